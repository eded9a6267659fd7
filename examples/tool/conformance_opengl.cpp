#include "conformance_backends.hpp"
#include "open_opengl.hpp"

#include <skybark/conformance/suite.hpp>

namespace skybark::tool {

result<void> register_opengl(const common_options& options) {
    if (auto opened = open_opengl(options); !opened) {
        return failure(opened.error());
    }
    conformance::register_suite<opengl::device>(
        "opengl", [options]() -> result<std::unique_ptr<opengl::device>> {
            auto opened = open_opengl(options);
            if (!opened) {
                return failure(opened.error());
            }
            return std::make_unique<opengl::device>(std::move(*opened).device());
        });
    return {};
}

} // namespace skybark::tool
