#include <io/atomic_file.hpp>

#include <io/text_input.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace skybark::io {

namespace {

namespace fs = std::filesystem;

/// The names of the temporary files that a signal handler has to remove. Names that are longer than
/// a slot, or more at once than there are slots, aren't noted.
constexpr std::size_t longest_name = 4096;
struct slot {
    std::atomic<bool> used{false};
    std::atomic<bool> noted{false}; ///< the name is whole
    std::array<char, longest_name> name{};
};
std::array<slot, 16> unfinished{};

/// The number of the slot, or -1.
int note_unfinished(const std::string& name) {
    for (std::size_t i = 0; i < unfinished.size() && name.size() < longest_name; ++i) {
        if (!unfinished[i].used.exchange(true)) {
            std::memcpy(unfinished[i].name.data(), name.c_str(), name.size() + 1);
            unfinished[i].noted = true;
            return static_cast<int>(i);
        }
    }
    return -1;
}

void forget_unfinished(int number) {
    if (number >= 0) {
        slot& s = unfinished[static_cast<std::size_t>(number)];
        s.noted = false;
        s.used = false;
    }
}

failure fail_file(const std::string& path, const std::string& complaint) {
    return fail(error_code::bad_input, in_quotes(path) + " " + complaint);
}

std::string reason(int number) { return std::string(std::strerror(number)) + "."; }

fs::path folder_of(const std::string& target) {
    const fs::path folder = fs::path(target).parent_path();
    return folder.empty() ? fs::path(".") : folder;
}

/// What bytes for `path` replace: the end of the links, if it is one.
result<std::string> resolve(const std::string& path) {
    if (path.empty()) {
        return fail(error_code::bad_input, "The name of the file to write is empty.");
    }
    constexpr int most_links = 40; // as many as Linux itself follows
    fs::path at = path;
    std::error_code error;
    for (int i = 0; i < most_links && fs::is_symlink(at, error); ++i) {
        const fs::path to = fs::read_symlink(at, error);
        if (error) {
            return fail_file(path, "is a link that can't be followed: " + error.message() + ".");
        }
        at = to.is_absolute() ? to : at.parent_path() / to;
    }
    if (fs::is_symlink(at, error)) {
        return fail_file(path, "is a link that leads in a circle.");
    }
    return at.string();
}

/// Errors of a target that nothing can be written to.
result<void> check_target(const std::string& path, const std::string& target) {
    std::error_code error;
    const fs::path folder = folder_of(target);
    if (!fs::exists(folder, error)) {
        return fail_file(path, "can't be written: there is no folder " +
                                   in_quotes(folder.string()) + ".");
    }
    if (!fs::is_directory(folder, error)) {
        return fail_file(path,
                         "can't be written: " + in_quotes(folder.string()) + " is no folder.");
    }
    if (fs::is_directory(target, error) || fs::path(target).filename().empty()) {
        return fail_file(path, "can't be written: it is a folder.");
    }
    const auto longest =
        static_cast<std::size_t>(std::max(0l, ::pathconf(folder.c_str(), _PC_NAME_MAX)));
    const std::size_t length = fs::path(target).filename().native().size();
    if (longest > 0 && length > longest) {
        return fail_file(path, "can't be written: its name has " + std::to_string(length) +
                                   " bytes; expected at most " + std::to_string(longest) + ".");
    }
    return {};
}

/// Whether it is there and something else than a plain file.
bool is_special(const std::string& target) {
    std::error_code error;
    const fs::file_status status = fs::status(target, error);
    return fs::exists(status) && !fs::is_regular_file(status);
}

/// ".NAME.PID.N.part" beside the target; hidden, so that no pattern such as *.png finds it.
std::string temporary_name(const std::string& target, int attempt) {
    const std::string name = fs::path(target).filename().string();
    constexpr std::size_t longest = 200; // a file system takes 255 bytes a name
    std::string hidden = ".";
    hidden += name.substr(0, longest) + "." + std::to_string(::getpid()) + "." +
              std::to_string(attempt) + ".part";
    return (folder_of(target) / hidden).string();
}

} // namespace

result<atomic_file> atomic_file::create(const std::string& path) {
    const auto target = resolve(path);
    if (!target) {
        return failure(target.error());
    }
    if (auto good = check_target(path, *target); !good) {
        return failure(good.error());
    }
    atomic_file file;
    file.path_ = path;
    if (is_special(*target)) {
        file.descriptor_ = ::open(target->c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
        if (file.descriptor_ < 0) {
            return file.failed("can't be opened");
        }
        return file;
    }
    constexpr int most_attempts = 100; // leftovers of a process with the same number
    for (int attempt = 0; attempt < most_attempts && file.descriptor_ < 0; ++attempt) {
        const std::string name = temporary_name(*target, attempt);
        // Noted before it is there, so that no signal comes in between.
        const int noted = note_unfinished(name);
        file.descriptor_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file.descriptor_ >= 0) {
            file.target_ = *target;
            file.temporary_ = name;
            file.slot_ = noted;
            continue;
        }
        const int error = errno;
        forget_unfinished(noted);
        errno = error;
        if (error != EEXIST) {
            break;
        }
    }
    if (file.descriptor_ < 0) {
        return file.failed("can't be written");
    }
    // The file that is replaced keeps its permissions.
    struct stat old {};
    if (::stat(target->c_str(), &old) == 0) {
        (void)::fchmod(file.descriptor_, old.st_mode & 07777u);
    }
    return file;
}

atomic_file::atomic_file(atomic_file&& other) noexcept
    : path_(std::move(other.path_)), target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      descriptor_(std::exchange(other.descriptor_, -1)), slot_(std::exchange(other.slot_, -1)) {}

atomic_file& atomic_file::operator=(atomic_file&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(target_, other.target_);
    std::swap(temporary_, other.temporary_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(slot_, other.slot_);
    return *this;
}

atomic_file::~atomic_file() { abandon(); }

void atomic_file::abandon() noexcept {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
        descriptor_ = -1;
    }
    if (!temporary_.empty()) {
        ::unlink(temporary_.c_str());
        temporary_.clear();
        forget_unfinished(std::exchange(slot_, -1));
    }
}

failure atomic_file::failed(std::string_view doing) const {
    return fail_file(path_, std::string(doing) + ": " + reason(errno));
}

result<void> atomic_file::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ::ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written >= 0) {
            bytes.remove_prefix(static_cast<std::size_t>(written));
        } else if (errno != EINTR) {
            return failed("can't be written");
        }
    }
    return {};
}

result<void> atomic_file::write(std::span<const std::byte> bytes) {
    return write(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

result<void> atomic_file::finish() {
    const bool direct = temporary_.empty();
    // A disk may say only now that it is full. Pipes and devices can't be synchronised.
    if (!direct && ::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOSYS) {
        return failed("can't be written");
    }
    if (::close(std::exchange(descriptor_, -1)) != 0) {
        return failed("can't be written");
    }
    return {};
}

result<void> atomic_file::commit() {
    if (descriptor_ >= 0) {
        if (auto done = finish(); !done) {
            return done;
        }
    }
    if (temporary_.empty()) {
        return {};
    }
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
        return failed("can't be renamed to");
    }
    temporary_.clear();
    forget_unfinished(std::exchange(slot_, -1));
    return {};
}

result<void> write_file(const std::string& path, std::string_view bytes) {
    auto file = atomic_file::create(path);
    if (!file) {
        return failure(file.error());
    }
    if (auto done = file->write(bytes); !done) {
        return done;
    }
    return file->commit();
}

result<void> check_writable(const std::string& path) {
    const auto target = resolve(path);
    if (!target) {
        return failure(target.error());
    }
    if (auto good = check_target(path, *target); !good) {
        return good;
    }
    const std::string what = is_special(*target) ? *target : folder_of(*target).string();
    if (::access(what.c_str(), W_OK) != 0) {
        return fail_file(path, "can't be written: " + reason(errno));
    }
    return {};
}

void remove_unfinished() noexcept {
    for (const slot& s : unfinished) {
        if (s.noted) {
            ::unlink(s.name.data());
        }
    }
}

} // namespace skybark::io
