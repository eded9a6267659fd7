#include <io/gather_points.hpp>

#include <io/atomic_file.hpp>
#include <io/number_table.hpp>
#include <io/text_input.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>

namespace skybark::io {

namespace {

static_assert(std::endian::native == std::endian::little, "the bytes are written as they are");

constexpr std::string_view expected_normal = "a finite number of at most 1e9";
constexpr table_column columns[] = {{"x", -farthest_metres, farthest_metres, expected_position},
                                    {"y", -farthest_metres, farthest_metres, expected_position},
                                    {"z", -farthest_metres, farthest_metres, expected_position},
                                    {"nx", -1e9, 1e9, expected_normal},
                                    {"ny", -1e9, 1e9, expected_normal},
                                    {"nz", -1e9, 1e9, expected_normal}};

/// Collects rows; remembers the first that has no normal.
class point_rows {
  public:
    void add(std::span<const double> row) {
        const glm::dvec3 normal(row[3], row[4], row[5]);
        const double length = glm::length(normal);
        if (!(length > 0) && bad_ == 0) {
            bad_ = points_.size() + 1;
        }
        gather_sample s;
        s.position = glm::vec3(glm::dvec3(row[0], row[1], row[2]));
        s.normal = length > 0 ? glm::vec3(normal / length) : glm::vec3(0);
        points_.push_back(s);
    }

    [[nodiscard]] result<std::vector<gather_sample>> take(const result<void>& read,
                                                          std::string_view name) {
        if (!read) {
            return failure(read.error());
        }
        if (bad_ != 0) {
            return fail(error_code::bad_input,
                        in_quotes(name) + " has the normal 0,0,0 at its point " +
                            std::to_string(bad_) + "; expected a direction.");
        }
        return std::move(points_);
    }

  private:
    std::vector<gather_sample> points_;
    std::size_t bad_ = 0; ///< counted from 1
};

/// The shortest text that is read as the same float, and what comes after it.
void append(std::string& text, float value, char after) {
    char digits[32];
    const auto written = std::to_chars(digits, digits + sizeof digits, value);
    text.append(digits, written.ptr).push_back(after);
}

/// Bytes on their way to a file, in blocks.
class block_writer {
  public:
    explicit block_writer(atomic_file& file) : file_(file) {}
    std::string text;

    [[nodiscard]] result<void> flush(std::size_t least = 0) {
        if (text.size() < least || text.empty()) {
            return {};
        }
        auto done = file_.write(std::string_view(text));
        text.clear();
        return done;
    }
    static constexpr std::size_t block = std::size_t{1} << 20u;

  private:
    atomic_file& file_;
};

template <class T>
void append_bytes(std::string& text, const T& value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    text.append(bytes, sizeof(T));
}

std::uint8_t for_display(float light, float white) {
    const double x = white > 0 ? std::clamp(double{light} / double{white}, 0.0, 1.0) : 0.0;
    const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

std::string ply_header(std::size_t points, std::size_t triangles) {
    std::string text = "ply\nformat binary_little_endian 1.0\n"
                       "comment Metres, +Y up; r, g, b: irradiance, error: its standard error, "
                       "W/m2\nelement vertex ";
    text += std::to_string(points) + "\n";
    for (const char* property : {"x", "y", "z", "nx", "ny", "nz", "r", "g", "b", "error"}) {
        text.append("property float ").append(property).append("\n");
    }
    for (const char* property : {"red", "green", "blue"}) {
        text.append("property uchar ").append(property).append("\n");
    }
    if (triangles != 0) {
        text += "element face " + std::to_string(triangles) +
                "\nproperty list uchar uint vertex_indices\n";
    }
    return text + "end_header\n";
}

} // namespace

result<std::vector<gather_sample>> read_gather_points(const std::string& path) {
    point_rows rows;
    const auto read = read_number_table(path, "points", columns,
                                        [&](std::span<const double> row) { rows.add(row); });
    return rows.take(read, path);
}

result<std::vector<gather_sample>> parse_gather_points(std::string_view text,
                                                       std::string_view name) {
    point_rows rows;
    const auto read = parse_number_table(text, name, "points", columns,
                                         [&](std::span<const double> row) { rows.add(row); });
    return rows.take(read, name);
}

result<void> write_gathered(const std::string& path, std::span<const gather_sample> points,
                            std::span<const glm::vec4> light) {
    auto file = atomic_file::create(path);
    if (!file) {
        return failure(file.error());
    }
    block_writer to(*file);
    to.text = "x,y,z,nx,ny,nz,r,g,b,error\n";
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::vec3 vectors[] = {points[i].position, points[i].normal, glm::vec3(light[i])};
        for (const glm::vec3& v : vectors) {
            for (int axis = 0; axis < 3; ++axis) {
                append(to.text, v[axis], ',');
            }
        }
        append(to.text, light[i].w, '\n');
        if (auto written = to.flush(block_writer::block); !written) {
            return written;
        }
    }
    if (auto written = to.flush(); !written) {
        return written;
    }
    return file->commit();
}

result<void> write_gathered_ply(const std::string& path, std::span<const gather_sample> points,
                                std::span<const glm::vec4> light, float white,
                                std::span<const glm::uvec3> triangles) {
    auto file = atomic_file::create(path);
    if (!file) {
        return failure(file.error());
    }
    block_writer to(*file);
    to.text = ply_header(points.size(), triangles.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::vec3 p = points[i].position;
        const glm::vec3 n = points[i].normal;
        const std::array<float, 10> floats{p.x, p.y,        p.z,        n.x,        n.y,
                                           n.z, light[i].x, light[i].y, light[i].z, light[i].w};
        append_bytes(to.text, floats);
        for (int c = 0; c < 3; ++c) {
            append_bytes(to.text, for_display(light[i][c], white));
        }
        if (auto written = to.flush(block_writer::block); !written) {
            return written;
        }
    }
    for (const glm::uvec3& t : triangles) {
        to.text.push_back('\3');
        append_bytes(to.text, std::array<std::uint32_t, 3>{t.x, t.y, t.z});
        if (auto written = to.flush(block_writer::block); !written) {
            return written;
        }
    }
    if (auto written = to.flush(); !written) {
        return written;
    }
    return file->commit();
}

} // namespace skybark::io
