#pragma once
// The conformance suite: what a backend must do to be one.
//
//     skybark::conformance::register_suite<my::device>("mine", [] { return my::make_device(); });
//     return skybark::conformance::run({});
//
// Every promise of core/backend.hpp is a case, for each pattern, padding policy and edge of the
// input. A case is there only if the backend models the concept that it is about. Cases are
// GoogleTest's and are called NAME/PATTERN.CASE, such as `mine/expand.compact_limit_plus_1`.
//
// Expected values are written out here in closed form, in integers and doubles; they never come
// from the code under test.
//
// `make` gives a result of a smart pointer to the device. An error with error_code::unavailable
// skips the cases, visibly, unless the environment names the backend in SKYBARK_REQUIRE_BACKENDS
// (comma-separated): then, and with any other error, they fail. One device serves all cases until
// one fails: the next case gets a new one.

#include <skybark/conformance/accumulations.hpp>
#include <skybark/conformance/bark.hpp>
#include <skybark/conformance/branches.hpp>
#include <skybark/conformance/buffers.hpp>
#include <skybark/conformance/bundles.hpp>
#include <skybark/conformance/chains.hpp>
#include <skybark/conformance/draws.hpp>
#include <skybark/conformance/grids.hpp>
#include <skybark/conformance/images.hpp>
#include <skybark/conformance/layers.hpp>
#include <skybark/conformance/leaves.hpp>
#include <skybark/conformance/lists.hpp>
#include <skybark/conformance/maps.hpp>
#include <skybark/conformance/rings.hpp>
#include <skybark/conformance/volume_scans.hpp>
#include <skybark/conformance/volumes.hpp>
#include <skybark/conformance/words.hpp>

#include <gtest/gtest-spi.h>

#include <cstdlib>
#include <memory>
#include <regex>

namespace skybark::conformance {

/// A case that is known to fail on some devices. It runs all the same, and it is a failure if it
/// passes or fails in another way.
struct expected_failure {
    std::string case_glob;   ///< "draw.blend_*"; * and ? as in a shell
    std::string device_glob; ///< of device_name()
    std::string message;     ///< a regular expression that every failure of the case matches
    std::string reason;      ///< a sentence
};

/// What register_suite may be told.
template <backend B>
struct suite_options {
    std::vector<expected_failure> expected_failures;
    std::function<void(B&)> before_case; ///< such as making a context current
    std::uint32_t seed = 1;
};

/// Whether `text` matches a pattern with * and ?.
[[nodiscard]] inline bool matches_glob(std::string_view text, std::string_view glob) {
    if (glob.empty()) {
        return text.empty();
    }
    if (glob[0] == '*') {
        return matches_glob(text, glob.substr(1)) ||
               (!text.empty() && matches_glob(text.substr(1), glob));
    }
    return !text.empty() && (glob[0] == '?' || glob[0] == text[0]) &&
           matches_glob(text.substr(1), glob.substr(1));
}

/// Whether a comma-separated list names it.
[[nodiscard]] inline bool lists_name(std::string_view list, std::string_view name) {
    while (!list.empty()) {
        const std::size_t comma = std::min(list.find(','), list.size());
        if (list.substr(0, comma) == name) {
            return true;
        }
        list.remove_prefix(std::min(comma + 1, list.size()));
    }
    return false;
}

/// "vulkan/other_driver" counts as "vulkan".
[[nodiscard]] inline bool is_required(std::string_view backend_name) {
    const char* list = std::getenv("SKYBARK_REQUIRE_BACKENDS");
    return list != nullptr && lists_name(list, backend_name.substr(0, backend_name.find('/')));
}

/// Every case that a backend's concepts allow.
template <backend B>
[[nodiscard]] cases<B> all_cases() {
    cases<B> all;
    add_buffer_cases(all);
    add_map_cases(all);
    add_list_cases(all);
    add_ring_cases(all);
    add_image_cases(all);
    add_draw_cases(all);
    add_peel_cases(all);
    add_chain_cases(all);
    add_branch_cases(all);
    add_bark_cases(all);
    add_leaf_cases(all);
    add_volume_cases(all);
    add_accumulation_cases(all);
    add_volume_scan_cases(all);
    add_word_scan_cases(all);
    add_sort_cases(all);
    add_grid_cases(all);
    add_bundle_cases(all);
    return all;
}

/// A backend under test: its device, made when first needed.
template <backend B>
class subject {
  public:
    using device_pointer = std::shared_ptr<B>;
    using maker = std::function<result<device_pointer>()>;

    subject(std::string name, maker make, suite_options<B> options)
        : name_(std::move(name)), make_(std::move(make)), options_(std::move(options)) {}

    void run(const suite_case<B>& which) {
        if (!device_) {
            auto made = make_();
            if (!made) {
                cannot_make(made.error());
                return;
            }
            device_ = std::move(*made);
        }
        if (options_.before_case) {
            options_.before_case(*device_);
        }
        const std::string test = which.pattern + "." + which.name;
        const expected_failure* expected = find_expected(test);
        if (expected != nullptr) {
            run_expecting(*expected, which, test);
        } else {
            run_body(which, test);
        }
        if (testing::Test::HasFailure()) {
            device_.reset(); // a device that failed may be lost, and shouldn't fail the next case
        }
    }
    /// Contexts and devices go before the process's other globals do.
    void release() { device_.reset(); }

  private:
    void cannot_make(const error& e) {
        const std::string why = "The backend " + name_ + " can't be used: " + e.message;
        if (e.code == error_code::unavailable && !is_required(name_)) {
            GTEST_SKIP() << why;
        }
        ADD_FAILURE() << why;
    }
    void run_body(const suite_case<B>& which, const std::string& test) {
        try {
            context<B> c(*device_, name_, test, options_.seed);
            which.body(c);
        } catch (const case_stopped&) {
            return; // the failure has been noted
        }
    }
    [[nodiscard]] const expected_failure* find_expected(const std::string& test) const {
        const std::string device = device_->device_name();
        for (const expected_failure& e : options_.expected_failures) {
            if (matches_glob(test, e.case_glob) && matches_glob(device, e.device_glob)) {
                return &e;
            }
        }
        return nullptr;
    }
    void run_expecting(const expected_failure& expected, const suite_case<B>& which,
                       const std::string& test) {
        testing::TestPartResultArray parts;
        {
            const testing::ScopedFakeTestPartResultReporter catching(
                testing::ScopedFakeTestPartResultReporter::INTERCEPT_ALL_THREADS, &parts);
            run_body(which, test);
        }
        int failures = 0;
        const std::regex message(expected.message);
        for (int i = 0; i < parts.size(); ++i) {
            const testing::TestPartResult& part = parts.GetTestPartResult(i);
            failures += part.failed() ? 1 : 0;
            if (part.failed() && !std::regex_search(part.message(), message)) {
                ADD_FAILURE() << "It should fail with a message like /" << expected.message
                              << "/, and not so: " << part.message();
            }
        }
        if (failures == 0) {
            ADD_FAILURE() << "It passes, though it is expected to fail: " << expected.reason;
        } else if (!testing::Test::HasFailure()) {
            GTEST_SKIP() << "It fails, as expected: " << expected.reason;
        }
    }

    std::string name_;
    maker make_;
    suite_options<B> options_;
    std::shared_ptr<B> device_;
};

/// GoogleTest wants one class a suite, whatever the backend.
class suite_test : public testing::Test {
  public:
    explicit suite_test(std::function<void()> body) : body_(std::move(body)) {}
    void TestBody() override { body_(); }

  private:
    std::function<void()> body_;
};

/// Lets go of the devices when all tests have run.
class device_releaser : public testing::Environment {
  public:
    explicit device_releaser(std::function<void()> release) : release_(std::move(release)) {}
    void TearDown() override { release_(); }

  private:
    std::function<void()> release_;
};

/// Registers every case for backend B with GoogleTest. Call it before RUN_ALL_TESTS.
template <backend B, class Make>
void register_suite(const std::string& name, Make make, suite_options<B> options = {}) {
    auto make_shared = [make = std::move(make)]() mutable -> result<std::shared_ptr<B>> {
        auto made = make();
        if (!made) {
            return failure(made.error());
        }
        return std::shared_ptr<B>(std::move(*made));
    };
    const auto on = std::make_shared<subject<B>>(name, std::move(make_shared), std::move(options));
    for (suite_case<B>& c : all_cases<B>()) {
        const std::string suite = name + "/" + c.pattern;
        const std::string test = c.name;
        testing::RegisterTest(suite.c_str(), test.c_str(), nullptr, nullptr, __FILE__, __LINE__,
                              [on, which = std::move(c)]() -> suite_test* {
                                  return new suite_test([on, which] { on->run(which); });
                              });
    }
    testing::AddGlobalTestEnvironment(new device_releaser([on] { on->release(); }));
}

/// What `run` runs, and where it says so.
struct options {
    std::string filter;                ///< a glob of PATTERN.CASE, such as "expand.*"; empty: all
    std::string json;                  ///< a file for the report; empty: none
    std::vector<std::string> backends; ///< names given to register_suite; empty: all
    bool quiet = false;                ///< only failures are printed
};

/// Prints failures, and how many cases passed.
class quiet_printer : public testing::EmptyTestEventListener {
  public:
    void OnTestEnd(const testing::TestInfo& info) override {
        for (int i = 0; i < info.result()->total_part_count(); ++i) {
            const testing::TestPartResult& part = info.result()->GetTestPartResult(i);
            if (part.failed()) {
                std::fprintf(stderr, "%s.%s: %s\n", info.test_suite_name(), info.name(),
                             part.message());
            }
        }
    }
};

/// Runs the registered cases; 0 when none has failed and there were some. Initialises GoogleTest.
[[nodiscard]] inline int run(const options& what) {
    std::string filter;
    const std::string glob = what.filter.empty() ? "*" : what.filter;
    for (const std::string& name : what.backends) {
        filter += (filter.empty() ? "" : ":") + name + "/" + glob;
    }
    if (what.backends.empty()) {
        filter = glob == "*" ? glob : "*/" + glob;
    }
    std::string program = "skybark";
    char* arguments[] = {program.data(), nullptr};
    int count = 1;
    testing::InitGoogleTest(&count, arguments);
    testing::GTEST_FLAG(filter) = filter;
    if (what.quiet) {
        auto& listeners = testing::UnitTest::GetInstance()->listeners();
        delete listeners.Release(listeners.default_result_printer());
        listeners.Append(new quiet_printer);
    }
    write_report(what.json);
    const int status = RUN_ALL_TESTS();
    if (testing::UnitTest::GetInstance()->test_to_run_count() == 0) {
        std::fprintf(stderr, "No case is called %s.\n", filter.c_str());
        return 1;
    }
    return status;
}

} // namespace skybark::conformance
