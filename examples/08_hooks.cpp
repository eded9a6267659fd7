// A program that wants to know: its heap gives the memory, its log reads what happens, its profiler
// gets the zones. With --verbose the log goes to stderr.

#include <skybark/cpu/cpu.hpp>
#include <skybark/skybark.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <vector>

namespace {

namespace trees = skybark::trees;
using backend = skybark::cpu::device;

/// The program's heap: counts what is out.
struct heap {
    std::mutex mutex; // buffers may be destroyed on any thread
    std::size_t now = 0;
    std::size_t most = 0;
    std::size_t calls = 0;

    [[nodiscard]] skybark::cpu::memory_hooks hooks() {
        return {this,
                [](void* user, std::size_t bytes, std::size_t alignment) {
                    return static_cast<heap*>(user)->allocate(bytes, alignment);
                },
                [](void* user, void* memory, std::size_t bytes, std::size_t) {
                    static_cast<heap*>(user)->free(memory, bytes);
                }};
    }

  private:
    void* allocate(std::size_t bytes, std::size_t alignment) {
        const std::lock_guard lock(mutex);
        ++calls;
        now += bytes;
        most = std::max(most, now);
        return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    }
    void free(void* memory, std::size_t bytes) {
        const std::lock_guard lock(mutex);
        now -= bytes;
        std::free(memory);
    }
};

/// The program's log and profiler: both are called on the thread that calls the device.
struct observer {
    using clock = std::chrono::steady_clock;
    struct sum {
        std::size_t count = 0;
        clock::duration time{};
    };
    struct open_zone {
        const char* name;
        clock::time_point begin;
    };

    bool verbose = false;
    std::size_t lines = 0;
    std::map<std::string_view, sum> zones; // names outlive the program
    std::vector<open_zone> open;

    [[nodiscard]] skybark::hooks hooks() {
        skybark::hooks to;
        to.user = this;
        to.log = [](void* user, skybark::log_level, std::string_view text) {
            auto& me = *static_cast<observer*>(user);
            ++me.lines;
            if (me.verbose) {
                std::fprintf(stderr, "%.*s\n", static_cast<int>(text.size()), text.data());
            }
        };
        to.begin_zone = [](void* user, const char* name) {
            static_cast<observer*>(user)->open.push_back({name, clock::now()});
        };
        to.end_zone = [](void* user) {
            auto& me = *static_cast<observer*>(user);
            sum& s = me.zones[me.open.back().name];
            ++s.count;
            s.time += clock::now() - me.open.back().begin;
            me.open.pop_back();
        };
        return to;
    }
};

/// A tree in the wind: `frames` of them.
skybark::result<void> sway(backend& device, int frames) {
    const auto skeleton = trees::grow(trees::quaking_aspen(), 1).and_then([](const auto& segments) {
        return trees::build_skeleton(segments);
    });
    if (!skeleton) {
        return skybark::failure(skeleton.error());
    }
    trees::leaf_options few;
    few.most = 2000;
    auto tree = trees::swaying_tree<backend>::create(device, *skeleton,
                                                     trees::place_leaves(*skeleton, few), {}, {});
    auto air = trees::wind_field<backend>::create(device, trees::segment_middles(*skeleton),
                                                  trees::kaimal_gusts{});
    if (!tree || !air) {
        return skybark::failure(tree ? air.error() : tree.error());
    }
    for (int frame = 0; frame < frames; ++frame) {
        auto done = skybark::run(device, [&](auto& recorder) {
            tree->advance(recorder, *air, frame / 30.0, 1 / 30.0f);
            tree->mesh(recorder);
        });
        if (!done) {
            return done;
        }
    }
    return {};
}

} // namespace

int main(int count, char** arguments) {
    heap memory;
    observer seen;
    seen.verbose = count > 1 && std::strcmp(arguments[1], "--verbose") == 0;
    {
        skybark::cpu::device_options options;
        options.memory = memory.hooks();
        options.hooks =
            seen.hooks(); // opengl::description and vulkan::device_description have it too
        backend device(options);
        if (auto done = sway(device, 10); !done) {
            std::fprintf(stderr, "%s\n", done.error().message.c_str());
            return 1;
        }
    }
    std::printf("%-28s %6s %10s\n", "zone", "count", "ms");
    for (const auto& [name, sum] : seen.zones) {
        std::printf("%-28s %6zu %10.3f\n", std::string(name).c_str(), sum.count,
                    std::chrono::duration<double, std::milli>(sum.time).count());
    }
    std::printf(
        "%zu lines of log; %zu allocations, at most %zu bytes at once, %zu not given back\n",
        seen.lines, memory.calls, memory.most, memory.now);
    const bool told = seen.zones.contains("submit") && seen.lines > 0 && memory.most > 0;
    return told && memory.now == 0 && seen.open.empty() ? 0 : 1;
}
