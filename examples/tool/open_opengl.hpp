#pragma once
// The OpenGL backend's devices: 0 is EGL without a surface, 1 is OSMesa.

#include "options.hpp"

#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/opengl.hpp>

namespace skybark::tool {

/// As `skybark devices` counts them.
inline constexpr opengl::headless_kind opengl_kinds[] = {opengl::headless_kind::egl,
                                                         opengl::headless_kind::osmesa};

[[nodiscard]] inline result<opengl::headless> open_opengl(const common_options& options) {
    opengl::headless_options wanted;
    if (!options.any_device) {
        if (options.device >= std::size(opengl_kinds)) {
            return fail(error_code::unavailable,
                        "There is no device " + std::to_string(options.device) +
                            " of the backend opengl; expected 0 (EGL) or 1 (OSMesa).");
        }
        wanted.kind = opengl_kinds[options.device];
    }
    return opengl::headless::create(std::move(wanted));
}

/// "RENDERER, OpenGL VERSION", the name of an OpenGL device, in two.
struct opengl_names {
    std::string renderer;
    std::string version;
};
[[nodiscard]] inline opengl_names split_name(const std::string& name) {
    const std::size_t at = name.rfind(", OpenGL ");
    return at == std::string::npos ? opengl_names{name, name}
                                   : opengl_names{name.substr(0, at), name.substr(at + 2)};
}

} // namespace skybark::tool
