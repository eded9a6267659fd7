#pragma once
// The kernels of multiple scattering that cost most, four cells of a row at a time.
//
// The operations and their order are those of shared/scatter.hpp and of the kernels, so the bits
// are the same (a test compares them). What is left over of a row runs the plain kernel, and so
// does everything on compilers without vector types.

#include <skybark/cpu/bark.hpp> // lanes::floor
#include <skybark/cpu/grids.hpp>
#include <skybark/kernels/scatter_medium.hpp>
#include <skybark/kernels/scatter_prolong.hpp>
#include <skybark/kernels/scatter_relax.hpp>
#include <skybark/kernels/scatter_restrict.hpp>

#if defined(__GNUC__)

namespace skybark::cpu {

/// The balance of cells of one row, four or more of them.
class scatter_row {
  public:
    scatter_row(const kernels::scatter_equation& equation, bool from_zero, int y, int z,
                const grids& from)
        : absorption_(equation.absorption), from_zero_(from_zero) {
        const glm::ivec3 size = from.size(1);
        here_ = rows::of(from, y, z);
        extinction_ = from.read_row(2, y, z);
        source_ = from.read_row(3, y, z);
        const glm::ivec2 to[] = {{y - 1, z}, {y + 1, z}, {y, z - 1}, {y, z + 1}};
        for (std::size_t i = 0; i < 4; ++i) {
            const float side = equation.sides[i < 2 ? 1 : 2];
            beyond_[i].inside =
                to[i].x >= 0 && to[i].x < size.y && to[i].y >= 0 && to[i].y < size.z;
            beyond_[i].side = side;
            beyond_[i].escape = shared::scatter_escape(equation.sides.w, side) / side;
            if (beyond_[i].inside) {
                beyond_[i].at = rows::of(from, to[i].x, to[i].y);
            }
        }
        side_x_ = equation.sides.x;
        escape_x_ = shared::scatter_escape(equation.sides.w, side_x_) / side_x_;
        last_ = static_cast<std::size_t>(size.x) - 4;
    }

    struct balance {
        lanes::f4 gain;
        lanes::f4 loss;
    };

    /// Of the cells x … x + 3.
    [[nodiscard]] balance at(std::size_t x) const {
        using namespace lanes;
        const f4 here = load(here_.resistance + 4 * x);
        balance sum{load(source_ + 4 * x), splat(absorption_) * load(extinction_ + 4 * x)};
        sum = x == 0 ? past_start(sum, here) : across(sum, here, here_, x - 1, side_x_);
        sum = x == last_ ? past_end(sum, here) : across(sum, here, here_, x + 1, side_x_);
        for (const border& b : beyond_) {
            if (b.inside) {
                sum = across(sum, here, b.at, x, b.side);
            } else {
                sum.loss = sum.loss + splat(b.escape);
            }
        }
        return sum;
    }

    [[nodiscard]] lanes::f4 fluence(std::size_t x) const {
        return from_zero_ ? lanes::splat(0) : lanes::load(here_.fluence + 4 * x);
    }

  private:
    struct rows {
        const std::byte* fluence = nullptr;
        const std::byte* resistance = nullptr;
        [[nodiscard]] static rows of(const grids& from, int y, int z) {
            return {from.read_row(0, y, z), from.read_row(1, y, z)};
        }
    };
    struct border {
        rows at;
        float side = 1;
        float escape = 0;
        bool inside = false;
    };

    [[nodiscard]] balance across(balance sum, lanes::f4 here, const rows& to, std::size_t x,
                                 float side) const {
        using namespace lanes;
        const f4 phi = from_zero_ ? splat(0) : load(to.fluence + 4 * x);
        return across(sum, here, load(to.resistance + 4 * x), phi, side);
    }
    [[nodiscard]] static balance across(balance sum, lanes::f4 here, lanes::f4 resistance,
                                        lanes::f4 phi, float side) {
        using namespace lanes;
        const f4 passes = splat(2.0f) / ((here + resistance) * splat(side) * splat(side));
        return {sum.gain + passes * phi, sum.loss + passes};
    }

    /// Across to the left of the first four cells, and to the right of the last four: one of the
    /// neighbours is beyond the border.
    [[nodiscard]] balance past_start(balance sum, lanes::f4 here) const {
        using namespace lanes;
        const f4 phi = fluence(0);
        const balance all = across(sum, here, __builtin_shufflevector(here, here, 0, 0, 1, 2),
                                   __builtin_shufflevector(phi, phi, 0, 0, 1, 2), side_x_);
        return escaping(sum, all, i4{-1, 0, 0, 0});
    }
    [[nodiscard]] balance past_end(balance sum, lanes::f4 here) const {
        using namespace lanes;
        const f4 phi = fluence(last_);
        const balance all = across(sum, here, __builtin_shufflevector(here, here, 1, 2, 3, 3),
                                   __builtin_shufflevector(phi, phi, 1, 2, 3, 3), side_x_);
        return escaping(sum, all, i4{0, 0, 0, -1});
    }
    [[nodiscard]] balance escaping(balance before, balance all, lanes::i4 out) const {
        return {lanes::choose(out, before.gain, all.gain),
                lanes::choose(out, before.loss + lanes::splat(escape_x_), all.loss)};
    }

    rows here_;
    const std::byte* extinction_ = nullptr;
    const std::byte* source_ = nullptr;
    border beyond_[4];
    float side_x_ = 1;
    float escape_x_ = 0;
    std::size_t last_ = 0; ///< where the last four cells begin
    float absorption_ = 0;
    bool from_zero_ = false;
};

template <>
struct program<kernels::scatter_relax> : plain_program<kernels::scatter_relax> {
    static void voxels(const kernels::scatter_relax& kernel, glm::ivec3 first, std::uint32_t count,
                       const grids& grids) {
        using namespace lanes;
        const int size = grids.size(1).x;
        const int end = first.x + static_cast<int>(count);
        if (size < 4 || first.x != 0 || end != size) {
            plain_program::voxels(kernel, first, count, grids);
            return;
        }
        const scatter_row row(kernel.equation, kernel.from_zero != 0, first.y, first.z, grids);
        std::byte* const to = grids.write_row(0, first.y, first.z);
        for (int x = 0; x < end; x += 4) {
            const auto at = static_cast<std::size_t>(std::min(x, end - 4)); // some of them again
            const scatter_row::balance sum = row.at(at);
            // shared::scatter_relaxed
            const f4 now = splat(1.0f - kernel.weight) * row.fluence(at) +
                           splat(kernel.weight) * (sum.gain / sum.loss);
            const f4 least = splat(kernel.least);
            const f4 kept = choose(now < least, least, now);
            std::memcpy(to + 4 * at, &kept, sizeof kept);
        }
    }
};

template <>
struct program<kernels::scatter_restrict> : plain_program<kernels::scatter_restrict> {
    static void voxels(const kernels::scatter_restrict& kernel, glm::ivec3 first,
                       std::uint32_t count, const grids& grids) {
        const glm::ivec3 size = grids.size(0);
        const glm::ivec3 child = 2 * first;
        const bool whole = kernel.axes == kernels::all_axes && size.x >= 4 &&
                           size.y > child.y + 1 && size.z > child.z + 1;
        if (!whole) {
            plain_program::voxels(kernel, first, count, grids);
            return;
        }
        const scatter_row rows[] = {
            {kernel.equation, false, child.y, child.z, grids},
            {kernel.equation, false, child.y + 1, child.z, grids},
            {kernel.equation, false, child.y, child.z + 1, grids},
            {kernel.equation, false, child.y + 1, child.z + 1, grids},
        };
        std::byte* const to = grids.write_row(0, first.y, first.z);
        const int end = first.x + static_cast<int>(count);
        for (int x = first.x; x < end;) {
            if (x + 2 <= end && 2 * x + 4 <= size.x) {
                float left[2] = {0, 0};
                for (const scatter_row& row : rows) {
                    const auto at = static_cast<std::size_t>(2 * x);
                    const scatter_row::balance sum = row.at(at);
                    const lanes::f4 lacks = sum.gain - sum.loss * row.fluence(at);
                    left[0] = left[0] + lacks[0] + lacks[1];
                    left[1] = left[1] + lacks[2] + lacks[3];
                }
                const float means[2] = {0.125f * left[0], 0.125f * left[1]};
                std::memcpy(to + 4 * static_cast<std::size_t>(x), means, sizeof means);
                x += 2;
            } else {
                kernel.voxel({x, first.y, first.z}, grids);
                ++x;
            }
        }
    }
};

template <>
struct program<kernels::scatter_prolong> : plain_program<kernels::scatter_prolong> {
    static void voxels(const kernels::scatter_prolong& kernel, glm::ivec3 first,
                       std::uint32_t count, const grids& grids) {
        using namespace lanes;
        if (kernel.axes != kernels::all_axes) {
            plain_program::voxels(kernel, first, count, grids);
            return;
        }
        const glm::ivec3 last = grids.size(1) - 1;
        const glm::ivec3 nearer = glm::min(first / 2, last);
        const glm::ivec3 farther =
            glm::clamp(nearer + 2 * (first - 2 * (first / 2)) - 1, glm::ivec3(0), last);
        const std::byte* const rows[] = {
            grids.read_row(1, nearer.y, nearer.z), grids.read_row(1, farther.y, nearer.z),
            grids.read_row(1, nearer.y, farther.z), grids.read_row(1, farther.y, farther.z)};
        const std::byte* const from = grids.read_row(0, first.y, first.z);
        std::byte* const to = grids.write_row(0, first.y, first.z);
        const int end = first.x + static_cast<int>(count);
        for (int x = first.x; x < end;) {
            if (x % 2 == 0 && x + 4 <= end && last.x >= 3) {
                const auto at = static_cast<std::size_t>(x);
                const auto row = [&](std::size_t i) {
                    const f4 v = around(rows[i], at / 2, static_cast<std::size_t>(last.x));
                    return splat(0.75f) * __builtin_shufflevector(v, v, 1, 1, 2, 2) +
                           splat(0.25f) * __builtin_shufflevector(v, v, 0, 2, 1, 3);
                };
                const f4 sum = splat(0.75f) * (splat(0.75f) * row(0) + splat(0.25f) * row(1)) +
                               splat(0.25f) * (splat(0.75f) * row(2) + splat(0.25f) * row(3));
                const f4 now = kernel.from_zero != 0 ? sum : load(from + 4 * at) + sum;
                std::memcpy(to + 4 * at, &now, sizeof now);
                x += 4;
            } else {
                kernel.voxel({x, first.y, first.z}, grids);
                ++x;
            }
        }
    }

  private:
    /// Cells x − 1 … x + 2 of a row, held at its ends.
    [[nodiscard]] static lanes::f4 around(const std::byte* row, std::size_t x, std::size_t last) {
        using namespace lanes;
        if (x == 0) {
            const f4 v = load(row);
            return __builtin_shufflevector(v, v, 0, 0, 1, 2);
        }
        if (x + 2 > last) {
            const f4 v = load(row + 4 * (x - 2));
            return __builtin_shufflevector(v, v, 1, 2, 3, 3);
        }
        return load(row + 4 * (x - 1));
    }
};

template <>
struct program<kernels::scatter_medium> : plain_program<kernels::scatter_medium> {
    static void voxels(const kernels::scatter_medium& kernel, glm::ivec3 first, std::uint32_t count,
                       const grids& grids) {
        using namespace lanes;
        const glm::ivec3 size = grids.size(0);
        const glm::ivec3 low = 2 * first;
        if (!grids.reads_floats(0) || low.y + 2 >= size.y || low.z + 1 >= size.z) {
            plain_program::voxels(kernel, first, count, grids);
            return;
        }
        // The rows of voxels below the cell, of its own two, and above it; twice.
        const std::byte* rows[2][4];
        for (int z = 0; z < 2; ++z) {
            for (int y = 0; y < 4; ++y) {
                rows[z][y] = grids.read_row(0, std::max(low.y + y - 1, 0), low.z + z);
            }
        }
        const int end = first.x + static_cast<int>(count);
        for (int x = first.x; x < end;) {
            if (x + 2 <= end && 2 * x + 4 <= size.x) {
                float depth[2] = {0, 0};
                float lost[2] = {0, 0};
                float beam[2] = {0, 0};
                for (const auto& row : rows) {
                    const std::size_t at = 8 * static_cast<std::size_t>(x);
                    const f4 top = splat(0.5f) * (taken(row[2] + at) + taken(row[3] + at));
                    const f4 bottom = splat(0.5f) * (taken(row[0] + at) + taken(row[1] + at));
                    const f4 lit = exp_minus(splat(kernel.kept) * top);
                    add_pairs(depth, positive(bottom - top));
                    add_pairs(lost, positive(lit - exp_minus(splat(kernel.kept) * bottom)));
                    add_pairs(beam, lit);
                }
                for (int i = 0; i < 2; ++i) {
                    const glm::ivec3 cell(x + i, first.y, first.z);
                    grids.store(0, cell, kernel.extinction * depth[i]);
                    grids.store(1, cell, kernel.scattered * lost[i]);
                    grids.store(2, cell, 0.25f * beam[i]);
                }
                x += 2;
            } else {
                kernel.voxel({x, first.y, first.z}, grids);
                ++x;
            }
        }
    }

  private:
    /// glm::max(v, 0).
    [[nodiscard]] static lanes::f4 positive(lanes::f4 v) {
        return lanes::choose(v < lanes::splat(0), lanes::splat(0), v);
    }
    [[nodiscard]] static lanes::f4 taken(const std::byte* from) {
        return positive(lanes::load(from));
    }
    static void add_pairs(float (&to)[2], lanes::f4 v) {
        to[0] = to[0] + v[0] + v[1];
        to[1] = to[1] + v[2] + v[3];
    }
    /// shared::exp_minus.
    [[nodiscard]] static lanes::f4 exp_minus(lanes::f4 x) {
        using namespace lanes;
        const f4 within = choose(splat(87.0f) < x, splat(87.0f), x);
        const f4 halvings = floor(within * splat(1.44269504f) + splat(0.5f));
        f4 r = halvings * splat(0.693145752f) - within;
        r = r + halvings * splat(1.42860677e-6f);
        const f4 one = splat(1.0f);
        f4 p = one + r * splat(1.0f / 7.0f);
        p = one + r * splat(1.0f / 6.0f) * p;
        p = one + r * splat(1.0f / 5.0f) * p;
        p = one + r * splat(1.0f / 4.0f) * p;
        p = one + r * splat(1.0f / 3.0f) * p;
        p = one + r * splat(1.0f / 2.0f) * p;
        p = one + r * p;
        const i4 exponent = 127 - __builtin_convertvector(halvings, i4);
        const f4 scaled = p * reinterpret_cast<f4>(exponent * 8388608);
        return choose(x < splat(87.0f), scaled, splat(0));
    }
};

} // namespace skybark::cpu

#endif
