#include "stages.hpp"

#include <algorithm>
#include <cstdio>
#include <unistd.h>

namespace skybark::tool {

stages::stages(std::vector<std::string> names, bool quiet)
    : current_(names.size()), bar_(!quiet && ::isatty(STDERR_FILENO) == 1) {
    for (std::string& name : names) {
        seconds_.emplace_back(std::move(name), 0.0);
    }
}

stages::~stages() { end(); }

void stages::begin(std::string_view name) {
    end();
    const auto found = std::find_if(seconds_.begin(), seconds_.end(),
                                    [&](const auto& stage) { return stage.first == name; });
    current_ = static_cast<std::size_t>(found - seconds_.begin());
    started_ = clock::now();
    draw_bar(0, {});
}

void stages::advance(double part, std::string_view note) { draw_bar(part, note); }

void stages::end() {
    if (current_ >= seconds_.size()) {
        return;
    }
    seconds_[current_].second += std::chrono::duration<double>(clock::now() - started_).count();
    current_ = seconds_.size();
    clear_bar();
}

double stages::total() const {
    double sum = 0;
    for (const auto& stage : seconds_) {
        sum += stage.second;
    }
    return sum;
}

void stages::draw_bar(double part, std::string_view note) const {
    if (!bar_ || current_ >= seconds_.size()) {
        return;
    }
    constexpr std::size_t width = 30;
    const double stages_done = static_cast<double>(current_) + std::clamp(part, 0.0, 1.0);
    const auto done = static_cast<std::size_t>(static_cast<double>(width) * stages_done /
                                               static_cast<double>(seconds_.size()));
    const std::string bar = std::string(done, '#') + std::string(width - done, '.');
    std::fprintf(stderr, "\r[%s] %s %.*s\033[K", bar.c_str(), seconds_[current_].first.c_str(),
                 static_cast<int>(note.size()), note.data());
    std::fflush(stderr);
}

void stages::clear_bar() const {
    if (bar_) {
        std::fputs("\r\033[K", stderr);
        std::fflush(stderr);
    }
}

} // namespace skybark::tool
