// Single places in an attenuation volume: trilinear by another way of writing it, in double
// precision; nothing above and beside the box, the undermost layer below it; octaves by their sums.

#include <skybark/kernels/light_at_points.hpp>

#include "support/devices.hpp"

#include <cmath>
#include <random>

using namespace skybark;

namespace {

constexpr glm::uvec3 voxels{7, 5, 6};

/// A turned grid with sides of 2, 3 and 0.5 m, its anchor in the middle.
light_grid turned_grid() {
    const glm::dvec3 y = glm::normalize(glm::dvec3(0.3, 0.8, -0.5));
    const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), y));
    const glm::dvec3 z = glm::cross(x, y);
    light_grid grid;
    grid.anchor = glm::vec4(100, 200, -300, 0);
    grid.row_x = glm::vec4(glm::vec3(x / 2.0), 3.5f);
    grid.row_y = glm::vec4(glm::vec3(y / 3.0), 2.5f);
    grid.row_z = glm::vec4(glm::vec3(z / 0.5), 3);
    grid.voxel = glm::vec4(2, 3, 0.5f, 0);
    return grid;
}

glm::dvec3 cells_by_hand(const light_grid& g, glm::vec3 place) {
    const glm::dvec3 p = glm::dvec3(place) - glm::dvec3(glm::vec3(g.anchor));
    return {glm::dot(glm::dvec3(glm::vec3(g.row_x)), p) + double(g.row_x.w),
            glm::dot(glm::dvec3(glm::vec3(g.row_y)), p) + double(g.row_y.w),
            glm::dot(glm::dvec3(glm::vec3(g.row_z)), p) + double(g.row_z.w)};
}

float& voxel(std::vector<float>& values, int x, int y, int z) {
    return values[static_cast<std::size_t>(x) +
                  voxels.x *
                      (static_cast<std::size_t>(y) + voxels.y * static_cast<std::size_t>(z))];
}

/// As a light box leaves it: nothing at the borders and on top.
std::vector<float> attenuation() {
    std::vector<float> values(std::size_t{voxels.x} * voxels.y * voxels.z, 0.0f);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> some(0, 4);
    for (int z = 1; z + 1 < static_cast<int>(voxels.z); ++z) {
        for (int x = 1; x + 1 < static_cast<int>(voxels.x); ++x) {
            float sum = 0;
            for (int y = static_cast<int>(voxels.y) - 2; y >= 0; --y) {
                sum += some(random);
                voxel(values, x, y, z) = sum;
            }
        }
    }
    return values;
}

/// The tent over each voxel's middle, summed over all voxels.
double by_tents(std::vector<float>& values, glm::dvec3 cells) {
    if (cells.x < 0 || cells.x > voxels.x || cells.z < 0 || cells.z > voxels.z ||
        cells.y > voxels.y) {
        return 0;
    }
    cells.y = std::max(cells.y, 0.5); // the undermost layer goes on
    double sum = 0;
    const auto tent = [](double distance) { return std::max(0.0, 1 - std::abs(distance)); };
    for (int z = 0; z < static_cast<int>(voxels.z); ++z) {
        for (int y = 0; y < static_cast<int>(voxels.y); ++y) {
            for (int x = 0; x < static_cast<int>(voxels.x); ++x) {
                sum += tent(cells.x - x - 0.5) * tent(cells.y - y - 0.5) * tent(cells.z - z - 0.5) *
                       double(voxel(values, x, y, z));
            }
        }
    }
    return sum;
}

/// Of 4 x 3 x 3 cells, each two voxels wide; the last along x and y ends half way.
std::vector<float> diffuse() {
    std::vector<float> values(4 * 3 * 3);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = 1 + static_cast<float>(i % 7) / 4;
    }
    return values;
}

/// What is left of a ball's solid angle at a distance from its surface, over that at it: a cap of
/// half an angle of asin(r / (r + d)).
double cap_left(double distance, double radius) {
    return 1 - std::cos(std::asin(radius / (radius + distance)));
}

/// Its tents, with the borders going on outside, and as much less as a ball of the box's size fills
/// less of what is seen: 14 x 15 x 3 m.
double diffuse_by_tents(glm::dvec3 cells) {
    const glm::dvec3 out = cells - glm::clamp(cells, glm::dvec3(0), glm::dvec3(voxels));
    const double left = cap_left(glm::length(out * glm::dvec3(2, 3, 0.5)), 7.5);
    const std::vector<float> values = diffuse();
    const glm::dvec3 at = glm::clamp(cells / 2.0, glm::dvec3(0.5), glm::dvec3(3.5, 2.5, 2.5));
    double sum = 0;
    for (int i = 0; i < 36; ++i) {
        const glm::dvec3 from = glm::abs(at - glm::dvec3(i % 4, i / 4 % 3, i / 12) - 0.5);
        const glm::dvec3 tent = glm::max(1.0 - from, glm::dvec3(0));
        sum += tent.x * tent.y * tent.z * double(values[static_cast<std::size_t>(i)]);
    }
    return sum * left;
}

std::vector<glm::vec4> some_places() {
    std::vector<glm::vec4> places{{100, 200, -300, 0}, {1e9f, 0, 0, 0},  {0, 1e9f, 0, 0},
                                  {0, -1e9f, 0, 0},    {0, 0, -1e9f, 0}, {-1e9f, 1e9f, 1e9f, 0}};
    std::mt19937 random(17);
    std::uniform_real_distribution<float> some(-14, 14);
    for (int i = 0; i < 3000; ++i) {
        places.emplace_back(100 + some(random), 200 + some(random), -300 + some(random) / 3, 0);
    }
    // Straight below the box, far away.
    const light_grid grid = turned_grid();
    const glm::vec3 down = -glm::normalize(glm::vec3(grid.row_y));
    for (int i = 1; i < 50; ++i) {
        places.emplace_back(glm::vec3(grid.anchor) + down * (10.0f * static_cast<float>(i)), 0);
    }
    return places;
}

std::vector<glm::vec4> found_on(const std::string& name, const kernels::light_at_points& kernel) {
    std::vector<glm::vec4> found;
    support::with_device(name, [&](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto values = attenuation();
        const auto coarse = diffuse();
        const auto places = some_places();
        auto volume = device.create_volume({voxels.x, voxels.y, voxels.z, volume_format::float32});
        ASSERT_TRUE(volume) << volume.error().message;
        ASSERT_TRUE(device.upload(*volume, std::as_bytes(std::span(values))));
        auto fluence = device.create_volume({4, 3, 3, volume_format::float32});
        ASSERT_TRUE(fluence) << fluence.error().message;
        ASSERT_TRUE(device.upload(*fluence, std::as_bytes(std::span(coarse))));
        auto from = make_buffer<B, glm::vec4>(device, places);
        auto to = device.create_buffer(places.size() * sizeof(glm::vec4));
        ASSERT_TRUE(from && to);
        const auto done = run(device, [&](auto& recorder) {
            volume_bindings<B, kernels::light_at_points> bound;
            bound.read = {&*volume, &*fluence};
            recorder.map(kernel, {view<B>(*from), view<B>(*to)}, bound,
                         range{0, static_cast<std::uint32_t>(places.size())});
        });
        ASSERT_TRUE(done) << done.error().message;
        found.resize(places.size());
        ASSERT_TRUE((read_back<B, glm::vec4>(device, *to, std::span(found))));
    });
    return found;
}

class light_at_points : public testing::TestWithParam<const char*> {};

} // namespace

TEST_P(light_at_points, is_linear_between_the_middles_of_voxels) {
    const kernels::light_at_points kernel{turned_grid(), 1};
    const auto found = found_on(GetParam(), kernel);
    if (found.empty()) {
        return;
    }
    auto values = attenuation();
    const auto places = some_places();
    std::size_t inside = 0;
    std::size_t below = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const glm::dvec3 cells = cells_by_hand(kernel.grid, glm::vec3(places[i]));
        const double expected = by_tents(values, cells);
        inside += expected > 0 && cells.y > 0 ? 1 : 0;
        below += expected > 0 && cells.y < -10 ? 1 : 0;
        // Coordinates of up to 170 cells in floats are 2e-5 off at most, within the grid 1e-6;
        // values of neighbours differ by up to 16 there, and by 4 below it.
        EXPECT_NEAR(found[i].x, expected, 1e-4) << i;
        EXPECT_NEAR(found[i].y, std::exp(-expected), 1e-4) << i;
        EXPECT_EQ(found[i].z, 0);
        EXPECT_EQ(found[i].w, 0);
    }
    EXPECT_GT(inside, 100u);
    EXPECT_GT(below, 40u);
}

// Their weights add up to 1, so that what lies beside the cloud has all the light.
TEST_P(light_at_points, sums_octaves_to_one_outside) {
    kernels::light_at_points kernel{turned_grid(), 8};
    const auto found = found_on(GetParam(), kernel);
    if (found.empty()) {
        return;
    }
    EXPECT_EQ(found[1].y, 1) << "far from the cloud";
    for (const glm::vec4& f : found) {
        double sum = 0;
        double weights = 0;
        for (int k = 0; k < 8; ++k) {
            sum += std::pow(0.5, k) * std::exp(-std::pow(0.5, k) * double(f.x));
            weights += std::pow(0.5, k);
        }
        EXPECT_NEAR(f.y, sum / weights, 1e-6);
    }
}

TEST_P(light_at_points, adds_what_was_scattered) {
    kernels::light_at_points kernel{turned_grid(), 1};
    kernel.diffuse = 0.5f;
    const auto found = found_on(GetParam(), kernel);
    if (found.empty()) {
        return;
    }
    const auto places = some_places();
    std::size_t lit = 0;
    std::size_t away = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const glm::dvec3 cells = cells_by_hand(kernel.grid, glm::vec3(places[i]));
        const double expected = diffuse_by_tents(cells);
        lit += expected > 0.8 ? 1 : 0;
        away += expected > 1e-3 && cells.x < -0.5 ? 1 : 0;
        // As above; neighbours differ by up to 1.5.
        EXPECT_NEAR(found[i].z, expected, 1e-4) << i;
        EXPECT_NEAR(found[i].y, std::exp(-double(found[i].x)) + expected, 1e-4) << i;
    }
    EXPECT_GT(lit, 200u);
    EXPECT_GT(away, 10u);
}

// Sums, products and a quotient of floats alone: the same bits everywhere.
TEST_P(light_at_points, have_the_bits_of_the_cpu) {
    kernels::light_at_points kernel{turned_grid(), 3};
    kernel.diffuse = 0.5f;
    const auto found = found_on(GetParam(), kernel);
    if (!found.empty()) {
        EXPECT_EQ(found, found_on("cpu", kernel));
    }
}

INSTANTIATE_TEST_SUITE_P(all, light_at_points, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& each) { return std::string(each.param); });
