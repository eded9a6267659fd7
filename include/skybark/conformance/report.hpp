#pragma once
// What the conformance suite has to say about a backend: to a person as a sentence, to a program as
// JSON.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace skybark::conformance {

/// A value that isn't where it should be.
struct mismatch {
    std::uint64_t index = 0; ///< which value of the result, from 0
    double low = 0;          ///< the expected interval
    double high = 0;
    double actual = 0;
};

/// All that differs in one comparison of one case.
struct report {
    std::string backend;
    std::string device;
    std::string test; ///< "map.range_limit"
    std::string what; ///< "numbers"
    std::uint32_t seed = 0;
    std::uint64_t compared = 0;
    std::uint64_t mismatches = 0;
    mismatch first;
    mismatch worst;
};

[[nodiscard]] inline std::string to_text(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
}

[[nodiscard]] inline std::string to_text(const mismatch& m) {
    return "value " + std::to_string(m.index) + " is " + to_text(m.actual) + " and should be " +
           (m.low == m.high || m.low != m.low ? to_text(m.low)
                                              : to_text(m.low) + " to " + to_text(m.high));
}

/// How to run one case again.
[[nodiscard]] inline std::string how_to_repeat(const report& r) {
    return "--gtest_filter=" + r.backend + "/" + r.test;
}

[[nodiscard]] inline std::string to_text(const report& r) {
    return std::to_string(r.mismatches) + " of " + std::to_string(r.compared) + " " + r.what +
           " differ on " + r.backend + " (" + r.device + "), seed " + std::to_string(r.seed) +
           ". First: " + to_text(r.first) + ". Worst: " + to_text(r.worst) +
           ". To repeat it: " + how_to_repeat(r);
}

/// What one case came to.
struct case_result {
    std::string name;   ///< "cpu/map.range_limit"
    std::string status; ///< "passed", "failed" or "skipped"
    std::string message;
    double seconds = 0;
    std::vector<report> reports;
};

/// Collects what the cases say while GoogleTest runs them.
class session {
  public:
    std::vector<case_result> results;
    std::vector<report> pending; ///< of the case that is running

    [[nodiscard]] std::size_t count(std::string_view status) const {
        std::size_t n = 0;
        for (const case_result& r : results) {
            n += r.status == status ? 1u : 0u;
        }
        return n;
    }
};

/// The session of this process, as GoogleTest's registry is one for the process.
[[nodiscard]] inline session& current_session() {
    static session only;
    return only;
}

[[nodiscard]] inline std::string json_string(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            out += '\\';
            out += c;
        } else if (static_cast<unsigned char>(c) < 0x20) {
            char escaped[8];
            std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
            out += escaped;
        } else {
            out += c;
        }
    }
    return out + "\"";
}

/// JSON has no NaN and no infinity: they become strings.
[[nodiscard]] inline std::string json_number(double value) {
    return std::isfinite(value) ? to_text(value) : json_string(to_text(value));
}

[[nodiscard]] inline std::string to_json(const mismatch& m) {
    return "{\"index\":" + std::to_string(m.index) + ",\"expected\":[" + json_number(m.low) + "," +
           json_number(m.high) + "],\"actual\":" + json_number(m.actual) + "}";
}

[[nodiscard]] inline std::string to_json(const report& r) {
    return "{\"backend\":" + json_string(r.backend) + ",\"device\":" + json_string(r.device) +
           ",\"what\":" + json_string(r.what) + ",\"seed\":" + std::to_string(r.seed) +
           ",\"compared\":" + std::to_string(r.compared) +
           ",\"mismatches\":" + std::to_string(r.mismatches) + ",\"first\":" + to_json(r.first) +
           ",\"worst\":" + to_json(r.worst) + ",\"repeat\":" + json_string(how_to_repeat(r)) + "}";
}

[[nodiscard]] inline std::string to_json(const session& s) {
    std::string out = "{\"passed\":" + std::to_string(s.count("passed")) +
                      ",\"failed\":" + std::to_string(s.count("failed")) +
                      ",\"skipped\":" + std::to_string(s.count("skipped")) + ",\"cases\":[";
    const char* comma = "\n";
    for (const case_result& c : s.results) {
        out += comma;
        out += "{\"name\":" + json_string(c.name) + ",\"status\":" + json_string(c.status) +
               ",\"message\":" + json_string(c.message) + ",\"seconds\":" + json_number(c.seconds);
        if (!c.reports.empty()) {
            out += ",\"reports\":[";
            for (std::size_t i = 0; i < c.reports.size(); ++i) {
                out += i == 0 ? "" : ",";
                out += to_json(c.reports[i]);
            }
            out += "]";
        }
        out += "}";
        comma = ",\n";
    }
    return out + "\n]}\n";
}

/// Fills a session from GoogleTest's events, and writes the file when all is done.
class report_listener : public testing::EmptyTestEventListener {
  public:
    explicit report_listener(std::string path) : path_(std::move(path)) {}

    void OnTestStart(const testing::TestInfo&) override { current_session().pending.clear(); }
    void OnTestEnd(const testing::TestInfo& info) override {
        const testing::TestResult& result = *info.result();
        case_result c;
        c.name = std::string(info.test_suite_name()) + "." + info.name();
        c.status = result.Skipped() ? "skipped" : result.Passed() ? "passed" : "failed";
        c.seconds = static_cast<double>(result.elapsed_time()) / 1000;
        for (int i = 0; i < result.total_part_count(); ++i) {
            c.message += (i == 0 ? "" : "\n") + std::string(result.GetTestPartResult(i).message());
        }
        c.reports = std::exchange(current_session().pending, {});
        current_session().results.push_back(std::move(c));
    }
    void OnTestProgramEnd(const testing::UnitTest&) override {
        if (path_.empty()) {
            return;
        }
        const std::string text = to_json(current_session());
        std::FILE* file = std::fopen(path_.c_str(), "wb");
        const bool written =
            file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
        if (file == nullptr || std::fclose(file) != 0 || !written) {
            std::fprintf(stderr, "The report %s could not be written.\n", path_.c_str());
        }
    }

  private:
    std::string path_;
};

/// Writes what the cases came to as JSON to `path` when GoogleTest has run them.
inline void write_report(std::string path) {
    testing::UnitTest::GetInstance()->listeners().Append(new report_listener(std::move(path)));
}

} // namespace skybark::conformance
