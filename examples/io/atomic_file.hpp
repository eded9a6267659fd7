#pragma once
// atomic_file: a file that is there whole or not at all.

#include <skybark/core/result.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace skybark::io {

/// Bytes go to a temporary file in the folder of `path`; `commit` renames it. Whatever ends before
/// that leaves the old file, if there was one, as it was.
///
/// A link is followed, so that what it points to is replaced. What isn't a plain file (a pipe,
/// /dev/stdout) is written to directly, since a rename would replace the device by a file.
class atomic_file {
  public:
    /// Errors: the folder isn't there or can't be written to; `path` is a directory, or its name is
    /// longer than the file system takes.
    [[nodiscard]] static result<atomic_file> create(const std::string& path);

    atomic_file(atomic_file&& other) noexcept;
    atomic_file& operator=(atomic_file&& other) noexcept;
    /// Removes the temporary file, unless committed.
    ~atomic_file();

    [[nodiscard]] result<void> write(std::string_view bytes);
    [[nodiscard]] result<void> write(std::span<const std::byte> bytes);
    /// Brings the bytes to the disk. What is left for `commit` then hardly ever fails: for several
    /// files that belong together. Nothing can be written any more.
    [[nodiscard]] result<void> finish();
    /// Brings the bytes to the disk, unless that is done, and gives the file its name.
    [[nodiscard]] result<void> commit();

  private:
    atomic_file() = default;
    void abandon() noexcept;
    [[nodiscard]] failure failed(std::string_view doing) const;

    std::string path_;      ///< as the caller named it
    std::string target_;    ///< what is replaced; empty where bytes go there directly
    std::string temporary_; ///< empty: nothing to remove
    int descriptor_ = -1;
    int slot_ = -1; ///< where the signal handler finds the temporary name
};

/// All of a file at once.
[[nodiscard]] result<void> write_file(const std::string& path, std::string_view bytes);

/// Whether a file of that name could be created, as far as can be said without creating it: to be
/// asked before hours of work. Errors: as `atomic_file::create`.
[[nodiscard]] result<void> check_writable(const std::string& path);

/// Removes the temporary files that are being written, if any. For a signal handler: it calls
/// nothing that such a one mustn't.
void remove_unfinished() noexcept;

} // namespace skybark::io
