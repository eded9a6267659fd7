#pragma once
// What a result<T> holds, in a test that can't go on without.

#include <skybark/core/result.hpp>

#include <stdexcept>
#include <utility>

namespace skybark::support {

/// The value, or an exception with the error's sentence, which fails the test.
template <class T>
[[nodiscard]] T value_of(result<T> made) {
    if (!made) {
        throw std::runtime_error(made.error().message);
    }
    return *std::move(made);
}
inline void expect_done(const result<void>& done) {
    if (!done) {
        throw std::runtime_error(done.error().message);
    }
}

} // namespace skybark::support
