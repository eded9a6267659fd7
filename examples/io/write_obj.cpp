#include <io/write_obj.hpp>

#include <io/atomic_file.hpp>

#include <charconv>
#include <initializer_list>

namespace skybark::io {

namespace {

/// Collects text and hands it on in large pieces. After a failure it takes no more.
class text_writer {
  public:
    explicit text_writer(atomic_file& file) : file_(file) { text_.reserve(full + longest_line); }

    void add(std::string_view text) { text_ += text; }
    template <class Number>
    void add_number(Number value) {
        char digits[32];
        const char* end = std::to_chars(digits, digits + sizeof digits, value).ptr;
        text_.append(digits, static_cast<std::size_t>(end - digits));
    }
    void end_line() {
        text_ += '\n';
        if (text_.size() >= full) {
            flush();
        }
    }
    [[nodiscard]] result<void> finish() {
        flush();
        return done_;
    }

  private:
    static constexpr std::size_t full = std::size_t{1} << 20u;
    static constexpr std::size_t longest_line = 256;

    void flush() {
        if (done_) {
            done_ = file_.write(text_);
        }
        text_.clear();
    }

    atomic_file& file_;
    std::string text_;
    result<void> done_;
};

void add_floats(text_writer& to, std::string_view keyword, std::initializer_list<float> values) {
    to.add(keyword);
    for (const float value : values) {
        to.add(" ");
        to.add_number(value);
    }
    to.end_line();
}

void add_triangle(text_writer& to, std::span<const std::uint32_t, 3> corners) {
    to.add("f");
    for (const std::uint32_t corner : corners) {
        const std::uint64_t number = std::uint64_t{corner} + 1; // OBJ counts from one
        to.add(" ");
        to.add_number(number);
        to.add("/");
        to.add_number(number);
        to.add("/");
        to.add_number(number);
    }
    to.end_line();
}

} // namespace

result<void> write_obj(const std::string& path, std::span<const surface_vertex> vertices,
                       std::span<const std::uint32_t> indices) {
    auto file = atomic_file::create(path);
    if (!file) {
        return failure(file.error());
    }
    text_writer to(*file);
    to.add("# Metres, +Y up. " + std::to_string(vertices.size()) + " vertices, " +
           std::to_string(indices.size() / 3) + " triangles.");
    to.end_line();
    for (const surface_vertex& v : vertices) {
        add_floats(to, "v", {v.position.x, v.position.y, v.position.z});
    }
    for (const surface_vertex& v : vertices) {
        add_floats(to, "vt", {v.u, v.v});
    }
    for (const surface_vertex& v : vertices) {
        add_floats(to, "vn", {v.normal.x, v.normal.y, v.normal.z});
    }
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        add_triangle(to, indices.subspan(i).first<3>());
    }
    if (auto done = to.finish(); !done) {
        return done;
    }
    return file->commit();
}

} // namespace skybark::io
