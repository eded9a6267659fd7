#pragma once
// Running sums of words, and sorting by them. What is needed besides is kept by the context, and
// grows where it must.

#include <skybark/core/when_used.hpp>
#include <skybark/opengl/patterns.hpp>
#include <skybark/opengl/programs/own_scan.hpp>
#include <skybark/opengl/programs/own_scan_add.hpp>
#include <skybark/opengl/programs/own_sort_count.hpp>
#include <skybark/opengl/programs/own_sort_scatter.hpp>

namespace skybark::opengl::detail {

/// Words that a group sums.
inline constexpr std::uint64_t scan_block = 4096;
/// 4096⁴ words are more than a buffer has.
inline constexpr std::size_t max_scan_levels = 4;

inline constexpr std::uint32_t storage_8 = 8;
inline constexpr std::uint32_t storage_9 = 9;
inline constexpr std::uint32_t storage_10 = 10;
inline constexpr std::uint32_t scan_mask =
    mask_of(storage_8) | mask_of(storage_9) | mask_of(storage_10);

[[nodiscard]] inline std::uint64_t aligned(const context& c, std::uint64_t bytes) {
    return (bytes + c.limits.view_alignment - 1) / c.limits.view_alignment *
           c.limits.view_alignment;
}
[[nodiscard]] inline bound_range part_of(const scratch_buffer& buffer, std::uint64_t offset,
                                         std::uint64_t bytes) {
    return {buffer.name, static_cast<std::ptrdiff_t>(offset), static_cast<std::ptrdiff_t>(bytes)};
}
[[nodiscard]] inline std::uint64_t words_of(const bound_range& range) {
    return static_cast<std::uint64_t>(range.size) / 4;
}

/// One of the two programs of a scan: `words` in blocks, `sums` one for each of them.
template <class = when_used>
void dispatch_scan(context& c, gl::handle program, const bound_range& words,
                   const bound_range& sums, std::uint64_t words_a_group) {
    const std::uint64_t count = words_of(words);
    bind_parameters(c, {0, static_cast<std::uint32_t>(count), 0, 0}, {});
    bind(c, gl::shader_storage_buffer, storage_8, words);
    bind(c, gl::shader_storage_buffer, storage_9, words);
    bind(c, gl::shader_storage_buffer, storage_10, sums);
    const std::uint64_t groups =
        std::max<std::uint64_t>((count + words_a_group - 1) / words_a_group, 1);
    dispatch(c, program, static_cast<std::uint32_t>(groups));
}

/// A scan without saved state: changes the program, the uniform buffer and storage buffers 8 to 10.
template <class = when_used>
[[nodiscard]] result<void> scan_blocks(context& c, const bound_range& words,
                                       const bound_range& total) {
    const shader_stage scan_stages[] = {{gl::compute_shader, scan_comp}};
    const shader_stage add_stages[] = {{gl::compute_shader, scan_add_comp}};
    const auto scan = c.find_program(scan_stages);
    const auto add = c.find_program(add_stages);
    if (!scan || !add) {
        return failure(scan ? add.error() : scan.error());
    }
    // Each level is the sums of the blocks of the one below; the top one has a single block.
    std::array<bound_range, max_scan_levels> levels{words};
    std::size_t top = 0;
    std::uint64_t bytes = 0;
    std::array<std::uint64_t, max_scan_levels> offsets{};
    std::array<std::uint64_t, max_scan_levels> counts{words_of(words)};
    while (counts[top] > scan_block) {
        counts[top + 1] = (counts[top] + scan_block - 1) / scan_block;
        offsets[top + 1] = bytes;
        bytes = aligned(c, bytes + counts[top + 1] * 4);
        ++top;
    }
    if (auto done = c.grow(c.objects.scan_sums, bytes); !done) {
        return done;
    }
    for (std::size_t i = 1; i <= top; ++i) {
        levels[i] = part_of(c.objects.scan_sums, offsets[i], counts[i] * 4);
    }
    for (std::size_t i = 0; i <= top; ++i) {
        dispatch_scan(c, *scan, levels[i], i == top ? total : levels[i + 1], scan_block);
    }
    for (std::size_t i = top; i-- > 0;) {
        dispatch_scan(c, *add, levels[i], levels[i + 1], 256);
    }
    return {};
}

template <class = when_used>
[[nodiscard]] result<void> scan_words(context& c, const bound_range& words,
                                      const bound_range& total) {
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, scan_mask);
    return scan_blocks(c, words, total);
}

// ---- sort ---------------------------------------------------------------------------------------

inline constexpr std::uint32_t sort_block = 1024; ///< pairs that a group sorts
inline constexpr std::uint32_t sort_digits = 16;
inline constexpr std::uint32_t word_bits = 32;
inline constexpr std::uint32_t digit_bits = 4;

struct key_values {
    bound_range keys;
    bound_range values;
};

/// By four bits of the keys, from one pair of buffers to another.
template <class = when_used>
[[nodiscard]] result<void> sort_by_digit(context& c, gl::handle count_program,
                                         gl::handle scatter_program, const key_values& from,
                                         const key_values& into, const element_range& pairs,
                                         std::uint32_t shift) {
    const std::uint32_t blocks = (pairs.count - 1) / sort_block + 1;
    const std::uint64_t bytes = std::uint64_t{sort_digits} * blocks * 4;
    const bound_range counts = part_of(c.objects.sort_counts, 0, bytes);
    const bound_range total = part_of(c.objects.sort_counts, aligned(c, bytes), 16);
    const std::array<std::uint32_t, 4> header{shift, pairs.count, blocks,
                                              pairs.length.buffer != 0 ? 1u : 0u};
    bind_parameters(c, header, {});
    bind(c, gl::shader_storage_buffer, storage_8, counts);
    bind(c, gl::shader_storage_buffer, storage_9, from.keys);
    bind(c, gl::shader_storage_buffer, storage_10, pairs.length);
    dispatch(c, count_program, blocks);
    if (auto done = scan_blocks(c, counts, total); !done) {
        return done;
    }
    bind_parameters(c, header, {});
    bind(c, gl::shader_storage_buffer, 0, into.keys);
    bind(c, gl::shader_storage_buffer, 1, into.values);
    bind(c, gl::shader_storage_buffer, 2, from.keys);
    bind(c, gl::shader_storage_buffer, 3, from.values);
    bind(c, gl::shader_storage_buffer, storage_9, counts);
    bind(c, gl::shader_storage_buffer, storage_10, pairs.length);
    dispatch(c, scatter_program, blocks);
    return {};
}

/// `pairs.count` pairs, or as many as the device knows, at most so many; keys are below 2^key_bits.
template <class = when_used>
[[nodiscard]] result<void> sort_pairs(context& c, const bound_range& keys,
                                      const bound_range& values, const element_range& pairs,
                                      std::uint32_t key_bits) {
    const shader_stage count_stages[] = {{gl::compute_shader, sort_count_comp}};
    const shader_stage scatter_stages[] = {{gl::compute_shader, sort_scatter_comp}};
    const auto count = c.find_program(count_stages);
    const auto scatter = c.find_program(scatter_stages);
    if (!count || !scatter) {
        return failure(count ? scatter.error() : count.error());
    }
    if (pairs.count == 0) {
        return {};
    }
    const std::uint64_t bytes = std::uint64_t{pairs.count} * 4;
    const std::uint64_t blocks = (pairs.count - 1) / sort_block + 1;
    if (auto done = c.grow(c.objects.sort_pairs, aligned(c, bytes) + bytes); !done) {
        return done;
    }
    if (auto done = c.grow(c.objects.sort_counts, aligned(c, blocks * sort_digits * 4) + 16);
        !done) {
        return done;
    }
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, scan_mask | 0xfu);
    key_values here{{keys.buffer, keys.offset, static_cast<std::ptrdiff_t>(bytes)},
                    {values.buffer, values.offset, static_cast<std::ptrdiff_t>(bytes)}};
    key_values there{part_of(c.objects.sort_pairs, 0, bytes),
                     part_of(c.objects.sort_pairs, aligned(c, bytes), bytes)};
    // An even number of passes: what is sorted ends where it began.
    const std::uint32_t bits = std::min(key_bits, word_bits);
    const std::uint32_t passes = (bits + 2 * digit_bits - 1) / (2 * digit_bits) * 2;
    for (std::uint32_t shift = 0; shift < passes * digit_bits; shift += digit_bits) {
        if (auto done = sort_by_digit(c, *count, *scatter, here, there, pairs, shift); !done) {
            return done;
        }
        std::swap(here, there);
    }
    return {};
}

} // namespace skybark::opengl::detail
