// record_light_at: the attenuation volume and the scattered light at places, against closed forms
// of one particle and against the volumes' own voxels, sampled here in double precision.

#include "support/devices.hpp"

#include <skybark/clouds/light_at_points.hpp>
#include <skybark/core/validated.hpp>

#include <cmath>
#include <random>

namespace {

using namespace skybark;
using namespace skybark::clouds;

constexpr glm::uvec3 voxels{64, 64, 64};
constexpr glm::vec3 to_sun{0.4f, 0.7f, -0.3f};

/// A ball of depth 3 and radius 30 m: σ is 10 m.
std::vector<cloud_particle> one_ball() { return {{{100, 200, -50}, 30, 3, 0.9f, {0, 0}}}; }

template <class B>
struct lit {
    attenuation_volume<B> sun;
    multiple_scattering<B> diffuse;
    light_box box;
};

template <class B>
std::optional<lit<B>> light(B& device, attenuation_light what, std::uint32_t halvings = 1) {
    const auto cloud = one_ball();
    attenuation_options options;
    options.light = what;
    options.forward = 0.7f;
    multiple_scattering_options scattering;
    scattering.medium = {0.9f, 0.85f, 0.7f};
    scattering.share = share_of(scattering.medium);
    scattering.halvings = halvings;
    auto sun = attenuation_volume<B>::create(device, voxels, options);
    auto diffuse = multiple_scattering<B>::create(device, voxels, scattering);
    auto particles = make_buffer<B, cloud_particle>(device, cloud);
    const auto box = fit_light_box(cloud, to_sun, voxels);
    EXPECT_TRUE(sun && diffuse && particles && box);
    if (!sun || !diffuse || !particles || !box) {
        return std::nullopt;
    }
    lit<B> made{std::move(*sun), std::move(*diffuse), *box};
    EXPECT_TRUE(run(device, [&](auto& recorder) {
        made.sun.relight(recorder, view<B>(*particles), 1, *box);
        made.diffuse.solve(recorder, made.sun);
    }));
    return made;
}

/// In the ball and around it, straight behind it, and far away; every second vec4 is something
/// else.
std::vector<glm::vec4> some_places(std::uint32_t stride) {
    std::vector<glm::vec3> at;
    std::mt19937 random(9);
    std::normal_distribution<float> near(0, 14);
    const glm::vec3 centre = one_ball()[0].position;
    for (int i = 0; i < 900; ++i) {
        at.push_back(centre + glm::vec3(near(random), near(random), near(random)));
    }
    for (int i = 0; i < 100; ++i) {
        at.push_back(centre - glm::normalize(to_sun) * (4.0f * static_cast<float>(i)));
    }
    at.push_back(centre + to_sun * 1e4f);
    std::vector<glm::vec4> places;
    for (const glm::vec3& p : at) {
        places.emplace_back(p, 0);
        places.resize(places.size() + stride - 1, glm::vec4(1e9f));
    }
    places.resize(places.size() - (stride - 1)); // nothing has to follow the last
    return places;
}

std::string sentence(const result<void>& done) {
    return done ? std::string("no error") : done.error().message;
}

template <class B>
std::vector<glm::vec4> found_at(B& device, const device_limits& limits, const lit<B>& from,
                                const multiple_scattering<B>* diffuse,
                                const std::vector<glm::vec4>& places,
                                const light_at_options& how = {}) {
    const auto count = static_cast<std::uint32_t>((places.size() - 1) / how.stride + 1);
    std::vector<glm::vec4> found(count);
    auto in = make_buffer<B, glm::vec4>(device, places);
    auto out = device.create_buffer(count * sizeof(glm::vec4));
    EXPECT_TRUE(in && out);
    result<void> recorded;
    EXPECT_TRUE(run(device, [&](auto& recorder) {
        recorded = record_light_at(recorder, limits, from.sun, diffuse, view<B>(*in), count,
                                   view<B>(*out), how);
    }));
    EXPECT_EQ(sentence(recorded), "no error");
    EXPECT_TRUE((read_back<B, glm::vec4>(device, *out, std::span(found))));
    return found;
}

/// What of the depth through the ball lies above a place: a Gaussian across and an erf along.
double depth_above(glm::vec3 place) {
    const glm::dvec3 y = glm::normalize(glm::dvec3(to_sun));
    const glm::dvec3 from = glm::dvec3(place) - glm::dvec3(one_ball()[0].position);
    const double along = glm::dot(from, y);
    const glm::dvec3 aside = from - along * y;
    const double d2 = glm::dot(aside, aside);
    return d2 >= 900 ? 0 : 3 * std::exp(-d2 / 200) * 0.5 * std::erfc(along / (std::sqrt(2.0) * 10));
}

/// Voxels of a volume on the host.
struct grid_of_floats {
    glm::ivec3 size;
    std::vector<float> values;

    /// The tents over the voxels' middles; the border goes on outside.
    [[nodiscard]] double at(glm::dvec3 cells) const {
        const glm::dvec3 from = glm::clamp(cells, glm::dvec3(0.5), glm::dvec3(size) - 0.5) - 0.5;
        double sum = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
            const glm::ivec3 v = glm::min(glm::ivec3(from) + step, size - 1);
            const glm::dvec3 tent =
                glm::max(1.0 - glm::abs(from - glm::dvec3(glm::ivec3(from) + step)), 0.0);
            sum += tent.x * tent.y * tent.z *
                   double(values[static_cast<std::size_t>((v.z * size.y + v.y) * size.x + v.x)]);
        }
        return sum;
    }
};

glm::dvec3 cells_in(const light_grid& g, glm::vec3 place) {
    const glm::dvec3 p = glm::dvec3(place) - glm::dvec3(glm::vec3(g.anchor));
    return {glm::dot(glm::dvec3(glm::vec3(g.row_x)), p) + double(g.row_x.w),
            glm::dot(glm::dvec3(glm::vec3(g.row_y)), p) + double(g.row_y.w),
            glm::dot(glm::dvec3(glm::vec3(g.row_z)), p) + double(g.row_z.w)};
}

class light_at_places : public testing::TestWithParam<const char*> {};

} // namespace

TEST_P(light_at_places, is_what_comes_through_one_ball) {
    support::with_device(GetParam(), [](auto& device) {
        const auto made = light(device, attenuation_light::extinction);
        ASSERT_TRUE(made);
        const auto places = some_places(1);
        using B = std::remove_reference_t<decltype(device)>;
        const auto found = found_at<B>(device, device.limits(), *made, nullptr, places);
        int behind = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const double depth = depth_above(glm::vec3(places[i]));
            behind += depth > 2.9 ? 1 : 0;
            // A voxel is 1 m, a tenth of σ. Trilinear: 1/8 of the largest second derivatives, 3/σ²
            // across in both directions and 0.73/σ² along: 0.9 %. At the ball's edge, 3 σ out,
            // 3 e^−4.5 = 0.033 begin at once.
            EXPECT_NEAR(double(found[i].x), depth, 0.035) << i;
            EXPECT_NEAR(double(found[i].y), std::exp(-double(found[i].x)), 1e-6) << i;
            EXPECT_EQ(found[i].z, 0);
            EXPECT_EQ(found[i].w, 0);
        }
        EXPECT_GT(behind, 80);
        EXPECT_EQ(found.back(), glm::vec4(0, 1, 0, 0)) << "between the ball and the sun";
    });
}

TEST_P(light_at_places, adds_the_scattered_light_where_its_own_grid_has_it) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        for (const std::uint32_t halvings : {1u, 2u}) {
            const auto made = light<B>(device, attenuation_light::continuum, halvings);
            ASSERT_TRUE(made);
            const auto places = some_places(1);
            const auto found = found_at<B>(device, device.limits(), *made, &made->diffuse, places);
            grid_of_floats fluence{glm::ivec3(made->diffuse.size()), {}};
            ASSERT_EQ(fluence.size, glm::ivec3(voxels >> halvings));
            fluence.values.resize(std::size_t{64 * 64 * 64} >> (3 * halvings));
            ASSERT_TRUE(device.download(made->diffuse.fluence(),
                                        std::as_writable_bytes(std::span(fluence.values))));
            const light_grid grid = made->diffuse.grid(made->box);
            int inside = 0;
            for (std::size_t i = 0; i < found.size(); ++i) {
                const glm::dvec3 cells = cells_in(grid, glm::vec3(places[i]));
                const bool below = cells.y < 0.5;
                const bool in = cells.x > 0 && cells.y > 0 && cells.z > 0 &&
                                cells.x < fluence.size.x && cells.y < fluence.size.y &&
                                cells.z < fluence.size.z;
                if (in && !below) {
                    ++inside;
                    // Floats of at most 2, places to 2e-5 of a cell, neighbours 0.5 apart.
                    EXPECT_NEAR(double(found[i].z), fluence.at(cells), 2e-5) << i;
                }
                EXPECT_NEAR(found[i].y, std::exp(-found[i].x) + found[i].z, 1e-6f) << i;
            }
            EXPECT_GT(inside, 800);
            EXPECT_GT(found[900].z, 0.1f) << "in the middle of the ball";
            EXPECT_EQ(found.back().x, 0) << "between the ball and the sun";
            EXPECT_GT(found.back().z, 0) << "the ball shines on it";
        }
    });
}

TEST_P(light_at_places, octaves_of_none_are_one) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto made = light<B>(device, attenuation_light::extinction);
        ASSERT_TRUE(made);
        const auto places = some_places(2);
        light_at_options how;
        how.stride = 2;
        const auto plain = found_at<B>(device, device.limits(), *made, nullptr, places, how);
        how.octaves = 0;
        EXPECT_EQ(found_at<B>(device, device.limits(), *made, nullptr, places, how), plain);
        how.octaves = 3;
        how.octave_weight = 0.25f;
        how.octave_attenuation = 0.1f;
        const auto octaves = found_at<B>(device, device.limits(), *made, nullptr, places, how);
        for (std::size_t i = 0; i < plain.size(); ++i) {
            const double depth = depth_above(glm::vec3(places[2 * i]));
            EXPECT_NEAR(double(plain[i].x), depth, 0.035);
            const double t = double(plain[i].x);
            const double mean =
                (std::exp(-t) + 0.25 * std::exp(-0.1 * t) + 0.0625 * std::exp(-0.01 * t)) / 1.3125;
            EXPECT_NEAR(double(octaves[i].y), mean, 1e-6);
        }
    });
}

TEST_P(light_at_places, goes_through_in_parts_where_views_are_short) {
    support::with_device(GetParam(), [](auto& inner) {
        using inner_type = std::remove_reference_t<decltype(inner)>;
        using B = validated<inner_type>;
        std::vector<std::string> misuse;
        B device(inner, [&](std::string_view said) { misuse.emplace_back(said); });
        const auto made = light<B>(device, attenuation_light::continuum);
        ASSERT_TRUE(made);
        light_at_options how;
        for (const std::uint32_t stride : {1u, 2u, 3u}) {
            how.stride = stride;
            const auto places = some_places(stride);
            const auto whole =
                found_at<B>(device, device.limits(), *made, &made->diffuse, places, how);
            device_limits limits = device.limits();
            limits.max_buffer_bytes = 5000; // of 16,016 bytes that are found
            EXPECT_EQ(found_at<B>(device, limits, *made, &made->diffuse, places, how), whole);
            limits = device.limits();
            limits.max_elements = 100;
            EXPECT_EQ(found_at<B>(device, limits, *made, &made->diffuse, places, how), whole);
        }
        EXPECT_EQ(misuse, std::vector<std::string>{});
    });
}

TEST_P(light_at_places, says_what_is_too_short_and_costs_parameters_alone) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto made = light<B>(device, attenuation_light::continuum);
        ASSERT_TRUE(made);
        auto in = device.create_buffer(30 * sizeof(glm::vec4));
        auto out = device.create_buffer(20 * sizeof(glm::vec4));
        ASSERT_TRUE(in && out);
        const auto said = [&](std::uint32_t count, std::uint32_t stride) {
            light_at_options how;
            how.stride = stride;
            result<void> recorded;
            EXPECT_TRUE(run(device, [&](auto& recorder) {
                recorded = record_light_at(recorder, device.limits(), made->sun, &made->diffuse,
                                           view<B>(*in), count, view<B>(*out), how);
            }));
            return sentence(recorded);
        };
        EXPECT_EQ(said(0, 1), "no error");
        EXPECT_EQ(said(20, 1), "no error");
        EXPECT_EQ(said(15, 2), "no error");
        EXPECT_EQ(said(21, 1), "The view of what is found has 320 bytes; expected 336 at least.");
        EXPECT_EQ(said(16, 2), "The view of places has 480 bytes; expected 496 at least.");
        const device_traffic before = device.traffic();
        const device_usage used = device.usage();
        EXPECT_EQ(said(20, 1), "no error");
        EXPECT_LE(device.traffic().up - before.up, 256u);
        EXPECT_EQ(device.traffic().down, before.down);
        EXPECT_EQ(device.usage().objects, used.objects);
    });
}

INSTANTIATE_TEST_SUITE_P(all, light_at_places, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& each) { return std::string(each.param); });
