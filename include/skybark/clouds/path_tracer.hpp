#pragma once
// The reference for light in clouds: paths of photons, on the host, in double, slow and exact.
//
//     auto cloud = clouds::gaussian_medium::create(particles);
//     auto light = clouds::trace_fluence(*cloud, phase, to_sun, box.grid, box.voxels);
//     light->mean[i]  // ∫ L dω in a voxel over the sun's irradiance, light->standard_error[i]
//
// Every figure is an expectation without bias: free flights by delta tracking (Woodcock et al.
// 1965) against majorants in cells, Henyey and Greenstein's lobe by its inverse, Draine's by
// rejection from it, absorption as a weight with Russian roulette. Standard errors come from the
// means of independent batches. A path draws its random numbers from the seed and its own number
// alone, and batches are added in order: results don't depend on how many threads there are.

#include <skybark/clouds/medium.hpp>
#include <skybark/clouds/phase.hpp>

#include <array>
#include <thread>

namespace skybark::clouds {

struct path_options {
    std::uint64_t paths = 1u << 20;            ///< rounded up to a multiple of `batches`
    std::uint64_t seed = 1;                    ///< another seed: other, independent paths
    std::uint32_t batches = 32;                ///< for the standard errors, 2…4096
    std::uint32_t threads = 0;                 ///< 0: as many as the machine has
    std::uint32_t most_scatterings = 1u << 30; ///< light scattered oftener than this is lost
};

/// An expectation and how far off it may be: with 68 % probability not more than this.
struct estimate {
    double mean = 0;
    double standard_error = 0;
};

/// Shares of the flux that falls on a slab.
struct slab_light {
    estimate transmission; ///< straight on included
    estimate reflection;
    estimate absorption;
    double direct = 0; ///< e^{−depth / cosine}, exact
};

/// What sunlight makes of a cloud.
struct fluence_field {
    glm::uvec3 voxels{0};
    std::vector<double> mean;           ///< ∫ L dω over the sun's irradiance; x fastest, then y
    std::vector<double> standard_error; ///< of each voxel
    double incident = 0;                ///< m² of sunlight that were followed
    estimate escaped;                   ///< m² of sunlight that left the cloud, scattered or not
    estimate absorbed;                  ///< m² of sunlight
};

/// A ray of a camera: from where, and the unit vector away from it.
struct camera_ray {
    glm::dvec3 origin{0};
    glm::dvec3 to{0, 0, 1};
};

/// Random numbers of one path: splitmix64 (Steele, Lea and Flood 2014) from a place of its own.
class path_random {
  public:
    path_random(std::uint64_t seed, std::uint64_t path)
        : state_(mixed(mixed(seed + step) + path * 0xd1342543de82ef95ull)) {}

    /// In (0, 1).
    [[nodiscard]] double unit() {
        state_ += step;
        return (static_cast<double>(mixed(state_) >> 11) + 0.5) * 0x1p-53;
    }

  private:
    static constexpr std::uint64_t step = 0x9e3779b97f4a7c15ull;
    [[nodiscard]] static std::uint64_t mixed(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

/// The cosine of a scattering angle, distributed exactly like the phase function.
[[nodiscard]] inline double sample_cosine(const phase_function& phase, path_random& random) {
    const auto henyey_greenstein = [&](double g) {
        if (std::abs(g) < 1e-6) {
            return 2 * random.unit() - 1;
        }
        const double s = (1 - g) * (1 + g) / (1 - g + 2 * g * random.unit());
        return std::clamp((1 + g * g - s * s) / (2 * g), -1.0, 1.0);
    };
    if (phase.weight() == 0 || (phase.weight() < 1 && random.unit() >= phase.weight())) {
        return henyey_greenstein(phase.g_henyey_greenstein());
    }
    // Draine's lobe is Henyey and Greenstein's times 1 + α u² ≤ 1 + α.
    for (;;) {
        const double u = henyey_greenstein(phase.g_draine());
        if (random.unit() * (1 + phase.alpha()) < 1 + phase.alpha() * u * u) {
            return u;
        }
    }
}

namespace detail {

/// A unit vector at a given cosine from another, anywhere around it (frame: Duff et al. 2017).
[[nodiscard]] inline glm::dvec3 turned(const glm::dvec3& d, double cosine, double around) {
    const double sign = std::copysign(1.0, d.z);
    const double a = -1 / (sign + d.z);
    const double b = d.x * d.y * a;
    const glm::dvec3 s(1 + sign * d.x * d.x * a, sign * b, -sign * d.x);
    const glm::dvec3 t(b, sign + d.y * d.y * a, -d.y);
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double angle = 6.283185307179586 * around;
    return glm::normalize(sine * (std::cos(angle) * s + std::sin(angle) * t) + cosine * d);
}

/// Within 10,000 km of the world's origin, and a number.
[[nodiscard]] inline bool within_reach(const glm::dvec3& p) { return glm::dot(p, p) < 1e14; }

[[nodiscard]] inline bool unit_vector(const glm::dvec3& d) {
    return std::abs(glm::dot(d, d) - 1) < 1e-6;
}

/// Light below this weight goes on with twice the weight, or not at all.
[[nodiscard]] inline bool roulette(double& weight, path_random& random) {
    if (weight >= 0.05) {
        return true;
    }
    weight *= 2;
    return weight > 0 && random.unit() < 0.5;
}

struct collision {
    double distance = std::numeric_limits<double>::infinity(); ///< none: the light escapes
    double albedo = 0;
};

/// Where light meets matter next. A flight is begun afresh in each cell's majorant, which an
/// exponential has no memory of.
template <medium M>
[[nodiscard]] collision next_collision(const M& in, const glm::dvec3& origin, const glm::dvec3& to,
                                       path_random& random) {
    const majorant_cells& cells = in.cells();
    double left = -std::log(random.unit());
    for (cell_walk walk((origin - cells.low) / cells.side, to / cells.side, 0,
                        std::numeric_limits<double>::infinity(), cells.count);
         walk.inside(); walk.next()) {
        const std::size_t cell = cells.index(walk.cell());
        const double majorant = cells.majorant[cell];
        double t = walk.enters();
        const double leaves = walk.leaves();
        while (left < majorant * (leaves - t)) {
            t += left / majorant;
            const matter here = in.at(origin + t * to, cell);
            if (random.unit() * majorant < here.extinction) {
                return {t, here.scattering / here.extinction};
            }
            left = -std::log(random.unit());
        }
        left -= majorant * (leaves - t);
    }
    return {};
}

/// Sums over batches, and what they say of the mean.
struct batch_sum {
    double sum = 0;
    double squares = 0;
    void add(double batch_mean) {
        sum += batch_mean;
        squares += batch_mean * batch_mean;
    }
    [[nodiscard]] estimate over(std::uint64_t count) const {
        const double n = static_cast<double>(count);
        const double variance = std::max(0.0, (squares - sum * sum / n) / (n - 1));
        return {sum / n, std::sqrt(variance / n)};
    }
};

[[nodiscard]] inline std::uint32_t path_threads(const path_options& options, std::uint64_t jobs) {
    const std::uint32_t wanted =
        options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(std::min(wanted, 256u), jobs));
}

/// work(job, slot) for all jobs, `threads` at a time, then done(job, slot) in order.
template <class Work, class Done>
void in_rounds(std::uint64_t jobs, std::uint32_t threads, Work&& work, Done&& done) {
    for (std::uint64_t first = 0; first < jobs; first += threads) {
        const auto round =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(threads, jobs - first));
        std::vector<std::thread> others;
        for (std::uint32_t slot = 1; slot < round; ++slot) {
            others.emplace_back([&work, first, slot] { work(first + slot, slot); });
        }
        work(first, 0);
        for (std::thread& other : others) {
            other.join();
        }
        for (std::uint32_t slot = 0; slot < round; ++slot) {
            done(first + slot, slot);
        }
    }
}

/// What phase_function asserts: no cosine could be drawn from another.
[[nodiscard]] inline result<void> check_phase(const phase_function& phase) {
    const auto is_cosine = [](double g) { return g > -1 && g < 1; };
    if (is_cosine(phase.g_henyey_greenstein()) && is_cosine(phase.g_draine()) &&
        phase.alpha() >= 0 && phase.alpha() <= 1e300 && phase.weight() >= 0 &&
        phase.weight() <= 1) {
        return {};
    }
    return fail(error_code::bad_input,
                std::string("A phase function of g ") +
                    std::to_string(phase.g_henyey_greenstein()) + ", Draine's g " +
                    std::to_string(phase.g_draine()) + ", alpha " + std::to_string(phase.alpha()) +
                    " and weight " + std::to_string(phase.weight()) +
                    " can't be traced: above -1 to below 1 for both g, from 0 for alpha and 0 to 1 "
                    "for the weight are wanted.");
}

[[nodiscard]] inline result<std::uint64_t> paths_per_batch(const path_options& options,
                                                           const phase_function& phase) {
    if (auto done = check_phase(phase); !done) {
        return failure(done.error());
    }
    if (!(options.batches >= 2 && options.batches <= 4096 && options.paths > 0 &&
          options.paths <= (std::uint64_t{1} << 48))) {
        return fail(
            error_code::bad_input,
            std::string("A standard error takes at least a path and 2 to 4096 batches, not ") +
                std::to_string(options.paths) + " paths in " + std::to_string(options.batches) +
                " batches.");
    }
    return (options.paths + options.batches - 1) / options.batches;
}

/// What a batch of paths leaves of the light on a slab.
struct slab_tally {
    double transmitted = 0, reflected = 0, absorbed = 0;
};

/// One path: the first collision is forced, so that thin slabs cost no more than thick ones.
inline void slab_path(double depth, double albedo, const phase_function& phase, double cosine,
                      std::uint32_t most_scatterings, path_random& random, slab_tally& tally) {
    const double scattered = -std::expm1(-depth / cosine);
    double at = -cosine * std::log1p(-random.unit() * scattered);
    double mu = cosine;
    double weight = 1;
    for (std::uint32_t order = 0;; ++order) {
        if (order == most_scatterings) {
            tally.absorbed += scattered * weight;
            return;
        }
        tally.absorbed += scattered * weight * (1 - albedo);
        weight *= albedo;
        if (!roulette(weight, random)) {
            return;
        }
        const double u = sample_cosine(phase, random);
        const double across = std::sqrt(std::max(0.0, (1 - mu * mu) * (1 - u * u)));
        mu = std::clamp(mu * u + across * std::cos(6.283185307179586 * random.unit()), -1.0, 1.0);
        at -= mu * std::log(random.unit());
        if (at < 0 || at > depth) {
            (at < 0 ? tally.reflected : tally.transmitted) += scattered * weight;
            return;
        }
    }
}

/// A grid of voxels as the light sees it, in double: cells(p) = offset + rows · (p − anchor).
struct voxel_frame {
    glm::dvec3 anchor, x, y, z, offset;
    glm::ivec3 count;

    voxel_frame(const light_grid& grid, const glm::uvec3& voxels)
        : anchor(grid.anchor), x(grid.row_x), y(grid.row_y), z(grid.row_z),
          offset(grid.row_x.w, grid.row_y.w, grid.row_z.w), count(voxels) {}

    [[nodiscard]] glm::dvec3 along(const glm::dvec3& v) const {
        return {glm::dot(x, v), glm::dot(y, v), glm::dot(z, v)};
    }
    [[nodiscard]] glm::dvec3 cells(const glm::dvec3& p) const { return offset + along(p - anchor); }
    /// A voxel's volume, m³: one over the determinant of the rows.
    [[nodiscard]] double volume() const { return 1 / std::abs(glm::dot(x, glm::cross(y, z))); }
    /// The place in the world of a corner of the box.
    [[nodiscard]] glm::dvec3 corner(int which) const {
        const glm::dvec3 c(which & 1 ? count.x : 0, which & 2 ? count.y : 0,
                           which & 4 ? count.z : 0);
        const glm::dvec3 d = c - offset;
        const double over = 1 / glm::dot(x, glm::cross(y, z));
        return anchor +
               over * (d.x * glm::cross(y, z) + d.y * glm::cross(z, x) + d.z * glm::cross(x, y));
    }
};

/// The rectangle across the sunlight that covers a cloud and the voxels asked for, sunwards of
/// both.
struct sun_window {
    glm::dvec3 corner{0}, across{0}, along{0}, down{0};
    double area = 0;

    template <medium M>
    sun_window(const M& in, const voxel_frame& voxels, const glm::dvec3& to_sun) : down(-to_sun) {
        const glm::dvec3 u = turned(down, 0, 0);
        const glm::dvec3 v = glm::cross(down, u);
        glm::dvec3 low(1e300), high(-1e300);
        const auto cover = [&](const glm::dvec3& p) {
            const glm::dvec3 q(glm::dot(u, p), glm::dot(v, p), glm::dot(to_sun, p));
            low = glm::min(low, q);
            high = glm::max(high, q);
        };
        const glm::dvec3 a = in.cells().low;
        const glm::dvec3 b = in.cells().high();
        for (int c = 0; c < 8; ++c) {
            cover({c & 1 ? b.x : a.x, c & 2 ? b.y : a.y, c & 4 ? b.z : a.z});
            cover(voxels.corner(c));
        }
        corner = low.x * u + low.y * v + high.z * to_sun;
        across = (high.x - low.x) * u;
        along = (high.y - low.y) * v;
        area = (high.x - low.x) * (high.y - low.y);
    }
};

/// What a batch of paths leaves of the sunlight in a cloud.
struct fluence_tally {
    std::vector<double> length; ///< m of flight in each voxel, weighted
    double escaped = 0, absorbed = 0;

    void fly(const voxel_frame& voxels, const glm::dvec3& from, const glm::dvec3& to,
             double length_m, double weight) {
        for (cell_walk walk(voxels.cells(from), voxels.along(to), 0, length_m, voxels.count);
             walk.inside(); walk.next()) {
            const glm::ivec3& c = walk.cell();
            const std::size_t at =
                (static_cast<std::size_t>(c.z) * static_cast<std::size_t>(voxels.count.y) +
                 static_cast<std::size_t>(c.y)) *
                    static_cast<std::size_t>(voxels.count.x) +
                static_cast<std::size_t>(c.x);
            length[at] += weight * (walk.leaves() - walk.enters());
        }
    }
};

template <medium M>
void fluence_path(const M& in, const phase_function& phase, const voxel_frame& voxels,
                  glm::dvec3 at, glm::dvec3 to, std::uint32_t most_scatterings, path_random& random,
                  fluence_tally& tally) {
    double weight = 1;
    for (std::uint32_t order = 0;; ++order) {
        const collision next = next_collision(in, at, to, random);
        tally.fly(voxels, at, to, next.distance, weight);
        if (next.distance == std::numeric_limits<double>::infinity()) {
            tally.escaped += weight;
            return;
        }
        if (order == most_scatterings) {
            tally.absorbed += weight;
            return;
        }
        tally.absorbed += weight * (1 - next.albedo);
        weight *= next.albedo;
        if (!roulette(weight, random)) {
            return;
        }
        at += next.distance * to;
        const double u = sample_cosine(phase, random);
        to = turned(to, u, random.unit());
    }
}

/// One path from a camera: at each collision the sunlight that is scattered into it, exactly.
template <medium M>
[[nodiscard]] double radiance_path(const M& in, const phase_function& phase,
                                   const glm::dvec3& to_sun, double sky, const camera_ray& ray,
                                   std::uint32_t most_scatterings, path_random& random) {
    glm::dvec3 at = ray.origin;
    glm::dvec3 to = ray.to;
    double weight = 1;
    double light = 0;
    for (std::uint32_t order = 0; order < most_scatterings; ++order) {
        const collision next = next_collision(in, at, to, random);
        if (next.distance == std::numeric_limits<double>::infinity()) {
            return light + weight * sky;
        }
        weight *= next.albedo;
        at += next.distance * to;
        light += weight * phase(glm::dot(to_sun, to)) * std::exp(-in.optical_depth(at, to_sun));
        if (!roulette(weight, random)) {
            return light;
        }
        const double u = sample_cosine(phase, random);
        to = turned(to, u, random.unit());
    }
    return light;
}

} // namespace detail

/// A homogeneous slab, endless to the sides, in parallel light. `depth`: optical, straight through,
/// 0…1e4; `cosine`: of the light to the slab's normal, 0…1. Errors: bad_input outside of that, or
/// of 0…1 for the albedo.
[[nodiscard]] inline result<slab_light> trace_slab(double depth, double albedo,
                                                   const phase_function& phase, double cosine = 1,
                                                   const path_options& options = {}) {
    const auto per_batch = detail::paths_per_batch(options, phase);
    if (!per_batch) {
        return failure(per_batch.error());
    }
    if (!(depth >= 0 && depth <= 1e4 && albedo >= 0 && albedo <= 1 && cosine > 0 && cosine <= 1)) {
        return fail(error_code::bad_input, std::string("A slab of depth ") + std::to_string(depth) +
                                               " and albedo " + std::to_string(albedo) +
                                               " in light at a cosine of " +
                                               std::to_string(cosine) + " can't be traced.");
    }
    const std::uint32_t threads = detail::path_threads(options, options.batches);
    std::vector<detail::slab_tally> tallies(threads);
    std::array<detail::batch_sum, 3> sums;
    detail::in_rounds(
        options.batches, threads,
        [&](std::uint64_t batch, std::uint32_t slot) {
            detail::slab_tally tally;
            for (std::uint64_t i = 0; i < *per_batch; ++i) {
                path_random random(options.seed, batch * *per_batch + i);
                detail::slab_path(depth, albedo, phase, cosine, options.most_scatterings, random,
                                  tally);
            }
            tallies[slot] = tally;
        },
        [&](std::uint64_t, std::uint32_t slot) {
            const double over = 1 / static_cast<double>(*per_batch);
            sums[0].add(tallies[slot].transmitted * over);
            sums[1].add(tallies[slot].reflected * over);
            sums[2].add(tallies[slot].absorbed * over);
        });
    slab_light out;
    out.direct = std::exp(-depth / cosine);
    out.transmission = sums[0].over(options.batches);
    out.transmission.mean += out.direct;
    out.reflection = sums[1].over(options.batches);
    out.absorption = sums[2].over(options.batches);
    return out;
}

/// The fluence that sunlight from the unit vector `to_sun` makes in the voxels of a grid, averaged
/// over each: the lengths that paths fly in it. The grid need not hold the cloud, nor be turned
/// towards the sun. Errors: bad_input where `to_sun` is no unit vector; out_of_memory for more than
/// 2^24 voxels.
template <medium M>
[[nodiscard]] result<fluence_field>
trace_fluence(const M& in, const phase_function& phase, const glm::dvec3& to_sun,
              const light_grid& grid, const glm::uvec3& voxels, const path_options& options = {}) {
    const auto per_batch = detail::paths_per_batch(options, phase);
    if (!per_batch) {
        return failure(per_batch.error());
    }
    constexpr std::uint64_t most = 1u << 24;
    if (voxels.x > most || voxels.y > most || voxels.z > most ||
        std::uint64_t{voxels.x} * voxels.y > most ||
        std::uint64_t{voxels.x} * voxels.y * voxels.z > most) {
        return fail(error_code::out_of_memory,
                    std::string("Fluence in ") + std::to_string(voxels.x) + " x " +
                        std::to_string(voxels.y) + " x " + std::to_string(voxels.z) +
                        " voxels is more than the 2^24 that can be traced.");
    }
    const detail::voxel_frame frame(grid, voxels);
    if (!detail::unit_vector(to_sun) || voxels.x == 0 || voxels.y == 0 || voxels.z == 0 ||
        !(frame.volume() > 0 && frame.volume() < 1e30) || !detail::within_reach(frame.corner(0)) ||
        !detail::within_reach(frame.corner(7))) {
        return fail(error_code::bad_input, "To trace fluence takes a unit vector to the sun and a "
                                           "grid of at least one voxel with a volume.");
    }
    const detail::sun_window window(in, frame, to_sun);
    const std::size_t count = std::size_t{voxels.x} * voxels.y * voxels.z;
    const std::uint32_t threads = detail::path_threads(options, options.batches);
    std::vector<detail::fluence_tally> tallies(threads);
    std::vector<detail::batch_sum> sums(count);
    detail::batch_sum escaped, absorbed;
    detail::in_rounds(
        options.batches, threads,
        [&](std::uint64_t batch, std::uint32_t slot) {
            detail::fluence_tally& tally = tallies[slot];
            tally.length.assign(count, 0);
            tally.escaped = tally.absorbed = 0;
            // Starts spread evenly (Roberts' R2 sequence), from a random place in each batch.
            path_random shift(~options.seed, batch);
            const double shift_x = shift.unit();
            const double shift_y = shift.unit();
            for (std::uint64_t i = 0; i < *per_batch; ++i) {
                path_random random(options.seed, batch * *per_batch + i);
                const double n = static_cast<double>(i);
                const double x = shift_x + 0.7548776662466927 * n;
                const double y = shift_y + 0.5698402909980532 * n;
                const glm::dvec3 start = window.corner + (x - std::floor(x)) * window.across +
                                         (y - std::floor(y)) * window.along;
                detail::fluence_path(in, phase, frame, start, window.down, options.most_scatterings,
                                     random, tally);
            }
        },
        [&](std::uint64_t, std::uint32_t slot) {
            const detail::fluence_tally& tally = tallies[slot];
            const double each = window.area / static_cast<double>(*per_batch);
            for (std::size_t i = 0; i < count; ++i) {
                sums[i].add(tally.length[i] * each / frame.volume());
            }
            escaped.add(tally.escaped * each);
            absorbed.add(tally.absorbed * each);
        });
    fluence_field out;
    out.voxels = voxels;
    out.incident = window.area;
    out.escaped = escaped.over(options.batches);
    out.absorbed = absorbed.over(options.batches);
    out.mean.resize(count);
    out.standard_error.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const estimate voxel = sums[i].over(options.batches);
        out.mean[i] = voxel.mean;
        out.standard_error[i] = voxel.standard_error;
    }
    return out;
}

/// How much of the sunlight reaches a place unscattered, exactly.
template <medium M>
[[nodiscard]] double sun_transmittance(const M& in, const glm::dvec3& place,
                                       const glm::dvec3& to_sun) {
    return std::exp(-in.optical_depth(place, to_sun));
}

/// The radiance that arrives along each ray, over the sun's irradiance: scattered sunlight and a
/// sky of radiance `sky` everywhere; the sun itself isn't seen. `options.paths` are for each ray;
/// the standard error is that of their mean. Errors: bad_input where a vector isn't of unit length,
/// or the sky is no radiance.
template <medium M>
[[nodiscard]] result<std::vector<estimate>>
trace_radiance(const M& in, const phase_function& phase, const glm::dvec3& to_sun,
               std::span<const camera_ray> rays, double sky = 0, const path_options& options = {}) {
    if (!detail::unit_vector(to_sun) || options.paths < 2 ||
        options.paths > (std::uint64_t{1} << 32) ||
        !std::all_of(rays.begin(), rays.end(), [](const camera_ray& r) {
            return detail::unit_vector(r.to) && detail::within_reach(r.origin);
        })) {
        return fail(error_code::bad_input, "To trace rays takes unit vectors, origins within 1e7 m "
                                           "and 2 to 2^32 paths a ray.");
    }
    if (!(sky >= 0 && sky <= 1e300)) {
        return fail(error_code::bad_input, std::string("A sky of radiance ") + std::to_string(sky) +
                                               " can't be traced; from 0 on is wanted.");
    }
    if (auto done = detail::check_phase(phase); !done) {
        return failure(done.error());
    }
    std::vector<estimate> out(rays.size());
    if (rays.empty()) {
        return out;
    }
    const std::uint32_t threads = detail::path_threads(options, rays.size());
    detail::in_rounds(
        threads, threads,
        [&](std::uint64_t thread, std::uint32_t) {
            for (std::size_t r = thread; r < rays.size(); r += threads) {
                detail::batch_sum sum;
                for (std::uint64_t i = 0; i < options.paths; ++i) {
                    path_random random(options.seed, r * options.paths + i);
                    sum.add(detail::radiance_path(in, phase, to_sun, sky, rays[r],
                                                  options.most_scatterings, random));
                }
                out[r] = sum.over(options.paths);
            }
        },
        [](std::uint64_t, std::uint32_t) {});
    return out;
}

} // namespace skybark::clouds
