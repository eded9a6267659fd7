#pragma once
// What a device tells its hooks.

#include <skybark/core/hooks.hpp>

#include <algorithm>
#include <gtest/gtest.h>
#include <set>
#include <thread>
#include <utility>
#include <vector>

namespace skybark::support {

/// Keeps all that is logged, and the zones, of which none may be left open.
class hook_log {
  public:
    hook_log() = default;
    hook_log(const hook_log&) = delete;
    hook_log& operator=(const hook_log&) = delete;

    [[nodiscard]] hooks to_me() {
        hooks h;
        h.user = this;
        h.log = [](void* user, log_level level, std::string_view text) {
            auto* me = static_cast<hook_log*>(user);
            me->look_at_thread();
            me->entries.emplace_back(level, text);
        };
        h.begin_zone = [](void* user, const char* name) {
            auto* me = static_cast<hook_log*>(user);
            me->look_at_thread();
            me->zones.insert(name);
            ++me->open;
        };
        h.end_zone = [](void* user) {
            auto* me = static_cast<hook_log*>(user);
            me->look_at_thread();
            EXPECT_GT(me->open, 0) << "a zone ends that did not begin";
            --me->open;
        };
        return h;
    }

    /// How many entries of a level have this in them.
    [[nodiscard]] std::ptrdiff_t count(log_level level, std::string_view part) const {
        return std::count_if(entries.begin(), entries.end(), [&](const auto& e) {
            return e.first == level && e.second.find(part) != std::string::npos;
        });
    }

    std::vector<std::pair<log_level, std::string>> entries;
    std::set<std::string> zones;
    int open = 0;

  private:
    void look_at_thread() const {
        EXPECT_EQ(std::this_thread::get_id(), owner_) << "a hook on another thread";
    }
    std::thread::id owner_ = std::this_thread::get_id();
};

} // namespace skybark::support
