// A device in somebody else's program: names and labels on all that it makes, the caller's memory,
// log and zones.

#include "raw_vulkan.hpp"
#include "support/every_pattern.hpp"
#include "support/hook_log.hpp"

#include <map>

namespace skybark::testing {
namespace {

using support::hook_log;

/// An object as Vulkan names it.
using object = std::pair<VkObjectType, std::uint64_t>;

/// What passes between a device and Vulkan. There is one at a time: Vulkan's functions have no room
/// for a pointer of ours.
struct spy {
    PFN_vkGetInstanceProcAddr instance_proc = nullptr;
    PFN_vkGetDeviceProcAddr device_proc = nullptr;
    const VkAllocationCallbacks* callbacks = nullptr; ///< that every call should have

    std::map<object, bool> alive; ///< what was made, and whether it has a name
    std::map<VkObjectType, int> made;
    int other_callbacks = 0;
    std::map<VkCommandBuffer, int> labels; ///< that are open
    std::set<std::string> label_names;
    int regions = 0;
    bool reject_modules = false;
    bool lose_device = false;
};
spy* current = nullptr;

template <class Handle>
[[nodiscard]] object object_of(VkObjectType type, Handle handle) {
    return {type, (std::uint64_t)handle}; // a pointer or an integer
}
template <class Handle>
void note_made(VkObjectType type, Handle handle) {
    const auto [at, is_new] = current->alive.try_emplace(object_of(type, handle), false);
    EXPECT_TRUE(is_new) << "made twice: object type " << type;
    ++current->made[type];
}
void note_callbacks(const VkAllocationCallbacks* given) {
    current->other_callbacks += given != current->callbacks ? 1 : 0;
}
void note_gone(const object& what) {
    const auto at = current->alive.find(what);
    if (what.second == 0 || at == current->alive.end()) {
        ADD_FAILURE() << "destroyed, but not made: object type " << what.first;
        return;
    }
    EXPECT_TRUE(at->second) << "went without a name: object type " << what.first;
    current->alive.erase(at);
}

// Functions of the shapes that Vulkan has, in front of the real ones.
template <class Function, VkObjectType Type>
struct front;
template <class Info, class Handle, VkObjectType Type>
struct front<VkResult(VKAPI_PTR*)(VkDevice, const Info*, const VkAllocationCallbacks*, Handle*),
             Type> {
    static inline VkResult(VKAPI_PTR* real)(VkDevice, const Info*, const VkAllocationCallbacks*,
                                            Handle*) = nullptr;
    static VkResult VKAPI_CALL call(VkDevice device, const Info* info,
                                    const VkAllocationCallbacks* callbacks, Handle* made) {
        note_callbacks(callbacks);
        if (Type == VK_OBJECT_TYPE_SHADER_MODULE && current->reject_modules) {
            return VK_ERROR_INVALID_SHADER_NV;
        }
        const VkResult done = real(device, info, callbacks, made);
        if (done == VK_SUCCESS) {
            note_made(Type, *made);
        }
        return done;
    }
};
template <class Handle, VkObjectType Type>
struct front<void(VKAPI_PTR*)(VkDevice, Handle, const VkAllocationCallbacks*), Type> {
    static inline void(VKAPI_PTR* real)(VkDevice, Handle, const VkAllocationCallbacks*) = nullptr;
    static void VKAPI_CALL call(VkDevice device, Handle gone,
                                const VkAllocationCallbacks* callbacks) {
        note_callbacks(callbacks);
        note_gone(object_of(Type, gone));
        real(device, gone, callbacks);
    }
};
template <class Info, VkObjectType Type>
struct front<VkResult(VKAPI_PTR*)(VkDevice, VkPipelineCache, std::uint32_t, const Info*,
                                  const VkAllocationCallbacks*, VkPipeline*),
             Type> {
    static inline VkResult(VKAPI_PTR* real)(VkDevice, VkPipelineCache, std::uint32_t, const Info*,
                                            const VkAllocationCallbacks*, VkPipeline*) = nullptr;
    static VkResult VKAPI_CALL call(VkDevice device, VkPipelineCache cache, std::uint32_t count,
                                    const Info* infos, const VkAllocationCallbacks* callbacks,
                                    VkPipeline* made) {
        note_callbacks(callbacks);
        const VkResult done = real(device, cache, count, infos, callbacks, made);
        for (std::uint32_t i = 0; i < count; ++i) {
            note_made(Type, made[i]);
        }
        return done;
    }
};
template <class Info, class Handle, VkObjectType Type>
struct front<VkResult(VKAPI_PTR*)(VkDevice, const Info*, Handle*), Type> { // sets, command buffers
    static inline VkResult(VKAPI_PTR* real)(VkDevice, const Info*, Handle*) = nullptr;
    static std::uint32_t count_of(const VkDescriptorSetAllocateInfo& info) {
        return info.descriptorSetCount;
    }
    static std::uint32_t count_of(const VkCommandBufferAllocateInfo& info) {
        return info.commandBufferCount;
    }
    static VkResult VKAPI_CALL call(VkDevice device, const Info* info, Handle* made) {
        const VkResult done = real(device, info, made);
        for (std::uint32_t i = 0; i < count_of(*info); ++i) {
            note_made(Type, made[i]);
        }
        return done;
    }
};

VkResult VKAPI_CALL set_name(VkDevice device, const VkDebugUtilsObjectNameInfoEXT* info) {
    const auto at = current->alive.find({info->objectType, info->objectHandle});
    EXPECT_NE(at, current->alive.end()) << "a name for something else: " << info->pObjectName;
    if (at != current->alive.end()) {
        at->second = std::string_view(info->pObjectName).starts_with("skybark ");
    }
    const auto real = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(
        current->device_proc(device, "vkSetDebugUtilsObjectNameEXT"));
    return real(device, info);
}

PFN_vkCmdBeginDebugUtilsLabelEXT real_begin_label = nullptr;
PFN_vkCmdEndDebugUtilsLabelEXT real_end_label = nullptr;
PFN_vkQueueSubmit2 real_submit = nullptr;
void VKAPI_CALL begin_label(VkCommandBuffer commands, const VkDebugUtilsLabelEXT* label) {
    ++current->labels[commands];
    ++current->regions;
    current->label_names.insert(label->pLabelName);
    real_begin_label(commands, label);
}
void VKAPI_CALL end_label(VkCommandBuffer commands) {
    EXPECT_GT(current->labels[commands], 0) << "a label ends that did not begin";
    --current->labels[commands];
    real_end_label(commands);
}
VkResult VKAPI_CALL submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* infos,
                           VkFence fence) {
    for (const auto& [commands, open] : current->labels) {
        EXPECT_EQ(open, 0) << "submitted with an open label";
    }
    return current->lose_device ? VK_ERROR_DEVICE_LOST : real_submit(queue, count, infos, fence);
}

template <class Function, VkObjectType Type>
PFN_vkVoidFunction put_in_front(PFN_vkVoidFunction real) {
    using in_front = front<Function, Type>;
    in_front::real = reinterpret_cast<Function>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(&in_front::call);
}

using in_front_type = PFN_vkVoidFunction (*)(PFN_vkVoidFunction real);
#define FRONT(name, type)                                                                          \
    { "vk" #name, &put_in_front<PFN_vk##name, VK_OBJECT_TYPE_##type> }
const std::map<std::string, in_front_type> fronts{
    FRONT(CreateBuffer, BUFFER),
    FRONT(DestroyBuffer, BUFFER),
    FRONT(AllocateMemory, DEVICE_MEMORY),
    FRONT(FreeMemory, DEVICE_MEMORY),
    FRONT(CreateImage, IMAGE),
    FRONT(DestroyImage, IMAGE),
    FRONT(CreateImageView, IMAGE_VIEW),
    FRONT(DestroyImageView, IMAGE_VIEW),
    FRONT(CreateSampler, SAMPLER),
    FRONT(DestroySampler, SAMPLER),
    FRONT(CreateDescriptorSetLayout, DESCRIPTOR_SET_LAYOUT),
    FRONT(DestroyDescriptorSetLayout, DESCRIPTOR_SET_LAYOUT),
    FRONT(CreatePipelineLayout, PIPELINE_LAYOUT),
    FRONT(DestroyPipelineLayout, PIPELINE_LAYOUT),
    FRONT(CreateDescriptorPool, DESCRIPTOR_POOL),
    FRONT(DestroyDescriptorPool, DESCRIPTOR_POOL),
    FRONT(AllocateDescriptorSets, DESCRIPTOR_SET),
    FRONT(CreateShaderModule, SHADER_MODULE),
    FRONT(DestroyShaderModule, SHADER_MODULE),
    FRONT(CreateComputePipelines, PIPELINE),
    FRONT(CreateGraphicsPipelines, PIPELINE),
    FRONT(DestroyPipeline, PIPELINE),
    FRONT(CreateCommandPool, COMMAND_POOL),
    FRONT(DestroyCommandPool, COMMAND_POOL),
    FRONT(AllocateCommandBuffers, COMMAND_BUFFER),
    FRONT(CreateFence, FENCE),
    FRONT(DestroyFence, FENCE),
};
#undef FRONT

/// Whether a function makes or destroys something, and so should be in the table above.
[[nodiscard]] bool should_be_in_front(const std::string& name) {
    return name.starts_with("vkCreate") || name.starts_with("vkAllocate") ||
           name.starts_with("vkDestroy") || name.starts_with("vkFree");
}

PFN_vkVoidFunction VKAPI_CALL device_proc(VkDevice device, const char* name) {
    const PFN_vkVoidFunction real = current->device_proc(device, name);
    if (const auto found = fronts.find(name); found != fronts.end() && real) {
        return found->second(real);
    }
    EXPECT_FALSE(should_be_in_front(name)) << name;
    if (std::string_view(name) == "vkQueueSubmit2") {
        real_submit = reinterpret_cast<PFN_vkQueueSubmit2>(real);
        return reinterpret_cast<PFN_vkVoidFunction>(&submit);
    }
    return real;
}

PFN_vkVoidFunction VKAPI_CALL instance_proc(VkInstance instance, const char* name) {
    const std::string_view wanted(name);
    const PFN_vkVoidFunction real = current->instance_proc(instance, name);
    if (wanted == "vkGetDeviceProcAddr") {
        current->device_proc = reinterpret_cast<PFN_vkGetDeviceProcAddr>(real);
        return reinterpret_cast<PFN_vkVoidFunction>(&device_proc);
    }
    if (wanted == "vkSetDebugUtilsObjectNameEXT") {
        return reinterpret_cast<PFN_vkVoidFunction>(&set_name);
    }
    if (wanted == "vkCmdBeginDebugUtilsLabelEXT") {
        real_begin_label = reinterpret_cast<PFN_vkCmdBeginDebugUtilsLabelEXT>(real);
        return reinterpret_cast<PFN_vkVoidFunction>(&begin_label);
    }
    if (wanted == "vkCmdEndDebugUtilsLabelEXT") {
        real_end_label = reinterpret_cast<PFN_vkCmdEndDebugUtilsLabelEXT>(real);
        return reinterpret_cast<PFN_vkVoidFunction>(&end_label);
    }
    return real;
}

/// Host memory that is counted.
struct counted_callbacks {
    counted_callbacks() {
        all.pUserData = this;
        all.pfnAllocation = [](void* user, std::size_t size, std::size_t alignment,
                               VkSystemAllocationScope) {
            ++static_cast<counted_callbacks*>(user)->calls;
            const std::size_t step = std::max(alignment, sizeof(void*));
            return std::aligned_alloc(step, (size + step - 1) / step * step);
        };
        all.pfnReallocation = [](void*, void* old, std::size_t size, std::size_t,
                                 VkSystemAllocationScope) { return std::realloc(old, size); };
        all.pfnFree = [](void*, void* memory) { std::free(memory); };
    }
    VkAllocationCallbacks all{};
    int calls = 0;
};

/// An engine's heap: blocks of a megabyte, cut in order, each freed when it is empty again.
class block_heap {
  public:
    explicit block_heap(const raw_vulkan& on) : raw_(on) {}
    ~block_heap() { EXPECT_TRUE(blocks_.empty()) << "memory that was not given back"; }

    [[nodiscard]] vulkan::memory_hooks to_me() {
        return {this,
                [](void* user, const vulkan::memory_request& request, vulkan::memory_piece& piece) {
                    return static_cast<block_heap*>(user)->allocate(request, piece);
                },
                [](void* user, const vulkan::memory_piece& piece) {
                    static_cast<block_heap*>(user)->free(piece);
                }};
    }

    int pieces = 0;
    int large_offsets = 0;
    std::set<vulkan::memory_kind> kinds;
    bool empty = false; ///< there is nothing more

  private:
    struct block {
        VkDeviceMemory memory = VK_NULL_HANDLE;
        void* mapped = nullptr;
        VkDeviceSize size = 0;
        VkDeviceSize used = 0;
        int pieces = 0;
        std::uint32_t type = 0;
    };

    VkResult allocate(const vulkan::memory_request& request, vulkan::memory_piece& piece) {
        if (empty) {
            return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        }
        EXPECT_NE(request.buffer != VK_NULL_HANDLE, request.image != VK_NULL_HANDLE);
        EXPECT_TRUE((request.need.memoryTypeBits >> request.type & 1u) != 0);
        kinds.insert(request.kind);
        for (block* b : blocks_) {
            if (b->type == request.type && take(*b, request, piece)) {
                return VK_SUCCESS;
            }
        }
        auto* const made = new block;
        made->type = request.type;
        made->size = std::max<VkDeviceSize>(1 << 20, request.need.size);
        auto info = vulkan::make<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
        info.allocationSize = made->size;
        info.memoryTypeIndex = request.type;
        EXPECT_EQ(VK_SUCCESS, raw_.call<PFN_vkAllocateMemory>("vkAllocateMemory")(
                                  raw_.device, &info, nullptr, &made->memory));
        EXPECT_EQ(VK_SUCCESS, raw_.call<PFN_vkMapMemory>("vkMapMemory")(
                                  raw_.device, made->memory, 0, VK_WHOLE_SIZE, 0, &made->mapped));
        blocks_.push_back(made);
        EXPECT_TRUE(take(*made, request, piece));
        return VK_SUCCESS;
    }
    bool take(block& b, const vulkan::memory_request& request, vulkan::memory_piece& piece) {
        const VkDeviceSize step = std::max<VkDeviceSize>(request.need.alignment, 1024);
        const VkDeviceSize at = (b.used + step - 1) / step * step;
        if (at + request.need.size > b.size) {
            return false;
        }
        b.used = at + request.need.size;
        ++b.pieces;
        ++pieces;
        large_offsets += at != 0 ? 1 : 0;
        piece = {b.memory, at, request.mapped ? static_cast<std::byte*>(b.mapped) + at : nullptr,
                 &b};
        return true;
    }
    void free(const vulkan::memory_piece& piece) {
        auto* const of = static_cast<block*>(piece.allocation);
        ASSERT_EQ(of->memory, piece.memory);
        --pieces;
        if (--of->pieces == 0) {
            raw_.call<PFN_vkFreeMemory>("vkFreeMemory")(raw_.device, of->memory, nullptr);
            std::erase(blocks_, of);
            delete of;
        }
    }

    const raw_vulkan& raw_;
    std::vector<block*> blocks_;
};

class vulkan_embedding : public ::testing::Test {
  protected:
    void SetUp() override {
        raw = std::make_unique<raw_vulkan>(log_);
        if (!raw->device) {
            if (vulkan_required()) {
                FAIL() << "no Vulkan device with validation";
            }
            GTEST_SKIP() << "no Vulkan device with validation";
        }
        spy_.instance_proc = raw->get;
        spy_.callbacks = &counted_.all;
        current = &spy_;
    }
    void TearDown() override {
        raw.reset();
        current = nullptr;
        EXPECT_TRUE(log_.messages.empty()) << log_.text();
    }

    [[nodiscard]] vulkan::device_description watched() {
        vulkan::device_description d = raw->description();
        d.get_instance_proc_addr = &instance_proc;
        d.allocation_callbacks = &counted_.all;
        d.debug_utils = true;
        d.hooks = hooks_.to_me();
        return d;
    }

    log log_;
    hook_log hooks_;
    counted_callbacks counted_;
    spy spy_;
    std::unique_ptr<raw_vulkan> raw;
};

TEST_F(vulkan_embedding, all_that_is_made_has_a_name_and_every_pattern_a_label) {
    {
        device gpu = must(device::create(watched()));
        (void)support::run_every_pattern(gpu);
        // In the caller's command buffer as well.
        const support::every_pattern<device> all(gpu);
        const VkCommandBuffer commands = raw->begin();
        auto recorder = must(gpu.record_into(commands));
        all.record(recorder);
        const auto ticket = must(gpu.finish(recorder));
        EXPECT_GT(spy_.labels.count(commands), 0u);
        EXPECT_EQ(spy_.labels[commands], 0);
        raw->submit_and_wait();
        for (const auto& [what, named] : spy_.alive) {
            EXPECT_TRUE(named) << "object type " << what.first;
        }
    }
    for (const VkObjectType type :
         {VK_OBJECT_TYPE_BUFFER, VK_OBJECT_TYPE_DEVICE_MEMORY, VK_OBJECT_TYPE_IMAGE,
          VK_OBJECT_TYPE_IMAGE_VIEW, VK_OBJECT_TYPE_SAMPLER, VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT,
          VK_OBJECT_TYPE_PIPELINE_LAYOUT, VK_OBJECT_TYPE_DESCRIPTOR_POOL,
          VK_OBJECT_TYPE_DESCRIPTOR_SET, VK_OBJECT_TYPE_SHADER_MODULE, VK_OBJECT_TYPE_PIPELINE,
          VK_OBJECT_TYPE_COMMAND_POOL, VK_OBJECT_TYPE_COMMAND_BUFFER, VK_OBJECT_TYPE_FENCE}) {
        EXPECT_GT(spy_.made[type], 0) << "object type " << type;
    }
    // What its pool frees has no function of its own; all else was destroyed.
    for (const auto& [what, named] : spy_.alive) {
        EXPECT_TRUE(what.first == VK_OBJECT_TYPE_DESCRIPTOR_SET ||
                    what.first == VK_OBJECT_TYPE_COMMAND_BUFFER)
            << "object type " << what.first;
    }
    EXPECT_EQ(spy_.other_callbacks, 0) << "calls without the caller's allocation callbacks";
    EXPECT_GT(counted_.calls, 0);
    EXPECT_EQ(spy_.label_names, support::every_patterns_name());
}

TEST_F(vulkan_embedding, tells_what_it_makes_and_every_pattern) {
    {
        device gpu = must(device::create(watched()));
        EXPECT_EQ(hooks_.count(log_level::info, "The vulkan device is "), 1);
        (void)support::run_every_pattern(gpu);
    }
    EXPECT_EQ(hooks_.open, 0);
    EXPECT_GT(hooks_.count(log_level::debug, "one buffer of"), 0);
    EXPECT_GT(hooks_.count(log_level::debug, "one staging buffer of"), 0);
    EXPECT_GT(hooks_.count(log_level::debug, "one scratch buffer of"), 0);
    EXPECT_GT(hooks_.count(log_level::debug, "one image of"), 0);
    EXPECT_GT(hooks_.count(log_level::debug, "one volume of"), 0);
    EXPECT_EQ(hooks_.count(log_level::debug, "has compiled \"map_voxels probe_voxels\" in"), 1);
    EXPECT_EQ(hooks_.count(log_level::error, ""), 0);
    auto zones = support::every_patterns_name();
    zones.insert({"submit", "wait", "download"});
    EXPECT_EQ(hooks_.zones, zones);
}

TEST_F(vulkan_embedding, without_debug_utils_nothing_is_named) {
    auto description = watched();
    description.debug_utils = false;
    {
        device gpu = must(device::create(description));
        const auto in = must(gpu.create_buffer(64));
        const auto out = must(gpu.create_buffer(64));
        go(gpu, [&](auto& r) { r.copy(view<device>(in), view<device>(out)); });
        for (const auto& [what, named] : spy_.alive) {
            EXPECT_FALSE(named);
        }
        for (auto& [what, named] : spy_.alive) {
            named = true; // for the check at their end
        }
    }
    EXPECT_EQ(spy_.regions, 0);
}

TEST_F(vulkan_embedding, a_rejected_program_and_a_lost_device_are_told_and_labels_stay_balanced) {
    {
        device gpu = must(device::create(watched()));
        const support::every_pattern<device> all(gpu);
        spy_.reject_modules = true;
        const auto rejected = run(gpu, [&](auto& r) { all.record(r); });
        ASSERT_FALSE(rejected);
        EXPECT_EQ(rejected.error().code, error_code::shader_rejected);
        EXPECT_EQ(hooks_.count(log_level::error, "No program \"map probe_map\""), 1);
        spy_.reject_modules = false;
        go(gpu, [&](auto& r) { all.record(r); });
        spy_.lose_device = true;
        for (int twice = 0; twice < 2; ++twice) {
            const auto lost = run(gpu, [&](auto& r) { all.record(r); });
            ASSERT_FALSE(lost);
            EXPECT_EQ(lost.error().code, error_code::device_lost);
        }
        EXPECT_EQ(hooks_.count(log_level::error, "was lost"), 1) << "once";
    }
    for (const auto& [commands, open] : spy_.labels) {
        EXPECT_EQ(open, 0);
    }
    EXPECT_EQ(hooks_.open, 0);
}

TEST_F(vulkan_embedding, device_memory_comes_from_the_caller_and_goes_back) {
    std::vector<std::byte> expected;
    {
        device plain = must(device::create(raw->description()));
        expected = support::run_every_pattern(plain);
    }
    for (const bool always_stage : {false, true}) {
        spy_.alive.clear(); // sets and command buffers go with their pools, unseen
        block_heap heap(*raw);
        auto description = watched();
        description.memory = heap.to_me();
        description.always_stage = always_stage;
        {
            device gpu = must(device::create(description));
            EXPECT_EQ(support::run_every_pattern(gpu), expected);
            EXPECT_EQ(spy_.made[VK_OBJECT_TYPE_DEVICE_MEMORY], 0)
                << "memory that we took ourselves";
            EXPECT_GT(heap.pieces, 0);
            EXPECT_GT(heap.large_offsets, 0) << "nothing was ever cut from within a block";
            EXPECT_TRUE(heap.kinds.contains(vulkan::memory_kind::upload));
            EXPECT_TRUE(heap.kinds.contains(vulkan::memory_kind::device));
            EXPECT_TRUE(heap.kinds.contains(vulkan::memory_kind::download));
            heap.empty = true;
            const auto refused = gpu.create_buffer(100000);
            ASSERT_FALSE(refused);
            EXPECT_EQ(refused.error().code, error_code::out_of_memory);
            EXPECT_GT(hooks_.count(log_level::warning, "from its caller"), 0);
        }
        EXPECT_EQ(heap.pieces, 0);
    }
}

} // namespace
} // namespace skybark::testing
