#include <first_pass/rays.hpp>

#include <scenes/embree_scene.hpp>
#include <skybark/shared/alpha_map.hpp>

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>

namespace skybark::first_pass {

struct rays::scene {
    explicit scene(const surfaces& of)
        : surface(of), traced(of.triangles, scenes::embree_build::exact) {
        for (const gather_triangle& t : of.triangles) {
            low = glm::min(low, glm::min(t.a, glm::min(t.b, t.c)));
            high = glm::max(high, glm::max(t.a, glm::max(t.b, t.c)));
        }
    }

    surfaces surface;
    scenes::embree_scene traced;
    glm::vec3 low{1e30f};
    glm::vec3 high{-1e30f};
};

namespace {

struct context_with_holes {
    RTCIntersectContext base;
    const surfaces* surface;
};

bool is_hole(const surfaces& of, std::uint32_t triangle, float u, float v) {
    const std::uint32_t number = of.triangles[triangle].alpha;
    if (number == 0) {
        return false;
    }
    const std::size_t at = std::size_t{12} * (number - 1);
    const auto value = [&](std::size_t word) { return std::bit_cast<float>(of.alpha[at + word]); };
    const std::uint32_t size = of.alpha[at + 7];
    const float x = shared::alpha_place(value(0), value(2), value(4), u, v);
    const float y = shared::alpha_place(value(1), value(3), value(5), u, v);
    const std::uint32_t texel = shared::alpha_texel(y, size >> 16) * (size & 0xffffu) +
                                shared::alpha_texel(x, size & 0xffffu);
    return std::bit_cast<float>(of.alpha[of.alpha[at + 6] + texel]) < value(8);
}

void pass_holes(const RTCFilterFunctionNArguments* found) {
    const auto* context = reinterpret_cast<const context_with_holes*>(found->context);
    const auto* hit = reinterpret_cast<const RTCHit*>(found->hit);
    if (is_hole(*context->surface, hit->primID, hit->u, hit->v)) {
        found->valid[0] = 0;
    }
}

context_with_holes context_of(const surfaces& of) {
    context_with_holes made;
    rtcInitIntersectContext(&made.base);
    made.base.filter = of.alpha.empty() ? nullptr : pass_holes;
    made.surface = &of;
    return made;
}

} // namespace

rays::rays(const surfaces& of) : scene_(std::make_unique<scene>(of)) {}
rays::~rays() = default;
rays::rays(rays&&) noexcept = default;
rays& rays::operator=(rays&&) noexcept = default;

gather_hit rays::first_hit(glm::vec3 origin, glm::vec3 direction) const {
    context_with_holes context = context_of(scene_->surface);
    RTCRayHit ray = scenes::ray_of(origin, direction, 0);
    rtcIntersect1(scene_->traced.get(), &context.base, &ray);
    gather_hit hit;
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        return hit;
    }
    const gather_triangle& t = scene_->surface.triangles[ray.hit.primID];
    const bool back = glm::dot(glm::cross(t.b - t.a, t.c - t.a), direction) > 0;
    hit.distance = ray.ray.tfar;
    hit.surface = 2 * ray.hit.primID + (back ? 1u : 0u);
    hit.u = ray.hit.u;
    hit.v = ray.hit.v;
    return hit;
}

bool rays::is_clear(glm::vec3 origin, glm::vec3 direction, float reach) const {
    context_with_holes context = context_of(scene_->surface);
    RTCRayHit ray = scenes::ray_of(origin, direction, 0);
    ray.ray.tfar = reach;
    rtcOccluded1(scene_->traced.get(), &context.base, &ray.ray);
    return ray.ray.tfar >= 0; // −∞ where something was met
}

glm::vec3 rays::centre() const { return 0.5f * (scene_->low + scene_->high); }
float rays::radius() const { return 0.5f * glm::distance(scene_->low, scene_->high); }
float rays::lift() const { return 2e-5f * radius(); }

} // namespace skybark::first_pass
