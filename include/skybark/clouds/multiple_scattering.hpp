#pragma once
// multiple_scattering: light of the sun that a cloud has scattered more than once, on the device,
// from the attenuation volume alone, anew for every frame.
//
//     auto sun = attenuation_volume<B>::create(device, voxels, light_of(phase));
//     multiple_scattering_options options;
//     options.medium = medium_of(phase, mean_albedo(particles));
//     auto diffuse = multiple_scattering<B>::create(device, voxels, options);
//     sun->relight(recorder, on_device, count, box);
//     diffuse->solve(recorder, *sun);
//     … diffuse->fluence() on diffuse->grid(box) …
//
// The model is diffusion of what has left the sun's beam. Of a phase function with mean cosine g,
// the part f of the energy goes on as if it had not been scattered (δ-Eddington: Joseph, Wiscombe
// and Weinman 1976; f is the second moment, g² for Henyey–Greenstein). What the beam, thinned by
// e^{−τ(1 − ωf)}, loses to scattering, feeds the diffuse fluence φ = ∫ L dω:
//
//     ∇·F + (1 − ω) σ φ = ω (1 − f) σ E,    F = (−∇φ + 3 ω (g − f) σ E l) / w,
//     w = 3 (1 − ωg) σ + 2 / W + 1.25 |∇⊥φ| / φ,
//
// E the beam over the sun's irradiance, l its direction, σ the extinction. Light leaves through the
// borders of the grid and none comes in (Marshak: F = φ/2). Without the last two terms of w this is
// δ-Eddington, which is right for layers, whatever their depth, but loses too much light from the
// sides of a cloud: a flux can't be larger than its fluence, and in empty space it isn't driven by
// a gradient at all. The third term limits the flux where φ falls off sideways (Levermore and
// Pomraning 1981, "A Flux-Limited Diffusion Theory"; Koerner, Portsmouth, Sadlo, Ertl and Eberhardt
// 2014, "Flux-Limited Diffusion for Multiple Scattering in Participating Media"), but not along the
// light, so that a layer stays exact; the second one is the resistance of empty space, from the
// lateral width W of the box (1/W² = the mean of 1/Wx², 1/Wz²; none for an endless layer). Their
// two factors were fitted to paths of photons in Gaussian clouds.
//
// Errors (tests/clouds/multiple_scattering.cpp prints the tables): transmission of layers of depth
// 0.5…64, g 0…0.85, albedo 0.9…1: 3.4 % where it is above 0.05, 8.2 % down to 0.001. Fluence in
// eight Gaussian clouds of depth 2…40, mean over the water: 3…14 % for the same media, where cells
// are no larger than the standard deviation of the particles. Cells twice as large, in clouds as
// deep as 40: up to 37 %. (Plain δ-Eddington, cells as small: 9…48 %.)
//
// Solved by full multigrid with a number of steps that depends on the sizes alone: from one cell up
// to the finest grid, a V-cycle on each and `cycles` on the last one, the limiter in between. Three
// cycles leave an error of 1 % on the mean. Where voxels are far from cubes, as over a wide field
// of clouds, that takes coarser grids of another shape (options.voxel; Mulder 1989, "A new
// multigrid approach to convection problems", halves single axes as well): without, 14 % remain of
// voxels that are nine times as wide as high. No history; nothing is allocated by `solve`; the same
// bits each time.
//
// What a consumer does with it. At a place in the cloud, with I the sun's light there (e^{−A} of
// the continuum's volume), E_0 the sun's irradiance and s = shared::scattering_without(ω, f), the
// light sent towards the eye from a piece of optical depth τ is
//
//     (1 − e^{−τ s.depth}) E_0 [s.single I P(ω, l) + s.diffuse φ / 4π]:
//
// single scattering by the whole phase function, and φ again from everywhere. kernels::lit_puff and
// kernels::lit_grid do that with this volume as their third, `diffuse_grid` = grid(box) and
// `diffuse` = 1/4π. Fluence as a path tracer counts it is I + φ.

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/light_box.hpp>
#include <skybark/clouds/phase.hpp>
#include <skybark/core/backend.hpp>
#include <skybark/kernels/scatter_average.hpp>
#include <skybark/kernels/scatter_coarsen.hpp>
#include <skybark/kernels/scatter_limit.hpp>
#include <skybark/kernels/scatter_medium.hpp>
#include <skybark/kernels/scatter_prolong.hpp>
#include <skybark/kernels/scatter_relax.hpp>
#include <skybark/kernels/scatter_restrict.hpp>
#include <skybark/kernels/scatter_source.hpp>

#include <cassert>
#include <cmath>
#include <span>
#include <vector>

namespace skybark::clouds {

/// How a cloud scatters, the same everywhere in it. Where particles differ in albedo, the mean by
/// optical depth is the best one number.
struct scattering_medium {
    float albedo = 1;              ///< ω, 0…1
    float mean_cosine = 0.85f;     ///< g of one scattering, −1 < g < 1
    float forward = 0.85f * 0.85f; ///< f, 0 ≤ f < 1: phase_function::forward_energy()
};

struct multiple_scattering_options {
    scattering_medium medium;
    /// The attenuation in the volume over the optical depth: 1 for attenuation_light::extinction,
    /// 1 − ωf (`share_of(medium)`) for the continuum's. `solve` with an attenuation_volume knows
    /// it.
    float share = 1;
    std::uint32_t halvings = 1; ///< the fluence has 2^-halvings of the volume's resolution: 1…4,
                                ///< and no more than leave a cell
    std::uint32_t cycles = 3;   ///< V-cycles on the finest grid, 1…64
    /// Sides of the volume's voxels, in any unit, as they will mostly be (light_box::grid.voxel).
    /// Where some are twice as long as others, or more, coarser grids halve the short ones first.
    glm::vec3 voxel{1};
    float spreading = 1.25f; ///< factor of the limiter; 0: plain δ-Eddington, with …
    float emptiness = 2;     ///< … 0 here: the resistance of empty space times W
    std::uint64_t most_bytes = std::uint64_t{2} << 30; ///< what all volumes together may take
};

/// For a volume of attenuation_light::continuum.
[[nodiscard]] constexpr float share_of(const scattering_medium& medium) noexcept {
    return 1 - medium.albedo * medium.forward;
}

/// How droplets of this phase function scatter, of this albedo each time.
[[nodiscard]] inline scattering_medium medium_of(const phase_function& phase, float albedo) {
    return {albedo, static_cast<float>(phase.mean_cosine()),
            static_cast<float>(phase.forward_energy())};
}

/// Of particles that differ: the mean by optical depth; 1 where there is none.
[[nodiscard]] inline float mean_albedo(std::span<const cloud_particle> particles) {
    double scattered = 0;
    double taken = 0;
    for (const cloud_particle& p : particles) {
        scattered += double{p.albedo} * double{p.optical_depth};
        taken += double{p.optical_depth};
    }
    return taken > 0 ? static_cast<float>(scattered / taken) : 1.0f;
}

/// A backend with all kernels of multiple scattering.
template <class B>
concept scatters_light = volume_backend<B> && maps_voxels<B, kernels::scatter_medium> &&
    maps_voxels<B, kernels::scatter_coarsen> && maps_voxels<B, kernels::scatter_limit> &&
    maps_voxels<B, kernels::scatter_average> && maps_voxels<B, kernels::scatter_source> &&
    maps_voxels<B, kernels::scatter_relax> && maps_voxels<B, kernels::scatter_restrict> &&
    maps_voxels<B, kernels::scatter_prolong>;

template <scatters_light B>
class multiple_scattering {
  public:
    /// For attenuation volumes of `voxels` (each side 4 or more). Takes about 4 bytes for each of
    /// their voxels. Errors: bad_input for a medium or a size that makes no sense, or takes more
    /// than most_bytes; what the device says.
    [[nodiscard]] static result<multiple_scattering>
    create(B& device, glm::uvec3 voxels, const multiple_scattering_options& options = {}) {
        if (auto done = detail::check_voxels(voxels); !done) {
            return failure(done.error());
        }
        if (auto done = check(options); !done) {
            return failure(done.error());
        }
        multiple_scattering made(voxels, options);
        if (made.finest() >= made.levels_.size()) {
            return fail(error_code::bad_input,
                        std::string("Multiple scattering over a volume of ") +
                            std::to_string(voxels.x) + " x " + std::to_string(voxels.y) + " x " +
                            std::to_string(voxels.z) + " voxels cannot have " +
                            std::to_string(options.halvings) +
                            " halvings; expected up to the one that leaves a single cell, " +
                            std::to_string(made.levels_.size()) + ".");
        }
        if (made.bytes() > options.most_bytes) {
            return fail(error_code::bad_input,
                        std::string("Multiple scattering over a volume of ") +
                            std::to_string(voxels.x) + " x " + std::to_string(voxels.y) + " x " +
                            std::to_string(voxels.z) + " voxels takes " +
                            std::to_string(made.bytes() >> 20) + " MiB; at most " +
                            std::to_string(options.most_bytes >> 20) + " MiB are allowed.");
        }
        for (level& l : made.levels_) {
            for (std::uint32_t i = 0; i < l.volumes; ++i) {
                auto volume = device.create_volume(
                    {static_cast<std::uint32_t>(l.size.x), static_cast<std::uint32_t>(l.size.y),
                     static_cast<std::uint32_t>(l.size.z), volume_format::float32});
                if (!volume) {
                    return failure(volume.error());
                }
                l.volume.push_back(std::move(*volume));
            }
        }
        return made;
    }

    /// Records the diffuse fluence for the cloud that `sun` was last relit with: extinction, or the
    /// continuum of the medium's `forward`. (Of the product no optical depth can be told.) The
    /// share is the volume's, whatever options().share was.
    void solve(typename B::recorder& recorder,
               const attenuation_volume<B>& sun) requires relights_volumes<B> {
        assert(fits(sun.options()) && "light that tells no depth, or another medium's");
        options_.share = share_of_light(sun.options());
        solve(recorder, sun.volume(), sun.box());
    }

    /// Whether the light is extinction, or the continuum of the medium's `forward`.
    [[nodiscard]] bool fits(const attenuation_options& light) const noexcept {
        return light.light == attenuation_light::extinction ||
               (light.light == attenuation_light::continuum &&
                std::abs(light.forward - options_.medium.forward) <= 1e-5f);
    }

    /// Records the diffuse fluence for the cloud whose attenuation is in `attenuation`, a volume of
    /// floats that lies in `box`, of options().share. As attenuation_volume makes it: nothing in
    /// the outermost layer of voxels, but for what is below the cloud.
    void solve(typename B::recorder& recorder, const typename B::volume& attenuation,
               const light_box& box) {
        assert(box.voxels == voxels_ && "a box that was fitted for another volume");
        place(box);
        take_matter(recorder, attenuation, glm::vec3(box.grid.voxel));
        const std::size_t last = levels_.size() - 1;
        limit(recorder, last, true);
        source(recorder, last);
        cycle(recorder, last, false);
        for (std::size_t l = last; l-- > finest();) {
            prolong(recorder, l, true);
            improve(recorder, l);
        }
        for (std::uint32_t c = 1; c < options_.cycles; ++c) {
            improve(recorder, finest());
        }
    }

    /// φ over the sun's irradiance at the middle of every cell, of float32: what the latest `solve`
    /// made; before the first one it holds nothing, and another `solve` may make it in another
    /// volume: ask anew after each. To sample trilinearly at cells_of(grid(box), place) / size().
    [[nodiscard]] const typename B::volume& fluence() const {
        const level& l = levels_[finest()];
        return l.volume[phi + l.current];
    }
    [[nodiscard]] glm::uvec3 size() const { return glm::uvec3(levels_[finest()].size); }

    /// Where the fluence lies, for the box of an attenuation volume. Odd volumes end half way
    /// through its last cell.
    [[nodiscard]] light_grid grid(const light_box& box) const {
        light_grid coarse = box.grid;
        const float over = 1.0f / static_cast<float>(1u << options_.halvings);
        coarse.row_x *= over;
        coarse.row_y *= over;
        coarse.row_z *= over;
        coarse.voxel = glm::vec4(glm::vec3(box.grid.voxel) / over, box.grid.voxel.w);
        return coarse;
    }

    /// The diffuse flux that leaves through the grid's borders of constant x, y and z, over the
    /// fluence of the cell there. So the transmission of a layer is e^{−τ(1 − ωf)} plus the fluence
    /// of the undermost cell times escape(box).y, and its diffuse reflection is that of the topmost
    /// one.
    [[nodiscard]] glm::vec3 escape(const light_box& box) const {
        const glm::vec3 side = glm::vec3(grid(box).voxel);
        const float empty = emptiness(box);
        return {shared::scatter_escape(empty, side.x), shared::scatter_escape(empty, side.y),
                shared::scatter_escape(empty, side.z)};
    }

    /// Device memory of all volumes.
    [[nodiscard]] std::uint64_t bytes() const {
        std::uint64_t sum = 0;
        for (const level& l : levels_) {
            sum += std::uint64_t{4} * l.volumes * static_cast<std::uint64_t>(l.size.x) *
                   static_cast<std::uint64_t>(l.size.y) * static_cast<std::uint64_t>(l.size.z);
        }
        return sum;
    }
    [[nodiscard]] const multiple_scattering_options& options() const noexcept { return options_; }

    /// For the next `solve`; `share` as in the options. Errors: bad_input, and nothing is changed.
    [[nodiscard]] result<void> set_medium(const scattering_medium& medium, float share = 1) {
        multiple_scattering_options next = options_;
        next.medium = medium;
        next.share = share;
        if (auto done = check(next); !done) {
            return done;
        }
        options_ = next;
        return {};
    }

  private:
    /// A grid's volumes, in order.
    enum slot : std::size_t { extinction, scattered, beam, resistance, lit, phi };
    struct level {
        glm::ivec3 size{1};
        glm::vec3 side{1};                      ///< m
        std::uint32_t axes = kernels::all_axes; ///< that the next one halves
        std::uint32_t volumes = 0; ///< two of fluence, or (finer than the finest) matter alone
        std::size_t current = 0;   ///< which of the two fluences is the latest
        std::vector<typename B::volume> volume;
    };

    multiple_scattering(glm::uvec3 voxels, const multiple_scattering_options& options)
        : options_(options), voxels_(voxels) {
        glm::ivec3 size = (glm::ivec3(voxels) + 1) / 2;
        glm::vec3 shape = options.voxel;
        for (;;) {
            const bool is_finer = levels_.size() < finest(); // the fluence halves all axes alike
            level l;
            l.size = size;
            l.volumes = is_finer ? 3 : 7;
            l.axes = is_finer ? kernels::all_axes : axes_to_halve(size, shape);
            const glm::ivec3 halved = kernels::halved_axes(l.axes, size);
            levels_.push_back(std::move(l));
            if (size == glm::ivec3(1)) {
                return;
            }
            size = (size + halved) / (1 + halved);
            shape *= glm::vec3(1 + halved);
        }
    }

    [[nodiscard]] static result<void> check(const multiple_scattering_options& options) {
        const scattering_medium& m = options.medium;
        const bool medium = m.albedo >= 0 && m.albedo <= 1 && m.mean_cosine > -1 &&
                            m.mean_cosine < 1 && m.forward >= 0 && m.forward < 1;
        if (!medium) {
            return fail(error_code::bad_input,
                        std::string("Multiple scattering was asked for with albedo ") +
                            std::to_string(m.albedo) + ", mean cosine " +
                            std::to_string(m.mean_cosine) + " and forward part " +
                            std::to_string(m.forward) +
                            "; expected 0 to 1, above -1 to below 1, and 0 to below 1.");
        }
        if (!(options.share > 0 && options.share <= 1) || options.halvings < 1 ||
            options.halvings > 4 || options.cycles < 1 || options.cycles > 64 ||
            !(options.spreading >= 0 && options.spreading <= 100) ||
            !(options.emptiness >= 0 && options.emptiness <= 100) || !is_shape(options.voxel)) {
            return fail(error_code::bad_input,
                        std::string("Multiple scattering was asked for with a share of ") +
                            std::to_string(options.share) + ", " +
                            std::to_string(options.halvings) + " halvings, " +
                            std::to_string(options.cycles) + " cycles, spreading " +
                            std::to_string(options.spreading) + ", emptiness " +
                            std::to_string(options.emptiness) + " and voxels of " +
                            detail::number_text(options.voxel.x) + " x " +
                            detail::number_text(options.voxel.y) + " x " +
                            detail::number_text(options.voxel.z) +
                            "; expected above 0 to 1, 1 to 4, 1 to 64, 0 to 100, 0 to 100 and "
                            "sides from 1e-9 to 1e9.");
        }
        return {};
    }

    [[nodiscard]] static bool is_shape(glm::vec3 voxel) {
        const auto is_side = [](float side) { return side >= 1e-9f && side <= 1e9f; };
        return is_side(voxel.x) && is_side(voxel.y) && is_side(voxel.z);
    }

    /// The axes that the grid coarser than one of this size and shape halves: those along which its
    /// cells are less than twice as long as along any other. What is left of an error across short
    /// sides, relaxing has smoothed; along much longer ones nothing has, and a grid that halved
    /// these as well could not hold it.
    [[nodiscard]] static std::uint32_t axes_to_halve(glm::ivec3 size, glm::vec3 shape) {
        float least = 3e38f;
        for (int a = 0; a < 3; ++a) {
            least = size[a] > 1 ? std::min(least, shape[a]) : least;
        }
        std::uint32_t axes = 0;
        for (int a = 0; a < 3; ++a) {
            axes |= shape[a] < 2 * least ? 1u << a : 0u;
        }
        return axes;
    }

    [[nodiscard]] float share_of_light(const attenuation_options& light) const {
        return light.light == attenuation_light::continuum
                   ? 1 - options_.medium.albedo * light.forward
                   : 1.0f;
    }

    [[nodiscard]] std::size_t finest() const { return options_.halvings - 1; }

    /// The resistance of empty space, 1/m. Never quite none, so that no cell is without.
    [[nodiscard]] float emptiness(const light_box& box) const {
        const glm::vec3 whole = glm::vec3(box.grid.voxel) * glm::vec3(box.voxels);
        const float over2 = 0.5f / (whole.x * whole.x) + 0.5f / (whole.z * whole.z);
        return options_.emptiness * std::sqrt(over2) + 0.01f / whole.y;
    }

    void place(const light_box& box) {
        empty_ = emptiness(box);
        glm::vec3 side = glm::vec3(box.grid.voxel) * 2.0f;
        for (level& l : levels_) {
            l.current = 0;
            l.side = side;
            side *= glm::vec3(1 + kernels::halved_axes(l.axes, l.size));
        }
    }

    template <class K>
    void map(typename B::recorder& recorder, const K& kernel, std::size_t to,
             const std::array<const typename B::volume*, volumes_of<K>>& read,
             const std::array<const typename B::volume*, volume_targets_of<K>>& write) {
        volume_bindings<B, K> bound;
        bound.read = read;
        bound.write = write;
        recorder.map_voxels(kernel, {}, bound, glm::uvec3(levels_[to].size));
    }

    [[nodiscard]] const typename B::volume* at(std::size_t l, std::size_t which) const {
        return &levels_[l].volume[which];
    }
    [[nodiscard]] const typename B::volume* now(std::size_t l) const {
        return at(l, phi + levels_[l].current);
    }
    [[nodiscard]] const typename B::volume* next(std::size_t l) const {
        return at(l, phi + 1 - levels_[l].current);
    }
    void swap(std::size_t l) { levels_[l].current = 1 - levels_[l].current; }

    /// Matter and beam on every grid.
    void take_matter(typename B::recorder& recorder, const typename B::volume& attenuation,
                     glm::vec3 voxel) {
        const scattering_medium& m = options_.medium;
        const float depth = 1 - m.albedo * m.forward;
        kernels::scatter_medium matter;
        matter.extinction = 1 / (8 * voxel.y * options_.share);
        matter.kept = depth / options_.share;
        matter.scattered = m.albedo * (1 - m.forward) / (depth * 8 * voxel.y);
        map(recorder, matter, 0, {&attenuation},
            {at(0, extinction), at(0, scattered), at(0, beam)});
        for (std::size_t l = 1; l < levels_.size(); ++l) {
            map(recorder, kernels::scatter_coarsen{levels_[l - 1].axes}, l,
                {at(l - 1, extinction), at(l - 1, scattered), at(l - 1, beam)},
                {at(l, extinction), at(l, scattered), at(l, beam)});
        }
    }

    /// The resistance of a grid, from its fluence or (first) from none, and of all coarser ones.
    void limit(typename B::recorder& recorder, std::size_t l, bool first) {
        kernels::scatter_limit how;
        how.sides = glm::vec4(levels_[l].side, empty_);
        how.transport = 1 - options_.medium.albedo * options_.medium.mean_cosine;
        how.spreading = options_.spreading;
        how.assumed = first ? 2 * empty_ : -1;
        map(recorder, how, l, {now(l), at(l, extinction)}, {at(l, resistance)});
        for (std::size_t c = l + 1; c < levels_.size(); ++c) {
            map(recorder, kernels::scatter_average{levels_[c - 1].axes}, c, {at(c - 1, resistance)},
                {at(c, resistance)});
        }
    }

    void source(typename B::recorder& recorder, std::size_t l) {
        const scattering_medium& m = options_.medium;
        kernels::scatter_source how;
        how.moment = 3 * m.albedo * (m.mean_cosine - m.forward) / levels_[l].side.y;
        map(recorder, how, l, {at(l, scattered), at(l, beam), at(l, extinction), at(l, resistance)},
            {at(l, lit)});
    }

    /// New resistances and sources for the fluence so far, and a V-cycle.
    void improve(typename B::recorder& recorder, std::size_t l) {
        limit(recorder, l, false);
        source(recorder, l);
        cycle(recorder, l, true);
        relax(recorder, l, 0.8f, false, 0);
    }

    [[nodiscard]] kernels::scatter_equation equation(std::size_t l) const {
        return {glm::vec4(levels_[l].side, empty_), 1 - options_.medium.albedo};
    }

    void relax(typename B::recorder& recorder, std::size_t l, float weight, bool from_zero,
               float least) {
        const kernels::scatter_relax how{equation(l), weight, from_zero ? 1u : 0u, least};
        map(recorder, how, l, {now(l), at(l, resistance), at(l, extinction), at(l, lit)},
            {next(l)});
        swap(l);
    }

    /// Chebyshev's three steps for errors that a grid of twice the sides can't hold: of the
    /// eigenvalues 0.2…2 of Jacobi's step no more than 0.28 remains, of 1/6 (cells twice as long as
    /// high) 0.37.
    void smooth(typename B::recorder& recorder, std::size_t l, bool from_zero) {
        relax(recorder, l, 0.532f, from_zero, unbounded);
        relax(recorder, l, 3.12f, false, unbounded);
        relax(recorder, l, 0.909f, false, unbounded);
    }

    void prolong(typename B::recorder& recorder, std::size_t l, bool from_zero) {
        const kernels::scatter_prolong how{from_zero ? 1u : 0u, levels_[l].axes};
        map(recorder, how, l, {now(l), now(l + 1)}, {next(l)});
        swap(l);
    }

    void cycle(typename B::recorder& recorder, std::size_t l, bool guessed) {
        if (l + 1 == levels_.size()) {
            relax(recorder, l, 1, !guessed, unbounded); // one cell: exact
            return;
        }
        smooth(recorder, l, !guessed);
        map(recorder, kernels::scatter_restrict{equation(l), levels_[l].axes}, l + 1,
            {now(l), at(l, resistance), at(l, extinction), at(l, lit)}, {at(l + 1, lit)});
        cycle(recorder, l + 1, false);
        prolong(recorder, l, false);
        smooth(recorder, l, false);
    }

    static constexpr float unbounded = -3e38f;
    multiple_scattering_options options_;
    glm::uvec3 voxels_{0};
    float empty_ = 0;
    std::vector<level> levels_; ///< from fine to coarse; the last one is a single cell
};

} // namespace skybark::clouds
