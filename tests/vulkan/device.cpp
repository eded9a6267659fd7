// The device itself: two at once, what validation notices, steady state, errors, loss.
#include "support.hpp"

#include <atomic>
#include <set>

namespace skybark::testing {
namespace {

using kernels::probe_map;
using kernels::probe_strips;
using kernels::probe_surface;
using kernels::probe_vertex;

class one_device : public vulkan_test {};

TEST(concepts, the_device_models_every_pattern_of_the_kernels_that_we_ship) {
    static_assert(backend<device>);
    static_assert(maps<device, kernels::ring_indices> && maps<device, probe_map>);
    static_assert(expands<device, kernels::hermite_branch> && expands<device, probe_strips>);
    static_assert(expands_rings<device, kernels::hermite_branch>);
    static_assert(expands_rings<device, kernels::branch_cap>);
    static_assert(draws<device, probe_surface> && draws<device, kernels::probe_image>);
    // A kernel without a program for a pattern does not model it.
    static_assert(!expands<device, kernels::branch_cap> && !maps<device, probe_strips>);
}

TEST_F(one_device, says_what_it_is) {
    EXPECT_EQ(gpu().name(), "vulkan");
    EXPECT_FALSE(gpu().device_name().empty());
    const device_limits l = gpu().limits();
    EXPECT_GE(l.max_buffer_bytes, 1u << 27);
    EXPECT_GE(l.view_alignment, 16u);
    EXPECT_GE(l.max_elements, 1u << 20);
    EXPECT_GE(l.max_image_size, 4096u);
    const auto devices = must(vulkan::headless::devices());
    ASSERT_FALSE(devices.empty());
    EXPECT_EQ(devices[0].name, gpu().device_name());
}

TEST_F(one_device, two_recorders_interleave) {
    const auto a = must(gpu().create_buffer(64));
    const auto b = must(gpu().create_buffer(64));
    auto first = must(gpu().begin());
    auto second = must(gpu().begin());
    first.upload(view<device>(a), bytes_of(std::vector<std::uint32_t>(16, 1)));
    second.upload(view<device>(b), bytes_of(std::vector<std::uint32_t>(16, 2)));
    first.copy({&a, 0, 32}, {&a, 32, 32});
    second.copy(view<device>(b), view<device>(a));
    must(gpu().submit(first));
    EXPECT_EQ(download<std::uint32_t>(gpu(), a, 16), std::vector<std::uint32_t>(16, 1));
    must(gpu().submit(second));
    EXPECT_EQ(download<std::uint32_t>(gpu(), a, 16), std::vector<std::uint32_t>(16, 2));
}

TEST_F(one_device, two_devices_live_in_one_process) {
    vulkan::headless_options o = options();
    o.sink = log_.sink();
    auto other = must(vulkan::headless::create(std::move(o)));
    device& second = other.device();
    const auto a = must(gpu().create_buffer(400));
    const auto b = must(second.create_buffer(400));
    auto ra = must(gpu().begin());
    auto rb = must(second.begin());
    ra.upload(view<device>(a), bytes_of(std::vector<std::uint32_t>(100, 1)));
    rb.upload(view<device>(b), bytes_of(std::vector<std::uint32_t>(100, 2)));
    ra.scan(view<device>(a), {&a, 0, 0});
    rb.scan(view<device>(b), {&b, 0, 0});
    must(second.submit(rb));
    must(gpu().submit(ra));
    EXPECT_EQ(download<std::uint32_t>(gpu(), a, 100)[99], 99u);
    EXPECT_EQ(download<std::uint32_t>(second, b, 100)[99], 198u);
}

/// Two maps of which the second reads what the first wrote.
void dependent_maps(device& d) {
    const auto numbers = must(d.create_buffer(4096));
    const auto middle = must(d.create_buffer(4096));
    const auto last = must(d.create_buffer(4096));
    const auto vectors = must(d.create_buffer(3 * 16384));
    const auto v = [&](std::uint64_t i) { return buffer_view<device>{&vectors, i * 16384, 16384}; };
    const probe_map k{};
    go(d, [&](auto& r) {
        r.map(k, {view<device>(numbers), v(0), view<device>(middle), v(1)}, range{0, 1024});
        r.map(k, {view<device>(middle), v(1), view<device>(last), v(2)}, range{0, 1024});
    });
}

TEST_F(one_device, a_missing_barrier_would_be_noticed) {
    dependent_maps(gpu());
    EXPECT_TRUE(log_.messages.empty()) << log_.text();
    log other;
    vulkan::headless_options o = options();
    o.sink = other.sink();
    o.omit_barriers = true;
    auto careless = must(vulkan::headless::create(std::move(o)));
    dependent_maps(careless.device());
    ASSERT_FALSE(other.messages.empty());
    EXPECT_NE(other.text().find("READ_AFTER_WRITE"), std::string::npos) << other.text();
}

TEST_F(one_device, runs_under_gpu_assisted_validation) {
    vulkan::headless_options o = options();
    o.gpu_assisted = true;
    log other;
    o.sink = other.sink();
    {
        auto checked = must(vulkan::headless::create(std::move(o)));
        device& d = checked.device();
        dependent_maps(d);
        const auto counts = upload(d, std::vector<std::uint32_t>(100, 5));
        const auto payloads = must(d.create_buffer(1600));
        const auto out = must(d.create_buffer(301 * 96));
        const auto record = must(d.create_buffer(16));
        for (const padding policy : {padding::degenerate, padding::compact}) {
            go(d, [&](auto& r) {
                r.expand(probe_strips{1, 7}, {view<device>(counts), view<device>(payloads)},
                         range{0, 100}, {view<device>(out), view<device>(record), policy});
            });
            EXPECT_EQ(download<count_record>(d, record, 1)[0].written, 301u);
        }
    }
    // The layer says that it is slow, and what it turned on: those are no findings.
    for (const std::string& m : other.messages) {
        EXPECT_EQ(m.find("out of bounds"), std::string::npos) << m;
        EXPECT_EQ(m.find("VUID"), std::string::npos) << m;
    }
}

// ---- Steady state

/// Counts calls that make something, by standing between the device and its functions. A function
/// pointer carries no state, so this must be global; it is the test's, not the library's.
std::atomic<int> made{0};
PFN_vkGetDeviceProcAddr next_get = nullptr;
PFN_vkAllocateMemory next_allocate_memory = nullptr;
std::set<std::string> counted_names;

template <class Function>
struct counting;
template <class... Arguments>
struct counting<VkResult(VKAPI_PTR*)(Arguments...)> {
    static inline VkResult(VKAPI_PTR* next)(Arguments...) = nullptr;
    static VKAPI_ATTR VkResult VKAPI_CALL call(Arguments... arguments) {
        ++made;
        return next(arguments...);
    }
};

/// Counts the calls of the device's function of that name and type.
template <class Function>
PFN_vkVoidFunction between(VkDevice d, const char* name) {
    counting<Function>::next = reinterpret_cast<Function>(next_get(d, name));
    counted_names.insert(name);
    return reinterpret_cast<PFN_vkVoidFunction>(&counting<Function>::call);
}

VKAPI_ATTR VkResult VKAPI_CALL count_sets(VkDevice d, const VkDescriptorSetAllocateInfo* info,
                                          VkDescriptorSet* sets) {
    ++made;
    return reinterpret_cast<PFN_vkAllocateDescriptorSets>(next_get(d, "vkAllocateDescriptorSets"))(
        d, info, sets);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL counting_get(VkDevice d, const char* name) {
    const std::string_view n(name);
    if (n == "vkAllocateMemory") {
        return between<PFN_vkAllocateMemory>(d, name);
    }
    if (n == "vkCreateBuffer") {
        return between<PFN_vkCreateBuffer>(d, name);
    }
    if (n == "vkCreateImage") {
        return between<PFN_vkCreateImage>(d, name);
    }
    if (n == "vkCreateImageView") {
        return between<PFN_vkCreateImageView>(d, name);
    }
    if (n == "vkCreateSampler") {
        return between<PFN_vkCreateSampler>(d, name);
    }
    if (n == "vkCreateDescriptorPool") {
        return between<PFN_vkCreateDescriptorPool>(d, name);
    }
    if (n == "vkCreateDescriptorSetLayout") {
        return between<PFN_vkCreateDescriptorSetLayout>(d, name);
    }
    if (n == "vkCreatePipelineLayout") {
        return between<PFN_vkCreatePipelineLayout>(d, name);
    }
    if (n == "vkCreateShaderModule") {
        return between<PFN_vkCreateShaderModule>(d, name);
    }
    if (n == "vkCreateCommandPool") {
        return between<PFN_vkCreateCommandPool>(d, name);
    }
    if (n == "vkCreateFence") {
        return between<PFN_vkCreateFence>(d, name);
    }
    if (n == "vkAllocateDescriptorSets") {
        return reinterpret_cast<PFN_vkVoidFunction>(&count_sets);
    }
    return next_get(d, name);
}

TEST_F(one_device, a_steady_frame_makes_nothing) {
    auto description = headless_->description();
    next_get = reinterpret_cast<PFN_vkGetDeviceProcAddr>(
        description.get_instance_proc_addr(description.instance, "vkGetDeviceProcAddr"));
    description.get_device_proc_addr = counting_get;
    device d = must(device::create(description));
    ASSERT_EQ(counted_names.size(), 11u);

    const std::uint32_t n = 20000;
    const auto counts = upload(d, std::vector<std::uint32_t>(n, 1));
    const auto payloads = must(d.create_buffer(n * 16));
    const auto list = must(d.create_buffer(n * 96));
    const auto record = must(d.create_buffer(16));
    const auto picture = must(d.create_image({16, 16, image_format::rgba8}));
    const auto vertices = upload(d, std::vector<probe_vertex>(3));
    const auto tints = upload(d, std::vector<glm::vec4>(1));
    const std::vector<std::uint32_t> fresh(n, 1);
    const std::vector<range> levels{{0, 10}, {10, 20}, {30, 5000}, {5030, 7}};
    const auto values = must(d.create_buffer(n * 4));
    const auto corners = must(d.create_buffer(3 * 16));
    const auto pixels = must(d.create_buffer(16 * 16 * 4));
    const auto numbers = must(d.create_buffer(16 * 16 * 4));
    const auto surfaces = upload(d, std::vector<gather_triangle>(100));
    const auto points = upload(d, std::vector<gather_sample>(100));
    const auto hits = must(d.create_buffer(100 * sizeof(gather_hit)));
    ray_bundle bundle;
    bundle.centre.w = 1;
    bundle.up.w = 8;
    bundle.direction.w = 16;
    const auto frame = [&] {
        go(d, [&](auto& r) {
            r.upload(view<device>(counts), bytes_of(fresh));
            r.map(kernels::probe_level{},
                  {view<device>(payloads), view<device>(values), view<device>(values)},
                  std::span<const range>(levels));
            r.expand(probe_strips{1, 1}, {view<device>(counts), view<device>(payloads)},
                     range{0, n}, {view<device>(list), view<device>(record), padding::compact});
            r.expand(probe_strips{1, 1}, {view<device>(counts), view<device>(payloads)},
                     counted<device>{view<device>(record), n},
                     {view<device>(list), view<device>(record), padding::compact});
            r.draw(probe_surface{},
                   bound<probe_surface>{view<device>(vertices), view<device>(tints)}, {},
                   draw_geometry<device>{{}, 0, 3, 0, {}},
                   draw_target<device>{&picture, nullptr, glm::vec4{0}, {}}, draw_state{});
            r.peel(kernels::probe_peel{}, bound<kernels::probe_peel>{view<device>(corners)},
                   range{0, 1},
                   peeled_layer<device>{16, 16, view<device>(pixels), view<device>(numbers),
                                        view<device>(record)});
            r.sort(view<device>(values), view<device>(payloads), 20);
            r.resolve(bundle,
                      bundle_work<device>{
                          view<device>(surfaces), {}, view<device>(points), view<device>(hits)});
        });
    };
    made = 0;
    frame();
    EXPECT_GT(made.load(), 5); // the counting works
    made = 0;
    const auto before = d.traffic();
    for (int i = 0; i < 3; ++i) {
        frame();
    }
    EXPECT_EQ(made.load(), 0);
    // Down go the counts and the two runs of ranges, and nothing comes up.
    EXPECT_EQ(d.traffic().up - before.up, 3 * (n * 4ull + 2 * 8));
    EXPECT_EQ(d.traffic().down, before.down);
}

// ---- Errors

TEST_F(one_device, sizes_beyond_the_device_are_errors_with_numbers) {
    for (const std::uint64_t size : {1ull << 45, ~0ull}) {
        const auto buffer = gpu().create_buffer(size);
        ASSERT_FALSE(buffer);
        EXPECT_EQ(buffer.error().code, error_code::out_of_memory);
        EXPECT_NE(buffer.error().message.find(std::to_string(size)), std::string::npos)
            << buffer.error().message;
    }
    for (const image_description what : {image_description{1u << 30, 1, image_format::rgba8},
                                         image_description{0, 4, image_format::rgba8}}) {
        const auto image = gpu().create_image(what);
        ASSERT_FALSE(image);
        EXPECT_EQ(image.error().code, error_code::out_of_memory);
    }
    EXPECT_TRUE(gpu().create_buffer(16)); // the device goes on
}

TEST_F(one_device, what_is_not_there_is_unavailable) {
    vulkan::headless_options o;
    o.device = 1000;
    const auto absent = vulkan::headless::create(std::move(o));
    ASSERT_FALSE(absent);
    EXPECT_EQ(absent.error().code, error_code::unavailable);
    EXPECT_NE(absent.error().message.find("1000"), std::string::npos);
}

VKAPI_ATTR VkResult VKAPI_CALL lost_submit(VkQueue, std::uint32_t, const VkSubmitInfo2*, VkFence) {
    return VK_ERROR_DEVICE_LOST;
}
VKAPI_ATTR VkResult VKAPI_CALL no_memory(VkDevice, const VkMemoryAllocateInfo*,
                                         const VkAllocationCallbacks*, VkDeviceMemory*) {
    return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}
bool memory_fails = false;
VKAPI_ATTR VkResult VKAPI_CALL sometimes_memory(VkDevice d, const VkMemoryAllocateInfo* info,
                                                const VkAllocationCallbacks* callbacks,
                                                VkDeviceMemory* out) {
    return (memory_fails ? no_memory : next_allocate_memory)(d, info, callbacks, out);
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL failing_get(VkDevice d, const char* name) {
    if (std::string_view(name) == "vkQueueSubmit2") {
        return reinterpret_cast<PFN_vkVoidFunction>(&lost_submit);
    }
    if (std::string_view(name) == "vkAllocateMemory") {
        next_allocate_memory = reinterpret_cast<PFN_vkAllocateMemory>(next_get(d, name));
        return reinterpret_cast<PFN_vkVoidFunction>(&sometimes_memory);
    }
    return next_get(d, name);
}

device failing_device(const vulkan::headless& on) {
    auto description = on.description();
    next_get = reinterpret_cast<PFN_vkGetDeviceProcAddr>(
        description.get_instance_proc_addr(description.instance, "vkGetDeviceProcAddr"));
    description.get_device_proc_addr = failing_get;
    return must(device::create(description));
}

template <class T>
void expect_lost(const result<T>& r) {
    ASSERT_FALSE(r);
    EXPECT_EQ(r.error().code, error_code::device_lost);
    EXPECT_NE(r.error().message.find("VK_ERROR_DEVICE_LOST"), std::string::npos);
}

TEST_F(one_device, a_lost_device_stays_lost_and_says_so) {
    device d = failing_device(*headless_);
    auto b = must(d.create_buffer(64));
    auto started = must(d.begin());
    auto r = must(d.begin());
    r.upload(view<device>(b), bytes_of(std::vector<std::uint32_t>(16)));
    expect_lost(d.submit(r));
    started.copy({&b, 0, 16}, {&b, 16, 16});
    expect_lost(d.submit(started));
    expect_lost(d.begin());
    expect_lost(d.record_into(VK_NULL_HANDLE));
    expect_lost(d.create_buffer(64));
    expect_lost(d.create_image({4, 4, image_format::rgba8}));
    expect_lost(d.upload(b, 0, bytes_of(std::vector<std::uint32_t>(16))));
    std::byte bytes[4];
    expect_lost(d.download(b, 0, bytes));
}

TEST_F(one_device, a_recorder_keeps_its_first_error_until_submit) {
    device d = failing_device(*headless_);
    const auto b = must(d.create_buffer(64));
    auto r = must(d.begin());
    memory_fails = true;
    r.upload(view<device>(b), bytes_of(std::vector<std::uint32_t>(16))); // no staging memory
    memory_fails = false;
    r.copy({&b, 0, 16}, {&b, 16, 16});
    const auto submitted = d.submit(r);
    ASSERT_FALSE(submitted);
    EXPECT_EQ(submitted.error().code, error_code::out_of_memory);
    EXPECT_NE(submitted.error().message.find("VK_ERROR_OUT_OF_DEVICE_MEMORY"), std::string::npos)
        << submitted.error().message;
}

TEST_F(one_device, empty_buffers_are_buffers) {
    const auto b = must(gpu().create_buffer(0));
    EXPECT_EQ(b.size_bytes(), 0u);
    must(gpu().upload(b, 0, {}));
    go(gpu(), [&](auto& r) {
        r.map(probe_map{}, {view<device>(b), view<device>(b), view<device>(b), view<device>(b)},
              range{});
        r.copy(view<device>(b), view<device>(b));
        r.upload(view<device>(b), {});
    });
}

} // namespace
} // namespace skybark::testing
