#include <io/picture_means.hpp>

#include <array>
#include <cmath>
#include <cstddef>

namespace skybark::io {

namespace {

/// sRGB's curve, for each byte (IEC 61966-2-1).
std::array<double, 256> linear_table() {
    std::array<double, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double c = static_cast<double>(i) / 255;
        table[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    }
    return table;
}

} // namespace

glm::vec3 mean_colour(const colour_picture& picture) {
    const std::array<double, 256> linear = linear_table();
    double sum[3] = {0, 0, 0};
    double weight = 0;
    for (std::size_t i = 0; i + 3 < picture.rgba.size(); i += 4) {
        const double alpha = picture.rgba[i + 3] / 255.0;
        for (std::size_t c = 0; c < 3; ++c) {
            sum[c] += alpha * linear[picture.rgba[i + c]];
        }
        weight += alpha;
    }
    if (weight == 0) {
        return glm::vec3(1);
    }
    return {static_cast<float>(sum[0] / weight), static_cast<float>(sum[1] / weight),
            static_cast<float>(sum[2] / weight)};
}

alpha_map alpha_of(const colour_picture& picture, bool turned_over) {
    alpha_map map{picture.width, picture.height, {}};
    map.values.reserve(std::size_t{picture.width} * picture.height);
    for (std::size_t row = 0; row < picture.height; ++row) {
        const std::size_t from = turned_over ? picture.height - 1 - row : row;
        for (std::size_t x = 0; x < picture.width; ++x) {
            const std::uint8_t* p = picture.rgba.data() + 4 * (from * picture.width + x);
            const double luma = 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
            const double value = picture.has_alpha ? double{1} * p[3] : luma;
            map.values.push_back(static_cast<float>(value / 255));
        }
    }
    return map;
}

} // namespace skybark::io
