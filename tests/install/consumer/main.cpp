#include <skybark/core/result.hpp>
#include <skybark/trees/skeleton.hpp>

#include <cstdio>

skybark::result<float> height(const skybark::trees::skeleton& tree) {
    if (tree.empty()) {
        return skybark::fail(skybark::error_code::bad_input,
                             "A tree without segments has no height.");
    }
    return tree.tip(tree.size() - 1).y;
}

int main() {
    skybark::trees::skeleton tree;
    const bool empty_is_an_error = !height(tree).has_value();
    tree.parent = {skybark::trees::none};
    tree.orientation = {glm::quat(1, 0, 0, 0)};
    tree.position = {glm::vec3(0)};
    tree.length = {2};
    std::printf("A tree of %zu segment is %g m high.\n", tree.size(), double(*height(tree)));
    return empty_is_an_error && *height(tree) == 2 ? 0 : 1;
}
