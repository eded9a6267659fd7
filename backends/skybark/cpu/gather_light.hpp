#pragma once
// gather_light and directional_light with the light of a few hundred samples ahead.
//
// A sample's light is where its hit's table says it is: two places in memory, one after another,
// all over the scene where leaves are small. Kernels wait for each; here they are all asked for
// first. What the kernels do then is their own, so the bits are the same.

#include <skybark/cpu/memory.hpp>
#include <skybark/cpu/program.hpp>
#include <skybark/kernels/directional_light.hpp>
#include <skybark/kernels/gather_light.hpp>

#include <array>

namespace skybark::cpu {

namespace lights {

inline constexpr std::uint32_t ahead = 256;
/// Tables that no core's caches lose: nothing is asked for.
inline constexpr std::size_t small_bytes = 1u << 18;

/// Asks for the tables that some hits need, then for the light that the tables tell of.
inline void fetch_light(std::span<const gather_hit> hits, std::span<const patch_table> tables,
                        std::span<const glm::vec4> radiance) {
    std::array<std::uint32_t, ahead> found;
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < hits.size(); ++i) {
        found[count] = i;
        if (hits[i].surface != no_surface) {
            detail::fetch(&tables[hits[i].surface / 2]);
            ++count;
        }
    }
    for (std::size_t n = 0; n < count; ++n) {
        const gather_hit& hit = hits[found[n]];
        const patch_table& table = tables[hit.surface / 2];
        const std::uint32_t patches = hit.surface % 2 == 0 ? table.front : table.back;
        if (patches < radiance.size()) {
            detail::fetch(&radiance[patches] + shared::patch_at(table.rows, hit.u, hit.v));
        }
    }
}

template <class K>
struct program_ahead : plain_program<K> {
    template <class... Sums>
    static void map(const K& kernel, range elements, std::span<const gather_sample> samples,
                    std::span<const gather_hit> hits, std::span<const patch_table> tables,
                    std::span<const glm::vec4> radiance, Sums... sums) {
        const bool fetches = tables.size_bytes() > small_bytes;
        for (std::uint32_t done = 0; done < elements.count; done += ahead) {
            const range some{elements.first + done, std::min(ahead, elements.count - done)};
            if (fetches) {
                fetch_light(hits.subspan(some.first, some.count), tables, radiance);
            }
            plain_program<K>::map(kernel, some, samples, hits, tables, radiance, sums...);
        }
    }
};

} // namespace lights

template <>
struct program<kernels::gather_light> : lights::program_ahead<kernels::gather_light> {};
template <>
struct program<kernels::directional_light> : lights::program_ahead<kernels::directional_light> {};

} // namespace skybark::cpu
