#pragma once
// What the tests of the tool share: a folder of their own, the tool as a process, its files.

#include <array>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace skybark::tests {

using words = std::vector<std::string>;

/// What a process left behind.
struct outcome {
    int code = -1; ///< of its exit; negative: the signal that ended it
    std::string out;
    std::string err;
};

inline std::string read_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_file(const std::filesystem::path& path, std::string_view text) {
    std::ofstream(path, std::ios::binary) << text;
}

/// Whether `text` has all of the parts.
inline testing::AssertionResult has(const std::string& text, const words& parts) {
    for (const std::string& part : parts) {
        if (text.find(part) == std::string::npos) {
            return testing::AssertionFailure() << '"' << text << "\" lacks \"" << part << '"';
        }
    }
    return testing::AssertionSuccess();
}

/// A full sentence: "skybark: ", something, and a full stop at the end of its line.
inline testing::AssertionResult is_sentence(const std::string& err) {
    const std::string line = err.substr(0, err.find('\n'));
    if (line.rfind("skybark: ", 0) == 0 && line.size() > 20 && line.back() == '.') {
        return testing::AssertionSuccess();
    }
    return testing::AssertionFailure() << '"' << err << "\" is no sentence";
}

/// An empty folder for each test, gone afterwards.
class tool : public testing::Test {
  protected:
    void SetUp() override {
        std::string name =
            (std::filesystem::temp_directory_path() / "skybark_tool.XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        // Temporary files of the processes themselves lie apart from what they should leave.
        base_ = name;
        folder = base_ / "folder";
        std::filesystem::create_directory(folder);
    }
    void TearDown() override {
        std::error_code ignored;
        std::filesystem::remove_all(base_, ignored);
    }

    [[nodiscard]] std::string in_folder(const std::string& name) const {
        return (folder / name).string();
    }

    /// Starts a program. Its environment is ours.
    [[nodiscard]] pid_t start(const words& command) const {
        std::vector<char*> arguments;
        for (const std::string& word : command) {
            arguments.push_back(const_cast<char*>(word.c_str()));
        }
        arguments.push_back(nullptr);
        const pid_t child = ::fork();
        if (child == 0) {
            // Descriptors alone: this process's buffered text isn't the child's to write.
            const auto open_as = [](int number, const std::string& path, int flags) {
                const int opened = ::open(path.c_str(), flags, 0600);
                if (opened < 0 || ::dup2(opened, number) < 0) {
                    std::_Exit(126);
                }
            };
            open_as(STDIN_FILENO, "/dev/null", O_RDONLY);
            open_as(STDOUT_FILENO, (base_ / "out").string(), O_WRONLY | O_CREAT | O_TRUNC);
            open_as(STDERR_FILENO, (base_ / "err").string(), O_WRONLY | O_CREAT | O_TRUNC);
            ::execvp(arguments[0], arguments.data());
            std::_Exit(127);
        }
        return child;
    }
    /// Waits for the program that was started last.
    [[nodiscard]] outcome finish(pid_t child) const {
        int status = 0;
        ::waitpid(child, &status, 0);
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status),
                read_file(base_ / "out"), read_file(base_ / "err")};
    }
    [[nodiscard]] outcome run(const words& command) const { return finish(start(command)); }

    /// Runs the tool.
    [[nodiscard]] outcome skybark(words arguments) const {
        arguments.insert(arguments.begin(), SKYBARK_TOOL);
        return run(arguments);
    }

    /// The same by the shell, after `before` ("ulimit -f 100").
    [[nodiscard]] outcome skybark_after(const std::string& before, words arguments) const {
        arguments.insert(arguments.begin(),
                         {"sh", "-c", before + "; exec \"$0\" \"$@\"", SKYBARK_TOOL});
        return run(arguments);
    }

    /// The names in the folder, hidden ones as well.
    [[nodiscard]] std::set<std::string> names() const {
        std::set<std::string> all;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            all.insert(entry.path().filename().string());
        }
        return all;
    }

    std::filesystem::path folder;

  private:
    std::filesystem::path base_;
};

/// Whether a backend that isn't there is a failure here.
inline bool is_required(const std::string& backend) {
    const char* list = std::getenv("SKYBARK_REQUIRE_BACKENDS");
    return list != nullptr &&
           ("," + std::string(list) + ",").find("," + backend + ",") != std::string::npos;
}

/// Skips the rest of a test where the tool says that there is no such backend.
#define SKYBARK_SKIP_UNAVAILABLE(outcome, backend)                                                 \
    if ((outcome).code == 3 && !skybark::tests::is_required(backend)) {                            \
        GTEST_SKIP() << (outcome).err;                                                             \
    }

} // namespace skybark::tests
