#pragma once
// Pictures of what is shown, as files.

#include "screen.hpp"

#include <skybark/core/result.hpp>

#include <string>

namespace skybark::viewer {

/// The first of skybark_0001.png, skybark_0002.png, … that is not in `folder`. Errors: all 9999
/// are.
[[nodiscard]] result<std::string> next_free_name(const std::string& folder);

/// Writes it, without what transparency the pixels may have.
[[nodiscard]] result<void> save(const std::string& path, shown picture);

} // namespace skybark::viewer
