#pragma once
// What the tests of the OpenGL backend share: a device of each kind, and what the driver said.

#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/headless_glfw.hpp>
#include <skybark/opengl/opengl.hpp>

#include <cstdlib>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

namespace skybark::opengl::tests {

using gpu = skybark::opengl::device;

/// Whether a backend that isn't there is a failure and no skip.
inline bool required() {
    const char* backends = std::getenv("SKYBARK_REQUIRE_BACKENDS");
    return backends != nullptr && std::string(backends).find("opengl") != std::string::npos;
}

/// The messages that a driver gives of high or medium severity.
struct message_log {
    std::vector<std::string> serious;
    [[nodiscard]] static std::function<void(const debug_message&)>
    sink(const std::shared_ptr<message_log>& log) {
        return [log](const debug_message& message) {
            if (message.severity == debug_severity::high ||
                message.severity == debug_severity::medium) {
                log->serious.emplace_back(message.text);
            }
        };
    }
};

/// A test with a headless device, which the driver must have no complaint about.
class device_test : public testing::Test {
  protected:
    void SetUp() override { start(headless_kind::egl); }
    void TearDown() override { EXPECT_EQ(log->serious, std::vector<std::string>{}); }

    void start(headless_kind kind) {
        auto made = headless::create({kind, message_log::sink(log)});
        if (!made) {
            ASSERT_FALSE(required()) << made.error().message;
            GTEST_SKIP() << made.error().message;
        }
        owner = std::make_unique<headless>(std::move(*made));
    }
    [[nodiscard]] gpu& device() { return owner->device(); }

    template <record T>
    [[nodiscard]] buffer make(std::span<const T> records) {
        auto made = make_buffer<gpu, T>(device(), records);
        EXPECT_TRUE(made) << made.error().message;
        return std::move(*made);
    }
    template <record T>
    [[nodiscard]] buffer make(const std::vector<T>& records) {
        return make(std::span<const T>(records));
    }
    [[nodiscard]] buffer zeros(std::uint64_t bytes) {
        auto made = device().create_buffer(bytes);
        EXPECT_TRUE(made) << made.error().message;
        return std::move(*made);
    }
    template <record T>
    [[nodiscard]] std::vector<T> read(const buffer& from, std::size_t count,
                                      std::size_t first = 0) {
        std::vector<T> records(count);
        const auto done = read_back<gpu, T>(device(), from, std::span<T>(records), first);
        EXPECT_TRUE(done) << done.error().message;
        return records;
    }
    template <class Record>
    void run(Record&& record) {
        const auto done = skybark::run(device(), std::forward<Record>(record));
        ASSERT_TRUE(done) << done.error().message;
    }

    std::shared_ptr<message_log> log = std::make_shared<message_log>();
    std::unique_ptr<headless> owner;
};

} // namespace skybark::opengl::tests
