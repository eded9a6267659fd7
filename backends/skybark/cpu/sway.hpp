#pragma once
// Swaying branches, four joints at a time: sway_inertia and sway_motion with the text of the plain
// kernels, so the bits are the same (a test compares them).

#include <skybark/cpu/programs/sway.hpp>
#include <skybark/kernels/sway_inertia.hpp>
#include <skybark/kernels/sway_motion.hpp>

#if defined(__GNUC__)

namespace skybark::cpu {
namespace four {

/// Up to four consecutive joints; spare lanes repeat the last.
struct joints {
    sway_joint all;
    const shared::sway_joint* plain[4];
    std::uint32_t at[4];
    std::uint32_t count;

    joints(std::span<const shared::sway_joint> from, std::uint32_t first, std::uint32_t left)
        : count(std::min(4u, left)) {
        for (std::uint32_t lane = 0; lane < 4; ++lane) {
            at[lane] = first + std::min(lane, count - 1);
            plain[lane] = &from[at[lane]];
        }
        all = gather<sway_joint>(plain);
    }
    template <class Four, class Record>
    [[nodiscard]] Four own(std::span<const Record> records) const {
        const Record* from[4] = {&records[at[0]], &records[at[1]], &records[at[2]],
                                 &records[at[3]]};
        return gather<Four>(from);
    }
    [[nodiscard]] sway_state parents(std::span<const shared::sway_state> states) const {
        const shared::sway_state* from[4];
        for (std::uint32_t lane = 0; lane < 4; ++lane) {
            from[lane] = &states[plain[lane]->parent];
        }
        return gather<sway_state>(from);
    }
    [[nodiscard]] vec4 parent_rotations(std::span<const shared::sway_state> states) const {
        const glm::vec4* from[4];
        for (std::uint32_t lane = 0; lane < 4; ++lane) {
            from[lane] = &states[plain[lane]->parent].rotation;
        }
        return gather<vec4>(from);
    }
    [[nodiscard]] sway_energy trees(std::span<const shared::sway_energy> energies) const {
        const shared::sway_energy* from[4];
        for (std::uint32_t lane = 0; lane < 4; ++lane) {
            from[lane] = &energies[plain[lane]->root];
        }
        return gather<sway_energy>(from);
    }
    /// Adds what the children carry, first to last.
    void add_children(std::span<const shared::sway_carry> carried, sway_carry& sum) const {
        // x + -0 is x, bit for bit: for lanes with fewer children.
        constexpr glm::vec4 no(-0.0f);
        static constexpr shared::sway_carry nothing{no, no, no, no, no, no, no};
        std::uint32_t most = 0;
        for (const shared::sway_joint* joint : plain) {
            most = std::max(most, joint->child_count);
        }
        for (std::uint32_t k = 0; k < most; ++k) {
            const shared::sway_carry* from[4];
            for (std::uint32_t lane = 0; lane < 4; ++lane) {
                from[lane] = k < plain[lane]->child_count ? &carried[plain[lane]->first_child + k]
                                                          : &nothing;
            }
            sum = sway_sum(sum, gather<sway_carry>(from));
        }
    }
};

} // namespace four

template <>
struct program<kernels::sway_inertia> : plain_program<kernels::sway_inertia> {
    static void map(const kernels::sway_inertia& kernel, range elements,
                    std::span<const shared::sway_joint> joints, std::span<const segment_load> loads,
                    std::span<const shared::sway_state> states,
                    std::span<const shared::sway_energy> energies,
                    std::span<const shared::sway_carry> carried,
                    std::span<shared::sway_carry> carry, std::span<shared::sway_gain> gains) {
        for (std::uint32_t done = 0; done < elements.count; done += 4) {
            const four::joints j(joints, elements.first + done, elements.count - done);
            const auto state = j.own<four::sway_state>(states);
            const four::sway_rule rule = four::sway_rule_of(j.all, kernel.seconds);
            four::sway_carry sum = four::sway_body(j.all, state, j.own<four::segment_load>(loads),
                                                   rule, j.trees(energies).scale, kernel.seconds);
            j.add_children(carried, sum);
            const four::sway_parted parted = four::sway_part(
                j.all, sum, rule, state.rotation, state.bend, j.parent_rotations(states));
            four::scatter(parted.carry, &carry[j.at[0]], j.count);
            four::scatter(parted.gain, &gains[j.at[0]], j.count);
        }
    }
};

template <>
struct program<kernels::sway_motion> : plain_program<kernels::sway_motion> {
    static void
    map(const kernels::sway_motion& kernel, range elements,
        std::span<const shared::sway_joint> joints, std::span<const shared::sway_energy> energies,
        std::span<const shared::sway_gain> gains, std::span<const shared::sway_state> before,
        std::span<const shared::sway_state> parents, std::span<shared::sway_state> states,
        std::span<segment_pose> poses, std::span<glm::vec4> velocities) {
        for (std::uint32_t done = 0; done < elements.count; done += 4) {
            const four::joints j(joints, elements.first + done, elements.count - done);
            const auto was = j.own<four::sway_state>(before);
            const four::sway_state now = four::sway_stepped(
                j.all, j.own<four::sway_gain>(gains), was, j.parent_rotations(before),
                j.parents(parents), four::sway_rule_of(j.all, kernel.seconds), j.trees(energies),
                kernel.seconds);
            four::scatter(now, &states[j.at[0]], j.count);
            four::scatter(four::sway_pose(j.all, now), &poses[j.at[0]], j.count);
            four::scatter(four::sway_velocity(j.all, was.rotation, now), &velocities[j.at[0]],
                          j.count);
        }
    }
};

} // namespace skybark::cpu

#endif
