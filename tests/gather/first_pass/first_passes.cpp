// First passes from the host as what a gather begins with: the same light as by bounces on the
// device.

#include "gather/first_pass/boxes.hpp"

#include <first_pass/photon_map.hpp>
#include <first_pass/radiosity.hpp>
#include <skybark/cpu/cpu.hpp>
#include <skybark/gather/bounces.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using support::surfaces_of;

namespace {

/// A room, its patches, and points on its floor.
class first_pass_of_a_room : public testing::Test {
  protected:
    void SetUp() override {
        gather::scene_description what;
        what.triangles = room_.triangles;
        what.materials = room_.materials;
        what.patch_size = 0.3f;
        auto scene = gather::gather_scene<cpu::device>::create(device_, what);
        ASSERT_TRUE(scene) << scene.error().message;
        scene_.emplace(std::move(*scene));
        tables_.resize(room_.triangles.size());
        ASSERT_TRUE((read_back<cpu::device, patch_table>(device_, *scene_->tables().buffer,
                                                         std::span(tables_))));
        patches_ = first_pass::patches_of(surfaces_of(room_), tables_);
        ASSERT_EQ(patches_.size(), scene_->patch_count());
        for (int i = 0; i < 100; ++i) {
            gather_sample s;
            s.position = {0.08f + 0.09f * static_cast<float>(i % 10), 0,
                          0.08f + 0.09f * static_cast<float>(i / 10)};
            s.normal = {0, 1, 0};
            samples_.push_back(s);
        }
    }

    [[nodiscard]] std::vector<glm::vec4> gathered() {
        auto gather = gather::final_gather<cpu::device>::create(device_, *scene_, samples_);
        std::vector<glm::vec4> found(samples_.size());
        EXPECT_TRUE(gather && gather->add(2048) && gather->read(found));
        return found;
    }

    /// What ten bounces on the device come to.
    [[nodiscard]] std::vector<glm::vec4> bounced() {
        gather::bounce_options options;
        options.axes = 1024;
        auto light = gather::bounced_light<cpu::device>::create(device_, *scene_, options);
        EXPECT_TRUE(light && light->bounce(10));
        return gathered();
    }

    void begin_with(std::span<const glm::vec4> radiance) {
        auto light = gather::bounced_light<cpu::device>::create(device_, *scene_);
        EXPECT_TRUE(light && light->set_radiance(radiance));
    }

    /// Mean difference of the two over the mean.
    [[nodiscard]] static double apart(std::span<const glm::vec4> a, std::span<const glm::vec4> b) {
        double difference = 0;
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            difference += std::abs(static_cast<double>(a[i].x) - static_cast<double>(b[i].x));
            sum += static_cast<double>(b[i].x);
        }
        return difference / sum;
    }

    scenes::surface_list room_ = support::lit_room();
    cpu::device device_;
    std::optional<gather::gather_scene<cpu::device>> scene_;
    std::vector<patch_table> tables_;
    std::vector<first_pass::patch> patches_;
    std::vector<gather_sample> samples_;
};

// Patches lie where the device has them: their middles are its samples.
TEST_F(first_pass_of_a_room, has_the_devices_patches) {
    std::vector<gather_sample> theirs(patches_.size());
    ASSERT_TRUE((read_back<cpu::device, gather_sample>(device_, *scene_->patch_samples().buffer,
                                                       std::span(theirs))));
    const auto ours = first_pass::middles_of(patches_);
    for (std::size_t i = 0; i < ours.size(); ++i) {
        ASSERT_LE(glm::distance(ours[i].position, theirs[i].position), 1e-6f) << i;
        ASSERT_LE(glm::distance(ours[i].normal, theirs[i].normal), 1e-6f) << i;
    }
}

// Direct light is gathered from the lamp either way; a third of the light is indirect, and what
// radiosity errs by in a patch is smoothed over.
TEST_F(first_pass_of_a_room, by_radiosity_has_the_light_of_bounces) {
    const auto truth = bounced();
    const auto found = first_pass::radiosity(surfaces_of(room_), tables_, {}, {});
    ASSERT_TRUE(found) << found.error().message;
    begin_with(found->radiance);
    const double error = apart(gathered(), truth);
    RecordProperty("apart", std::to_string(error));
    EXPECT_LE(error, 0.005);
}

TEST_F(first_pass_of_a_room, by_photons_has_the_light_of_bounces) {
    const auto truth = bounced();
    first_pass::photon_options options;
    options.photons = 300'000;
    const auto map = first_pass::photon_map::trace(surfaces_of(room_), {}, options);
    ASSERT_TRUE(map) << map.error().message;
    const auto irradiance = map->irradiance(first_pass::middles_of(patches_), 60);
    begin_with(first_pass::leaving_radiance(surfaces_of(room_), patches_, irradiance));
    const double error = apart(gathered(), truth);
    RecordProperty("apart", std::to_string(error));
    // Half of the disk of an estimate lies beyond the wall near an edge: those are too dark.
    EXPECT_LE(error, 0.02);
}

} // namespace
