#pragma once
// bundle_hits: what each sample meets first along a bundle of rays.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/alpha_map.hpp>
#include <skybark/shared/bundle.hpp>

namespace skybark::kernels {

/// Buffers: samples; corners (of bundle_order); starts: of each cell, its place in the order, and
/// their number; alpha: words, as alpha_coordinates says; hits, before and after: the same buffer.
/// Maps over samples. Of the triangles around a sample it looks at those from `first` to
/// `first` + `count`; `first` = 0 begins anew. Of equally distant triangles the one of the lower
/// number counts.
struct bundle_hits {
    using buffers =
        buffer_list<readonly<gather_sample>, readonly<glm::vec4>, readonly<std::uint32_t>,
                    readonly<std::uint32_t>, readonly<gather_hit>, writeonly<gather_hit>>;

    ray_bundle bundle;
    std::uint32_t first = 0;
    std::uint32_t count = 0;

    void map(std::uint32_t i, std::span<const gather_sample> samples,
             std::span<const glm::vec4> corners, std::span<const std::uint32_t> starts,
             std::span<const std::uint32_t> alpha, std::span<const gather_hit> before,
             std::span<gather_hit> hits) const {
        gather_hit best;
        if (first != 0) {
            best = before[i];
        }
        const gather_sample at = samples[i];
        const glm::vec3 origin = shared::across_bundle(bundle, shared::ray_origin(bundle, at));
        const float side = shared::side_of_bundle(bundle, at.normal);
        const float x = shared::bundle_cells(bundle, origin.x);
        const float y = shared::bundle_cells(bundle, origin.y);
        const auto cells = static_cast<std::uint32_t>(bundle.direction.w);
        const std::uint32_t last = first + count;
        std::uint32_t seen = 0;
        std::uint32_t base = 0;
        float share = 1;
        for (std::uint32_t side_cells = cells; side_cells > 0; side_cells /= 2) {
            const auto n = static_cast<int>(side_cells);
            const std::uint32_t next = base + side_cells * side_cells;
            if (starts[base] != starts[next]) {
                const int column = shared::cell_within(x * share, n);
                const int row = shared::cell_within(y * share, n);
                const int left = glm::max(column - 1, 0);
                const int right = glm::min(column + 1, n - 1);
                const int top = glm::min(row + 1, n - 1);
                for (int r = glm::max(row - 1, 0); r <= top; ++r) {
                    const std::uint32_t begin =
                        starts[base + static_cast<std::uint32_t>(r * n + left)];
                    const std::uint32_t end =
                        starts[base + static_cast<std::uint32_t>(r * n + right) + 1];
                    const std::uint32_t skipped =
                        glm::min(glm::max(first, seen) - seen, end - begin);
                    const std::uint32_t wanted = glm::min(glm::max(last, seen) - seen, end - begin);
                    for (std::uint32_t k = begin + skipped; k < begin + wanted; ++k) {
                        best = nearer(best, k, origin, side, corners, alpha);
                    }
                    seen += end - begin;
                }
            }
            base = next;
            share *= 0.5f;
        }
        hits[i] = best;
    }

    /// Whether the triangle with these alpha_coordinates (from 1; 0: none) has a hole at u, v.
    [[nodiscard]] static bool is_hole(std::uint32_t number, float u, float v,
                                      std::span<const std::uint32_t> alpha) {
        if (number == 0) {
            return false;
        }
        const std::size_t at = std::size_t{12} * (number - 1);
        const auto value = [&](std::size_t word) { return glm::uintBitsToFloat(alpha[at + word]); };
        const std::uint32_t size = alpha[at + 7];
        const std::uint32_t column = shared::alpha_texel(
            shared::alpha_place(value(0), value(2), value(4), u, v), size & 0xffffu);
        const std::uint32_t row = shared::alpha_texel(
            shared::alpha_place(value(1), value(3), value(5), u, v), size >> 16);
        const std::size_t texel = alpha[at + 6] + std::size_t{row} * (size & 0xffffu) + column;
        return glm::uintBitsToFloat(alpha[texel]) < value(8);
    }

  private:
    [[nodiscard]] gather_hit nearer(gather_hit best, std::uint32_t k, glm::vec3 origin, float side,
                                    std::span<const glm::vec4> corners,
                                    std::span<const std::uint32_t> alpha) const {
        const glm::vec4 p = corners[3 * std::size_t{k}];
        const glm::vec4 q = corners[3 * std::size_t{k} + 1];
        const glm::vec4 r = corners[3 * std::size_t{k} + 2];
        const shared::bundle_meeting met = shared::meet_triangle(
            glm::vec3(p.x, p.y, q.z), glm::vec3(p.z, p.w, q.w), glm::vec3(q.x, q.y, r.x), origin.x,
            origin.y, shared::meeting_slack(bundle));
        const float distance = shared::distance_along(met, side, origin.z, bundle.right.w);
        if (!(distance >= 0.0f && distance <= best.distance)) {
            return best;
        }
        const std::uint32_t triangle = glm::floatBitsToUint(r.y);
        if (distance == best.distance && best.surface != no_surface &&
            triangle >= best.surface / 2) {
            return best;
        }
        if (is_hole(glm::floatBitsToUint(r.z), met.u, met.v, alpha)) {
            return best;
        }
        gather_hit found;
        found.distance = distance;
        found.surface = 2 * triangle + (side * met.facing < 0.0f ? 0u : 1u);
        found.u = met.u;
        found.v = met.v;
        return found;
    }
};
static_assert(sizeof(bundle_hits) == 72);

} // namespace skybark::kernels
