// A program that has a VkDevice already, as engines do: it lends it, records a tree's branches into
// its own command buffer between its own commands, and submits that itself.
//
// What is Skybark's is in `main` and `describe`; the rest is what such a program has anyway.

#include <skybark/cpu/cpu.hpp>
#include <skybark/skybark.hpp>
#include <skybark/vulkan/vulkan.hpp>

#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <vector>

namespace {

namespace trees = skybark::trees;

constexpr int no_such_backend = 3;

[[noreturn]] void stop(int status, const std::string& why) {
    std::fprintf(stderr, "%s\n", why.c_str());
    std::exit(status);
}
template <class T>
T value_of(skybark::result<T> made) {
    if (!made) {
        stop(1, made.error().message);
    }
    return std::move(*made);
}
void check(VkResult returned, const char* what) {
    if (returned != VK_SUCCESS) {
        stop(no_such_backend, std::string(what) + " returned " + std::to_string(returned) + ".");
    }
}

/// The engine: an instance, a device, a queue, a command buffer, and memory to read back from.
struct engine {
    PFN_vkGetInstanceProcAddr get = nullptr;
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkBuffer readback = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    void* mapped = nullptr;

    template <class Function>
    [[nodiscard]] Function call(const char* name) const {
        return reinterpret_cast<Function>(get(instance, name));
    }

    engine() {
        void* library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
        if (library == nullptr) {
            stop(no_such_backend, "There is no Vulkan on this machine.");
        }
        get = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
        VkApplicationInfo application{};
        application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
        application.apiVersion = VK_API_VERSION_1_3;
        VkInstanceCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
        info.pApplicationInfo = &application;
        check(call<PFN_vkCreateInstance>("vkCreateInstance")(&info, nullptr, &instance),
              "vkCreateInstance");
        std::uint32_t one = 1;
        call<PFN_vkEnumeratePhysicalDevices>("vkEnumeratePhysicalDevices")(instance, &one,
                                                                           &physical_device);
        if (one == 0) {
            stop(no_such_backend, "There is no Vulkan device on this machine.");
        }
        make_device();
        make_commands();
    }

    /// Skybark needs Vulkan 1.3 with these two features, and a queue for graphics and compute: as
    /// family 0 is nearly everywhere.
    void make_device() {
        VkPhysicalDeviceVulkan13Features features{};
        features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
        features.synchronization2 = features.dynamicRendering = VK_TRUE;
        const float priority = 1;
        VkDeviceQueueCreateInfo queue_info{};
        queue_info.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
        queue_info.queueCount = 1;
        queue_info.pQueuePriorities = &priority;
        VkDeviceCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
        info.pNext = &features;
        info.queueCreateInfoCount = 1;
        info.pQueueCreateInfos = &queue_info;
        check(call<PFN_vkCreateDevice>("vkCreateDevice")(physical_device, &info, nullptr, &device),
              "vkCreateDevice");
        call<PFN_vkGetDeviceQueue>("vkGetDeviceQueue")(device, 0, 0, &queue);
    }

    void make_commands() {
        VkCommandPoolCreateInfo pool_info{};
        pool_info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
        check(call<PFN_vkCreateCommandPool>("vkCreateCommandPool")(device, &pool_info, nullptr,
                                                                   &pool),
              "vkCreateCommandPool");
        VkCommandBufferAllocateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
        info.commandPool = pool;
        info.commandBufferCount = 1;
        check(call<PFN_vkAllocateCommandBuffers>("vkAllocateCommandBuffers")(device, &info,
                                                                             &commands),
              "vkAllocateCommandBuffers");
    }

    void make_readback(VkDeviceSize size) {
        VkBufferCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
        info.size = size;
        info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
        check(call<PFN_vkCreateBuffer>("vkCreateBuffer")(device, &info, nullptr, &readback),
              "vkCreateBuffer");
        VkMemoryRequirements need{};
        call<PFN_vkGetBufferMemoryRequirements>("vkGetBufferMemoryRequirements")(device, readback,
                                                                                 &need);
        VkPhysicalDeviceMemoryProperties has{};
        call<PFN_vkGetPhysicalDeviceMemoryProperties>("vkGetPhysicalDeviceMemoryProperties")(
            physical_device, &has);
        constexpr VkMemoryPropertyFlags wanted =
            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        VkMemoryAllocateInfo memory_info{};
        memory_info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
        memory_info.allocationSize = need.size;
        std::uint32_t& type = memory_info.memoryTypeIndex;
        while ((need.memoryTypeBits >> type & 1u) == 0 ||
               (has.memoryTypes[type].propertyFlags & wanted) != wanted) {
            ++type; // Vulkan promises one
        }
        check(
            call<PFN_vkAllocateMemory>("vkAllocateMemory")(device, &memory_info, nullptr, &memory),
            "vkAllocateMemory");
        check(call<PFN_vkBindBufferMemory>("vkBindBufferMemory")(device, readback, memory, 0),
              "vkBindBufferMemory");
        check(call<PFN_vkMapMemory>("vkMapMemory")(device, memory, 0, VK_WHOLE_SIZE, 0, &mapped),
              "vkMapMemory");
    }

    void begin() const {
        VkCommandBufferBeginInfo info{};
        info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
        check(call<PFN_vkBeginCommandBuffer>("vkBeginCommandBuffer")(commands, &info),
              "vkBeginCommandBuffer");
    }

    void barrier(VkPipelineStageFlags from, VkAccessFlags wrote, VkPipelineStageFlags to,
                 VkAccessFlags will) const {
        VkMemoryBarrier memory_barrier{};
        memory_barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
        memory_barrier.srcAccessMask = wrote;
        memory_barrier.dstAccessMask = will;
        call<PFN_vkCmdPipelineBarrier>("vkCmdPipelineBarrier")(
            commands, from, to, 0, 1, &memory_barrier, 0, nullptr, 0, nullptr);
    }

    void submit_and_wait() const {
        check(call<PFN_vkEndCommandBuffer>("vkEndCommandBuffer")(commands), "vkEndCommandBuffer");
        VkSubmitInfo info{};
        info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
        info.commandBufferCount = 1;
        info.pCommandBuffers = &commands;
        check(call<PFN_vkQueueSubmit>("vkQueueSubmit")(queue, 1, &info, VK_NULL_HANDLE),
              "vkQueueSubmit");
        check(call<PFN_vkQueueWaitIdle>("vkQueueWaitIdle")(queue), "vkQueueWaitIdle");
    }

    ~engine() {
        call<PFN_vkDestroyBuffer>("vkDestroyBuffer")(device, readback, nullptr);
        call<PFN_vkFreeMemory>("vkFreeMemory")(device, memory, nullptr);
        call<PFN_vkDestroyCommandPool>("vkDestroyCommandPool")(device, pool, nullptr);
        call<PFN_vkDestroyDevice>("vkDestroyDevice")(device, nullptr);
        call<PFN_vkDestroyInstance>("vkDestroyInstance")(instance, nullptr);
    }
};

/// What of the engine is lent. Skybark owns none of it.
skybark::vulkan::device_description describe(const engine& engine) {
    skybark::vulkan::device_description lent;
    lent.instance = engine.instance;
    lent.physical_device = engine.physical_device;
    lent.device = engine.device;
    lent.queue = engine.queue;
    lent.queue_family = 0;
    lent.get_instance_proc_addr = engine.get;
    lent.synchronization2 = lent.dynamic_rendering = true; // enabled above
    return lent;
}

/// The same vertices from the CPU, to compare with.
std::vector<skybark::surface_vertex> from_the_cpu(const trees::skeleton& skeleton) {
    skybark::cpu::device device;
    const auto mesh =
        value_of(trees::branch_mesh<skybark::cpu::device>::create(device, skeleton, {}));
    const auto done = skybark::run(device, [&](auto& recorder) { mesh.record(recorder); });
    const auto& part = mesh.parts().front();
    std::vector<skybark::surface_vertex> vertices(part.vertex_count);
    if (!done || !skybark::read_back<skybark::cpu::device, skybark::surface_vertex>(
                     device, part.vertices, vertices)) {
        stop(1, "The CPU made no vertices.");
    }
    return vertices;
}

} // namespace

int main() {
    const auto skeleton =
        value_of(trees::grow(trees::quaking_aspen(), 1).and_then([](const auto& grown) {
            return trees::build_skeleton(grown);
        }));
    engine engine;
    std::size_t count = 0;
    std::size_t differ = 0;
    {
        // The device, and all that it makes, goes before the VkDevice does.
        auto device = value_of(skybark::vulkan::device::create(describe(engine)));
        const auto mesh =
            value_of(trees::branch_mesh<skybark::vulkan::device>::create(device, skeleton, {}));
        const auto& part = mesh.parts().front();
        const VkDeviceSize bytes = part.vertex_count * sizeof(skybark::surface_vertex);
        engine.make_readback(bytes);

        engine.begin();
        // … whatever the engine does before …
        auto recorder = value_of(device.record_into(engine.commands));
        mesh.record(recorder);
        // Nothing was submitted. The ticket keeps temporaries until the command buffer has run.
        const skybark::vulkan::ticket ticket = value_of(device.finish(recorder));
        // What was recorded is visible to all that comes next in the queue: here, a copy.
        const VkBufferCopy region{0, 0, bytes};
        engine.call<PFN_vkCmdCopyBuffer>("vkCmdCopyBuffer")(engine.commands, part.vertices.handle(),
                                                            engine.readback, 1, &region);
        engine.barrier(VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
        engine.submit_and_wait();

        const std::vector<skybark::surface_vertex> expected = from_the_cpu(skeleton);
        const auto* got = static_cast<const skybark::surface_vertex*>(engine.mapped);
        count = expected.size();
        for (std::size_t i = 0; i < count; ++i) {
            const float apart = glm::length(got[i].position - expected[i].position);
            differ += apart <= 1e-5f ? 0 : 1; // m; counts what is no number as well
        }
        std::printf("%zu vertices of a tree on %s, in the engine's own command buffer; %zu are not "
                    "where the CPU has them\n",
                    count, device.device_name().c_str(), differ);
    }
    return count != 0 && differ == 0 ? 0 : 1;
}
