#pragma once
// What the tests of the Vulkan backend share: a device with validation that must stay silent.

#include <skybark/vulkan/headless.hpp>
#include <skybark/vulkan/vulkan.hpp>

#include <cstdlib>
#include <gtest/gtest.h>

namespace skybark::testing {

using device = vulkan::device;
template <class K>
using bound = bindings<device, K>;

/// Whether a machine without Vulkan should fail these tests and not skip them.
inline bool vulkan_required() {
    const char* required = std::getenv("SKYBARK_REQUIRE_BACKENDS");
    return required && std::string_view(required).find("vulkan") != std::string_view::npos;
}

/// Everything that validation said.
struct log {
    std::vector<std::string> messages;

    [[nodiscard]] vulkan::message_sink sink() {
        return [this](const vulkan::message& m) { messages.emplace_back(m.text); };
    }
    [[nodiscard]] std::string text() const {
        std::string all;
        for (const std::string& m : messages) {
            all += m + "\n";
        }
        return all;
    }
};

/// A test with a device of its own. Skipped where there is no Vulkan; what validation says is a
/// failure.
class vulkan_test : public ::testing::Test {
  protected:
    void SetUp() override { open(options()); }
    void TearDown() override { EXPECT_TRUE(log_.messages.empty()) << log_.text(); }

    virtual vulkan::headless_options options() const {
        vulkan::headless_options o;
        o.validation = true;
        return o;
    }

    void open(vulkan::headless_options o) {
        o.sink = log_.sink();
        auto made = vulkan::headless::create(std::move(o));
        if (!made) {
            if (vulkan_required()) {
                FAIL() << made.error().message;
            }
            GTEST_SKIP() << made.error().message;
        }
        headless_.emplace(std::move(*made));
    }

    [[nodiscard]] device& gpu() { return headless_->device(); }

    log log_;
    std::optional<vulkan::headless> headless_;
};

/// The two ways that a device may be: memory that host and device share and an element an
/// invocation, or memory of its own and a few vertices an invocation.
class both_ways : public vulkan_test, public ::testing::WithParamInterface<bool> {
  protected:
    vulkan::headless_options options() const override {
        vulkan::headless_options o = vulkan_test::options();
        o.always_stage = GetParam();
        o.expand_by = GetParam() ? vulkan::expansion::per_vertices : vulkan::expansion::per_element;
        return o;
    }
};

inline std::string way_name(const ::testing::TestParamInfo<bool>& info) {
    return info.param ? "staged" : "shared";
}

/// The value, or a failed test.
template <class T>
T must(result<T> r) {
    if (!r) {
        ADD_FAILURE() << r.error().message;
        std::abort();
    }
    return std::move(*r);
}
inline void must(result<void> r) { EXPECT_TRUE(r.has_value()) << r.error().message; }

template <class T>
vulkan::buffer upload(device& d, const std::vector<T>& records) {
    return must(make_buffer<device, T>(d, records));
}

template <class T>
std::vector<T> download(device& d, const vulkan::buffer& b, std::size_t count,
                        std::size_t first = 0) {
    std::vector<T> records(count);
    must(read_back<device, T>(d, b, records, first));
    return records;
}

template <class Record>
void go(device& d, Record&& record) {
    must(run(d, std::forward<Record>(record)));
}

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& records) {
    return std::as_bytes(std::span<const T>(records));
}

/// Deterministic noise.
struct noise {
    std::uint32_t state = 12345;
    std::uint32_t operator()() {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        return state;
    }
    float unit() { return static_cast<float>((*this)() >> 8) / 16777216.0f; }
};

} // namespace skybark::testing
