#pragma once
// result<T>: a value, or what went wrong in a full sentence.
//
// Only what no caller can foresee is a result: memory, a lost device, a shader that the driver
// rejects, a malformed file. Misuse is an assertion, checked in full by `validated<B>`.

#include <string>
#include <string_view>
#include <utility>
#include <version>

#if defined(__cpp_lib_expected)
#    include <expected>
#else
#    include <tl/expected.hpp>
#endif

namespace skybark {

/// What kind of thing went wrong, for a program to act on.
enum class error_code {
    bad_input,       ///< data from outside that is malformed: a file, a description
    out_of_memory,   ///< host or device memory, or a size that the device cannot hold
    unavailable,     ///< the backend or a feature of it does not exist on this machine
    shader_rejected, ///< the driver would not compile or link a device program
    device_lost,     ///< the device is gone; every later call says so at once
};

/// An error code and a sentence with the values that explain it, for a person to read.
struct error {
    error_code code = error_code::bad_input;
    std::string message;
};

#if defined(__cpp_lib_expected)
template <class T>
using result = std::expected<T, error>;
using failure = std::unexpected<error>;
#else
template <class T>
using result = tl::expected<T, error>;
using failure = tl::unexpected<error>;
#endif

/// Shorthand for returning an error from a function that returns a `result`.
[[nodiscard]] inline failure fail(error_code code, std::string message) {
    return failure(error{code, std::move(message)});
}

[[nodiscard]] constexpr std::string_view to_string(error_code code) noexcept {
    switch (code) {
    case error_code::bad_input:
        return "bad input";
    case error_code::out_of_memory:
        return "out of memory";
    case error_code::unavailable:
        return "unavailable";
    case error_code::shader_rejected:
        return "shader rejected";
    case error_code::device_lost:
        return "device lost";
    }
    return "unknown";
}

} // namespace skybark
