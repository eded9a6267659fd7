#include <io/write_ply.hpp>

#include <io/atomic_file.hpp>

#include <array>
#include <bit>
#include <cstring>
#include <vector>

namespace skybark::io {

namespace {

static_assert(std::endian::native == std::endian::little, "the bytes are written as they are");

std::string header(std::size_t vertices, std::size_t triangles) {
    std::string text = "ply\nformat binary_little_endian 1.0\ncomment Metres, +Y up\n"
                       "element vertex " +
                       std::to_string(vertices) + "\n";
    for (const char* property : {"x", "y", "z", "nx", "ny", "nz", "s", "t"}) {
        text += std::string("property float ") + property + "\n";
    }
    return text + "element face " + std::to_string(triangles) +
           "\nproperty list uchar uint vertex_indices\nend_header\n";
}

/// Writes `count` records of `size` bytes, each filled by `fill(i, bytes)`, in large pieces.
template <class Fill>
result<void> write_records(atomic_file& file, std::size_t count, std::size_t size, Fill&& fill) {
    constexpr std::size_t piece = 32768;
    std::vector<std::byte> bytes(std::min(count, piece) * size);
    for (std::size_t first = 0; first < count; first += piece) {
        const std::size_t n = std::min(piece, count - first);
        for (std::size_t i = 0; i < n; ++i) {
            fill(first + i, bytes.data() + i * size);
        }
        if (auto done = file.write(std::span<const std::byte>(bytes).first(n * size)); !done) {
            return done;
        }
    }
    return {};
}

} // namespace

result<void> write_ply(const std::string& path, std::span<const surface_vertex> vertices,
                       std::span<const std::uint32_t> indices) {
    auto file = atomic_file::create(path);
    if (!file) {
        return failure(file.error());
    }
    const std::size_t triangles = indices.size() / 3;
    if (auto done = file->write(header(vertices.size(), triangles)); !done) {
        return done;
    }
    using floats = std::array<float, 8>;
    auto done =
        write_records(*file, vertices.size(), sizeof(floats), [&](std::size_t i, std::byte* to) {
            const surface_vertex& v = vertices[i];
            const floats values{v.position.x, v.position.y, v.position.z, v.normal.x,
                                v.normal.y,   v.normal.z,   v.u,          v.v};
            std::memcpy(to, values.data(), sizeof values);
        });
    if (!done) {
        return done;
    }
    constexpr std::size_t corners = 3 * sizeof(std::uint32_t);
    done = write_records(*file, triangles, 1 + corners, [&](std::size_t i, std::byte* to) {
        to[0] = std::byte{3};
        std::memcpy(to + 1, indices.data() + 3 * i, corners);
    });
    if (!done) {
        return done;
    }
    return file->commit();
}

} // namespace skybark::io
