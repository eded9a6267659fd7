#pragma once
// child_process: work that may bring its process down, in one of its own.

#include <skybark/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace skybark::io {

/// Where the child's results go.
class byte_sink {
  public:
    explicit byte_sink(int descriptor) : descriptor_(descriptor) {}

    /// What the parent reads. Ends the child where the parent has gone.
    void write(std::span<const std::byte> bytes);
    /// A sentence's end, in place of more bytes: "has no grid; …". Nothing is sent after it.
    void complain(std::string_view text);

  private:
    void send(unsigned char kind, std::span<const std::byte> bytes);

    int descriptor_;
    bool complained_ = false;
};

/// A child of this process and what it sends.
class child_process {
  public:
    /// Forks, and runs `work` in the child, which says nothing on stderr, leaves no core and ends
    /// without the parent's clean-up. Call it before other threads hold locks that the work needs.
    /// Errors: there is no room for another process.
    [[nodiscard]] static result<child_process> start(const std::function<void(byte_sink&)>& work);

    child_process(child_process&& other) noexcept;
    child_process& operator=(child_process&& other) noexcept;
    /// Ends the child, if it goes on.
    ~child_process();

    /// Fills `bytes` from what the child sends. False: it sent less, and `complaint` says why.
    [[nodiscard]] bool read(std::span<std::byte> bytes);
    /// Completes a sentence that begins with the file.
    [[nodiscard]] const std::string& complaint() const { return complaint_; }

  private:
    child_process() = default;
    [[nodiscard]] bool fill(std::span<std::byte> bytes);
    [[nodiscard]] bool next_message();
    void wait_for_end();

    int descriptor_ = -1;
    int process_ = -1;
    std::size_t left_ = 0; ///< bytes of the message that is being read
    std::string complaint_;
};

/// As long as it lives, the process gets no more than `bytes` of memory beyond what it has: asking
/// for it fails at once, and not when all other programs have lost theirs. For a child.
class memory_limit {
  public:
    explicit memory_limit(std::uint64_t bytes);
    memory_limit(const memory_limit&) = delete;
    memory_limit& operator=(const memory_limit&) = delete;
    ~memory_limit();

  private:
    std::uint64_t before_ = 0;
};

} // namespace skybark::io
