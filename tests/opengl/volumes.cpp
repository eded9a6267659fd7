// Volumes of the OpenGL backend: sums by every route and padding, where the rectangles lie, how many
// there may be, and textures of the caller's.

#include "support.hpp"

#include <random>

namespace skybark::opengl::tests {
namespace {

using kernels::probe_box;
using kernels::probe_slabs;

constexpr std::array<accumulate_route, 4> all_routes = {
    accumulate_route::direct, accumulate_route::tiles_copied, accumulate_route::tiles_drawn,
    accumulate_route::layers};
constexpr std::array<padding, 2> both_policies = {padding::degenerate, padding::compact};

std::string name_of(accumulate_route route, padding policy) {
    const char* routes[] = {"direct", "tiles_copied", "tiles_drawn", "layers"};
    return std::string(routes[static_cast<std::size_t>(route)]) +
           (policy == padding::compact ? ", compact" : ", degenerate");
}

/// The sums as the contract has them, in 64 bits.
std::vector<std::int32_t> expected_sums(const probe_slabs& kernel, std::span<const probe_box> boxes,
                                        const volume_description& size) {
    std::vector<std::int64_t> sums(std::size_t{size.width} * size.height * size.depth);
    for (const probe_box& box : boxes) {
        const int layers = std::min(box.high.z - box.low.z, static_cast<int>(kernel.most));
        for (int s = 0; s < layers; ++s) {
            const int z = box.low.z + s;
            for (int y = std::max(box.low.y, 0); y < std::min(box.high.y - s, int(size.height));
                 ++y) {
                for (int x = std::max(box.low.x + s, 0); x < std::min(box.high.x, int(size.width));
                     ++x) {
                    if (z >= 0 && z < static_cast<int>(size.depth)) {
                        const std::int64_t amount =
                            (box.low.w + std::int64_t{kernel.per_x} * x + kernel.per_z * z +
                             std::int64_t{box.high.w} * y) *
                            kernel.factor;
                        sums[(static_cast<std::size_t>(z) * size.height +
                              static_cast<std::size_t>(y)) *
                                 size.width +
                             static_cast<std::size_t>(x)] += amount;
                    }
                }
            }
        }
    }
    std::vector<std::int32_t> result;
    for (const std::int64_t sum : sums) {
        EXPECT_EQ(sum, static_cast<std::int32_t>(sum)) << "the test's own sums leave an int32";
        result.push_back(static_cast<std::int32_t>(sum));
    }
    return result;
}

/// Boxes that lie inside, outside, and across every border of the volume.
std::vector<probe_box> scattered_boxes(std::size_t count, const volume_description& size,
                                       std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto number = [&](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random);
    };
    std::vector<probe_box> boxes(count);
    for (probe_box& box : boxes) {
        const glm::ivec3 sides(size.width, size.height, size.depth);
        for (int axis = 0; axis < 3; ++axis) {
            box.low[axis] = number(-4, sides[axis] + 1);
            box.high[axis] = box.low[axis] + number(-1, axis == 2 ? 6 : 9);
        }
        box.low.w = number(-200000, 200000);
        box.high.w = number(-50, 50);
    }
    return boxes;
}

class volumes_test : public device_test {
  protected:
    [[nodiscard]] volume make_volume(const volume_description& what) {
        auto made = device().create_volume(what);
        EXPECT_TRUE(made) << made.error().message;
        return std::move(*made);
    }
    template <class T>
    void fill(const volume& to, const std::vector<T>& voxels) {
        const auto done = device().upload(to, std::as_bytes(std::span(voxels)));
        EXPECT_TRUE(done) << done.error().message;
    }
    template <class T>
    [[nodiscard]] std::vector<T> voxels(const volume& from) {
        std::vector<T> got(from.description().size_bytes() / sizeof(T));
        const auto done = device().download(from, std::as_writable_bytes(std::span(got)));
        EXPECT_TRUE(done) << done.error().message;
        return got;
    }
    /// An accumulation from zero, of all of `boxes`.
    [[nodiscard]] std::vector<std::int32_t> sums(const probe_slabs& kernel, const buffer& boxes,
                                                 const volume& into, accumulate_route route,
                                                 padding policy) {
        const auto count = static_cast<std::uint32_t>(boxes.size_bytes() / sizeof(probe_box));
        run([&](recorder& r) {
            r.accumulate(kernel, {view<gpu>(boxes)}, range{0, count}, {&into, true, route, policy});
        });
        return voxels<std::int32_t>(into);
    }
};

TEST_F(volumes_test, every_route_and_padding_gives_the_same_sums) {
    // Sides that are no multiples of anything, and 11 layers: 4 × 4 tiles, the last ones empty.
    const volume_description size{19, 13, 11, volume_format::int32};
    const volume into = make_volume(size);
    const auto boxes = scattered_boxes(500, size, 1);
    const buffer bound = make(boxes);
    const probe_slabs kernel{5, 3, -7, 1};
    const auto wanted = expected_sums(kernel, boxes, size);
    for (const accumulate_route route : all_routes) {
        for (const padding policy : both_policies) {
            EXPECT_EQ(sums(kernel, bound, into, route, policy), wanted) << name_of(route, policy);
        }
    }
}

} // namespace
} // namespace skybark::opengl::tests
