#pragma once
// stages: how long each stage of a command took, and a progress bar on a terminal.

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace skybark::tool {

class stages {
  public:
    /// The names in their order; each is in the result even when it never began.
    stages(std::vector<std::string> names, bool quiet);
    stages(const stages&) = delete;
    stages& operator=(const stages&) = delete;
    /// Takes the bar off the terminal.
    ~stages();

    /// Ends the stage that was going on, if any.
    void begin(std::string_view name);
    void end();
    /// How much of the stage is done, 0 to 1, for the bar; what else is to be said of it.
    void advance(double part, std::string_view note = {});

    [[nodiscard]] const std::vector<std::pair<std::string, double>>& seconds() const {
        return seconds_;
    }
    [[nodiscard]] double total() const;

  private:
    using clock = std::chrono::steady_clock;

    void draw_bar(double part, std::string_view note) const;
    void clear_bar() const;

    std::vector<std::pair<std::string, double>> seconds_;
    clock::time_point started_;
    std::size_t current_;
    bool bar_;
};

} // namespace skybark::tool
