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
    /// What would be seen is in a file of `folder`.
    explicit display(const std::filesystem::path& folder) : screen_(folder / "Xvfb_screen0") {
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
                     "-fbdir", folder.c_str(), "-nocursor", static_cast<char*>(nullptr));
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

    /// The pixels of the screen's top left corner, RGBA, by the format of xwd(1): a header of
    /// big-endian words, colours of 12 bytes, then rows of blue, green, red and nothing.
    [[nodiscard]] std::vector<unsigned char> corner(std::size_t width, std::size_t height) const {
        const std::string file = tests::read_file(screen_);
        const auto word = [&](std::size_t i) {
            std::size_t value = 0;
            for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
                value = value << 8 | static_cast<unsigned char>(file.at(k));
            }
            return value;
        };
        const std::size_t first = word(0) + 12 * word(19);
        const std::size_t row = word(12);
        std::vector<unsigned char> pixels;
        for (std::size_t y = 0; y < height; ++y) {
            for (std::size_t x = 0; x < width; ++x) {
                for (const std::size_t channel : {2, 1, 0}) {
                    pixels.push_back(
                        static_cast<unsigned char>(file.at(first + y * row + 4 * x + channel)));
                }
                pixels.push_back(255);
            }
        }
        return pixels;
    }

  private:
    std::filesystem::path screen_;
    pid_t server_ = -1;
    std::string name_;
};

/// Whether windows that can't be had are a failure here.
inline bool windows_are_required() { return std::getenv("SKYBARK_REQUIRE_GLFW") != nullptr; }

class program : public tests::tool {
  protected:
    /// A meadow that is soon grown and soon drawn.
    static inline const words small{"--trees",        "1",  "--grass", "0.02", "--directions", "1",
                                    "--cloud-voxels", "16", "--cloud", "0.1"};

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
    /// For what isn't the viewer's.
    [[nodiscard]] std::filesystem::path beside() const { return folder.parent_path(); }
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
