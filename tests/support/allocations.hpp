#pragma once
// Counts a program's allocations through new: containers, std::function. The operators are in
// tests/support/allocations.cpp.

#include <atomic>
#include <cstdint>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#    define SKYBARK_TEST_COUNTS_ALLOCATIONS 0
#elif defined(__has_feature)
#    if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#        define SKYBARK_TEST_COUNTS_ALLOCATIONS 0 // the sanitizer's own operators
#    endif
#endif
#if !defined(SKYBARK_TEST_COUNTS_ALLOCATIONS)
#    define SKYBARK_TEST_COUNTS_ALLOCATIONS 1
#endif

namespace skybark::support {
inline std::atomic<std::uint64_t> allocations{0};
}
