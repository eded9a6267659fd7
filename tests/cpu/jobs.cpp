// Who runs the tasks must not show in the results.

#include "support/cpu_work.hpp"

#include <gtest/gtest.h>

using namespace skybark;

namespace {

std::vector<support::bytes> done_on(cpu::device_options options) {
    cpu::device device(std::move(options));
    support::cpu_work work(device);
    work.run();
    return work.output();
}

std::vector<support::bytes> done_by(cpu::parallel_for jobs) {
    cpu::device_options options;
    options.jobs = std::move(jobs);
    return done_on(std::move(options));
}

const std::vector<support::bytes>& done_by_one_thread() {
    static const auto output = done_by([](std::uint32_t count, const auto& task) {
        for (std::uint32_t i = 0; i < count; ++i) {
            task(i);
        }
    });
    return output;
}

void expect_equal(const std::vector<support::bytes>& actual, const char* what) {
    const auto& expected = done_by_one_thread();
    ASSERT_EQ(actual.size(), expected.size());
    for (std::size_t i = 0; i < actual.size(); ++i) {
        EXPECT_TRUE(actual[i] == expected[i]) << "output " << i << ", " << what;
    }
}

} // namespace

TEST(jobs, any_number_of_threads_gives_the_same_bits) {
    for (const std::uint32_t threads : {1u, 2u, 3u, 8u}) {
        cpu::device_options options;
        options.threads = threads;
        expect_equal(done_on(options), std::to_string(threads).c_str());
    }
}

TEST(jobs, callers_jobs_may_run_backwards) {
    std::uint32_t batches = 0;
    const auto output = done_by([&](std::uint32_t count, const auto& task) {
        ++batches;
        for (std::uint32_t i = count; i-- > 0;) {
            task(i);
        }
    });
    EXPECT_GT(batches, 5u); // the patterns do come here
    expect_equal(output, "backwards");
}

TEST(jobs, callers_jobs_may_run_elsewhere) {
    const auto output = done_by([](std::uint32_t count, const auto& task) {
        std::vector<std::thread> threads;
        for (std::uint32_t first = 0; first < 3; ++first) {
            threads.emplace_back([&, first] {
                for (std::uint32_t i = first; i < count; i += 3) {
                    task(i);
                }
            });
        }
        for (std::thread& thread : threads) {
            thread.join();
        }
    });
    expect_equal(output, "three threads of the caller's");
}

TEST(jobs, device_names_who_works) {
    cpu::device_options options;
    options.threads = 3;
    EXPECT_EQ(cpu::device(options).device_name(), "3 threads");
    options.jobs = [](std::uint32_t, const auto&) {};
    EXPECT_EQ(cpu::device(options).device_name(), "the caller's jobs");
}

TEST(thread_pool, each_task_once_and_all_done_on_return) {
    cpu::thread_pool pool(4);
    for (std::uint32_t round = 0; round < 3000; ++round) {
        const std::uint32_t count = round % 40;
        // Not atomic: two runs of a task, or one after the return, would be a race.
        std::vector<std::uint32_t> runs(count, 0);
        pool(count, [&](std::uint32_t i) { ++runs[i]; });
        for (const std::uint32_t n : runs) {
            ASSERT_EQ(n, 1u);
        }
    }
}

TEST(thread_pool, callers_on_many_threads_take_turns) {
    cpu::thread_pool pool(3);
    std::vector<std::thread> callers;
    std::atomic<std::uint64_t> sum{0};
    for (std::uint32_t c = 0; c < 4; ++c) {
        callers.emplace_back([&] {
            for (int round = 0; round < 300; ++round) {
                std::uint64_t mine[16] = {};
                pool(16, [&](std::uint32_t i) { mine[i] = i; });
                for (const std::uint64_t n : mine) {
                    sum += n;
                }
            }
        });
    }
    for (std::thread& caller : callers) {
        caller.join();
    }
    EXPECT_EQ(sum, 4u * 300u * 120u);
}

TEST(thread_pool, comes_and_goes) {
    for (std::uint32_t i = 0; i < 200; ++i) {
        cpu::thread_pool pool(1 + i % 5);
        EXPECT_EQ(pool.threads(), 1 + i % 5);
        if (i % 2 == 0) {
            std::atomic<std::uint32_t> runs{0};
            pool(7, [&](std::uint32_t) { ++runs; });
            EXPECT_EQ(runs, 7u);
        }
    }
}
