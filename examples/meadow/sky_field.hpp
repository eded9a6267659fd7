#pragma once
// The clouds of the meadow's sky at rest: fair-weather cumulus over a square that repeats, in such
// an order that the first of them are a sky of less cloud.

#include <skybark/clouds/cumulus.hpp>
#include <skybark/clouds/drift.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace skybark::meadow {

struct sky_field_options {
    std::uint64_t seed = 1;
    clouds::drift_box box{{0, 0}, 13000, 5300, 6500}; ///< what they lie in, and go round in
    glm::dvec3 clearing{0, 0, 0}; ///< m, x and z, and a radius: clouds keep out while there is room
    float base = 1050;            ///< m, altitude of the level bases
    float width = 1700;           ///< m, across the largest
    float thickness = 850;        ///< m, of the largest
    float extinction = 0.2f;      ///< 1/m, inside
    std::uint32_t particles_largest = 900; ///< of the largest; others in proportion to their area
    std::uint32_t models = 40;             ///< different clouds; others are these, turned
    float most_cover = 0.8f;
    std::uint32_t most_clouds = 600; ///< no more, covered or not
};

/// Particles cloud after cloud, the middle of each one's cloud, and how much of the sky is covered
/// when a cloud has been added.
struct sky_field {
    struct step {
        std::uint32_t particles = 0; ///< so far
        float cover = 0;             ///< mean of 1 − e^−depth, straight up
    };
    std::vector<cloud_particle> particles;
    std::vector<glm::vec4> middles;
    std::vector<step> steps; ///< from none on; both numbers grow
    clouds::drift_box box;

    /// As many particles as cover a part of the sky: the last cloud may be part of one.
    [[nodiscard]] std::uint32_t count_for(float cover) const {
        const auto above = std::lower_bound(steps.begin(), steps.end(), cover,
                                            [](const step& s, float c) { return s.cover < c; });
        if (above == steps.end()) {
            return static_cast<std::uint32_t>(particles.size());
        }
        if (above == steps.begin()) {
            return 0;
        }
        const step& below = *(above - 1);
        const float part = (cover - below.cover) / (above->cover - below.cover);
        return below.particles + static_cast<std::uint32_t>(
                                     part * static_cast<float>(above->particles - below.particles));
    }
    /// What the first `count` particles cover.
    [[nodiscard]] float cover_of(std::uint32_t count) const {
        const auto above =
            std::lower_bound(steps.begin(), steps.end(), count,
                             [](const step& s, std::uint32_t c) { return s.particles < c; });
        if (above == steps.begin() || above == steps.end()) {
            return steps.empty() || above == steps.begin() ? 0 : steps.back().cover;
        }
        const step& below = *(above - 1);
        const float part = static_cast<float>(count - below.particles) /
                           static_cast<float>(above->particles - below.particles);
        return below.cover + part * (above->cover - below.cover);
    }
};

namespace detail {

/// Optical depths straight up over the square, which repeats.
class repeated_depths {
  public:
    explicit repeated_depths(const clouds::drift_box& box)
        : low_(box.centre - 0.5f * box.side), cell_(box.side / side) {}

    /// A particle's depth is a Gaussian of three sigmas in its radius.
    void add(const cloud_particle& p) {
        const float x = (p.position.x - low_.x) / cell_;
        const float z = (p.position.z - low_.y) / cell_;
        const float radius = p.radius / cell_;
        const float over = -4.5f / (radius * radius);
        for (int j = int(std::ceil(z - radius - 0.5f)); float(j) + 0.5f <= z + radius; ++j) {
            for (int i = int(std::ceil(x - radius - 0.5f)); float(i) + 0.5f <= x + radius; ++i) {
                const float dx = float(i) + 0.5f - x;
                const float dz = float(j) + 0.5f - z;
                const float depth = p.optical_depth * std::exp(over * (dx * dx + dz * dz));
                float& sum = depths_[std::size_t((j & (side - 1)) * side + (i & (side - 1)))];
                light_ += std::exp(-double(sum + depth)) - std::exp(-double(sum));
                sum += depth;
            }
        }
    }
    [[nodiscard]] float cover() const { return 1 - static_cast<float>(light_ / (side * side)); }

  private:
    static constexpr int side = 128;
    glm::vec2 low_;
    float cell_;
    std::vector<float> depths_ = std::vector<float>(side * side);
    double light_ = side * side;
};

/// Of a few random places, the one with the widest gap to the clouds there are (x, z, half the
/// width), also across the border.
[[nodiscard]] inline glm::dvec2 place_between(clouds::detail::cumulus_random& random,
                                              const std::vector<glm::dvec3>& taken, double half,
                                              double side) {
    glm::dvec2 best(0);
    double widest = -1e300;
    for (int candidate = 0; candidate < 12; ++candidate) {
        const glm::dvec2 at(random.between(-0.5, 0.5) * side, random.between(-0.5, 0.5) * side);
        double gap = 1e200;
        for (const glm::dvec3& other : taken) {
            glm::dvec2 d = at - glm::dvec2(other);
            d -= glm::round(d / side) * side;
            gap = std::min(gap, glm::length(d) - half - other.z);
        }
        if (gap > widest) {
            widest = gap;
            best = at;
        }
    }
    return best;
}

/// A cloud that several of the field are turned from.
struct cloud_model {
    double half = 0;                       ///< the width, m
    std::vector<cloud_particle> particles; ///< from the middle of the base
};

/// As in clouds::cumulus_field many are small and few large, but any number of the first has all
/// sizes: rank follows the golden section.
[[nodiscard]] inline std::vector<cloud_model> cloud_models(clouds::detail::cumulus_random& random,
                                                           const sky_field_options& options) {
    std::vector<cloud_model> models(options.models);
    double rank = 0.5;
    for (cloud_model& model : models) {
        rank += 0.6180339887498949;
        rank -= std::floor(rank);
        const double size = 1 / (1 + 3 * rank);
        model.half = 0.5 * size * double{options.width};
        clouds::cumulus_options one;
        one.seed = random.bits();
        one.base = glm::vec3(0);
        one.width = static_cast<float>(2 * model.half);
        one.thickness = static_cast<float>(double{options.thickness} * std::pow(size, 0.8) *
                                           random.between(0.8, 1));
        one.particles = static_cast<std::uint32_t>(
            std::max(40.0, static_cast<double>(options.particles_largest) * size * size));
        one.extinction = options.extinction;
        model.particles = clouds::cumulus_cloud(one);
    }
    return models;
}

} // namespace detail

/// Clouds until `most_cover` is covered. The field fits to itself where it repeats.
[[nodiscard]] inline sky_field make_sky_field(const sky_field_options& options) {
    sky_field field;
    field.box = options.box;
    field.steps.push_back({});
    clouds::detail::cumulus_random random(options.seed);
    const std::vector<detail::cloud_model> models = detail::cloud_models(random, options);
    detail::repeated_depths depths(options.box);
    std::vector<glm::dvec3> taken{options.clearing};
    while (!models.empty() && field.steps.back().cover < options.most_cover &&
           taken.size() <= options.most_clouds) {
        const detail::cloud_model& model = models[taken.size() % models.size()];
        const glm::dvec2 at =
            detail::place_between(random, taken, model.half, double{options.box.side});
        taken.emplace_back(at, model.half);
        const glm::vec3 base(options.box.centre.x + static_cast<float>(at.x), options.base,
                             options.box.centre.y + static_cast<float>(at.y));
        const double turn = random.between(0, 2 * std::numbers::pi);
        const auto c = static_cast<float>(std::cos(turn));
        const auto s = static_cast<float>(std::sin(turn));
        for (cloud_particle p : model.particles) {
            const glm::vec3 from = p.position;
            p.position = base + glm::vec3(c * from.x - s * from.z, from.y, s * from.x + c * from.z);
            depths.add(p);
            field.particles.push_back(p);
            field.middles.emplace_back(base, 0.0f);
        }
        const auto count = static_cast<std::uint32_t>(field.particles.size());
        const float cover = depths.cover();
        if (cover > field.steps.back().cover) {
            field.steps.push_back({count, cover});
        } else {
            field.steps.back().particles = count;
        }
    }
    return field;
}

} // namespace skybark::meadow
