#pragma once
// Work in pieces, on threads.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace skybark::first_pass {

/// Calls `work(i)` for all i below `pieces`, in any order, on `threads` threads (0: all there are).
template <class Work>
void for_each_piece(std::size_t pieces, std::uint32_t threads, Work&& work) {
    std::atomic<std::size_t> next = 0;
    const auto run = [&] {
        for (std::size_t i = next++; i < pieces; i = next++) {
            work(i);
        }
    };
    const std::uint32_t count = threads != 0 ? threads : std::thread::hardware_concurrency();
    std::vector<std::thread> others;
    for (std::uint32_t i = 1; i < count && i < pieces; ++i) {
        others.emplace_back(run);
    }
    run();
    for (std::thread& other : others) {
        other.join();
    }
}

} // namespace skybark::first_pass
