#include <io/probe_points.hpp>

#include <io/atomic_file.hpp>
#include <io/number_table.hpp>

#include <charconv>

namespace skybark::io {

namespace {

constexpr table_column columns[] = {{"x", -farthest_metres, farthest_metres, expected_position},
                                    {"y", -farthest_metres, farthest_metres, expected_position},
                                    {"z", -farthest_metres, farthest_metres, expected_position}};

glm::vec3 point_of(std::span<const double> row) {
    return {static_cast<float>(row[0]), static_cast<float>(row[1]), static_cast<float>(row[2])};
}

/// The shortest text that is read as the same float, and what comes after it.
void append(std::string& text, float value, char after) {
    char digits[32];
    const auto written = std::to_chars(digits, digits + sizeof digits, value);
    text.append(digits, written.ptr).push_back(after);
}

} // namespace

result<std::vector<glm::vec3>> read_points(const std::string& path) {
    std::vector<glm::vec3> points;
    const auto read = read_number_table(path, "points", columns, [&](std::span<const double> row) {
        points.push_back(point_of(row));
    });
    if (!read)
        return failure(read.error());
    return points;
}

result<std::vector<glm::vec3>> parse_points(std::string_view text, std::string_view name) {
    std::vector<glm::vec3> points;
    const auto read =
        parse_number_table(text, name, "points", columns,
                           [&](std::span<const double> row) { points.push_back(point_of(row)); });
    if (!read)
        return failure(read.error());
    return points;
}

result<void> write_probes(const std::string& path, std::span<const glm::vec3> points,
                          std::span<const probed_light> light) {
    auto file = atomic_file::create(path);
    if (!file)
        return failure(file.error());
    constexpr std::size_t block = std::size_t{1} << 20u;
    std::string text = "x,y,z,optical_depth,light\n";
    for (std::size_t i = 0; i < points.size(); ++i) {
        append(text, points[i].x, ',');
        append(text, points[i].y, ',');
        append(text, points[i].z, ',');
        append(text, light[i].optical_depth, ',');
        append(text, light[i].light, '\n');
        if (text.size() >= block) {
            if (auto written = file->write(text); !written)
                return written;
            text.clear();
        }
    }
    if (auto written = file->write(text); !written)
        return written;
    return file->commit();
}

} // namespace skybark::io
