#include <io/vdb/child_process.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace skybark::io {

namespace {

constexpr unsigned char kind_bytes = 1;
constexpr unsigned char kind_complaint = 2;
constexpr std::size_t longest_complaint = 4096;

/// Before each message: its kind and its length.
struct message_header {
    std::uint64_t kind = 0;
    std::uint64_t length = 0;
};

void be_quiet() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) {
        std::signal(signal, SIG_DFL); // the parent's handlers are about the parent's files
    }
    const rlimit none{0, 0};
    (void)::setrlimit(RLIMIT_CORE, &none);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere >= 0) {
        (void)::dup2(nowhere, STDERR_FILENO);
        (void)::dup2(nowhere, STDOUT_FILENO);
    }
}

} // namespace

void byte_sink::send(unsigned char kind, std::span<const std::byte> bytes) {
    const message_header header{kind, bytes.size()};
    for (std::span<const std::byte> rest : {std::as_bytes(std::span(&header, 1)), bytes}) {
        while (!rest.empty()) {
            const ::ssize_t written = ::write(descriptor_, rest.data(), rest.size());
            if (written >= 0) {
                rest = rest.subspan(static_cast<std::size_t>(written));
            } else if (errno != EINTR) {
                ::_exit(1);
            }
        }
    }
}

void byte_sink::write(std::span<const std::byte> bytes) {
    if (!complained_) {
        send(kind_bytes, bytes);
    }
}

void byte_sink::complain(std::string_view text) {
    text = text.substr(0, longest_complaint);
    if (!complained_) {
        send(kind_complaint, std::as_bytes(std::span(text)));
    }
    complained_ = true;
}

result<child_process> child_process::start(const std::function<void(byte_sink&)>& work) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
        return fail(error_code::out_of_memory, "There is no pipe to read a file through: " +
                                                   std::string(std::strerror(errno)) + ".");
    }
    const ::pid_t process = ::fork();
    if (process == 0) {
        ::close(ends[0]);
        be_quiet();
        byte_sink sink(ends[1]);
        work(sink);
        ::_exit(0);
    }
    const int error = errno;
    ::close(ends[1]);
    if (process < 0) {
        ::close(ends[0]);
        return fail(error_code::out_of_memory, "There is no process to read a file in: " +
                                                   std::string(std::strerror(error)) + ".");
    }
    child_process child;
    child.descriptor_ = ends[0];
    child.process_ = process;
    return child;
}

child_process::child_process(child_process&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      process_(std::exchange(other.process_, -1)), left_(other.left_),
      complaint_(std::move(other.complaint_)) {}

child_process& child_process::operator=(child_process&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(process_, other.process_);
    std::swap(left_, other.left_);
    std::swap(complaint_, other.complaint_);
    return *this;
}

child_process::~child_process() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
    if (process_ >= 0) {
        ::kill(process_, SIGKILL);
        while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
        }
    }
}

bool child_process::fill(std::span<std::byte> bytes) {
    while (!bytes.empty()) {
        const ::ssize_t got = ::read(descriptor_, bytes.data(), bytes.size());
        if (got > 0) {
            bytes = bytes.subspan(static_cast<std::size_t>(got));
        } else if (got == 0 || errno != EINTR) {
            return false;
        }
    }
    return true;
}

bool child_process::next_message() {
    message_header header;
    if (!fill(std::as_writable_bytes(std::span(&header, 1)))) {
        wait_for_end();
        return false;
    }
    if (header.kind == kind_bytes) {
        left_ = static_cast<std::size_t>(header.length);
        return true;
    }
    complaint_.assign(
        static_cast<std::size_t>(std::min<std::uint64_t>(header.length, longest_complaint)), ' ');
    if (header.kind != kind_complaint ||
        !fill(std::as_writable_bytes(std::span(complaint_.data(), complaint_.size())))) {
        wait_for_end();
    }
    return false;
}

void child_process::wait_for_end() {
    int status = 0;
    ::pid_t ended = -1;
    do {
        ended = ::waitpid(process_, &status, 0);
    } while (ended < 0 && errno == EINTR);
    process_ = -1;
    complaint_ = "is damaged: its reader came to an end";
    if (ended >= 0 && WIFSIGNALED(status)) {
        complaint_ += " with signal " + std::to_string(WTERMSIG(status));
    }
    complaint_ += ".";
}

bool child_process::read(std::span<std::byte> bytes) {
    if (!complaint_.empty()) {
        return false;
    }
    while (!bytes.empty()) {
        if (left_ == 0) {
            if (!next_message()) {
                return false;
            }
            continue;
        }
        const std::size_t now = std::min(left_, bytes.size());
        if (!fill(bytes.first(now))) {
            wait_for_end();
            return false;
        }
        left_ -= now;
        bytes = bytes.subspan(now);
    }
    return true;
}

memory_limit::memory_limit(std::uint64_t bytes) {
    rlimit limit{};
    std::uint64_t pages = 0;
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || !(std::ifstream("/proc/self/statm") >> pages)) {
        return;
    }
    before_ = limit.rlim_cur;
    const std::uint64_t now = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    limit.rlim_cur = std::min<std::uint64_t>(limit.rlim_cur, now + bytes);
    (void)::setrlimit(RLIMIT_AS, &limit);
}

memory_limit::~memory_limit() {
    rlimit limit{};
    if (before_ != 0 && ::getrlimit(RLIMIT_AS, &limit) == 0) {
        limit.rlim_cur = before_;
        (void)::setrlimit(RLIMIT_AS, &limit);
    }
}

} // namespace skybark::io
