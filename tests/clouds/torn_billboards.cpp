// Clouds that are drawn by a light for each particle, with torn outlines.
#include "support/cloud_sums.hpp"
#include "support/devices.hpp"

#include <skybark/clouds/torn_billboards.hpp>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace {

using namespace skybark;
using namespace skybark::clouds;
using kernels::torn_puff;

constexpr std::uint32_t side = 96;
constexpr float field = 0.2f; // rad
constexpr torn_puff whole{0, 1, 0};

/// What is drawn: particles, where they lie at rest, and from where they are seen.
struct sight {
    std::vector<cloud_particle> particles;
    std::vector<cloud_particle> rest;
    glm::vec3 eye{0, 0, 100};
    glm::vec3 target{0};
    glm::vec3 to_sun = glm::normalize(glm::vec3(0.5f, 0.7f, 0.4f));
    float forward = 0;
    float air = 0;
    bool lit_by_fragment = false; ///< by cloud_billboards
    bool unshaded = false;        ///< as if each were alone
};

sight one_particle() {
    sight what;
    cloud_particle p;
    p.position = {1, -0.5f, 0};
    p.radius = 6;
    p.optical_depth = 1.7f;
    p.albedo = 0.9f;
    what.particles = {p};
    what.rest = {p};
    return what;
}

kernels::scene_record scene_of(const sight& what) {
    kernels::scene_record scene{};
    scene.to_clip = glm::perspectiveRH_ZO(field, 1.0f, 1.0f, 1e4f) *
                    glm::lookAtRH(what.eye, what.target, glm::vec3(0, 1, 0));
    scene.from_clip = glm::inverse(scene.to_clip);
    scene.camera = glm::vec4(what.eye, 0);
    scene.sky.to_sun = glm::vec4(what.to_sun, 0);
    scene.sky.sunlight = glm::vec4(4, 3, 2, 0);
    scene.sky.zenith = glm::vec4(0.1f, 0.3f, 0.3f, 0);
    return scene;
}

template <class B>
std::vector<glm::vec4> draw(B& device, const sight& what, const torn_puff& how) {
    std::vector<glm::vec4> pixels(side * side);
    const auto count = static_cast<std::uint32_t>(what.particles.size());
    const kernels::scene_record scene = scene_of(what);
    attenuation_options options;
    options.light = what.forward > 0 ? attenuation_light::continuum : attenuation_light::extinction;
    options.forward = what.forward;
    auto sun = attenuation_volume<B>::create(device, glm::uvec3(32), options);
    const auto box = fit_light_box(what.unshaded ? one_particle().particles : what.particles,
                                   what.to_sun, glm::uvec3(32));
    auto moved = make_buffer<B, cloud_particle>(device, std::span(what.particles));
    auto rest = make_buffer<B, cloud_particle>(device, std::span(what.rest));
    auto on_device = make_buffer<B, kernels::scene_record>(device, std::span(&scene, 1));
    auto color = device.create_image({side, side, image_format::rgba32f});
    auto torn = torn_billboards<B>::create(device, count);
    auto lit = cloud_billboards<B>::create(device, count);
    if (!sun || !box || !moved || !rest || !on_device || !color || !torn || !lit) {
        ADD_FAILURE();
        return pixels;
    }
    EXPECT_TRUE(run(device, [&](auto& to) {
        // A single particle does not shade itself here.
        sun->relight(to, view<B>(*moved), count > 1 && !what.unshaded ? count : 0, *box);
        cloud_light_sources<B> light;
        light.lighting = single_scattering(options, *box, phase_function::isotropic());
        light.lighting.air = what.air;
        light.sun = &sun->volume();
        const draw_target<B> target{&*color, nullptr, glm::vec4(0), {}};
        if (what.lit_by_fragment) {
            lit->record(to, view<B>(*moved), count, what.eye, view<B>(*on_device), light, target);
        } else {
            torn->record(to, {view<B>(*moved), view<B>(*rest), count}, what.eye,
                         view<B>(*on_device), light, how, target);
        }
    }));
    EXPECT_TRUE(device.download(*color, std::as_writable_bytes(std::span(pixels))));
    return pixels;
}
std::vector<glm::vec4> draw(const sight& what, const torn_puff& how) {
    cpu::device device;
    return draw(device, what, how);
}

/// A ball of particles, 12 m across.
sight many_particles() {
    sight what;
    what.particles = support::ball(600, 0.5f, 1.2f, 0.4f, 7);
    for (cloud_particle& p : what.particles) {
        p.position *= 6.0f;
    }
    what.rest = what.particles;
    return what;
}

/// The ray through the middle of a pixel, from the eye along −z.
glm::dvec3 ray(std::size_t i) {
    const double scale = 2 * std::tan(double{field} / 2) / side;
    const double x = (double(i % side) + 0.5 - side / 2) * scale;
    const double y = (side / 2 - double(i / side) - 0.5) * scale;
    return glm::normalize(glm::dvec3(x, y, -1));
}

TEST(torn_billboards, draw_a_gaussian_where_nothing_is_torn) {
    const sight what = one_particle();
    const auto pixels = draw(what, whole);
    const cloud_particle& p = what.particles[0];
    std::size_t seen = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const glm::dvec3 away = glm::dvec3(p.position) - glm::dvec3(what.eye);
        const double rho = glm::length(glm::cross(away, ray(i)));
        const double over = rho / 6;
        const double alpha = over < 1 ? 1 - std::exp(-1.7 * std::exp(-4.5 * over * over)) : 0;
        // The billboard is a plane 100 m off: a tangent for a sine, at most 0.003 of rho², and at
        // the rim, where a body of 0.019 ends, half a pixel.
        EXPECT_NEAR(double{pixels[i].w}, alpha, std::abs(over - 1) < 0.02 ? 0.02 : 0.004);
        seen += alpha > 0 ? 1 : 0;
        // Isotropic: 1 / 4 pi of the irradiance, pi times sunlight.
        const glm::dvec3 color = double{pixels[i].w} * 0.9 * 0.25 * glm::dvec3(4, 3, 2);
        EXPECT_LT(glm::distance(glm::dvec3(pixels[i]), color), 1e-4);
    }
    EXPECT_GT(seen, 2000u);
}

TEST(torn_billboards, are_lit_as_fragments_are) {
    for (const float forward : {0.0f, 0.6f}) {
        sight what = many_particles();
        what.forward = forward;
        what.air = 0.004f;
        const auto by_particle = draw(what, whole);
        what.lit_by_fragment = true;
        const auto by_fragment = draw(what, whole);
        double sum = 0;
        double apart = 0;
        double alpha = 0;
        for (std::size_t i = 0; i < by_particle.size(); ++i) {
            sum += double{by_fragment[i].y};
            apart += std::abs(double{by_fragment[i].y} - double{by_particle[i].y});
            alpha = std::max(alpha, std::abs(double{by_fragment[i].w} - double{by_particle[i].w}));
        }
        EXPECT_GT(sum, 300);
        // Light that falls to 1/e within a particle is no straight line: measured 4.1 % and less.
        EXPECT_LT(apart / sum, 0.06) << "forward " << forward;
        EXPECT_LT(alpha, 0.02);
    }
}

TEST(torn_billboards, are_torn_from_the_rim) {
    const sight what = one_particle();
    const auto gaussian = draw(what, whole);
    const auto torn = draw(what, {0.6f, 0.3f, 0});
    double before = 0;
    double after = 0;
    for (std::size_t i = 0; i < torn.size(); ++i) {
        ASSERT_LE(torn[i].w, gaussian[i].w + 1e-5f);
        // Noise of 0…1 takes at most 0.6 from the body: what had more than that is still there.
        const double body = -std::log(1 - double{gaussian[i].w}) / 1.7;
        if (body > 0.62) {
            ASSERT_GT(torn[i].w, 0.0f);
        }
        before += double{gaussian[i].w};
        after += double{torn[i].w};
    }
    EXPECT_LT(after, 0.9 * before);
    EXPECT_GT(after, 0.2 * before);
}

TEST(torn_billboards, carry_their_outlines_along) {
    sight what = many_particles();
    const torn_puff how{0.6f, 0.4f, 0.5f};
    const auto at_first = draw(what, how);
    const glm::vec3 way(256, 0, -512);
    for (cloud_particle& p : what.particles) {
        p.position += way;
    }
    what.eye += way;
    what.target += way;
    const auto later = draw(what, how);
    what.rest = what.particles;
    const auto others = draw(what, how);
    double same = 0;
    double other = 0;
    for (std::size_t i = 0; i < later.size(); ++i) {
        same += double{glm::distance(at_first[i], later[i])};
        other += double{glm::distance(at_first[i], others[i])};
    }
    // Of volumes whose voxels lie elsewhere on the cloud, 1 %; with other noise far more.
    EXPECT_LT(same, 0.2 * other);
}

TEST(torn_billboards, are_the_same_on_every_backend) {
    sight what = many_particles();
    what.air = 0.004f;
    const torn_puff how{0.6f, 0.4f, 0.5f};
    const auto expected = draw(what, how);
    for (const char* name : {"opengl", "vulkan"}) {
        support::with_device(name, [&](auto& device) {
            const auto found = draw(device, what, how);
            double sum = 0;
            double apart = 0;
            for (std::size_t i = 0; i < found.size(); ++i) {
                sum += double{glm::length(expected[i])};
                apart += double{glm::distance(expected[i], found[i])};
            }
            EXPECT_LT(apart / sum, 0.002) << name; // filtering of volumes, and edges
        });
    }
}

/// Five that the eye is equally far from, three of them in one place, in all orders of the list.
TEST(torn_billboards, do_not_depend_on_the_order_of_the_list) {
    std::vector<cloud_particle> five(5, one_particle().particles[0]);
    const std::array<glm::vec3, 5> places{{{2, 0, 0}, {2, 0, 0}, {2, 0, 0}, {-2, 0, 0}, {0, 2, 0}}};
    for (std::size_t i = 0; i < five.size(); ++i) {
        five[i].position = places[i];
        five[i].albedo = 1 - 0.2f * static_cast<float>(i);
    }
    five[2].optical_depth = 3;
    for (const char* name : {"cpu", "opengl", "vulkan"}) {
        support::with_device(name, [&](auto& device) {
            std::array<std::size_t, 5> order{0, 1, 2, 3, 4};
            std::vector<glm::vec4> expected;
            do {
                sight what;
                for (const std::size_t i : order) {
                    what.particles.push_back(five[i]);
                }
                what.rest = what.particles;
                what.unshaded = true;
                const auto found = draw(device, what, {0.6f, 0.4f, 0.5f});
                if (expected.empty()) {
                    expected = found;
                }
                ASSERT_EQ(
                    std::memcmp(found.data(), expected.data(), found.size() * sizeof(glm::vec4)), 0)
                    << name << ' ' << order[0] << order[1] << order[2] << order[3] << order[4];
            } while (std::next_permutation(order.begin(), order.end()));
        });
    }
}

TEST(torn_billboards, draw_nothing_of_senseless_particles) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    for (const char* name : {"cpu", "opengl", "vulkan"}) {
        support::with_device(name, [&](auto& device) {
            const auto nothing = [&](auto change) {
                sight what = one_particle();
                what.particles.push_back(what.particles[0]);
                what.rest.push_back(what.rest[0]);
                what.unshaded = true;
                change(what.particles[0], what.rest[0]);
                const auto both = draw(device, what, {0.6f, 0.4f, 0.5f});
                what.particles.erase(what.particles.begin());
                what.rest.erase(what.rest.begin());
                const auto sane = draw(device, what, {0.6f, 0.4f, 0.5f});
                return std::memcmp(both.data(), sane.data(), both.size() * sizeof(glm::vec4)) == 0;
            };
            for (const float wrong : {nan, infinite, -infinite}) {
                EXPECT_TRUE(nothing([&](auto& p, auto&) { p.albedo = wrong; })) << name << wrong;
                EXPECT_TRUE(nothing([&](auto& p, auto&) { p.optical_depth = wrong; })) << name;
                EXPECT_TRUE(nothing([&](auto& p, auto&) { p.radius = wrong; })) << name << wrong;
                EXPECT_TRUE(nothing([&](auto& p, auto&) { p.position.y = wrong; })) << name;
                EXPECT_TRUE(nothing([&](auto&, auto& rest) { rest.position.x = wrong; })) << name;
            }
            EXPECT_FALSE(nothing([](auto& p, auto&) { p.albedo = 0.5f; })) << name;
        });
    }
}

TEST(torn_billboards, may_be_none_and_not_too_many) {
    cpu::device device;
    using B = cpu::device;
    EXPECT_TRUE(torn_billboards<B>::create(device, 0));
    const auto many = torn_billboards<B>::create(device, 0xffffffffu);
    ASSERT_FALSE(many);
    EXPECT_EQ(many.error().code, error_code::bad_input);
}

} // namespace
