#include <io/read_image.hpp>

#include <io/text_input.hpp>

#include <cstdio>
#include <memory>

// Static: a library that we load may bring the same functions.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#include <stb/stb_image.h>

namespace skybark::io {

namespace {

struct close_file {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
struct free_pixels {
    void operator()(void* pixels) const { stbi_image_free(pixels); }
};

[[nodiscard]] failure unreadable(const std::string& path, const std::string& why) {
    return fail(error_code::bad_input, in_quotes(path).append(" can't be read: ").append(why));
}

} // namespace

result<trees::bark_texture> read_image(const std::string& path) {
    constexpr int longest = 16384;
    const std::unique_ptr<std::FILE, close_file> file(std::fopen(path.c_str(), "rb"));
    if (!file) {
        return fail(error_code::unavailable, in_quotes(path).append(" can't be opened."));
    }
    int width = 0;
    int height = 0;
    int channels = 0;
    if (stbi_info_from_file(file.get(), &width, &height, &channels) == 0) {
        return unreadable(path, "it is no picture that we know.");
    }
    const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
    if (width < 1 || height < 1 || width > longest || height > longest) {
        return unreadable(path, "a bark texture of " + size + " isn't possible.");
    }
    const std::unique_ptr<stbi_us, free_pixels> pixels(
        stbi_load_from_file_16(file.get(), &width, &height, &channels, 1));
    if (!pixels) {
        return unreadable(path, "its " + size + " are damaged or not all there.");
    }
    trees::bark_texture texture{
        static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
    const std::size_t count = std::size_t{texture.width} * texture.height;
    texture.heights.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        texture.heights.push_back(static_cast<float>(pixels.get()[i]) / 65535.0f);
    }
    return texture;
}

} // namespace skybark::io
