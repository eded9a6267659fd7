#pragma once
// gather_scene: what light meets, on the device: triangles and what they do with light, and patches
// that keep the light which leaves them.
//
// A triangle's side is cut into rows² equal triangles, its patches, each with one radiance, as in
// radiosity; a ray that meets the triangle finds its patch by the barycentric weights (patch_at in
// shared/bundle.hpp). No texture coordinates are needed. A gather smooths over what it sees, so
// that steps between patches hardly show in it.
//
// Triangles may be rewritten on the device at any time (kernels::surface_triangles): nothing is
// built over them. Their number, materials, tables and patches stay.

#include <skybark/core/backend.hpp>
#include <skybark/core/when_used.hpp>
#include <skybark/gather/bundle.hpp>
#include <skybark/kernels/patch_samples.hpp>
#include <skybark/kernels/surface_light.hpp>

#include <optional>
#include <vector>

namespace skybark::gather {

struct scene_description {
    std::span<const gather_triangle> triangles;
    std::span<const gather_material> materials;
    /// Words: alpha_coordinates, then the maps that they name. Empty: no holes.
    std::span<const std::uint32_t> alpha;
    float patch_size = 0; ///< m: no patch has a longer edge, up to 1024 rows; 0: a patch a side
    float lift = 0;       ///< m: how far samples stand off their surfaces; 0: default_lift
    /// Where the triangles will be; absent: where they are.
    std::optional<bounds> box;
};

namespace detail {

inline constexpr std::uint32_t most_rows = 1024;
inline constexpr std::size_t alpha_words = sizeof(alpha_coordinates) / 4;

[[nodiscard]] inline bool is_finite(glm::vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <class = when_used>
[[nodiscard]] result<void> check_material(const gather_material& m, std::size_t number) {
    const glm::vec3 leaves = m.diffuse + m.transmission;
    const auto within = [](float x) { return x >= 0.0f && x <= 1.0f; };
    const auto emitted = [](float x) { return x >= 0.0f && std::isfinite(x); };
    for (int i = 0; i < 3; ++i) {
        if (!within(m.diffuse[i]) || !within(m.transmission[i]) || !(leaves[i] <= 1.0001f) ||
            !emitted(m.emission[i])) {
            return fail(error_code::bad_input,
                        "Material " + std::to_string(number) + " has a diffuse part of " +
                            std::to_string(m.diffuse[i]) + ", a transmitted one of " +
                            std::to_string(m.transmission[i]) + " and an emission of " +
                            std::to_string(m.emission[i]) +
                            "; expected parts from 0 to 1 with a sum up to 1, and a finite "
                            "emission that is not negative.");
        }
    }
    return {};
}

template <class = when_used>
[[nodiscard]] result<void> check_alpha(std::span<const std::uint32_t> words, std::uint32_t number,
                                       std::size_t triangle) {
    const std::size_t at = alpha_words * (number - std::size_t{1});
    if (at + alpha_words <= words.size()) {
        const std::uint64_t width = words[at + 7] & 0xffffu;
        const std::uint64_t height = words[at + 7] >> 16;
        if (width != 0 && height != 0 && words[at + 6] + width * height <= words.size()) {
            return {};
        }
    }
    return fail(error_code::bad_input,
                "Triangle " + std::to_string(triangle) + " names the alpha coordinates " +
                    std::to_string(number) + "; expected ones that lie, with their map, in the " +
                    std::to_string(words.size()) + " words given.");
}

template <class = when_used>
[[nodiscard]] result<void> check_scene(const scene_description& what) {
    if (what.triangles.empty() || what.triangles.size() > 0x7fffffffu) {
        return fail(error_code::bad_input, "A scene of " + std::to_string(what.triangles.size()) +
                                               " triangles was given; expected 1 to 2147483647.");
    }
    for (std::size_t i = 0; i < what.materials.size(); ++i) {
        if (auto done = check_material(what.materials[i], i); !done) {
            return done;
        }
    }
    for (std::size_t i = 0; i < what.triangles.size(); ++i) {
        const gather_triangle& t = what.triangles[i];
        if (t.material >= what.materials.size()) {
            return fail(error_code::bad_input,
                        "Triangle " + std::to_string(i) + " has the material " +
                            std::to_string(t.material) + "; expected one of " +
                            std::to_string(what.materials.size()) + ".");
        }
        if (!is_finite(t.a) || !is_finite(t.b) || !is_finite(t.c)) {
            return fail(error_code::bad_input, "Triangle " + std::to_string(i) +
                                                   " has a corner that is not finite; expected "
                                                   "places in metres.");
        }
        if (t.alpha != 0) {
            if (auto done = check_alpha(what.alpha, t.alpha, i); !done) {
                return done;
            }
        }
    }
    return {};
}

/// Rows of patches that a triangle needs.
[[nodiscard]] inline std::uint32_t rows_of(const gather_triangle& t, float patch_size) {
    if (!(patch_size > 0.0f)) {
        return 1;
    }
    const float longest =
        std::max({glm::length(t.b - t.a), glm::length(t.c - t.b), glm::length(t.a - t.c)});
    const float rows = std::ceil(longest / patch_size);
    return static_cast<std::uint32_t>(std::clamp(rows, 1.0f, static_cast<float>(most_rows)));
}

/// The patches of a scene: those of the fronts, triangle after triangle, then those of the backs.
struct patch_layout {
    std::vector<patch_table> tables;
    std::uint64_t patches = 0;

    [[nodiscard]] static patch_layout of(const scene_description& what) {
        patch_layout made;
        made.tables.resize(what.triangles.size());
        for (std::size_t i = 0; i < made.tables.size(); ++i) {
            made.tables[i].rows = rows_of(what.triangles[i], what.patch_size);
            made.tables[i].front = static_cast<std::uint32_t>(made.patches);
            made.patches += std::uint64_t{made.tables[i].rows} * made.tables[i].rows;
        }
        for (std::size_t i = 0; i < made.tables.size(); ++i) {
            if (what.materials[what.triangles[i].material].two_sided != 0) {
                made.tables[i].back = static_cast<std::uint32_t>(made.patches);
                made.patches += std::uint64_t{made.tables[i].rows} * made.tables[i].rows;
            }
        }
        return made;
    }

    /// Of each patch, 2 · its triangle, + 1 on the back.
    [[nodiscard]] std::vector<std::uint32_t> owners() const {
        std::vector<std::uint32_t> made(patches);
        for (std::size_t i = 0; i < tables.size(); ++i) {
            const std::size_t count = std::size_t{tables[i].rows} * tables[i].rows;
            const auto number = static_cast<std::uint32_t>(2 * i);
            std::fill_n(made.begin() + tables[i].front, count, number);
            if (tables[i].back != no_surface) {
                std::fill_n(made.begin() + tables[i].back, count, number + 1);
            }
        }
        return made;
    }
};

} // namespace detail

template <backend B>
requires maps<B, kernels::patch_samples> && maps<B, kernels::surface_light>
class gather_scene {
  public:
    /// Copies everything to the device. Radiance is the emission until something changes it.
    ///
    /// Errors: no triangles; one that is not finite, or names a material or alpha coordinates that
    /// there are not; materials that pass on more light than they get; more patches than the
    /// device's views hold; memory.
    [[nodiscard]] static result<gather_scene> create(B& device, const scene_description& what) {
        if (auto done = detail::check_scene(what); !done) {
            return failure(done.error());
        }
        const auto layout = detail::patch_layout::of(what);
        const std::uint64_t most = std::min<std::uint64_t>(
            device.limits().max_buffer_bytes / sizeof(gather_sample),
            std::min<std::uint64_t>(device.limits().max_elements, no_surface - 1));
        const std::uint64_t most_triangles =
            device.limits().max_buffer_bytes / sizeof(gather_triangle);
        if (layout.patches > most || what.triangles.size() > most_triangles) {
            return fail(error_code::out_of_memory,
                        "A scene of " + std::to_string(what.triangles.size()) + " triangles with " +
                            std::to_string(layout.patches) +
                            " patches was asked for; this device takes " +
                            std::to_string(most_triangles) + " triangles and " +
                            std::to_string(most) + " patches at most.");
        }
        gather_scene made(what, layout.patches);
        const std::vector<std::uint32_t> owners = layout.owners();
        const std::array<std::uint32_t, 4> no_alpha{};
        auto triangles = make_buffer<B, gather_triangle>(device, what.triangles);
        auto materials = make_buffer<B, gather_material>(device, what.materials);
        auto alpha = make_buffer<B, std::uint32_t>(
            device, what.alpha.empty() ? std::span<const std::uint32_t>(no_alpha) : what.alpha);
        auto tables = make_buffer<B, patch_table>(device, layout.tables);
        auto owner = make_buffer<B, std::uint32_t>(device, owners);
        auto samples = device.create_buffer(layout.patches * sizeof(gather_sample));
        auto radiance = device.create_buffer(layout.patches * sizeof(glm::vec4));
        for (const auto& [slot, buffer] :
             {std::pair{&made.triangles_, &triangles}, std::pair{&made.materials_, &materials},
              std::pair{&made.alpha_, &alpha}, std::pair{&made.tables_, &tables},
              std::pair{&made.owners_, &owner}, std::pair{&made.samples_, &samples},
              std::pair{&made.radiance_, &radiance}}) {
            if (!*buffer) {
                return failure(buffer->error());
            }
            slot->emplace(std::move(**buffer));
        }
        auto nothing = device.create_buffer(layout.patches * sizeof(glm::vec4)); // zeros
        if (!nothing) {
            return failure(nothing.error());
        }
        auto done = run(device, [&](auto& recorder) {
            made.record_samples(recorder);
            made.record_radiance(recorder, view<B>(*nothing));
        });
        if (!done) {
            return failure(done.error());
        }
        return made;
    }

    [[nodiscard]] std::uint32_t triangle_count() const noexcept { return triangle_count_; }
    [[nodiscard]] std::uint32_t patch_count() const noexcept { return patch_count_; }
    [[nodiscard]] const bounds& box() const noexcept { return box_; }
    [[nodiscard]] float lift() const noexcept { return lift_; }

    [[nodiscard]] buffer_view<B> triangles() const { return view<B>(*triangles_); }
    [[nodiscard]] buffer_view<B> materials() const { return view<B>(*materials_); }
    /// As bundle_work takes it: empty where nothing has holes.
    [[nodiscard]] buffer_view<B> alpha() const {
        return has_alpha_ ? view<B>(*alpha_) : buffer_view<B>{};
    }
    [[nodiscard]] buffer_view<B> tables() const { return view<B>(*tables_); }
    [[nodiscard]] buffer_view<B> owners() const { return view<B>(*owners_); }
    /// A gather_sample a patch: its middle and its normal.
    [[nodiscard]] buffer_view<B> patch_samples() const { return view<B>(*samples_); }
    /// A vec4 a patch: the radiance that leaves it, W/(m² sr). A caller's own goes here.
    [[nodiscard]] buffer_view<B> radiance() const { return view<B>(*radiance_); }

    /// The samples of the patches, after the triangles have changed.
    void record_samples(typename B::recorder& recorder) const {
        recorder.map(kernels::patch_samples{}, {owners(), tables(), triangles(), patch_samples()},
                     range{0, patch_count_});
    }

    /// The radiance, from the irradiance of each patch: a vec4 each, W/m², in another buffer.
    void record_radiance(typename B::recorder& recorder, const buffer_view<B>& irradiance) const {
        recorder.map(kernels::surface_light{},
                     {owners(), tables(), triangles(), materials(), irradiance, radiance()},
                     range{0, patch_count_});
    }

    /// Where triangles that move are from now on. The lift stays.
    void move_within(const bounds& box) noexcept { box_ = box; }

  private:
    gather_scene(const scene_description& what, std::uint64_t patches)
        : triangle_count_(static_cast<std::uint32_t>(what.triangles.size())),
          patch_count_(static_cast<std::uint32_t>(patches)),
          box_(what.box ? *what.box : bounds_of(what.triangles)),
          lift_(what.lift > 0.0f ? what.lift : default_lift(box_)),
          has_alpha_(!what.alpha.empty()) {}

    std::uint32_t triangle_count_;
    std::uint32_t patch_count_;
    bounds box_;
    float lift_;
    bool has_alpha_;
    std::optional<typename B::buffer> triangles_;
    std::optional<typename B::buffer> materials_;
    std::optional<typename B::buffer> alpha_;
    std::optional<typename B::buffer> tables_;
    std::optional<typename B::buffer> owners_;
    std::optional<typename B::buffer> samples_;
    std::optional<typename B::buffer> radiance_;
};

} // namespace skybark::gather
