#pragma once
// Leaves on a skeleton's last segments.
//
// Source: Akagi and Kitajima, sections 2.1 and 2.4 (leaves sit on the end segments); Weber and
// Penn, "Creation and Rendering of Realistic Trees", SIGGRAPH 1995, section 4.9 and its table
// (Leaves, LeafScale, LeafScaleX); the golden angle of a spiral phyllotaxis.

#include <skybark/core/when_used.hpp>
#include <skybark/trees/leaf_texture.hpp>
#include <skybark/trees/skeleton.hpp>
#include <skybark/trees/species.hpp>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

namespace skybark::trees {

/// How leaves follow one another around a twig.
enum class leaf_arrangement {
    spiral,    ///< 137.5° on
    alternate, ///< left and right in turn, level where the twig is
    opposite,  ///< in pairs, each a quarter turn from the one before
};

/// A twig is a chain of continuing segments up to one without children; leaves grow on its last
/// segment and, further down, as far as `reach` says. Angles in radians.
struct leaf_options {
    leaf_shape shape = leaf_shape::ovate; ///< of the picture
    leaf_arrangement arrangement = leaf_arrangement::spiral;
    float per_metre = 0;           ///< leaves along the leafy part of a twig, and
    float per_twig = 12;           ///< leaves on each besides
    float reach = 0;               ///< m back from the twig's tip; 0: the last segment alone
    float length = 0.08f;          ///< m, of a leaf with its stalk
    float width = 0.7f;            ///< of the length
    float spread = 0.25f;          ///< sizes vary by up to this part
    float down_angle = 0.9f;       ///< between twig and leaf
    float down_angle_v = 0.3f;     ///< ± at random
    float droop = 0.2f;            ///< 0 as they grow … 1 all hang straight down
    float light = 0.6f;            ///< 0: upper faces look along the twig … 1: to the sky
    float disorder = 0.3f;         ///< of the upper faces' directions
    float fold = 0.25f;            ///< how far the halves are folded up, ± a third
    float multiplier = 1;          ///< more and smaller leaves, or fewer and larger: the same area
    std::size_t most = 10'000'000; ///< beyond it they are thinned out evenly
    std::uint32_t seed = 1;
};

namespace detail {

/// The leafy part of a twig: the last `length` metres up to the tip of segment `end`.
struct twig {
    std::uint32_t end = 0;
    float length = 0;
};

template <class = when_used>
class leaf_placer {
  public:
    leaf_placer(const skeleton& on, const leaf_options& options)
        : on_(on), options_(options), random_(options.seed) {}

    [[nodiscard]] std::vector<leaf> place() {
        std::vector<leaf> leaves;
        const std::vector<twig> twigs = find_twigs();
        double wanted = 0;
        for (const twig& t : twigs) {
            wanted += number_on(t);
        }
        if (!(wanted >= 1) || !(size() > 0) || !std::isfinite(size()) || options_.most == 0) {
            return leaves;
        }
        const double kept = std::min(1.0, static_cast<double>(options_.most) / wanted);
        leaves.reserve(static_cast<std::size_t>(std::ceil(wanted * kept)));
        double owed = 0.5; // fractions go on to the next twig
        for (const twig& t : twigs) {
            owed += number_on(t) * kept;
            const double count = std::floor(owed);
            owed -= count;
            const auto n = std::min<std::size_t>(static_cast<std::size_t>(count),
                                                 options_.most - leaves.size());
            fill(t, n, leaves);
        }
        return leaves;
    }

  private:
    static constexpr float pi = 3.14159265358979f;

    [[nodiscard]] static float positive(float value) {
        return value > 0 && std::isfinite(value) ? value : 0.0f;
    }
    [[nodiscard]] float multiplier() const { return positive(options_.multiplier); }
    [[nodiscard]] float size() const { return options_.length / std::sqrt(multiplier()); }

    [[nodiscard]] double number_on(const twig& t) const {
        return (double{positive(options_.per_metre)} * t.length + positive(options_.per_twig)) *
               multiplier();
    }

    /// The segment that segment `i` continues, or `none`.
    [[nodiscard]] std::uint32_t before(std::uint32_t i) const {
        const std::uint32_t p = on_.parent[i];
        return p != none && on_.continuation[p] == i ? p : none;
    }

    [[nodiscard]] std::vector<twig> find_twigs() const {
        std::vector<twig> twigs;
        for (std::uint32_t i = 0; i < on_.size(); ++i) {
            if (on_.child_count[i] != 0) {
                continue;
            }
            float length = on_.length[i];
            for (std::uint32_t s = before(i); s != none && length < options_.reach; s = before(s)) {
                length += on_.length[s];
            }
            twigs.push_back({i, std::min(length, std::max(options_.reach, on_.length[i]))});
        }
        return twigs;
    }

    void fill(const twig& t, std::size_t count, std::vector<leaf>& leaves) {
        const float turn = static_cast<float>(random_.uniform()) * 2 * pi;
        const bool pairs = options_.arrangement == leaf_arrangement::opposite;
        const std::size_t nodes = pairs ? (count + 1) / 2 : count;
        std::uint32_t segment = t.end;
        float above = 0; // m of the twig above this segment's tip
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t node = pairs ? k / 2 : k;
            const float from_tip =
                t.length * (static_cast<float>(node) + 0.35f) / static_cast<float>(nodes);
            while (from_tip > above + on_.length[segment] && before(segment) != none) {
                above += on_.length[segment];
                segment = before(segment);
            }
            const float length = on_.length[segment];
            const float along =
                length > 0 ? std::clamp(1 - (from_tip - above) / length, 0.0f, 1.0f) : 1.0f;
            leaves.push_back(grow(segment, along, azimuth(k, turn), node == 0));
        }
    }

    [[nodiscard]] float azimuth(std::size_t k, float turn) const {
        switch (options_.arrangement) {
        case leaf_arrangement::alternate:
            return pi * static_cast<float>(k % 2);
        case leaf_arrangement::opposite:
            return turn + pi * static_cast<float>(k % 2) + pi / 2 * static_cast<float>(k / 2 % 2);
        default:
            break;
        }
        constexpr double golden = 2.39996322972865332;
        return turn + static_cast<float>(std::fmod(golden * static_cast<double>(k), 2 * pi));
    }

    /// `v`, made perpendicular to unit `d` and of length 1, or `otherwise` if nothing is left.
    [[nodiscard]] static glm::vec3 across(const glm::vec3& v, const glm::vec3& d,
                                          const glm::vec3& otherwise) {
        const glm::vec3 rest = v - d * glm::dot(v, d);
        const float l = glm::length(rest);
        return l > 1e-3f ? rest / l : otherwise;
    }
    [[nodiscard]] static glm::vec3 any_across(const glm::vec3& d) {
        return across(std::abs(d.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1), d,
                      glm::vec3(0, 1, 0));
    }

    [[nodiscard]] leaf grow(std::uint32_t segment, float along, float azimuth, bool last) {
        const glm::vec3 up(0, 1, 0);
        const glm::vec3 axis = on_.orientation[segment] * up;
        const glm::vec3 level = across(glm::cross(up, axis), axis, any_across(axis));
        const glm::vec3 outward =
            level * std::cos(azimuth) + glm::cross(axis, level) * std::sin(azimuth);
        const float radius = glm::mix(on_.base_radius[segment], on_.radius[segment], along);

        const auto vary = [&](float v) { return static_cast<float>(random_.vary(v)); };
        // The twig's last leaf goes on with it.
        const float down =
            (options_.down_angle + vary(options_.down_angle_v)) * (last ? 0.3f : 1.0f);
        const glm::vec3 grown = axis * std::cos(down) + outward * std::sin(down);
        const glm::vec3 hung = glm::mix(grown, -up, std::clamp(options_.droop, 0.0f, 1.0f));
        const glm::vec3 y = glm::length(hung) > 1e-3f ? glm::normalize(hung) : grown;

        const glm::vec3 natural = across(axis, y, across(-outward, y, any_across(y)));
        const glm::vec3 lit = across(up, y, natural);
        const glm::vec3 noise(vary(1), vary(1), vary(1));
        const glm::vec3 z =
            across(glm::mix(natural, lit, options_.light) + options_.disorder * noise, y, natural);

        leaf made;
        made.position =
            on_.position[segment] + axis * (on_.length[segment] * along) + outward * radius;
        made.length = size() * (1 + vary(options_.spread));
        made.width = made.length * options_.width;
        const glm::quat turn = glm::normalize(glm::quat_cast(glm::mat3(glm::cross(y, z), y, z)));
        made.orientation = {turn.x, turn.y, turn.z, turn.w};
        made.fold = options_.fold * (1 + vary(1.0f / 3));
        made.carrier = segment;
        made.seed = random_.next();
        return made;
    }

    const skeleton& on_;
    const leaf_options& options_;
    weber_penn::pcg32 random_;
};

} // namespace detail

/// Leaves on the twigs of a skeleton, twig by twig in the order of their last segments, from each
/// tip down. The same skeleton, options and seed give the same leaves. As many as the twigs call
/// for, at most `options.most`; none where sizes or numbers are not positive.
template <class = when_used>
[[nodiscard]] std::vector<leaf> place_leaves(const skeleton& on, const leaf_options& options) {
    return detail::leaf_placer<>(on, options).place();
}

/// Leaves as Weber and Penn's table has them: so many a stem of the last level, over its length.
template <class = when_used>
[[nodiscard]] leaf_options leaves_of(const weber_penn_parameters& p) {
    leaf_options o;
    o.per_twig = static_cast<float>(std::abs(p.leaves));
    o.length = p.leaf_scale;
    o.width = p.leaf_scale_x;
    o.reach = p.scale;
    for (int n = 0; n < p.levels; ++n) {
        o.reach *= detail::weber_penn::level_of(p, n).length;
    }
    return o;
}

/// Those, with what the table doesn't say of the built-in species. Others get the table's alone.
template <class = when_used>
[[nodiscard]] leaf_options leaves_of(const species_entry& species) {
    leaf_options o = leaves_of(species.parameters);
    if (species.name == "quaking_aspen") {
        o.shape = leaf_shape::round; // on long flat stalks: they hang, and tremble in any air
        o.droop = 0.45f;
        o.light = 0.3f;
        o.disorder = 0.6f;
        o.fold = 0.12f;
    } else if (species.name == "black_tupelo") {
        o.shape = leaf_shape::ovate;
    } else if (species.name == "weeping_willow") {
        o.shape = leaf_shape::lanceolate;
        o.down_angle = 0.5f;
        o.droop = 0.6f;
        o.light = 0.2f;
        o.fold = 0.35f;
    } else if (species.name == "california_black_oak") {
        o.shape = leaf_shape::lobed;
        o.down_angle = 1.0f;
        o.fold = 0.2f;
    }
    return o;
}

/// Fresh leaf in kg/m²: mass per area / dry matter content, 0.067 / 0.35 for broad leaves that are
/// shed (Vile et al. 2005, Annals of Botany 96:1129).
inline constexpr float fresh_leaf_mass = 0.19f;

/// m² of leaves on each of `segments` segments, one side. `cover` is the part of the blade's
/// octagon that the leaf fills (`leaf_picture::cover`). Carriers beyond are left out.
template <class = when_used>
[[nodiscard]] std::vector<float> leaf_area(std::span<const leaf> leaves, std::size_t segments,
                                           float cover = 1) {
    std::vector<float> area(segments, 0.0f);
    for (const leaf& l : leaves) {
        if (l.carrier < segments) {
            area[l.carrier] += l.width * l.length * 0.70710678f * cover;
        }
    }
    return area;
}

/// kg of leaves on each of `segments` segments.
template <class = when_used>
[[nodiscard]] std::vector<float> leaf_mass(std::span<const leaf> leaves, std::size_t segments,
                                           float cover = 1,
                                           float per_square_metre = fresh_leaf_mass) {
    std::vector<float> mass = leaf_area(leaves, segments, cover);
    for (float& m : mass) {
        m *= per_square_metre;
    }
    return mass;
}

} // namespace skybark::trees
