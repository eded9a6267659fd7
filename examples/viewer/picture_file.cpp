#include "picture_file.hpp"

#include <cstdio>
#include <filesystem>
#include <io/text_input.hpp>
#include <io/write_png.hpp>

namespace skybark::viewer {

result<std::string> next_free_name(const std::string& folder) {
    for (int number = 1; number <= 9999; ++number) {
        char name[32];
        std::snprintf(name, sizeof name, "skybark_%04d.png", number);
        std::string path = (std::filesystem::path(folder) / name).string();
        std::error_code error;
        if (std::filesystem::symlink_status(path, error).type() ==
            std::filesystem::file_type::not_found) {
            return path;
        }
    }
    return fail(error_code::bad_input,
                "The folder " + io::in_quotes(folder) +
                    " has all of skybark_0001.png to skybark_9999.png already.");
}

result<void> save(const std::string& path, shown picture) {
    for (std::size_t i = 3; i < picture.pixels.size(); i += 4) {
        picture.pixels[i] = 255;
    }
    return io::write_png(path, picture.pixels, picture.width, picture.height);
}

} // namespace skybark::viewer
