#pragma once
// What a caller's own shader, caller_light.comp, asks of a cloud and of gathered light, and what it
// has to find: closed forms in double precision.

#include "cloud_sums.hpp"
#include "gathered.hpp"
#include "random.hpp"

#include <scenes/surface_list.hpp>
#include <skybark/clouds/multiple_scattering.hpp>
#include <skybark/clouds/phase.hpp>
#include <skybark/gather/irradiance_volume.hpp>

#include <array>
#include <cstddef>
#include <memory>

namespace skybark::support {

/// The shader's blocks and records.
struct caller_lights {
    light_grid sun;
    light_grid fluence;
    shared::irradiance_grid gathered;
    glm::vec4 phase;
    glm::vec4 medium;
};
static_assert(sizeof(caller_lights) == 240 && offsetof(caller_lights, phase) == 208); // std140
struct caller_place {
    glm::vec4 place;
    glm::vec4 normal;
};
struct caller_found {
    glm::vec4 cloud;
    glm::vec4 irradiance;
};

/// A sun, and the box of the volume that was made for it.
struct caller_moment {
    glm::dvec3 to_sun{0};
    light_box box;
};

/// Two Gaussian particles that end where nothing is left of them (e^−18), so that their depth is
/// smooth everywhere; light from a sky and a lamp, other at each place and from each direction; and
/// what Skybark makes of both for a shader of somebody else's.
template <class B>
class caller_light {
  public:
    static constexpr float sigmas = 6;
    static constexpr float albedo = 0.9f;
    static constexpr glm::uvec3 voxels{112, 96, 112};
    static inline const std::array<cloud_particle, 2> particles{
        cloud_particle{{0, 100, 0}, 60, 3, albedo, {}},
        cloud_particle{{25, 120, 10}, 48, 1.5f, albedo, {}}};

    explicit caller_light(B& device) : device_(&device) {
        medium_.albedo = albedo;
        medium_.mean_cosine = static_cast<float>(phase().mean_cosine());
        medium_.forward = static_cast<float>(phase().forward_energy());
        attenuation_options of_sun = with(attenuation_method::impulse_scan,
                                          attenuation_profile::erf, attenuation_light::extinction);
        of_sun.sigmas = sigmas;
        sun_ = made(attenuation_volume<B>::create(device, voxels, of_sun));
        multiple_scattering_options of_cloud;
        of_cloud.medium = medium_;
        diffuse_ = made(multiple_scattering<B>::create(device, voxels, of_cloud));
        buffer_ = made(make_buffer<B, cloud_particle>(device, std::span(particles)));
        gather::bounds box;
        box.add({-200, 0, -200});
        box.add({200, 200, 200});
        gather::irradiance_volume_options of_sky;
        of_sky.sky = [](glm::vec3 to) { return glm::vec3(1 + 0.5f * to.x, 2 - to.z, 3 + to.y); };
        scene_ = std::make_unique<gather::gather_scene<B>>(make_scene(device, describe(lamp())));
        gathered_ =
            made(gather::irradiance_volume<B>::create(device, *scene_, box, {3, 2, 3}, of_sky));
        EXPECT_TRUE(run(device, [&](auto& recorder) { gathered_->record(recorder, 32); }));
    }

    /// Records what a frame does, for this sun.
    [[nodiscard]] caller_moment relight(typename B::recorder& recorder, glm::vec3 to_sun) {
        const auto box = fit_light_box(particles, to_sun, voxels);
        EXPECT_TRUE(box) << box.error().message;
        sun_->relight(recorder, view<B>(*buffer_), 2, *box);
        diffuse_->solve(recorder, sun_->volume(), *box);
        return {glm::normalize(glm::dvec3(to_sun)), *box};
    }

    [[nodiscard]] const typename B::volume& attenuation() const { return sun_->volume(); }
    [[nodiscard]] const typename B::volume& fluence() const { return diffuse_->fluence(); }
    [[nodiscard]] const typename B::volume& gathered() const { return gathered_->volume(); }
    [[nodiscard]] caller_lights lights(const caller_moment& of) const {
        return {of.box.grid, diffuse_->grid(of.box), gathered_->grid(), phase().parameters(),
                glm::vec4(medium_.albedo, medium_.forward, 0, 0)};
    }

    /// Below the cloud, in it, above and beside it, a kilometre down the light, and middles of
    /// voxels of the box, which are the last `middles`.
    [[nodiscard]] static std::vector<caller_place> places(const caller_moment& of) {
        random_source random(5);
        std::vector<caller_place> all;
        const auto add = [&](glm::dvec3 place) {
            const glm::vec3 normal = glm::normalize(
                glm::vec3(random.between(-1, 1), random.between(-1, 1), random.between(0.1, 1)));
            all.push_back({glm::vec4(glm::vec3(place), 0),
                           glm::vec4(normal, static_cast<float>(random.between(-1, 1)))});
        };
        for (int i = 0; i < 400; ++i) {
            add({random.between(-150, 150), random.between(0, 220), random.between(-150, 150)});
        }
        for (int i = 0; i < 100; ++i) {
            const glm::dvec3 in_it(random.between(-30, 30), 100, random.between(-30, 30));
            add(in_it - of.to_sun * random.between(0.0, 1000.0));
        }
        for (int i = 0; i < middles; ++i) {
            const glm::dvec3 cells(random.below(voxels.x), random.below(voxels.y),
                                   random.below(voxels.z));
            add(middle_of(of.box.grid, cells + 0.5));
        }
        return all;
    }

    /// The fluence that the latest `relight` has left, to compare with.
    [[nodiscard]] std::vector<float> fluence_cells() const { return cells_of(fluence()); }

    /// Of what the shader found at the places of a moment; `cells` is the fluence then, or empty
    /// where nobody kept it.
    void expect_right(std::span<const caller_found> found, const caller_moment& of,
                      const std::vector<float>& cells) const {
        const auto asked = places(of);
        ASSERT_EQ(found.size(), asked.size());
        const std::vector<float> coefficients = cells_of(gathered());
        int shaded = 0;
        int bright = 0;
        for (std::size_t i = 0; i < asked.size(); ++i) {
            SCOPED_TRACE(i);
            const glm::dvec3 at(glm::vec3(asked[i].place));
            const double light = std::exp(-depth(at, of.to_sun));
            shaded += light < 0.5 ? 1 : 0;
            bright += light > 0.999 ? 1 : 0;
            const bool middle = i + middles >= asked.size();
            EXPECT_NEAR(double(found[i].cloud.x), light, middle ? filtered(of) : interpolated(of));
            if (!cells.empty()) {
                expect_fluence(asked[i], found[i], of, cells);
            }
            expect_scattered(asked[i], found[i]);
            expect_gathered(asked[i], found[i], coefficients);
        }
        EXPECT_GT(shaded, 20); // the places tell something
        EXPECT_GT(bright, 20);
    }

  private:
    static constexpr int middles = 200;

    [[nodiscard]] static phase_function phase() {
        return phase_function::mixture(0.9, 0.4, 2, 0.5);
    }

    template <class T>
    [[nodiscard]] static std::optional<T> made(result<T> of) {
        if (!of) {
            ADD_FAILURE() << of.error().message;
            return std::nullopt;
        }
        return std::move(*of);
    }
    /// A square of 200 m under one corner of the box.
    [[nodiscard]] static scenes::surface_list lamp() {
        scenes::surface_list scene;
        const std::uint32_t light = add_light(scene, {8, 4, 2});
        scenes::add_triangle(scene, light, {50, -30, 50}, {50, -30, 250}, {250, -30, 250});
        scenes::add_triangle(scene, light, {50, -30, 50}, {250, -30, 250}, {250, -30, 50});
        return scene;
    }

    [[nodiscard]] static double depth(glm::dvec3 at, glm::dvec3 to_sun) {
        double sum = 0;
        for (const cloud_particle& p : particles) {
            sum += depth_of(p, at, to_sun, attenuation_profile::erf, double(sigmas)).tau;
        }
        return sum;
    }

    /// How far a filter whose weights have eight bits is off at the middle of a voxel, where it
    /// should take that voxel alone: a 256th of the steepest difference to the next ones, of
    /// τ e^−½ / σ a metre across the light and τ / (√2π σ) along it; and 1e-5 for the sums.
    [[nodiscard]] static double filtered(const caller_moment& of) {
        const glm::dvec3 h(glm::vec3(of.box.grid.voxel));
        double most = 0;
        for (const cloud_particle& p : particles) {
            const double sigma = double(p.radius / sigmas);
            most += double(p.optical_depth) / sigma * (0.6065 * (h.x + h.z) + 0.3989 * h.y);
        }
        return most / 256 + 1e-5;
    }
    /// And between middles: h² / 8 of the second derivatives, at most τ / σ² across the light and
    /// τ e^−½ / (√2π σ²) along it. Light changes by no more than depth does.
    [[nodiscard]] static double interpolated(const caller_moment& of) {
        const glm::dvec3 h(glm::vec3(of.box.grid.voxel));
        double most = 0;
        for (const cloud_particle& p : particles) {
            const double sigma = double(p.radius / sigmas);
            most += double(p.optical_depth) / (8 * sigma * sigma) *
                    (h.x * h.x + h.z * h.z + 0.242 * h.y * h.y);
        }
        return most + filtered(of);
    }

    /// Fluence as the volume has it, trilinear in double precision, edges clamped; cells are
    /// 2 × 2 × 2 voxels. A 256th of the largest fluence along each axis for a filter's weights.
    void expect_fluence(const caller_place& asked, const caller_found& found,
                        const caller_moment& of, const std::vector<float>& cells) const {
        const light_grid& grid = of.box.grid;
        const glm::dvec3 from =
            glm::dvec3(glm::vec3(asked.place)) - glm::dvec3(glm::vec3(grid.anchor));
        const glm::vec4 rows[] = {grid.row_x, grid.row_y, grid.row_z};
        glm::dvec3 at(0);
        for (int a = 0; a < 3; ++a) {
            at[a] = 0.5 * (glm::dot(glm::dvec3(glm::vec3(rows[a])), from) + double(rows[a].w));
        }
        const double largest = double(*std::max_element(cells.begin(), cells.end()));
        ASSERT_GT(largest, 0.05);
        EXPECT_NEAR(double(found.cloud.y), sampled(cells, diffuse_->size(), at),
                    3.0 / 256 * largest);
    }

    /// The formula of clouds/multiple_scattering.hpp, of the light and the fluence that the shader
    /// found. Roundings: a dozen of 6e-8 each, and sharper lobes lose some more.
    void expect_scattered(const caller_place& asked, const caller_found& found) const {
        const double value = phase()(double(asked.normal.w));
        EXPECT_NEAR(double(found.cloud.w), value, 1e-5 * value);
        const double a = double(albedo);
        const double f = double(medium_.forward);
        const double scattered = (a * double(found.cloud.x) * value +
                                  a * (1 - f) * double(found.cloud.y) / (4 * std::numbers::pi)) /
                                 (1 - a * f);
        EXPECT_NEAR(double(found.cloud.z), scattered, 2e-5 * scattered);
    }

    /// Irradiance of the coefficients in the volume (four for each of red, green and blue, of 1, y,
    /// z and x; twelve layers along y), trilinear in double precision between points that lie on
    /// the box, clamped to it (Ramamoorthi and Hanrahan 2001, by the constants of its equation 13).
    /// A 256th of the largest differences along each axis for a filter's weights.
    void expect_gathered(const caller_place& asked, const caller_found& found,
                         const std::vector<float>& cells) const {
        const glm::uvec3 points = gathered_->points();
        glm::dvec3 at = (glm::dvec3(glm::vec3(asked.place)) + glm::dvec3(200, 0, 200)) /
                        glm::dvec3(400, 200, 400) * (glm::dvec3(points) - 1.0);
        at = glm::clamp(at, glm::dvec3(0), glm::dvec3(points) - 1.0);
        const std::size_t each = std::size_t{points.x} * points.y;
        const glm::dvec3 n(glm::vec3(asked.normal));
        for (std::size_t c = 0; c < 3; ++c) {
            std::array<double, 4> harmonics{};
            double differences = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                std::vector<float> one; // a volume of this coefficient alone
                for (std::size_t z = 0; z < points.z; ++z) {
                    const auto first = cells.begin() + std::ptrdiff_t((12 * z + 4 * c + k) * each);
                    one.insert(one.end(), first, first + std::ptrdiff_t(each));
                }
                harmonics[k] = sampled(one, points, at + 0.5);
                const auto [low, high] = std::minmax_element(one.begin(), one.end());
                differences += double(*high) - double(*low);
            }
            const double expected = std::max(
                0.0, 0.886227 * harmonics[0] +
                         1.023328 * (harmonics[1] * n.y + harmonics[2] * n.z + harmonics[3] * n.x));
            EXPECT_NEAR(double(found.irradiance[static_cast<int>(c)]), expected,
                        3.0 / 256 * differences + 1e-5 * expected);
        }
    }

    [[nodiscard]] std::vector<float> cells_of(const typename B::volume& from) const {
        std::vector<float> cells(from.description().size_bytes() / sizeof(float));
        EXPECT_TRUE(device_->download(from, std::as_writable_bytes(std::span(cells))));
        return cells;
    }

    B* device_;
    scattering_medium medium_;
    std::optional<attenuation_volume<B>> sun_;
    std::optional<multiple_scattering<B>> diffuse_;
    std::optional<typename B::buffer> buffer_;
    std::unique_ptr<gather::gather_scene<B>> scene_;
    std::optional<gather::irradiance_volume<B>> gathered_;
};

} // namespace skybark::support
