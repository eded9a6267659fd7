// vulkan.h without prototypes, and functions that are variables, as volk has them.
#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

extern "C" {
PFN_vkCreateDevice vkCreateDevice = nullptr;
PFN_vkCreateBuffer vkCreateBuffer = nullptr;
PFN_vkGetInstanceProcAddr vkGetInstanceProcAddr = nullptr;
PFN_vkCmdDispatch vkCmdDispatch = nullptr;
}

#include <skybark/vulkan/headless.hpp>
#include <skybark/vulkan/vulkan.hpp>

bool with_volk() {
    const auto made = skybark::vulkan::device::create({});
    return vkCreateDevice == nullptr && vkCmdDispatch == nullptr && !made &&
           made.error().message.find("synchronization2") != std::string::npos;
}
