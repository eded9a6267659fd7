#pragma once
// A Vulkan device of our own, without a window: for tools, tests and those who have none yet. It
// loads libvulkan.so.1 when asked, never before.
//
//     auto gpu = skybark::vulkan::headless::create({});
//     auto buffer = gpu->device().create_buffer(bytes);
//
// Everything that its device made must be gone before it is.

#include <skybark/vulkan/transfers.hpp>

#include <dlfcn.h>
#include <functional>

namespace skybark::vulkan {

/// Something that the validation layers say. Called on the thread that made the mistake.
struct message {
    bool is_error = false; ///< else a warning
    std::string_view text;
};
using message_sink = std::function<void(const message&)>;

struct headless_options {
    std::uint32_t device = 0; ///< index into `headless::devices()`
    bool validation = false;  ///< the Khronos layer, with synchronisation validation
    /// With `validation`: shaders check their own accesses too, slowly. The layer checks the ends
    /// of bound buffers only on devices that have descriptor indexing; Mesa 22.3's lavapipe has
    /// not.
    bool gpu_assisted = false;
    message_sink sink; ///< with `validation`
    // As in device_description.
    expansion expand_by = expansion::automatic;
    bool always_stage = false;
    bool omit_barriers = false;
    memory_hooks memory = {};
    skybark::hooks hooks = {};
};

/// A physical device, for people to choose from.
struct physical_device {
    std::string name;
    std::string driver;
    std::string api_version;
    VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
};

class headless {
  public:
    headless(headless&&) noexcept = default;
    headless& operator=(headless&&) noexcept = default;

    /// `unavailable` where there is no Vulkan, no such device, or no validation layer.
    [[nodiscard]] static result<headless> create(headless_options options);

    [[nodiscard]] static result<std::vector<physical_device>> devices();

    [[nodiscard]] vulkan::device& device() noexcept { return *device_; }
    [[nodiscard]] const vulkan::device& device() const noexcept { return *device_; }
    /// Our handles, as anybody else's would be described.
    [[nodiscard]] const device_description& description() const noexcept {
        return device_->description();
    }

  private:
    struct loader {
        void* library = nullptr;
        VkInstance instance = VK_NULL_HANDLE;
        VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
        VkDevice device = VK_NULL_HANDLE;
        PFN_vkGetInstanceProcAddr get = nullptr;
        message_sink sink;

        loader() = default;
        loader(const loader&) = delete;
        loader& operator=(const loader&) = delete;
        ~loader();

        template <class Function>
        [[nodiscard]] Function find(const char* name) const {
            return reinterpret_cast<Function>(get(instance, name));
        }
        [[nodiscard]] result<void> open();
        [[nodiscard]] result<void> make_instance(const headless_options& options);
        [[nodiscard]] result<void> make_messenger();
        [[nodiscard]] result<VkPhysicalDevice> choose(std::uint32_t index) const;
        [[nodiscard]] result<std::vector<VkPhysicalDevice>> list() const;
        [[nodiscard]] result<std::uint32_t> queue_family(VkPhysicalDevice of) const;
        [[nodiscard]] result<void> make_device(VkPhysicalDevice on, std::uint32_t family,
                                               bool gpu_assisted);
        [[nodiscard]] VkPhysicalDeviceFeatures features(VkPhysicalDevice of) const;
        [[nodiscard]] bool has_layer(const char* name) const;
        [[nodiscard]] bool has_debug_utils(const char* layer) const;
    };

    headless(std::unique_ptr<loader> l, vulkan::device d)
        : loader_(std::move(l)), device_(std::move(d)) {}

    static constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

    std::unique_ptr<loader> loader_;
    std::optional<vulkan::device> device_; // destroyed before what it stands on
};

inline headless::loader::~loader() {
    if (device != VK_NULL_HANDLE) {
        find<PFN_vkDestroyDevice>("vkDestroyDevice")(device, nullptr);
    }
    if (messenger != VK_NULL_HANDLE) {
        find<PFN_vkDestroyDebugUtilsMessengerEXT>("vkDestroyDebugUtilsMessengerEXT")(
            instance, messenger, nullptr);
    }
    if (instance != VK_NULL_HANDLE) {
        find<PFN_vkDestroyInstance>("vkDestroyInstance")(instance, nullptr);
    }
    if (library) {
        dlclose(library);
    }
}

inline result<void> headless::loader::open() {
    library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char* why = dlerror();
        return fail(error_code::unavailable, "There is no Vulkan on this machine: " +
                                                 std::string(why ? why : "no loader") + ".");
    }
    get = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
    if (!get) {
        return fail(error_code::unavailable, "libvulkan.so.1 has no vkGetInstanceProcAddr.");
    }
    return {};
}

inline bool headless::loader::has_layer(const char* name) const {
    const auto list_layers =
        find<PFN_vkEnumerateInstanceLayerProperties>("vkEnumerateInstanceLayerProperties");
    std::uint32_t count = 0;
    (void)list_layers(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    (void)list_layers(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(), [&](const VkLayerProperties& layer) {
        return std::string_view(layer.layerName) == name;
    });
}

inline bool headless::loader::has_debug_utils(const char* layer) const {
    const auto list_extensions =
        find<PFN_vkEnumerateInstanceExtensionProperties>("vkEnumerateInstanceExtensionProperties");
    std::uint32_t count = 0;
    (void)list_extensions(layer, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    (void)list_extensions(layer, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(), [](const VkExtensionProperties& e) {
        return std::string_view(e.extensionName) == VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    });
}

inline result<void> headless::loader::make_instance(const headless_options& options) {
    if (options.validation && !has_layer(validation_layer)) {
        return fail(error_code::unavailable,
                    "Validation was asked for, but the layer VK_LAYER_KHRONOS_validation is not "
                    "installed (on Debian: vulkan-validationlayers).");
    }
    auto application = make<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
    application.pApplicationName = "skybark";
    application.apiVersion = VK_API_VERSION_1_3;
    auto info = make<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
    info.pApplicationInfo = &application;
    // In code and not by VK_INSTANCE_LAYERS, which draws warnings from the loader.
    std::vector<VkValidationFeatureEnableEXT> enabled{
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    if (options.gpu_assisted) {
        enabled.push_back(VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT);
        enabled.push_back(VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_RESERVE_BINDING_SLOT_EXT);
    }
    auto validation = make<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
    validation.enabledValidationFeatureCount = static_cast<std::uint32_t>(enabled.size());
    validation.pEnabledValidationFeatures = enabled.data();
    const char* const layers[] = {validation_layer};
    const char* const extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                                      VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
    if (options.validation) {
        info.pNext = &validation;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = layers;
        info.enabledExtensionCount = 2;
        info.ppEnabledExtensionNames = extensions;
    }
    const VkResult made = find<PFN_vkCreateInstance>("vkCreateInstance")(&info, nullptr, &instance);
    if (made != VK_SUCCESS) {
        return fail(error_code::unavailable,
                    "Vulkan could not make an instance: " + to_string(made) + ".");
    }
    return {};
}

inline result<void> headless::loader::make_messenger() {
    auto info = make<VkDebugUtilsMessengerCreateInfoEXT>(
        VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
    info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT;
    info.pUserData = &sink;
    info.pfnUserCallback =
        [](VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT,
           const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) -> VkBool32 {
        const message_sink& to = *static_cast<const message_sink*>(user);
        if (to) {
            to({severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
                data->pMessage ? data->pMessage : ""});
        }
        return VK_FALSE;
    };
    const VkResult made = find<PFN_vkCreateDebugUtilsMessengerEXT>(
        "vkCreateDebugUtilsMessengerEXT")(instance, &info, nullptr, &messenger);
    if (made != VK_SUCCESS) {
        return fail(error_code::unavailable,
                    "Vulkan could not make a messenger: " + to_string(made) + ".");
    }
    return {};
}

inline result<std::vector<VkPhysicalDevice>> headless::loader::list() const {
    const auto enumerate = find<PFN_vkEnumeratePhysicalDevices>("vkEnumeratePhysicalDevices");
    std::uint32_t count = 0;
    VkResult listed = enumerate(instance, &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    if (listed >= 0) {
        listed = enumerate(instance, &count, devices.data());
    }
    if (listed < 0) {
        return fail(error_code::unavailable,
                    "Vulkan could not list the devices: " + to_string(listed) + ".");
    }
    return devices;
}

inline result<VkPhysicalDevice> headless::loader::choose(std::uint32_t index) const {
    auto devices = list();
    if (!devices) {
        return failure(devices.error());
    }
    if (index >= devices->size()) {
        return fail(error_code::unavailable, "Vulkan device " + std::to_string(index) +
                                                 " was asked for; there are " +
                                                 std::to_string(devices->size()) + ".");
    }
    return (*devices)[index];
}

inline result<std::uint32_t> headless::loader::queue_family(VkPhysicalDevice of) const {
    const auto list_families = find<PFN_vkGetPhysicalDeviceQueueFamilyProperties>(
        "vkGetPhysicalDeviceQueueFamilyProperties");
    std::uint32_t count = 0;
    list_families(of, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    list_families(of, &count, families.data());
    constexpr VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (std::uint32_t i = 0; i < count; ++i) {
        if ((families[i].queueFlags & needed) == needed) {
            return i;
        }
    }
    return fail(error_code::unavailable,
                "This Vulkan device has no queue for both graphics and compute.");
}

inline VkPhysicalDeviceFeatures headless::loader::features(VkPhysicalDevice of) const {
    VkPhysicalDeviceFeatures has{};
    find<PFN_vkGetPhysicalDeviceFeatures>("vkGetPhysicalDeviceFeatures")(of, &has);
    return has;
}

inline result<void> headless::loader::make_device(VkPhysicalDevice on, std::uint32_t family,
                                                  bool gpu_assisted) {
    auto has13 = make<VkPhysicalDeviceVulkan13Features>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
    auto has = make<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
    has.pNext = &has13;
    auto properties =
        make<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
    find<PFN_vkGetPhysicalDeviceProperties2>("vkGetPhysicalDeviceProperties2")(on, &properties);
    find<PFN_vkGetPhysicalDeviceFeatures2>("vkGetPhysicalDeviceFeatures2")(on, &has);
    if (properties.properties.apiVersion < VK_API_VERSION_1_3 || !has13.synchronization2 ||
        !has13.dynamicRendering) {
        return fail(error_code::unavailable,
                    "The Vulkan device " + std::string(properties.properties.deviceName) +
                        " has not all of Vulkan 1.3, synchronization2 and dynamicRendering.");
    }
    auto want13 = make<VkPhysicalDeviceVulkan13Features>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
    want13.synchronization2 = want13.dynamicRendering = VK_TRUE;
    auto want = make<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
    want.pNext = &want13;
    want.features.shaderStorageImageExtendedFormats =
        has.features.shaderStorageImageExtendedFormats;
    if (gpu_assisted) { // the layer's own instrumentation writes from every stage
        want.features.fragmentStoresAndAtomics = has.features.fragmentStoresAndAtomics;
        want.features.vertexPipelineStoresAndAtomics = has.features.vertexPipelineStoresAndAtomics;
    }
    const float priority = 1;
    auto queue = make<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
    queue.queueFamilyIndex = family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    auto info = make<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
    info.pNext = &want;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    const VkResult made = find<PFN_vkCreateDevice>("vkCreateDevice")(on, &info, nullptr, &device);
    if (made != VK_SUCCESS) {
        return fail(error_code::unavailable,
                    "Vulkan could not make a device: " + to_string(made) + ".");
    }
    return {};
}

inline result<headless> headless::create(headless_options options) {
    auto made = std::make_unique<loader>();
    made->sink = std::move(options.sink);
    auto done = made->open();
    if (done) {
        done = made->make_instance(options);
    }
    if (done && options.validation) {
        done = made->make_messenger();
    }
    if (!done) {
        return failure(done.error());
    }
    auto physical = made->choose(options.device);
    if (!physical) {
        return failure(physical.error());
    }
    auto family = made->queue_family(*physical);
    if (!family) {
        return failure(family.error());
    }
    done = made->make_device(*physical, *family, options.gpu_assisted);
    if (!done) {
        return failure(done.error());
    }
    device_description description;
    description.instance = made->instance;
    description.physical_device = *physical;
    description.device = made->device;
    made->find<PFN_vkGetDeviceQueue>("vkGetDeviceQueue")(made->device, *family, 0,
                                                         &description.queue);
    description.queue_family = *family;
    description.get_instance_proc_addr = made->get;
    description.synchronization2 = description.dynamic_rendering = true;
    description.debug_utils = options.validation;
    description.shader_storage_image_extended_formats =
        made->features(*physical).shaderStorageImageExtendedFormats != VK_FALSE;
    description.expand_by = options.expand_by;
    description.always_stage = options.always_stage;
    description.omit_barriers = options.omit_barriers;
    description.memory = options.memory;
    description.hooks = options.hooks;
    auto device = vulkan::device::create(description);
    if (!device) {
        return failure(device.error());
    }
    return headless(std::move(made), std::move(*device));
}

inline result<std::vector<physical_device>> headless::devices() {
    loader l;
    if (auto done = l.open(); !done) {
        return failure(done.error());
    }
    if (auto done = l.make_instance({}); !done) {
        return failure(done.error());
    }
    auto handles = l.list();
    if (!handles) {
        return failure(handles.error());
    }
    std::vector<physical_device> devices;
    for (const VkPhysicalDevice handle : *handles) {
        auto driver = make<VkPhysicalDeviceDriverProperties>(
            VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
        auto properties =
            make<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
        properties.pNext = &driver;
        l.find<PFN_vkGetPhysicalDeviceProperties2>("vkGetPhysicalDeviceProperties2")(handle,
                                                                                     &properties);
        const std::uint32_t v = properties.properties.apiVersion;
        devices.push_back({properties.properties.deviceName,
                           std::string(driver.driverName) + " " + driver.driverInfo,
                           std::to_string(VK_API_VERSION_MAJOR(v)) + "." +
                               std::to_string(VK_API_VERSION_MINOR(v)) + "." +
                               std::to_string(VK_API_VERSION_PATCH(v)),
                           properties.properties.deviceType});
    }
    return devices;
}

} // namespace skybark::vulkan
