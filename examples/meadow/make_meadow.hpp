#pragma once
// The members of meadow<B>, for the files that compile them for a backend.

#include <meadow/land.hpp>
#include <meadow/light.hpp>
#include <meadow/meadow.hpp>
#include <meadow/painter.hpp>
#include <meadow/sky.hpp>
#include <meadow/stand.hpp>
#include <skybark/trees/view_detail.hpp>

#include <cmath>

namespace skybark::meadow {

namespace detail {

/// m: so far wind bends crowns over the edge of where they are at rest.
inline constexpr float bent = 3;

} // namespace detail

/// All that a meadow is made of. Parts refer to the device and to each other: they stay in place.
template <backend B>
struct meadow<B>::parts {
    B& device;
    description what;
    weather now;
    camera from;
    land ground;
    stand<B> growing;
    sky<B> clouds;
    light<B> lit;
    painter<B> paint;
    contents has;
    std::vector<drawable<B>> drawn; ///< in their order, as they never change

    double seconds = 0; ///< of the frame
    double swayed = 0;  ///< s, until when the last sway went
    std::uint32_t steps = 0;
    glm::dvec2 drifted{0}; ///< m, when the weather was last changed
    double changed = 0;    ///< s, when that was

    /// How far clouds have drifted, m.
    [[nodiscard]] glm::dvec2 drift() const {
        return drifted + wind_aloft(now) * (seconds - changed);
    }

    /// Height of the land where the camera is.
    [[nodiscard]] float ground_below() const { return ground.height(from.eye.x, from.eye.z); }

    [[nodiscard]] shadow_box shadows() const {
        return {growing.box().min - detail::bent, growing.box().max + detail::bent};
    }

    void record_sway(typename B::recorder& to) {
        const double step = steps == 0 ? 0 : (seconds - swayed) / steps;
        for (std::uint32_t i = 1; i <= steps; ++i) {
            growing.advance(to, i == steps ? seconds : swayed + i * step, static_cast<float>(step));
        }
        if (steps == 0) {
            growing.advance(to, swayed, 0);
        }
        swayed = std::max(swayed, seconds);
        steps = 0;
    }

    void record_light(typename B::recorder& to) {
        lit.record(to, {scene().sky, clouds.cover()}, {&clouds.sun_volume(), clouds.sun_grid()},
                   [&](typename B::recorder& r, const buffer_view<B>& triangles) {
                       growing.record_light_surfaces(r, triangles, 0);
                   });
    }

    [[nodiscard]] kernels::scene_record scene() const {
        const float aspect = static_cast<float>(what.width) / static_cast<float>(what.height);
        return scene_for(from, ground_below(), now, aspect, shadows(), land::albedo);
    }

    void record_picture(typename B::recorder& to) {
        const kernels::scene_record seen = scene();
        kernels::surroundings_record around{};
        around.clouds = clouds.sun_grid();
        around.gathered = lit.volume().grid();
        around.cloud_shadow = 1;
        around.air = extinction_of_air(now.turbidity);
        const light_sources<B> light{&clouds.sun_volume(), &lit.volume().volume(),
                                     lit.land_irradiance()};
        paint.record(to, seen, around, drawn, light,
                     [&](typename B::recorder& r, const buffer_view<B>& record,
                         const draw_target<B>& target) {
                         clouds.draw_clouds(r, record, glm::vec3(seen.camera), target, around.air);
                     });
    }
};

namespace detail {

/// What a picture of this size can show.
[[nodiscard]] inline trees::view_detail detail_of(const description& what, const camera& from,
                                                  float ground, float coarser) {
    trees::view_detail view;
    view.camera = from.eye + glm::vec3(0, ground, 0);
    view.pixels_per_radian = static_cast<float>(what.height) / (2 * std::tan(from.field / 2));
    view.error *= coarser;
    view.thin *= coarser;
    return view;
}

/// Bytes that the device has in use since it was last asked.
template <backend B>
class bytes_counter {
  public:
    explicit bytes_counter(const B& device) : device_(device), last_(now()) {}
    [[nodiscard]] std::uint64_t more() {
        const std::uint64_t before = std::exchange(last_, now());
        return last_ - before;
    }

  private:
    [[nodiscard]] std::uint64_t now() const {
        if constexpr (requires(const B& d) { d.usage(); }) {
            return device_.usage().bytes;
        } else {
            return 0;
        }
    }
    const B& device_;
    std::uint64_t last_;
};

/// Errors: a description that no meadow can be made of.
[[nodiscard]] inline result<void> check(const description& what, const weather& now,
                                        const camera& from) {
    const auto refuse = [](std::string_view name, const std::string& value,
                           std::string_view expected) -> result<void> {
        return fail(error_code::bad_input, std::string("A meadow's ")
                                               .append(name)
                                               .append(" is ")
                                               .append(value)
                                               .append("; expected ")
                                               .append(expected)
                                               .append("."));
    };
    constexpr std::uint32_t longest = 16384;
    if (what.width == 0 || what.height == 0 || what.width > longest || what.height > longest ||
        what.supersampling == 0 || what.supersampling > 8) {
        return refuse("picture",
                      std::to_string(what.width) + " x " + std::to_string(what.height) +
                          " pixels of " + std::to_string(what.supersampling) + "² samples",
                      "sides from 1 to 16384 and 1 to 8 samples");
    }
    if (!(what.grass >= 0 && what.grass <= 16)) {
        return refuse("grass", std::to_string(what.grass), "0 to 16");
    }
    if (what.cloud_voxels < 4 || what.directions == 0) {
        return refuse("light",
                      std::to_string(what.cloud_voxels) + " voxels and " +
                          std::to_string(what.directions) + " directions",
                      "at least 4 voxels a side and one direction");
    }
    const float place =
        (from.eye.x + from.eye.y + from.eye.z) + (from.target.x + from.target.y + from.target.z);
    if (!std::isfinite(place) || !(from.field > 0.01f && from.field < 3)) {
        return refuse("camera", "nowhere", "finite places and a field of 0.01 to 3 rad");
    }
    const double sum =
        now.sun_azimuth + now.sun_elevation + now.turbidity + static_cast<double>(now.wind_from);
    if (!std::isfinite(sum) || !(now.wind >= 0 && now.wind <= 60) ||
        !(now.cloud >= 0 && now.cloud <= 1)) {
        return refuse("weather",
                      "a wind of " + std::to_string(now.wind) + " m/s under clouds of " +
                          std::to_string(now.cloud),
                      "finite angles, a wind of 0 to 60 m/s and clouds from 0 to 1");
    }
    return {};
}

} // namespace detail

template <backend B>
result<meadow<B>> meadow<B>::create(B& device, const description& what, const weather& now,
                                    const camera& from) {
    if (auto good = detail::check(what, now, from); !good) {
        return failure(good.error());
    }
    contents has;
    detail::bytes_counter<B> bytes(device);
    land ground(what.seed);
    const float below = ground.height(from.eye.x, from.eye.z);
    auto growing =
        stand<B>::create(device, what, ground, now, detail::detail_of(what, from, below, 1));
    if (!growing) {
        return failure(growing.error());
    }
    has.stand_bytes = bytes.more();
    auto clouds = sky<B>::create(device, what, now);
    if (!clouds) {
        return failure(clouds.error());
    }
    has.cloud_bytes = bytes.more();
    std::vector<gather_triangle> surfaces;
    if (auto done = growing->describe_light(device, surfaces); !done) {
        return failure(done.error());
    }
    const std::vector<gather_material> materials = growing->light_materials();
    gather::scene_description meets;
    meets.triangles = surfaces;
    meets.materials = materials;
    meets.box =
        gather::bounds{growing->box().min - detail::bent, growing->box().max + detail::bent};
    light_options gathered;
    gathered.bounces = what.bounces;
    gathered.directions = what.directions;
    gathered.seed = what.seed;
    auto lit = light<B>::create(device, ground, meets, gathered);
    if (!lit) {
        return failure(lit.error());
    }
    has.light_bytes = bytes.more();
    const land_mesh mesh = ground.mesh();
    auto paint =
        painter<B>::create(device, what, growing->materials(), mesh.vertices, mesh.indices);
    if (!paint) {
        return failure(paint.error());
    }
    has.picture_bytes = bytes.more();
    has.trees = growing->trees();
    has.segments = growing->segments();
    has.leaves = growing->leaves();
    has.particles = clouds->capacity();
    has.light_triangles = lit->scene().triangle_count();
    has.light_patches = lit->scene().patch_count();
    has.gather_points = lit->gather_points();
    auto all = std::unique_ptr<parts>(new parts{device,
                                                what,
                                                now,
                                                from,
                                                std::move(ground),
                                                std::move(*growing),
                                                std::move(*clouds),
                                                std::move(*lit),
                                                std::move(*paint),
                                                has,
                                                {}});
    all->growing.for_each_draw([&](const drawable<B>& one) { all->drawn.push_back(one); });
    return meadow(std::move(all));
}

template <backend B>
meadow<B>::meadow(std::unique_ptr<parts> all) : all_(std::move(all)) {}
template <backend B>
meadow<B>::meadow(meadow&&) noexcept = default;
template <backend B>
meadow<B>& meadow<B>::operator=(meadow&&) noexcept = default;
template <backend B>
meadow<B>::~meadow() = default;

template <backend B>
result<void> meadow<B>::change(const weather& now) {
    parts& p = *all_;
    if (auto good = detail::check(p.what, now, p.from); !good) {
        return good;
    }
    p.drifted = p.drift();
    p.changed = p.seconds;
    const bool other_wind = now.wind != p.now.wind || now.wind_from != p.now.wind_from;
    p.now = now;
    return other_wind ? p.growing.set_wind(p.device, now.wind, now.wind_from) : result<void>();
}

template <backend B>
void meadow<B>::look(const camera& from, float detail) {
    parts& p = *all_;
    p.from = from;
    p.growing.look_from(detail::detail_of(p.what, from, p.ground_below(), detail));
}

template <backend B>
void meadow<B>::bounce(std::uint32_t bounces) {
    all_->lit.bounce(bounces);
}

template <backend B>
result<void> meadow<B>::settle(double seconds) {
    constexpr double batch = 0.5; // s that one submission takes
    while (all_->swayed < seconds) {
        begin_frame(std::min(seconds, all_->swayed + batch));
        auto done = run(all_->device, [&](auto& to) { record(to, stage::sway); });
        if (!done) {
            return done;
        }
    }
    return {};
}

template <backend B>
void meadow<B>::begin_frame(double seconds) {
    parts& p = *all_;
    p.seconds = seconds;
    const double more = std::max(0.0, seconds - p.swayed);
    p.steps = static_cast<std::uint32_t>(std::ceil(more / longest_step - 1e-9));
}

template <backend B>
void meadow<B>::record(typename B::recorder& to, stage which) {
    parts& p = *all_;
    switch (which) {
    case stage::sway:
        return p.record_sway(to);
    case stage::mesh:
        return p.growing.mesh(to);
    case stage::clouds:
        return p.clouds.record_moved(to, p.now, p.drift());
    case stage::light:
        return p.record_light(to);
    case stage::draw:
        return p.record_picture(to);
    }
}

template <backend B>
const typename B::image& meadow<B>::picture() const {
    return all_->paint.picture();
}

template <backend B>
result<std::vector<std::uint8_t>> meadow<B>::download() const {
    return all_->paint.download(all_->device);
}

template <backend B>
contents meadow<B>::holds() const {
    return all_->has;
}

template <backend B>
result<std::uint64_t> meadow<B>::triangles() const {
    return all_->growing.triangles(all_->device);
}

template <backend B>
result<bool> meadow<B>::update() {
    const auto grown = all_->growing.update(all_->device);
    if (grown && *grown) {
        all_->drawn.clear();
        all_->growing.for_each_draw([&](const drawable<B>& one) { all_->drawn.push_back(one); });
    }
    return grown;
}

template <backend B>
float meadow<B>::ground(float x, float z) const {
    return all_->ground.height(x, z);
}

template <backend B>
double meadow<B>::seconds() const {
    return all_->seconds;
}

} // namespace skybark::meadow
