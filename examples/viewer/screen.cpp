#include "screen.hpp"

#include <algorithm>

namespace skybark::viewer {

placed place(glm::uvec2 picture, glm::uvec2 window) {
    // Whether the window is wider than the picture is, in whole numbers.
    const bool wider = std::uint64_t{window.x} * picture.y > std::uint64_t{picture.x} * window.y;
    glm::uvec2 size = window;
    if (wider) {
        size.x = static_cast<std::uint32_t>(std::uint64_t{picture.x} * window.y / picture.y);
    } else {
        size.y = static_cast<std::uint32_t>(std::uint64_t{picture.y} * window.x / picture.x);
    }
    size = glm::uvec2(std::max(size.x, 1u), std::max(size.y, 1u));
    const glm::uvec2 low((window.x - std::min(size.x, window.x)) / 2,
                         (window.y - std::min(size.y, window.y)) / 2);
    return {low, low + size};
}

} // namespace skybark::viewer
