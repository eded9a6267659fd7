// Error of gathered light against directions and against time: our bundles, a ray tracer's
// hemispheres, and irradiance caching.
//
//   skybark_gather_error SCENE [SAMPLES [DIRECTIONS [SEEDS]]]      writes CSV
//       SCENE       cornell, park, canopy
//       SAMPLES     points on its surfaces (65536)
//       DIRECTIONS  the most directions (1024)
//       SEEDS       of final_gather: its seconds and errors are means over so many (4)
//
//   method              what it is
//   final_gather        gather::final_gather on the CPU
//   embree_random       random directions, as many as their cosine, by Embree's fastest call
//   embree_lattice      the same rays, but evenly spread for each point
//   irradiance_cache_A  Ward's interpolation, of accuracy A, between records of `directions` rays
//
// Columns: scene, samples, method, directions, records (points with rays of their own), seconds
// (for all samples, on all threads), error (rms over 4,096 of the samples, of the luminance, over
// its mean), and times_faster: how many times as long random directions take to the same error.
// Embree's seconds are those of one pass, a median, times the directions; its hierarchy is built
// before. What is true is told by 2 · 8,192 evenly spread rays a point.
//
// The sky is white. Surfaces send out what they emit and what they would reflect of an open sky:
// the same light for every method.

#include "hemisphere_gather.hpp"

#include <skybark/gather/final_gather.hpp>

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace skybark::benchmarks {
namespace {

using clock = std::chrono::steady_clock;

[[nodiscard]] double seconds_since(clock::time_point begin) {
    return std::chrono::duration<double>(clock::now() - begin).count();
}

[[nodiscard]] gather_light_sources light_of(const scenes::surface_list& scene) {
    gather_light_sources light;
    light.sky = glm::vec3(1);
    for (const gather_triangle& t : scene.triangles) {
        const gather_material& m = scene.materials[t.material];
        const float up = glm::normalize(glm::cross(t.b - t.a, t.c - t.a)).y;
        const float above = 0.5f + 0.5f * up; // of the sky, that the front sees
        const glm::vec3 front = m.emission + m.diffuse * above + m.transmission * (1 - above);
        const glm::vec3 back = m.emission + m.diffuse * (1 - above) + m.transmission * above;
        light.radiance.push_back(front);
        light.radiance.push_back(m.two_sided != 0 ? back : glm::vec3(0));
    }
    return light;
}

/// All that the methods are given.
struct comparison {
    const gather_work* work;
    gather_light_sources light;
    std::unique_ptr<scenes::embree_scene> scene;
    std::vector<gather_sample> checked; ///< every stride-th sample
    std::size_t stride;
    std::vector<double> truth; ///< luminance of the irradiance there
    double mean = 0;

    [[nodiscard]] hemisphere_scene all() const {
        return {scene->get(), &light, work->samples, work->lift};
    }
    [[nodiscard]] hemisphere_scene few() const {
        return {scene->get(), &light, checked, work->lift};
    }
};

[[nodiscard]] double luminance(glm::vec3 c) {
    return 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) +
           0.0722 * static_cast<double>(c.z);
}

/// Over the mean; `irradiance_of(i)` is that of checked sample i.
template <class IrradianceOf>
[[nodiscard]] double rms_error(const comparison& c, IrradianceOf&& irradiance_of) {
    double squares = 0;
    for (std::size_t i = 0; i < c.truth.size(); ++i) {
        const double error = luminance(irradiance_of(i)) - c.truth[i];
        squares += error * error;
    }
    return std::sqrt(squares / static_cast<double>(c.truth.size())) / c.mean;
}

constexpr double pi = 3.14159265358979323846;

/// Irradiance at the checked points from n evenly spread rays each.
[[nodiscard]] std::vector<glm::vec3> lattice_irradiance(cpu::device& device, const comparison& c,
                                                        std::uint32_t n, std::uint32_t seed) {
    std::vector<glm::vec3> sums(c.checked.size(), glm::vec3(0));
    for (std::uint32_t k = 0; k < n; ++k) {
        add_rays(device, c.few(), embree_call::packet8, sums,
                 [&](const gather_sample& at, std::uint32_t i) {
                     return lattice_direction(at, i, k, n, seed);
                 });
    }
    for (glm::vec3& sum : sums) {
        sum *= static_cast<float>(pi / n);
    }
    return sums;
}

/// Fills `truth` and says how far its halves are apart.
[[nodiscard]] double find_truth(cpu::device& device, comparison& c, std::uint32_t rays) {
    const auto one = lattice_irradiance(device, c, rays, 11);
    const auto other = lattice_irradiance(device, c, rays, 12);
    double squares = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
        c.truth.push_back(0.5 * (luminance(one[i]) + luminance(other[i])));
        c.mean += c.truth.back() / static_cast<double>(one.size());
        const double apart = 0.5 * (luminance(one[i]) - luminance(other[i]));
        squares += apart * apart;
    }
    return std::sqrt(squares / static_cast<double>(one.size())) / c.mean;
}

/// Prints rows, and knows what random directions cost.
class table {
  public:
    explicit table(const gather_work& work) : work_(&work) {
        std::puts("scene,samples,method,directions,records,seconds,error,times_faster");
    }

    /// Random directions' error is `constant` / √n after n passes of so many seconds.
    void set_random(double seconds, double constant) {
        seconds_ = seconds;
        constant_ = constant;
    }

    void row(const std::string& method, std::uint64_t directions, std::size_t records,
             double seconds, double error) const {
        const double random_seconds = seconds_ * (constant_ / error) * (constant_ / error);
        std::printf("%s,%zu,%s,%llu,%zu,%.6g,%.4g,%.3g\n", work_->scene.name.c_str(),
                    work_->samples.size(), method.c_str(),
                    static_cast<unsigned long long>(directions), records, seconds, error,
                    random_seconds / seconds);
        std::fflush(stdout);
    }

  private:
    const gather_work* work_;
    double seconds_ = 0;
    double constant_ = 0;
};

/// Seconds of a pass by the fastest call: a median of five.
[[nodiscard]] double random_pass_seconds(cpu::device& device, const comparison& c,
                                         const cosine_directions& directions) {
    std::vector<glm::vec3> sums(c.work->samples.size(), glm::vec3(0));
    double best = 1e30;
    for (const embree_call call : embree_calls) {
        std::array<double, 5> seconds{};
        for (std::uint32_t turn = 0; turn < seconds.size(); ++turn) {
            const auto begin = clock::now();
            add_rays(device, c.all(), call, sums, [&](const gather_sample& at, std::uint32_t i) {
                return directions.about(at.normal, i, turn);
            });
            seconds[turn] = seconds_since(begin);
        }
        std::nth_element(seconds.begin(), seconds.begin() + 2, seconds.end());
        best = std::min(best, seconds[2]);
    }
    return best;
}

/// Returns the seconds of a pass.
double measure_random(cpu::device& device, const comparison& c, std::uint32_t most, table& out) {
    const cosine_directions directions;
    const double seconds = random_pass_seconds(device, c, directions);
    std::vector<glm::vec3> sums(c.checked.size(), glm::vec3(0));
    std::vector<std::pair<std::uint32_t, double>> errors;
    double log_constants = 0;
    for (std::uint32_t n = 1; n <= most; ++n) {
        add_rays(device, c.few(), embree_call::packet8, sums,
                 [&](const gather_sample& at, std::uint32_t i) {
                     return directions.about(at.normal, i, n);
                 });
        if ((n & (n - 1)) == 0) {
            const double error =
                rms_error(c, [&](std::size_t i) { return static_cast<float>(pi / n) * sums[i]; });
            errors.emplace_back(n, error);
            log_constants += std::log(error * std::sqrt(static_cast<double>(n)));
        }
    }
    out.set_random(seconds, std::exp(log_constants / static_cast<double>(errors.size())));
    for (const auto& [n, error] : errors) {
        out.row("embree_random", n, c.work->samples.size(), n * seconds, error);
    }
    return seconds;
}

void measure_lattice(cpu::device& device, const comparison& c, double pass_seconds,
                     std::uint32_t most, const table& out) {
    for (std::uint32_t n = 8; n <= most; n *= 4) {
        const auto irradiance = lattice_irradiance(device, c, n, 21);
        out.row("embree_lattice", n, c.work->samples.size(), n * pass_seconds,
                rms_error(c, [&](std::size_t i) { return irradiance[i]; }));
    }
}

/// The scene for our own gather, with the light of `c`.
[[nodiscard]] result<gather::gather_scene<cpu::device>> lit_scene(cpu::device& device,
                                                                  const comparison& c) {
    gather::scene_description what;
    what.triangles = c.work->scene.triangles;
    what.materials = c.work->scene.materials;
    auto scene = gather::gather_scene<cpu::device>::create(device, what);
    if (!scene) {
        return scene;
    }
    std::vector<patch_table> tables(what.triangles.size());
    std::vector<glm::vec4> radiance(scene->patch_count());
    const buffer_view<cpu::device> kept = scene->tables();
    if (auto done = read_back<cpu::device, patch_table>(device, *kept.buffer, tables); !done) {
        return failure(done.error());
    }
    for (std::size_t i = 0; i < tables.size(); ++i) {
        radiance[tables[i].front] = glm::vec4(c.light.radiance[2 * i], 0);
        if (tables[i].back != no_surface) {
            radiance[tables[i].back] = glm::vec4(c.light.radiance[2 * i + 1], 0);
        }
    }
    const auto done =
        device.upload(*scene->radiance().buffer, 0, std::as_bytes(std::span(radiance)));
    if (!done) {
        return failure(done.error());
    }
    return scene;
}

/// Squares of the errors of all seeds, and the seconds that they took.
struct seed_sums {
    double squares = 0;
    double seconds = 0;
};

/// The power of the directions that the error falls with, from eight axes a replicate on: by least
/// squares of the logarithms.
void print_exponent(const std::map<std::uint32_t, seed_sums>& sums) {
    double n = 0;
    glm::dvec2 sum(0);
    double squares = 0;
    double products = 0;
    for (auto at = sums.lower_bound(64); at != sums.end(); ++at) {
        const glm::dvec2 p(std::log(at->first), 0.5 * std::log(at->second.squares));
        ++n;
        sum += p;
        squares += p.x * p.x;
        products += p.x * p.y;
    }
    if (n > 1) {
        std::fprintf(stderr, "final_gather's error falls with the power %.2f of the directions.\n",
                     (n * products - sum.x * sum.y) / (n * squares - sum.x * sum.x));
    }
}

[[nodiscard]] result<void> measure_final_gather(cpu::device& device, const comparison& c,
                                                std::uint32_t most, std::uint32_t seeds,
                                                const table& out) {
    const auto scene = lit_scene(device, c);
    if (!scene) {
        return failure(scene.error());
    }
    gather::final_gather_options options;
    options.sky = gather::even_sky(c.light.sky);
    auto gather =
        gather::final_gather<cpu::device>::create(device, *scene, c.work->samples, options);
    if (!gather) {
        return failure(gather.error());
    }
    if (auto done = gather->add(8); !done) { // touches pages
        return done;
    }
    std::vector<glm::vec4> found(c.work->samples.size());
    std::map<std::uint32_t, seed_sums> sums;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        if (auto done = gather->restart(seed); !done) {
            return done;
        }
        double seconds = 0;
        std::uint32_t axes = 0;
        for (std::uint32_t wanted = 8; wanted <= most; wanted *= 2) {
            const auto begin = clock::now();
            auto done = gather->add(wanted - axes);
            seconds += seconds_since(begin);
            axes = wanted;
            done = done ? gather->read(found) : done;
            if (!done) {
                return done;
            }
            const double error =
                rms_error(c, [&](std::size_t i) { return glm::vec3(found[i * c.stride]); });
            sums[axes].squares += error * error / seeds;
            sums[axes].seconds += seconds / seeds;
        }
    }
    print_exponent(sums);
    for (const auto& [axes, sum] : sums) {
        out.row("final_gather", axes, c.work->samples.size(), sum.seconds, std::sqrt(sum.squares));
    }
    return {};
}

void measure_caches(cpu::device& device, const comparison& c, const table& out) {
    for (const std::uint32_t rays : {256u, 1024u}) {
        for (const float accuracy : {0.5f, 0.3f, 0.2f, 0.1f}) {
            const auto begin = clock::now();
            const cached_gather found =
                gather_cached(device, c.all(), c.work->box, {accuracy, rays});
            const double seconds = seconds_since(begin);
            char name[40];
            std::snprintf(name, sizeof name, "irradiance_cache_%.1f",
                          static_cast<double>(accuracy));
            out.row(name, rays, found.records, seconds,
                    rms_error(c, [&](std::size_t i) { return found.irradiance[i * c.stride]; }));
        }
    }
}

int compare(const std::string& scene, std::uint32_t samples, std::uint32_t most,
            std::uint32_t seeds) {
    cpu::device& device = **device_of<cpu::device>::get();
    comparison c;
    c.work = &work_of(scene, samples);
    c.light = light_of(c.work->scene);
    c.scene =
        std::make_unique<scenes::embree_scene>(c.work->scene.triangles, scenes::embree_build::fast);
    c.stride = std::max<std::size_t>(samples / 4096, 1);
    for (std::size_t i = 0; i < samples; i += c.stride) {
        c.checked.push_back(c.work->samples[i]);
    }
    const double apart = find_truth(device, c, 8192);
    table out(*c.work);
    const double pass_seconds = measure_random(device, c, most, out);
    if (auto done = measure_final_gather(device, c, most, seeds, out); !done) {
        std::fprintf(stderr, "%s\n", done.error().message.c_str());
        return 1;
    }
    measure_lattice(device, c, pass_seconds, most, out);
    measure_caches(device, c, out);
    std::fprintf(stderr, "The truth is known to %.2g of the mean.\n", apart);
    return 0;
}

} // namespace
} // namespace skybark::benchmarks

int main(int count, char** arguments) {
    const auto number = [&](int i, std::uint32_t usual) {
        return count > i ? static_cast<std::uint32_t>(std::strtoul(arguments[i], nullptr, 10))
                         : usual;
    };
    const std::string scene = count > 1 ? arguments[1] : "";
    if (scene != "cornell" && scene != "park" && scene != "canopy") {
        std::fputs(
            "usage: skybark_gather_error cornell|park|canopy [SAMPLES [DIRECTIONS [SEEDS]]]\n",
            stderr);
        return 2;
    }
    return skybark::benchmarks::compare(scene, std::max(number(2, 65536), 1u),
                                        std::max(number(3, 1024), 1u), std::max(number(4, 4), 1u));
}
