#pragma once
// A Vulkan device as somebody else's program would have it, made with plain calls and none of
// ours, under the same validation.

#include "support.hpp"

#include <dlfcn.h>

namespace skybark::testing {

class raw_vulkan {
  public:
    explicit raw_vulkan(log& to) : log_(to) {
        library_ = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
        if (library_) {
            get = reinterpret_cast<PFN_vkGetInstanceProcAddr>(
                dlsym(library_, "vkGetInstanceProcAddr"));
            make_instance();
        }
        if (instance) {
            make_device();
        }
    }
    raw_vulkan(const raw_vulkan&) = delete;
    raw_vulkan& operator=(const raw_vulkan&) = delete;
    ~raw_vulkan() {
        if (device) {
            call<PFN_vkDestroyCommandPool>("vkDestroyCommandPool")(device, pool_, nullptr);
            call<PFN_vkDestroyFence>("vkDestroyFence")(device, fence_, nullptr);
            call<PFN_vkDestroyDevice>("vkDestroyDevice")(device, nullptr);
        }
        if (instance) {
            call<PFN_vkDestroyDebugUtilsMessengerEXT>("vkDestroyDebugUtilsMessengerEXT")(
                instance, messenger_, nullptr);
            call<PFN_vkDestroyInstance>("vkDestroyInstance")(instance, nullptr);
        }
        if (library_) {
            dlclose(library_);
        }
    }

    template <class Function>
    [[nodiscard]] Function call(const char* name) const {
        return reinterpret_cast<Function>(get(instance, name));
    }

    [[nodiscard]] vulkan::device_description description() const {
        vulkan::device_description d;
        d.instance = instance;
        d.physical_device = physical;
        d.device = device;
        d.queue = queue;
        d.queue_family = 0;
        d.get_instance_proc_addr = get;
        d.synchronization2 = d.dynamic_rendering = true;
        return d;
    }

    [[nodiscard]] VkCommandBuffer begin() {
        auto info =
            vulkan::make<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
        EXPECT_EQ(VK_SUCCESS,
                  call<PFN_vkBeginCommandBuffer>("vkBeginCommandBuffer")(commands_, &info));
        return commands_;
    }

    void submit_and_wait() {
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkEndCommandBuffer>("vkEndCommandBuffer")(commands_));
        auto info = vulkan::make<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
        info.commandBufferCount = 1;
        info.pCommandBuffers = &commands_;
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkQueueSubmit>("vkQueueSubmit")(queue, 1, &info, fence_));
        EXPECT_EQ(VK_SUCCESS,
                  call<PFN_vkWaitForFences>("vkWaitForFences")(device, 1, &fence_, VK_TRUE, ~0ull));
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkResetFences>("vkResetFences")(device, 1, &fence_));
    }

    /// Memory of type 0: a software device has no other, and every device's first will do.
    [[nodiscard]] VkDeviceMemory memory_for(const VkMemoryRequirements& need) {
        auto info = vulkan::make<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
        info.allocationSize = need.size;
        while ((need.memoryTypeBits >> info.memoryTypeIndex & 1u) == 0) {
            ++info.memoryTypeIndex;
        }
        VkDeviceMemory memory = VK_NULL_HANDLE;
        EXPECT_EQ(VK_SUCCESS,
                  call<PFN_vkAllocateMemory>("vkAllocateMemory")(device, &info, nullptr, &memory));
        return memory;
    }

    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    PFN_vkGetInstanceProcAddr get = nullptr;

  private:
    void make_instance() {
        auto application = vulkan::make<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
        application.apiVersion = VK_API_VERSION_1_3;
        const VkValidationFeatureEnableEXT enabled[] = {
            VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
        auto features =
            vulkan::make<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
        features.enabledValidationFeatureCount = 1;
        features.pEnabledValidationFeatures = enabled;
        const char* const layers[] = {"VK_LAYER_KHRONOS_validation"};
        const char* const extensions[] = {"VK_EXT_debug_utils", "VK_EXT_validation_features"};
        auto info = vulkan::make<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
        info.pNext = &features;
        info.pApplicationInfo = &application;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = layers;
        info.enabledExtensionCount = 2;
        info.ppEnabledExtensionNames = extensions;
        if (call<PFN_vkCreateInstance>("vkCreateInstance")(&info, nullptr, &instance) !=
            VK_SUCCESS) {
            instance = VK_NULL_HANDLE;
            return;
        }
        auto messenger = vulkan::make<VkDebugUtilsMessengerCreateInfoEXT>(
            VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
        messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                                    VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
        messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
        messenger.pUserData = &log_;
        messenger.pfnUserCallback =
            [](VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
               const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) -> VkBool32 {
            static_cast<log*>(user)->messages.emplace_back(data->pMessage);
            return VK_FALSE;
        };
        EXPECT_EQ(VK_SUCCESS,
                  call<PFN_vkCreateDebugUtilsMessengerEXT>("vkCreateDebugUtilsMessengerEXT")(
                      instance, &messenger, nullptr, &messenger_));
    }

    void make_device() {
        std::uint32_t count = 1;
        const VkResult listed = call<PFN_vkEnumeratePhysicalDevices>("vkEnumeratePhysicalDevices")(
            instance, &count, &physical);
        if (listed < 0 || count == 0) {
            return;
        }
        auto features13 = vulkan::make<VkPhysicalDeviceVulkan13Features>(
            VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
        features13.synchronization2 = features13.dynamicRendering = VK_TRUE;
        const float priority = 1;
        auto queue_info =
            vulkan::make<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
        queue_info.queueCount = 1;
        queue_info.pQueuePriorities = &priority;
        auto info = vulkan::make<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
        info.pNext = &features13;
        info.queueCreateInfoCount = 1;
        info.pQueueCreateInfos = &queue_info;
        if (call<PFN_vkCreateDevice>("vkCreateDevice")(physical, &info, nullptr, &device) !=
            VK_SUCCESS) {
            device = VK_NULL_HANDLE;
            return;
        }
        call<PFN_vkGetDeviceQueue>("vkGetDeviceQueue")(device, 0, 0, &queue);
        make_command_buffer();
    }

    void make_command_buffer() {
        auto pool =
            vulkan::make<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
        pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkCreateCommandPool>("vkCreateCommandPool")(
                                  device, &pool, nullptr, &pool_));
        auto info = vulkan::make<VkCommandBufferAllocateInfo>(
            VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
        info.commandPool = pool_;
        info.commandBufferCount = 1;
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkAllocateCommandBuffers>("vkAllocateCommandBuffers")(
                                  device, &info, &commands_));
        const auto fence = vulkan::make<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
        EXPECT_EQ(VK_SUCCESS,
                  call<PFN_vkCreateFence>("vkCreateFence")(device, &fence, nullptr, &fence_));
    }

    log& log_;
    void* library_ = nullptr;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
};

} // namespace skybark::testing
