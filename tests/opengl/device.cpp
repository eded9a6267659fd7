// Buffers, images, traffic, limits, what is created when, and what happens when things go wrong.

#include "support.hpp"

#include <map>

namespace skybark::opengl::tests {
namespace {

using kernels::hermite_branch;
using kernels::probe_map;
using kernels::probe_strips;
using kernels::probe_surface;
using kernels::probe_vertex;

static_assert(backend<gpu>);
static_assert(maps<gpu, probe_map>);
static_assert(expands<gpu, hermite_branch>);
static_assert(expands_rings<gpu, hermite_branch>);
static_assert(draws<gpu, probe_surface>);
static_assert(draws<gpu, kernels::probe_image>);

TEST_F(device_test, says_who_it_is_and_what_it_can) {
    EXPECT_EQ(device().name(), "opengl");
    EXPECT_NE(device().device_name(), "");
    const device_limits limits = device().limits();
    EXPECT_GE(limits.max_buffer_bytes, std::uint64_t{1} << 27); // what OpenGL 4.5 guarantees
    EXPECT_GE(limits.view_alignment, 16u);
    EXPECT_EQ(limits.view_alignment & (limits.view_alignment - 1), 0u);
    EXPECT_GE(limits.max_elements, std::uint64_t{1} << 31);
    EXPECT_GE(limits.max_image_size, 16384u);
}

TEST_F(device_test, a_new_buffer_holds_zeros_even_where_another_was) {
    for (int i = 0; i < 3; ++i) {
        const buffer b = zeros(1 << 20);
        EXPECT_EQ(b.size_bytes(), 1u << 20);
        EXPECT_EQ(read<std::uint32_t>(b, 1 << 18), std::vector<std::uint32_t>(1 << 18, 0));
        const std::vector<std::uint32_t> other(1 << 18, 0xabababab);
        ASSERT_TRUE(device().upload(b, 0, std::as_bytes(std::span(other))));
    }
    EXPECT_EQ(zeros(0).size_bytes(), 0u);
}

TEST_F(device_test, bytes_go_where_they_are_sent) {
    const buffer b = zeros(64);
    const std::vector<std::uint32_t> two{1, 2};
    ASSERT_TRUE(device().upload(b, 8, std::as_bytes(std::span(two))));
    const std::vector<std::uint32_t> three{3, 4, 5};
    const buffer other = zeros(64);
    run([&](recorder& r) {
        r.upload({&b, 32, 16}, std::as_bytes(std::span(three)));
        r.upload({}, {});
        r.copy({&b, 0, 48}, {&other, 16, 48});
        r.copy({}, {});
    });
    EXPECT_EQ(read<std::uint32_t>(b, 16),
              (std::vector<std::uint32_t>{0, 0, 1, 2, 0, 0, 0, 0, 3, 4, 5, 0, 0, 0, 0, 0}));
    EXPECT_EQ(read<std::uint32_t>(other, 16),
              (std::vector<std::uint32_t>{0, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 3, 4, 5, 0}));
}

TEST_F(device_test, images_keep_what_is_put_into_them) {
    for (const image_format format :
         {image_format::rgba8, image_format::rgba32f, image_format::depth32f}) {
        // An odd width: rows of a depth image are no multiple of 8 bytes.
        const image_description what{3, 5, format};
        auto made = device().create_image(what);
        ASSERT_TRUE(made) << made.error().message;
        EXPECT_EQ(made->description().width, 3u);
        EXPECT_EQ(made->description().height, 5u);
        std::vector<std::byte> bytes(15 * bytes_per_pixel(format));
        for (std::size_t i = 0; i < bytes.size() / 4; ++i) {
            const float value = static_cast<float>(i) / 64;
            std::memcpy(&bytes[i * 4], &value, 4);
        }
        ASSERT_TRUE(device().upload(*made, bytes));
        std::vector<std::byte> got(bytes.size());
        ASSERT_TRUE(device().download(*made, got));
        EXPECT_EQ(got, bytes);
    }
}

TEST_F(device_test, what_no_memory_holds_is_an_error_with_the_size_in_it) {
    const auto huge = device().create_buffer(std::uint64_t{1} << 50);
    ASSERT_FALSE(huge);
    EXPECT_EQ(huge.error().code, error_code::out_of_memory);
    EXPECT_NE(huge.error().message.find("1125899906842624"), std::string::npos);
    EXPECT_FALSE(device().create_buffer(~std::uint64_t{0}));
    for (const image_description bad :
         {image_description{0, 4}, image_description{4, 0}, image_description{1u << 20, 4}}) {
        const auto made = device().create_image(bad);
        ASSERT_FALSE(made);
        EXPECT_EQ(made.error().code, error_code::out_of_memory);
    }
    // And the device goes on.
    EXPECT_EQ(read<std::uint32_t>(zeros(16), 4), std::vector<std::uint32_t>(4, 0));
    log->serious.clear(); // the driver says that memory is out
}

TEST_F(device_test, counts_the_bytes_that_cross) {
    const buffer in = make(std::vector<std::uint32_t>(100));
    const buffer vectors = zeros(1600);
    const buffer out = zeros(400);
    const buffer vectors_out = zeros(1600);
    const device_traffic before = device().traffic();
    EXPECT_EQ(before.up, 400u);
    EXPECT_EQ(before.down, 0u);
    run([&](recorder& r) {
        r.map(probe_map{},
              {view<gpu>(in), view<gpu>(vectors), view<gpu>(out), view<gpu>(vectors_out)},
              range{0, 100});
        r.copy({&out, 0, 400}, {&in, 0, 400});
    });
    EXPECT_EQ(device().traffic().up - before.up, 16 + sizeof(probe_map));
    EXPECT_EQ(device().traffic().down, 0u);
    (void)read<std::uint32_t>(out, 10);
    EXPECT_EQ(device().traffic().down, 40u);
}

TEST_F(device_test, a_moved_buffer_is_deleted_once) {
    buffer a = zeros(16);
    buffer b = std::move(a);
    EXPECT_EQ(a.size_bytes(), 0u); // NOLINT: what is left is an empty buffer
    b = zeros(32);
    buffer& same = b;
    b = std::move(same);
    EXPECT_EQ(read<std::uint32_t>(b, 8), std::vector<std::uint32_t>(8, 0));
}

// ---- A context whose functions are looked over the shoulder -------------------------------------

/// Lends a headless context to a device of its own, with some functions replaced.
class lent_test : public device_test {
  protected:
    void SetUp() override {
        device_test::SetUp();
        if (owner) {
            context = detail::egl_context::create(true);
            ASSERT_TRUE(context);
            ASSERT_TRUE((*context)->start(message_log::sink(log)));
            real = context->get();
        }
    }
    void TearDown() override {
        device_test::TearDown();
        replaced.clear();
        real = nullptr;
    }
    [[nodiscard]] static description lend() {
        return {[](const char* name, void*) {
                    const auto found = replaced.find(name);
                    return found != replaced.end() ? found->second : real->find(name);
                },
                nullptr, nullptr, nullptr};
    }
    template <class Function>
    [[nodiscard]] static Function* original(const char* name) {
        return reinterpret_cast<Function*>(real->find(name));
    }
    template <class Function>
    static void replace(const char* name, Function* by) {
        replaced[name] = reinterpret_cast<procedure>(by);
    }

    result<std::shared_ptr<detail::headless_context>> context =
        fail(error_code::unavailable, "not yet");
    static inline detail::headless_context* real = nullptr;
    static inline std::map<std::string, procedure> replaced;
    static inline int created = 0;
    static inline gl::token reset = 0;
    static inline int version = 4;
};

TEST_F(lent_test, a_steady_state_creates_no_object) {
    created = 0;
    replace(
        "glCreateBuffers", +[](int n, gl::handle* names) {
            ++created;
            original<void(int, gl::handle*)>("glCreateBuffers")(n, names);
        });
    replace(
        "glCreateTextures", +[](gl::token target, int n, gl::handle* names) {
            ++created;
            original<void(gl::token, int, gl::handle*)>("glCreateTextures")(target, n, names);
        });
    replace(
        "glCreateQueries", +[](gl::token target, int n, gl::handle* names) {
            ++created;
            original<void(gl::token, int, gl::handle*)>("glCreateQueries")(target, n, names);
        });
    replace(
        "glCreateFramebuffers", +[](int n, gl::handle* names) {
            ++created;
            original<void(int, gl::handle*)>("glCreateFramebuffers")(n, names);
        });
    replace(
        "glCreateVertexArrays", +[](int n, gl::handle* names) {
            ++created;
            original<void(int, gl::handle*)>("glCreateVertexArrays")(n, names);
        });
    replace(
        "glCreateSamplers", +[](int n, gl::handle* names) {
            ++created;
            original<void(int, gl::handle*)>("glCreateSamplers")(n, names);
        });
    replace(
        "glCreateTransformFeedbacks", +[](int n, gl::handle* names) {
            ++created;
            original<void(int, gl::handle*)>("glCreateTransformFeedbacks")(n, names);
        });
    replace(
        "glCreateProgram", +[]() {
            ++created;
            return original<gl::handle()>("glCreateProgram")();
        });
    replace(
        "glCreateShader", +[](gl::token type) {
            ++created;
            return original<gl::handle(gl::token)>("glCreateShader")(type);
        });
    auto made = gpu::create(lend());
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_GT(created, 8);
    const buffer numbers = *made->create_buffer(4096);
    const buffer vectors = *made->create_buffer(16384);
    const buffer out = *made->create_buffer(65536);
    const buffer count = *made->create_buffer(16);
    const image target = *made->create_image({8, 8, image_format::rgba8});
    const image depth = *made->create_image({8, 8, image_format::depth32f});
    const image seen[] = {*made->create_image({4, 4}), *made->create_image({4, 4})};
    const std::vector<range> ranges(150, range{0, 3});
    const auto frame = [&](recorder& r) {
        const bindings<gpu, probe_map> mapped{view<gpu>(numbers), view<gpu>(vectors),
                                              view<gpu>(out), view<gpu>(out)};
        const bindings<gpu, probe_strips> expanded{view<gpu>(numbers), view<gpu>(vectors)};
        r.map(probe_map{}, mapped, range{0, 10});
        r.map(probe_map{}, mapped, std::span<const range>(ranges));
        r.map(probe_map{}, mapped, counted<gpu>{view<gpu>(count), 10});
        for (const padding policy : {padding::compact, padding::degenerate}) {
            r.expand(probe_strips{2, 7}, expanded, range{0, 10},
                     {view<gpu>(out), view<gpu>(count), policy});
            r.expand(probe_strips{2, 7}, expanded, counted<gpu>{view<gpu>(count), 10},
                     {view<gpu>(out), view<gpu>(count), policy});
        }
        r.expand_rings(kernels::probe_rings{9}, {view<gpu>(vectors)}, range{0, 10}, view<gpu>(out));
        r.draw(kernels::probe_image{}, {view<gpu>(out)},
               {sampled_image<gpu>{&seen[0]}, sampled_image<gpu>{&seen[1]}},
               {view<gpu>(numbers), 0, 3, 0, view<gpu>(count)},
               {&target, &depth, glm::vec4(0), 1.0f}, {});
        r.upload(view<gpu>(count), std::as_bytes(std::span(&ranges[0], 1)));
    };
    ASSERT_TRUE(skybark::run(*made, frame));
    const int after_one = created;
    for (int i = 0; i < 100; ++i) { // more than the ring of parameters has slots
        ASSERT_TRUE(skybark::run(*made, frame));
    }
    EXPECT_EQ(created, after_one);
}

TEST_F(lent_test, a_lost_context_stays_lost_and_says_so) {
    reset = gl::no_error;
    replace(
        "glGetGraphicsResetStatus", +[]() { return reset; });
    auto made = gpu::create(lend());
    ASSERT_TRUE(made) << made.error().message;
    auto b = made->create_buffer(64);
    ASSERT_TRUE(b);
    auto recorded = made->begin();
    ASSERT_TRUE(recorded);
    reset = 0x8253; // GL_GUILTY_CONTEXT_RESET
    const auto submitted = made->submit(*recorded);
    ASSERT_FALSE(submitted);
    EXPECT_EQ(submitted.error().code, error_code::device_lost);
    reset = gl::no_error; // OpenGL tells of a reset once
    std::array<std::byte, 64> bytes{};
    EXPECT_EQ(made->upload(*b, 0, bytes).error().code, error_code::device_lost);
    EXPECT_EQ(made->download(*b, 0, bytes).error().code, error_code::device_lost);
    EXPECT_EQ(made->create_buffer(16).error().code, error_code::device_lost);
    EXPECT_EQ(made->create_image({4, 4}).error().code, error_code::device_lost);
    EXPECT_EQ(made->begin().error().code, error_code::device_lost);
    EXPECT_EQ(made->submit(*recorded).error().code, error_code::device_lost);
}

TEST_F(lent_test, an_older_version_is_told_by_its_number_not_by_its_pointers) {
    replace(
        "glGetIntegerv", +[](gl::token name, int* values) {
            original<void(gl::token, int*)>("glGetIntegerv")(name, values);
            if (name == gl::minor_version) {
                *values = version;
            }
        });
    version = 4;
    const auto old = gpu::create(lend());
    ASSERT_FALSE(old);
    EXPECT_EQ(old.error().code, error_code::unavailable);
    EXPECT_NE(old.error().message.find("OpenGL 4.5 core"), std::string::npos);
    version = 6;
    EXPECT_TRUE(gpu::create(lend()));
}

TEST_F(lent_test, without_get_proc_address_or_a_function_there_is_no_device) {
    EXPECT_EQ(gpu::create({}).error().code, error_code::bad_input);
    replaced["glDispatchCompute"] = nullptr;
    const auto made = gpu::create(lend());
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, error_code::unavailable);
    EXPECT_NE(made.error().message.find("glDispatchCompute"), std::string::npos);
}

TEST_F(lent_test, without_a_current_context_there_is_no_device) {
    (*context)->release();
    const auto made = gpu::create(lend());
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, error_code::unavailable);
}

// ---- The caller's own objects -------------------------------------------------------------------

TEST_F(lent_test, wrapped_objects_are_used_and_not_deleted) {
    gl::functions gl;
    const auto find = [](const char* name, void*) { return real->find(name); };
    ASSERT_EQ(gl::load(gl, find, nullptr), nullptr);
    auto made = gpu::create(lend());
    ASSERT_TRUE(made);
    gl::handle names[2] = {};
    gl.create_buffers(2, names);
    const std::vector<std::uint32_t> numbers{1, 2, 3, 4};
    gl.named_buffer_storage(names[0], 16, numbers.data(), 0);
    gl.named_buffer_storage(names[1], 16, nullptr, gl::dynamic_storage_bit);
    gl::handle texture = 0;
    gl.create_textures(gl::texture_2d, 1, &texture);
    gl.texture_storage_2d(texture, 1, gl::rgba8, 2, 2);
    {
        const buffer in = made->wrap_buffer(names[0], 16);
        const buffer out = made->wrap_buffer(names[1], 16);
        const buffer vectors = *made->create_buffer(64);
        const image target = made->wrap_image(texture, {2, 2, image_format::rgba8});
        const auto done = skybark::run(*made, [&](recorder& r) {
            r.map(probe_map{10, 0, 1, 0},
                  {view<gpu>(in), view<gpu>(vectors), view<gpu>(out), view<gpu>(vectors)},
                  range{0, 4});
            r.draw(probe_surface{}, {view<gpu>(vectors), view<gpu>(vectors)}, {}, {},
                   {&target, nullptr, glm::vec4(1, 0, 0, 1), {}}, {});
        });
        ASSERT_TRUE(done) << done.error().message;
    }
    std::array<std::uint32_t, 4> got{};
    gl.get_named_buffer_sub_data(names[1], 0, 16, got.data());
    EXPECT_EQ(got, (std::array<std::uint32_t, 4>{10, 21, 32, 43}));
    std::array<std::uint32_t, 4> pixels{};
    gl.get_texture_image(texture, 0, gl::rgba, gl::unsigned_byte, 16, pixels.data());
    EXPECT_EQ(pixels,
              (std::array<std::uint32_t, 4>{0xff0000ff, 0xff0000ff, 0xff0000ff, 0xff0000ff}));
    EXPECT_EQ(gl.get_error(), gl::no_error);
    gl.delete_buffers(2, names);
    gl.delete_textures(1, &texture);
}

// ---- The programs that come with the library ----------------------------------------------------

/// Nothing to do still compiles the programs of each pattern that K takes part in.
template <class K>
void compile_all(gpu& device, const image& some, const image& target) {
    const auto done = skybark::run(device, [&](recorder& r) {
        if constexpr (map_kernel<K>) {
            r.map(K{}, {}, range{});
            r.map(K{}, {}, std::span<const range>{});
        }
        if constexpr (strip_kernel<K>) {
            r.expand(K{}, {}, range{}, {{}, {}, padding::compact});
            r.expand(K{}, {}, range{}, {{}, {}, padding::degenerate});
        }
        if constexpr (ring_kernel<K>) {
            r.expand_rings(K{}, {}, range{}, {});
        }
        if constexpr (draw_kernel<K>) {
            image_bindings<gpu, K> images;
            images.fill({&some});
            r.draw(K{}, {}, images, {}, {&target, nullptr, {}, {}}, {});
        }
    });
    EXPECT_TRUE(done) << done.error().message;
}

template <class... Kernels>
struct kernel_list {
    static void compile(gpu& device, const image& some, const image& target) {
        (compile_all<Kernels>(device, some, target), ...);
    }
};
using all_kernels = kernel_list<kernels::branch_cap, kernels::cast_shadow, kernels::clear_sky,
                                kernels::develop, kernels::hermite_branch, kernels::lit_branch,
                                kernels::meadow_ground, kernels::probe_image, kernels::probe_level,
                                kernels::probe_map, kernels::probe_rings, kernels::probe_strips,
                                kernels::probe_surface, kernels::ring_indices>;

TEST_F(device_test, every_program_compiles_without_complaint) {
    const image some = *device().create_image({4, 4});
    const image target = *device().create_image({4, 4});
    all_kernels::compile(device(), some, target);
}

// ---- Errors of a recorder -----------------------------------------------------------------------

} // namespace

/// A kernel whose program no driver compiles.
struct broken {
    using buffers = buffer_list<>;
    void map(std::uint32_t) const {}
};

} // namespace skybark::opengl::tests

template <>
struct skybark::opengl::program<skybark::opengl::tests::broken> {
    static constexpr std::string_view map_comp = "#version 450\nvoid main() { nonsense(); }\n";
    static constexpr std::string_view levels_comp = map_comp;
};

namespace skybark::opengl::tests {
namespace {

TEST_F(device_test, a_recorder_keeps_its_first_error_and_ignores_what_follows) {
    const buffer b = make(std::vector<std::uint32_t>{1, 2, 3, 4});
    const std::vector<std::uint32_t> other{9, 9, 9, 9};
    const auto done = skybark::run(device(), [&](recorder& r) {
        r.map(broken{}, {}, range{0, 1});
        r.upload(view<gpu>(b), std::as_bytes(std::span(other)));
    });
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, error_code::shader_rejected);
    EXPECT_NE(done.error().message.find("nonsense"), std::string::npos) << done.error().message;
    EXPECT_EQ(read<std::uint32_t>(b, 4), (std::vector<std::uint32_t>{1, 2, 3, 4}));
    run([](recorder&) {});
    log->serious.clear(); // the driver says the same
}

} // namespace
} // namespace skybark::opengl::tests
