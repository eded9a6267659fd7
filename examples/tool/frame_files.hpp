#pragma once
// frame_files: where the pictures of frames go: one .png, a numbered one each, or one .apng.

#include "frame_name.hpp"

#include <io/write_apng.hpp>

#include <optional>

namespace skybark::tool {

/// What becomes of the frames.
enum class frame_output {
    single,   ///< there is one, and the name is as it is
    numbered, ///< each has a file of its own, `name.of(frame)`
    together, ///< all are in the one file: .glb, .apng
};

/// That `out` is the name of a single file: a place for a number in it is a slip. `expected` ends
/// the sentence.
[[nodiscard]] result<void> check_single_name(const std::string& out, std::string_view expected);

/// How so many frames go to `out`; a name of numbered ones is read into `name`. `asked` begins the
/// sentence that says there are too many, such as "--frames is 2".
[[nodiscard]] result<frame_output> find_frame_output(const std::string& out, std::uint32_t frames,
                                                     const std::string& asked, frame_name& name);

/// Pictures of one size.
class frame_files {
  public:
    frame_files(std::string out, std::uint32_t width, std::uint32_t height, std::uint32_t frames,
                double frames_per_second)
        : out_(std::move(out)), width_(width), height_(height), frames_(frames),
          frames_per_second_(frames_per_second) {}

    /// Each has a file of its own: `name`.
    [[nodiscard]] result<void> write(const std::string& name,
                                     std::span<const std::uint8_t> rgba) const;
    /// The next frame of the one file that holds all.
    [[nodiscard]] result<void> add(std::span<const std::uint8_t> rgba);
    /// After all frames: gives that file its name, if it was begun.
    [[nodiscard]] result<void> commit();

  private:
    std::string out_;
    std::uint32_t width_;
    std::uint32_t height_;
    std::uint32_t frames_;
    double frames_per_second_;
    std::optional<io::apng_writer> animation_;
};

} // namespace skybark::tool
