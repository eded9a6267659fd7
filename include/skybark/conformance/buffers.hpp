#pragma once
// Cases: buffers, and what a recorder does with their bytes.

#include <skybark/conformance/context.hpp>

#include <numeric>

namespace skybark::conformance {

[[nodiscard]] inline std::vector<std::uint32_t> counting(std::size_t count, std::uint32_t first) {
    std::vector<std::uint32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), first);
    return numbers;
}

template <backend B>
void expect_numbers(const context<B>& c, const guarded<B>& at,
                    const std::vector<std::uint32_t>& expected, const char* what = "numbers") {
    const auto actual = c.template get<std::uint32_t>(at);
    comparison numbers = c.compare(what);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        numbers.same(actual[i], expected[i]);
    }
}

template <backend B>
void new_buffer_holds_zeros(context<B>& c) {
    for (const std::uint64_t size : {4u, 100u, 65536u, 1000004u}) {
        const auto buffer = c.need(c.device.create_buffer(size), "create_buffer");
        std::vector<std::byte> bytes(size, guard_byte);
        c.need(c.device.download(buffer, 0, bytes), "download");
        comparison zeros = c.compare("bytes of a new buffer");
        zeros.same(static_cast<double>(buffer.size_bytes()), static_cast<double>(size));
        for (const std::byte byte : bytes) {
            zeros.same(std::to_integer<int>(byte), 0);
        }
    }
}

template <backend B>
void upload_part_of_a_buffer(context<B>& c) {
    auto g = c.put(counting(100, 0));
    const auto middle = counting(10, 1000);
    c.need(c.device.upload(g.buffer, g.before + 40 * 4, std::as_bytes(std::span(middle))),
           "upload");
    auto expected = counting(100, 0);
    std::copy(middle.begin(), middle.end(), expected.begin() + 40);
    expect_numbers(c, g, expected);
    std::vector<std::uint32_t> part(5);
    c.need(c.device.download(g.buffer, g.before + 38 * 4, std::as_writable_bytes(std::span(part))),
           "download");
    comparison numbers = c.compare("numbers of a part");
    for (std::size_t i = 0; i < part.size(); ++i) {
        numbers.same(part[i], expected[38 + i]);
    }
}

template <backend B>
void traffic_is_counted(context<B>& c) {
    const auto before = c.device.traffic();
    const auto buffer = c.need(c.device.create_buffer(1024), "create_buffer");
    std::vector<std::byte> bytes(1000);
    c.need(c.device.upload(buffer, 0, bytes), "upload");
    c.need(c.device.download(buffer, 0, std::span(bytes).first(300)), "download");
    const auto between = c.device.traffic();
    c.run([&](auto& r) { r.upload(buffer_view<B>{&buffer, 0, 512}, std::span(bytes).first(512)); });
    const auto after = c.device.traffic();
    comparison traffic = c.compare("bytes of traffic (up, down, up in the stream)");
    traffic.same(static_cast<double>(between.up - before.up), 1000);
    traffic.same(static_cast<double>(between.down - before.down), 300);
    traffic.same(static_cast<double>(after.up - between.up), 512);
}

/// What is uploaded is copied when called; two uploads of one view do not overtake a copy between.
template <backend B>
void upload_in_the_stream(context<B>& c) {
    const auto shared = c.template room<std::uint32_t>(300);
    const auto first = c.template room<std::uint32_t>(300);
    const auto second = c.template room<std::uint32_t>(300);
    c.run([&](auto& r) {
        auto numbers = counting(300, 7);
        r.upload(shared.view(), std::as_bytes(std::span(numbers)));
        r.copy(shared.view(), first.view());
        numbers = counting(300, 5000);
        r.upload(shared.view(), std::as_bytes(std::span(numbers)));
        r.copy(shared.view(), second.view());
        numbers.assign(300, 0);
    });
    expect_numbers(c, first, counting(300, 7), "numbers of the first copy");
    expect_numbers(c, second, counting(300, 5000), "numbers of the second copy");
}

template <backend B>
void large_upload_in_the_stream(context<B>& c) {
    const auto numbers = counting(100000, 1); // more than vkCmdUpdateBuffer's 65,536 bytes
    const auto to = c.template room<std::uint32_t>(numbers.size());
    c.run([&](auto& r) { r.upload(to.view(), std::as_bytes(std::span(numbers))); });
    expect_numbers(c, to, numbers);
}

template <backend B>
void copy_within_a_buffer(context<B>& c) {
    const std::uint64_t align = std::max<std::uint64_t>(c.device.limits().view_alignment, 256);
    const auto count = static_cast<std::uint32_t>(align / 4);
    const auto g = c.put(counting(2 * count, 3));
    c.run([&](auto& r) {
        r.copy({&g.buffer, g.before, align}, {&g.buffer, g.before + align, align});
    });
    auto expected = counting(2 * count, 3);
    std::copy_n(expected.begin(), count, expected.begin() + count);
    expect_numbers(c, g, expected);
}

template <backend B>
void empty_recorder(context<B>& c) {
    c.run([](auto&) {});
    const auto none = c.need(c.device.create_buffer(0), "create_buffer of no bytes");
    comparison sizes = c.compare("bytes of an empty buffer");
    sizes.same(static_cast<double>(none.size_bytes()), 0);
}

/// Two streams recorded turn by turn do not mix. (Work of one that another one in the making waits
/// for is not asked: a backend may run it when it is recorded or when it is submitted.)
template <backend B>
void two_recorders_interleaved(context<B>& c) {
    const auto a = c.put(counting(100, 1));
    const auto b = c.put(counting(100, 1000));
    const auto a1 = c.template room<std::uint32_t>(100);
    const auto a2 = c.template room<std::uint32_t>(100);
    const auto b1 = c.template room<std::uint32_t>(100);
    const auto b2 = c.template room<std::uint32_t>(100);
    auto first = c.begin();
    auto second = c.begin();
    second.copy(b.view(), b1.view());
    first.copy(a.view(), a1.view());
    second.copy(b1.view(), b2.view());
    first.copy(a1.view(), a2.view());
    c.submit(second);
    c.submit(first);
    expect_numbers(c, a2, counting(100, 1), "numbers of the first recorder");
    expect_numbers(c, b2, counting(100, 1000), "numbers of the second recorder");
}

template <backend B>
void recorder_moves(context<B>& c) {
    const auto a = c.put(counting(10, 1));
    const auto to = c.template room<std::uint32_t>(10);
    auto first = c.begin();
    first.copy(a.view(), to.view());
    auto second = std::move(first);
    c.submit(second);
    expect_numbers(c, to, counting(10, 1));
}

template <backend B>
void limits_are_usable(context<B>& c) {
    const device_limits limits = c.device.limits();
    comparison sane = c.compare("limits");
    constexpr double most = 1e30;
    sane.within(static_cast<double>(limits.max_buffer_bytes), 1 << 20, most);
    sane.within(static_cast<double>(limits.max_elements), 1 << 16, most);
    sane.within(static_cast<double>(limits.view_alignment), 4, 4096);
    sane.same(std::fmod(static_cast<double>(limits.view_alignment), 4), 0);
    sane.within(limits.max_image_size, 1024, most);
    EXPECT_FALSE(std::string(c.device.device_name()).empty())
        << "A report needs the device's name.";
}

template <backend B>
void add_buffer_cases(cases<B>& to) {
    to.push_back({"buffers", "new_buffer_holds_zeros", new_buffer_holds_zeros<B>});
    to.push_back({"buffers", "upload_part", upload_part_of_a_buffer<B>});
    to.push_back({"buffers", "traffic", traffic_is_counted<B>});
    to.push_back({"buffers", "upload_in_the_stream", upload_in_the_stream<B>});
    to.push_back({"buffers", "large_upload_in_the_stream", large_upload_in_the_stream<B>});
    to.push_back({"buffers", "copy_within", copy_within_a_buffer<B>});
    to.push_back({"buffers", "empty_recorder", empty_recorder<B>});
    to.push_back({"buffers", "two_recorders", two_recorders_interleaved<B>});
    to.push_back({"buffers", "recorder_moves", recorder_moves<B>});
    to.push_back({"buffers", "limits", limits_are_usable<B>});
}

} // namespace skybark::conformance
