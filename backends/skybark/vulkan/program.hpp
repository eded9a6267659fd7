#pragma once
// Where the Vulkan backend finds a kernel's SPIR-V.

#include <cstddef>
#include <cstdint>

namespace skybark::vulkan {

/// A program's SPIR-V, in the host's byte order: an array of words, or the literal that embed.py
/// makes, which compilers read much faster. The address tells programs apart.
class spirv_words {
  public:
    constexpr spirv_words() noexcept = default;
    template <std::size_t N>
    constexpr spirv_words(const std::uint32_t (&words)[N]) noexcept : words_(words), size_(N) {}
    /// Without the zero that ends a literal.
    template <std::size_t N>
    constexpr spirv_words(const char32_t (&words)[N]) noexcept : words_(words), size_(N - 1) {}

    [[nodiscard]] constexpr const void* data() const noexcept { return words_; }
    [[nodiscard]] constexpr std::size_t size_bytes() const noexcept {
        return size_ * sizeof(std::uint32_t);
    }

  private:
    const void* words_ = nullptr;
    std::size_t size_ = 0;
};

/// Specialised for each kernel, with a member for each skeleton that it goes with: `map_comp`,
/// `levels_comp`, `strip_counts_comp`, `strips_comp`, `rings_comp`, `voxels_comp`,
/// `accumulate_comp`, `draw_vert`, `draw_frag`, each of which spirv_words can be made from.
/// shaders/embed.py makes it.
template <class Kernel>
struct program;

} // namespace skybark::vulkan
