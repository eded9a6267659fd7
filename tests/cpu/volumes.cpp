// The CPU backend's volumes: what they hold, how they are summed, and how kernels read them.

#include "support/cpu_work.hpp"

#include <skybark/core/validated.hpp>
#include <skybark/kernels/probe_slabs.hpp>
#include <skybark/kernels/probe_voxels.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using support::expect_value;

namespace {

using device = cpu::device;

static_assert(volume_backend<device>);
static_assert(fuses_accumulate_scan<device, kernels::probe_slabs>);

device with_threads(std::uint32_t threads) {
    cpu::device_options options;
    options.threads = threads;
    return device(options);
}

/// A volume with these voxels in it.
template <class T>
cpu::volume put(device& on, volume_description what, const std::vector<T>& voxels) {
    auto made = expect_value(on.create_volume(what));
    EXPECT_EQ(made.size_bytes(), voxels.size() * sizeof(T));
    EXPECT_TRUE(on.upload(made, std::as_bytes(std::span(voxels))));
    return made;
}
template <class T>
std::vector<T> voxels_of(device& on, const cpu::volume& from) {
    std::vector<T> voxels(from.size_bytes() / sizeof(T));
    EXPECT_TRUE(on.download(from, std::as_writable_bytes(std::span(voxels))));
    return voxels;
}

// ---------------------------------------------------------------------------------------- memory

TEST(volumes, keep_their_bytes_and_count_them) {
    device d;
    std::vector<std::int32_t> voxels(3 * 5 * 7);
    std::iota(voxels.begin(), voxels.end(), -50);
    const auto v = put(d, {3, 5, 7, volume_format::int32}, voxels);
    EXPECT_EQ(v.description().height, 5u);
    EXPECT_EQ(voxels_of<std::int32_t>(d, v), voxels);
    EXPECT_EQ(d.traffic().up, 420u);
    EXPECT_EQ(d.traffic().down, 420u);
    EXPECT_EQ(expect_value(d.create_volume({3, 5, 7, volume_format::float16})).size_bytes(), 210u);
}

TEST(volumes, too_large_ones_are_errors) {
    device d;
    const auto sentence = [&](volume_description what) {
        const auto made = d.create_volume(what);
        EXPECT_FALSE(made);
        EXPECT_EQ(made.error().code, error_code::out_of_memory);
        return made.error().message;
    };
    EXPECT_EQ(sentence({4097, 1, 1, volume_format::int32}),
              "The cpu backend cannot make a volume of 4097 x 1 x 1 voxels; each side must be 1 to "
              "4096.");
    EXPECT_EQ(sentence({16, 0, 16, volume_format::int32}),
              "The cpu backend cannot make a volume of 16 x 0 x 16 voxels; each side must be 1 to "
              "4096.");
    if (cpu::detail::memory_of_machine() < std::uint64_t{1} << 38) {
        EXPECT_EQ(sentence({4096, 4096, 4096, volume_format::float32}),
                  "The cpu backend could not allocate a volume of 4096 x 4096 x 4096 voxels, "
                  "274877906944 bytes.");
    }
}

TEST(volumes, callers_memory_can_be_one) {
    device d;
    alignas(16) std::int32_t words[4 + 24 + 4];
    std::fill(std::begin(words), std::end(words), 7);
    const auto memory = std::as_writable_bytes(std::span(words));
    const auto v = cpu::volume::wrap(memory.subspan(16, 96), {2, 3, 4, volume_format::int32});
    const auto boxes =
        expect_value(make_buffer<device, kernels::probe_box>(d, {{{{0, 0, 0, 5}, {2, 3, 4, 0}}}}));
    ASSERT_TRUE(run(d, [&](auto& r) {
        r.accumulate(kernels::probe_slabs{4, 0, 0, 1}, {view<device>(boxes)}, range{0, 1},
                     {&v, true, {}, {}});
    }));
    EXPECT_EQ(words[3], 7);
    EXPECT_EQ(words[28], 7);
    // The slab of layer s is s voxels narrower on the left and lower at the top.
    const std::vector<std::int32_t> expected{5, 5, 5, 5, 5, 5, 0, 5, 0, 5, 0, 0,
                                             0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(std::vector<std::int32_t>(words + 4, words + 28), expected);
}

// ---------------------------------------------------------------------------------------- halves

/// The nearest half, by its definition: 11 bits, exponents −14 … 15, ties to even.
double nearest_half(double x) {
    if (x == 0) {
        return x;
    }
    if (std::abs(x) < 65520) {
        const double unit = std::max(std::ldexp(1.0, std::ilogb(x) - 10), std::ldexp(1.0, -24));
        return std::copysign(std::nearbyint(x / unit) * unit, x);
    }
    return std::copysign(std::numeric_limits<double>::infinity(), x);
}

TEST(halves, are_the_nearest_to_floats) {
    support::random_source random(3);
    const auto expect_nearest = [](float x) {
        const auto expected = static_cast<float>(nearest_half(static_cast<double>(x)));
        EXPECT_EQ(cpu::bits_of(cpu::to_float(cpu::to_half(x))), cpu::bits_of(expected)) << x;
    };
    for (int i = 0; i < 200'000; ++i) {
        expect_nearest(static_cast<float>(
            std::copysign(std::exp2(random.between(-30, 18)), random.between(-1, 1))));
    }
    for (const float x : {0.0f, -0.0f, 65519.996f, 65520.0f, 65504.0f, 1e30f, 0x1p-24f, 0x1p-25f,
                          0x1.000002p-25f, 0x3p-25f, 0x1p-14f, 0x1.ffcp-15f, 1.00048828125f,
                          1.00146484375f, std::numeric_limits<float>::infinity()}) {
        expect_nearest(x);
        expect_nearest(-x);
    }
    EXPECT_TRUE(std::isnan(cpu::to_float(cpu::to_half(std::nanf("")))));
}

TEST(halves, all_of_them_survive_as_floats) {
    for (std::uint32_t bits = 0; bits < 65536; ++bits) {
        const cpu::half h{static_cast<std::uint16_t>(bits)};
        const bool number = (bits & 0x7c00u) != 0x7c00u || (bits & 0x3ffu) == 0;
        EXPECT_TRUE(!number || cpu::to_half(cpu::to_float(h)).bits == bits) << bits;
    }
}

// ------------------------------------------------------------------------------------ accumulate

struct boxes_case {
    volume_description what;
    kernels::probe_slabs kernel;
    std::vector<kernels::probe_box> boxes;
};

/// Boxes of all sizes, many of them beyond the volume's sides.
boxes_case random_boxes(std::uint32_t count, volume_description what) {
    support::random_source random(11);
    boxes_case c{what, {6, 3, -5, 7}, {}};
    const auto around = [&](std::uint32_t side) {
        return static_cast<int>(random.below(side + 20)) - 10;
    };
    for (std::uint32_t i = 0; i < count; ++i) {
        kernels::probe_box box;
        box.low = {around(what.width), around(what.height), around(what.depth),
                   static_cast<int>(random.below(200)) - 100};
        box.high = box.low + glm::ivec4(random.below(12), random.below(12), random.below(9), 0);
        box.high.w = static_cast<int>(random.below(9)) - 4;
        c.boxes.push_back(box);
    }
    return c;
}

/// What is added, by the description of the kernel, one voxel after another.
std::vector<std::int32_t> sums_of(const boxes_case& c, std::size_t first, std::size_t count) {
    const int w = static_cast<int>(c.what.width);
    const int h = static_cast<int>(c.what.height);
    const int d = static_cast<int>(c.what.depth);
    std::vector<std::int32_t> sums(static_cast<std::size_t>(w * h * d));
    for (std::size_t i = first; i < first + count; ++i) {
        const auto& b = c.boxes[i];
        for (int s = 0; s < std::min(b.high.z - b.low.z, static_cast<int>(c.kernel.most)); ++s) {
            const int z = b.low.z + s;
            for (int y = b.low.y; y < b.high.y - s; ++y) {
                for (int x = b.low.x + s; x < b.high.x; ++x) {
                    if (x >= 0 && x < w && y >= 0 && y < h && z >= 0 && z < d) {
                        sums[static_cast<std::size_t>((z * h + y) * w + x)] +=
                            (b.low.w + c.kernel.per_x * x + c.kernel.per_z * z + b.high.w * y) *
                            c.kernel.factor;
                    }
                }
            }
        }
    }
    return sums;
}

TEST(accumulate, adds_every_box_where_it_is) {
    for (const std::uint32_t threads : {1u, 3u}) {
        device d = with_threads(threads);
        const boxes_case c = random_boxes(3000, {37, 29, 41, volume_format::int32});
        const auto boxes = expect_value(make_buffer<device, kernels::probe_box>(d, c.boxes));
        const auto v = expect_value(d.create_volume(c.what));
        std::fill_n(reinterpret_cast<std::int32_t*>(v.data()), 37 * 29 * 41, 99);
        const auto add = [&](range elements, bool clear) {
            ASSERT_TRUE(run(d, [&](auto& r) {
                r.accumulate(c.kernel, {view<device>(boxes)}, elements, {&v, clear, {}, {}});
            }));
        };
        add({500, 2500}, true);
        EXPECT_EQ(voxels_of<std::int32_t>(d, v), sums_of(c, 500, 2500));
        add({0, 500}, false);
        EXPECT_EQ(voxels_of<std::int32_t>(d, v), sums_of(c, 0, 3000));
        add({0, 0}, false);
        EXPECT_EQ(voxels_of<std::int32_t>(d, v), sums_of(c, 0, 3000));
        add({0, 0}, true);
        EXPECT_EQ(voxels_of<std::int32_t>(d, v), std::vector<std::int32_t>(37 * 29 * 41));
    }
}

TEST(accumulate, takes_a_length_of_the_devices) {
    device d;
    const boxes_case c = random_boxes(400, {17, 19, 11, volume_format::int32});
    const auto boxes = expect_value(make_buffer<device, kernels::probe_box>(d, c.boxes));
    const auto count = expect_value(make_buffer<device, count_record>(d, {{{250, 9, {}}}}));
    const auto v = expect_value(d.create_volume(c.what));
    for (const auto& [limit, expected] : {std::pair{300u, 250u}, {200u, 200u}}) {
        ASSERT_TRUE(run(d, [&, limit = limit](auto& r) {
            // A route that the backend does not have is the direct one.
            r.accumulate(c.kernel, {view<device>(boxes)},
                         counted<device>{view<device>(count), limit},
                         {&v, true, accumulate_route::layers, padding::degenerate});
        }));
        EXPECT_EQ(voxels_of<std::int32_t>(d, v), sums_of(c, 0, expected));
    }
}

TEST(accumulate, more_slabs_than_a_batch_holds) {
    device d;
    boxes_case c = random_boxes(3000, {8, 8, 8, volume_format::int32});
    c.kernel.most = 1u << 13; // 512 elements a batch
    const auto boxes = expect_value(make_buffer<device, kernels::probe_box>(d, c.boxes));
    const auto v = expect_value(d.create_volume(c.what));
    ASSERT_TRUE(run(d, [&](auto& r) {
        r.accumulate(c.kernel, {view<device>(boxes)}, range{0, 3000}, {&v, true, {}, {}});
    }));
    EXPECT_EQ(voxels_of<std::int32_t>(d, v), sums_of(c, 0, 3000));
}

// ------------------------------------------------------------------------------------------ scan

template <class T>
struct volume_of {
    static constexpr volume_format format = volume_format::int32;
};
template <>
struct volume_of<float> {
    static constexpr volume_format format = volume_format::float32;
};
template <>
struct volume_of<cpu::half> {
    static constexpr volume_format format = volume_format::float16;
};

/// The scan by its description, one voxel after another.
template <class Out, class In>
std::vector<Out> scanned(const std::vector<In>& in, glm::ivec3 size, const volume_scan& how) {
    std::vector<Out> out(in.size());
    const auto at = [&](glm::ivec3 p) {
        return static_cast<std::size_t>((p.z * size.y + p.y) * size.x + p.x);
    };
    for (int z = 0; z < size.z; ++z) {
        for (int y = 0; y < size.y; ++y) {
            for (int x = 0; x < size.x; ++x) {
                const glm::ivec3 here(x, y, z);
                In before = 0;
                if (how.axis != scan_axis::none) {
                    const int axis = static_cast<int>(how.axis) - 1;
                    const bool up = how.direction == scan_direction::ascending;
                    glm::ivec3 p = here;
                    for (p[axis] = up ? 0 : size[axis] - 1; p[axis] != here[axis];
                         p[axis] += up ? 1 : -1) {
                        before += in[at(p)];
                    }
                }
                const In own = in[at(here)];
                if constexpr (std::is_same_v<Out, std::int32_t>) {
                    out[at(here)] = how.share == scan_share::whole ? before + own : before;
                } else {
                    const float sum =
                        how.share == scan_share::whole
                            ? static_cast<float>(before + own)
                            : static_cast<float>(before) + (how.share == scan_share::half
                                                                ? 0.5f * static_cast<float>(own)
                                                                : 0.0f);
                    if constexpr (std::is_same_v<Out, float>) {
                        out[at(here)] = sum * how.scale;
                    } else {
                        out[at(here)] =
                            cpu::to_half(std::clamp(sum * how.scale, -65504.0f, 65504.0f));
                    }
                }
            }
        }
    }
    return out;
}

template <class In, class Out>
void expect_scans(std::initializer_list<scan_share> shares) {
    support::random_source random(5);
    for (const glm::ivec3 size : {glm::ivec3(13, 6, 9), glm::ivec3(1, 1, 1), glm::ivec3(520, 3, 2),
                                  glm::ivec3(64, 32, 2)}) {
        std::vector<In> in(static_cast<std::size_t>(size.x * size.y * size.z));
        for (In& v : in) {
            v = static_cast<In>(random.between(-3000, 3000));
        }
        const volume_description what{static_cast<std::uint32_t>(size.x),
                                      static_cast<std::uint32_t>(size.y),
                                      static_cast<std::uint32_t>(size.z), volume_of<In>::format};
        volume_description made = what;
        made.format = volume_of<Out>::format;
        device d = with_threads(2);
        const auto from = put(d, what, in);
        const auto to = expect_value(d.create_volume(made));
        for (const auto axis : {scan_axis::none, scan_axis::x, scan_axis::y, scan_axis::z}) {
            for (const auto direction : {scan_direction::ascending, scan_direction::descending}) {
                for (const auto share : shares) {
                    const float scale = std::is_same_v<Out, std::int32_t> ? 1.0f : 0.37f;
                    const volume_scan how{axis, direction, share, scale};
                    ASSERT_TRUE(run(d, [&](auto& r) { r.scan(from, to, how); }));
                    const auto expected = scanned<Out>(in, size, how);
                    EXPECT_EQ(std::memcmp(to.data(), expected.data(), to.size_bytes()), 0)
                        << size.x << ' ' << int(axis) << int(direction) << int(share);
                }
            }
        }
    }
}

TEST(volume_scan, whole_numbers) {
    expect_scans<std::int32_t, std::int32_t>({scan_share::whole, scan_share::none});
    expect_scans<std::int32_t, float>({scan_share::whole, scan_share::half, scan_share::none});
    expect_scans<std::int32_t, cpu::half>({scan_share::whole, scan_share::half, scan_share::none});
}

TEST(volume_scan, floats) {
    expect_scans<float, float>({scan_share::whole, scan_share::half, scan_share::none});
    expect_scans<float, cpu::half>({scan_share::whole, scan_share::half, scan_share::none});
}

TEST(volume_scan, fused_with_accumulate_has_the_same_bits) {
    for (const std::uint32_t threads : {1u, 2u, 5u}) {
        device d = with_threads(threads);
        boxes_case c = random_boxes(2000, {72, 31, 13, volume_format::int32});
        const auto boxes = expect_value(make_buffer<device, kernels::probe_box>(d, c.boxes));
        const auto sums = expect_value(d.create_volume(c.what));
        const auto spare = expect_value(d.create_volume(c.what));
        for (const auto format : {volume_format::float32, volume_format::float16}) {
            volume_description what = c.what;
            what.format = format;
            const auto apart = expect_value(d.create_volume(what));
            const auto fused = expect_value(d.create_volume(what));
            for (const auto axis : {scan_axis::y, scan_axis::z}) {
                for (const auto share : {scan_share::whole, scan_share::half, scan_share::none}) {
                    for (const auto direction :
                         {scan_direction::ascending, scan_direction::descending}) {
                        const volume_scan how{axis, direction, share, 0.125f};
                        ASSERT_TRUE(run(d, [&](auto& r) {
                            r.accumulate(c.kernel, {view<device>(boxes)}, range{3, 1990},
                                         {&sums, true, {}, {}});
                            r.scan(sums, apart, how);
                            r.accumulate_scan(c.kernel, {view<device>(boxes)}, range{3, 1990},
                                              spare, fused, how);
                        }));
                        EXPECT_EQ(std::memcmp(apart.data(), fused.data(), apart.size_bytes()), 0)
                            << int(axis) << int(share) << int(direction);
                    }
                }
            }
        }
    }
}

TEST(volume_scan, fused_calls_are_validated) {
    using checked = validated<device>;
    static_assert(fuses_accumulate_scan<checked, kernels::probe_slabs>);
    device inner;
    std::string said;
    checked d(inner, [&](std::string_view sentence) { said = sentence; });
    const auto boxes = expect_value(d.create_buffer(32));
    const auto sums = expect_value(d.create_volume({4, 4, 4, volume_format::int32}));
    const auto wide = expect_value(d.create_volume({5, 4, 4, volume_format::float32}));
    const auto to = expect_value(d.create_volume({4, 4, 4, volume_format::float32}));
    const auto fused = [&](const auto& scratch, const auto& out) {
        said.clear();
        ASSERT_TRUE(run(d, [&](auto& r) {
            r.accumulate_scan(kernels::probe_slabs{}, {view<checked>(boxes)}, range{0, 1}, scratch,
                              out, volume_scan{});
        }));
    };
    fused(to, wide);
    EXPECT_EQ(said, "accumulate_scan: the scratch volume has the format float32, which cannot be.");
    fused(sums, wide);
    EXPECT_EQ(said, "accumulate_scan: the source has 4 x 4 x 4 voxels and the destination "
                    "5 x 4 x 4.");
    fused(sums, to);
    EXPECT_EQ(said, "");
}

// ----------------------------------------------------------------------------------------- grids

TEST(grids, trilinear_samples_of_a_plane_lie_in_it) {
    device d;
    const glm::ivec3 size(5, 4, 6);
    std::vector<float> voxels;
    const auto plane = [](glm::dvec3 cells) {
        return 3 + 2 * cells.x - 0.5 * cells.y + 0.25 * cells.z;
    };
    for (int i = 0; i < 120; ++i) {
        const glm::dvec3 middle(i % 5 + 0.5, i / 5 % 4 + 0.5, i / 20 + 0.5);
        voxels.push_back(static_cast<float>(plane(middle)));
    }
    std::vector<cpu::half> halves;
    for (const float v : voxels) {
        halves.push_back(cpu::to_half(v)); // exact
    }
    const auto a = put(d, {5, 4, 6, volume_format::float32}, voxels);
    const auto b = put(d, {5, 4, 6, volume_format::float16}, halves);
    const auto t = expect_value(d.create_volume({5, 4, 6, volume_format::float32}));
    const auto grids = cpu::grids::of<device, kernels::probe_voxels>({{&a, &b}, {&t, &t}});
    EXPECT_EQ(grids.size(1), size);
    EXPECT_EQ(grids.load(0, {4, 3, 5}), voxels[119]);
    EXPECT_EQ(grids.load(1, {4, 3, 5}), voxels[119]);
    support::random_source random(8);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 at(random.between(-0.3, 1.3), random.between(-0.3, 1.3),
                           random.between(-0.3, 1.3));
        const glm::dvec3 half_voxel(0.5);
        const glm::dvec3 cells =
            glm::clamp(glm::dvec3(at) * glm::dvec3(size), half_voxel, glm::dvec3(size) - 0.5);
        // Three rounded interpolations of values below 16: a few units of 2^-20 each.
        EXPECT_NEAR(grids.sample(0, at), plane(cells), 2e-5);
        EXPECT_EQ(grids.sample(1, at), grids.sample(0, at));
    }
    const float nan = std::nanf("");
    const float huge = std::numeric_limits<float>::max();
    EXPECT_EQ(grids.sample(0, {nan, nan, nan}), voxels[0]);
    EXPECT_EQ(grids.sample(0, {huge, huge, huge}), voxels[119]);
    EXPECT_EQ(grids.sample(0, {-huge, -huge, -huge}), voxels[0]);
    grids.store(1, {1, 2, 3}, 42.5f);
    EXPECT_EQ(voxels_of<float>(d, t)[3 * 20 + 2 * 5 + 1], 42.5f);
}

TEST(map_voxels, runs_each_voxel_of_the_extent_once) {
    device d = with_threads(3);
    const volume_description what{11, 7, 9, volume_format::float32};
    std::vector<float> voxels(11 * 7 * 9);
    std::iota(voxels.begin(), voxels.end(), 1.0f);
    const auto a = put(d, what, voxels);
    const auto to = put(d, what, std::vector<float>(voxels.size(), -1.0f));
    const auto sampled = put(d, what, std::vector<float>(voxels.size(), -1.0f));
    const auto weights =
        expect_value(make_buffer<device, glm::vec4>(d, std::vector<glm::vec4>(9, glm::vec4(1))));
    const glm::uvec3 extent(10, 6, 8);
    const auto numbers = expect_value(d.create_buffer(10 * 6 * 8 * 4));
    kernels::probe_voxels kernel;
    kernel.extent_x = 10;
    kernel.extent_y = 6;
    ASSERT_TRUE(run(d, [&](auto& r) {
        r.map_voxels(kernel, {view<device>(weights), view<device>(numbers)},
                     {{&a, &a}, {&to, &sampled}}, extent);
        r.map_voxels(kernel, {view<device>(weights), view<device>(numbers)},
                     {{&a, &a}, {&to, &sampled}}, glm::uvec3(10, 0, 8));
    }));
    const auto out = voxels_of<float>(d, to);
    const auto at = [&](int x, int y, int z) {
        const bool in = x >= 0 && y >= 0 && z >= 0 && x < 11 && y < 7 && z < 9;
        return in ? voxels[static_cast<std::size_t>((z * 7 + y) * 11 + x)] : 0.0f;
    };
    for (int i = 0; i < 11 * 7 * 9; ++i) {
        const int x = i % 11, y = i / 11 % 7, z = i / 77;
        const bool inside = x < 10 && y < 6 && z < 8;
        const float sum = at(x, y, z) + at(x - 1, y, z) + at(x + 1, y, z) + at(x, y - 1, z) +
                          at(x, y + 1, z) + at(x, y, z - 1) + at(x, y, z + 1);
        EXPECT_EQ(out[static_cast<std::size_t>(i)], inside ? sum : -1.0f) << i;
    }
    const auto* number = reinterpret_cast<const std::uint32_t*>(numbers.data());
    for (std::uint32_t i = 0; i < 480; ++i) {
        EXPECT_EQ(number[i], i + (11u << 24));
    }
}

} // namespace
