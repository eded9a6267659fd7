#pragma once
// frame_name: the names of numbered files, from a pattern such as tree_%04d.png.

#include <skybark/core/result.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace skybark::tool {

/// A name with a place for the frame's number, counted from 0. %d is the number, %04d the number
/// with zeros before it up to four digits, and %% a per cent sign; nothing else begins with one.
class frame_name {
  public:
    /// Errors: another conversion than %d, %0Nd (N from 1 to 9) and %%; more than one of the
    /// former.
    [[nodiscard]] static result<frame_name> parse(std::string_view pattern);

    /// Whether there is a place for the number: without, all frames have the same name.
    [[nodiscard]] bool is_numbered() const noexcept { return numbered_; }
    [[nodiscard]] std::string of(std::uint32_t frame) const;

  private:
    std::string before_;
    std::string after_;
    std::size_t digits_ = 1; ///< at least
    bool numbered_ = false;
};

} // namespace skybark::tool
