#pragma once
// write_apng: pictures one after another as one animated PNG. Viewers that know no APNG show the
// first. Source: "Animated PNG Graphics", in PNG (Third Edition), W3C, sections 4.9 and 11.3.2.

#include <io/atomic_file.hpp>

#include <skybark/core/result.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace skybark::io {

/// How long a frame is shown: numerator / denominator seconds, as near to 1 / frames_per_second as
/// 16 bits each can say. Frames per second beyond 1/65535 … 65535 get the nearer end.
struct apng_delay {
    std::uint16_t numerator = 1;
    std::uint16_t denominator = 24;
};
[[nodiscard]] apng_delay delay_of(double frames_per_second);

/// Frames go to the file one by one; each but the first as the rectangle that differs from what is
/// shown, over it where that is smaller.
class apng_writer {
  public:
    /// A file of `frames` frames, shown again and again.
    /// Errors: a side is 0 or more than 16384; no frames, or more than 2³⁰; the file can't be
    /// written.
    [[nodiscard]] static result<apng_writer> create(const std::string& path, std::uint32_t width,
                                                    std::uint32_t height, std::uint32_t frames,
                                                    apng_delay delay);

    /// The next frame: width · height pixels of four bytes (red, green, blue, alpha; sRGB, not
    /// premultiplied), rows from the top.
    /// Errors: `pixels` has another size; more frames than were said; the file can't be written;
    /// not enough memory.
    [[nodiscard]] result<void> add(std::span<const std::uint8_t> pixels);

    /// Gives the file its name. Errors: fewer frames than were said; the file can't be written.
    [[nodiscard]] result<void> commit();

  private:
    apng_writer(atomic_file file, std::string path, std::uint32_t width, std::uint32_t height,
                std::uint32_t frames, apng_delay delay);

    [[nodiscard]] result<void> write_frame(std::span<const std::uint8_t> pixels);

    atomic_file file_;
    std::string path_;
    std::uint32_t width_;
    std::uint32_t height_;
    std::uint32_t frames_;
    apng_delay delay_;
    std::uint32_t added_ = 0;
    std::uint32_t sequence_ = 0;
    std::vector<std::uint8_t> shown_; ///< what a viewer has after the last frame
};

} // namespace skybark::io
