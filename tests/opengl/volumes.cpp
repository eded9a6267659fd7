// Volumes of the OpenGL backend: sums by every route and padding, where the rectangles lie, how
// many there may be, and textures of the caller's.

#include "caller.hpp"

#include <random>

namespace skybark::opengl::tests {
namespace {

using kernels::probe_box;
using kernels::probe_slabs;

constexpr std::array<accumulate_route, 4> all_routes = {
    accumulate_route::direct, accumulate_route::tiles_copied, accumulate_route::tiles_drawn,
    accumulate_route::layers};
constexpr std::array<padding, 2> both_policies = {padding::degenerate, padding::compact};

std::string name_of(accumulate_route route, padding policy) {
    const char* routes[] = {"direct", "tiles_copied", "tiles_drawn", "layers"};
    return std::string(routes[static_cast<std::size_t>(route)]) +
           (policy == padding::compact ? ", compact" : ", degenerate");
}

/// The sums as the contract has them, in 64 bits.
std::vector<std::int32_t> expected_sums(const probe_slabs& kernel, std::span<const probe_box> boxes,
                                        const volume_description& size) {
    std::vector<std::int64_t> sums(std::size_t{size.width} * size.height * size.depth);
    for (const probe_box& box : boxes) {
        const int layers = std::min(box.high.z - box.low.z, static_cast<int>(kernel.most));
        for (int s = 0; s < layers; ++s) {
            const int z = box.low.z + s;
            for (int y = std::max(box.low.y, 0); y < std::min(box.high.y - s, int(size.height));
                 ++y) {
                for (int x = std::max(box.low.x + s, 0); x < std::min(box.high.x, int(size.width));
                     ++x) {
                    if (z >= 0 && z < static_cast<int>(size.depth)) {
                        const std::int64_t amount =
                            (box.low.w + std::int64_t{kernel.per_x} * x + kernel.per_z * z +
                             std::int64_t{box.high.w} * y) *
                            kernel.factor;
                        sums[(static_cast<std::size_t>(z) * size.height +
                              static_cast<std::size_t>(y)) *
                                 size.width +
                             static_cast<std::size_t>(x)] += amount;
                    }
                }
            }
        }
    }
    std::vector<std::int32_t> result;
    for (const std::int64_t sum : sums) {
        EXPECT_EQ(sum, static_cast<std::int32_t>(sum)) << "the test's own sums leave an int32";
        result.push_back(static_cast<std::int32_t>(sum));
    }
    return result;
}

/// Boxes that lie inside, outside, and across every border of the volume.
std::vector<probe_box> scattered_boxes(std::size_t count, const volume_description& size,
                                       std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto number = [&](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random);
    };
    std::vector<probe_box> boxes(count);
    for (probe_box& box : boxes) {
        const glm::ivec3 sides(size.width, size.height, size.depth);
        for (int axis = 0; axis < 3; ++axis) {
            box.low[axis] = number(-4, sides[axis] + 1);
            box.high[axis] = box.low[axis] + number(-1, axis == 2 ? 6 : 9);
        }
        box.low.w = number(-200000, 200000);
        box.high.w = number(-50, 50);
    }
    return boxes;
}

class volumes_test : public device_test {
  protected:
    [[nodiscard]] volume make_volume(const volume_description& what) {
        auto made = device().create_volume(what);
        EXPECT_TRUE(made) << made.error().message;
        return std::move(*made);
    }
    template <class T>
    void fill(const volume& to, const std::vector<T>& voxels) {
        const auto done = device().upload(to, std::as_bytes(std::span(voxels)));
        EXPECT_TRUE(done) << done.error().message;
    }
    template <class T>
    [[nodiscard]] std::vector<T> voxels(const volume& from) {
        std::vector<T> got(from.description().size_bytes() / sizeof(T));
        const auto done = device().download(from, std::as_writable_bytes(std::span(got)));
        EXPECT_TRUE(done) << done.error().message;
        return got;
    }
    /// An accumulation from zero, of all of `boxes`.
    [[nodiscard]] std::vector<std::int32_t> sums(const probe_slabs& kernel, const buffer& boxes,
                                                 const volume& into, accumulate_route route,
                                                 padding policy) {
        const auto count = static_cast<std::uint32_t>(boxes.size_bytes() / sizeof(probe_box));
        run([&](recorder& r) {
            r.accumulate(kernel, {view<gpu>(boxes)}, range{0, count}, {&into, true, route, policy});
        });
        return voxels<std::int32_t>(into);
    }
    void expect_equal_sums();
};

TEST_F(volumes_test, every_route_and_padding_gives_the_same_sums) { expect_equal_sums(); }

TEST_F(volumes_test, in_a_context_of_osmesa_as_well) {
    start(headless_kind::osmesa);
    if (owner && !IsSkipped()) {
        expect_equal_sums();
    }
}

void volumes_test::expect_equal_sums() {
    // Sides that are no multiples of anything, and 11 layers: 4 × 3 tiles, the last one empty.
    const volume_description size{19, 13, 11, volume_format::int32};
    const volume into = make_volume(size);
    const auto boxes = scattered_boxes(500, size, 1);
    const buffer bound = make(boxes);
    const probe_slabs kernel{5, 3, -7, 1};
    const auto wanted = expected_sums(kernel, boxes, size);
    for (const accumulate_route route : all_routes) {
        for (const padding policy : both_policies) {
            EXPECT_EQ(sums(kernel, bound, into, route, policy), wanted) << name_of(route, policy);
        }
    }
}

TEST_F(volumes_test, the_order_of_elements_does_not_change_a_bit) {
    const volume_description size{16, 16, 8, volume_format::int32};
    const volume into = make_volume(size);
    auto boxes = scattered_boxes(300, size, 2);
    const probe_slabs kernel{4, 5, 11, 1};
    const auto wanted = expected_sums(kernel, boxes, size);
    std::mt19937 random(3);
    for (int order = 0; order < 5; ++order) {
        std::shuffle(boxes.begin(), boxes.end(), random);
        const buffer bound = make(boxes);
        for (const accumulate_route route : all_routes) {
            const padding policy = order % 2 == 0 ? padding::compact : padding::degenerate;
            EXPECT_EQ(sums(kernel, bound, into, route, policy), wanted) << name_of(route, policy);
        }
    }
}

TEST_F(volumes_test, sums_are_added_to_what_is_there_and_lengths_may_be_the_devices) {
    const volume_description size{9, 10, 7, volume_format::int32};
    const volume into = make_volume(size);
    const auto boxes = scattered_boxes(80, size, 4);
    const buffer bound = make(boxes);
    const buffer length = make(std::vector<count_record>{{30, 99, {0, 0}}});
    const probe_slabs kernel{3, 0, 1, 2};
    std::vector<std::int32_t> before(630);
    std::mt19937 random(5);
    for (std::int32_t& each : before) {
        each = static_cast<std::int32_t>(random() % 2000000) - 1000000;
    }
    // Those of [20, 60), the first 30, none of none, and the first 12 of 30.
    const std::span<const probe_box> all(boxes);
    std::vector<std::int32_t> wanted = before;
    for (const auto part : {all.subspan(20, 40), all.subspan(0, 30), all.subspan(0, 12)}) {
        const auto more = expected_sums(kernel, part, size);
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            wanted[i] += more[i];
        }
    }
    for (const accumulate_route route : all_routes) {
        for (const padding policy : both_policies) {
            fill(into, before);
            const bindings<gpu, probe_slabs> views{view<gpu>(bound)};
            const accumulation<gpu> out{&into, false, route, policy};
            run([&](recorder& r) {
                r.accumulate(kernel, views, range{20, 40}, out);
                r.accumulate(kernel, views, counted<gpu>{view<gpu>(length), 80}, out);
                r.accumulate(kernel, views, range{7, 0}, out);
                r.accumulate(kernel, views, counted<gpu>{view<gpu>(length), 12}, out);
            });
            EXPECT_EQ(voxels<std::int32_t>(into), wanted) << name_of(route, policy);
            run([&](recorder& r) {
                r.accumulate(kernel, views, range{0, 0}, {&into, true, route, policy});
            });
            EXPECT_EQ(voxels<std::int32_t>(into), std::vector<std::int32_t>(630))
                << name_of(route, policy);
        }
    }
}

TEST_F(volumes_test, more_amounts_than_a_float_sums_exactly) {
    // 127 and -127 are what an amount leaves beside multiples of 256, and 132,105 of them are 2^24.
    const volume_description size{2, 1, 2, volume_format::int32};
    const volume into = make_volume(size);
    for (const std::int32_t each : {127 + 59 * 256, -127 - 59 * 256}) {
        const std::vector<probe_box> boxes(140000, {{0, 0, 1, each}, {2, 1, 2, 0}});
        const buffer bound = make(boxes);
        const buffer length = make(std::vector<count_record>{{139999, 0, {0, 0}}});
        const std::vector<std::int32_t> wanted{0, 0, each * 140000, each * 140000};
        for (const accumulate_route route : all_routes) {
            const padding policy = each > 0 ? padding::degenerate : padding::compact;
            EXPECT_EQ(sums({1}, bound, into, route, policy), wanted) << name_of(route, policy);
            run([&](recorder& r) {
                r.accumulate(probe_slabs{1}, {view<gpu>(bound)},
                             counted<gpu>{view<gpu>(length), 140000}, {&into, true, route, policy});
            });
            EXPECT_EQ(voxels<std::int32_t>(into)[2], each * 139999) << name_of(route, policy);
        }
    }
}

TEST_F(volumes_test, amounts_as_large_as_an_int32) {
    const volume_description size{4, 4, 1, volume_format::int32};
    const volume into = make_volume(size);
    const buffer bound = make(std::vector<probe_box>{{{1, 1, 0, 1}, {3, 3, 1, 0}}});
    for (const std::int32_t amount : {0x7fffffff, -0x7fffffff - 1, 0x7fffff80, 0x7fffff7f, -128,
                                      127, 128, -129, 0x1000000, 0x1000001}) {
        std::vector<std::int32_t> wanted(16);
        for (const std::size_t i : {5u, 6u, 9u, 10u}) {
            wanted[i] = amount;
        }
        for (const accumulate_route route : all_routes) {
            EXPECT_EQ(sums({1, 0, 0, amount}, bound, into, route, padding::compact), wanted)
                << amount << ", " << name_of(route, padding::compact);
        }
    }
}

TEST_F(volumes_test, elements_of_more_slabs_than_a_geometry_shader_emits) {
    // 1,024 components are 36 rectangles of 4 vertices: 75 slabs are three parts.
    const volume_description size{5, 6, 90, volume_format::int32};
    const volume into = make_volume(size);
    auto boxes = scattered_boxes(40, size, 6);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        boxes[i].high.z = boxes[i].low.z + static_cast<int>(i) * 2;
        boxes[i].high.y += 70;
    }
    const buffer bound = make(boxes);
    const probe_slabs kernel{75, 1, 1, 1};
    const auto wanted = expected_sums(kernel, boxes, size);
    for (const accumulate_route route : all_routes) {
        for (const padding policy : both_policies) {
            EXPECT_EQ(sums(kernel, bound, into, route, policy), wanted) << name_of(route, policy);
        }
    }
}

TEST_F(volumes_test, voxels_go_up_and_come_down_as_they_are) {
    std::mt19937 random(7);
    const auto check = [&]<class T>(volume_format format, T) {
        const volume v = make_volume({7, 3, 5, format});
        std::vector<T> in(105);
        for (T& each : in) {
            each = static_cast<T>(random() % 30000);
        }
        fill(v, in);
        EXPECT_EQ(voxels<T>(v), in);
        EXPECT_EQ(v.description().size_bytes(), 105 * sizeof(T));
    };
    check(volume_format::int32, std::int32_t{});
    check(volume_format::float32, float{});
    check(volume_format::float16, std::uint16_t{}); // bits of halves up to 0.46
}

TEST_F(volumes_test, volumes_that_cannot_be_had_are_a_sentence) {
    const std::uint32_t most = device().limits().max_volume_size;
    ASSERT_GE(most, 256u); // OpenGL 4.5 guarantees 2,048
    for (const volume_description& what :
         {volume_description{0, 4, 4}, {4, 0, 4}, {4, 4, 0}, {most + 1, 4, 4}, {4, 4, most + 1}}) {
        const auto made = device().create_volume(what);
        ASSERT_FALSE(made);
        EXPECT_EQ(made.error().code, error_code::out_of_memory);
        EXPECT_NE(made.error().message.find("must be 1 to " + std::to_string(most)),
                  std::string::npos)
            << made.error().message;
    }
    // 8.6 billion voxels of 4 bytes.
    const auto made = device().create_volume({2048, 2048, 2048, volume_format::float32});
    if (!made) {
        EXPECT_EQ(made.error().code, error_code::out_of_memory);
        EXPECT_NE(made.error().message.find("2048 x 2048 x 2048"), std::string::npos)
            << made.error().message;
        log->serious.clear(); // the driver, too, says that it is too large
    }
    EXPECT_TRUE(device().create_volume({4, 4, 4}));
}

/// A caller's context, and how many textures and buffers were made in it.
class callers_volumes_test : public testing::Test {
  protected:
    void SetUp() override {
        if (!caller.current()) {
            ASSERT_FALSE(required());
            GTEST_SKIP() << "There is no EGL with OpenGL 4.5.";
        }
    }
    template <class Function>
    [[nodiscard]] Function gl(const char* name) const {
        return reinterpret_cast<Function>(caller.find(name));
    }
    caller_context caller;
};

TEST_F(callers_volumes_test, can_be_wrapped) {
    auto device = gpu::create(caller.describe());
    ASSERT_TRUE(device) << device.error().message;
    GLuint name = 0;
    gl<PFNGLCREATETEXTURESPROC>("glCreateTextures")(GL_TEXTURE_3D, 1, &name);
    gl<PFNGLTEXTURESTORAGE3DPROC>("glTextureStorage3D")(name, 3, GL_R32I, 4, 5, 6);
    {
        const volume into = device->wrap_volume(name, {4, 5, 6, volume_format::int32});
        EXPECT_EQ(into.name(), name);
        const std::vector<probe_box> boxes{{{0, 0, 0, 9}, {4, 5, 6, 0}}};
        const buffer bound = *make_buffer<gpu, probe_box>(*device, boxes);
        for (const accumulate_route route : all_routes) {
            const auto done = run(*device, [&](recorder& r) {
                r.accumulate(probe_slabs{6}, {view<gpu>(bound)}, range{0, 1},
                             {&into, true, route, padding::compact});
            });
            ASSERT_TRUE(done) << done.error().message;
            std::vector<std::int32_t> got(120);
            ASSERT_TRUE(device->download(into, std::as_writable_bytes(std::span(got))));
            EXPECT_EQ(got, expected_sums({6}, boxes, into.description()));
        }
    }
    GLint width = 0; // it is still there
    gl<PFNGLGETTEXTURELEVELPARAMETERIVPROC>("glGetTextureLevelParameteriv")(
        name, 0, GL_TEXTURE_WIDTH, &width);
    EXPECT_EQ(width, 4);
}

TEST_F(callers_volumes_test, layers_that_do_not_fit_into_a_target_are_drawn_in_turns) {
    const volume_description size{6, 7, 9, volume_format::int32};
    const auto boxes = scattered_boxes(200, size, 8);
    const probe_slabs kernel{4, 1, 2, 3};
    const auto wanted = expected_sums(kernel, boxes, size);
    // 8 bytes a voxel: less than a layer, one, two and a half, four, all but one.
    for (const std::uint64_t most : {100u, 336u, 840u, 1344u, 2688u}) {
        description described = caller.describe();
        described.max_target_bytes = most;
        auto device = gpu::create(std::move(described));
        ASSERT_TRUE(device) << device.error().message;
        const buffer bound = *make_buffer<gpu, probe_box>(*device, boxes);
        const volume into = *device->create_volume(size);
        for (const accumulate_route route : all_routes) {
            for (const padding policy : both_policies) {
                const auto done = run(*device, [&](recorder& r) {
                    r.accumulate(kernel, {view<gpu>(bound)}, range{0, 200},
                                 {&into, true, route, policy});
                });
                ASSERT_TRUE(done) << done.error().message;
                std::vector<std::int32_t> got(wanted.size());
                ASSERT_TRUE(device->download(into, std::as_writable_bytes(std::span(got))));
                EXPECT_EQ(got, wanted) << most << " bytes, " << name_of(route, policy);
            }
        }
    }
}

/// What makes storage on the device, counted; OpenGL's own functions know nothing of it.
struct counted_storage {
    inline static int made = 0;
    inline static GLsizei most_texels = 0; ///< of a texture
    inline static PFNGLNAMEDBUFFERSTORAGEPROC buffer = nullptr;
    inline static PFNGLTEXTURESTORAGE2DPROC flat = nullptr;
    inline static PFNGLTEXTURESTORAGE3DPROC deep = nullptr;

    static void APIENTRY make_buffer(GLuint name, GLsizeiptr size, const void* data,
                                     GLbitfield flags) {
        ++made;
        buffer(name, size, data, flags);
    }
    static void APIENTRY make_flat(GLuint name, GLsizei levels, GLenum format, GLsizei width,
                                   GLsizei height) {
        ++made;
        most_texels = std::max(most_texels, width * height);
        flat(name, levels, format, width, height);
    }
    static void APIENTRY make_deep(GLuint name, GLsizei levels, GLenum format, GLsizei width,
                                   GLsizei height, GLsizei depth) {
        ++made;
        most_texels = std::max(most_texels, width * height * depth);
        deep(name, levels, format, width, height, depth);
    }
    static procedure find(const char* name, void* user) {
        const procedure found = static_cast<caller_context*>(user)->find(name);
        const auto instead = [&](auto& kept, auto counting) {
            kept = reinterpret_cast<std::remove_reference_t<decltype(kept)>>(found);
            return reinterpret_cast<procedure>(counting);
        };
        const std::string_view text(name);
        return text == "glNamedBufferStorage" ? instead(buffer, &make_buffer)
               : text == "glTextureStorage2D" ? instead(flat, &make_flat)
               : text == "glTextureStorage3D" ? instead(deep, &make_deep)
                                              : found;
    }
};

TEST_F(callers_volumes_test, a_frame_like_the_last_one_allocates_nothing_on_the_device) {
    description described = caller.describe();
    described.get_proc_address = &counted_storage::find;
    auto device = gpu::create(std::move(described));
    ASSERT_TRUE(device) << device.error().message;
    const volume_description size{6, 7, 9, volume_format::int32};
    const auto boxes = scattered_boxes(200, size, 8);
    const buffer bound = *make_buffer<gpu, probe_box>(*device, boxes);
    const buffer words = *device->create_buffer(1 << 16);
    const volume into = *device->create_volume(size);
    const volume larger = *device->create_volume({6, 7, 10, volume_format::int32});
    const auto frame = [&](recorder& r, const volume& to, std::uint32_t elements) {
        for (const accumulate_route route : all_routes) {
            r.accumulate(probe_slabs{4}, {view<gpu>(bound)}, range{0, elements},
                         {&to, true, route, padding::compact});
        }
        r.scan({&words, 0, 1 << 15}, {&words, 1 << 15, 16});
        r.sort({&words, 0, 1 << 15}, {&words, 1 << 15, 1 << 15});
    };
    counted_storage::made = 0;
    EXPECT_TRUE(run(*device, [&](recorder& r) { frame(r, into, 200); }));
    EXPECT_GT(counted_storage::made, 0); // the count sees what is made
    counted_storage::made = 0;
    EXPECT_TRUE(run(*device, [&](recorder& r) { frame(r, into, 200); }));
    EXPECT_TRUE(run(*device, [&](recorder& r) { frame(r, into, 150); }));
    EXPECT_EQ(counted_storage::made, 0);
    EXPECT_TRUE(run(*device, [&](recorder& r) { frame(r, larger, 150); }));
    EXPECT_EQ(counted_storage::made, 2); // 4 × 3 tiles instead of 3 × 3, and the layers
    counted_storage::made = 0;
    EXPECT_TRUE(run(*device, [&](recorder& r) { frame(r, into, 150); }));
    EXPECT_TRUE(run(*device, [&](recorder& r) { frame(r, larger, 150); }));
    EXPECT_EQ(counted_storage::made, 0);
}

// As those of a sun and a sky: both fit into what the larger one, or the two together, have asked
// for; and what is beside a volume in a target that is too large for it is not added to it.
TEST_F(callers_volumes_test, volumes_of_several_sizes_take_turns_without_allocating) {
    description described = caller.describe();
    described.get_proc_address = &counted_storage::find;
    auto device = gpu::create(std::move(described));
    ASSERT_TRUE(device) << device.error().message;
    const probe_slabs kernel{4, 1, 2, 3};
    const std::array<volume_description, 3> sizes = {
        volume_description{20, 11, 12, volume_format::int32},
        {7, 23, 5, volume_format::int32},
        {5, 6, 31, volume_format::int32}};
    const auto boxes = scattered_boxes(300, sizes[0], 8);
    const buffer bound = *make_buffer<gpu, probe_box>(*device, boxes);
    std::vector<volume> volumes;
    for (const volume_description& size : sizes) {
        volumes.push_back(*device->create_volume(size));
    }
    for (int turn = 0; turn < 3; ++turn) {
        counted_storage::made = 0;
        for (const volume& into : volumes) {
            const auto wanted = expected_sums(kernel, boxes, into.description());
            for (const accumulate_route route : all_routes) {
                const padding policy = turn == 1 ? padding::compact : padding::degenerate;
                ASSERT_TRUE(run(*device, [&](recorder& r) {
                    r.accumulate(kernel, {view<gpu>(bound)}, range{0, 300},
                                 {&into, true, route, policy});
                }));
                std::vector<std::int32_t> got(wanted.size());
                ASSERT_TRUE(device->download(into, std::as_writable_bytes(std::span(got))));
                EXPECT_EQ(got, wanted) << name_of(route, policy);
            }
        }
        EXPECT_EQ(counted_storage::made > 0, turn == 0);
    }
    // More than can be summed without a carry in between, into a corner of the target.
    const std::vector<probe_box> pile(140000, {{1, 1, 1, 127}, {2, 2, 2, 0}});
    const buffer piled = *make_buffer<gpu, probe_box>(*device, pile);
    for (const accumulate_route route : all_routes) {
        ASSERT_TRUE(run(*device, [&](recorder& r) {
            r.accumulate(probe_slabs{1}, {view<gpu>(piled)}, range{0, 140000},
                         {&volumes[1], true, route, padding::compact});
        }));
        std::vector<std::int32_t> got(7 * 23 * 5);
        ASSERT_TRUE(device->download(volumes[1], std::as_writable_bytes(std::span(got))));
        EXPECT_EQ(got[(1 * 23 + 1) * 7 + 1], 127 * 140000) << name_of(route, padding::compact);
    }
}

// Together they would be 30 × 30 × 30 voxels of 8 bytes.
TEST_F(callers_volumes_test, targets_of_several_sizes_stay_as_small_as_described) {
    description described = caller.describe();
    described.get_proc_address = &counted_storage::find;
    described.max_target_bytes = 8 * 4000;
    auto device = gpu::create(std::move(described));
    ASSERT_TRUE(device) << device.error().message;
    const probe_slabs kernel{4, 1, 2, 3};
    counted_storage::most_texels = 0;
    for (const volume_description& size : {volume_description{30, 30, 4, volume_format::int32},
                                           {30, 4, 30, volume_format::int32},
                                           {4, 30, 30, volume_format::int32}}) {
        const auto boxes = scattered_boxes(100, size, 3);
        const buffer bound = *make_buffer<gpu, probe_box>(*device, boxes);
        const volume into = *device->create_volume(size);
        const auto wanted = expected_sums(kernel, boxes, size);
        for (const accumulate_route route : all_routes) {
            ASSERT_TRUE(run(*device, [&](recorder& r) {
                r.accumulate(kernel, {view<gpu>(bound)}, range{0, 100},
                             {&into, true, route, padding::compact});
            }));
            std::vector<std::int32_t> got(wanted.size());
            ASSERT_TRUE(device->download(into, std::as_writable_bytes(std::span(got))));
            EXPECT_EQ(got, wanted) << name_of(route, padding::compact);
        }
    }
    EXPECT_LE(counted_storage::most_texels, 4000);
    EXPECT_GE(counted_storage::most_texels, 3600);
}

} // namespace
} // namespace skybark::opengl::tests
