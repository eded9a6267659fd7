// The whole suite once more, each time in one test: backends in their other modes, behind
// validated<B>, and under Vulkan's and OpenGL's own checks. The suite itself must use them rightly.

#include "backends.hpp"
#include "run_cases.hpp"

#include <skybark/core/validated.hpp>

namespace {

using namespace skybark;

/// All but the largest cases pass on this device.
template <backend B>
void expect_all_pass(B& device) {
    const auto wanted = [](const std::string& name) {
        return name.find("groups") == std::string::npos && !name.ends_with("huge");
    };
    for (const auto& [name, why] :
         conformance::failed_cases<B>([&]() -> B& { return device; }, wanted)) {
        ADD_FAILURE() << name << ": " << why;
    }
}

/// The same behind validated<B>, which has nothing to complain of.
template <backend B>
void expect_all_valid(B& device) {
    validated<B> checked(device, [](std::string_view sentence) { ADD_FAILURE() << sentence; });
    expect_all_pass(checked);
    EXPECT_EQ(checked.last_misuse(), "");
}

/// Skips the test, or fails it where the environment asks for the backend.
template <class Made>
[[nodiscard]] bool is_there(const Made& made, const char* backend_name) {
    if (!made) {
        EXPECT_TRUE(made.error().code == error_code::unavailable &&
                    !conformance::is_required(backend_name))
            << made.error().message;
    }
    return made.has_value();
}

#define SKYBARK_NEED(made, backend_name)                                                           \
    if (!is_there(made, backend_name)) {                                                           \
        GTEST_SKIP() << (made).error().message;                                                    \
    }

TEST(variants, cpu_validated) {
    cpu::device device;
    expect_all_valid(device);
}

TEST(variants, cpu_many_threads) {
    cpu::device_options options;
    options.threads = 7;
    cpu::device device(options);
    expect_all_pass(device);
}

TEST(variants, cpu_jobs_of_the_caller) {
    cpu::device_options options;
    options.jobs = [](std::uint32_t count, const std::function<void(std::uint32_t)>& task) {
        for (std::uint32_t i = count; i-- > 0;) { // in any order
            task(i);
        }
    };
    cpu::device device(options);
    expect_all_pass(device);
}

TEST(variants, opengl_validated) {
    auto made = opengl::headless::create();
    SKYBARK_NEED(made, "opengl");
    expect_all_valid(made->device());
}

TEST(variants, opengl_osmesa) {
    opengl::headless_options options;
    options.kind = opengl::headless_kind::osmesa;
    auto made = opengl::headless::create(options);
    SKYBARK_NEED(made, "opengl");
    expect_all_pass(made->device());
}

TEST(variants, opengl_debug_context) {
    opengl::headless_options options;
    std::vector<std::string> said;
    options.debug = [&](const opengl::debug_message& message) {
        if (message.severity == opengl::debug_severity::high ||
            message.severity == opengl::debug_severity::medium) {
            said.emplace_back(message.text);
        }
    };
    auto made = opengl::headless::create(options);
    SKYBARK_NEED(made, "opengl");
    expect_all_pass(made->device());
    for (std::size_t i = 0; i < std::min<std::size_t>(said.size(), 10); ++i) {
        ADD_FAILURE() << said[i];
    }
}

void vulkan_variant(vulkan::headless_options options) {
    std::vector<std::string> said;
    options.sink = [&](const vulkan::message& message) { said.emplace_back(message.text); };
    {
        auto made = vulkan::headless::create(options);
        SKYBARK_NEED(made, "vulkan");
        expect_all_pass(made->device());
    }
    for (std::size_t i = 0; i < std::min<std::size_t>(said.size(), 10); ++i) {
        ADD_FAILURE() << said[i];
    }
}

TEST(variants, vulkan_validated) {
    auto made = vulkan::headless::create({});
    SKYBARK_NEED(made, "vulkan");
    expect_all_valid(made->device());
}

TEST(variants, vulkan_per_element) {
    vulkan::headless_options options;
    options.expand_by = vulkan::expansion::per_element;
    vulkan_variant(options);
}

TEST(variants, vulkan_per_vertices) {
    vulkan::headless_options options;
    options.expand_by = vulkan::expansion::per_vertices;
    vulkan_variant(options);
}

TEST(variants, vulkan_staged) {
    vulkan::headless_options options;
    options.always_stage = true;
    vulkan_variant(options);
}

TEST(variants, vulkan_validation_layer) {
    vulkan::headless_options options;
    options.validation = true;
    vulkan_variant(options);
}

/// The layer sees what it should: without barriers it has something to say.
TEST(variants, vulkan_validation_layer_is_awake) {
    vulkan::headless_options options;
    options.validation = true;
    options.omit_barriers = true;
    std::size_t errors = 0;
    options.sink = [&](const vulkan::message& message) { errors += message.is_error ? 1u : 0u; };
    auto made = vulkan::headless::create(options);
    SKYBARK_NEED(made, "vulkan");
    (void)conformance::failed_cases<vulkan::device>(
        [&]() -> vulkan::device& { return made->device(); },
        [](const std::string& name) { return name == "map.twice_in_one_recorder"; });
    EXPECT_GT(errors, 0u);
}

TEST(variants, vulkan_gpu_assisted_slow) {
    vulkan::headless_options options;
    options.validation = true;
    options.gpu_assisted = true;
    vulkan_variant(options);
}

} // namespace
