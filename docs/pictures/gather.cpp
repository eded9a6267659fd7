// Draws the pictures of gathered light, on the CPU: skybark_gather_pictures FOLDER [--draft]
// [NAME…]
//
//   --draft        an eighth of the directions, a quarter of the places
//   box            the box, four bounces: colour bleeds from its walls
//   park           balls and boxes under a sky: direct light, and with three bounces
//   park_error     what a gather says of its own error, and what the error is
//   tree           a tree in the sun on a white floor: light that has come through leaves

#include <io/write_png.hpp>
#include <picture/gather_picture.hpp>
#include <scenes/scenes.hpp>
#include <scenes/tree_light.hpp>
#include <skybark/cpu/cpu.hpp>
#include <skybark/gather/bounces.hpp>
#include <skybark/trees/build_skeleton.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using skybark::result;
using backend = skybark::cpu::device;
namespace gather = skybark::gather;
namespace picture = skybark::picture;
namespace scenes = skybark::scenes;

struct distant_light {
    glm::vec3 towards{0, 1, 0};
    glm::vec3 irradiance{0}; ///< across the beam, W/m²
};

/// A scene, how it is lit, and from where it is looked at.
struct shot {
    gather::scene_description scene;
    distant_light sun;
    gather::sky_radiance sky;
    picture::gather_view view;
    std::uint32_t bounces = 0;       ///< before the last gather, which is one more
    std::uint64_t bounce_axes = 256; ///< of each
    std::uint64_t axes = 512;        ///< of the last
};

/// Light at all places that a picture sees.
struct gathered {
    picture::seen_places places;
    std::vector<glm::vec4> irradiance;
};

/// A sky that is whiter towards the horizon; what is below it is dark.
glm::vec3 clear_sky(glm::vec3 from) {
    const float up = std::max(from.y, 0.0f);
    const glm::vec3 above = glm::mix(glm::vec3(1.05f, 1.02f, 0.98f), glm::vec3(0.50f, 0.70f, 1.0f),
                                     1 - std::exp(-3.5f * up));
    return from.y >= 0 ? above : glm::vec3(0);
}

class studio {
  public:
    studio(std::string folder, bool draft) : folder_(std::move(folder)), draft_(draft) {}

    /// As asked for, or less of it.
    [[nodiscard]] shot set(shot of) const {
        if (draft_) {
            of.view.width /= 2;
            of.view.height /= 2;
            of.axes /= 8;
            of.bounce_axes /= 8;
        }
        return of;
    }

    /// The light, at places that are found first or given.
    result<gathered> light(const shot& of, const picture::seen_places* given = nullptr) {
        gather::bounce_options options;
        options.axes = of.bounce_axes;
        options.gather.sky = of.sky;
        auto scene = gather::gather_scene<backend>::create(device_, of.scene);
        if (!scene) {
            return skybark::failure(scene.error());
        }
        gathered found;
        if (given != nullptr) {
            found.places = *given;
        } else {
            auto seen = picture::see(device_, scene->triangles(), scene->alpha(),
                                     of.scene.triangles, of.scene.materials, of.view);
            if (!seen) {
                return skybark::failure(seen.error());
            }
            found.places = std::move(*seen);
        }
        auto done = bounce(*scene, of, options);
        if (!done) {
            return skybark::failure(done.error());
        }
        auto last = gather::final_gather<backend>::create(device_, *scene, found.places.samples,
                                                          options.gather);
        if (!last) {
            return skybark::failure(last.error());
        }
        found.irradiance.resize(found.places.samples.size());
        done = last->light_from(of.sun.towards, of.sun.irradiance)
                   .and_then([&] { return last->add(of.axes); })
                   .and_then([&] { return last->read(found.irradiance); });
        if (!done) {
            return skybark::failure(done.error());
        }
        return found;
    }

    result<void> draw(const std::string& name, const shot& of, const gathered& found,
                      float exposure) {
        return develop(name, of.view,
                       picture::radiance_seen(found.places, found.irradiance, of.scene.triangles,
                                              of.scene.materials, of.view,
                                              [&](glm::vec3 from) {
                                                  from.y = std::abs(from.y);
                                                  return of.sky ? of.sky(from) : glm::vec3(0);
                                              }),
                       exposure);
    }

    /// One value a sample, 0…1, as a colour: dark blue, green, yellow.
    result<void> draw_values(const std::string& name, const shot& of,
                             const picture::seen_places& places, std::span<const float> values) {
        static constexpr std::array<glm::vec3, 5> colours{{{0.05f, 0.01f, 0.20f},
                                                           {0.15f, 0.10f, 0.55f},
                                                           {0.05f, 0.45f, 0.55f},
                                                           {0.30f, 0.75f, 0.30f},
                                                           {1.00f, 0.95f, 0.25f}}};
        const std::uint32_t side = of.view.supersampling;
        std::vector<std::uint8_t> pixels(std::size_t{4} * of.view.width * of.view.height, 255);
        for (std::uint32_t i = 0; i < of.view.width * of.view.height; ++i) {
            glm::vec3 sum(0);
            for (std::uint32_t k = 0; k < side * side; ++k) {
                const std::uint32_t x = i % of.view.width * side + k % side;
                const std::uint32_t y = i / of.view.width * side + k / side;
                const std::uint32_t sample = places.places[y * of.view.columns() + x].here;
                if (sample != picture::no_sample) {
                    const float at = std::clamp(values[sample], 0.0f, 0.9999f) * 4;
                    const auto below = static_cast<std::size_t>(at);
                    sum += glm::mix(colours[below], colours[below + 1],
                                    at - static_cast<float>(below));
                }
            }
            for (int c = 0; c < 3; ++c) {
                pixels[4 * std::size_t{i} + static_cast<std::size_t>(c)] =
                    static_cast<std::uint8_t>(sum[c] * 255 / static_cast<float>(side * side));
            }
        }
        return write(name, of.view, pixels);
    }

    [[nodiscard]] backend& device() { return device_; }

  private:
    result<void> bounce(const gather::gather_scene<backend>& scene, const shot& of,
                        const gather::bounce_options& options) {
        if (of.bounces == 0) {
            return {};
        }
        auto light = gather::bounced_light<backend>::create(device_, scene, options);
        if (!light) {
            return skybark::failure(light.error());
        }
        light->light_from(of.sun.towards, of.sun.irradiance);
        return light->bounce(of.bounces);
    }

    result<void> develop(const std::string& name, const picture::gather_view& view,
                         std::span<const glm::vec4> radiance, float exposure) {
        const auto pixels = picture::develop(device_, radiance, view, exposure);
        if (!pixels) {
            return skybark::failure(pixels.error());
        }
        return write(name, view, *pixels);
    }

    result<void> write(const std::string& name, const picture::gather_view& view,
                       std::span<const std::uint8_t> pixels) {
        return skybark::io::write_png(folder_ + "/" + name + ".png", pixels, view.width,
                                      view.height);
    }

    std::string folder_;
    bool draft_;
    backend device_;
};

// ---- The pictures
// --------------------------------------------------------------------------------

shot box_shot(const scenes::surface_list& box) {
    shot made;
    made.scene.triangles = box.triangles;
    made.scene.materials = box.materials;
    made.scene.patch_size = 0.2f;
    made.view.eye = {0, 2.75f, 11.0f};
    made.view.target = {0, 2.75f, 0};
    made.view.field_of_view = 39;
    made.view.nearest = 4;
    made.view.width = made.view.height = 400;
    made.bounces = 4;
    made.bounce_axes = 1024;
    made.axes = 8192;
    return made;
}

result<void> draw_box(studio& in) {
    const scenes::surface_list box = scenes::cornell();
    const shot whole = in.set(box_shot(box));
    const auto found = in.light(whole);
    if (!found) {
        return skybark::failure(found.error());
    }
    return in.draw("gather_box", whole, *found, 0.9f);
}

shot park_shot(const scenes::surface_list& park) {
    shot made;
    made.scene.triangles = park.triangles;
    made.scene.materials = park.materials;
    made.sky = clear_sky;
    made.view.eye = {4.0f, 6.2f, 12.0f};
    made.view.target = {0, 0.1f, 0.8f};
    made.view.field_of_view = 33;
    made.view.nearest = 2;
    made.view.width = 720;
    made.view.height = 480;
    made.axes = 384;
    return made;
}

result<void> draw_park(studio& in) {
    const scenes::surface_list park = scenes::park();
    shot of = in.set(park_shot(park));
    const auto direct = in.light(of);
    if (!direct) {
        return skybark::failure(direct.error());
    }
    auto done = in.draw("gather_park_direct", of, *direct, 0.8f);
    if (!done) {
        return done;
    }
    of.bounces = 3;
    const auto bounced = in.light(of, &direct->places);
    if (!bounced) {
        return skybark::failure(bounced.error());
    }
    return in.draw("gather_park", of, *bounced, 0.8f);
}

result<void> draw_park_error(studio& in) {
    const scenes::surface_list park = scenes::park();
    shot few = park_shot(park);
    few.view.width = 450;
    few.view.height = 300;
    few.view.supersampling = 1;
    few.axes = 128;
    few = in.set(few);
    const auto coarse = in.light(few);
    if (!coarse) {
        return skybark::failure(coarse.error());
    }
    shot many = few;
    many.axes *= 24;
    const auto fine = in.light(many, &coarse->places);
    if (!fine) {
        return skybark::failure(fine.error());
    }
    constexpr float most = 0.15f; // of the light
    std::vector<float> said(coarse->irradiance.size());
    std::vector<float> is(said.size());
    for (std::size_t i = 0; i < said.size(); ++i) {
        const auto luminance = [](glm::vec4 e) {
            return 0.2126f * e.x + 0.7152f * e.y + 0.0722f * e.z;
        };
        const float light = std::max(luminance(fine->irradiance[i]), 1e-6f);
        said[i] = coarse->irradiance[i].w / light / most;
        is[i] = std::abs(luminance(coarse->irradiance[i]) - light) / light / most;
    }
    return in.draw_values("gather_error_said", few, coarse->places, said).and_then([&] {
        return in.draw_values("gather_error_is", few, coarse->places, is);
    });
}

result<void> draw_tree(studio& in) {
    namespace trees = skybark::trees;
    trees::species_entry species = *trees::find_species("quaking_aspen");
    species.parameters.scale = 5; // a young one
    species.parameters.scale_v = 0;
    species.parameters.base_size = 0.15f;
    species.parameters.levels = 3;
    const auto wood = trees::grow(species.parameters, 3).and_then([](const auto& segments) {
        return trees::build_skeleton(segments);
    });
    if (!wood) {
        return skybark::failure(wood.error());
    }
    trees::leaf_options leaves = trees::leaves_of(species);
    leaves.most = 1'300;
    leaves.length = 0.2f;
    const auto placed = trees::place_leaves(*wood, leaves);
    trees::swaying_tree<backend>::options_type options;
    options.branches.sides = 6;
    options.branches.rings = 2;
    const auto tree = trees::swaying_tree<backend>::create(in.device(), *wood, placed, {}, options);
    if (!tree) {
        return skybark::failure(tree.error());
    }
    auto surfaces = scenes::tree_surfaces<backend>::create(in.device(), *tree,
                                                           trees::draw_leaf(leaves.shape, 128));
    if (!surfaces) {
        return skybark::failure(surfaces.error());
    }
    auto& around = surfaces->surroundings();
    scenes::add_ground(around, scenes::add_paint(around, glm::vec3(0.5f)), 12, 96);
    shot of;
    of.scene = surfaces->describe();
    of.sky = [](glm::vec3 from) { return 0.15f * clear_sky(from); };
    of.sun.towards = glm::normalize(glm::vec3(0.35f, 0.9f, 0.3f));
    of.sun.irradiance = glm::vec3(14, 13, 11.5f);
    const gather::bounds box =
        gather::bounds_of(std::span(of.scene.triangles).subspan(0, surfaces->triangles()));
    std::printf("tree: %u triangles, from %g %g %g to %g %g %g\n", surfaces->triangles(),
                static_cast<double>(box.low.x), static_cast<double>(box.low.y),
                static_cast<double>(box.low.z), static_cast<double>(box.high.x),
                static_cast<double>(box.high.y), static_cast<double>(box.high.z));
    of.view.eye = {-1.6f, 2.4f, 6.0f};
    of.view.target = {-0.5f, 0.12f * box.high.y, 0};
    of.view.field_of_view = 36;
    of.view.nearest = 1;
    of.view.width = 480;
    of.view.height = 480;
    of.bounces = 3;
    of.bounce_axes = 64;
    of.axes = 512;
    of = in.set(of);
    const auto found = in.light(of);
    if (!found) {
        return skybark::failure(found.error());
    }
    return in.draw("gather_tree", of, *found, 0.6f);
}

struct entry {
    const char* name;
    result<void> (*draw)(studio&);
};
constexpr entry entries[] = {
    {"box", draw_box}, {"park", draw_park}, {"park_error", draw_park_error}, {"tree", draw_tree}};

} // namespace

int main(int count, char** words) {
    if (count < 2) {
        std::fprintf(stderr, "skybark_gather_pictures FOLDER [--draft] [NAME…]\n");
        return 2;
    }
    std::vector<std::string> names(words + 2, words + count);
    const bool draft = std::erase(names, "--draft") != 0;
    studio in(words[1], draft);
    for (const entry& one : entries) {
        const bool wanted =
            names.empty() || std::find(names.begin(), names.end(), one.name) != names.end();
        if (!wanted) {
            continue;
        }
        if (const auto done = one.draw(in); !done) {
            std::fprintf(stderr, "%s\n", done.error().message.c_str());
            return 1;
        }
    }
}
