#include <io/settle.hpp>

#include <algorithm>

namespace skybark::io {

void settle(std::vector<trees::segment>& segments) {
    const auto root = std::find_if(segments.begin(), segments.end(),
                                   [](const auto& s) { return s.parent == trees::none; });
    if (root == segments.end())
        return;
    const glm::vec3 foot = root->base;
    for (trees::segment& s : segments) {
        s.base -= foot;
        s.tip -= foot;
    }
}

} // namespace skybark::io
