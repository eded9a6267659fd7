// Table 2 of Akagi and Kitajima: whole trees made anew every frame (skeleton in; swayed; branches,
// bark and leaves out), and drawn, at the paper's seven sizes and at 50 million polygons.
//
// A stand of aspens is cut to size: as many segments, in the order of their levels, as give the
// wood and its bark half of the polygons or less, and leaves for the rest, to within one leaf.

#include "devices.hpp"
#include "floor.hpp"
#include "paper_tree.hpp"

#include <skybark/kernels/lit_bark.hpp>
#include <skybark/kernels/lit_leaf.hpp>
#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/species.hpp>
#include <skybark/trees/swaying_tree.hpp>

#include <benchmark/benchmark.h>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

namespace skybark::benchmarks {
namespace {

constexpr std::uint64_t sizes[] = {108808,  201760,  450592,  823840,
                                   1321504, 2536192, 4109056, 50000000};
constexpr float bark_edge = 0.25f; // m
constexpr float step = 1.0f / 60;
constexpr std::uint64_t leaf_triangles = 6;

/// What a benchmark of one size is made of.
struct stand {
    trees::skeleton skeleton;
    std::vector<leaf> leaves;
    std::uint64_t polygons = 0;
};

const trees::bark_texture& bark() {
    static const trees::bark_texture texture = trees::furrowed_bark(1, 256, 256);
    return texture;
}

using options_type = trees::swaying_tree<cpu::device>::options_type;

options_type options() {
    options_type o;
    o.bark = trees::bark_options{};
    o.bark->threshold = bark_edge;
    return o;
}

/// So many aspens on a lawn, 7 m apart, each grown from its own seed.
trees::skeleton aspens(std::uint64_t count) {
    std::vector<trees::segment> all;
    const auto side = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(count))));
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto first = static_cast<std::uint32_t>(all.size());
        const glm::vec3 place(7.0f * static_cast<float>(i % side), 0,
                              7.0f * static_cast<float>(i / side));
        const auto seed = static_cast<std::uint32_t>(1 + i % 16);
        const std::vector<trees::segment> grown = *trees::grow(trees::quaking_aspen(), seed);
        for (trees::segment s : grown) {
            s.base += place;
            s.tip += place;
            s.parent += s.parent == trees::none ? 0 : first;
            all.push_back(s);
        }
    }
    return *trees::build_skeleton(all);
}

/// The first `count` segments, level by level: a skeleton as well, since parents come first.
trees::skeleton first_of(const trees::skeleton& all, std::size_t count) {
    std::vector<trees::segment> kept(std::min(count, all.size()));
    for (std::size_t i = 0; i < kept.size(); ++i) {
        kept[i] = {all.position[i], all.tip(i), all.base_radius[i], all.radius[i], all.parent[i]};
    }
    return *trees::build_skeleton(kept);
}

std::uint64_t wood_polygons(const trees::skeleton& skeleton) {
    cpu::device& device = **device_of<cpu::device>::get();
    const auto tree =
        trees::swaying_tree<cpu::device>::create(device, skeleton, {}, bark(), options());
    (void)run(device, [&](auto& to) { tree->mesh(to); });
    return *tree->triangles(device);
}

/// Leaves on the twigs, each with its own place, as many as are wanted.
std::vector<leaf> leaves_on(const trees::skeleton& skeleton, std::uint64_t count) {
    trees::leaf_options how = trees::leaves_of(*trees::find_species("quaking_aspen"));
    std::vector<leaf> leaves;
    for (how.seed = 1; leaves.size() < count; ++how.seed) {
        const std::vector<leaf> more = trees::place_leaves(skeleton, how);
        if (more.empty()) {
            break;
        }
        const std::size_t some = std::min<std::size_t>(more.size(), count - leaves.size());
        leaves.insert(leaves.end(), more.begin(), more.begin() + static_cast<std::ptrdiff_t>(some));
    }
    return leaves;
}

/// One size after the other: the last one made is kept.
const stand& stand_of(std::uint64_t polygons) {
    static stand made;
    if (made.polygons == polygons) {
        return made;
    }
    made = {};
    constexpr std::uint64_t an_aspen = 3800; // segments
    constexpr std::uint64_t a_segment = 60;  // polygons, with its fork and bark
    const std::uint64_t segments = polygons / 2 / a_segment;
    const trees::skeleton all = aspens(segments / an_aspen + 1);
    made.skeleton = first_of(all, segments);
    const std::uint64_t wood = wood_polygons(made.skeleton);
    made.leaves =
        leaves_on(made.skeleton, wood < polygons ? (polygons - wood) / leaf_triangles : 0);
    made.polygons = polygons;
    return made;
}

/// A stand, its wind and its tree on a device.
template <backend B>
struct living {
    trees::wind_field<B> air;
    trees::swaying_tree<B> tree;
    double time = 0;

    void advance(typename B::recorder& to) {
        time += static_cast<double>(step);
        tree.advance(to, air, time, step);
    }
};

template <backend B>
result<living<B>> plant(B& device, const stand& from) {
    auto air = trees::wind_field<B>::create(device, trees::segment_middles(from.skeleton),
                                            trees::kaimal_gusts{});
    if (!air) {
        return failure(air.error());
    }
    typename trees::swaying_tree<B>::options_type o;
    o.bark = options().bark;
    auto tree = trees::swaying_tree<B>::create(device, from.skeleton, from.leaves, bark(), o);
    if (!tree) {
        return failure(tree.error());
    }
    return living<B>{std::move(*air), std::move(*tree)};
}

/// Bytes of the vertices that a frame writes for good: not what passes between bark's levels.
template <backend B>
std::uint64_t bytes_of(B& device, const living<B>& from) {
    std::uint64_t bytes = from.tree.branches().vertices() * sizeof(surface_vertex) +
                          from.tree.leaves().vertices() * sizeof(surface_vertex);
    if (const auto* refined = from.tree.bark()) {
        bytes += 3 * sizeof(surface_vertex) * refined->count(device)->written;
    }
    return bytes;
}

void report(benchmark::State& state, std::uint64_t triangles, std::uint64_t bytes) {
    const auto per_run = [&](double n) {
        return benchmark::Counter(n, benchmark::Counter::kIsIterationInvariantRate);
    };
    state.counters["triangles"] = per_run(static_cast<double>(triangles));
    state.counters["bytes"] = per_run(static_cast<double>(bytes));
    state.counters["floor"] =
        per_run(floor_seconds(**device_of<cpu::device>::get(), bytes / 64 * 64));
    state.counters["polygons"] = static_cast<double>(triangles);
}

template <backend B>
void generate(benchmark::State& state) {
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    auto planted = plant<B>(**device, stand_of(static_cast<std::uint64_t>(state.range(0))));
    if (!planted) {
        state.SkipWithError(planted.error().message.c_str());
        return;
    }
    const auto frame = [&] {
        return run(**device, [&](auto& to) {
            planted->advance(to);
            planted->tree.mesh(to);
        });
    };
    auto done = frame();
    for (auto _ : state) {
        done = frame();
        if (!done) {
            state.SkipWithError(done.error().message.c_str());
            return;
        }
    }
    const auto triangles = planted->tree.triangles(**device);
    report(state, triangles ? *triangles : 0, bytes_of(**device, *planted));
}

/// The paper's CPU path with the same segments, leaves and length of the bark's edges.
void generate_paper(benchmark::State& state) {
    const stand& from = stand_of(static_cast<std::uint64_t>(state.range(0)));
    paper_options o;
    o.threshold = bark_edge;
    o.relief = trees::bark_options{}.relief;
    paper_tree tree(from.skeleton, from.leaves, bark().heights, bark().width, o);
    tree.generate(glm::vec3(8, 0, 0)); // its list has grown, as in a running program
    for (auto _ : state) {
        tree.generate(glm::vec3(8, 0, 0));
        benchmark::ClobberMemory();
    }
    report(state, tree.triangles(), 3 * sizeof(surface_vertex) * tree.triangles());
}

/// Writing as many bytes as a frame's vertices have.
void generate_floor(benchmark::State& state) {
    cpu::device& device = **device_of<cpu::device>::get();
    auto planted = plant<cpu::device>(device, stand_of(static_cast<std::uint64_t>(state.range(0))));
    if (!planted) {
        state.SkipWithError(planted.error().message.c_str());
        return;
    }
    (void)run(device, [&](auto& to) { planted->tree.mesh(to); });
    const std::uint64_t bytes = bytes_of(device, *planted) / 64 * 64;
    auto buffer = device.create_buffer(bytes);
    if (!buffer) {
        state.SkipWithError(buffer.error().message.c_str());
        return;
    }
    for (auto _ : state) {
        write_floor(device, *buffer, bytes);
    }
    report(state, *planted->tree.triangles(device), bytes);
}

/// Images and a scene to draw into: 1280 × 800, one sample a pixel, no shadows.
template <backend B>
struct canvas {
    typename B::image color, depth, shadow, bark, leaf;
    typename B::buffer scene;
};

template <backend B>
result<canvas<B>> make_canvas(B& device, const trees::bounding_box& box) {
    constexpr std::uint32_t width = 1280;
    constexpr std::uint32_t height = 800;
    const trees::leaf_picture picture = trees::draw_leaf(trees::leaf_shape::round, 64);
    const auto map = trees::normal_map(bark(), 0.025f, 0.5f, 0.7f);
    result<typename B::image> images[] = {
        device.create_image({width, height, image_format::rgba32f}),
        device.create_image({width, height, image_format::depth32f}),
        device.create_image({1, 1, image_format::depth32f}),
        device.create_image({bark().width, bark().height, image_format::rgba8}),
        device.create_image({picture.width, picture.height, image_format::rgba8})};
    for (const auto& image : images) {
        if (!image) {
            return failure(image.error());
        }
    }
    const float far = 1;
    (void)device.upload(*images[2], std::as_bytes(std::span(&far, 1)));
    (void)device.upload(*images[3], std::as_bytes(std::span(map)));
    (void)device.upload(*images[4], std::as_bytes(std::span(picture.rgba)));
    kernels::scene_record scene{};
    const glm::vec3 centre = (box.min + box.max) * 0.5f;
    const float size = glm::distance(box.min, box.max);
    const glm::vec3 eye = centre + glm::vec3(0.5f, 0.35f, 0.8f) * size;
    scene.to_clip = glm::perspectiveRH_ZO(0.9f, 1.6f, 0.01f * size, 4 * size) *
                    glm::lookAtRH(eye, centre, glm::vec3(0, 1, 0));
    scene.to_shadow = glm::mat4(0);
    scene.camera = glm::vec4(eye, 0);
    scene.shadow = {1, 1, 0, 0};
    scene.sky.to_sun = {0.3f, 0.9f, 0.3f, 0};
    scene.sky.sunlight = {3, 3, 3, 0};
    auto buffer = make_buffer<B, kernels::scene_record>(device, std::span(&scene, 1));
    if (!buffer) {
        return failure(buffer.error());
    }
    return canvas<B>{std::move(*images[0]), std::move(*images[1]), std::move(*images[2]),
                     std::move(*images[3]), std::move(*images[4]), std::move(*buffer)};
}

template <backend B>
void draw_all(typename B::recorder& to, const living<B>& from, const canvas<B>& on) {
    draw_target<B> target{&on.color, &on.depth, glm::vec4(0.5f, 0.6f, 0.8f, 1), 1.0f};
    const sampled_image<B> shadow{&on.shadow, filter_mode::nearest, wrap_mode::clamp};
    from.tree.for_each_wood([&](auto vertices, auto geometry) {
        to.draw(kernels::lit_bark{}, {vertices, view<B>(on.scene)},
                {shadow, sampled_image<B>{&on.bark, filter_mode::linear, wrap_mode::repeat}},
                geometry, target, draw_state{});
        target.clear_color.reset();
        target.clear_depth.reset();
    });
    from.tree.for_each_leaf([&](auto vertices, auto geometry) {
        to.draw(kernels::lit_leaf{}, {vertices, view<B>(on.scene)},
                {shadow, sampled_image<B>{&on.leaf, filter_mode::linear, wrap_mode::clamp}},
                geometry, target, draw_state{});
    });
}

template <backend B>
void draw(benchmark::State& state) {
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    const stand& from = stand_of(static_cast<std::uint64_t>(state.range(0)));
    auto planted = plant<B>(**device, from);
    if (!planted) {
        state.SkipWithError(planted.error().message.c_str());
        return;
    }
    const auto on = make_canvas<B>(**device, trees::bounds(from.skeleton));
    if (!on) {
        state.SkipWithError(on.error().message.c_str());
        return;
    }
    auto done = run(**device, [&](auto& to) { planted->tree.mesh(to); });
    for (auto _ : state) {
        done = run(**device, [&](auto& to) { draw_all<B>(to, *planted, *on); });
        if (!done) {
            state.SkipWithError(done.error().message.c_str());
            return;
        }
    }
    const auto triangles = planted->tree.triangles(**device);
    report(state, triangles ? *triangles : 0, 4 * 1280 * 800);
}

void add(const std::string& name, void (*function)(benchmark::State&), std::uint64_t size) {
    benchmark::RegisterBenchmark(name.c_str(), function)
        ->Arg(static_cast<std::int64_t>(size))
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
}

const bool registered = [] {
    // Size by size, so that a stand is grown once.
    for (const std::uint64_t size : sizes) {
        add("trees/generate/floor", generate_floor, size);
        add("trees/generate/cpu", generate<cpu::device>, size);
        add("trees/generate/paper", generate_paper, size);
        add("trees/generate/vulkan", generate<vulkan::device>, size);
        add("trees/generate/opengl", generate<opengl::device>, size);
        add("trees/draw/cpu", draw<cpu::device>, size);
        add("trees/draw/vulkan", draw<vulkan::device>, size);
        add("trees/draw/opengl", draw<opengl::device>, size);
    }
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
