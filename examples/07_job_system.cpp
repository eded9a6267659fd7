// A program that has a job system: the CPU device runs on its threads and starts none of its own.

#include <skybark/cpu/cpu.hpp>
#include <skybark/skybark.hpp>

#include <condition_variable>
#include <cstdio>
#include <deque>
#include <functional>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace {

namespace trees = skybark::trees;
using backend = skybark::cpu::device;

/// The program's job system: a queue of jobs, and workers that take them from it.
class job_system {
  public:
    explicit job_system(unsigned workers) {
        for (unsigned i = 0; i < workers; ++i) {
            workers_.emplace_back([this] { work(); });
        }
    }
    job_system(const job_system&) = delete;
    job_system& operator=(const job_system&) = delete;
    ~job_system() {
        {
            const std::lock_guard lock(mutex_);
            stopping_ = true;
        }
        changed_.notify_all();
        for (std::thread& worker : workers_) {
            worker.join();
        }
    }

    /// Runs task(0) … task(count − 1), each once, and returns when all are done. Who waits helps.
    void parallel_for(std::uint32_t count, const std::function<void(std::uint32_t)>& task) {
        std::uint32_t left = count;
        std::unique_lock lock(mutex_);
        for (std::uint32_t i = 0; i < count; ++i) {
            jobs_.push_back({&task, i, &left});
        }
        changed_.notify_all();
        while (left != 0) {
            if (!run_one(lock)) {
                changed_.wait(lock);
            }
        }
    }

    [[nodiscard]] std::size_t jobs_done() const { return done_; }
    [[nodiscard]] std::size_t threads_seen() const { return seen_.size(); }

  private:
    struct job {
        const std::function<void(std::uint32_t)>* task;
        std::uint32_t number;
        std::uint32_t* left; ///< of its parallel_for
    };

    void work() {
        std::unique_lock lock(mutex_);
        while (!stopping_) {
            if (!run_one(lock)) {
                changed_.wait(lock);
            }
        }
    }

    /// Runs the oldest job, outside the lock. False where there is none.
    bool run_one(std::unique_lock<std::mutex>& lock) {
        if (jobs_.empty()) {
            return false;
        }
        const job next = jobs_.front();
        jobs_.pop_front();
        seen_.insert(std::this_thread::get_id());
        lock.unlock();
        (*next.task)(next.number);
        lock.lock();
        ++done_;
        if (--*next.left == 0) {
            changed_.notify_all();
        }
        return true;
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<job> jobs_;
    std::vector<std::thread> workers_;
    std::set<std::thread::id> seen_;
    std::size_t done_ = 0;
    bool stopping_ = false;
};

/// A tree's branches, as bytes.
std::vector<std::byte> branches(backend& device, const trees::skeleton& skeleton) {
    std::vector<std::byte> all;
    const auto mesh = trees::branch_mesh<backend>::create(device, skeleton, {});
    if (!mesh || !skybark::run(device, [&](auto& recorder) { mesh->record(recorder); })) {
        return all;
    }
    for (const auto& part : mesh->parts()) {
        const std::size_t before = all.size();
        all.resize(before + part.vertices.size_bytes());
        if (!device.download(part.vertices, 0, std::span(all).subspan(before))) {
            return {};
        }
    }
    return all;
}

} // namespace

int main() {
    const auto skeleton = trees::grow(trees::quaking_aspen(), 1).and_then([](const auto& segments) {
        return trees::build_skeleton(segments);
    });
    if (!skeleton) {
        std::fprintf(stderr, "%s\n", skeleton.error().message.c_str());
        return 1;
    }

    job_system jobs(3);
    skybark::cpu::device_options options;
    options.jobs = [&jobs](std::uint32_t count, const std::function<void(std::uint32_t)>& task) {
        jobs.parallel_for(count, task);
    };
    backend device(options); // starts no threads
    const std::vector<std::byte> ours = branches(device, *skeleton);

    // The bits don't depend on who did the work.
    skybark::cpu::device_options alone;
    alone.threads = 1;
    backend one_thread(alone);
    const std::vector<std::byte> expected = branches(one_thread, *skeleton);

    const bool same = !ours.empty() && ours == expected;
    std::printf("%zu bytes of vertices by %zu jobs on %zu threads (%s): %s as by one thread\n",
                ours.size(), jobs.jobs_done(), jobs.threads_seen(), device.device_name().c_str(),
                same ? "the same" : "not the same");
    return same && jobs.jobs_done() > 0 ? 0 : 1;
}
