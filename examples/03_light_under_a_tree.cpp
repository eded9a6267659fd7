// Light under a tree that sways: gathered anew each frame, with nothing built beforehand. The
// triangles never leave the device.

#include <scenes/tree_light.hpp>
#include <skybark/cpu/cpu.hpp>
#include <skybark/skybark.hpp>

#include <cstdio>

namespace {

using backend = skybark::cpu::device; // or skybark::vulkan::device, skybark::opengl::device
namespace gather = skybark::gather;
namespace trees = skybark::trees;

constexpr glm::vec3 sunlight(3.0f, 2.8f, 2.4f); // W/m² across the beam
const glm::vec3 to_sun = glm::normalize(glm::vec3(0.5f, 1, 0.3f));
constexpr int samples_a_side = 24;

/// A young aspen in a wind of 10 m/s.
struct tree_in_the_wind {
    trees::wind_field<backend> air;
    trees::swaying_tree<backend> tree;
    skybark::scenes::tree_surfaces<backend> surfaces;
};

skybark::result<tree_in_the_wind> plant(backend& device) {
    trees::species_entry aspen = *trees::find_species("quaking_aspen");
    aspen.parameters.levels = 2;
    const auto grown = trees::grow(aspen.parameters, 1).and_then([](const auto& segments) {
        return trees::build_skeleton(segments);
    });
    if (!grown) {
        return skybark::failure(grown.error());
    }
    trees::leaf_options few = trees::leaves_of(aspen);
    few.length *= 4;
    few.most = 2000;
    trees::kaimal_gusts gusts;
    gusts.speed = 10;
    auto air = trees::wind_field<backend>::create(device, trees::segment_middles(*grown), gusts);
    if (!air) {
        return skybark::failure(air.error());
    }
    auto tree = trees::swaying_tree<backend>::create(device, *grown,
                                                     trees::place_leaves(*grown, few), {}, {});
    if (!tree) {
        return skybark::failure(tree.error());
    }
    auto surfaces = skybark::scenes::tree_surfaces<backend>::create(
        device, *tree, trees::draw_leaf(few.shape, 64));
    if (!surfaces) {
        return skybark::failure(surfaces.error());
    }
    return tree_in_the_wind{std::move(*air), std::move(*tree), std::move(*surfaces)};
}

/// Points on the lawn, one a quarter of a metre.
std::vector<skybark::gather_sample> on_the_lawn() {
    std::vector<skybark::gather_sample> samples;
    for (int i = 0; i < samples_a_side * samples_a_side; ++i) {
        skybark::gather_sample s;
        s.position = {0.25f * static_cast<float>(i % samples_a_side) - 3, 0,
                      0.25f * static_cast<float>(i / samples_a_side) - 3};
        s.normal = {0, 1, 0};
        samples.push_back(s);
    }
    return samples;
}

/// What the lawn looks like from above: the brighter, the denser.
void show(std::span<const glm::vec4> light) {
    constexpr char shades[] = " .:-=+*#%@";
    for (std::size_t i = 0; i < light.size(); ++i) {
        const float shade = glm::clamp(light[i].y / 4, 0.0f, 0.99f);
        std::putchar(shades[static_cast<int>(shade * 10)]);
        std::putchar(i % samples_a_side + 1 == samples_a_side ? '\n' : ' ');
    }
}

skybark::result<void> frames(backend& device, tree_in_the_wind& made, int count) {
    auto& around = made.surfaces.surroundings();
    skybark::scenes::add_ground(around, skybark::scenes::add_paint(around, {0.2f, 0.3f, 0.1f}), 4,
                                8);
    auto scene = gather::gather_scene<backend>::create(device, made.surfaces.describe());
    if (!scene) {
        return skybark::failure(scene.error());
    }
    gather::bounce_options options;
    options.axes = 8; // a frame: each serves two directions, for all patches and samples at once
    options.gather.sky = gather::even_sky({0.25f, 0.35f, 0.6f});
    auto bounces = gather::bounced_light<backend>::create(device, *scene, options);
    auto light =
        gather::final_gather<backend>::create(device, *scene, on_the_lawn(), options.gather);
    if (!bounces || !light) {
        return skybark::failure(bounces ? light.error() : bounces.error());
    }
    bounces->light_from(to_sun, sunlight);
    std::vector<glm::vec4> found(light->samples());
    for (int frame = 0; frame < count; ++frame) {
        auto done = skybark::run(device, [&](auto& recorder) {
            made.tree.advance(recorder, made.air, frame / 30.0, 1 / 30.0f);
            made.tree.mesh(recorder);
            made.surfaces.record(recorder, made.tree, scene->triangles());
            scene->record_samples(recorder);
        });
        done = done.and_then([&] { return bounces->restart(); })
                   .and_then([&] { return bounces->bounce(); })
                   .and_then([&] { return light->restart(1); })
                   .and_then([&] { return light->light_from(to_sun, sunlight); })
                   .and_then([&] { return light->add(16); })
                   .and_then([&] { return light->read(found); });
        if (!done) {
            return done;
        }
    }
    std::printf("Light on the lawn under %u triangles after %d frames:\n", scene->triangle_count(),
                count);
    show(found);
    return {};
}

} // namespace

int main() {
    backend device;
    auto done =
        plant(device).and_then([&](tree_in_the_wind made) { return frames(device, made, 20); });
    if (!done) {
        std::fprintf(stderr, "%s\n", done.error().message.c_str());
        return 1;
    }
}
