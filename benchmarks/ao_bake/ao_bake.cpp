// Ambient occlusion of the park's ground in a square map of texels. benchmarks/ao_bake/run bakes
// the same with Blender's Cycles, and calls this.
//
//   skybark_ao_bake scene OUT.obj        the park, its ground an object with a map of its own
//   skybark_ao_bake bake SIDE OTHER.raw SECONDS
//       bakes until the error is no larger than that of OTHER.raw (SIDE² floats, the bottom row
//       first), which took SECONDS, and prints both
//
// The error is the rms over some 4,000 of the texels, against 4,096 directions; occlusion is 0…1,
// 1 in the open, and `mean` says how far it is off on average. Texels whose corners differ by more
// than 0.02 are left out: there lie edges, and Cycles bakes a texel's mean where we bake its
// middle. Our seconds count everything from the scene in memory to the map in memory.

#include "../devices.hpp"

#include <scenes/park.hpp>
#include <skybark/gather/final_gather.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace skybark::benchmarks {
namespace {

using clock = std::chrono::steady_clock;
using device_scene = gather::gather_scene<cpu::device>;

constexpr float half_width = 10; // of the park's ground, m

[[nodiscard]] double seconds_since(clock::time_point begin) {
    return std::chrono::duration<double>(clock::now() - begin).count();
}

int write_scene(const char* path) {
    std::FILE* file = std::fopen(path, "w");
    if (!file) {
        std::fprintf(stderr, "%s can't be written.\n", path);
        return 1;
    }
    const auto scene = scenes::park();
    const auto number = [](float x) { return static_cast<double>(x); };
    std::uint32_t corners = 0;
    for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) {
        if (i == 0 || i == scenes::park_ground_triangles) {
            std::fprintf(file, "o %s\n", i == 0 ? "ground" : "others");
        }
        const gather_triangle& t = scene.triangles[i];
        for (const glm::vec3 p : {t.a, t.b, t.c}) {
            const glm::vec2 at(0.5f + 0.5f * p.x / half_width, 0.5f - 0.5f * p.z / half_width);
            std::fprintf(file, "v %.9g %.9g %.9g\nvt %.9g %.9g\n", number(p.x), number(p.y),
                         number(p.z), number(at.x), number(at.y));
        }
        corners += 3;
        std::fprintf(file, "f %u/%u %u/%u %u/%u\n", corners - 2, corners - 2, corners - 1,
                     corners - 1, corners, corners);
    }
    return std::fclose(file) == 0 ? 0 : 1;
}

/// On the ground at (column, row) of the map, in texels from its bottom left corner.
[[nodiscard]] gather_sample place_of(double column, double row, std::uint32_t side) {
    gather_sample at;
    const double texel = 2.0 * static_cast<double>(half_width) / side;
    at.position = {static_cast<float>(column * texel - static_cast<double>(half_width)), 0,
                   static_cast<float>(static_cast<double>(half_width) - row * texel)};
    at.normal = {0, 1, 0};
    return at;
}

[[nodiscard]] result<device_scene> open_scene(cpu::device& device,
                                              const scenes::surface_list& scene) {
    gather::scene_description what;
    what.triangles = scene.triangles;
    what.materials = scene.materials;
    return device_scene::create(device, what);
}

[[nodiscard]] result<gather::final_gather<cpu::device>>
open_gather(cpu::device& device, const device_scene& scene, std::span<const gather_sample> samples,
            std::uint64_t seed) {
    gather::final_gather_options options;
    options.seed = seed;
    options.sky = gather::even_sky(glm::vec3(0.318309886f)); // of which 1 arrives in the open
    return gather::final_gather<cpu::device>::create(device, scene, samples, options);
}

struct map_error {
    double rms = 0;
    double mean = 0;
};

/// Texels that errors are told from, and what is true there.
struct checked_texels {
    std::vector<std::uint32_t> texels;
    std::vector<float> truth;

    template <class OcclusionOf>
    [[nodiscard]] map_error error_of(OcclusionOf&& occlusion_of) const {
        map_error all;
        const auto count = static_cast<double>(texels.size());
        for (std::size_t i = 0; i < texels.size(); ++i) {
            const double error =
                static_cast<double>(occlusion_of(texels[i])) - static_cast<double>(truth[i]);
            all.rms += error * error / count;
            all.mean += error / count;
        }
        all.rms = std::sqrt(all.rms);
        return all;
    }
};

[[nodiscard]] result<checked_texels> find_truth(cpu::device& device, const device_scene& scene,
                                                std::uint32_t side) {
    const std::uint32_t step = std::max(side / 64, 1u);
    std::vector<std::uint32_t> texels;
    std::vector<gather_sample> samples; // five a texel: the middle and the corners
    for (std::uint32_t row = step / 2; row < side; row += step) {
        for (std::uint32_t column = step / 2; column < side; column += step) {
            texels.push_back(row * side + column);
            for (const glm::dvec2 at : {glm::dvec2(0.5, 0.5), glm::dvec2(0, 0), glm::dvec2(1, 0),
                                        glm::dvec2(0, 1), glm::dvec2(1, 1)}) {
                samples.push_back(place_of(column + at.x, row + at.y, side));
            }
        }
    }
    auto gather = open_gather(device, scene, samples, 99);
    if (!gather) {
        return failure(gather.error());
    }
    std::vector<glm::vec4> found(samples.size());
    auto done = gather->add(4096);
    done = done ? gather->read(found) : done;
    if (!done) {
        return failure(done.error());
    }
    checked_texels checked;
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const auto [low, high] =
            std::minmax({found[5 * i].x, found[5 * i + 1].x, found[5 * i + 2].x, found[5 * i + 3].x,
                         found[5 * i + 4].x});
        if (high - low <= 0.02f) {
            checked.texels.push_back(texels[i]);
            checked.truth.push_back(found[5 * i].x);
        }
    }
    return checked;
}

[[nodiscard]] std::vector<float> read_map(const char* path, std::size_t texels) {
    std::vector<float> map(texels);
    std::FILE* file = std::fopen(path, "rb");
    if (!file || std::fread(map.data(), sizeof(float), texels, file) != texels) {
        map.clear();
    }
    if (file) {
        std::fclose(file);
    }
    return map;
}

/// Bakes with twice the directions each time, from the start, until the error is small enough.
[[nodiscard]] result<void> bake(cpu::device& device, const scenes::surface_list& park,
                                const checked_texels& checked, std::uint32_t side, double wanted,
                                double other_seconds) {
    std::vector<glm::vec4> found(std::size_t{side} * side);
    for (std::uint32_t axes = 8; axes <= 4096; axes += std::max(axes / 4, 8u)) {
        const auto begin = clock::now();
        std::vector<gather_sample> samples;
        samples.reserve(found.size());
        for (std::uint32_t i = 0; i < found.size(); ++i) {
            samples.push_back(place_of(i % side + 0.5, i / side + 0.5, side));
        }
        const auto scene = open_scene(device, park);
        if (!scene) {
            return failure(scene.error());
        }
        auto gather = open_gather(device, *scene, samples, 1);
        if (!gather) {
            return failure(gather.error());
        }
        auto done = gather->add(axes);
        done = done ? gather->read(found) : done;
        if (!done) {
            return done;
        }
        const double seconds = seconds_since(begin);
        const map_error error = checked.error_of([&](std::uint32_t i) { return found[i].x; });
        if (error.rms <= wanted) {
            std::printf("final_gather, %u directions: %.2f s, rms error %.5f, mean %+.5f\n", axes,
                        seconds, error.rms, error.mean);
            std::printf("%.1f times as fast\n", other_seconds / seconds);
            return {};
        }
    }
    return fail(error_code::bad_input, "4096 directions do not reach that error.");
}

int compare(std::uint32_t side, const char* path, double other_seconds) {
    const auto other = read_map(path, std::size_t{side} * side);
    if (other.empty()) {
        std::fprintf(stderr, "%s does not hold %u x %u floats.\n", path, side, side);
        return 1;
    }
    cpu::device device;
    const auto park = scenes::park();
    const auto scene = open_scene(device, park);
    const auto checked = scene ? find_truth(device, *scene, side) : failure(scene.error());
    if (!checked) {
        std::fprintf(stderr, "%s\n", checked.error().message.c_str());
        return 1;
    }
    const map_error wanted = checked->error_of([&](std::uint32_t i) { return other[i]; });
    std::printf("Cycles: %.2f s, rms error %.5f, mean %+.5f\n", other_seconds, wanted.rms,
                wanted.mean);
    const auto done = bake(device, park, *checked, side, wanted.rms, other_seconds);
    if (!done) {
        std::fprintf(stderr, "%s\n", done.error().message.c_str());
        return 1;
    }
    return 0;
}

} // namespace
} // namespace skybark::benchmarks

int main(int count, char** arguments) {
    const std::string what = count > 1 ? arguments[1] : "";
    if (what == "scene" && count == 3) {
        return skybark::benchmarks::write_scene(arguments[2]);
    }
    if (what == "bake" && count == 5) {
        const auto side = static_cast<std::uint32_t>(std::strtoul(arguments[2], nullptr, 10));
        return skybark::benchmarks::compare(std::clamp(side, 1u, 8192u), arguments[3],
                                            std::strtod(arguments[4], nullptr));
    }
    std::fputs("usage: skybark_ao_bake scene OUT.obj | bake SIDE OTHER.raw SECONDS\n", stderr);
    return 2;
}
