#include <io/read_scene.hpp>

#include <io/text_input.hpp>

#include <algorithm>
#include <filesystem>

namespace skybark::io {

result<triangle_scene> read_scene(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    if (extension == ".obj") {
        return read_obj_scene(path);
    }
    if (extension == ".glb") {
        return read_glb_scene(path);
    }
    return fail(error_code::bad_input,
                in_quotes(path) + " is no scene that we know; expected a name that ends in .obj or "
                                  ".glb.");
}

} // namespace skybark::io
