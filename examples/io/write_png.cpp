#include <io/write_png.hpp>

#include <io/atomic_file.hpp>
#include <io/text_input.hpp>

// Static: a library that we load may bring the same functions.
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace skybark::io {

namespace {

void append(void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data),
                                               static_cast<std::size_t>(size));
}

} // namespace

result<std::string> encode_png(const std::string& name, std::span<const std::uint8_t> pixels,
                               std::uint32_t width, std::uint32_t height) {
    constexpr std::uint32_t longest = 16384; // sizes are ints below
    const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
    if (width == 0 || height == 0 || width > longest || height > longest ||
        pixels.size() != std::size_t{4} * width * height) {
        return fail(error_code::bad_input, in_quotes(name) + " can't be written: a picture of " +
                                               size + " from " + std::to_string(pixels.size()) +
                                               " bytes isn't possible.");
    }
    std::string png;
    const int made =
        stbi_write_png_to_func(append, &png, static_cast<int>(width), static_cast<int>(height), 4,
                               pixels.data(), static_cast<int>(4 * width));
    if (made == 0) {
        return fail(error_code::out_of_memory, "There is not enough memory to compress " +
                                                   in_quotes(name) + ", " + size + ".");
    }
    return png;
}

result<void> write_png(const std::string& path, std::span<const std::uint8_t> pixels,
                       std::uint32_t width, std::uint32_t height) {
    const auto png = encode_png(path, pixels, width, height);
    if (!png) {
        return failure(png.error());
    }
    return write_file(path, *png);
}

} // namespace skybark::io
