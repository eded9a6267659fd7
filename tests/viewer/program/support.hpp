#pragma once
// skybark_viewer as a process, on a display of its own, and the pictures that it saves.

#define SKYBARK_TOOL SKYBARK_VIEWER // what the base class runs
#include "tool/pictures.hpp"

#include <csignal>
#include <sys/prctl.h>

namespace skybark::viewer {

using tests::outcome;
using tests::read_picture;
using tests::words;

/// An X server without a screen to see, for one test.
class display {
  public:
    display() {
        int ends[2] = {-1, -1};
        if (::pipe(ends) != 0) {
            return;
        }
        server_ = ::fork();
        if (server_ == 0) {
            ::close(ends[0]);
            const std::string number = std::to_string(ends[1]);
            ::prctl(PR_SET_PDEATHSIG, SIGTERM); // it does not outlive a test that crashes
            const int silence = ::open("/dev/null", O_WRONLY);
            ::dup2(silence, STDERR_FILENO);
            ::execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", "800x600x24",
                     static_cast<char*>(nullptr));
            std::_Exit(127);
        }
        ::close(ends[1]);
        std::string text; // the number and an end of line, when it is ready
        char one = 0;
        while (::read(ends[0], &one, 1) == 1 && one != '\n') {
            text += one;
        }
        ::close(ends[0]);
        name_ = text.empty() ? "" : ":" + text;
    }
    display(const display&) = delete;
    display& operator=(const display&) = delete;
    ~display() {
        ::kill(server_, SIGTERM);
        ::waitpid(server_, nullptr, 0);
    }

    /// Empty: there is none.
    [[nodiscard]] const std::string& name() const { return name_; }

  private:
    pid_t server_ = -1;
    std::string name_;
};

/// Whether windows that can't be had are a failure here.
inline bool windows_are_required() { return std::getenv("SKYBARK_REQUIRE_GLFW") != nullptr; }

class program : public tests::tool {
  protected:
    /// A meadow that is soon grown and soon drawn.
    static inline const words small{"--trees",        "2",  "--grass",   "0.05",
                                    "--directions",   "2",  "--bounces", "1",
                                    "--cloud-voxels", "16", "--cloud",   "0.2"};

    /// What starts the viewer with these, in the folder, on a display (none where it is empty).
    [[nodiscard]] words command(const std::string& on, const words& arguments) const {
        words all{"sh", "-c",
                  "cd \"$0\" && " +
                      (on.empty() ? std::string("unset DISPLAY WAYLAND_DISPLAY")
                                  : "export DISPLAY=" + on) +
                      " && exec \"$@\"",
                  folder.string(), SKYBARK_VIEWER};
        all.insert(all.end(), arguments.begin(), arguments.end());
        return all;
    }
    [[nodiscard]] outcome view(const std::string& on, const words& arguments) const {
        return run(command(on, arguments));
    }

    /// The pixels of a picture in the folder.
    [[nodiscard]] std::vector<unsigned char> pixels(const std::string& name) const {
        return tests::read_png(in_folder(name)).rgba;
    }
    /// How many of the pixels of one picture are not those of another.
    [[nodiscard]] double different(const std::string& a, const std::string& b) const {
        const auto one = pixels(a);
        const auto two = pixels(b);
        EXPECT_EQ(one.size(), two.size());
        double count = 0;
        for (std::size_t i = 0; i + 3 < std::min(one.size(), two.size()); i += 4) {
            count += std::memcmp(&one[i], &two[i], 4) != 0 ? 1 : 0;
        }
        return 4 * count / static_cast<double>(one.size());
    }
};

/// A complaint of the viewer's: a full sentence.
inline testing::AssertionResult is_complaint(const std::string& err) {
    const std::string line = err.substr(0, err.find('\n'));
    if (line.rfind("skybark_viewer: ", 0) == 0 && line.size() > 30 && line.back() == '.') {
        return testing::AssertionSuccess();
    }
    return testing::AssertionFailure() << '"' << err << "\" is no sentence";
}

} // namespace skybark::viewer
