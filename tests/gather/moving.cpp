// Light under a tree that sways: gathered anew each frame, with nothing built beforehand, and at
// the same cost each time.

#include "support/allocations.hpp"
#include "support/devices.hpp"
#include "support/results.hpp"
#include "support/test_trees.hpp"

#include <scenes/random.hpp>
#include <scenes/tree_light.hpp>
#include <skybark/conformance/null_backend.hpp>
#include <skybark/gather/bounces.hpp>

#include <cstring>
#include <gtest/gtest.h>
#include <memory>

using namespace skybark;
using support::expect_done;
using support::value_of;

namespace {

const glm::vec3 to_sun = glm::normalize(glm::vec3(0.5f, 1, 0.3f));
const glm::vec3 sunlight(3, 2.8f, 2.4f);

gather::bounce_options light_options() {
    gather::bounce_options options;
    options.axes = 8;
    options.gather.sky = gather::even_sky({0.2f, 0.3f, 0.5f});
    return options;
}

/// Points on the ground around the trunk.
std::vector<gather_sample> on_the_ground() {
    scenes::random_numbers random(5);
    std::vector<gather_sample> samples(300);
    for (gather_sample& s : samples) {
        s.position = {random.between(-3, 3), 0, random.between(-3, 3)};
        s.normal = {0, 1, 0};
    }
    return samples;
}

/// Light on a scene as it is now: a bounce, and what is gathered of it at the samples.
template <backend B>
class frame_light {
  public:
    frame_light(B& device, const gather::gather_scene<B>& scene)
        : bounces_(value_of(gather::bounced_light<B>::create(device, scene, light_options()))),
          gather_(value_of(gather::final_gather<B>::create(device, scene, on_the_ground(),
                                                           light_options().gather))),
          found_(gather_.samples()) {
        bounces_.light_from(to_sun, sunlight);
    }

    [[nodiscard]] const std::vector<glm::vec4>& gather() {
        expect_done(bounces_.restart());
        expect_done(bounces_.bounce());
        expect_done(gather_.restart(1));
        expect_done(gather_.light_from(to_sun, sunlight));
        expect_done(gather_.add(8));
        expect_done(gather_.read(found_));
        return found_;
    }

  private:
    gather::bounced_light<B> bounces_;
    gather::final_gather<B> gather_;
    std::vector<glm::vec4> found_;
};

/// A young aspen on a lawn, in a wind.
template <backend B>
class swaying_scene {
  public:
    explicit swaying_scene(B& device)
        : device_(&device), wood_(support::built(grown())),
          leaves_(trees::place_leaves(wood_, few_leaves())),
          air_(value_of(
              trees::wind_field<B>::create(device, trees::segment_middles(wood_), gusts()))),
          tree_(value_of(trees::swaying_tree<B>::create(device, wood_, leaves_, {}, thin()))),
          surfaces_(value_of(scenes::tree_surfaces<B>::create(
              device, tree_, trees::draw_leaf(trees::leaf_shape::round, 32)))),
          scene_(with_lawn(device)), light_(device, *scene_) {}

    /// Half a second of sway, and the light.
    [[nodiscard]] const std::vector<glm::vec4>& next() {
        for (int i = 0; i < 10; ++i) {
            seconds_ += 0.05;
            expect_done(run(*device_, [&](auto& to) { tree_.advance(to, air_, seconds_, 0.05f); }));
        }
        expect_done(run(*device_, [&](auto& to) {
            tree_.mesh(to);
            surfaces_.record(to, tree_, scene_->triangles());
            scene_->record_samples(to);
        }));
        return light_.gather();
    }

    [[nodiscard]] const gather::gather_scene<B>& scene() const { return *scene_; }
    [[nodiscard]] const scenes::tree_surfaces<B>& surfaces() const { return surfaces_; }
    [[nodiscard]] const trees::swaying_tree<B>& tree() const { return tree_; }

    [[nodiscard]] std::vector<gather_triangle> triangles() {
        std::vector<gather_triangle> all(scene_->triangle_count());
        const buffer_view<B> from = scene_->triangles();
        expect_done(read_back<B, gather_triangle>(*device_, *from.buffer, all));
        return all;
    }

    /// The light of these triangles, by a scene that has never seen others.
    [[nodiscard]] std::vector<glm::vec4> cold_start(std::span<const gather_triangle> all) {
        gather::scene_description what = surfaces_.describe();
        what.triangles = all;
        what.lift = scene_->lift();
        const auto scene = value_of(gather::gather_scene<B>::create(*device_, what));
        frame_light<B> light(*device_, scene);
        return light.gather();
    }

  private:
    static const trees::species_entry& aspen() { return *trees::find_species("quaking_aspen"); }
    static auto grown() {
        trees::weber_penn_parameters parameters = aspen().parameters;
        parameters.levels = 2;
        return value_of(trees::grow(parameters, 1));
    }
    static trees::leaf_options few_leaves() {
        trees::leaf_options options = trees::leaves_of(aspen());
        options.most = 400;
        options.length *= 3;
        return options;
    }
    static auto thin() {
        typename trees::swaying_tree<B>::options_type options;
        options.branches.sides = 3;
        options.branches.rings = 2;
        return options;
    }
    static trees::kaimal_gusts gusts() {
        trees::kaimal_gusts model;
        model.speed = 10;
        return model;
    }
    [[nodiscard]] std::unique_ptr<gather::gather_scene<B>> with_lawn(B& device) {
        scenes::surface_list& around = surfaces_.surroundings();
        scenes::add_ground(around, scenes::add_paint(around, {0.2f, 0.3f, 0.1f}), 4, 8);
        return std::make_unique<gather::gather_scene<B>>(
            value_of(gather::gather_scene<B>::create(device, surfaces_.describe())));
    }

    B* device_;
    trees::skeleton wood_;
    std::vector<leaf> leaves_;
    trees::wind_field<B> air_;
    trees::swaying_tree<B> tree_;
    scenes::tree_surfaces<B> surfaces_;
    std::unique_ptr<gather::gather_scene<B>> scene_;
    frame_light<B> light_;
    double seconds_ = 0;
};

bool same_bits(std::span<const glm::vec4> a, std::span<const glm::vec4> b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

class moving_scene : public testing::TestWithParam<const char*> {};

TEST_P(moving_scene, has_the_light_of_a_cold_start) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        swaying_scene<B> moving(device);
        ASSERT_GE(moving.surfaces().triangles(), 3000u);
        std::vector<glm::vec4> last;
        std::vector<gather_triangle> before = moving.triangles();
        for (int frame = 0; frame < 3; ++frame) {
            const std::vector<glm::vec4> found = moving.next();
            const std::vector<gather_triangle> now = moving.triangles();
            EXPECT_TRUE(same_bits(found, moving.cold_start(now))) << "frame " << frame;
            EXPECT_FALSE(same_bits(found, last)) << "frame " << frame;
            EXPECT_NE(std::memcmp(now.data(), before.data(), sizeof(now[0]) * 100), 0);
            last = found;
            before = now;
        }
        // Some of the ground is in the sun, some in the shade, all of it under the sky.
        const auto lit =
            std::count_if(last.begin(), last.end(), [](const glm::vec4& e) { return e.x > 2.0f; });
        const auto dark =
            std::count_if(last.begin(), last.end(), [](const glm::vec4& e) { return e.x < 1.2f; });
        EXPECT_GE(lit, 30);
        EXPECT_GE(dark, 10);
    });
}

TEST_P(moving_scene, has_the_tree_that_is_drawn) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        swaying_scene<B> moving(device);
        (void)moving.next();
        const std::vector<gather_triangle> now = moving.triangles();
        const auto wood = value_of(moving.tree().branches().download(device));
        const auto leaves = value_of(moving.tree().leaves().download(device));
        std::size_t number = 0;
        for (const trees::host_mesh* mesh : {&wood, &leaves}) {
            const bool leaf = mesh == &leaves;
            ASSERT_TRUE(!leaf || number == moving.surfaces().first_leaf());
            for (std::size_t i = 0; i < mesh->indices.size(); i += 3, ++number) {
                const gather_triangle& t = now[number];
                ASSERT_EQ(t.a, mesh->vertices[mesh->indices[i]].position) << number;
                ASSERT_EQ(t.b, mesh->vertices[mesh->indices[i + 1]].position) << number;
                ASSERT_EQ(t.c, mesh->vertices[mesh->indices[i + 2]].position) << number;
                ASSERT_EQ(t.material, leaf ? 1u : 0u) << number;
                ASSERT_EQ(t.alpha, leaf ? number - moving.surfaces().first_leaf() + 1 : 0u);
            }
        }
        EXPECT_EQ(number, moving.surfaces().triangles());
        EXPECT_EQ(number + 128, now.size()) << "and the lawn";
    });
}

TEST_P(moving_scene, sends_down_what_is_asked_for) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        swaying_scene<B> moving(device);
        (void)moving.next();
        const device_traffic before = device.traffic();
        (void)moving.next();
        EXPECT_EQ(device.traffic().down - before.down, 300 * sizeof(glm::vec4));
        // What calls are told: 18 bundles in some ten calls of at most 128 bytes, and the wind's
        // ten steps of 2 kB. Triangles would be 48 bytes each.
        const std::uint64_t told = 18 * 10 * 128 + 10 * 2048;
        EXPECT_LE(device.traffic().up - before.up, told);
        EXPECT_GT(48ull * moving.surfaces().triangles(), 2 * told);
    });
}

INSTANTIATE_TEST_SUITE_P(backends, moving_scene, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& name) { return std::string(name.param); });

TEST(moving_scene, makes_no_objects) {
    conformance::null_device device;
    swaying_scene<conformance::null_device> moving(device);
    (void)moving.next();
    const auto before = device.counts();
    (void)moving.next();
    (void)moving.next();
    EXPECT_EQ(device.counts().buffers_made, before.buffers_made);
    EXPECT_EQ(device.counts().images_made, before.images_made);
    EXPECT_GT(device.counts().maps, before.maps);
}

TEST(moving_scene, allocates_nothing) {
    if (SKYBARK_TEST_COUNTS_ALLOCATIONS == 0) {
        GTEST_SKIP() << "Allocations are the sanitizer's here.";
    }
    cpu::device device;
    swaying_scene<cpu::device> moving(device);
    (void)moving.next();
    (void)moving.next();
    const std::uint64_t before = support::allocations;
    ::operator delete(::operator new(1000));
    ASSERT_EQ(support::allocations, before + 1) << "the counting works";
    (void)moving.next();
    (void)moving.next();
    EXPECT_EQ(support::allocations, before + 1);
}

} // namespace
