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

/// An image file that is open, of a size that is possible.
struct opened_image {
    std::unique_ptr<std::FILE, close_file> file;
    int width = 0;
    int height = 0;
    std::string size; // for sentences
};

result<opened_image> open_image(const std::string& path) {
    constexpr int longest = 16384;
    opened_image image;
    image.file.reset(std::fopen(path.c_str(), "rb"));
    if (!image.file) {
        return fail(error_code::unavailable, in_quotes(path).append(" can't be opened."));
    }
    int channels = 0;
    if (stbi_info_from_file(image.file.get(), &image.width, &image.height, &channels) == 0) {
        return unreadable(path, "it is no picture that we know.");
    }
    image.size = std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels";
    if (image.width < 1 || image.height < 1 || image.width > longest || image.height > longest) {
        return unreadable(path, "a texture of " + image.size + " isn't possible.");
    }
    return image;
}

} // namespace

result<trees::bark_texture> read_image(const std::string& path) {
    auto image = open_image(path);
    if (!image) {
        return failure(image.error());
    }
    int channels = 0;
    const std::unique_ptr<stbi_us, free_pixels> pixels(
        stbi_load_from_file_16(image->file.get(), &image->width, &image->height, &channels, 1));
    if (!pixels) {
        return unreadable(path, "its " + image->size + " are damaged or not all there.");
    }
    trees::bark_texture texture{
        static_cast<std::uint32_t>(image->width), static_cast<std::uint32_t>(image->height), {}};
    const std::size_t count = std::size_t{texture.width} * texture.height;
    texture.heights.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        texture.heights.push_back(static_cast<float>(pixels.get()[i]) / 65535.0f);
    }
    return texture;
}

result<colour_picture> read_colours(const std::string& path) {
    auto image = open_image(path);
    if (!image) {
        return failure(image.error());
    }
    int channels = 0;
    const std::unique_ptr<stbi_uc, free_pixels> pixels(
        stbi_load_from_file(image->file.get(), &image->width, &image->height, &channels, 4));
    if (!pixels) {
        return unreadable(path, "its " + image->size + " are damaged or not all there.");
    }
    colour_picture picture;
    picture.width = static_cast<std::uint32_t>(image->width);
    picture.height = static_cast<std::uint32_t>(image->height);
    const std::size_t bytes = std::size_t{4} * picture.width * picture.height;
    picture.rgba.assign(pixels.get(), pixels.get() + bytes);
    picture.has_alpha = channels == 2 || channels == 4;
    return picture;
}

result<trees::leaf_picture> read_leaf(const std::string& path) {
    auto colours = read_colours(path);
    if (!colours) {
        return failure(colours.error());
    }
    trees::leaf_picture picture;
    picture.width = colours->width;
    picture.height = colours->height;
    picture.rgba = std::move(colours->rgba);
    return trees::turned_over(picture);
}

} // namespace skybark::io
