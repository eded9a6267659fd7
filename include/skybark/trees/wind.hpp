#pragma once
// Wind on a device: the air's velocity at places, and its load on the segments of a skeleton.
//
//     auto air = trees::wind_field<B>::create(device, trees::segment_middles(tree),
//                                             trees::kaimal_gusts{.speed = 12});
//     auto loads = trees::wind_loads<B>::create(device, tree, leaf_area, {});
//     run(device, [&](auto& recorder) {
//         air->record(recorder, seconds);
//         loads->record(recorder, poses, air->air());
//     });
//
// The air at a segment is taken at its middle at rest: trees move by little against the size of the
// gusts that move them, and the wind of a segment then doesn't depend on how it sways.
//
// A wind of one's own:
//  - a table of waves (`gusts`), or a model that `tabulate` makes one of: wind_field;
//  - velocities on a regular grid, from a simulation or a measurement: wind_grid;
//  - a function of place and time on the host: wind_function;
//  - a kernel of one's own that writes the air on the device: anything that models `wind<W, B>`.

#include <skybark/core/backend.hpp>
#include <skybark/core/when_used.hpp>
#include <skybark/kernels/grid_wind.hpp>
#include <skybark/kernels/wave_wind.hpp>
#include <skybark/kernels/wind_load.hpp>
#include <skybark/trees/gusts.hpp>
#include <skybark/trees/skeleton.hpp>

#include <cassert>

namespace skybark::trees {

/// What can be asked for the air: after `record(recorder, seconds)`, `air()` holds one vec4 a
/// place, xyz the velocity in m/s and w its length.
template <class W, class B>
concept wind = backend<B> && requires(W& w, const W& c, typename B::recorder& recorder, double t) {
    w.record(recorder, t);
    { c.air() } -> std::same_as<buffer_view<B>>;
};

/// The middles of the segments at rest.
template <class = when_used>
[[nodiscard]] std::vector<glm::vec3> segment_middles(const skeleton& of) {
    std::vector<glm::vec3> middles(of.size());
    for (std::size_t i = 0; i < of.size(); ++i) {
        middles[i] = of.position[i] + of.orientation[i] * glm::vec3(0, of.length[i] / 2, 0);
    }
    return middles;
}

namespace detail {

/// Places as the kernels read them, w: the factor of the mean wind there. Errors: bad_input where
/// one is not a number or farther than 1e6 m from the origin; out_of_memory where they don't fit.
template <class = when_used>
[[nodiscard]] result<std::vector<glm::vec4>> wind_places(std::span<const glm::vec3> places,
                                                         const mean_profile& profile,
                                                         const device_limits& limits) {
    constexpr float most = 1e6f;
    if (places.size() > limits.max_buffer_bytes / sizeof(glm::vec4) ||
        places.size() >= 0xffffffffull) {
        return fail(error_code::out_of_memory,
                    std::string("Wind at ") + std::to_string(places.size()) +
                        " places needs a larger buffer than the device can bind.");
    }
    std::vector<glm::vec4> out(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        const glm::vec3& p = places[i];
        if (!(std::abs(p.x) <= most && std::abs(p.y) <= most && std::abs(p.z) <= most)) {
            return fail(error_code::bad_input, std::string("Place ") + std::to_string(i) +
                                                   " of a wind is not within 1e6 m of the origin.");
        }
        const double height = (double{p.y} - profile.ground) / profile.reference_height;
        const double factor =
            profile.exponent == 0 ? 1 : (height > 0 ? std::pow(height, profile.exponent) : 0);
        out[i] = {p, static_cast<float>(factor)};
    }
    return out;
}

/// A velocity as somebody else's function or table has it. What is no wind on earth would leave no
/// number in a tree that it has once blown on: calm in its place.
[[nodiscard]] inline glm::vec3 wind_or_calm(const glm::vec3& u) {
    constexpr float most = 1000; // m/s
    const bool is_wind = std::abs(u.x) <= most && std::abs(u.y) <= most && std::abs(u.z) <= most;
    return is_wind ? u : glm::vec3(0);
}

/// Maps over so many elements, in as many calls as the device's longest range asks for.
template <backend B, class K>
void map_all(typename B::recorder& to, const K& kernel, const bindings<B, K>& buffers,
             std::uint32_t count, std::uint32_t longest) {
    for (std::uint32_t first = 0; first < count;) {
        const std::uint32_t some = std::min(longest, count - first);
        to.map(kernel, buffers, range{first, some});
        first += some;
    }
}

template <class = when_used>
[[nodiscard]] std::uint32_t longest_range(const device_limits& limits) {
    return static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(limits.max_elements, 1, 0xffffffffu));
}

/// The buffers that every wind has: where the air is asked for, and the answer.
template <backend B>
struct wind_buffers {
    std::optional<typename B::buffer> places; // both are there after create
    std::optional<typename B::buffer> air;
    std::uint32_t count = 0;
    std::uint32_t longest = 1;

    [[nodiscard]] result<void> create(B& device, std::span<const glm::vec3> at,
                                      const mean_profile& profile) {
        const auto records = wind_places(at, profile, device.limits());
        if (!records) {
            return failure(records.error());
        }
        auto made = make_buffer<B, glm::vec4>(device, *records);
        if (!made) {
            return failure(made.error());
        }
        auto room = device.create_buffer(at.size() * sizeof(glm::vec4));
        if (!room) {
            return failure(room.error());
        }
        places = std::move(*made);
        air = std::move(*room);
        count = static_cast<std::uint32_t>(at.size());
        longest = longest_range(device.limits());
        return {};
    }
};

} // namespace detail

/// The wind of a table of waves.
///
/// Phases are brought to 0 … 1 on the host, in double, so that the wind is as fine after a month
/// as at the start. Wave vectors times places are in float: up to some kilometres from the origin.
template <backend B>
requires maps<B, kernels::wave_wind>
class wind_field {
  public:
    using buffer = typename B::buffer;
    using recorder = typename B::recorder;

    /// Sends places and table to the device.
    /// Errors: bad_input where a place or a value of the model is out of range; whatever the
    /// device says of memory.
    [[nodiscard]] static result<wind_field> create(B& device, std::span<const glm::vec3> places,
                                                   const gusts& table) {
        if (auto valid = tabulate(table); !valid) {
            return failure(valid.error());
        }
        wind_field field;
        if (auto done = field.buffers_.create(device, places, table.profile); !done) {
            return failure(done.error());
        }
        if (auto done = field.send(device, table); !done) {
            return failure(done.error());
        }
        return field;
    }

    template <gust_model M>
    [[nodiscard]] static result<wind_field> create(B& device, std::span<const glm::vec3> places,
                                                   const M& model) {
        auto table = tabulate(model);
        if (!table) {
            return failure(table.error());
        }
        return create(device, places, *table);
    }

    /// Another table of as many waves with the same profile, from the next `record` on. Its waves
    /// go on in the phases that they have at `time`, in seconds: where a model has another speed or
    /// direction and all else is the same, gusts that are under way stay, and grow or turn.
    /// Errors: bad_input where the number of waves or the profile is another, or a value out of
    /// range.
    [[nodiscard]] result<void> change(B& device, const gusts& table, double time) {
        if (auto valid = tabulate(table); !valid) {
            return failure(valid.error());
        }
        const mean_profile& own = profile_;
        if (table.waves.size() != tones_.size() || table.profile.exponent != own.exponent ||
            table.profile.reference_height != own.reference_height ||
            table.profile.ground != own.ground) {
            return fail(error_code::bad_input,
                        std::string("A wind of ")
                            .append(std::to_string(tones_.size()))
                            .append(" waves cannot change to ")
                            .append(std::to_string(table.waves.size()))
                            .append(" waves, or to another profile; create a new one."));
        }
        const std::vector<shared::wind_waves> waves = waves_of(table);
        kernel_.mean = glm::vec4(glm::vec3(table.mean), 0);
        for (std::size_t i = 0; i < tones_.size(); ++i) {
            const double frequency = table.waves[i].frequency;
            tones_[i].phase =
                detail::fraction(tones_[i].phase + (tones_[i].frequency - frequency) * time);
            tones_[i].frequency = frequency;
        }
        return device.upload(*waves_, 0, bytes_of(waves));
    }

    /// Appends the air at `time`, in seconds, finite. Allocates nothing.
    void record(recorder& to, double time) {
        assert(std::isfinite(time));
        for (std::size_t i = 0; i < tones_.size(); ++i) {
            const tone& w = tones_[i];
            phases_now_[i / 4][static_cast<int>(i % 4)] =
                static_cast<float>(detail::fraction(w.frequency * time + w.phase));
        }
        to.upload(view<B>(*phases_), bytes_of(phases_now_));
        detail::map_all<B>(to, kernel_,
                           {view<B>(*buffers_.places), view<B>(*waves_), view<B>(*phases_),
                            view<B>(*buffers_.air)},
                           buffers_.count, buffers_.longest);
    }

    /// One vec4 a place: xyz the velocity in m/s, w its length.
    [[nodiscard]] buffer_view<B> air() const { return view<B>(*buffers_.air); }
    [[nodiscard]] std::uint32_t size() const { return buffers_.count; }

  private:
    struct tone {
        double frequency = 0; // Hz
        double phase = 0;     // cycles
    };

    wind_field() = default;

    /// Four waves to a record; where there are none, one of no amplitude.
    [[nodiscard]] static std::vector<shared::wind_waves> waves_of(const gusts& table) {
        std::vector<shared::wind_waves> waves(
            std::max<std::size_t>(1, (table.waves.size() + 3) / 4));
        for (std::size_t i = 0; i < table.waves.size(); ++i) {
            const wave& w = table.waves[i];
            shared::wind_waves& four = waves[i / 4];
            const auto lane = static_cast<int>(i % 4);
            four.kx[lane] = static_cast<float>(w.wave_vector.x);
            four.ky[lane] = static_cast<float>(w.wave_vector.y);
            four.kz[lane] = static_cast<float>(w.wave_vector.z);
            four.ax[lane] = static_cast<float>(w.amplitude.x);
            four.ay[lane] = static_cast<float>(w.amplitude.y);
            four.az[lane] = static_cast<float>(w.amplitude.z);
        }
        return waves;
    }

    [[nodiscard]] result<void> send(B& device, const gusts& table) {
        const std::vector<shared::wind_waves> waves = waves_of(table);
        for (const wave& w : table.waves) {
            tones_.push_back({w.frequency, w.phase});
        }
        phases_now_.assign(waves.size(), glm::vec4(0));
        profile_ = table.profile;
        kernel_ = {glm::vec4(glm::vec3(table.mean), 0), static_cast<std::uint32_t>(waves.size())};
        auto made = make_buffer<B, shared::wind_waves>(device, waves);
        if (!made) {
            return failure(made.error());
        }
        auto room = device.create_buffer(waves.size() * sizeof(glm::vec4));
        if (!room) {
            return failure(room.error());
        }
        waves_ = std::move(*made);
        phases_ = std::move(*room);
        return {};
    }

    kernels::wave_wind kernel_;
    mean_profile profile_;
    detail::wind_buffers<B> buffers_;
    std::optional<buffer> waves_; // both are there after create
    std::optional<buffer> phases_;
    std::vector<tone> tones_;
    std::vector<glm::vec4> phases_now_; // kept, so that record allocates nothing
};

/// Where the nodes of a grid of velocities lie: node (i, j, k) at origin + spacing · (i, j, k), and
/// at index (k · nodes.y + j) · nodes.x + i.
struct wind_grid_layout {
    glm::vec3 origin{0};  ///< m, within 1e6 of the world's
    glm::vec3 spacing{1}; ///< m, 1e-6 … 1e6
    std::uint32_t nx = 1; ///< 1 … 16,777,216, as are ny and nz
    std::uint32_t ny = 1;
    std::uint32_t nz = 1;

    [[nodiscard]] std::uint64_t size() const { return std::uint64_t{nx} * ny * nz; }
};

/// The wind of a regular grid: trilinear between its nodes, outside as at its nearest place.
template <backend B>
requires maps<B, kernels::grid_wind>
class wind_grid {
  public:
    using buffer = typename B::buffer;
    using recorder = typename B::recorder;

    /// `velocities`, m/s: one a node. What is not within 1000 m/s along each axis is a calm.
    /// Errors: bad_input where a place or the layout is out of range or the number of velocities
    /// is another; whatever the device says of memory.
    [[nodiscard]] static result<wind_grid> create(B& device, std::span<const glm::vec3> places,
                                                  const wind_grid_layout& layout,
                                                  std::span<const glm::vec3> velocities) {
        if (auto valid = check(layout, velocities.size(), device.limits()); !valid) {
            return failure(valid.error());
        }
        wind_grid grid;
        if (auto done = grid.buffers_.create(device, places, {}); !done) {
            return failure(done.error());
        }
        grid.kernel_ = {glm::vec4(layout.origin, 0), glm::vec4(1.0f / layout.spacing, 0), layout.nx,
                        layout.ny, layout.nz};
        grid.scratch_.resize(velocities.size());
        grid.widen(velocities);
        auto made = make_buffer<B, glm::vec4>(device, grid.scratch_);
        if (!made) {
            return failure(made.error());
        }
        grid.nodes_ = std::move(*made);
        return grid;
    }

    /// Appends new velocities, as many as there are nodes: a wind that changes. Copied when called.
    void set(recorder& to, std::span<const glm::vec3> velocities) {
        assert(velocities.size() == scratch_.size());
        widen(velocities);
        to.upload(view<B>(*nodes_), bytes_of(scratch_));
    }
    /// The nodes on the device, one vec4 each (w unused), for a kernel that writes them there.
    [[nodiscard]] buffer_view<B> velocities() const { return view<B>(*nodes_); }

    /// Appends the air as the grid has it; the time is not needed. Allocates nothing.
    void record(recorder& to, double /*time*/) {
        detail::map_all<B>(to, kernel_,
                           {view<B>(*buffers_.places), view<B>(*nodes_), view<B>(*buffers_.air)},
                           buffers_.count, buffers_.longest);
    }

    [[nodiscard]] buffer_view<B> air() const { return view<B>(*buffers_.air); }
    [[nodiscard]] std::uint32_t size() const { return buffers_.count; }

  private:
    wind_grid() = default;

    [[nodiscard]] static result<void> check(const wind_grid_layout& layout, std::size_t velocities,
                                            const device_limits& limits) {
        constexpr double longest = 16'777'216; // floats count no further
        if (auto valid = detail::expect_ranges(
                {{"number of a wind grid's nodes along x", static_cast<double>(layout.nx), 1,
                  longest},
                 {"number of a wind grid's nodes along y", static_cast<double>(layout.ny), 1,
                  longest},
                 {"number of a wind grid's nodes along z", static_cast<double>(layout.nz), 1,
                  longest},
                 {"spacing of a wind grid along x", double{layout.spacing.x}, 1e-6, 1e6},
                 {"spacing of a wind grid along y", double{layout.spacing.y}, 1e-6, 1e6},
                 {"spacing of a wind grid along z", double{layout.spacing.z}, 1e-6, 1e6},
                 {"origin of a wind grid along x", double{layout.origin.x}, -1e6, 1e6},
                 {"origin of a wind grid along y", double{layout.origin.y}, -1e6, 1e6},
                 {"origin of a wind grid along z", double{layout.origin.z}, -1e6, 1e6}});
            !valid) {
            return valid;
        }
        const double nodes = static_cast<double>(layout.nx) * layout.ny * layout.nz;
        if (nodes > static_cast<double>(limits.max_buffer_bytes / sizeof(glm::vec4)) ||
            nodes >= 4294967295.0) {
            return fail(error_code::out_of_memory,
                        std::string("A wind grid of ") + std::to_string(nodes) +
                            " nodes needs a larger buffer than the device can bind.");
        }
        if (velocities != layout.size()) {
            return fail(error_code::bad_input,
                        std::string("A wind grid of ") + std::to_string(layout.size()) +
                            " nodes was given " + std::to_string(velocities) + " velocities.");
        }
        return {};
    }

    void widen(std::span<const glm::vec3> velocities) {
        for (std::size_t i = 0; i < scratch_.size(); ++i) {
            scratch_[i] = glm::vec4(detail::wind_or_calm(velocities[i]), 0);
        }
    }

    kernels::grid_wind kernel_;
    detail::wind_buffers<B> buffers_;
    std::optional<buffer> nodes_; // there after create
    std::vector<glm::vec4> scratch_;
};

/// The wind of a function on the host: `function(place in m, time in s)`, in m/s, is called for
/// every place at every `record`, and the answers are sent to the device. What is not within
/// 1000 m/s along each axis is a calm.
template <backend B, class Function>
requires std::is_invocable_r_v<glm::vec3, Function&, glm::vec3, double>
class wind_function {
  public:
    using buffer = typename B::buffer;
    using recorder = typename B::recorder;

    /// Errors: bad_input where a place is out of range; whatever the device says of memory.
    [[nodiscard]] static result<wind_function> create(B& device, std::span<const glm::vec3> places,
                                                      Function function) {
        const auto valid = detail::wind_places(places, {}, device.limits());
        if (!valid) {
            return failure(valid.error());
        }
        auto room = device.create_buffer(places.size() * sizeof(glm::vec4));
        if (!room) {
            return failure(room.error());
        }
        return wind_function(places, std::move(function), std::move(*room));
    }

    /// Appends the air at `time`. Allocates nothing but what the function does.
    void record(recorder& to, double time) {
        for (std::size_t i = 0; i < places_.size(); ++i) {
            const glm::vec3 u = detail::wind_or_calm(function_(places_[i], time));
            now_[i] = shared::wind_velocity(u.x, u.y, u.z);
        }
        if (!now_.empty()) {
            to.upload(view<B>(air_), bytes_of(now_));
        }
    }

    [[nodiscard]] buffer_view<B> air() const { return view<B>(air_); }
    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(now_.size()); }

  private:
    wind_function(std::span<const glm::vec3> places, Function function, buffer air)
        : function_(std::move(function)), places_(places.begin(), places.end()),
          now_(places.size()), air_(std::move(air)) {}

    Function function_;
    std::vector<glm::vec3> places_;
    std::vector<glm::vec4> now_;
    buffer air_;
};

/// `wind_function<B, F>::create` for a lambda, whose type has no name.
template <backend B, class Function>
[[nodiscard]] result<wind_function<B, Function>>
make_wind_function(B& device, std::span<const glm::vec3> places, Function function) {
    return wind_function<B, Function>::create(device, places, std::move(function));
}

/// How the air drags. A crown's drag grows as U^(2 + vogel) above the reference speed, because
/// leaves fold and turn: exponents of −0.5 to −1 are measured (Vogel 1984; Vollsinger et al. 2005,
/// whose crowns are smaller from the 4 m/s on at which their tests begin). 0 is rigid, bare wood's.
/// The coefficients in leaf are twice the 0.2 of canopies' drag ρ c_d a U² (Katul et al. 2004),
/// where `a` counts leaves and twigs alike and shelter is in c_d.
struct drag_options {
    double air_density = 1.2; ///< kg/m³, 0 … 1e4
    double wood = 1.1;        ///< C_d of a cylinder below its drag crisis, 0 … 10
    double sheltered = 0.4;   ///< C_d of wood on trees in leaf, whose crowns slow the air; 0 … 10
    double leaves = 0.4;      ///< C_d on one side of all leaves; 0 … 10
    double vogel = -0.7;      ///< of the leaves, −1 … 0
    double reference = 4;     ///< m/s, where the leaves begin to yield, 1e-3 … 1000
};

/// What the wind does to the segments of a skeleton: a segment_load each.
///
/// The damping is the derivative of the drag along itself; across the wind it is half of that, so
/// that motion across is damped more than it would be.
template <backend B>
requires maps<B, kernels::wind_load>
class wind_loads {
  public:
    using buffer = typename B::buffer;
    using recorder = typename B::recorder;

    /// `leaf_area`: m², one side of all leaves on each segment; none where it is empty.
    /// Errors: bad_input where an option or an area is out of range or the number of areas is
    /// neither 0 nor the segments'; out_of_memory where their poses would not fit the device's
    /// largest buffer; whatever the device says of memory.
    [[nodiscard]] static result<wind_loads> create(B& device, const skeleton& of,
                                                   std::span<const float> leaf_area,
                                                   const drag_options& options) {
        if (auto valid = check(options, of, leaf_area, device.limits()); !valid) {
            return failure(valid.error());
        }
        const std::vector<bool> leafy = trees_in_leaf(of, leaf_area);
        std::vector<shared::wind_segment> segments(of.size());
        for (std::size_t i = 0; i < of.size(); ++i) {
            const float across = of.length[i] * (of.base_radius[i] + of.radius[i]);
            const float leaves = leaf_area.empty() ? 0 : leaf_area[i];
            if (auto valid = check_areas(i, across, leaves); !valid) {
                return failure(valid.error());
            }
            const auto wood = static_cast<float>(leafy[i] ? options.sheltered : options.wood);
            const glm::vec3 axis = of.orientation[i] * glm::vec3(0, 1, 0);
            segments[i].axis = glm::vec4(axis, wood * across);
            segments[i].leaves = glm::vec4(static_cast<float>(options.leaves) * leaves, 0, 0, 0);
        }
        wind_loads made;
        auto sent = make_buffer<B, shared::wind_segment>(device, segments);
        if (!sent) {
            return failure(sent.error());
        }
        auto room = device.create_buffer(of.size() * sizeof(segment_load));
        if (!room) {
            return failure(room.error());
        }
        made.segments_ = std::move(*sent);
        made.loads_ = std::move(*room);
        made.count_ = static_cast<std::uint32_t>(of.size());
        made.longest_ = detail::longest_range(device.limits());
        made.kernel_ = {static_cast<float>(0.5 * options.air_density),
                        static_cast<float>(options.vogel), static_cast<float>(options.reference)};
        return made;
    }

    /// Appends the loads of this air on segments in these poses: one segment_pose and one vec4 a
    /// segment. Allocates nothing.
    void record(recorder& to, buffer_view<B> poses, buffer_view<B> air) const {
        detail::map_all<B>(to, kernel_, {view<B>(*segments_), poses, air, view<B>(*loads_)}, count_,
                           longest_);
    }

    /// One segment_load a segment.
    [[nodiscard]] buffer_view<B> loads() const { return view<B>(*loads_); }
    [[nodiscard]] std::uint32_t size() const { return count_; }

  private:
    wind_loads() = default;

    [[nodiscard]] static result<void> check(const drag_options& options, const skeleton& of,
                                            std::span<const float> leaf_area,
                                            const device_limits& limits) {
        if (!leaf_area.empty() && leaf_area.size() != of.size()) {
            return fail(error_code::bad_input,
                        std::string("A skeleton of ") + std::to_string(of.size()) +
                            " segments was given " + std::to_string(leaf_area.size()) +
                            " leaf areas.");
        }
        if (of.size() > limits.max_buffer_bytes / sizeof(segment_pose) ||
            of.size() >= 0xffffffffull) {
            return fail(error_code::out_of_memory,
                        std::string("The poses of ") + std::to_string(of.size()) +
                            " segments need a larger buffer than the device can bind.");
        }
        return detail::expect_ranges(
            {{"air's density", options.air_density, 0, 1e4},
             {"drag coefficient of wood", options.wood, 0, 10},
             {"drag coefficient of sheltered wood", options.sheltered, 0, 10},
             {"drag coefficient of leaves", options.leaves, 0, 10},
             {"Vogel exponent", options.vogel, -1, 0},
             {"reference speed of leaves", options.reference, 1e-3, 1000}});
    }

    /// Whether the tree that each segment belongs to has leaves.
    [[nodiscard]] static std::vector<bool> trees_in_leaf(const skeleton& of,
                                                         std::span<const float> leaf_area) {
        std::vector<std::uint32_t> root(of.size());
        std::vector<bool> leafy(of.size(), false);
        for (std::uint32_t i = 0; i < of.size(); ++i) {
            root[i] = of.parent[i] == none ? i : root[of.parent[i]];
            if (!leaf_area.empty() && leaf_area[i] > 0) {
                leafy[root[i]] = true;
            }
        }
        for (std::size_t i = 0; i < of.size(); ++i) {
            leafy[i] = leafy[root[i]];
        }
        return leafy;
    }

    [[nodiscard]] static result<void> check_areas(std::size_t i, float wood, float leaves) {
        constexpr float most = 1e6f; // m²
        if (wood >= 0 && wood <= most && leaves >= 0 && leaves <= most) {
            return {};
        }
        return fail(error_code::bad_input, std::string("Segment ") + std::to_string(i) + " shows " +
                                               std::to_string(wood) + " m² of wood and " +
                                               std::to_string(leaves) +
                                               " m² of leaves to the wind; it takes 0 to 1e6.");
    }

    kernels::wind_load kernel_;
    std::optional<buffer> segments_; // both are there after create
    std::optional<buffer> loads_;
    std::uint32_t count_ = 0;
    std::uint32_t longest_ = 1;
};

} // namespace skybark::trees
