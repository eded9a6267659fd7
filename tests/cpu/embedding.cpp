// A device in somebody else's program: the caller's memory, log, zones and jobs.

#include "support/every_pattern.hpp"
#include "support/hook_log.hpp"

#include <skybark/cpu/cpu.hpp>

#include <gtest/gtest.h>
#include <map>
#include <mutex>

namespace skybark {
namespace {

using support::every_patterns_name;
using support::hook_log;
using support::run_every_pattern;

/// A heap that knows what it gave, gives no zeros, and can be told to stop.
class counting_heap {
  public:
    [[nodiscard]] cpu::memory_hooks to_me() {
        return {this,
                [](void* user, std::size_t bytes, std::size_t alignment) {
                    return static_cast<counting_heap*>(user)->allocate(bytes, alignment);
                },
                [](void* user, void* memory, std::size_t bytes, std::size_t alignment) {
                    static_cast<counting_heap*>(user)->free(memory, bytes, alignment);
                }};
    }

    std::size_t bytes_now = 0;
    std::size_t calls = 0;
    std::size_t left = ~std::size_t{0}; ///< allocations until one fails

  private:
    void* allocate(std::size_t bytes, std::size_t alignment) {
        const std::lock_guard lock(mutex_);
        EXPECT_EQ(alignment, 64u);
        if (left-- == 0) {
            return nullptr;
        }
        ++calls;
        bytes_now += bytes;
        void* made = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
        std::memset(made, 0xcd, bytes);
        given_[made] = bytes;
        return made;
    }
    void free(void* memory, std::size_t bytes, std::size_t alignment) {
        const std::lock_guard lock(mutex_);
        EXPECT_EQ(alignment, 64u);
        const auto found = given_.find(memory);
        ASSERT_NE(found, given_.end()) << "freed, but not given";
        EXPECT_EQ(found->second, bytes);
        bytes_now -= bytes;
        given_.erase(found);
        std::free(memory);
    }

    std::mutex mutex_;
    std::map<void*, std::size_t> given_;
};

[[nodiscard]] cpu::device_options with(counting_heap* heap, hook_log* log) {
    cpu::device_options options;
    options.threads = 2;
    if (heap != nullptr) {
        options.memory = heap->to_me();
    }
    if (log != nullptr) {
        options.hooks = log->to_me();
    }
    return options;
}

TEST(cpu_embedding, all_memory_comes_from_the_caller_and_goes_back) {
    cpu::device plain;
    const std::vector<std::byte> expected = run_every_pattern(plain);
    counting_heap heap;
    {
        cpu::device device(with(&heap, nullptr));
        EXPECT_EQ(run_every_pattern(device), expected);
        EXPECT_GT(heap.bytes_now, 0u) << "what patterns keep is the caller's as well";
        const std::size_t calls = heap.calls;
        cpu::device moved(std::move(device));
        EXPECT_EQ(run_every_pattern(moved), expected);
        EXPECT_LT(heap.calls - calls, 40u) << "what is kept is used again";
    }
    EXPECT_EQ(heap.bytes_now, 0u);
}

TEST(cpu_embedding, a_buffer_of_the_callers_memory_is_zero_and_goes_back_at_once) {
    counting_heap heap;
    cpu::device device(with(&heap, nullptr));
    {
        const auto made = device.create_buffer(1000);
        ASSERT_TRUE(made);
        EXPECT_EQ(std::count(made->data(), made->data() + 1000, std::byte{0}), 1000);
        EXPECT_GE(heap.bytes_now, 1000u);
    }
    EXPECT_EQ(heap.bytes_now, 0u);
}

TEST(cpu_embedding, memory_that_runs_out_is_an_error_wherever_it_does) {
    std::size_t needed = 0; // by patterns, besides their buffers
    {
        counting_heap heap;
        cpu::device device(with(&heap, nullptr));
        const support::every_pattern<cpu::device> all(device);
        const std::size_t before = heap.calls;
        ASSERT_TRUE(run(device, [&](auto& r) { all.record(r); }));
        needed = heap.calls - before;
    }
    ASSERT_GT(needed, 5u);
    for (std::size_t some = 0; some < needed; ++some) {
        counting_heap heap;
        hook_log log;
        {
            cpu::device device(with(&heap, &log));
            const support::every_pattern<cpu::device> all(device);
            heap.left = some;
            const auto done = run(device, [&](auto& r) { all.record(r); });
            ASSERT_FALSE(done) << some;
            EXPECT_EQ(done.error().code, error_code::out_of_memory);
            heap.left = 0;
            EXPECT_FALSE(device.create_buffer(100));
            EXPECT_EQ(log.count(log_level::warning, "could not make a buffer of 100 bytes"), 1);
            EXPECT_TRUE(run(device, [&](auto& r) { all.record(r); })) << "it works again";
        }
        EXPECT_EQ(heap.bytes_now, 0u);
        EXPECT_EQ(log.open, 0);
    }
}

TEST(cpu_embedding, tells_what_it_makes_and_every_pattern) {
    hook_log log;
    {
        cpu::device device(with(nullptr, &log));
        EXPECT_EQ(log.count(log_level::info, "2 threads"), 1);
        (void)run_every_pattern(device);
        const auto made = log.entries.size();
        const support::every_pattern<cpu::device> again(device);
        const auto all_made = log.entries.size();
        EXPECT_GT(all_made, made);
        ASSERT_TRUE(run(device, [&](auto& r) { again.record(r); }));
        EXPECT_EQ(log.entries.size(), all_made) << "nothing is kept that was not before";
    }
    EXPECT_EQ(log.open, 0);
    EXPECT_GT(log.count(log_level::debug, "has made a volume of 480 bytes"), 0);
    EXPECT_GT(log.count(log_level::debug, "bytes to work in"), 0);
    auto expected = every_patterns_name();
    expected.insert({"submit", "download"});
    EXPECT_EQ(log.zones, expected);
}

} // namespace
} // namespace skybark
