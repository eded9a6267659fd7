#pragma once
// Cases: what samples meet along a bundle of parallel rays, by the backend's own way (fused) and by
// the patterns of gather/bundle_resolver.hpp (composed).
//
// Scenes are of two kinds. In exact ones all coordinates are small multiples of powers of two and
// the bundle lies along an axis, so that single precision rounds nothing and every hit is known to
// the bit. In the others a hit is sought among all triangles in double precision, and where single
// precision may decide either way (a ray that passes an edge, or that begins where another surface
// is) any of the answers is right.

#include <skybark/conformance/buffers.hpp>
#include <skybark/gather/bundle_resolver.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace skybark::conformance {

/// What is resolved. The bundle's grid has as many cells as it says.
struct bundle_scene {
    std::vector<gather_triangle> triangles;
    std::vector<gather_sample> samples;
    std::vector<std::uint32_t> alpha;
    ray_bundle bundle;

    [[nodiscard]] float lift() const { return bundle.right.w; }
    [[nodiscard]] std::uint32_t cells() const {
        return static_cast<std::uint32_t>(bundle.direction.w);
    }
    void add(glm::vec3 a, glm::vec3 b, glm::vec3 c, std::uint32_t alpha_number = 0) {
        triangles.push_back({a, 0, b, alpha_number, c, 0});
    }
    void ask(glm::vec3 position, glm::vec3 normal) { samples.push_back({position, 0, normal, 0}); }
};

/// A bundle along +z over −half … half, all of it powers of two.
[[nodiscard]] inline ray_bundle upright_bundle(float half, std::uint32_t cells, float lift) {
    const auto side = static_cast<float>(cells);
    return {{0, 0, 0, half}, {1, 0, 0, lift}, {0, 1, 0, side / (2 * half)}, {0, 0, 1, side}};
}

// ---- How a scene is resolved

using gather::resolve_route;

/// A resolver and the buffers of a scene, the hits between guards.
template <backend B>
class resolving {
  public:
    resolving(context<B>& c, const bundle_scene& scene, resolve_route route,
              std::uint32_t turns = 60000)
        : c_(c), bundle_(scene.bundle),
          resolver_(c.need(gather::bundle_resolver<B>::create(c.device, scene.triangles.size(),
                                                              {scene.cells(), route, turns}),
                           "bundle_resolver::create")),
          triangles_(c.put(scene.triangles)), samples_(c.put(scene.samples)),
          alpha_(c.put(scene.alpha)), hits_(c.template room<gather_hit>(scene.samples.size())) {}

    [[nodiscard]] bundle_work<B> work() const {
        return {triangles_.view(), alpha_.size == 0 ? buffer_view<B>{} : alpha_.view(),
                samples_.view(), hits_.view()};
    }
    void record(typename B::recorder& r) { resolver_.record(r, bundle_, work()); }
    [[nodiscard]] gather::bundle_resolver<B>& resolver() { return resolver_; }
    [[nodiscard]] std::vector<gather_hit> get() const { return c_.template get<gather_hit>(hits_); }
    [[nodiscard]] std::vector<gather_hit> run() {
        c_.run([&](auto& r) { record(r); });
        return get();
    }

  private:
    context<B>& c_;
    ray_bundle bundle_;
    gather::bundle_resolver<B> resolver_;
    guarded<B> triangles_;
    guarded<B> samples_;
    guarded<B> alpha_;
    guarded<B> hits_;
};

// ---- What is met, in double precision

[[nodiscard]] inline glm::dvec3 across(const ray_bundle& bundle, glm::dvec3 place) {
    const glm::dvec3 p = place - glm::dvec3(glm::vec3(bundle.centre));
    return {glm::dot(p, glm::dvec3(glm::vec3(bundle.right))),
            glm::dot(p, glm::dvec3(glm::vec3(bundle.up))),
            glm::dot(p, glm::dvec3(glm::vec3(bundle.direction)))};
}

/// A sample's ray across the bundle.
struct exact_ray {
    glm::dvec3 origin{0};
    double side = 1; ///< +1 along the bundle, −1 against it

    exact_ray(const ray_bundle& bundle, const gather_sample& s)
        : origin(across(bundle,
                        glm::dvec3(s.position) + double{bundle.right.w} * glm::dvec3(s.normal))),
          side(glm::dot(glm::dvec3(s.normal), glm::dvec3(glm::vec3(bundle.direction))) >= 0 ? 1
                                                                                            : -1) {}
};

/// A triangle across the bundle, as a ray at (x, y) finds it.
struct exact_meeting {
    std::array<glm::dvec3, 3> corners;
    double area = 0;                ///< twice the area; > 0: the front looks along the bundle
    std::array<double, 3> weight{}; ///< of the corners, where there is an area
    double depth = 0;

    exact_meeting(const ray_bundle& bundle, const gather_triangle& t, const exact_ray& ray)
        : corners{across(bundle, t.a), across(bundle, t.b), across(bundle, t.c)} {
        const auto turn = [](glm::dvec2 u, glm::dvec2 v) { return u.x * v.y - u.y * v.x; };
        std::array<glm::dvec2, 3> from;
        for (std::size_t k = 0; k < 3; ++k) {
            from[k] = glm::dvec2(corners[k]) - glm::dvec2(ray.origin);
        }
        area = turn(from[1] - from[0], from[2] - from[0]);
        if (!std::isfinite(area)) {
            area = 0;
        }
        for (std::size_t k = 0; k < 3 && area != 0; ++k) {
            weight[k] = turn(from[(k + 1) % 3], from[(k + 2) % 3]) / area;
            depth += weight[k] * corners[k].z;
        }
    }
    [[nodiscard]] bool is_inside() const {
        return area != 0 && std::min({weight[0], weight[1], weight[2]}) >= 0;
    }
    [[nodiscard]] bool is_back(const exact_ray& ray) const { return ray.side * area > 0; }
    /// From the origin on; below zero where the surface counts though it is a little behind.
    [[nodiscard]] double distance(const exact_ray& ray) const {
        return ray.side * (depth - ray.origin.z);
    }
};

/// Whether there is a hole where these weights are: the nearest texel of a map that repeats.
[[nodiscard]] inline bool exact_hole(const bundle_scene& scene, const gather_triangle& t,
                                     const std::array<double, 3>& weight) {
    if (t.alpha == 0) {
        return false;
    }
    alpha_coordinates at;
    std::memcpy(static_cast<void*>(&at), &scene.alpha[12 * (std::size_t{t.alpha} - 1)], sizeof at);
    const glm::dvec2 place =
        weight[0] * glm::dvec2(at.a) + weight[1] * glm::dvec2(at.b) + weight[2] * glm::dvec2(at.c);
    const glm::dvec2 sides(at.size % 65536, at.size / 65536);
    const glm::dvec2 texel = glm::floor((place - glm::floor(place)) * sides);
    const auto word = at.map + static_cast<std::size_t>(texel.y * sides.x + texel.x);
    return std::bit_cast<float>(scene.alpha[word]) < at.cutoff;
}

/// What a sample of an exact scene meets.
[[nodiscard]] inline gather_hit exact_hit(const bundle_scene& scene, const gather_sample& sample) {
    const exact_ray ray(scene.bundle, sample);
    gather_hit best;
    for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
        const exact_meeting met(scene.bundle, scene.triangles[t], ray);
        const double least = (met.is_back(ray) ? 0.5 : -0.5) * double{scene.lift()};
        const double distance = std::max(met.distance(ray), 0.0);
        if (met.is_inside() && met.distance(ray) > least && distance < double{best.distance} &&
            !exact_hole(scene, scene.triangles[t], met.weight)) {
            best = {static_cast<float>(distance), 2 * t + (met.is_back(ray) ? 1u : 0u),
                    static_cast<float>(met.weight[1]), static_cast<float>(met.weight[2])};
        }
    }
    return best;
}

template <backend B>
void expect_same_hits(const context<B>& c, const std::vector<gather_hit>& actual,
                      const std::vector<gather_hit>& expected, const char* what) {
    comparison check = c.compare(what);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        check.same(actual[i].surface, expected[i].surface);
        check.same(double{actual[i].distance}, double{expected[i].distance});
        check.same(double{actual[i].u}, double{expected[i].u});
        check.same(double{actual[i].v}, double{expected[i].v});
    }
}

/// Every hit of an exact scene, to the bit.
template <backend B>
void expect_exact_hits(const context<B>& c, const bundle_scene& scene,
                       const std::vector<gather_hit>& actual) {
    std::vector<gather_hit> expected;
    for (const gather_sample& sample : scene.samples) {
        expected.push_back(exact_hit(scene, sample));
    }
    expect_same_hits(c, actual, expected, "surface, distance, u and v of a hit");
}
template <backend B>
void resolve_exactly(context<B>& c, const bundle_scene& scene, resolve_route route,
                     std::uint32_t turns = 60000) {
    expect_exact_hits(c, scene, resolving<B>(c, scene, route, turns).run());
}

/// An answer that may be right, and how far it may be off.
struct likely_hit {
    std::uint32_t triangle = 0;
    bool back = false;
    bool is_certain = false; ///< it is met for sure: only nearer ones may be right as well
    bool is_flat = false;    ///< which side is seen, and at which weights, is known
    double nearest = 0;
    double farthest = 0;
    double u = 0;
    double v = 0;
    double weight_tolerance = 0;
};

/// How far single precision may be off. A place across a bundle has passed through a difference,
/// three products and two sums, and an origin through a product and a sum before: each rounds by
/// 2^-24 of what is at most the scene's reach, and eight of them are more than enough.
[[nodiscard]] inline double place_tolerance(const bundle_scene& scene) {
    double reach = double{scene.bundle.centre.w};
    const glm::dvec3 centre(glm::vec3(scene.bundle.centre));
    const auto reach_to = [&](glm::dvec3 p) {
        const double length = std::max(glm::length(p), glm::length(p - centre));
        reach = std::isfinite(length) ? std::max(reach, length) : reach;
    };
    for (const gather_triangle& t : scene.triangles) {
        reach_to(t.a);
        reach_to(t.b);
        reach_to(t.c);
    }
    for (const gather_sample& s : scene.samples) {
        reach_to(s.position);
    }
    return 8 * 0x1p-24 * reach;
}

/// Whether, and how, a ray may meet a triangle, if places are off by `delta`.
[[nodiscard]] inline std::optional<likely_hit>
may_meet(const bundle_scene& scene, std::uint32_t number, const exact_ray& ray, double delta) {
    const gather_triangle& t = scene.triangles[number];
    const exact_meeting met(scene.bundle, t, ray);
    double reach = 0;   // of the corners from the ray
    double longest = 0; // edge
    double beside = 0;  // how far the ray is from its line
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 corner = glm::dvec2(met.corners[k]) - glm::dvec2(ray.origin);
        const glm::dvec2 next = glm::dvec2(met.corners[(k + 1) % 3]) - glm::dvec2(ray.origin);
        const double edge = glm::length(next - corner);
        reach = std::max(reach, glm::length(corner));
        if (edge > longest) {
            longest = edge;
            beside = std::fabs(corner.x * next.y - corner.y * next.x) / edge;
        }
    }
    // Of two corners in one place, the edges are exactly opposite: there is no area.
    if (!std::isfinite(reach + longest) || t.a == t.b || t.b == t.c || t.c == t.a) {
        return std::nullopt;
    }
    const auto [low, high] = std::minmax({met.corners[0].z, met.corners[1].z, met.corners[2].z});
    likely_hit hit;
    hit.triangle = number;
    hit.back = met.is_back(ray);
    const double margin = 4 * delta;
    hit.is_flat = std::fabs(met.area) > 2 * margin * longest; // it is higher than its edges' noise
    if (!hit.is_flat) {
        const glm::dvec2 at(ray.origin);
        const glm::dvec2 a(glm::min(met.corners[0], glm::min(met.corners[1], met.corners[2])));
        const glm::dvec2 b(glm::max(met.corners[0], glm::max(met.corners[1], met.corners[2])));
        // Rounding widens it by the margin, and by the slack that the formula allows itself.
        const double slack = margin + 2e-6 * double{scene.bundle.centre.w};
        if (beside > margin || at.x < a.x - slack || at.y < a.y - slack || at.x > b.x + slack ||
            at.y > b.y + slack) {
            return std::nullopt;
        }
        hit.nearest = ray.side * ((ray.side > 0 ? low : high) - ray.origin.z) - margin;
        hit.farthest = ray.side * ((ray.side > 0 ? high : low) - ray.origin.z) + margin;
        return hit.farthest > -0.5 * double{scene.lift()} ? std::optional(hit) : std::nullopt;
    }
    // Distances from the edges' lines: a weight is the distance from an edge in heights over it.
    double inside = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const double edge = glm::length(glm::dvec2(met.corners[(k + 1) % 3]) -
                                        glm::dvec2(met.corners[(k + 2) % 3]));
        inside = std::min(inside, met.weight[k] * std::fabs(met.area) / edge);
    }
    if (inside < -margin) {
        return std::nullopt;
    }
    // Products of two distances from the ray, off by `delta` each and by rounding, over the area.
    hit.weight_tolerance =
        (4 * delta * reach + 6 * 0x1p-24 * reach * reach) / std::fabs(met.area) + 0x1p-22;
    const double tolerance = 2 * margin + 3 * hit.weight_tolerance * (high - low);
    const double distance = met.distance(ray);
    const double beyond = distance - (hit.back ? 0.5 : -0.5) * double{scene.lift()};
    if (beyond < -tolerance) {
        return std::nullopt;
    }
    hit.is_certain = inside > margin && beyond > tolerance;
    hit.nearest = distance - tolerance;
    hit.farthest = distance + tolerance;
    hit.u = met.weight[1];
    hit.v = met.weight[2];
    return hit;
}

/// All answers that may be right; none of them certain: nothing may be met as well.
[[nodiscard]] inline std::vector<likely_hit>
likely_hits(const bundle_scene& scene, const gather_sample& sample, double delta) {
    const exact_ray ray(scene.bundle, sample);
    std::vector<likely_hit> all;
    double farthest = std::numeric_limits<double>::infinity();
    for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
        if (const auto hit = may_meet(scene, t, ray, delta)) {
            all.push_back(*hit);
            farthest = hit->is_certain ? std::min(farthest, hit->farthest) : farthest;
        }
    }
    std::erase_if(all, [&](const likely_hit& hit) { return hit.nearest > farthest; });
    return all;
}

/// Every hit is one that may be right, and at least `certain` in a hundred are the only such ones.
template <backend B>
void expect_likely_hits(context<B>& c, const bundle_scene& scene,
                        const std::vector<gather_hit>& actual, std::size_t certain) {
    const double delta = place_tolerance(scene);
    std::size_t known = 0;
    comparison surfaces = c.compare("surface of a hit");
    comparison distances = c.compare("distance, u and v of a hit");
    for (std::size_t i = 0; i < scene.samples.size(); ++i) {
        const auto likely = likely_hits(scene, scene.samples[i], delta);
        const bool is_met = std::any_of(likely.begin(), likely.end(),
                                        [](const likely_hit& hit) { return hit.is_certain; });
        known += likely.size() == (is_met ? 1u : 0u) ? 1 : 0;
        if (!is_met && actual[i].surface == no_surface) {
            distances.same(double{actual[i].distance}, double{no_distance});
            continue;
        }
        const auto found = std::find_if(likely.begin(), likely.end(), [&](const likely_hit& hit) {
            const std::uint32_t back = hit.back ? 1 : 0;
            return hit.triangle == actual[i].surface / 2 &&
                   (!hit.is_flat || actual[i].surface % 2 == back);
        });
        if (found == likely.end()) {
            surfaces.same(actual[i].surface, likely.empty()
                                                 ? double{no_surface}
                                                 : 2.0 * likely[0].triangle + likely[0].back);
            continue;
        }
        surfaces.same(actual[i].surface, actual[i].surface);
        distances.within(double{actual[i].distance}, std::max(found->nearest, 0.0),
                         std::max(found->farthest, 0.0));
        if (found->is_flat) {
            distances.close_to(double{actual[i].u}, found->u, found->weight_tolerance);
            distances.close_to(double{actual[i].v}, found->v, found->weight_tolerance);
        }
    }
    if (known * 100 < scene.samples.size() * certain) {
        context<B>::stop("The case knows too few of its hits: " + std::to_string(known));
    }
}

// ---- Scenes

/// 0 … 1, in ten thousand steps.
template <backend B>
[[nodiscard]] double unit(context<B>& c) {
    return c.below(10001) / 10000.0;
}
template <backend B>
[[nodiscard]] glm::dvec3 unit_place(context<B>& c) {
    const double x = 2 * unit(c) - 1;
    const double y = 2 * unit(c) - 1;
    return {x, y, 2 * unit(c) - 1};
}
template <backend B>
[[nodiscard]] glm::dvec3 unit_direction(context<B>& c) {
    while (true) {
        const glm::dvec3 p = unit_place(c);
        const double length = glm::length(p);
        if (length > 0.1 && length < 1) {
            return p / length;
        }
    }
}

/// Triangles of all sizes around one another in a box, and samples anywhere, a few of them outside.
template <backend B>
[[nodiscard]] bundle_scene random_scene(context<B>& c, std::uint32_t triangles,
                                        std::uint32_t samples, glm::dvec3 middle = {}) {
    bundle_scene scene;
    gather::bounds box;
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const glm::dvec3 at = middle + unit_place(c);
        const double size = std::pow(2.0, -1.0 - c.below(6));
        const auto corner = [&] { return glm::vec3(at + size * unit_place(c)); };
        const glm::vec3 a = corner();
        const glm::vec3 b = corner();
        scene.add(a, b, corner());
        box.add(a);
        box.add(b);
        box.add(scene.triangles.back().c);
    }
    for (std::uint32_t i = 0; i < samples; ++i) {
        const double spread = i % 10 == 0 ? 2.5 : 1.0;
        const glm::vec3 position(middle + spread * unit_place(c));
        scene.ask(position, glm::vec3(unit_direction(c)));
    }
    scene.bundle = gather::make_bundle(box, unit_direction(c), gather::default_cells(triangles),
                                       gather::default_lift(box));
    return scene;
}

template <backend B>
void resolve_random(context<B>& c, resolve_route route, std::uint32_t triangles,
                    glm::dvec3 middle) {
    for (int turn = 0; turn < 3; ++turn) {
        const bundle_scene scene = random_scene(c, triangles, 250, middle);
        expect_likely_hits(c, scene, resolving<B>(c, scene, route).run(), 90);
    }
}

/// So many triangles side by side, and as many samples, the first of them below the last triangle.
template <backend B>
void resolve_sizes(context<B>& c, resolve_route route) {
    for (const std::uint32_t triangles : {0u, 1u, 2u, 63u, 64u, 65u, 257u}) {
        for (const std::uint32_t samples : {0u, 1u, 64u, 65u, 300u}) {
            bundle_scene scene;
            scene.bundle = upright_bundle(16, gather::default_cells(triangles), 0x1p-10f);
            const auto corner = [](std::uint32_t i) {
                return glm::vec3(i % 32, i / 32, i % 3) - glm::vec3(16, 16, 0);
            };
            for (std::uint32_t i = 0; i < triangles; ++i) {
                const glm::vec3 p = corner(i);
                scene.add(p, p + glm::vec3(0.5f, 0, 0), p + glm::vec3(0, 0.5f, 0));
            }
            for (std::uint32_t i = 0; i < samples; ++i) { // some of them beyond the first
                const std::uint32_t above = triangles - 1 - i % (triangles + 3);
                const glm::vec3 p = corner(above) + glm::vec3(0.125f, 0.125f, 0);
                const float up = i % 2 == 0 ? 1.0f : -1.0f;
                scene.ask({p.x, p.y, -5 * up}, {0, 0, up});
            }
            resolve_exactly(c, scene, route);
        }
    }
}

inline void add_square(bundle_scene& to, float half, float z, bool turned) {
    const std::array<glm::vec3, 4> p{
        glm::vec3{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
    to.add(p[0], p[turned ? 2 : 1], p[turned ? 1 : 2]);
    to.add(p[0], p[turned ? 3 : 2], p[turned ? 2 : 3]);
}

/// Squares above one another, in no order and wound either way, and samples between them that look
/// up and down; a sample that looks across the bundle looks along it.
template <backend B>
void resolve_planes(context<B>& c, resolve_route route) {
    bundle_scene scene;
    scene.bundle = upright_bundle(16, 8, 0x1p-10f);
    for (const int k : {3, -4, 0, 5, -1, 4, -6, 2, 1, -3}) {
        add_square(scene, 8, static_cast<float>(k), k % 2 == 0);
    }
    const std::array<glm::vec3, 4> normals{glm::vec3{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
    for (std::uint32_t i = 0; i < 400; ++i) {
        const auto place = [&] { return static_cast<float>(c.below(73)) / 4 - 9; };
        const float x = place();
        const float y = place();
        scene.ask({x, y, static_cast<float>(c.below(15)) - 7.25f}, normals[i % 4]);
    }
    resolve_exactly(c, scene, route);
}

/// Samples on surfaces: a lift keeps them off their own, and they see what touches it.
template <backend B>
void resolve_own_surface(context<B>& c, resolve_route route) {
    bundle_scene scene;
    scene.bundle = upright_bundle(16, 4, 0x1p-10f);
    add_square(scene, 8, 0, false);
    add_square(scene, 8, 2, true);
    add_square(scene, 8, 2 + 0x1p-9f, false); // two lifts above: its back is seen from below
    add_square(scene, 8, 4 + 0x1p-11f, true); // half a lift above a sample: where it begins
    for (const float z : {0.0f, 2.0f, 2 + 0x1p-9f, 4.0f}) {
        for (const float up : {1.0f, -1.0f}) {
            scene.ask({1, 2.5f, z}, {0, 0, up});
            scene.ask({-3.25f, 5, z}, {0, 0, up});
        }
    }
    resolve_exactly(c, scene, route);
}

/// A mesh of squares cut in two, seen by rays through its corners, edges and middles: the triangle
/// of the lowest number counts, and none is lost.
template <backend B>
void resolve_shared_edges(context<B>& c, resolve_route route) {
    bundle_scene scene;
    scene.bundle = upright_bundle(16, 8, 0x1p-10f);
    std::vector<std::array<glm::vec3, 3>> all;
    for (int y = -8; y < 8; y += 2) {
        for (int x = -8; x < 8; x += 2) {
            const auto corner = [&](int i, int j) {
                const glm::vec2 p(x + 2 * i, y + 2 * j);
                return glm::vec3(p.x, p.y, p.x / 4);
            };
            all.push_back({corner(0, 0), corner(1, 0), corner(0, 1)});
            all.push_back({corner(1, 1), corner(1, 0), corner(0, 1)}); // the other way round
        }
    }
    std::shuffle(all.begin(), all.end(), c.random);
    for (const auto& t : all) {
        scene.add(t[0], t[1], t[2]);
    }
    for (int y = -17; y <= 17; ++y) {
        for (int x = -17; x <= 17; ++x) {
            const glm::vec2 p = 0.5f * glm::vec2(x, y);
            scene.ask({p.x, p.y, -6}, {0, 0, 1});
            scene.ask({p.x, p.y, 6}, {0, 0, -1});
        }
    }
    resolve_exactly(c, scene, route);
}

/// A ball of triangles around the origin: an octahedron whose faces have been divided.
struct ball {
    std::vector<glm::vec3> corners;
    std::vector<std::array<std::uint32_t, 3>> faces;

    explicit ball(int divisions) {
        corners = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
        faces = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                 {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
        for (int i = 0; i < divisions; ++i) {
            divide();
        }
    }

  private:
    void divide() {
        std::vector<std::array<std::uint32_t, 3>> finer;
        std::vector<std::array<std::uint32_t, 3>> middles; // of an edge: its ends, and the corner
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [low, high] = std::minmax(a, b);
            for (const auto& m : middles) {
                if (m[0] == low && m[1] == high) {
                    return m[2];
                }
            }
            const auto made = static_cast<std::uint32_t>(corners.size());
            corners.push_back(glm::normalize(corners[a] + corners[b]));
            middles.push_back({low, high, made});
            return made;
        };
        for (const auto& f : faces) {
            const std::uint32_t ab = middle(f[0], f[1]);
            const std::uint32_t bc = middle(f[1], f[2]);
            const std::uint32_t ca = middle(f[2], f[0]);
            finer.push_back({f[0], ab, ca});
            finer.push_back({ab, f[1], bc});
            finer.push_back({ca, bc, f[2]});
            finer.push_back({ab, bc, ca});
        }
        faces = std::move(finer);
    }
};

/// From inside a closed surface no ray gets out, though rays are aimed at its corners and edges
/// from any direction.
template <backend B>
void resolve_watertight(context<B>& c, resolve_route route) {
    const ball around(3);
    for (int turn = 0; turn < 4; ++turn) {
        bundle_scene scene;
        gather::bounds box;
        for (const auto& f : around.faces) {
            scene.add(around.corners[f[0]], around.corners[f[1]], around.corners[f[2]]);
        }
        for (const glm::vec3 p : around.corners) {
            box.add(p);
        }
        scene.bundle =
            gather::make_bundle(box, unit_direction(c), gather::default_cells(512), 1e-5f);
        const glm::vec3 along(scene.bundle.direction);
        const auto aim = [&](glm::vec3 at) {
            const float side = glm::dot(at, along) >= 0 ? 1.0f : -1.0f;
            const float deep = std::fabs(glm::dot(at, along));
            if (deep > 0.2f) { // else it would begin outside
                scene.ask(at - side * deep * along, side * along);
            }
        };
        for (const glm::vec3 p : around.corners) {
            aim(p);
        }
        for (const auto& f : around.faces) {
            for (std::size_t k = 0; k < 3; ++k) {
                const glm::vec3 a = around.corners[f[k]];
                const glm::vec3 b = around.corners[f[(k + 1) % 3]];
                aim(a + 0.5f * (b - a));
                aim(a + 0.3f * (b - a));
            }
        }
        const auto hits = resolving<B>(c, scene, route).run();
        comparison check = c.compare("how far from the middle a ray meets a ball, m");
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const gather_sample& s = scene.samples[i];
            const glm::dvec3 at =
                glm::dvec3(s.position) + double{hits[i].distance} * glm::dvec3(s.normal);
            // The middle of a face lies deepest: its edges span up to 0.29 rad.
            check.within(hits[i].surface == no_surface ? 2 : glm::length(at), 0.96, 1.001);
        }
    }
}

/// Samples on the walls, edges and corners of a box: rays end at the wall where they leave it, and
/// where that is one that the sample touches, at once. Only a ray that begins where two other walls
/// meet and leaves through one of them runs along the box's outline: it may pass on either side.
template <backend B>
void resolve_box_corners(context<B>& c, resolve_route route) {
    for (int turn = 0; turn < 6; ++turn) {
        bundle_scene scene;
        gather::bounds box;
        const std::array<glm::vec3, 2> ends{glm::vec3(-1), glm::vec3(1)};
        box.add(ends[0]);
        box.add(ends[1]);
        for (int axis = 0; axis < 3; ++axis) {
            for (const float wall : {-1.0f, 1.0f}) { // its number: 2 · axis + (wall > 0)
                const auto corner = [&](float s, float t) {
                    glm::vec3 p(wall);
                    p[(axis + 1) % 3] = -wall * s;
                    p[(axis + 2) % 3] = t;
                    return p;
                };
                scene.add(corner(-1, -1), corner(1, -1), corner(1, 1)); // fronts look inwards
                scene.add(corner(-1, -1), corner(1, 1), corner(-1, 1));
            }
        }
        glm::dvec3 axis = unit_direction(c);
        while (std::min({std::fabs(axis.x), std::fabs(axis.y), std::fabs(axis.z)}) < 0.25) {
            axis = unit_direction(c);
        }
        scene.bundle = gather::make_bundle(box, axis, 4, gather::default_lift(box));
        for (const float x : {-1.0f, 0.25f, 1.0f}) {
            for (const float y : {-1.0f, 0.25f, 1.0f}) {
                for (const float z : {-1.0f, 0.25f, 1.0f}) {
                    for (int k = 0; k < 3; ++k) {
                        const glm::vec3 place(x, y, z);
                        glm::vec3 normal(0);
                        normal[k] = -place[k];
                        if (std::fabs(place[k]) == 1) {
                            scene.ask(place, normal);
                        }
                    }
                }
            }
        }
        const auto hits = resolving<B>(c, scene, route).run();
        comparison check = c.compare("distance to the wall of a box, and what is left to the wall "
                                     "that is named, and its side");
        // Off by what rounding makes on a wall that is seen at a quarter: 4 · place_tolerance.
        const double tolerance = 4 * 2 * place_tolerance(scene);
        const glm::dvec3 along(glm::vec3(scene.bundle.direction));
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const gather_sample& s = scene.samples[i];
            const glm::dvec3 from =
                glm::dvec3(s.position) + double{scene.lift()} * glm::dvec3(s.normal);
            const glm::dvec3 ray = glm::dot(glm::dvec3(s.normal), along) >= 0 ? along : -along;
            const glm::dvec3 left = (glm::sign(ray) - from) / ray; // to each axis' wall
            const double out = std::min({left.x, left.y, left.z});
            int touched = 0;
            int left_through = 0;
            for (int k = 0; k < 3; ++k) {
                const bool touches = std::fabs(s.position[k]) == 1 && s.normal[k] == 0;
                touched += touches ? 1 : 0;
                left_through += touches && ray[k] * double{s.position[k]} > 0 ? 1 : 0;
            }
            if (touched == 2 && left_through == 1) {
                continue;
            }
            check.close_to(double{hits[i].distance}, out, tolerance);
            const bool is_wall = hits[i].surface / 2 < scene.triangles.size();
            const auto wall = static_cast<int>(is_wall ? hits[i].surface / 4 : 0);
            check.close_to(is_wall ? left[wall / 2] : no_distance, out, tolerance);
            check.same(is_wall && (ray[wall / 2] > 0) == (wall % 2 == 1) ? hits[i].surface % 2 : 1,
                       0);
        }
    }
}

/// A map of holes, its coordinates and its texels, at the end of the words.
inline void add_alpha(bundle_scene& to, const alpha_coordinates& at) {
    const std::size_t words = to.alpha.size();
    to.alpha.resize(words + 12);
    std::memcpy(&to.alpha[words], &at, sizeof at);
}

/// Two maps in one buffer, with their places turned, repeated and beyond 0…1; behind them, and
/// where they have holes, is a plane.
template <backend B>
void resolve_alpha(context<B>& c, resolve_route route) {
    bundle_scene scene;
    scene.bundle = upright_bundle(16, 4, 0x1p-10f);
    const auto coordinates = [](glm::vec2 a, glm::vec2 b, glm::vec2 third, std::uint32_t map,
                                std::uint32_t size, float cutoff) {
        alpha_coordinates made;
        made.a = a;
        made.b = b;
        made.c = third;
        made.map = map;
        made.size = size;
        made.cutoff = cutoff;
        return made;
    };
    const std::uint32_t first = 4 * 12;
    const std::uint32_t second = first + 4 * 2;
    add_alpha(scene, coordinates({0, 0}, {1, 0}, {1, 1}, first, 4 + 65536 * 2, 0.5f));
    add_alpha(scene, coordinates({0, 0}, {1, 1}, {0, 1}, first, 4 + 65536 * 2, 0.5f));
    add_alpha(scene, coordinates({-3, 2}, {-3, 4}, {1, 4}, second, 8 + 65536 * 8, 0.25f));
    add_alpha(scene, coordinates({-3, 2}, {1, 4}, {1, 2}, second, 8 + 65536 * 8, 0.25f));
    for (const float opacity : {1.0f, 0.0f, 0.5f, 0.4375f, 0.0f, 1.0f, 0.25f, 0.75f}) {
        scene.alpha.push_back(std::bit_cast<std::uint32_t>(opacity));
    }
    for (int i = 0; i < 64; ++i) {
        const float opacity = static_cast<float>(c.below(5)) / 8;
        scene.alpha.push_back(std::bit_cast<std::uint32_t>(opacity));
    }
    add_square(scene, 8, 1, false);
    add_square(scene, 8, 2, false);
    add_square(scene, 8, 3, true);
    for (std::uint32_t i = 0; i < 4; ++i) {
        scene.triangles[i].alpha = i + 1;
    }
    for (int y = -31; y < 32; y += 2) { // off the edges of all texels
        for (int x = -31; x < 32; x += 2) {
            const bool below = (x + y) % 4 == 0;
            const glm::vec2 p = 0.25f * glm::vec2(x, y);
            scene.ask({p.x, p.y, below ? 0.0f : 2.5f}, {0, 0, below ? 1 : -1});
        }
    }
    resolve_exactly(c, scene, route);
}

/// Of triangles in one place, and wound either way, the one of the lowest number counts.
template <backend B>
void resolve_duplicates(context<B>& c, resolve_route route) {
    bundle_scene scene;
    scene.bundle = upright_bundle(16, 8, 0x1p-10f);
    for (int i = 0; i < 60; ++i) {
        const float size = i % 3 == 0 ? 8.0f : 4.0f; // in another grid, and in one plane with it
        add_square(scene, size, 1, i % 4 < 2);
    }
    std::shuffle(scene.triangles.begin(), scene.triangles.end(), c.random);
    for (int y = -9; y <= 9; ++y) {
        for (int x = -9; x <= 9; ++x) {
            const float up = (x + y) % 2 == 0 ? 1.0f : -1.0f;
            scene.ask({static_cast<float>(x), static_cast<float>(y), 1 - up}, {0, 0, up});
        }
    }
    resolve_exactly(c, scene, route);
}

/// Triangles without an area and corners that are no numbers are not there; the others keep their
/// numbers.
template <backend B>
void resolve_degenerate(context<B>& c, resolve_route route) {
    bundle_scene scene = random_scene(c, 400, 300);
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float inf = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < scene.triangles.size(); i += 3) {
        gather_triangle& t = scene.triangles[i];
        const auto axis = static_cast<int>(i / 3 % 3);
        switch (i / 9 % 6) {
        case 0:
            t.b = t.a;
            break;
        case 1:
            t.b = t.a;
            t.c = t.a;
            break;
        case 2:
            t.a[axis] = nan;
            break;
        case 3:
            t.b[axis] = inf;
            break;
        case 4:
            t.c[axis] = -inf;
            break;
        default:
            t.a = glm::vec3(nan);
            t.b = t.a;
            t.c = t.a;
            break;
        }
    }
    expect_likely_hits(c, scene, resolving<B>(c, scene, route).run(), 90);
}

/// Samples whose place or normal is no number meet nothing; those between them what they would.
template <backend B>
void resolve_no_numbers(context<B>& c, resolve_route route) {
    bundle_scene scene;
    scene.bundle = upright_bundle(16, 4, 0x1p-10f);
    for (int k = 0; k < 8; ++k) {
        add_square(scene, 8, static_cast<float>(k), k % 2 == 0);
    }
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    for (int i = 0; i < 200; ++i) {
        const float up = i % 2 == 0 ? 1.0f : -1.0f;
        scene.ask(glm::vec3(i % 7, i % 5, i % 8) - glm::vec3(3, 2.5f, 0.5f), {0, 0, up});
        gather_sample& s = scene.samples.back();
        const std::array<float, 3> wrong{nan, inf, -inf};
        if (i % 3 == 1) {
            s.position[i / 3 % 3] = wrong[static_cast<std::size_t>(i / 9 % 3)];
        } else if (i % 3 == 2) {
            s.normal[i / 3 % 3] = nan;
        }
    }
    const auto hits = resolving<B>(c, scene, route).run();
    comparison check = c.compare("surface and distance of a hit");
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const gather_hit expected = i % 3 == 0 ? exact_hit(scene, scene.samples[i]) : gather_hit{};
        check.same(hits[i].surface, expected.surface);
        check.same(double{hits[i].distance}, double{expected.distance});
    }
}

/// More triangles in one cell than a pass looks at, all above one another.
template <backend B>
void resolve_crowd(context<B>& c, resolve_route route, std::uint32_t triangles,
                   std::uint32_t samples, std::uint32_t turns) {
    bundle_scene scene;
    scene.bundle = upright_bundle(16, 16, 0x1p-10f);
    auto order = counting(triangles, 0);
    std::shuffle(order.begin(), order.end(), c.random);
    for (const std::uint32_t k : order) {
        // Small steps, so that depths times areas are whole in 24 bits.
        const float z = (static_cast<float>(k) - static_cast<float>(triangles / 2)) / 4;
        scene.add({0, 0, z}, {1, 0, z}, {0, 1, z});
    }
    for (std::uint32_t i = 0; i < samples; ++i) {
        const float z =
            (static_cast<float>(c.below(triangles)) - static_cast<float>(triangles / 2)) / 4;
        scene.ask({0.25f, i % 5 == 0 ? -0.25f : 0.25f, z + 0.125f},
                  {0, 0, i % 2 == 0 ? 1.0f : -1.0f});
    }
    resolve_exactly(c, scene, route, turns);
}

/// Rays far from a triangle that is seen from its side meet nothing.
template <backend B>
void resolve_beside(context<B>& c, resolve_route route) {
    bundle_scene scene;
    scene.bundle = upright_bundle(16, 8, 0x1p-10f);
    scene.add({-4, -4, 0}, {4, 4, 0}, {0, 0, 2}); // a line across
    scene.add({2, 2, 1}, {2, 2, 3}, {2, 2, 5});   // a point across
    add_square(scene, 1, 4, false);
    for (int y = -10; y <= 10; ++y) {
        for (int x = -10; x <= 10; ++x) {
            scene.ask({static_cast<float>(x), static_cast<float>(y), -1}, {0, 0, 1});
        }
    }
    for (const float away : {15.75f, -15.75f, 100.0f, -100.0f, 1e6f}) {
        scene.ask({away, 0.5f, -1}, {0, 0, 1});
        scene.ask({0.5f, away, -1}, {0, 0, 1});
    }
    resolve_exactly(c, scene, route);
}

/// One resolver for two bundles in one stream, whose triangles are others as well.
template <backend B>
void resolve_twice_in_one_recorder(context<B>& c, resolve_route route) {
    bundle_scene first = random_scene(c, 500, 200);
    bundle_scene second = random_scene(c, 350, 300);
    second.bundle = gather::make_bundle(gather::bounds_of(second.triangles), unit_direction(c),
                                        first.cells(), second.lift());
    resolving<B> a(c, first, route);
    const resolving<B> b(c, second, route);
    c.run([&](auto& r) {
        a.record(r);
        a.resolver().record(r, second.bundle, b.work());
    });
    expect_likely_hits(c, first, a.get(), 90);
    expect_likely_hits(c, second, b.get(), 90);
}

/// Two recorders turn by turn.
template <backend B>
void resolve_interleaved(context<B>& c, resolve_route route) {
    const bundle_scene large = random_scene(c, 700, 150);
    const bundle_scene other = random_scene(c, 30, 40);
    resolving<B> a(c, large, route);
    resolving<B> b(c, other, route);
    auto first = c.begin();
    auto second = c.begin();
    a.resolver().record_triangles(first, large.bundle, a.work().triangles);
    b.resolver().record_triangles(second, other.bundle, b.work().triangles);
    a.resolver().record_samples(first, large.bundle, a.work());
    b.resolver().record_samples(second, other.bundle, b.work());
    c.submit(second);
    c.submit(first);
    expect_likely_hits(c, large, a.get(), 90);
    expect_likely_hits(c, other, b.get(), 90);
}

/// Triangles, alpha, samples and hits are parts of one buffer, with numbers around them.
template <backend B>
void resolve_in_views(context<B>& c, resolve_route route) {
    bundle_scene scene;
    scene.bundle = upright_bundle(16, 4, 0x1p-10f);
    for (int k = 0; k < 20; ++k) {
        add_square(scene, 8, static_cast<float>(k % 7), k % 2 == 0);
    }
    for (int i = 0; i < 50; ++i) {
        scene.ask(glm::vec3(i % 7, i % 5, i) * glm::vec3(1, 1, 0.125f) - glm::vec3(3, 2.5f, 0),
                  {0, 0, i % 2 == 0 ? 1.0f : -1.0f});
    }
    resolving<B> own(c, scene, route);
    const std::uint64_t step = std::max<std::uint64_t>(c.device.limits().view_alignment, 256);
    const std::uint64_t part = (40 * sizeof(gather_triangle) / step + 2) * step;
    auto numbers = counting(3 * part / 4, 77);
    std::memcpy(numbers.data(), scene.triangles.data(), 40 * sizeof(gather_triangle));
    std::memcpy(&numbers[part / 4], scene.samples.data(), 50 * sizeof(gather_sample));
    const auto g = c.put(numbers);
    const std::uint64_t hits_at = 2 * part;
    c.run([&](auto& r) {
        own.resolver().record(
            r, scene.bundle,
            bundle_work<B>{{&g.buffer, g.before, 40 * sizeof(gather_triangle)},
                           {},
                           {&g.buffer, g.before + part, 50 * sizeof(gather_sample)},
                           {&g.buffer, g.before + hits_at, 50 * sizeof(gather_hit)}});
    });
    const auto seen = c.template get<std::uint32_t>(g);
    std::vector<gather_hit> hits(50);
    std::memcpy(static_cast<void*>(hits.data()), &seen[hits_at / 4], 50 * sizeof(gather_hit));
    expect_exact_hits(c, scene, hits);
    comparison check = c.compare("words around hits");
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (i < hits_at / 4 || i >= hits_at / 4 + 50 * sizeof(gather_hit) / 4) {
            check.same(seen[i], numbers[i]);
        }
    }
}

/// Samples may come in parts: the triangles are sorted once.
template <backend B>
void resolve_samples_in_parts(context<B>& c, resolve_route route) {
    const bundle_scene scene = random_scene(c, 300, 192);
    resolving<B> whole(c, scene, route);
    const auto expected = whole.run();
    resolving<B> parts(c, scene, route);
    const bundle_work<B> work = parts.work();
    // Whole multiples of any alignment up to 256 bytes: 8 samples, 16 hits.
    const auto records = [](const buffer_view<B>& v, std::uint64_t bytes, std::uint64_t first,
                            std::uint64_t count) {
        return buffer_view<B>{v.buffer, v.offset + first * bytes, count * bytes};
    };
    c.run([&](auto& r) {
        parts.resolver().record_triangles(r, scene.bundle, work.triangles);
        for (const auto& [first, count] :
             {std::pair{std::uint64_t{128}, std::uint64_t{64}}, {0, 16}, {16, 112}}) {
            bundle_work<B> some = work;
            some.samples = records(work.samples, sizeof(gather_sample), first, count);
            some.hits = records(work.hits, sizeof(gather_hit), first, count);
            parts.resolver().record_samples(r, scene.bundle, some);
        }
    });
    expect_same_hits(c, parts.get(), expected, "hits of samples that came in parts");
}

/// The grid is for speed alone: with any number of cells the hits have the same bits.
template <backend B>
void resolve_any_grid(context<B>& c) {
    bundle_scene scene = random_scene(c, 1500, 400);
    const gather::bounds box = gather::bounds_of(scene.triangles);
    const glm::dvec3 axis = unit_direction(c);
    std::vector<gather_hit> expected;
    for (const std::uint32_t cells : {1u, 2u, 16u, 64u, 512u}) {
        scene.bundle = gather::make_bundle(box, axis, cells, scene.lift());
        const auto hits = resolving<B>(c, scene, resolve_route::composed).run();
        if (expected.empty()) {
            expected = hits;
        }
        expect_same_hits(c, hits, expected, "hits with another grid");
    }
    expect_likely_hits(c, scene, expected, 90);
}

/// The backend's own way and that of the patterns give the same bits.
template <backend B>
void resolve_same(context<B>& c, const bundle_scene& scene) {
    const auto fused = resolving<B>(c, scene, resolve_route::fastest).run();
    const auto composed = resolving<B>(c, scene, resolve_route::composed).run();
    comparison check = c.compare("words of hits, fused and composed");
    for (std::size_t i = 0; i < fused.size(); ++i) {
        const auto a = std::bit_cast<std::array<std::uint32_t, 4>>(fused[i]);
        const auto b = std::bit_cast<std::array<std::uint32_t, 4>>(composed[i]);
        for (std::size_t k = 0; k < 4; ++k) {
            check.same(a[k], b[k]);
        }
    }
}
template <backend B>
void resolve_same_random(context<B>& c) {
    for (const std::uint32_t triangles : {200u, 3000u}) {
        bundle_scene scene = random_scene(c, triangles, 1500, {3, -20, 7});
        for (int turn = 0; turn < 3; ++turn) {
            scene.bundle = gather::make_bundle(gather::bounds_of(scene.triangles),
                                               unit_direction(c), scene.cells(), scene.lift());
            resolve_same(c, scene);
        }
    }
}
/// Samples on the surfaces and at the corners of a mesh, holes and triangles in one place.
template <backend B>
void resolve_same_mesh(context<B>& c) {
    bundle_scene scene;
    const ball around(3);
    for (int copy = 0; copy < 2; ++copy) {
        for (const auto& f : around.faces) {
            scene.add(around.corners[f[0]], around.corners[f[1]], around.corners[f[2]],
                      copy == 0 ? 1 + c.below(2) : 0);
            const gather_triangle& t = scene.triangles.back();
            const glm::vec3 middle = (t.a + t.b + t.c) / 3.0f;
            scene.ask(middle, glm::normalize(copy == 0 ? -middle : middle));
            scene.ask(t.a, glm::normalize(-t.a));
        }
    }
    for (const float cutoff : {0.5f, 0.25f}) {
        alpha_coordinates at;
        at.b = {2.5f, 0.3f};
        at.c = {-0.7f, 3};
        at.map = 24;
        at.size = 5 + 65536 * 7;
        at.cutoff = cutoff;
        add_alpha(scene, at);
    }
    for (int i = 0; i < 35; ++i) {
        scene.alpha.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(unit(c))));
    }
    const gather::bounds box = gather::bounds_of(scene.triangles);
    for (int turn = 0; turn < 3; ++turn) {
        scene.bundle = gather::make_bundle(box, unit_direction(c), 32, gather::default_lift(box));
        resolve_same(c, scene);
    }
}

template <backend B>
void add_bundle_route(cases<B>& to, const std::string& way, resolve_route route) {
    const auto add = [&](const std::string& name,
                         std::function<void(context<B>&, resolve_route)> body) {
        to.push_back({"resolve", way + name,
                      [body = std::move(body), route](context<B>& c) { body(c, route); }});
    };
    add("sizes", resolve_sizes<B>);
    add("random", [](context<B>& c, resolve_route how) { resolve_random(c, how, 800, {0, 0, 0}); });
    add("random_aside", [](context<B>& c, resolve_route how) {
        resolve_random(c, how, 300, {40, -5, 13});
    });
    add("planes", resolve_planes<B>);
    add("own_surface", resolve_own_surface<B>);
    add("shared_edges", resolve_shared_edges<B>);
    add("watertight", resolve_watertight<B>);
    add("box_corners", resolve_box_corners<B>);
    add("alpha", resolve_alpha<B>);
    add("duplicates", resolve_duplicates<B>);
    add("degenerate", resolve_degenerate<B>);
    add("no_numbers", resolve_no_numbers<B>);
    add("beside", resolve_beside<B>);
    add("crowd", [](context<B>& c, resolve_route how) { resolve_crowd(c, how, 4321, 100, 1000); });
    add("crowd_many",
        [](context<B>& c, resolve_route how) { resolve_crowd(c, how, 70000, 24, 60000); });
    add("twice_in_one_recorder", resolve_twice_in_one_recorder<B>);
    add("interleaved", resolve_interleaved<B>);
    add("in_views", resolve_in_views<B>);
    add("samples_in_parts", resolve_samples_in_parts<B>);
}

template <backend B>
void add_bundle_cases(cases<B>& to) {
    if constexpr (gather::resolves_composed<B>) {
        add_bundle_route(to, "composed_", resolve_route::composed);
        to.push_back({"resolve", "composed_any_grid", resolve_any_grid<B>});
        if constexpr (resolves_bundles<B>) {
            add_bundle_route(to, "fused_", resolve_route::fastest);
            to.push_back({"resolve", "same_random", resolve_same_random<B>});
            to.push_back({"resolve", "same_mesh", resolve_same_mesh<B>});
        }
    }
}

} // namespace skybark::conformance
