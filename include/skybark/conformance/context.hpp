#pragma once
// What a case of the conformance suite works with: a device, buffers between guards, comparisons.

#include <skybark/conformance/report.hpp>
#include <skybark/core/backend.hpp>

#include <cstring>
#include <functional>
#include <limits>
#include <random>

namespace skybark::conformance {

/// Ends a case after its failure has been noted.
struct case_stopped {};

/// A sentence about an error that a case did not expect.
[[nodiscard]] inline std::string unexpected_error(std::string_view doing, const error& e) {
    return std::string(doing) + " failed: " + std::string(to_string(e.code)) + ": " + e.message;
}

/// Compares values one by one, and says at its end what differed.
class comparison {
  public:
    explicit comparison(report about) : report_(std::move(about)) {}
    comparison(const comparison&) = delete;
    comparison& operator=(const comparison&) = delete;
    ~comparison() {
        if (report_.mismatches != 0) {
            ADD_FAILURE() << to_text(report_);
            current_session().pending.push_back(report_);
        }
    }

    /// actual in [low, high]; where low is NaN, actual must be NaN as well.
    void within(double actual, double low, double high) {
        const bool right = low != low ? actual != actual : actual >= low && actual <= high;
        if (!right) {
            note({report_.compared, low, high, actual});
        }
        ++report_.compared;
    }
    void close_to(double actual, double expected, double tolerance) {
        within(actual, expected - tolerance, expected + tolerance);
    }
    void close_to(const glm::vec4& actual, const glm::vec4& expected, double tolerance) {
        for (int i = 0; i < 4; ++i) {
            close_to(double{actual[i]}, double{expected[i]}, tolerance);
        }
    }
    void same(double actual, double expected) { within(actual, expected, expected); }
    void same(const glm::vec4& actual, const glm::vec4& expected) { close_to(actual, expected, 0); }

  private:
    void note(const mismatch& m) {
        const auto distance = [](const mismatch& x) {
            const double d = std::fmax(x.low - x.actual, x.actual - x.high);
            return d == d ? d : std::numeric_limits<double>::infinity();
        };
        if (report_.mismatches++ == 0) {
            report_.first = m;
            report_.worst = m;
        } else if (distance(m) > distance(report_.worst)) {
            report_.worst = m;
        }
    }

    report report_;
};

/// A buffer with guard bytes on both sides of the records that a case uses.
template <backend B>
struct guarded {
    typename B::buffer buffer;
    std::uint64_t before = 0;
    std::uint64_t size = 0;
    std::uint64_t after = 0;

    [[nodiscard]] buffer_view<B> view() const { return {&buffer, before, size}; }
    /// The first `bytes` of it.
    [[nodiscard]] buffer_view<B> view(std::uint64_t bytes) const {
        return {&buffer, before, bytes};
    }
};

inline constexpr std::byte guard_byte{0xa5};

/// A device and everything that a case does with it. Whatever fails ends the case.
template <backend B>
class context {
  public:
    context(B& on, std::string backend_name, std::string test, std::uint32_t seed)
        : device(on), random(seed), about_{std::move(backend_name),
                                           std::string(on.device_name()),
                                           std::move(test),
                                           "",
                                           seed,
                                           0,
                                           0,
                                           {},
                                           {}} {}

    B& device;
    std::mt19937 random;

    [[nodiscard]] comparison compare(std::string what) const {
        report r = about_;
        r.what = std::move(what);
        return comparison(std::move(r));
    }

    template <class T>
    [[nodiscard]] T need(result<T> value, std::string_view doing) const {
        if (!value) {
            stop(unexpected_error(doing, value.error()));
        }
        return std::move(*value);
    }
    void need(const result<void>& done, std::string_view doing) const {
        if (!done) {
            stop(unexpected_error(doing, done.error()));
        }
    }
    [[noreturn]] static void stop(const std::string& why) {
        ADD_FAILURE() << why;
        throw case_stopped{};
    }

    /// Room for `count` records, filled with guard bytes inside and around.
    template <record T>
    [[nodiscard]] guarded<B> room(std::uint64_t count) const {
        const std::uint64_t margin = std::max<std::uint64_t>(256, device.limits().view_alignment);
        guarded<B> g{need(device.create_buffer(2 * margin + count * sizeof(T)), "create_buffer"),
                     margin, count * sizeof(T), margin};
        const std::vector<std::byte> fill(2 * margin + g.size, guard_byte);
        need(device.upload(g.buffer, 0, fill), "upload of guard bytes");
        return g;
    }
    /// A guarded copy of the records.
    template <record T>
    [[nodiscard]] guarded<B> put(const std::vector<T>& records) const {
        guarded<B> g = room<T>(records.size());
        if (!records.empty()) {
            need(device.upload(g.buffer, g.before, std::as_bytes(std::span(records))), "upload");
        }
        return g;
    }
    /// All records of a guarded buffer, whose guards must be as they were.
    template <record T>
    [[nodiscard]] std::vector<T> get(const guarded<B>& g) const {
        const std::uint64_t total = g.before + g.size + g.after;
        std::vector<std::byte> all(total);
        need(device.download(g.buffer, 0, all), "download");
        comparison guards = compare("guard bytes");
        for (std::uint64_t i = 0; i < total; ++i) {
            if (i < g.before || i >= g.before + g.size) {
                guards.same(std::to_integer<int>(all[i]), std::to_integer<int>(guard_byte));
            }
        }
        std::vector<T> records(g.size / sizeof(T));
        if (!records.empty()) {
            std::memcpy(records.data(), all.data() + g.before, records.size() * sizeof(T));
        }
        return records;
    }

    [[nodiscard]] guarded<B> put_count(std::uint32_t written) const {
        return put(std::vector<count_record>{{written, written, {0, 0}}});
    }
    void expect_count(const guarded<B>& at, std::uint64_t written, std::uint64_t required) const {
        const count_record count = get<count_record>(at)[0];
        comparison counts = compare("counts (written, required)");
        counts.same(count.written, static_cast<double>(written));
        counts.same(count.required, static_cast<double>(required));
    }

    /// Records, submits and waits.
    template <class Record>
    void run(Record&& record) const {
        need(skybark::run(device, std::forward<Record>(record)), "submit");
    }
    [[nodiscard]] typename B::recorder begin() const { return need(device.begin(), "begin"); }
    void submit(typename B::recorder& recorder) const { need(device.submit(recorder), "submit"); }

    /// A small random integer as a float: sums and products of these are exact.
    [[nodiscard]] float small_number() {
        return static_cast<float>(static_cast<int>(random() % 2001) - 1000);
    }
    [[nodiscard]] glm::vec4 small_vector() {
        return {small_number(), small_number(), small_number(), small_number()};
    }
    /// 0 … limit − 1.
    [[nodiscard]] std::uint32_t below(std::uint32_t limit) {
        return static_cast<std::uint32_t>(random() % limit);
    }

  private:
    report about_;
};

/// A named case. Which ones there are is decided by the concepts that the backend models: what it
/// cannot do isn't there.
template <backend B>
struct suite_case {
    std::string pattern; ///< "map"
    std::string name;    ///< "range_limit"
    std::function<void(context<B>&)> body;
};

template <backend B>
using cases = std::vector<suite_case<B>>;

/// A size to try, by name.
struct named_size {
    const char* name;
    std::uint32_t size;
};

/// Nothing, one, and the edges of a workgroup, of a block of a scan, and of its second level.
inline constexpr named_size edge_sizes[] = {{"empty", 0},
                                            {"one", 1},
                                            {"limit_minus_1", 63},
                                            {"limit", 64},
                                            {"limit_plus_1", 65},
                                            {"block_minus_1", 255},
                                            {"block", 256},
                                            {"block_plus_1", 257},
                                            {"scan_minus_1", 65535},
                                            {"scan", 65536},
                                            {"scan_plus_1", 65537}};

} // namespace skybark::conformance
