#pragma once
// Who does the work on the CPU backend: our own few threads, or the caller's job system.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace skybark::cpu {

/// Runs `task(0) … task(count − 1)`, each once, on whatever threads it likes, and returns when all
/// are done. It must not let tasks run after that. Tasks do not depend on each other.
using parallel_for =
    std::function<void(std::uint32_t count, const std::function<void(std::uint32_t)>& task)>;

/// Threads that wait for work: one less than `threads`, because the caller's thread works as well.
class thread_pool {
  public:
    explicit thread_pool(std::uint32_t threads) {
        for (std::uint32_t i = 1; i < threads; ++i) {
            workers_.emplace_back([this] { work_until_stopped(); });
        }
    }
    thread_pool(const thread_pool&) = delete;
    thread_pool& operator=(const thread_pool&) = delete;
    ~thread_pool() {
        {
            const std::lock_guard lock(mutex_);
            stopping_ = true;
        }
        wake_.notify_all();
        for (std::thread& worker : workers_) {
            worker.join();
        }
    }

    [[nodiscard]] std::uint32_t threads() const {
        return static_cast<std::uint32_t>(workers_.size()) + 1;
    }

    void operator()(std::uint32_t count, const std::function<void(std::uint32_t)>& task) {
        if (workers_.empty() || count < 2) {
            for (std::uint32_t i = 0; i < count; ++i) {
                task(i);
            }
            return;
        }
        // One batch at a time; a second caller waits here for the first.
        const std::lock_guard one_caller(callers_);
        {
            const std::lock_guard lock(mutex_);
            task_ = &task;
            count_ = count;
            next_ = 0;
            busy_ = static_cast<std::uint32_t>(workers_.size());
            ++batch_;
        }
        wake_.notify_all();
        take_tasks(task, count);
        std::unique_lock lock(mutex_);
        done_.wait(lock, [this] { return busy_ == 0; });
        task_ = nullptr;
    }

  private:
    void take_tasks(const std::function<void(std::uint32_t)>& task, std::uint32_t count) {
        for (std::uint32_t i = next_++; i < count; i = next_++) {
            task(i);
        }
    }

    void work_until_stopped() {
        std::uint64_t seen = 0;
        std::unique_lock lock(mutex_);
        while (true) {
            wake_.wait(lock, [&] { return stopping_ || batch_ != seen; });
            if (stopping_) {
                return;
            }
            seen = batch_;
            const auto* task = task_;
            const std::uint32_t count = count_;
            lock.unlock();
            take_tasks(*task, count);
            lock.lock();
            if (--busy_ == 0) {
                done_.notify_one();
            }
        }
    }

    std::vector<std::thread> workers_;
    std::mutex callers_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::condition_variable done_;
    const std::function<void(std::uint32_t)>* task_ = nullptr;
    std::uint32_t count_ = 0;
    std::atomic<std::uint32_t> next_{0};
    std::uint32_t busy_ = 0;
    std::uint64_t batch_ = 0;
    bool stopping_ = false;
};

} // namespace skybark::cpu
