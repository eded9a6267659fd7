#pragma once
// The floor: how long this machine takes to write so many bytes, and do nothing else.

#include <skybark/cpu/cpu.hpp>

#include <algorithm>
#include <chrono>
#include <vector>

namespace skybark::benchmarks {

/// Writes `bytes` (a multiple of 64) past the cache, on all threads of the device.
inline void write_floor(cpu::device& device, const cpu::buffer& to, std::uint64_t bytes) {
    device.for_pieces(bytes / 64, 1024, [&](std::uint64_t first, std::uint64_t count) {
        struct line {
            glm::vec4 words[4];
        };
        std::byte* place = to.data() + first * sizeof(line);
        const line value{{glm::vec4(1), glm::vec4(2), glm::vec4(3), glm::vec4(4)}};
        for (std::uint64_t i = 0; i < count; ++i) {
            cpu::stream_vertex(place + i * sizeof(line), value);
        }
        cpu::finish_streaming();
    });
}

/// Seconds to write `bytes`, the median of nine.
inline double floor_seconds(cpu::device& device, std::uint64_t bytes) {
    auto buffer = device.create_buffer(bytes);
    if (!buffer) {
        return 0;
    }
    std::vector<double> seconds;
    for (int i = 0; i < 10; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        write_floor(device, *buffer, bytes / 64 * 64);
        seconds.push_back(
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    seconds.erase(seconds.begin()); // the first touches the pages
    std::nth_element(seconds.begin(), seconds.begin() + 4, seconds.end());
    return seconds[4];
}

} // namespace skybark::benchmarks
