#pragma once
// Pictures that the tool drew, and how far apart they are.

#include "support.hpp"

#include <cstdlib>
#include <tiny_gltf.h>

namespace skybark::tests {

/// A picture from a file, by tinygltf's decoder, which is stb_image; rows of RGBA.
struct read_picture {
    int width = 0;
    int height = 0;
    std::vector<unsigned char> rgba;
};
inline read_picture read_png(const std::string& path) {
    const std::string bytes = read_file(path);
    tinygltf::Image image;
    std::string error, warning;
    EXPECT_TRUE(tinygltf::LoadImageData(&image, 0, &error, &warning, 0, 0,
                                        reinterpret_cast<const unsigned char*>(bytes.data()),
                                        static_cast<int>(bytes.size()), nullptr))
        << error;
    return {image.width, image.height, image.image};
}

struct picture_difference {
    double mean = 0; ///< of a channel, 0 … 255
    double far = 0;  ///< part of the pixels with a channel that differs by more than 16
};
inline picture_difference compare(const read_picture& a, const read_picture& b) {
    picture_difference found;
    if (a.rgba.size() != b.rgba.size() || a.rgba.empty()) {
        ADD_FAILURE() << "pictures of " << a.rgba.size() << " and " << b.rgba.size() << " bytes";
        return found;
    }
    const auto pixels = static_cast<double>(a.rgba.size() / 4);
    for (std::size_t i = 0; i + 3 < a.rgba.size(); i += 4) {
        int most = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const int d = std::abs(int{a.rgba[i + c]} - int{b.rgba[i + c]});
            found.mean += d / (3 * pixels);
            most = std::max(most, d);
        }
        found.far += most > 16 ? 1 / pixels : 0;
    }
    return found;
}

} // namespace skybark::tests
