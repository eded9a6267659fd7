#include <io/read_particles.hpp>

#include <io/number_table.hpp>

namespace skybark::io {

namespace {

constexpr table_column columns[] = {
    {"x", -farthest_metres, farthest_metres, expected_position},
    {"y", -farthest_metres, farthest_metres, expected_position},
    {"z", -farthest_metres, farthest_metres, expected_position},
    {"radius", 1e-6, farthest_metres, "a number of metres from 1e-6 to 1e9"},
    {"optical_depth", 0, 1e6, "a number from 0 to 1e6"},
    {"albedo", 0, 1, "a number from 0 to 1"}};

cloud_particle particle_of(std::span<const double> row) {
    const auto at = [&](std::size_t c) { return static_cast<float>(row[c]); };
    cloud_particle p;
    p.position = {at(0), at(1), at(2)};
    p.radius = at(3);
    p.optical_depth = at(4);
    p.albedo = at(5);
    return p;
}

} // namespace

result<std::vector<cloud_particle>> read_particles(const std::string& path) {
    std::vector<cloud_particle> particles;
    const auto read =
        read_number_table(path, "particles", columns, [&](std::span<const double> row) {
            particles.push_back(particle_of(row));
        });
    if (!read)
        return failure(read.error());
    return particles;
}

result<std::vector<cloud_particle>> parse_particles(std::string_view text, std::string_view name) {
    std::vector<cloud_particle> particles;
    const auto read =
        parse_number_table(text, name, "particles", columns, [&](std::span<const double> row) {
            particles.push_back(particle_of(row));
        });
    if (!read)
        return failure(read.error());
    return particles;
}

} // namespace skybark::io
