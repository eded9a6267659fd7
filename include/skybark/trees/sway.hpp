#pragma once
// Trees that sway: forces on segments in, poses of segments out, every frame anew.
//
//     auto swaying = trees::sway<B>::create(device, skeleton, {});
//     run(device, [&](auto& r) { swaying->record(r, loads, 1.0f / 60); });   // loads: segment_load
//     … swaying->poses() …                                                  // segment_pose
//
// All trees of a skeleton move in one batch, in passes over the levels of the hierarchy: from the
// tips to the roots, where what a segment carries is summed up, and back, where joints bend and
// segments follow. A segment is rigid, its joint with its parent an elastic one in three axes; a
// root's joint is clamped to the ground. The rest pose is the one under the tree's own weight, so
// no gravity acts here. Three models:
//
//   paper         Akagi and Kitajima, section 2.5, word for word: forces are summed without their
//                 lever arms. It does not converge as segments get finer (docs/sway.md).
//   quasi_static  Each frame the equilibrium of moments M_parent = sum of (M_child + r x F_child)
//                 with bends M / k, in the bent pose: Newton's method in O(n) a step.
//   dynamic       With inertia, damping of the wood and drag: Featherstone's articulated bodies,
//                 one implicit step a frame, stable at any length of the step. Energy never grows
//                 beyond the work of the loads, and without damping it stays.
//
// How each works and how well: docs/sway.md.

#include <skybark/core/backend.hpp>
#include <skybark/kernels/sway_bends.hpp>
#include <skybark/kernels/sway_energies.hpp>
#include <skybark/kernels/sway_forces.hpp>
#include <skybark/kernels/sway_inertia.hpp>
#include <skybark/kernels/sway_moments.hpp>
#include <skybark/kernels/sway_motion.hpp>
#include <skybark/trees/wood.hpp>

#include <limits>

namespace skybark::trees {

enum class sway_model { paper, quasi_static, dynamic };

struct sway_options {
    sway_model model = sway_model::dynamic;
    wood material;
    /// Of quasi_static: steps of Newton's method a frame, from the last frame's pose; 1 … 100. Four
    /// follow a wind; from rest to a load that bends a branch right over takes eight.
    std::uint32_t iterations = 4;
};

/// What a joint remembers from frame to frame; to save and to resume.
struct joint_motion {
    glm::vec3 bend{0}; ///< rad, rotation vector from rest, in the parent's axes
    glm::vec3 rate{0}; ///< rad/s, of the joint, in the same axes
};

/// The sway of all trees of a skeleton, on a device of backend B.
template <backend B>
requires maps<B, kernels::sway_inertia> && maps<B, kernels::sway_motion> &&
    maps<B, kernels::sway_energies> && maps<B, kernels::sway_moments> &&
    maps<B, kernels::sway_forces> && maps<B, kernels::sway_bends>
class sway {
  public:
    using buffer = typename B::buffer;
    using recorder = typename B::recorder;

    /// The longest step, s. `record` takes a longer one for this.
    static constexpr float longest_step = 1;

    /// Makes the joints and puts them at rest. `leaf_mass`: kg carried by each segment beyond its
    /// wood, spread along it; empty (none), or size() entries.
    /// Errors: bad_input where a value is out of range or `leaf_mass` has another size;
    /// out_of_memory where a buffer would be larger than the device takes.
    [[nodiscard]] static result<sway> create(B& device, const skeleton& of,
                                             sway_options options = {},
                                             std::span<const float> leaf_mass = {}) {
        if (auto valid = check(of, options, leaf_mass); !valid) {
            return failure(valid.error());
        }
        sway made;
        made.options_ = options;
        if (auto done = made.build(device, of, leaf_mass); !done) {
            return failure(done.error());
        }
        return made;
    }

    /// Appends one frame. `loads`: one segment_load a segment, in the skeleton's order. `step` in
    /// s; 0 or less: nothing moves. Allocates nothing. Each recording must be submitted, once and
    /// in order.
    void record(recorder& to, const buffer_view<B>& loads, float step) {
        if (!(step > 0)) {
            return;
        }
        switch (options_.model) {
        case sway_model::paper:
            to.map(kernels::sway_forces{},
                   {view<B>(*joints_), loads, now(), view<B>(*carries_), view<B>(*carries_),
                    view<B>(*gains_)},
                   up());
            bend(to);
            break;
        case sway_model::quasi_static:
            for (std::uint32_t i = 0; i < options_.iterations; ++i) {
                to.map(kernels::sway_moments{},
                       {view<B>(*joints_), loads, now(), view<B>(*carries_), view<B>(*carries_),
                        view<B>(*gains_)},
                       up());
                bend(to);
            }
            break;
        case sway_model::dynamic:
            move(to, loads, std::min(step, longest_step));
            break;
        }
    }

    /// One segment_pose a segment, of the last frame, in the skeleton's order.
    [[nodiscard]] buffer_view<B> poses() const { return view<B>(*poses_); }

    /// One vec4 a segment: xyz the velocity of its middle over the last step (m/s), with which its
    /// load did work: power = force · velocity. Zero in the models without inertia.
    [[nodiscard]] buffer_view<B> velocities() const { return view<B>(*velocities_); }

    [[nodiscard]] std::size_t size() const noexcept { return roots_.size(); }

    /// The trees, and the first natural frequency of each (rad/s).
    [[nodiscard]] const std::vector<sway_layout::tree>& trees() const noexcept { return trees_; }

    /// Brings all joints to rest.
    [[nodiscard]] result<void> reset(B& device) {
        return upload(device, std::vector<joint_motion>(size()));
    }

    /// The joints as they are now, in the skeleton's order.
    [[nodiscard]] result<std::vector<joint_motion>> download(B& device) const {
        std::vector<shared::sway_state> states(size());
        std::vector<shared::sway_energy> energies(size());
        if (auto done = device.download(*states_[current_], 0, writable_bytes_of(states)); !done) {
            return failure(done.error());
        }
        if (auto done = device.download(*energies_, 0, writable_bytes_of(energies)); !done) {
            return failure(done.error());
        }
        std::vector<joint_motion> joints(size());
        for (std::size_t i = 0; i < size(); ++i) {
            // The states hold rates before the scale that keeps a tree's energy.
            joints[i] = {states[i].bend, states[i].rate * energies[roots_[i]].scale};
        }
        return joints;
    }

    /// Puts the joints where `download` found them: `motions` has size() entries. The poses follow.
    [[nodiscard]] result<void> upload(B& device, std::span<const joint_motion> motions) {
        if (motions.size() != size()) {
            return fail(error_code::bad_input,
                        text(motions.size(), " joints do not fit a sway of ", size()));
        }
        std::vector<shared::sway_state> states(size() + 1, at_rest());
        for (std::size_t i = 0; i < size(); ++i) {
            states[i].bend = motions[i].bend;
            states[i].rate = motions[i].rate;
        }
        const std::vector<shared::sway_gain> still(size());
        if (auto done = device.upload(*states_[current_], 0, bytes_of(states)); !done) {
            return done;
        }
        if (auto done = device.upload(*gains_, 0, bytes_of(still)); !done) {
            return done;
        }
        return run(device, [&](recorder& to) {
            bend(to);
            // No time passes, so that loads do no work, whatever they are.
            sum_energies(to, view<B>(*velocities_), 0);
        });
    }

  private:
    [[nodiscard]] static std::string text(std::uint64_t a, std::string_view between,
                                          std::uint64_t b) {
        return std::to_string(a).append(between).append(std::to_string(b)).append(".");
    }

    [[nodiscard]] static result<void> check(const skeleton& of, const sway_options& options,
                                            std::span<const float> leaf_mass) {
        const wood& w = options.material;
        const auto positive = [](double x) { return x > 0 && x < 1e30; };
        if (!positive(w.elasticity) || !positive(w.density) ||
            !(w.damping_ratio >= 0 && w.damping_ratio < 1e6)) {
            return fail(error_code::bad_input,
                        "Wood needs an elasticity and a density above 0 and a damping ratio of 0 "
                        "or more.");
        }
        if (options.iterations < 1 || options.iterations > 100) {
            return fail(error_code::bad_input,
                        text(options.iterations, " iterations a frame are not within 1 to ", 100));
        }
        if (of.empty() || of.size() >= none) {
            return fail(error_code::bad_input,
                        text(of.size(), " segments are not within 1 to ", none - 1));
        }
        if (!leaf_mass.empty() && leaf_mass.size() != of.size()) {
            return fail(
                error_code::bad_input,
                text(leaf_mass.size(), " masses of leaves do not fit segments: ", of.size()));
        }
        for (std::size_t i = 0; i < leaf_mass.size(); ++i) {
            if (!(leaf_mass[i] >= 0 && leaf_mass[i] < 1e30f)) {
                return fail(error_code::bad_input, std::string("The mass of the leaves of segment ")
                                                       .append(std::to_string(i))
                                                       .append(" is not a number from 0 kg up."));
            }
        }
        return {};
    }

    [[nodiscard]] static shared::sway_state at_rest() {
        shared::sway_state state{};
        state.rotation = {0, 0, 0, 1};
        return state;
    }

    [[nodiscard]] result<void> build(B& device, const skeleton& of,
                                     std::span<const float> leaf_mass) {
        sway_layout layout = layout_sway(of, options_.material, leaf_mass);
        if (options_.model == sway_model::paper) {
            use_paper_stiffness(layout, of);
        }
        trees_ = std::move(layout.trees);
        roots_.reserve(of.size());
        for (const shared::sway_joint& joint : layout.joints) {
            roots_.push_back(joint.root);
        }
        for (std::size_t l = 0; l + 1 < of.levels.size(); ++l) {
            down_.push_back({of.levels[l], of.levels[l + 1] - of.levels[l]});
        }
        for (std::size_t l = down_.size(); l != 0; --l) {
            up_.push_back(down_[l - 1]);
        }
        if (auto done = allocate(device, layout.joints); !done) {
            return done;
        }
        return reset(device);
    }

    /// One segment that is held at its base and pushed at its tip moves its tip by F L³ / (3 E I),
    /// which is the lever L times an angle of F L / k: k = 3 E I / L.
    void use_paper_stiffness(sway_layout& layout, const skeleton& of) const {
        constexpr double pi = 3.14159265358979323846;
        for (std::size_t i = 0; i < of.size(); ++i) {
            const double radius =
                std::max((double{of.base_radius[i]} + double{of.radius[i]}) / 2, least_wood_radius);
            const double length = std::max(double{of.length[i]}, least_wood_length);
            layout.joints[i].stiffness = static_cast<float>(3 * options_.material.elasticity * pi /
                                                            4 * std::pow(radius, 4) / length);
        }
    }

    [[nodiscard]] result<void> allocate(B& device, const std::vector<shared::sway_joint>& joints) {
        const std::uint64_t n = joints.size();
        const std::uint64_t carry =
            options_.model == sway_model::dynamic        ? sizeof(shared::sway_carry)
            : options_.model == sway_model::quasi_static ? sizeof(shared::sway_moment)
                                                         : sizeof(glm::vec4);
        const std::pair<std::optional<buffer>*, std::uint64_t> wanted[] = {
            {&joints_, n * sizeof(shared::sway_joint)},
            {&energies_, n * sizeof(shared::sway_energy)},
            {&carries_, n * carry},
            {&gains_, n * sizeof(shared::sway_gain)},
            {&states_[0], (n + 1) * sizeof(shared::sway_state)},
            {&states_[1], (n + 1) * sizeof(shared::sway_state)},
            {&poses_, n * sizeof(segment_pose)},
            {&velocities_, n * sizeof(glm::vec4)},
        };
        for (const auto& [to, bytes] : wanted) {
            if (bytes > device.limits().max_buffer_bytes) {
                return fail(error_code::out_of_memory,
                            text(bytes, " bytes for the joints are more than a buffer can have: ",
                                 device.limits().max_buffer_bytes));
            }
            auto made = device.create_buffer(bytes);
            if (!made) {
                return failure(made.error());
            }
            to->emplace(*std::move(made));
        }
        const shared::sway_state ground = at_rest();
        for (const std::optional<buffer>& states : states_) {
            if (auto done = device.upload(*states, n * sizeof ground, bytes_of_one(ground));
                !done) {
                return done;
            }
        }
        return device.upload(*joints_, 0, bytes_of(joints));
    }

    [[nodiscard]] const std::vector<range>& up() const { return up_; }
    [[nodiscard]] const std::vector<range>& down() const { return down_; }
    [[nodiscard]] buffer_view<B> now() const { return view<B>(*states_[current_]); }
    [[nodiscard]] buffer_view<B> next() const { return view<B>(*states_[1 - current_]); }

    /// The way up, the way down, and the energies that the next frame starts with.
    void move(recorder& to, const buffer_view<B>& loads, float step) {
        to.map(kernels::sway_inertia{step},
               {view<B>(*joints_), loads, now(), view<B>(*energies_), view<B>(*carries_),
                view<B>(*carries_), view<B>(*gains_)},
               up());
        to.map(kernels::sway_motion{step},
               {view<B>(*joints_), view<B>(*energies_), view<B>(*gains_), now(), next(), next(),
                view<B>(*poses_), view<B>(*velocities_)},
               down());
        current_ = 1 - current_;
        sum_energies(to, loads, step);
    }

    void bend(recorder& to) {
        to.map(kernels::sway_bends{},
               {view<B>(*joints_), view<B>(*gains_), now(), next(), next(), view<B>(*poses_),
                view<B>(*velocities_)},
               down());
        current_ = 1 - current_;
    }

    void sum_energies(recorder& to, const buffer_view<B>& loads, float step) const {
        to.map(kernels::sway_energies{step},
               {view<B>(*joints_), now(), loads, view<B>(*velocities_), view<B>(*energies_),
                view<B>(*energies_)},
               up());
    }

    sway_options options_;
    std::vector<sway_layout::tree> trees_;
    std::vector<std::uint32_t> roots_;
    std::vector<range> down_;
    std::vector<range> up_;
    std::optional<buffer> joints_; // all are there after create
    std::optional<buffer> energies_;
    std::optional<buffer> carries_;
    std::optional<buffer> gains_;
    std::optional<buffer>
        states_[2]; ///< before and after a step, in turns; both end with the ground
    std::optional<buffer> poses_;
    std::optional<buffer> velocities_;
    std::uint32_t current_ = 0; ///< which of the states is the last frame's
};

} // namespace skybark::trees
