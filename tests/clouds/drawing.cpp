// Drawing of clouds on every backend, against closed forms in double precision.

#include "support/allocations.hpp"
#include "support/devices.hpp"
#include <glm/common.hpp>

#include <picture/cloud_picture.hpp>
#include <skybark/clouds/cloud_billboards.hpp>
#include <skybark/clouds/cloud_density.hpp>
#include <skybark/clouds/cumulus.hpp>
#include <skybark/clouds/multiple_scattering.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

using namespace skybark;
using namespace skybark::clouds;
using glm::dvec3;
using glm::vec3;
using glm::vec4;

namespace {

constexpr double pi = std::numbers::pi;
constexpr int side = 48; ///< pixels
constexpr float field = 40;

/// A camera at `eye` that looks at `at`; the sun in `to_sun` sends (1, 2, 3) times pi, the sky and
/// the ground nothing.
kernels::scene_record scene_at(vec3 eye, vec3 at, vec3 to_sun = {0, 1, 0}) {
    kernels::scene_record scene{};
    const vec3 ahead = glm::normalize(at - eye);
    const vec3 above = std::abs(ahead.y) > 0.99f ? vec3(0, 0, -1) : vec3(0, 1, 0);
    scene.to_clip = glm::perspectiveRH_ZO(glm::radians(field), 1.0f, 0.1f, 10000.0f) *
                    glm::lookAtRH(eye, at, above);
    scene.from_clip = glm::inverse(scene.to_clip);
    scene.camera = vec4(eye, 0);
    scene.sky = picture::daylight(to_sun, 2.5);
    scene.sky.to_sun = vec4(glm::normalize(to_sun), 0);
    scene.sky.sunlight = vec4(1, 2, 3, 0);
    return scene;
}

/// The unit vector through the middle of a pixel, from the camera's frame alone.
dvec3 direction_of(int x, int y, vec3 eye, vec3 at) {
    const dvec3 ahead = glm::normalize(dvec3(at) - dvec3(eye));
    const dvec3 above = std::abs(ahead.y) > 0.99 ? dvec3(0, 0, -1) : dvec3(0, 1, 0);
    const dvec3 right = glm::normalize(glm::cross(ahead, above));
    const dvec3 up = glm::cross(right, ahead);
    const double reach = std::tan(double{field} * pi / 360);
    const double u = ((x + 0.5) / side * 2 - 1) * reach;
    const double v = (1 - (y + 0.5) / side * 2) * reach;
    return glm::normalize(ahead + right * u + up * v);
}

/// A grid of 1 m voxels along the world's axes whose corner is at `low`.
light_grid grid_at(vec3 low, float voxel = 1) {
    light_grid grid;
    grid.anchor = vec4(low, 0);
    grid.row_x = vec4(1 / voxel, 0, 0, 0);
    grid.row_y = vec4(0, 1 / voxel, 0, 0);
    grid.row_z = vec4(0, 0, 1 / voxel, 0);
    grid.voxel = vec4(voxel, voxel, voxel, 0x1p-22f);
    return grid;
}

/// Light that is scattered once, evenly, from a volume that lies at `grid`.
cloud_lighting plain_light(const light_grid& grid) {
    light_box box;
    box.grid = grid;
    return single_scattering({}, box, clouds::phase_function::isotropic());
}

template <volume_backend B>
typename B::volume make_volume(B& device, glm::uvec3 size, std::span<const float> voxels) {
    auto volume = device.create_volume({size.x, size.y, size.z, volume_format::float32});
    EXPECT_TRUE(volume) << volume.error().message;
    EXPECT_TRUE(device.upload(*volume, std::as_bytes(voxels)));
    return std::move(*volume);
}
template <volume_backend B>
typename B::volume clear_volume(B& device, float value = 0) {
    const std::vector<float> voxels(64, value);
    return make_volume(device, {4, 4, 4}, voxels);
}

/// What is needed to draw particles into an image of side × side floats.
template <volume_backend B>
class stage {
  public:
    explicit stage(B& device, std::uint32_t capacity = 1024)
        : device_(&device), puffs_(*cloud_billboards<B>::create(device, capacity)),
          color_(*device.create_image({side, side, image_format::rgba32f})),
          depth_(*device.create_image({side, side, image_format::depth32f})),
          scene_(*device.create_buffer(sizeof(kernels::scene_record))) {}

    void set(const kernels::scene_record& scene) {
        eye_ = vec3(scene.camera);
        ASSERT_TRUE(device_->upload(scene_, 0, std::as_bytes(std::span(&scene, 1))));
    }

    /// Over `background` behind everything.
    std::vector<vec4> draw(std::span<const cloud_particle> particles,
                           const cloud_light_sources<B>& light, vec4 background = vec4(0)) {
        // A buffer of no bytes has no view.
        auto buffer = *device_->create_buffer(std::max<std::size_t>(particles.size_bytes(), 32));
        EXPECT_TRUE(device_->upload(buffer, 0, std::as_bytes(particles)));
        const auto done = run(*device_, [&](typename B::recorder& r) {
            clear(r, background);
            puffs_.record(r, view<B>(buffer), static_cast<std::uint32_t>(particles.size()), eye_,
                          view<B>(scene_), light, {&color_, &depth_, {}, {}});
        });
        EXPECT_TRUE(done) << done.error().message;
        return pixels();
    }

    /// The sky, as a draw that clears, over which `background` is laid.
    void clear(typename B::recorder& r, vec4 background, float depth = 1) {
        draw_geometry<B> none;
        none.count = 0;
        r.draw(kernels::clear_sky{}, {view<B>(scene_)}, {}, none,
               {&color_, &depth_, background, depth}, draw_state{});
    }

    std::vector<vec4> pixels() {
        std::vector<vec4> all(side * side);
        EXPECT_TRUE(device_->download(color_, std::as_writable_bytes(std::span(all))));
        return all;
    }

    B& device() { return *device_; }
    const typename B::image& color() { return color_; }
    const typename B::image& depth() { return depth_; }
    buffer_view<B> scene() { return view<B>(scene_); }
    const cloud_billboards<B>& puffs() { return puffs_; }

  private:
    B* device_;
    cloud_billboards<B> puffs_;
    typename B::image color_;
    typename B::image depth_;
    typename B::buffer scene_;
    vec3 eye_{0};
};

struct ray_hit {
    double rho2;  ///< squared distance from the centre
    double ahead; ///< m before the eye where that is
};
ray_hit hit(const cloud_particle& p, dvec3 eye, dvec3 direction) {
    const dvec3 c = dvec3(p.position) - eye;
    const double ahead = glm::dot(c, direction);
    return {glm::dot(c, c) - ahead * ahead, ahead};
}

/// tau exp(-rho²/2σ²), what lies before the eye of it, and nothing beyond the radius (the
/// blob along a ray).
double depth_along(const cloud_particle& p, const ray_hit& h, double sigmas = 3) {
    const double r = p.radius;
    if (h.rho2 >= r * r) {
        return 0;
    }
    const double sigma = r / sigmas;
    return double{p.optical_depth} * std::exp(-h.rho2 / (2 * sigma * sigma)) * 0.5 *
           std::erfc(-h.ahead / (std::sqrt(2.0) * sigma));
}

class drawing : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(on, drawing, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& one) { return std::string(one.param); });

/// One particle: alpha and colour of every pixel. Corners of billboards round to 1/256 of a pixel,
/// half of it either way, which here is 3.2 mm across the ray; the rest rounds to 1e-5 at most. The
/// rim, where the depth ends at tau e^-4.5, is left out.
TEST_P(drawing, a_puff_has_the_profile_of_a_gaussian) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device);
        const vec3 eye(30, 20, 100);
        const vec3 at(2, 1, 0);
        on.set(scene_at(eye, at));
        for (const float tau : {0.01f, 1.0f, 8.0f}) {
            for (const auto& [forward, sigmas] :
                 {std::pair{0.0f, 3.0f}, std::pair{0.6f, 3.0f}, std::pair{0.6f, 2.0f}}) {
                cloud_particle p;
                p.radius = 25;
                p.optical_depth = tau;
                p.albedo = 0.9f;
                cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
                lighting.forward = forward;
                lighting.sigmas = sigmas;
                const auto pixels = on.draw({&p, 1}, {lighting, &lit, nullptr, nullptr, {}});
                int covered = 0;
                for (int y = 0; y < side; ++y) {
                    for (int x = 0; x < side; ++x) {
                        const ray_hit h = hit(p, dvec3(eye), direction_of(x, y, eye, at));
                        if (std::abs(std::sqrt(h.rho2) / double{p.radius} - 1) < 2e-4) {
                            continue;
                        }
                        const double kept = 1 - 0.9 * double{forward};
                        const double depth = kept * depth_along(p, h, double{sigmas});
                        const double alpha = 1 - std::exp(-depth);
                        const double light = 0.9 / kept * alpha / 4; // a P pi sunlight
                        const double slope = depth * std::exp(-depth) * std::sqrt(h.rho2) *
                                             double{sigmas * sigmas} / 625;
                        const vec4 pixel = pixels[static_cast<std::size_t>(y * side + x)];
                        // What is fainter than 1/4096 is left out.
                        const double tolerance = alpha < 2.5e-4 ? 2.5e-4 : 1e-5 + 0.0032 * slope;
                        ASSERT_NEAR(pixel.a, alpha, tolerance) << x << ' ' << y << ' ' << tau;
                        ASSERT_NEAR(pixel.r, light, tolerance) << x << ' ' << y;
                        ASSERT_NEAR(pixel.g, 2 * light, 2 * tolerance);
                        ASSERT_NEAR(pixel.b, 3 * light, 3 * tolerance);
                        covered += alpha > 0 ? 1 : 0;
                    }
                }
                EXPECT_GT(covered, 500);
            }
        }
    });
}

/// The paper's own form is a tau P I, and does not saturate.
TEST_P(drawing, the_papers_form_scatters_in_proportion_to_the_depth) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device, 0.5f);
        const vec3 eye(0, 0, 100);
        on.set(scene_at(eye, {0, 0, 0}, {0, 0, -1})); // the sun behind the cloud
        cloud_particle p;
        p.radius = 30;
        p.optical_depth = 5;
        cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        const auto phase = clouds::phase_function::henyey_greenstein(0.5);
        lighting.phase = phase.parameters();
        lighting.paper_form = 1;
        const auto pixels = on.draw({&p, 1}, {lighting, &lit, nullptr, nullptr, {}});
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const dvec3 to = direction_of(x, y, eye, {0, 0, 0});
                const double depth = depth_along(p, hit(p, dvec3(eye), to));
                const double light = depth * phase(-to.z) * pi * std::exp(-0.5);
                ASSERT_NEAR(pixels[static_cast<std::size_t>(y * side + x)].r, light, 5e-4)
                    << x << ' ' << y;
            }
        }
    });
}

/// 1/sr: (1 − w) Henyey–Greenstein + w Draine, as Draine 2003 has it in eq. 4, which is
/// Henyey–Greenstein where alpha is 0.
struct published_phase {
    const char* name;
    clouds::phase_function drawn;
    double g_henyey_greenstein = 0;
    double g_draine = 0;
    double alpha = 0;
    double weight = 0;

    static double draine(double g, double a, double u) {
        return (1 - g * g) / (1 + a * (1 + 2 * g * g) / 3) * (1 + a * u * u) /
               (4 * pi * std::pow(1 + g * g - 2 * g * u, 1.5));
    }
    double operator()(double u) const {
        return (1 - weight) * draine(g_henyey_greenstein, 0, u) +
               weight * draine(g_draine, alpha, u);
    }
    [[nodiscard]] double least() const {
        double found = 1e9;
        for (int i = -1000; i <= 1000; ++i) {
            found = std::min(found, (*this)(i / 1000.0));
        }
        return found;
    }
};
std::vector<published_phase> published_phases() {
    const double d = 10; // µm; Jendersie and d'Eon 2023, eq. 4 to 7
    return {{"isotropic", clouds::phase_function::isotropic()},
            {"Henyey-Greenstein", clouds::phase_function::henyey_greenstein(0.5), 0.5},
            {"Draine", clouds::phase_function::draine(0.5, 5), 0, 0.5, 5, 1},
            {"Mie", *clouds::phase_function::mie(d), std::exp(-0.0990567 / (d - 1.67154)),
             std::exp(-2.20679 / (d + 3.91029) - 0.428934),
             std::exp(3.62489 - 8.29288 / (d + 5.52825)),
             std::exp(-0.599085 / (d - 0.641583) - 0.665888)}};
}

/// Light that is scattered once, over alpha, is the phase function, with the sun behind the eye, to
/// its sides, before it and where a droplet's lobe is, for particles and for a grid.
TEST_P(drawing, light_is_scattered_by_the_phase_function) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device);
        const vec3 eye(0, 0, 100);
        cloud_particle p;
        p.radius = 60;
        p.optical_depth = 2;
        const std::vector<float> ones(64, 1.0f);
        const auto density = make_volume(device, {4, 4, 4}, ones);
        density_box where;
        where.low = vec3(-50);
        where.high = vec3(50);
        where.extinction = 0.02f;
        auto rays = cloud_density<B>::create(device);
        ASSERT_TRUE(rays);
        for (const published_phase& phase : published_phases()) {
            cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
            lighting.phase = phase.drawn.parameters();
            const cloud_light_sources<B> light{lighting, &lit, nullptr, nullptr, {}};
            double most = 0;
            double least = 1e9;
            for (const int degrees : {0, 2, 30, 60, 90, 135, 180}) { // between view and sun
                const double angle = degrees * pi / 180;
                const vec3 to_sun(dvec3(std::sin(angle), 0, -std::cos(angle)));
                on.set(scene_at(eye, {0, 0, 0}, to_sun));
                // A cosine rounds to 2e-7 and the ray to so many radians; the rest, with g once
                // rounded, to 2e-5 of P.
                const auto expect = [&](const std::vector<vec4>& pixels, double ray) {
                    for (int y = 0; y < side; y += 2) {
                        for (int x = 0; x < side; x += 2) {
                            const double u =
                                glm::dot(direction_of(x, y, eye, {0, 0, 0}), dvec3(to_sun));
                            const double beside = 2e-7 + ray * std::sqrt(std::max(0.0, 1 - u * u));
                            const double steepest =
                                std::max(std::abs(phase(u + beside) - phase(u)),
                                         std::abs(phase(u - beside) - phase(u)));
                            const vec4 pixel = pixels[static_cast<std::size_t>(y * side + x)];
                            ASSERT_GT(pixel.a, 0.01f);
                            const double found = double{pixel.g} / (2 * pi * double{pixel.a});
                            ASSERT_NEAR(found, phase(u), 2e-5 * phase(u) + steepest)
                                << phase.name << ' ' << degrees << ": " << x << ' ' << y;
                            most = std::max(most, found);
                            least = std::min(least, found);
                        }
                    }
                };
                // Corners of billboards: half of 1/256 pixel.
                expect(on.draw({&p, 1}, light), 3.2e-5);
                ASSERT_TRUE(run(device, [&](auto& r) {
                    on.clear(r, vec4(0));
                    rays->record(r, density, where, on.scene(), light, on.color(), on.depth());
                }));
                // The inverse of a matrix with a near plane at 0.1 m, where the eye is at 100 m:
                // 2^-24 of their quotient, twice.
                expect(on.pixels(), 1.2e-4);
            }
            // The droplets' lobe, half a pixel beside its middle.
            EXPECT_GT(most, 0.5 * phase(1)) << phase.name;
            EXPECT_LT(least, 1.1 * phase.least()) << phase.name;
        }
    });
}

std::vector<cloud_particle> thick_crowd(std::uint32_t seed, int count) {
    std::mt19937 random(seed);
    const auto unit = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
    std::vector<cloud_particle> all;
    for (int i = 0; i < count; ++i) {
        cloud_particle p;
        p.position = vec3(unit(), unit(), unit()) * 60.0f - 30.0f;
        p.radius = 4 + 12 * unit();
        p.optical_depth = 8 * unit();
        p.albedo = 0.5f + 0.5f * unit();
        all.push_back(p);
    }
    return all;
}

/// 300 particles with a light of their own each, many of them opaque: the same picture as
/// compositing them one by one, farthest first (eq. 5). Errors of single alphas, 2e-5 and up to
/// 2.5e-4 where what is faint is left out, add up over at most 40 that a ray meets.
TEST_P(drawing, puffs_are_composited_back_to_front) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device);
        const vec3 eye(70, 30, 80);
        const vec3 at(0, 0, 0);
        on.set(scene_at(eye, at));
        const auto particles = thick_crowd(5, 300);
        std::vector<float> light(particles.size());
        for (std::size_t i = 0; i < light.size(); ++i) {
            light[i] = static_cast<float>(i % 7);
        }
        auto values = make_buffer<B, float>(device, light);
        ASSERT_TRUE(values);
        cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        lighting.by_particle = 1;
        const vec4 background(5, 6, 7, 1);
        const auto pixels =
            on.draw(particles, {lighting, &lit, nullptr, nullptr, view<B>(*values)}, background);

        std::vector<std::size_t> order(particles.size());
        for (std::size_t i = 0; i < order.size(); ++i) {
            order[i] = i;
        }
        const auto away = [&](std::size_t i) {
            return glm::distance(dvec3(particles[i].position), dvec3(eye));
        };
        std::sort(order.begin(), order.end(),
                  [&](std::size_t a, std::size_t b) { return away(a) > away(b); });
        std::vector<std::uint32_t> sorted(order.size());
        auto found = device.create_buffer(4 * order.size());
        ASSERT_TRUE(run(device, [&](auto& r) {
            r.copy(on.puffs().order(static_cast<std::uint32_t>(order.size())), view<B>(*found));
        }));
        ASSERT_TRUE((read_back<B, std::uint32_t>(device, *found, sorted)));
        for (std::size_t i = 0; i < order.size(); ++i) {
            ASSERT_EQ(sorted[i], order[i]) << "the " << i << "th from the back";
        }
        double worst = 0;
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const dvec3 to = direction_of(x, y, eye, at);
                double red = 5;
                double alpha = 1;
                bool rim = false;
                for (const std::size_t i : order) {
                    const cloud_particle& p = particles[i];
                    const ray_hit h = hit(p, dvec3(eye), to);
                    rim = rim || std::abs(std::sqrt(h.rho2) / double{p.radius} - 1) < 1e-4;
                    const double a = 1 - std::exp(-depth_along(p, h));
                    red = a * double{p.albedo} * double{light[i]} / 4 + (1 - a) * red;
                    alpha = a + (1 - a) * alpha;
                }
                const vec4 pixel = pixels[static_cast<std::size_t>(y * side + x)];
                if (!rim) {
                    ASSERT_NEAR(pixel.r, red, 4e-3) << x << ' ' << y;
                    ASSERT_NEAR(pixel.a, alpha, 1e-4);
                    worst = std::max(worst, std::abs(double{pixel.r} - red));
                }
            }
        }
        testing::Test::RecordProperty("worst", std::to_string(worst));
    });
}

/// Light that grows across one particle: for each fragment where it is, for each particle none.
TEST_P(drawing, light_is_looked_up_for_each_fragment) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        // −ln light = 1 + x / 20 from x = −30 to 30: linear, so trilinear filtering is exact
        // between the outermost centres.
        std::vector<float> voxels(64 * 4 * 4);
        for (std::size_t i = 0; i < voxels.size(); ++i) {
            voxels[i] = 1 + (static_cast<float>(i % 64) + 0.5f - 32) / 20;
        }
        const auto ramp = make_volume(device, {64, 4, 4}, voxels);
        light_grid grid = grid_at({-32, -32, -32});
        grid.row_y = vec4(0, 1 / 16.0f, 0, 0);
        grid.row_z = vec4(0, 0, 1 / 16.0f, 0);
        const vec3 eye(0, 0, 100);
        on.set(scene_at(eye, {0, 0, 0}));
        cloud_particle p;
        p.radius = 25;
        p.optical_depth = 2;
        cloud_lighting lighting = plain_light(grid);
        for (const bool forward : {false, true}) {
            lighting.forward_point = forward ? 1 : 0;
            const auto pixels = on.draw({&p, 1}, {lighting, &ramp, nullptr, nullptr, {}});
            for (int y = 0; y < side; ++y) {
                for (int x = 0; x < side; ++x) {
                    const dvec3 to = direction_of(x, y, eye, {0, 0, 0});
                    const ray_hit h = hit(p, dvec3(eye), to);
                    const double alpha = 1 - std::exp(-depth_along(p, h));
                    if (alpha < 0.01) {
                        continue;
                    }
                    // Where the ray is nearest to the centre; at most 1.3 σ before it.
                    const double px = to.x * h.ahead;
                    const double slack = forward ? std::abs(to.x) * 1.3 * 25 / 3 / 20 : 0;
                    const double light = std::exp(-(1 + px / 20)) / 4;
                    const vec4 pixel = pixels[static_cast<std::size_t>(y * side + x)];
                    ASSERT_NEAR(pixel.r / alpha / light, 1, 2e-3 + slack) << x << ' ' << y;
                }
            }
        }
        // One value a particle: the same all over, whatever the volume says.
        const float value = std::exp(-1.0f);
        auto values = make_buffer<B, float>(device, std::span(&value, 1));
        lighting.by_particle = 1;
        const auto flat = on.draw({&p, 1}, {lighting, &ramp, nullptr, nullptr, view<B>(*values)});
        for (const vec4& pixel : flat) {
            ASSERT_NEAR(pixel.r, pixel.a * value / 4, 1e-5f);
        }
    });
}

/// Through and past a particle: what lies before the eye, at every distance, and no jump where the
/// billboard becomes the screen.
TEST_P(drawing, the_eye_may_be_inside) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device);
        cloud_particle p;
        p.radius = 20;
        p.optical_depth = 1.5f;
        const cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        for (const float z : {60.0f, 23.0f, 22.7f, 20.5f, 20.0f, 12.0f, 1.0f, 0.0f, -3.0f, -19.0f,
                              -22.9f, -30.0f}) {
            const vec3 eye(1, 0.5f, z);
            const vec3 at = eye - vec3(0, 0, 1);
            on.set(scene_at(eye, at));
            const auto pixels = on.draw({&p, 1}, {lighting, &lit, nullptr, nullptr, {}});
            for (int y = 0; y < side; ++y) {
                for (int x = 0; x < side; ++x) {
                    const ray_hit h = hit(p, dvec3(eye), direction_of(x, y, eye, at));
                    const double alpha = 1 - std::exp(-depth_along(p, h));
                    const double r = std::sqrt(std::max(h.rho2, 0.0)) / double{p.radius};
                    if (std::abs(r - 1) < 1e-4) {
                        continue;
                    }
                    // Behind the eye the billboard is gone once the eye is √1.3 radii away: of the
                    // Gaussian 3.1e-4 are left there, and of the depth 4.7e-4.
                    const double cut = z < -22 ? 5e-4 : 1e-4;
                    ASSERT_NEAR(pixels[static_cast<std::size_t>(y * side + x)].a, alpha, cut)
                        << x << ' ' << y << " from " << z;
                }
            }
        }
    });
}

TEST_P(drawing, no_particles_and_senseless_ones_draw_nothing) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device);
        on.set(scene_at({0, 0, 100}, {0, 0, 0}));
        const cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        const vec4 background(0.25f, 0.5f, 0.75f, 1);
        const auto all_background = [&](const std::vector<vec4>& pixels) {
            return std::all_of(pixels.begin(), pixels.end(),
                               [&](const vec4& p) { return p == background; });
        };
        EXPECT_TRUE(
            all_background(on.draw({}, {lighting, &lit, nullptr, nullptr, {}}, background)));
        const float nan = std::numeric_limits<float>::quiet_NaN();
        const float infinite = std::numeric_limits<float>::infinity();
        std::vector<cloud_particle> wrong(13);
        for (cloud_particle& p : wrong) {
            p.radius = 10;
            p.optical_depth = 1;
        }
        wrong[0].radius = 0;
        wrong[1].radius = -3;
        wrong[2].optical_depth = 0;
        wrong[3].position.y = nan;
        wrong[4].optical_depth = nan;
        wrong[5].optical_depth = infinite;
        wrong[6].optical_depth = -1;
        wrong[7].radius = nan;
        wrong[8].radius = infinite;
        wrong[9].albedo = nan;
        wrong[10].albedo = infinite;
        wrong[11].albedo = -infinite;
        wrong[12].position.z = -infinite;
        for (std::size_t i = 0; i < wrong.size(); ++i) {
            EXPECT_TRUE(all_background(
                on.draw({&wrong[i], 1}, {lighting, &lit, nullptr, nullptr, {}}, background)))
                << "the " << i << "th";
        }
        EXPECT_TRUE(
            all_background(on.draw(wrong, {lighting, &lit, nullptr, nullptr, {}}, background)));
    });
}

bool same_bytes(const std::vector<vec4>& a, const std::vector<vec4>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(vec4)) == 0;
}

/// Five that the eye is equally far from, three of them in one place: white ones, grey ones, thick
/// and thin ones, drawn in all 120 orders of the list.
TEST_P(drawing, the_order_of_the_list_does_not_matter) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device);
        on.set(scene_at({0, 0, 100}, {0, 0, 0}));
        const cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        std::vector<cloud_particle> five(5);
        for (cloud_particle& p : five) {
            p.position = vec3(8, 0, 0);
            p.radius = 20;
            p.optical_depth = 3;
        }
        five[1].albedo = 0.2f;
        five[2].albedo = 0.6f;
        five[2].optical_depth = 1;
        five[3].position = vec3(-8, 0, 0); // sum of squares as that of the others
        five[4].position = vec3(0, 8, 0);
        five[4].albedo = 0.4f;
        const cloud_light_sources<B> light{lighting, &lit, nullptr, nullptr, {}};
        const auto expected = on.draw(five, light);
        std::array<std::size_t, 5> order{0, 1, 2, 3, 4};
        while (std::next_permutation(order.begin(), order.end())) {
            std::vector<cloud_particle> listed;
            for (const std::size_t i : order) {
                listed.push_back(five[i]);
            }
            ASSERT_TRUE(same_bytes(on.draw(listed, light), expected))
                << order[0] << order[1] << order[2] << order[3] << order[4];
        }
    });
}

/// A cloud of which every particle has a grey twin in its place, shuffled.
TEST_P(drawing, a_shuffled_cloud_has_the_same_picture) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        cumulus_options options;
        options.base = vec3(0, -20, 0);
        options.width = 70;
        options.thickness = 40;
        options.particles = 400;
        std::vector<cloud_particle> cloud = cumulus_cloud(options);
        for (std::size_t i = 0; i < options.particles; ++i) {
            cloud.push_back(cloud[i]);
            cloud.back().albedo = 0.3f;
        }
        stage<B> on(device);
        const auto lit = clear_volume(device);
        on.set(scene_at({10, 5, 100}, {0, 0, 0}));
        const cloud_light_sources<B> light{
            plain_light(grid_at({-2, -2, -2})), &lit, nullptr, nullptr, {}};
        const auto expected = on.draw(cloud, light);
        std::mt19937 random(3);
        for (int turn = 0; turn < 3; ++turn) {
            for (std::size_t i = cloud.size() - 1; i > 0; --i) {
                std::swap(cloud[i], cloud[random() % (i + 1)]);
            }
            EXPECT_TRUE(same_bytes(on.draw(cloud, light), expected));
        }
    });
}

/// What is opaque and nearer hides the cloud, and is not drawn over by the cloud's own depth.
TEST_P(drawing, depth_is_tested_and_not_written) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device);
        const kernels::scene_record scene = scene_at({0, 0, 100}, {0, 0, 0});
        on.set(scene);
        std::vector<cloud_particle> two(2);
        for (cloud_particle& p : two) {
            p.radius = 20;
            p.optical_depth = 50;
        }
        two[0].position = vec3(0, 0, 40); // nearer than the wall, the other one behind
        two[1].position = vec3(0, 0, -40);
        const vec4 wall = scene.to_clip * vec4(0, 0, 0, 1);
        const auto buffer = make_buffer<B, cloud_particle>(device, two);
        const cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        const auto draw = [&](std::uint32_t first) {
            ASSERT_TRUE(run(device, [&](auto& r) {
                on.clear(r, vec4(0), wall.z / wall.w);
                on.puffs().record(r, view<B, cloud_particle>(*buffer, first, 1), 1, {0, 0, 100},
                                  on.scene(), {lighting, &lit, nullptr, nullptr, {}},
                                  {&on.color(), &on.depth(), {}, {}});
            }));
        };
        const std::size_t middle = side / 2 * side + side / 2;
        const auto expect_the_walls_depth = [&] {
            std::vector<float> depth(side * side);
            ASSERT_TRUE(device.download(on.depth(), std::as_writable_bytes(std::span(depth))));
            for (const float d : depth) {
                ASSERT_EQ(d, wall.z / wall.w);
            }
        };
        draw(0);
        EXPECT_NEAR(on.pixels()[middle].a, 1, 1e-4);
        expect_the_walls_depth();
        draw(1);
        EXPECT_EQ(on.pixels()[middle].a, 0);
        expect_the_walls_depth();
    });
}

/// Octaves: Σ a^i e^(−b^i A) P(c^i g) (Wrenninge et al. 2013).
TEST_P(drawing, octaves_add_up) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device, 3);
        const vec3 eye(0, 0, 100);
        const vec3 to_sun = glm::normalize(vec3(1, 2, -1));
        on.set(scene_at(eye, {0, 0, 0}, to_sun));
        cloud_particle p;
        p.radius = 30;
        p.optical_depth = 2;
        cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        lighting.phase = phase_function::henyey_greenstein(0.85).parameters();
        add_octaves(lighting, 5, 0.6f, 0.4f, 0.7f);
        const auto pixels = on.draw({&p, 1}, {lighting, &lit, nullptr, nullptr, {}});
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const double cosine = glm::dot(direction_of(x, y, eye, {0, 0, 0}), dvec3(to_sun));
                double sum = 0;
                for (int i = 0; i < 5; ++i) {
                    const double g = 0.85 * std::pow(0.7, i);
                    sum += std::pow(0.6, i) * std::exp(-3 * std::pow(0.4, i)) * (1 - g * g) /
                           (4 * std::pow(1 + g * g - 2 * g * cosine, 1.5));
                }
                const vec4 pixel = pixels[static_cast<std::size_t>(y * side + x)];
                // Polynomials and directions round to 1e-5 of what they give.
                ASSERT_NEAR(pixel.g, 2 * sum * double{pixel.a}, 1e-4) << x << ' ' << y;
            }
        }
    });
}

/// A column of depth 12 under a white sky and over black ground, then the other way round: the
/// means of two streams without absorption, whose net flux is T = 1 / (1 + 3/4 (1 − g) tau).
void expect_two_streams(const std::string& backend, float forward_part) {
    support::with_device(backend, [forward_part](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        // tau grows downwards: 12 at the bottom of 16 layers of 4 m, half a layer's worth less at
        // each centre, then as in a box: an empty layer on top, a full one at the bottom.
        std::vector<float> voxels(4 * 18 * 4);
        for (std::size_t i = 0; i < voxels.size(); ++i) {
            const double layer = static_cast<double>(i / 4 % 18);
            voxels[i] = static_cast<float>(std::clamp((16.5 - layer) / 16 * 12, 0.0, 12.0));
        }
        const auto sun = clear_volume(device, 50); // no sun
        light_box box;
        box.grid = grid_at({-100, -36, -100}, 50);
        box.grid.row_y = vec4(0, 0.25f, 0, 0);
        const auto phase = phase_function::henyey_greenstein(0.8);
        // By its extinction, and by what the continuum has of it.
        attenuation_options column;
        column.light =
            forward_part == 0 ? attenuation_light::extinction : attenuation_light::continuum;
        column.forward = forward_part;
        for (float& v : voxels) {
            v *= 1 - forward_part;
        }
        const auto above = make_volume(device, {4, 18, 4}, voxels);
        cloud_lighting lighting = single_scattering(column, box, phase);
        add_sky(lighting, column, box, phase);
        lighting.forward_point = 0;
        const vec3 eye(0, 0, 3000);
        const double gamma = 0.75 * 0.2;
        for (const bool from_above : {true, false}) {
            kernels::scene_record scene = scene_at(eye, {0, 0, 0});
            // Irradiance over pi 7 from one side, 0 from the other: 3.5 (1 ± n.y).
            for (int c = 0; c < 3; ++c) {
                scene.ambient[0][c] = 3.5f;
                scene.ambient[2][c] = from_above ? 3.5f : -3.5f;
            }
            on.set(scene);
            for (const float y : {-25.0f, 0.0f, 10.0f, 29.0f}) {
                cloud_particle p;
                p.position = vec3(0, y, 0);
                p.radius = 3;
                p.optical_depth = 4000; // opaque out to where only one pixel's ray goes
                scene = scene_at(vec3(0, y, 3000), p.position);
                for (int c = 0; c < 3; ++c) {
                    scene.ambient[0][c] = 3.5f;
                    scene.ambient[2][c] = from_above ? 3.5f : -3.5f;
                }
                // A long lens: the particle fills the picture.
                scene.to_clip = glm::perspectiveRH_ZO(0.0002f, 1.0f, 10.0f, 10000.0f) *
                                glm::lookAtRH(vec3(0, y, 3000), p.position, vec3(0, 1, 0));
                scene.from_clip = glm::inverse(scene.to_clip);
                on.set(scene);
                const auto pixels = on.draw({&p, 1}, {lighting, &sun, &above, nullptr, {}});
                const double tau = (32 - double{y}) / 64 * 12;
                const double over = from_above ? tau : 12 - tau;
                const double expected = 7 * (1 + 2 * gamma * (12 - over)) / (2 * (1 + gamma * 12));
                const vec4 middle = pixels[side / 2 * side + side / 2];
                ASSERT_NEAR(middle.a, 1, 1e-5);
                EXPECT_NEAR(middle.r, expected, 2e-3 * expected) << y << ' ' << from_above;
            }
        }
    });
}

TEST_P(drawing, light_of_the_sky_comes_by_two_streams) {
    for (const float forward_part : {0.0f, 0.64f}) {
        expect_two_streams(GetParam(), forward_part);
    }
}

/// A grid of one density: alpha is that of its length along the ray, however long; its light is
/// what the attenuation at every step says; and it ends at what is opaque.
TEST_P(drawing, a_grid_is_marched) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const std::vector<float> ones(8 * 8 * 8, 0.5f);
        const auto density = make_volume(device, {8, 8, 8}, ones);
        density_box where;
        where.low = vec3(-20, -10, -15);
        where.high = vec3(20, 10, 15);
        where.extinction = 0.1f; // 0.05 1/m
        where.albedo = 0.8f;
        const auto lit = clear_volume(device, 1);
        auto rays = cloud_density<B>::create(device);
        ASSERT_TRUE(rays);
        const cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        for (const vec3 eye : {vec3(50, 40, 60), vec3(0, 0, 80), vec3(1, 2, 3)}) {
            for (const bool wall : {false, true}) {
                const vec3 at = eye == vec3(1, 2, 3) ? vec3(5, 0, 0) : vec3(0);
                const kernels::scene_record scene = scene_at(eye, at);
                on.set(scene);
                // A wall across the line of sight, at the middle of the box.
                const vec4 middle = scene.to_clip * vec4(0, 0, 0, 1);
                const dvec3 ahead = glm::normalize(dvec3(at) - dvec3(eye));
                const double wall_away = glm::dot(-dvec3(eye), ahead);
                if (wall && wall_away < 1) {
                    continue;
                }
                ASSERT_TRUE(run(device, [&](auto& r) {
                    on.clear(r, vec4(0), wall ? middle.z / middle.w : 1.0f);
                    rays->record(r, density, where, on.scene(),
                                 {lighting, &lit, nullptr, nullptr, {}}, on.color(), on.depth());
                }));
                const auto pixels = on.pixels();
                for (int y = 0; y < side; ++y) {
                    for (int x = 0; x < side; ++x) {
                        const dvec3 to = direction_of(x, y, eye, at);
                        double first = 0;
                        double last = 1e9;
                        for (int a = 0; a < 3; ++a) {
                            const double s = (double{where.low[a]} - double{eye[a]}) / to[a];
                            const double e = (double{where.high[a]} - double{eye[a]}) / to[a];
                            first = std::max(first, std::min(s, e));
                            last = std::min(last, std::max(s, e));
                        }
                        if (wall) {
                            last = std::min(last, wall_away / glm::dot(to, ahead));
                        }
                        const double alpha = 1 - std::exp(-0.05 * std::max(last - first, 0.0));
                        const vec4 pixel = pixels[static_cast<std::size_t>(y * side + x)];
                        // The depth of a wall rounds to 6e-8 of 1, which 60 m away is 2 cm; rays
                        // end when 1/2048 is left.
                        const double tolerance = 6e-4 + (wall ? 0.05 * 0.02 : 0.0);
                        ASSERT_NEAR(pixel.a, alpha, tolerance) << x << ' ' << y;
                        ASSERT_NEAR(pixel.b, 3 * 0.8 / 4 * std::exp(-1.0) * alpha, tolerance);
                    }
                }
            }
        }
    });
}

/// Where the light that leaves a Gaussian towards the eye was scattered: 1/tau - 1/(e^tau - 1) of
/// its depth lies before that place, on average, which is documented to 0.1 sigma.
TEST_P(drawing, what_is_seen_was_scattered_in_front) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        // −ln light grows by 1 in 20 m away from the eye, which is at z = 100.
        std::vector<float> voxels(4 * 4 * 64);
        for (std::size_t i = 0; i < voxels.size(); ++i) {
            voxels[i] = 4 - (static_cast<float>(i / 16) + 0.5f - 32) / 20;
        }
        const auto ramp = make_volume(device, {4, 4, 64}, voxels);
        light_grid grid = grid_at({-32, -32, -32});
        grid.row_x = vec4(1 / 16.0f, 0, 0, 0);
        grid.row_y = vec4(0, 1 / 16.0f, 0, 0);
        const vec3 eye(0, 0, 100);
        on.set(scene_at(eye, {0, 0, 0}));
        for (const float tau : {0.3f, 3.0f, 15.0f}) {
            cloud_particle p;
            p.radius = 30;
            p.optical_depth = tau;
            const auto pixels = on.draw({&p, 1}, {plain_light(grid), &ramp, nullptr, nullptr, {}});
            for (int x = 0; x < side; ++x) {
                const int y = side / 2;
                const dvec3 to = direction_of(x, y, eye, {0, 0, 0});
                const ray_hit h = hit(p, dvec3(eye), to);
                const double depth = depth_along(p, h);
                if (depth < 0.05) {
                    continue;
                }
                // The quantile of the Gaussian, by halving.
                const double before = 1 / depth - 1 / std::expm1(depth);
                double low = -8;
                double high = 8;
                for (int i = 0; i < 60; ++i) {
                    const double middle = (low + high) / 2;
                    (0.5 * std::erfc(middle / std::sqrt(2.0)) > before ? low : high) = middle;
                }
                const double z = 100 + to.z * (h.ahead - low * 10);
                const double light = std::exp(-(4 - z / 20)) / 4;
                const vec4 pixel = pixels[static_cast<std::size_t>(y * side + x)];
                // 0.1 sigma of 10 m; filtering and corners round to 2e-3.
                ASSERT_NEAR(std::log(double{pixel.r / pixel.a} / light), 0, 0.05 + 2e-3)
                    << x << ' ' << tau;
            }
        }
    });
}

/// A volume of fluence that grows along x, in a grid of its own: from −30 to 30 m, 2.5 + x / 20.
template <volume_backend B>
typename B::volume fluence_ramp(B& device) {
    std::vector<float> voxels(32 * 4 * 4);
    for (std::size_t i = 0; i < voxels.size(); ++i) {
        voxels[i] = 2.5f + (2 * (static_cast<float>(i % 32) + 0.5f) - 32) / 20;
    }
    return make_volume(device, {32, 4, 4}, voxels);
}
light_grid fluence_grid() {
    light_grid grid = grid_at({-32, -32, -32}, 2);
    grid.row_y = vec4(0, 1 / 16.0f, 0, 0);
    grid.row_z = vec4(0, 0, 1 / 16.0f, 0);
    return grid;
}

/// Of light that was scattered before, a (1 − f) / (1 − a f) is scattered again, the same to all
/// sides; of the sun's, a / (1 − a f).
TEST_P(drawing, what_was_scattered_is_scattered_again) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device, 1);
        const auto ramp = fluence_ramp(device);
        const vec3 eye(0, 0, 100);
        on.set(scene_at(eye, {0, 0, 0}));
        cloud_particle p;
        p.radius = 25;
        p.optical_depth = 2;
        p.albedo = 0.7f;
        cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        lighting.forward = 0.6f;
        lighting.forward_point = 0;
        add_diffuse(lighting, fluence_grid());
        const double kept = 1 - 0.7 * 0.6;
        const auto pixels = on.draw({&p, 1}, {lighting, &lit, nullptr, &ramp, {}});
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const dvec3 to = direction_of(x, y, eye, {0, 0, 0});
                const ray_hit h = hit(p, dvec3(eye), to);
                const double alpha = 1 - std::exp(-kept * depth_along(p, h));
                if (alpha < 0.01) {
                    continue;
                }
                const double fluence = 2.5 + to.x * h.ahead / 20;
                const double light = (0.7 / kept * std::exp(-1.0) + 0.7 * 0.4 / kept * fluence) / 4;
                const vec4 pixel = pixels[static_cast<std::size_t>(y * side + x)];
                ASSERT_NEAR(pixel.b / alpha / (3 * light), 1, 2e-3) << x << ' ' << y;
            }
        }
    });
}

/// Own light dimmed by e^(−air · way), and what the sky has in that direction in its place.
TEST_P(drawing, air_lies_before_the_cloud) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        const auto lit = clear_volume(device, 1);
        const vec3 eye(0, 0, 100);
        const kernels::scene_record scene = scene_at(eye, {0, 0, 0}, {0.3f, 1, 0.2f});
        on.set(scene);
        const vec3 sky = shared::sky_radiance(scene.sky, vec3(0, 0, -1));
        ASSERT_GT(sky.r, 0.01f);
        cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        lighting.forward_point = 0;
        lighting.air = 0.007f;
        const std::size_t middle = side / 2 * side + side / 2;
        const auto expect = [&](const vec4& pixel, double alpha, double way) {
            const double seen = std::exp(-0.007 * way);
            const double own = std::exp(-1.0) / 4;
            for (int c = 0; c < 3; ++c) {
                // Half a pixel beside the axis, where the sky is 0.3 % darker.
                const double all = (c + 1) * own * seen + double{sky[c]} * (1 - seen);
                EXPECT_NEAR(double{pixel[c]} / alpha / all, 1, 5e-3) << c;
            }
        };
        cloud_particle p;
        p.radius = 25;
        p.optical_depth = 2;
        const auto pixels = on.draw({&p, 1}, {lighting, &lit, nullptr, nullptr, {}});
        expect(pixels[middle], 1 - std::exp(-2.0), 100);
        // A grid so dense that its first step is all that is seen: of 20 / 8 / 2 m at most.
        const std::vector<float> ones(8 * 8 * 8, 1.0f);
        const auto density = make_volume(device, {8, 8, 8}, ones);
        density_box where;
        where.low = vec3(-20, -10, -15);
        where.high = vec3(20, 10, 15);
        where.extinction = 100;
        auto rays = cloud_density<B>::create(device);
        ASSERT_TRUE(rays);
        ASSERT_TRUE(run(device, [&](auto& r) {
            on.clear(r, vec4(0));
            rays->record(r, density, where, on.scene(), {lighting, &lit, nullptr, nullptr, {}},
                         on.color(), on.depth());
        }));
        expect(on.pixels()[middle], 1, 85.6);
    });
}

/// A density that grows along x, albedo, forward part and all: ∫ by the midpoints of fine steps.
TEST_P(drawing, a_grid_scatters_what_was_scattered) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        std::vector<float> voxels(16 * 4 * 4);
        for (std::size_t i = 0; i < voxels.size(); ++i) {
            voxels[i] = (static_cast<float>(i % 16) + 0.5f) / 16;
        }
        const auto density = make_volume(device, {16, 4, 4}, voxels);
        density_box where;
        where.low = vec3(-20, -10, -15);
        where.high = vec3(20, 10, 15);
        where.extinction = 0.15f;
        where.albedo = 0.7f;
        const auto lit = clear_volume(device, 1);
        const auto fluence = clear_volume(device, 2.5f);
        auto rays = cloud_density<B>::create(device);
        ASSERT_TRUE(rays);
        cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
        lighting.forward = 0.6f;
        add_diffuse(lighting, grid_at({-2, -2, -2}));
        const double kept = 1 - 0.7 * 0.6;
        const double light = (0.7 / kept * std::exp(-1.0) + 0.7 * 0.4 / kept * 2.5) / 4;
        for (const vec3 eye : {vec3(80, 10, 15), vec3(-60, 5, 40)}) {
            on.set(scene_at(eye, {0, 0, 0}));
            ASSERT_TRUE(run(device, [&](auto& r) {
                on.clear(r, vec4(0));
                rays->record(r, density, where, on.scene(), {lighting, &lit, nullptr, &fluence, {}},
                             on.color(), on.depth());
            }));
            const auto pixels = on.pixels();
            int covered = 0;
            for (int y = 0; y < side; y += 3) {
                for (int x = 0; x < side; x += 3) {
                    const dvec3 to = direction_of(x, y, eye, {0, 0, 0});
                    double depth = 0;
                    const int steps = 4000;
                    const double length = 140.0 / steps;
                    for (int i = 0; i < steps; ++i) {
                        const dvec3 at = dvec3(eye) + to * ((i + 0.5) * length);
                        if (glm::all(glm::lessThan(glm::abs(at), dvec3(20, 10, 15)))) {
                            // Level in the outer half of the outermost voxels.
                            depth +=
                                length * 0.15 * std::clamp((at.x + 20) / 40, 0.5 / 16, 15.5 / 16);
                        }
                    }
                    const double alpha = 1 - std::exp(-kept * depth);
                    const vec4 pixel = pixels[static_cast<std::size_t>(y * side + x)];
                    // Rays end when 1/2048 is left; the quadrature's ends are 35 mm, of 0.15 1/m;
                    // a step of 1.25 m meets a bend of 0.15 / 40 in slope to 1e-3.
                    ASSERT_NEAR(pixel.a, alpha, 4e-3) << x << ' ' << y;
                    ASSERT_NEAR(pixel.g, 2 * light * double{pixel.a}, 1e-4) << x << ' ' << y;
                    covered += alpha > 0.3 ? 1 : 0;
                }
            }
            EXPECT_GT(covered, 30);
        }
    });
}

/// The shadow on the ground is what the column towards the sun lets through: a Gaussian's depth on
/// the line from the ground's point to the sun.
TEST_P(drawing, the_ground_lies_in_the_clouds_shadow) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> on(device);
        std::vector<cloud_particle> cloud(3);
        cloud[0].position = vec3(0, 500, 0);
        cloud[1].position = vec3(80, 520, 30);
        cloud[2].position = vec3(-60, 460, -90);
        for (cloud_particle& p : cloud) {
            p.radius = 180;
            p.optical_depth = 1.2f;
        }
        const vec3 to_sun = glm::normalize(vec3(0.5f, 1, 0.2f));
        attenuation_options how;
        how.light = attenuation_light::extinction;
        auto volume = attenuation_volume<B>::create(device, glm::uvec3(96), how);
        ASSERT_TRUE(volume) << volume.error().message;
        const auto box = fit_light_box(cloud, to_sun, glm::uvec3(96));
        ASSERT_TRUE(box);
        const auto particles = make_buffer<B, cloud_particle>(device, cloud);
        ASSERT_TRUE(particles);
        // Straight down on where the shadow falls.
        const vec3 at(-250, 0, -100);
        const vec3 eye = at + vec3(0, 1200, 0);
        kernels::scene_record scene = scene_at(eye, at, to_sun);
        on.set(scene);
        const auto ground = [&](float shadow) {
            kernels::clouded_ground country;
            country.grid = box->grid;
            country.shadow = shadow;
            EXPECT_TRUE(run(device, [&](auto& r) {
                volume->relight(r, view<B>(*particles), 3, *box);
                on.clear(r, vec4(0));
                volume_bindings<B, kernels::clouded_ground> bound;
                bound.read = {&volume->volume()};
                draw_geometry<B> plane;
                plane.count = 6;
                r.draw(country, {on.scene()}, {}, bound, plane, {&on.color(), &on.depth(), {}, {}},
                       draw_state{});
            }));
            return on.pixels();
        };
        const auto shaded = ground(1);
        const auto sunny = ground(0);
        double darkest = 1;
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const dvec3 to = direction_of(x, y, eye, at);
                const dvec3 place = dvec3(eye) + to * (-double{eye.y} / to.y);
                double depth = 0;
                for (const cloud_particle& p : cloud) {
                    depth += depth_along(p, hit(p, place, glm::normalize(dvec3(to_sun))));
                }
                const std::size_t i = static_cast<std::size_t>(y * side + x);
                ASSERT_GT(sunny[i].r, 0);
                // Trilinear filtering of 7 m voxels, σ = 60 m: h²/8 times the curvatures, 3.6/σ²
                // each in two directions, is 0.012 in depth; where particles end, 0.013 more.
                const double light = double{shaded[i].r} / double{sunny[i].r};
                ASSERT_NEAR(light, std::exp(-depth), 0.015) << x << ' ' << y;
                darkest = std::min(darkest, light);
            }
        }
        EXPECT_LT(darkest, 0.15);
    });
}

/// Everything that the picture of a cloud is made with, from the volumes to the image.
template <volume_backend B>
class whole_way {
  public:
    static constexpr std::uint32_t voxels = 24;

    explicit whole_way(B& device)
        : device_(&device), on_(device),
          sun_(*attenuation_volume<B>::create(device, glm::uvec3(voxels), light_of(phase_))),
          sky_(*attenuation_volume<B>::create(device, glm::uvec3(voxels), light_of(phase_))),
          diffuse_(*multiple_scattering<B>::create(device, glm::uvec3(voxels), spread())) {}

    /// The picture of a cloud and the sun as they are now.
    std::vector<vec4> frame(std::span<const cloud_particle> cloud, vec3 to_sun) {
        const auto sun_box = fit_light_box(cloud, to_sun, glm::uvec3(voxels));
        const auto sky_box = fit_light_box(cloud, {0, 1, 0}, glm::uvec3(voxels));
        EXPECT_TRUE(sun_box && sky_box);
        const auto count = static_cast<std::uint32_t>(cloud.size());
        const auto particles = make_buffer<B, cloud_particle>(*device_, cloud);
        EXPECT_TRUE(particles);
        cloud_lighting lighting = single_scattering(sun_.options(), *sun_box, phase_);
        add_diffuse(lighting, diffuse_.grid(*sun_box));
        add_sky(lighting, sky_.options(), *sky_box, phase_);
        const vec3 eye(60, 35, 90);
        on_.set(scene_at(eye, {0, 0, 0}, to_sun));
        EXPECT_TRUE(run(*device_, [&](auto& r) {
            sun_.relight(r, view<B>(*particles), count, *sun_box);
            sky_.relight(r, view<B>(*particles), count, *sky_box);
            diffuse_.solve(r, sun_);
            on_.clear(r, vec4(0));
            on_.puffs().record(r, view<B>(*particles), count, eye, on_.scene(),
                               {lighting, &sun_.volume(), &sky_.volume(), &diffuse_.fluence(), {}},
                               {&on_.color(), &on_.depth(), {}, {}});
        }));
        return on_.pixels();
    }

  private:
    [[nodiscard]] multiple_scattering_options spread() const {
        multiple_scattering_options options;
        options.medium = medium_of(phase_, 1);
        return options;
    }

    B* device_;
    clouds::phase_function phase_ = clouds::phase_function::henyey_greenstein(0.8);
    stage<B> on_;
    attenuation_volume<B> sun_;
    attenuation_volume<B> sky_;
    multiple_scattering<B> diffuse_;
};

/// The sun once around, through the zenith, both level directions and the nadir: with what was
/// there before the very picture that everything made anew gives.
TEST_P(drawing, a_sun_swept_all_around_leaves_no_trace) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto cloud = thick_crowd(21, 300);
        const auto exactly_level = [](double v) {
            return std::abs(v) < 1e-9 ? 0.0f : static_cast<float>(v);
        };
        whole_way<B> kept(device);
        std::vector<vec4> first;
        std::vector<vec4> before;
        for (int degrees = 0; degrees <= 360; degrees += 30) {
            const double angle = degrees * pi / 180;
            const vec3 to_sun(exactly_level(std::cos(angle)), exactly_level(std::sin(angle)), 0);
            const auto picture = kept.frame(cloud, to_sun);
            EXPECT_TRUE(same_bytes(picture, whole_way<B>(device).frame(cloud, to_sun))) << degrees;
            // There is a cloud, and the sun has moved on.
            const vec4 middle = picture[side / 2 * side + side / 2];
            EXPECT_GT(middle.a, 0.9f) << degrees;
            EXPECT_GT(middle.g, 0.01f) << degrees;
            EXPECT_FALSE(same_bytes(picture, before)) << degrees;
            before = picture;
            if (degrees == 0) {
                first = picture;
            }
        }
        EXPECT_TRUE(same_bytes(before, first)) << "once around";
    });
}

/// What a picture takes: two frames, the second one without any memory.
TEST(cloud_billboards, frames_allocate_nothing) {
    using B = cpu::device;
    B device;
    stage<B> on(device);
    const auto lit = clear_volume(device);
    on.set(scene_at({0, 0, 100}, {0, 0, 0}));
    const auto buffer = make_buffer<B, cloud_particle>(device, thick_crowd(3, 500));
    const cloud_lighting lighting = plain_light(grid_at({-2, -2, -2}));
    std::uint64_t allocations[2] = {0, 0};
    for (std::uint64_t& count : allocations) {
        auto recorder = device.begin();
        const std::uint64_t before = support::allocations;
        on.puffs().record(*recorder, view<B>(*buffer), 500, {0, 0, 100}, on.scene(),
                          {lighting, &lit, nullptr, nullptr, {}},
                          {&on.color(), &on.depth(), {}, {}});
        count = support::allocations - before;
        ASSERT_TRUE(device.submit(*recorder));
    }
    EXPECT_EQ(allocations[1], 0u);
}

/// What the lighting uses and nobody gave is a mistake of the caller's, not another volume.
TEST(cloud_billboards_death, miss_what_the_lighting_uses) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe"; // the device has threads
    using B = cpu::device;
    B device;
    stage<B> on(device);
    const auto lit = clear_volume(device);
    on.set(scene_at({0, 0, 100}, {0, 0, 0}));
    const auto crowd = thick_crowd(3, 2);
    const auto values = make_buffer<B, float>(device, std::vector<float>(2, 0.5f));
    const auto plain = plain_light(grid_at({-2, -2, -2}));
    cloud_light_sources<B> light{plain, &lit, nullptr, nullptr, {}};
    (void)on.draw(crowd, light);
    light.lighting.sky = 1;
    EXPECT_DEBUG_DEATH((void)on.draw(crowd, light), "light.sky");
    light.sky = &lit;
    (void)on.draw(crowd, light);
    light.lighting.diffuse = 0.1f;
    EXPECT_DEBUG_DEATH((void)on.draw(crowd, light), "light.diffuse");
    light.diffuse = &lit;
    (void)on.draw(crowd, light);
    light.lighting.by_particle = 1;
    EXPECT_DEBUG_DEATH((void)on.draw(crowd, light), "light.by_particle");
    light.by_particle = view<B>(*values);
    (void)on.draw(crowd, light);
}

TEST(cloud_billboards, know_of_the_light_what_the_volume_has) {
    const auto phase = phase_function::henyey_greenstein(0.5);
    attenuation_options options;
    options.sigmas = 2;
    options.forward = 0.25f;
    light_box box;
    box.grid = grid_at({1, 2, 3});
    for (const auto light : {attenuation_light::extinction, attenuation_light::continuum,
                             attenuation_light::product}) {
        options.light = light;
        const cloud_lighting lighting = single_scattering(options, box, phase);
        EXPECT_EQ(lighting.forward, light == attenuation_light::continuum ? 0.25f : 0.0f);
        EXPECT_EQ(lighting.sigmas, 2);
        EXPECT_EQ(lighting.sun_grid.anchor, box.grid.anchor);
        EXPECT_EQ(lighting.phase, phase.parameters());
    }
}

TEST(cloud_billboards, more_than_a_device_binds_is_refused) {
    cpu::device device;
    const auto made = cloud_billboards<cpu::device>::create(device, 0xffffffffu);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, error_code::bad_input);
}

/// A whole picture: sky, ground with shadow, a small cumulus in sun and sky light.
template <volume_backend B>
std::vector<std::uint8_t> picture_on(B& device) {
    cumulus_options options;
    options.particles = 1500;
    const auto cloud = cumulus_cloud(options);
    picture::cloud_picture_options how;
    how.width = 200;
    how.height = 120;
    how.eye = vec3(300, 500, 2600);
    how.target = vec3(0, 1000, 0);
    const auto phase = phase_function::henyey_greenstein(0.85);
    attenuation_options light;
    light.forward = static_cast<float>(phase.forward_energy());
    const glm::uvec3 voxels(48);
    auto sun = attenuation_volume<B>::create(device, voxels, light);
    auto sky = attenuation_volume<B>::create(device, voxels, light);
    auto painter =
        picture::cloud_painter<B>::create(device, how, static_cast<std::uint32_t>(cloud.size()));
    EXPECT_TRUE(sun && sky && painter);
    const auto scene = picture::cloud_scene({-700, 900, -700}, {700, 1700, 700}, how);
    const auto to_sun = fit_light_box(cloud, vec3(scene.sky.to_sun), voxels);
    const auto up = fit_light_box(cloud, {0, 1, 0}, voxels);
    const auto particles = make_buffer<B, cloud_particle>(device, cloud);
    EXPECT_TRUE(to_sun && up && particles);
    cloud_lighting lighting = single_scattering(light, *to_sun, phase);
    add_sky(lighting, light, *up, phase);
    const auto count = static_cast<std::uint32_t>(cloud.size());
    const auto done = run(device, [&](auto& r) {
        sun->relight(r, view<B>(*particles), count, *to_sun);
        sky->relight(r, view<B>(*particles), count, *up);
        painter->record(r, scene, view<B>(*particles), count,
                        {lighting, &sun->volume(), &sky->volume(), nullptr, {}}, 0);
    });
    EXPECT_TRUE(done) << done.error().message;
    auto pixels = painter->download(device);
    EXPECT_TRUE(pixels);
    return std::move(*pixels);
}

TEST_P(drawing, pictures_agree_with_the_cpus) {
    support::with_device(GetParam(), [](auto& device) {
        cpu::device cpu;
        const auto expected = picture_on(cpu);
        const auto actual = picture_on(device);
        ASSERT_EQ(actual.size(), expected.size());
        double sum = 0;
        int worst = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const int off = std::abs(int{actual[i]} - int{expected[i]});
            sum += off;
            worst = std::max(worst, off);
        }
        const double mean = sum / static_cast<double>(expected.size());
        testing::Test::RecordProperty("mean", std::to_string(mean));
        EXPECT_LE(mean, 0.1) << "1 is what is asked for";
        // A horizon may lie a pixel higher.
        EXPECT_LE(worst, 64);
        // There is a cloud: some of it is brighter than the sky behind it.
        const auto at = [&](int x, int y) { return int{actual[std::size_t(4 * (y * 200 + x))]}; };
        EXPECT_NE(at(100, 55), at(5, 55));
    });
}

} // namespace
