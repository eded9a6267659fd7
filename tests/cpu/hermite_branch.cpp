// The vectorised branch kernel against the plain one, bit for bit.

#include "support/cpu_work.hpp"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>

using namespace skybark;
using kernels::branch_frame;
using kernels::hermite_branch;

namespace {

struct input {
    std::vector<branch_end> ends;
    std::vector<branch_segment> segments;
};

branch_end random_end(support::random_source& random) {
    branch_end e;
    e.position = glm::vec3(random.direction() * random.between(0, 5));
    e.radius = static_cast<float>(random.between(0, 1));
    e.orientation = glm::vec4(random.rotation(6.2)); // either sign of w
    e.path = static_cast<float>(random.between(0, 9));
    e.slope = static_cast<float>(random.between(-2, 2));
    return e;
}

/// Ends out of order and used by several segments each.
input random_input(support::random_source& random, std::uint32_t count) {
    input in;
    for (std::uint32_t i = 0; i < count + 3; ++i) {
        in.ends.push_back(random_end(random));
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        in.segments.push_back({random.below(count + 3), random.below(count + 3), 0, 0});
    }
    return in;
}

std::vector<surface_vertex> by_plain_kernel(const hermite_branch& kernel, const input& in) {
    std::vector<surface_vertex> made;
    const auto corners = kernels::unit_polygon(kernel.sides);
    const auto sink = [&](const surface_vertex& v) { made.push_back(v); };
    for (std::uint32_t i = 0; i < in.segments.size(); ++i) {
        kernel.ring(i, 0, kernel.ring_vertices(), sink, in.segments, in.ends, corners);
    }
    return made;
}

std::vector<surface_vertex> by_device(cpu::device& device, const hermite_branch& kernel,
                                      const input& in) {
    using B = cpu::device;
    const auto count = static_cast<std::uint32_t>(in.segments.size());
    const auto segments =
        support::expect_value(make_buffer<B, branch_segment>(device, in.segments));
    const auto ends = support::expect_value(make_buffer<B, branch_end>(device, in.ends));
    const auto corners = support::expect_value(
        make_buffer<B, glm::vec4>(device, kernels::unit_polygon(kernel.sides)));
    std::vector<surface_vertex> made(std::size_t{count} * kernel.ring_vertices());
    const auto out =
        support::expect_value(device.create_buffer(made.size() * sizeof(surface_vertex)));
    auto r = support::expect_value(device.begin());
    r.expand_rings(kernel, {view<B>(segments), view<B>(ends), view<B>(corners)}, range{0, count},
                   view<B>(out));
    EXPECT_TRUE(device.submit(r));
    EXPECT_TRUE((read_back<B, surface_vertex>(device, out, made)));
    return made;
}

/// Equal bits, or both not a number: which of an operation's two NaNs goes on is the compiler's
/// choice.
bool same(float a, float b) {
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

void expect_same(const hermite_branch& kernel, const input& in) {
    cpu::device_options options;
    options.threads = 1;
    cpu::device device(options);
    const auto plain = by_plain_kernel(kernel, in);
    const auto vectorised = by_device(device, kernel, in);
    ASSERT_EQ(plain.size(), vectorised.size());
    for (std::size_t i = 0; i < plain.size(); ++i) {
        float a[12], b[12];
        std::memcpy(a, &plain[i], sizeof a);
        std::memcpy(b, &vectorised[i], sizeof b);
        for (int k = 0; k < 12; ++k) {
            ASSERT_TRUE(same(a[k], b[k]))
                << "vertex " << i << ", float " << k << ": " << a[k] << " and " << b[k]
                << "; sides " << kernel.sides << ", rings " << kernel.rings << ", count "
                << in.segments.size();
        }
    }
}

constexpr branch_frame both_frames[] = {branch_frame::slerp, branch_frame::rotation_minimising};

} // namespace

TEST(cpu_hermite_branch, equals_the_plain_kernel) {
    support::random_source random(1);
    for (const branch_frame frame : both_frames) {
        for (const std::uint32_t sides : {3u, 8u, 17u}) {
            for (const std::uint32_t rings : {2u, 4u, 9u, 16u, 17u, 40u}) {
                for (std::uint32_t count = 1; count <= 9; ++count) {
                    expect_same({sides, rings, frame}, random_input(random, count));
                }
            }
        }
    }
}

TEST(cpu_hermite_branch, equals_the_plain_kernel_over_many_pieces) {
    support::random_source random(2);
    expect_same({8, 4, branch_frame::slerp}, random_input(random, 64 * 300 + 3));
}

TEST(cpu_hermite_branch, equals_the_plain_kernel_on_degenerate_input) {
    support::random_source random(3);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const glm::vec4 turn(random.rotation(3));
    const glm::vec4 near_turn = turn + glm::vec4(1e-4f, -1e-4f, 0, 1e-5f);
    const glm::vec4 orientations[] = {
        {0, 0, 0, 1},   {0, 0, 0, -1},        {1, 0, 0, 0},       turn,         -turn,
        near_turn,      -near_turn,           {0, 0, 0, 0},       turn * 1e-3f, turn * 1e20f,
        {nan, 0, 0, 1}, {nan, nan, nan, nan}, {infinity, 0, 0, 0}};
    const glm::vec3 positions[] = {
        {0, 0, 0},     {1, 2, 3},        {1e-20f, 0, 0},       {nan, 0, 0},
        {1e30f, 0, 0}, {infinity, 0, 0}, {-0.0f, -0.0f, -0.0f}};
    input in;
    for (const glm::vec4& q : orientations) {
        for (const glm::vec3& p : positions) {
            for (const float radius : {0.5f, 0.0f, -1.0f, nan}) {
                branch_end e = random_end(random);
                e.position = p;
                e.orientation = q;
                e.radius = radius;
                in.ends.push_back(e);
            }
        }
    }
    const auto n = static_cast<std::uint32_t>(in.ends.size());
    for (std::uint32_t i = 0; i < 6000; ++i) {
        in.segments.push_back({random.below(n), random.below(n), 0, 0});
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        in.segments.push_back({i, i, 0, 0});
    }
    expect_same({5, 4, branch_frame::slerp}, in);
}
