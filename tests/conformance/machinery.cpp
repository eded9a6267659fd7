// What the suite says about itself: reports, expected failures, backends that aren't there.

#include "run_cases.hpp"

#include "../../examples/02_own_backend.hpp"

#include <cstdlib>

namespace {

using namespace skybark;
using namespace skybark::conformance;

TEST(machinery, globs) {
    EXPECT_TRUE(matches_glob("expand.compact_one", "*"));
    EXPECT_TRUE(matches_glob("expand.compact_one", "expand.*_one"));
    EXPECT_TRUE(matches_glob("expand.compact_one", "expand.compact_on?"));
    EXPECT_FALSE(matches_glob("expand.compact_one", "expand"));
    EXPECT_FALSE(matches_glob("expand.compact_one", "map.*"));
    EXPECT_TRUE(matches_glob("", "*"));
    EXPECT_FALSE(matches_glob("", "?"));
}

TEST(machinery, required_backends) {
    EXPECT_TRUE(lists_name("cpu,opengl", "opengl"));
    EXPECT_FALSE(lists_name("cpu,opengl", "open"));
    EXPECT_FALSE(lists_name("", "cpu"));
    EXPECT_FALSE(lists_name(",", "cpu"));
}

/// What a test that runs `body` would have said.
template <class Body>
[[nodiscard]] std::vector<std::string> failures_of(Body&& body) {
    testing::TestPartResultArray parts;
    {
        const testing::ScopedFakeTestPartResultReporter catching(
            testing::ScopedFakeTestPartResultReporter::INTERCEPT_ALL_THREADS, &parts);
        body();
    }
    std::vector<std::string> said;
    for (int i = 0; i < parts.size(); ++i) {
        said.emplace_back((parts.GetTestPartResult(i).skipped() ? "skipped: " : "failed: ") +
                          std::string(parts.GetTestPartResult(i).message()));
    }
    current_session().pending.clear();
    return said;
}

TEST(machinery, a_comparison_says_first_and_worst) {
    own::device device;
    context<own::device> c(device, "own", "map.example", 7);
    const auto said = failures_of([&] {
        comparison check = c.compare("numbers");
        check.same(1, 1);
        check.close_to(2.5, 2, 0.25);
        check.same(10, 3);
        check.same(std::nan(""), std::nan(""));
    });
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(
        said[0],
        "failed: Failed\n2 of 4 numbers differ on own (one thread), seed 7. First: value 1 is "
        "2.5 and should be 1.75 to 2.25. Worst: value 2 is 10 and should be 3. To repeat it: "
        "--gtest_filter=own/map.example");
}

TEST(machinery, nan_is_never_near_a_number) {
    own::device device;
    context<own::device> c(device, "own", "map.example", 7);
    EXPECT_EQ(failures_of([&] { c.compare("numbers").same(std::nan(""), 1); }).size(), 1u);
    EXPECT_EQ(failures_of([&] { c.compare("numbers").same(1, std::nan("")); }).size(), 1u);
}

const suite_case<own::device> good{"map", "good", [](context<own::device>&) {}};
const suite_case<own::device> bad{"map", "bad",
                                  [](context<own::device>& c) { c.compare("numbers").same(1, 2); }};

[[nodiscard]] std::vector<std::string> run_one(const suite_case<own::device>& which,
                                               std::vector<expected_failure> expected) {
    suite_options<own::device> with;
    with.expected_failures = std::move(expected);
    subject<own::device> on(
        "own",
        []() -> result<std::shared_ptr<own::device>> { return std::make_shared<own::device>(); },
        with);
    return failures_of([&] { on.run(which); });
}

TEST(machinery, expected_failures) {
    EXPECT_TRUE(run_one(good, {}).empty());
    EXPECT_EQ(run_one(bad, {}).size(), 1u);

    const auto skipped = run_one(bad, {{"map.*", "*", "numbers differ", "The driver can't."}});
    ASSERT_EQ(skipped.size(), 1u);
    EXPECT_NE(skipped[0].find("skipped: "), std::string::npos);
    EXPECT_NE(skipped[0].find("The driver can't."), std::string::npos);

    const auto passes = run_one(good, {{"map.good", "one*", ".*", "The driver can't."}});
    ASSERT_EQ(passes.size(), 1u);
    EXPECT_NE(passes[0].find("failed: "), std::string::npos);
    EXPECT_NE(passes[0].find("It passes"), std::string::npos);

    const auto otherwise = run_one(bad, {{"map.bad", "*", "colours differ", "The driver can't."}});
    ASSERT_FALSE(otherwise.empty());
    EXPECT_NE(otherwise[0].find("and not so"), std::string::npos);

    const auto another_device = run_one(bad, {{"map.bad", "two*", ".*", "The driver can't."}});
    ASSERT_EQ(another_device.size(), 1u);
    EXPECT_NE(another_device[0].find("failed: "), std::string::npos);
}

[[nodiscard]] std::vector<std::string> run_without(error_code why) {
    subject<own::device> on(
        "imaginary",
        [why]() -> result<std::shared_ptr<own::device>> { return fail(why, "There is none."); },
        {});
    return failures_of([&] { on.run(good); });
}

TEST(machinery, a_backend_that_is_not_there) {
    const char* before = std::getenv("SKYBARK_REQUIRE_BACKENDS");
    const std::string kept = before != nullptr ? before : "";
    setenv("SKYBARK_REQUIRE_BACKENDS", "cpu", 1);
    const auto skipped = run_without(error_code::unavailable);
    ASSERT_EQ(skipped.size(), 1u);
    EXPECT_NE(skipped[0].find("skipped: "), std::string::npos);
    EXPECT_NE(skipped[0].find("imaginary can't be used: There is none."), std::string::npos);
    EXPECT_NE(run_without(error_code::device_lost)[0].find("failed: "), std::string::npos);
    setenv("SKYBARK_REQUIRE_BACKENDS", "cpu,imaginary", 1);
    EXPECT_NE(run_without(error_code::unavailable)[0].find("failed: "), std::string::npos);
    if (before != nullptr) {
        setenv("SKYBARK_REQUIRE_BACKENDS", kept.c_str(), 1);
    } else {
        unsetenv("SKYBARK_REQUIRE_BACKENDS");
    }
}

TEST(machinery, json) {
    session s;
    s.results.push_back({"cpu/map.one", "passed", "", 0.25, {}});
    report r;
    r.backend = "cpu";
    r.device = "a \"quoted\"\nname";
    r.test = "map.two";
    r.what = "numbers";
    r.first = r.worst = {3, 1, 2, std::nan("")};
    s.results.push_back({"cpu/map.two", "failed", "why", 1, {r}});
    EXPECT_EQ(to_json(s),
              R"({"passed":1,"failed":1,"skipped":0,"cases":[
{"name":"cpu/map.one","status":"passed","message":"","seconds":0.25},
{"name":"cpu/map.two","status":"failed","message":"why","seconds":1,"reports":[{"backend":"cpu",)"
              R"("device":"a \"quoted\"\u000aname","what":"numbers","seed":0,"compared":0,)"
              R"("mismatches":0,"first":{"index":3,"expected":[1,2],"actual":"nan"},)"
              R"("worst":{"index":3,"expected":[1,2],"actual":"nan"},)"
              R"("repeat":"--gtest_filter=cpu/map.two"}]}
]}
)");
}

TEST(machinery, cases_are_gated_by_what_a_backend_models) {
    const auto all = all_cases<own::device>();
    EXPECT_GT(all.size(), 440u);
    std::map<std::string, int> seen;
    for (const auto& c : all) {
        EXPECT_EQ(++seen[c.pattern + "." + c.name], 1) << c.pattern << '.' << c.name;
    }
}

} // namespace
