// The trees of the stand: where they are, how they grow, and what their surfaces look like.

#include "growth.hpp"

#include <scenes/random.hpp>
#include <skybark/shared/surfaces.hpp>
#include <skybark/trees/bark_texture.hpp>
#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/leaf_texture.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace skybark::meadow {

namespace {

enum species_number : std::uint32_t { oak, aspen, willow, tupelo };

/// A place as the camera sees it: so many metres ahead and to the right of it.
struct composed_place {
    species_number species;
    float ahead;
    float right;
    float height;
};

/// An oak on the left and aspens on the right frame a clearing that opens towards a lone oak and
/// the hills; taller trees close it on both sides. The sun stands to the left: some trees are
/// there for their shadows alone.
constexpr composed_place composition[] = {
    {oak, 34, -17, 12},     {aspen, 31, 15.5f, 11}, {aspen, 36, 20, 13.5f}, {willow, 58, -13, 15},
    {tupelo, 74, -24, 24},  {oak, 62, 19, 12},      {aspen, 43, 18, 10},    {oak, 96, 4, 13},
    {tupelo, 84, 24, 23},   {willow, 80, 13, 14},   {aspen, 92, -20, 18},   {aspen, 97, -15, 16},
    {tupelo, 104, -30, 25}, {oak, 13, -21, 12},     {aspen, 100, -25, 17},  {oak, 112, -8, 14},
    {tupelo, 116, 32, 24},  {willow, 110, 18, 15},  {aspen, 122, 8, 17},    {oak, 56, -34, 13},
    {aspen, 47, 29, 14},    {tupelo, 128, -20, 25}, {aspen, 126, 14, 16},   {oak, 70, 40, 13},
};

constexpr float border = 4; ///< m at the edge of the land where no tree stands

bool is_in_the_way(const view_axes& seen, glm::vec2 place) {
    const float ahead = glm::dot(place - seen.eye, seen.ahead);
    const float right = glm::dot(place - seen.eye, seen.right);
    return ahead > -10 && ahead < 70 && std::abs(right) < 8 + 0.5f * std::max(ahead, 0.0f);
}

} // namespace

view_axes usual_view() {
    const camera usual;
    const glm::vec2 eye(usual.eye.x, usual.eye.z);
    const glm::vec2 ahead = glm::normalize(glm::vec2(usual.target.x, usual.target.z) - eye);
    return {eye, ahead, {-ahead.y, ahead.x}};
}

std::vector<tree_place> place_trees(std::uint32_t count, std::uint64_t seed) {
    std::vector<tree_place> places;
    places.reserve(count);
    const view_axes seen = usual_view();
    for (const composed_place& each : composition) {
        if (places.size() < count) {
            places.push_back({each.species,
                              seen.eye + seen.ahead * each.ahead + seen.right * each.right,
                              each.height});
        }
    }
    scenes::random_numbers random(static_cast<std::uint32_t>(seed * 7919 + 17));
    const float reach = land::side / 2 - border;
    float apart = 7; // m: less where there is no room for so much
    while (places.size() < count) {
        const glm::vec2 at(random.between(-reach, reach), random.between(-reach, reach));
        apart = std::max(apart * 0.999f, 0.5f);
        const bool crowded = std::any_of(places.begin(), places.end(), [&](const tree_place& p) {
            return glm::distance(p.at, at) < apart;
        });
        if (crowded || is_in_the_way(seen, at)) {
            continue;
        }
        constexpr species_number mixed[] = {aspen, oak, aspen, tupelo, willow, aspen, oak};
        const species_number species = mixed[random.bits() % std::size(mixed)];
        const float height = species == tupelo ? 19 : 12;
        places.push_back({species, at, height * random.between(0.8f, 1.15f)});
    }
    return places;
}

namespace {

/// The species' table with fewer twigs, each with more leaves on it: some thousand segments a tree.
trees::weber_penn_parameters simplified(std::uint32_t species) {
    trees::weber_penn_parameters p = trees::find_species(stand_species[species])->parameters;
    p.scale_v = 0;
    switch (species) {
    case oak:
        p.base_size = 0.16f;
        p.ratio = 0.016f;
        p.level[1].branches = 30;
        p.level[1].curve_res = 6;
        p.level[1].length = 0.7f;
        p.level[2].branches = 84;
        p.level[2].length = 0.27f;
        p.level[2].curve_res = 2;
        break;
    case aspen:
        p.level[1].branches = 46;
        p.level[1].curve_res = 4;
        p.level[2].branches = 22;
        p.level[2].curve_res = 2;
        break;
    case willow:
        p.levels = 3;
        p.level[1].branches = 22;
        p.level[1].curve_res = 8;
        p.level[2].branches = 26;
        p.level[2].curve_res = 7;
        break;
    default:
        p.levels = 3;
        p.level[1].branches = 46;
        p.level[1].curve_res = 6;
        p.level[2].branches = 24;
        p.level[2].curve_res = 4;
        break;
    }
    return p;
}

/// Leaves that are larger and fewer than a tree's, as they are seen from some tens of metres.
trees::leaf_options blades_of(std::uint32_t species) {
    const trees::species_entry& entry = *trees::find_species(stand_species[species]);
    trees::leaf_options o = trees::leaves_of(entry);
    switch (species) {
    case oak:
        o.per_twig = 18;
        o.length = 0.21f;
        o.reach = 1.2f;
        break;
    case aspen:
        o.per_twig = 15;
        o.length = 0.17f;
        o.width = 0.95f;
        o.reach = 0.9f;
        break;
    case willow:
        o.per_twig = 0;
        o.per_metre = 13;
        o.length = 0.30f;
        o.width = 0.22f;
        o.reach = 3.5f;
        break;
    default:
        o.per_twig = 14;
        o.length = 0.27f;
        o.width = 0.55f;
        o.reach = 1.6f;
        break;
    }
    return o;
}

// Pictures have no smaller copies of themselves: as fine as they are seen, and no finer.
constexpr std::uint32_t bark_texels = 256;
constexpr std::uint32_t leaf_texels = 96;

material bark_of(std::uint32_t species, float girth, std::uint64_t seed) {
    material made;
    made.as = look::bark;
    const auto number = static_cast<std::uint32_t>(seed + species);
    const bool smooth = species == aspen;
    switch (species) {
    case oak:
        made.low = {0.035f, 0.030f, 0.026f};
        made.high = {0.20f, 0.175f, 0.15f};
        break;
    case aspen:
        made.low = {0.30f, 0.30f, 0.24f};
        made.high = {0.52f, 0.51f, 0.42f};
        break;
    case willow:
        made.low = {0.07f, 0.055f, 0.035f};
        made.high = {0.36f, 0.31f, 0.22f};
        break;
    default:
        break;
    }
    // A repeat is half a metre around a trunk and 0.7 m along it.
    constexpr float around = 0.5f;
    constexpr float along = 0.7f;
    const trees::bark_texture heights =
        smooth ? trees::smooth_bark(number, bark_texels, bark_texels)
               : trees::furrowed_bark(number, bark_texels, bark_texels);
    made.width = heights.width;
    made.height = heights.height;
    made.texels = trees::normal_map(heights, smooth ? 0.006f : 0.025f, around, along);
    made.around = std::clamp(std::round(girth / around), 1.0f, 64.0f);
    made.along = 1 / along;
    return made;
}

/// The species' leaf, brighter or darker than the built-in picture.
material blade_of(std::uint32_t species, trees::leaf_shape shape) {
    constexpr glm::vec3 tints[] = {
        {0.97f, 1.02f, 0.90f}, {1.08f, 1.12f, 0.92f}, {1.02f, 1.06f, 0.98f}, {0.94f, 0.98f, 0.95f}};
    trees::leaf_picture picture = trees::draw_leaf(shape, leaf_texels);
    for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
        if (i % 4 != 3) {
            const float tint = tints[species][static_cast<int>(i % 4)];
            const float value = static_cast<float>(picture.rgba[i]) * tint + 0.5f;
            picture.rgba[i] = static_cast<std::uint8_t>(std::min(value, 255.0f));
        }
    }
    material made;
    made.as = look::leaf;
    made.width = picture.width;
    made.height = picture.height;
    made.texels = std::move(picture.rgba);
    return made;
}

/// How deep a trunk's foot stands in the ground, m: its rim must not come out downhill.
constexpr float sunk = 0.06f;

/// Appends a tree at its place. Segments of one tree follow one another.
result<void> plant(std::vector<trees::segment>& all, const trees::weber_penn_parameters& species,
                   const tree_place& place, const land& ground, std::uint32_t seed) {
    trees::weber_penn_parameters own = species;
    own.scale = place.height;
    auto grown = trees::grow(own, seed);
    if (!grown) {
        return failure(grown.error());
    }
    const glm::vec3 foot = ground.on(place.at.x, place.at.y) - glm::vec3(0, sunk, 0);
    const auto first = static_cast<std::uint32_t>(all.size());
    for (trees::segment each : *grown) {
        each.base += foot;
        each.tip += foot;
        each.parent += each.parent == trees::none ? 0 : first;
        all.push_back(each);
    }
    return {};
}

float girth_of(const trees::skeleton& of) {
    float sum = 0;
    std::size_t roots = 0;
    while (roots < of.size() && of.parent[roots] == trees::none) {
        sum += of.base_radius[roots];
        ++roots;
    }
    return roots == 0 ? 0 : 2 * std::numbers::pi_v<float> * sum / static_cast<float>(roots);
}

} // namespace

result<std::vector<grown_trees>> grow_trees(std::span<const tree_place> places, const land& ground,
                                            std::uint64_t seed) {
    std::vector<grown_trees> all;
    for (std::uint32_t species = 0; species < stand_species.size(); ++species) {
        const trees::weber_penn_parameters parameters = simplified(species);
        std::vector<trees::segment> segments;
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (places[i].species != species) {
                continue;
            }
            const auto own = static_cast<std::uint32_t>(seed * 1009 + i * 31 + 1);
            if (auto done = plant(segments, parameters, places[i], ground, own); !done) {
                return failure(done.error());
            }
        }
        if (segments.empty()) {
            continue;
        }
        auto wood = trees::build_skeleton(segments);
        if (!wood) {
            return failure(wood.error());
        }
        trees::leaf_options blades = blades_of(species);
        blades.seed = static_cast<std::uint32_t>(seed + species);
        grown_trees made;
        made.species = stand_species[species];
        made.leaves = trees::place_leaves(*wood, blades);
        made.bark = bark_of(species, girth_of(*wood), seed);
        made.blade = blade_of(species, blades.shape);
        made.leaf_cover = static_cast<float>(
            trees::leaf_picture{made.blade.width, made.blade.height, made.blade.texels}.cover());
        made.wood = std::move(*wood);
        all.push_back(std::move(made));
    }
    return all;
}

std::vector<leaf> coarse_leaves(std::span<const leaf> leaves, std::size_t count, float cover) {
    std::vector<leaf> chosen;
    const std::size_t n = std::min(count, leaves.size());
    if (n == 0) {
        return chosen;
    }
    const auto area = [](std::span<const leaf> of) {
        double sum = 0;
        for (const leaf& each : of) {
            sum += static_cast<double>(each.width) * static_cast<double>(each.length);
        }
        return sum;
    };
    for (std::size_t i = 0; i < n; ++i) {
        chosen.push_back(leaves[i * leaves.size() / n]);
    }
    const double kept = area(chosen);
    const double wanted = area(leaves) * static_cast<double>(cover);
    const auto larger = static_cast<float>(kept > 0 ? std::sqrt(wanted / kept) : 0);
    for (leaf& each : chosen) {
        each.width *= larger;
        each.length *= larger;
    }
    return chosen;
}

trees::branch_layout thick_branches(const trees::skeleton& of, std::size_t count) {
    trees::branch_layout layout = trees::layout_branches(of, kernels::branch_frame::slerp);
    std::vector<std::uint32_t> order(of.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return of.base_radius[a] > of.base_radius[b];
    });
    order.resize(std::min(count, order.size()));
    std::sort(order.begin(), order.end());
    std::vector<branch_segment> thick;
    for (const std::uint32_t i : order) {
        thick.push_back(layout.segments[i]);
        thick.back().caps = 0;
    }
    layout.segments = std::move(thick);
    return layout;
}

gather_material light_of(const material& of) {
    gather_material made;
    glm::vec3 sum(0);
    glm::vec3 through(0);
    float covered = 0;
    for (std::size_t i = 0; i + 3 < of.texels.size(); i += 4) {
        const auto channel = [&](std::size_t c) {
            return static_cast<float>(of.texels[i + c]) / 255;
        };
        if (of.as == look::bark) {
            sum += glm::mix(of.low, of.high, channel(3));
            covered += 1;
        } else if (channel(3) >= 0.5f) {
            const shared::leaf_surface blade = shared::leaf_surface_of(
                glm::vec4(channel(0), channel(1), channel(2), 1), of.through);
            sum += blade.reflected;
            through += blade.through;
            covered += 1;
        }
    }
    made.diffuse = sum / std::max(covered, 1.0f);
    if (of.as == look::leaf) {
        made.two_sided = 1;
        made.transmission =
            glm::min(through / std::max(covered, 1.0f), glm::vec3(1) - made.diffuse);
    }
    return made;
}

} // namespace skybark::meadow
