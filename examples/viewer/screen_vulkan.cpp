#include "screen_vulkan.hpp"

#include <algorithm>
#include <array>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <cstring>
#include <GLFW/glfw3.h>
#include <imgui.h>

namespace skybark::viewer {

namespace {

using vulkan::make;

constexpr std::uint32_t most_marks = 16;
constexpr VkFormat image_format_used = VK_FORMAT_R8G8B8A8_UNORM;
constexpr VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
constexpr VkImageSubresourceLayers layer{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};

result<void> check(VkResult returned, const char* doing) {
    if (returned >= 0) {
        return {};
    }
    return fail(
        returned == VK_ERROR_DEVICE_LOST ? error_code::device_lost : error_code::unavailable,
        std::string("Vulkan could not ") + doing + ": " + vulkan::to_string(returned) + ".");
}

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data,
                                          void* user) {
    static_cast<std::vector<std::string>*>(user)->emplace_back(data->pMessage);
    return VK_FALSE;
}

bool has_layer(const char* name) {
    std::uint32_t count = 0;
    (void)vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    (void)vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(), [&](const VkLayerProperties& one) {
        return std::strcmp(one.layerName, name) == 0;
    });
}

bool has_swapchains(VkPhysicalDevice device) {
    std::uint32_t count = 0;
    (void)vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    (void)vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(), [](const VkExtensionProperties& one) {
        return std::strcmp(one.extensionName, VK_KHR_SWAPCHAIN_EXTENSION_NAME) == 0;
    });
}

/// GPUs before software.
int preference(VkPhysicalDevice device) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(device, &properties);
    switch (properties.deviceType) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return 3;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return 2;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return 1;
    default:
        return 0;
    }
}

/// A format of the surface's whose numbers are shown as they are: pictures are developed for it.
VkSurfaceFormatKHR choose_format(const std::vector<VkSurfaceFormatKHR>& formats) {
    for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM}) {
        for (const VkSurfaceFormatKHR& format : formats) {
            if (format.format == wanted) {
                return format;
            }
        }
    }
    return formats.front();
}

} // namespace

result<std::unique_ptr<screen_vulkan>> screen_vulkan::create(const screen_options& options) {
    std::unique_ptr<screen_vulkan> made(new screen_vulkan(options));
    if (!options.headless) {
        auto window = glfw_window::create(window_kind::vulkan, options.width, options.height);
        if (!window) {
            return failure(window.error());
        }
        made->window_ = std::move(*window);
    }
    for (const auto part :
         {&screen_vulkan::make_instance, &screen_vulkan::choose_device, &screen_vulkan::make_device,
          &screen_vulkan::make_ours, &screen_vulkan::make_commands, &screen_vulkan::start_panel}) {
        if (auto done = (made.get()->*part)(); !done) {
            return failure(done.error());
        }
    }
    return made;
}

screen_vulkan::~screen_vulkan() {
    if (device_ != VK_NULL_HANDLE) {
        (void)vkDeviceWaitIdle(device_);
    }
    if (panel_) {
        ImGui_ImplVulkan_Shutdown();
        if (window_ && !options_.scripted) {
            ImGui_ImplGlfw_Shutdown();
        }
    }
    ours_.reset();
    if (device_ != VK_NULL_HANDLE) {
        destroy_swapchain();
        destroy_image();
        vkDestroyDescriptorPool(device_, descriptors_, nullptr);
        vkDestroyRenderPass(device_, pass_, nullptr);
        vkDestroyQueryPool(device_, timestamps_, nullptr);
        vkDestroySemaphore(device_, acquired_, nullptr);
        vkDestroyFence(device_, fence_, nullptr);
        vkDestroyCommandPool(device_, pool_, nullptr);
        vkDestroyDevice(device_, nullptr);
    }
    if (instance_ != VK_NULL_HANDLE) {
        if (messenger_ != VK_NULL_HANDLE) {
            reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(
                instance_, "vkDestroyDebugUtilsMessengerEXT"))(instance_, messenger_, nullptr);
        }
        if (surface_ != VK_NULL_HANDLE) { // else the function is not enabled
            vkDestroySurfaceKHR(instance_, surface_, nullptr);
        }
        vkDestroyInstance(instance_, nullptr);
    }
}

// ---- the device ---------------------------------------------------------------------------------

result<void> screen_vulkan::make_instance() {
    const char* const validation = "VK_LAYER_KHRONOS_validation";
    std::vector<const char*> extensions;
    if (window_) {
        std::uint32_t count = 0;
        const char** needed = glfwGetRequiredInstanceExtensions(&count);
        if (needed == nullptr) {
            return fail(error_code::unavailable,
                        "Vulkan cannot draw in windows on this machine; --headless needs none.");
        }
        extensions.assign(needed, needed + count);
    }
    auto application = make<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
    application.pApplicationName = "skybark_viewer";
    application.apiVersion = VK_API_VERSION_1_3;
    auto info = make<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
    info.pApplicationInfo = &application;
    const VkValidationFeatureEnableEXT enabled[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    auto features = make<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = enabled;
    if (options_.messages != nullptr) {
        if (!has_layer(validation)) {
            return fail(error_code::unavailable,
                        "--check needs the layer VK_LAYER_KHRONOS_validation, which is not "
                        "installed (on Debian: vulkan-validationlayers).");
        }
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
        extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
        info.pNext = &features;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = &validation;
    }
    info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    if (auto done = check(vkCreateInstance(&info, nullptr, &instance_), "start"); !done) {
        return done;
    }
    if (options_.messages != nullptr) {
        if (auto done = make_messenger(); !done) {
            return done;
        }
    }
    return window_
               ? check(glfwCreateWindowSurface(instance_, window_->handle(), nullptr, &surface_),
                       "draw in a window")
               : result<void>{};
}

result<void> screen_vulkan::make_messenger() {
    auto info = make<VkDebugUtilsMessengerCreateInfoEXT>(
        VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
    info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    info.pfnUserCallback = on_message;
    info.pUserData = options_.messages;
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
    return check(create(instance_, &info, nullptr, &messenger_), "listen to its checks");
}

/// Finds the queue's family, too.
bool screen_vulkan::suits(VkPhysicalDevice candidate) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(candidate, &properties);
    if (properties.apiVersion < VK_API_VERSION_1_3 || (window_ && !has_swapchains(candidate))) {
        return false;
    }
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(candidate, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(candidate, &count, families.data());
    for (std::uint32_t i = 0; i < count; ++i) {
        VkBool32 presents = VK_TRUE;
        if (window_ &&
            vkGetPhysicalDeviceSurfaceSupportKHR(candidate, i, surface_, &presents) < 0) {
            continue;
        }
        const VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
        if ((families[i].queueFlags & both) == both && presents == VK_TRUE) {
            family_ = i;
            tick_ = families[i].timestampValidBits > 0
                        ? 1e-9 * static_cast<double>(properties.limits.timestampPeriod)
                        : 0.0;
            return true;
        }
    }
    return false;
}

result<void> screen_vulkan::choose_device() {
    std::uint32_t count = 0;
    (void)vkEnumeratePhysicalDevices(instance_, &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    (void)vkEnumeratePhysicalDevices(instance_, &count, devices.data());
    std::stable_sort(devices.begin(), devices.end(), [](VkPhysicalDevice a, VkPhysicalDevice b) {
        return preference(a) > preference(b);
    });
    const auto found = std::find_if(devices.begin(), devices.end(),
                                    [this](VkPhysicalDevice one) { return suits(one); });
    if (found == devices.end()) {
        return fail(error_code::unavailable, std::string("None of ") + std::to_string(count) +
                                                 " Vulkan devices is of version 1.3 and draws" +
                                                 (window_ ? " in windows of this display." : "."));
    }
    physical_ = *found;
    return {};
}

result<void> screen_vulkan::make_device() {
    VkPhysicalDeviceFeatures has{};
    vkGetPhysicalDeviceFeatures(physical_, &has);
    VkPhysicalDeviceFeatures wanted{};
    wanted.shaderStorageImageExtendedFormats = has.shaderStorageImageExtendedFormats;
    float16_volumes_ = has.shaderStorageImageExtendedFormats == VK_TRUE;
    auto features13 = make<VkPhysicalDeviceVulkan13Features>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
    features13.synchronization2 = features13.dynamicRendering = VK_TRUE;
    const float priority = 1;
    auto queue = make<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
    queue.queueFamilyIndex = family_;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    const char* const extensions[] = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
    auto info = make<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
    info.pNext = &features13;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = window_ ? 1 : 0;
    info.ppEnabledExtensionNames = extensions;
    info.pEnabledFeatures = &wanted;
    auto done = check(vkCreateDevice(physical_, &info, nullptr, &device_), "open its device");
    if (done) {
        vkGetDeviceQueue(device_, family_, 0, &queue_);
    }
    return done;
}

result<void> screen_vulkan::make_ours() {
    vulkan::device_description description;
    description.instance = instance_;
    description.physical_device = physical_;
    description.device = device_;
    description.queue = queue_;
    description.queue_family = family_;
    description.get_instance_proc_addr = vkGetInstanceProcAddr;
    description.synchronization2 = description.dynamic_rendering = true;
    description.debug_utils = options_.messages != nullptr;
    description.shader_storage_image_extended_formats = float16_volumes_;
    auto made = vulkan::device::create(description);
    if (!made) {
        return failure(made.error());
    }
    ours_ = std::move(*made);
    return {};
}

result<void> screen_vulkan::make_commands() {
    auto pool = make<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = family_;
    if (auto done =
            check(vkCreateCommandPool(device_, &pool, nullptr, &pool_), "make a command pool");
        !done) {
        return done;
    }
    auto commands =
        make<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
    commands.commandPool = pool_;
    commands.commandBufferCount = 1;
    auto queries = make<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = most_marks;
    const auto fence = make<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
    const auto semaphore = make<VkSemaphoreCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO);
    for (const VkResult returned : {vkAllocateCommandBuffers(device_, &commands, &commands_),
                                    vkCreateQueryPool(device_, &queries, nullptr, &timestamps_),
                                    vkCreateFence(device_, &fence, nullptr, &fence_),
                                    vkCreateSemaphore(device_, &semaphore, nullptr, &acquired_)}) {
        if (auto done = check(returned, "make a command buffer"); !done) {
            return done;
        }
    }
    return {};
}

result<std::uint32_t> screen_vulkan::memory_type(std::uint32_t among,
                                                 VkMemoryPropertyFlags wanted) const {
    VkPhysicalDeviceMemoryProperties memory{};
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        if ((among >> i & 1u) != 0 && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) {
            return i;
        }
    }
    return fail(error_code::unavailable, "This Vulkan device has no memory of a kind that the "
                                         "viewer needs.");
}

// ---- the panel ----------------------------------------------------------------------------------

result<void> screen_vulkan::start_panel() {
    VkAttachmentDescription color{};
    color.format = image_format_used;
    color.samples = VK_SAMPLE_COUNT_1_BIT;
    color.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
    color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    color.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    color.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    color.initialLayout = color.finalLayout = VK_IMAGE_LAYOUT_GENERAL;
    const VkAttachmentReference drawn{0, VK_IMAGE_LAYOUT_GENERAL};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &drawn;
    auto pass = make<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
    pass.attachmentCount = 1;
    pass.pAttachments = &color;
    pass.subpassCount = 1;
    pass.pSubpasses = &subpass;
    if (auto done =
            check(vkCreateRenderPass(device_, &pass, nullptr, &pass_), "make a render pass");
        !done) {
        return done;
    }
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 4};
    auto pool = make<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
    pool.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
    pool.maxSets = 4;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &size;
    if (auto done = check(vkCreateDescriptorPool(device_, &pool, nullptr, &descriptors_),
                          "make a descriptor pool");
        !done) {
        return done;
    }
    if (window_ && !options_.scripted) {
        ImGui_ImplGlfw_InitForVulkan(window_->handle(), false);
    }
    ImGui_ImplVulkan_InitInfo info{};
    info.Instance = instance_;
    info.PhysicalDevice = physical_;
    info.Device = device_;
    info.QueueFamily = family_;
    info.Queue = queue_;
    info.DescriptorPool = descriptors_;
    info.MinImageCount = info.ImageCount = 2;
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    panel_ = ImGui_ImplVulkan_Init(&info, pass_);
    return upload_fonts();
}

result<void> screen_vulkan::upload_fonts() {
    if (auto begun = begin_commands(0); !begun) {
        return begun;
    }
    ImGui_ImplVulkan_CreateFontsTexture(commands_);
    auto done = submit_and_wait(VK_NULL_HANDLE, VK_NULL_HANDLE);
    ImGui_ImplVulkan_DestroyFontUploadObjects();
    return done;
}

void screen_vulkan::begin_panel() {
    ImGui_ImplVulkan_NewFrame();
    if (window_ && !options_.scripted) {
        ImGui_ImplGlfw_NewFrame();
    }
}

// ---- command buffers ----------------------------------------------------------------------------

result<void> screen_vulkan::begin_commands(std::size_t marks) {
    auto info = make<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    auto begun = check(vkBeginCommandBuffer(commands_, &info), "begin a command buffer");
    if (begun && marks > 0) {
        vkCmdResetQueryPool(commands_, timestamps_, 0, most_marks);
    }
    return begun;
}

result<void> screen_vulkan::submit_and_wait(VkSemaphore before, VkSemaphore after) {
    if (auto ended = check(vkEndCommandBuffer(commands_), "end a command buffer"); !ended) {
        return ended;
    }
    const VkPipelineStageFlags waiting = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    auto info = make<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
    info.commandBufferCount = 1;
    info.pCommandBuffers = &commands_;
    info.waitSemaphoreCount = before != VK_NULL_HANDLE ? 1 : 0;
    info.pWaitSemaphores = &before;
    info.pWaitDstStageMask = &waiting;
    info.signalSemaphoreCount = after != VK_NULL_HANDLE ? 1 : 0;
    info.pSignalSemaphores = &after;
    if (auto done = check(vkQueueSubmit(queue_, 1, &info, fence_), "submit"); !done) {
        return done;
    }
    if (auto done = check(vkWaitForFences(device_, 1, &fence_, VK_TRUE, ~std::uint64_t{0}), "wait");
        !done) {
        return done;
    }
    return check(vkResetFences(device_, 1, &fence_), "wait again");
}

void screen_vulkan::mark(std::size_t number) {
    if (tick_ > 0 && number < most_marks) {
        vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, timestamps_,
                             static_cast<std::uint32_t>(number));
    }
}

result<void> screen_vulkan::read_marks(std::span<double> seconds) {
    if (tick_ <= 0 || seconds.size() >= most_marks) {
        return {};
    }
    std::array<std::uint64_t, most_marks> times{};
    const std::size_t count = seconds.size() + 1;
    auto done =
        check(vkGetQueryPoolResults(device_, timestamps_, 0, static_cast<std::uint32_t>(count),
                                    sizeof times, times.data(), sizeof times[0],
                                    VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
              "read its timestamps");
    for (std::size_t i = 0; done && i < seconds.size(); ++i) {
        seconds[i] = tick_ * static_cast<double>(times[i + 1] - times[i]);
    }
    return done;
}

void screen_vulkan::to_layout(VkImage image, VkImageLayout from, VkImageLayout to) {
    auto barrier = make<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = whole;
    auto all = make<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
    all.imageMemoryBarrierCount = 1;
    all.pImageMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands_, &all);
}

// ---- images -------------------------------------------------------------------------------------

void screen_vulkan::destroy_image() {
    vkDestroyFramebuffer(device_, frame_, nullptr);
    vkDestroyImageView(device_, image_.view, nullptr);
    vkDestroyImage(device_, image_.image, nullptr);
    vkFreeMemory(device_, image_.memory, nullptr);
    frame_ = VK_NULL_HANDLE;
    image_ = {};
    size_ = glm::uvec2(0);
}

result<void> screen_vulkan::make_image(glm::uvec2 size) {
    if (size == size_) {
        return {};
    }
    destroy_image();
    auto info = make<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = image_format_used;
    info.extent = {size.x, size.y, 1};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                 VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    const char* const doing = "make the image of a window";
    if (auto done = check(vkCreateImage(device_, &info, nullptr, &image_.image), doing); !done) {
        return done;
    }
    VkMemoryRequirements need{};
    vkGetImageMemoryRequirements(device_, image_.image, &need);
    const auto type = memory_type(need.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    if (!type) {
        return failure(type.error());
    }
    auto memory = make<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
    memory.allocationSize = need.size;
    memory.memoryTypeIndex = *type;
    if (auto done = check(vkAllocateMemory(device_, &memory, nullptr, &image_.memory), doing);
        !done) {
        return done;
    }
    if (auto done = check(vkBindImageMemory(device_, image_.image, image_.memory, 0), doing);
        !done) {
        return done;
    }
    auto view = make<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
    view.image = image_.image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = image_format_used;
    view.subresourceRange = whole;
    if (auto done = check(vkCreateImageView(device_, &view, nullptr, &image_.view), doing); !done) {
        return done;
    }
    auto frame = make<VkFramebufferCreateInfo>(VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO);
    frame.renderPass = pass_;
    frame.attachmentCount = 1;
    frame.pAttachments = &image_.view;
    frame.width = size.x;
    frame.height = size.y;
    frame.layers = 1;
    auto done = check(vkCreateFramebuffer(device_, &frame, nullptr, &frame_), doing);
    size_ = done ? size : glm::uvec2(0);
    return done;
}

void screen_vulkan::destroy_swapchain() {
    for (const VkSemaphore semaphore : drawn_) {
        vkDestroySemaphore(device_, semaphore, nullptr);
    }
    drawn_.clear();
    targets_.clear();
    if (swapchain_ != VK_NULL_HANDLE) {
        vkDestroySwapchainKHR(device_, swapchain_, nullptr);
        swapchain_ = VK_NULL_HANDLE;
    }
}

result<void> screen_vulkan::make_swapchain(glm::uvec2 size) {
    if (auto idle = check(vkDeviceWaitIdle(device_), "wait for its device"); !idle) {
        return idle;
    }
    destroy_swapchain();
    VkSurfaceCapabilitiesKHR can{};
    if (auto done = check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(physical_, surface_, &can),
                          "ask what a window can do");
        !done) {
        return done;
    }
    std::uint32_t count = 0;
    (void)vkGetPhysicalDeviceSurfaceFormatsKHR(physical_, surface_, &count, nullptr);
    std::vector<VkSurfaceFormatKHR> formats(count);
    (void)vkGetPhysicalDeviceSurfaceFormatsKHR(physical_, surface_, &count, formats.data());
    if (formats.empty() || (can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT) == 0) {
        return fail(error_code::unavailable, "Vulkan cannot copy pictures into this window.");
    }
    const VkSurfaceFormatKHR format = choose_format(formats);
    const bool given = can.currentExtent.width != ~std::uint32_t{0};
    auto info = make<VkSwapchainCreateInfoKHR>(VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR);
    info.surface = surface_;
    info.minImageCount = std::max(can.minImageCount, 2u);
    info.imageFormat = format.format;
    info.imageColorSpace = format.colorSpace;
    info.imageExtent = given ? can.currentExtent : VkExtent2D{size.x, size.y};
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
    info.preTransform = can.currentTransform;
    info.compositeAlpha = (can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) != 0
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
    info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
    info.clipped = VK_TRUE;
    if (auto done =
            check(vkCreateSwapchainKHR(device_, &info, nullptr, &swapchain_), "make a swapchain");
        !done) {
        return done;
    }
    (void)vkGetSwapchainImagesKHR(device_, swapchain_, &count, nullptr);
    targets_.resize(count);
    (void)vkGetSwapchainImagesKHR(device_, swapchain_, &count, targets_.data());
    drawn_.resize(count, VK_NULL_HANDLE);
    const auto semaphore = make<VkSemaphoreCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO);
    for (VkSemaphore& each : drawn_) {
        if (auto done =
                check(vkCreateSemaphore(device_, &semaphore, nullptr, &each), "make a semaphore");
            !done) {
            return done;
        }
    }
    swapchain_size_ = {info.imageExtent.width, info.imageExtent.height};
    return {};
}

// ---- a frame ------------------------------------------------------------------------------------

void screen_vulkan::draw_all(const vulkan::image& picture) {
    const image_description what = picture.description();
    const auto [low, high] = place({what.width, what.height}, size_);
    to_layout(image_.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    const VkClearColorValue black{{0, 0, 0, 1}};
    vkCmdClearColorImage(commands_, image_.image, VK_IMAGE_LAYOUT_GENERAL, &black, 1, &whole);
    to_layout(image_.image, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL);
    VkImageBlit blit{};
    blit.srcSubresource = blit.dstSubresource = layer;
    blit.srcOffsets[1] = {static_cast<std::int32_t>(what.width),
                          static_cast<std::int32_t>(what.height), 1};
    blit.dstOffsets[0] = {static_cast<std::int32_t>(low.x), static_cast<std::int32_t>(low.y), 0};
    blit.dstOffsets[1] = {static_cast<std::int32_t>(high.x), static_cast<std::int32_t>(high.y), 1};
    // Skybark's images are always in the general layout.
    vkCmdBlitImage(commands_, picture.handle(), VK_IMAGE_LAYOUT_GENERAL, image_.image,
                   VK_IMAGE_LAYOUT_GENERAL, 1, &blit, VK_FILTER_LINEAR);
    to_layout(image_.image, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL);
    auto pass = make<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
    pass.renderPass = pass_;
    pass.framebuffer = frame_;
    pass.renderArea.extent = {size_.x, size_.y};
    vkCmdBeginRenderPass(commands_, &pass, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands_);
    vkCmdEndRenderPass(commands_);
    to_layout(image_.image, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL);
}

result<void> screen_vulkan::show(const vulkan::image& picture) {
    const glm::uvec2 size =
        window_ ? window_->framebuffer() : glm::uvec2(options_.width, options_.height);
    if (auto made = make_image(size); !made) {
        return made;
    }
    if (auto begun = begin_commands(0); !begun) {
        return begun;
    }
    draw_all(picture);
    if (auto done = submit_and_wait(VK_NULL_HANDLE, VK_NULL_HANDLE); !done || !window_) {
        return done;
    }
    return present();
}

result<void> screen_vulkan::present() {
    if (swapchain_ == VK_NULL_HANDLE || swapchain_size_ != size_) {
        if (auto made = make_swapchain(size_); !made) {
            return made;
        }
    }
    std::uint32_t index = 0;
    const VkResult got = vkAcquireNextImageKHR(device_, swapchain_, ~std::uint64_t{0}, acquired_,
                                               VK_NULL_HANDLE, &index);
    if (got == VK_ERROR_OUT_OF_DATE_KHR) { // the window has another size by now: the next frame
        swapchain_size_ = glm::uvec2(0);
        return {};
    }
    if (auto done = check(got, "get an image of the window"); !done) {
        return done;
    }
    if (auto begun = begin_commands(0); !begun) {
        return begun;
    }
    to_layout(targets_[index], VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    VkImageBlit blit{};
    blit.srcSubresource = blit.dstSubresource = layer;
    blit.srcOffsets[1] = {static_cast<std::int32_t>(size_.x), static_cast<std::int32_t>(size_.y),
                          1};
    blit.dstOffsets[1] = {static_cast<std::int32_t>(swapchain_size_.x),
                          static_cast<std::int32_t>(swapchain_size_.y), 1};
    vkCmdBlitImage(commands_, image_.image, VK_IMAGE_LAYOUT_GENERAL, targets_[index],
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_NEAREST);
    to_layout(targets_[index], VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
              VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
    if (auto done = submit_and_wait(acquired_, drawn_[index]); !done) {
        return done;
    }
    auto info = make<VkPresentInfoKHR>(VK_STRUCTURE_TYPE_PRESENT_INFO_KHR);
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = &drawn_[index];
    info.swapchainCount = 1;
    info.pSwapchains = &swapchain_;
    info.pImageIndices = &index;
    const VkResult shown_now = vkQueuePresentKHR(queue_, &info);
    if (shown_now == VK_ERROR_OUT_OF_DATE_KHR || shown_now == VK_SUBOPTIMAL_KHR) {
        swapchain_size_ = glm::uvec2(0);
        return {};
    }
    return check(shown_now, "show a picture in the window");
}

result<shown> screen_vulkan::read() {
    shown all{{}, size_.x, size_.y};
    all.pixels.resize(std::size_t{4} * size_.x * size_.y);
    // As an image of the caller's, which Skybark's device downloads.
    vulkan::foreign_image foreign;
    foreign.image = image_.image;
    foreign.description = {size_.x, size_.y, image_format::rgba8};
    const auto wrapped = ours_->wrap(foreign);
    if (!wrapped) {
        return failure(wrapped.error());
    }
    if (auto done = ours_->download(*wrapped, std::as_writable_bytes(std::span(all.pixels)));
        !done) {
        return failure(done.error());
    }
    return all;
}

} // namespace skybark::viewer
