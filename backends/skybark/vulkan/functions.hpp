#pragma once
// Our own table of Vulkan functions, one a device, loaded through the caller's
// vkGetInstanceProcAddr. Nothing is linked, no loader is asked for, and nothing is global: two
// devices of two drivers have a table each. Only types of vulkan_core.h are used, so it works with
// VK_NO_PROTOTYPES and without. A vulkan.h that is included already is the one that is used.

#include <skybark/core/result.hpp>

#include <string>

#if !defined(VULKAN_CORE_H_)
#    include <vulkan/vulkan_core.h>
#endif
#if !defined(VK_VERSION_1_3)
#    error "Skybark needs the headers of Vulkan 1.3 or newer."
#endif

namespace skybark::vulkan {

/// A Vulkan struct with its sType set and everything else zero.
template <class T>
[[nodiscard]] constexpr T make(VkStructureType type) {
    T value{};
    value.sType = type;
    return value;
}

/// The functions that the backend calls. All of them are Vulkan 1.3; only the last may be absent.
struct functions {
    PFN_vkGetDeviceProcAddr get_device_proc_addr = nullptr;
    PFN_vkGetPhysicalDeviceProperties2 get_properties = nullptr;
    PFN_vkGetPhysicalDeviceMemoryProperties get_memory_properties = nullptr;
    PFN_vkGetPhysicalDeviceFormatProperties get_format_properties = nullptr;
    PFN_vkGetPhysicalDeviceImageFormatProperties get_image_format_properties = nullptr;

    PFN_vkAllocateMemory allocate_memory = nullptr;
    PFN_vkFreeMemory free_memory = nullptr;
    PFN_vkMapMemory map_memory = nullptr;
    PFN_vkCreateBuffer create_buffer = nullptr;
    PFN_vkDestroyBuffer destroy_buffer = nullptr;
    PFN_vkGetBufferMemoryRequirements get_buffer_memory_requirements = nullptr;
    PFN_vkBindBufferMemory bind_buffer_memory = nullptr;
    PFN_vkCreateImage create_image = nullptr;
    PFN_vkDestroyImage destroy_image = nullptr;
    PFN_vkGetImageMemoryRequirements get_image_memory_requirements = nullptr;
    PFN_vkBindImageMemory bind_image_memory = nullptr;
    PFN_vkCreateImageView create_image_view = nullptr;
    PFN_vkDestroyImageView destroy_image_view = nullptr;
    PFN_vkCreateSampler create_sampler = nullptr;
    PFN_vkDestroySampler destroy_sampler = nullptr;

    PFN_vkCreateDescriptorSetLayout create_descriptor_set_layout = nullptr;
    PFN_vkDestroyDescriptorSetLayout destroy_descriptor_set_layout = nullptr;
    PFN_vkCreatePipelineLayout create_pipeline_layout = nullptr;
    PFN_vkDestroyPipelineLayout destroy_pipeline_layout = nullptr;
    PFN_vkCreateDescriptorPool create_descriptor_pool = nullptr;
    PFN_vkDestroyDescriptorPool destroy_descriptor_pool = nullptr;
    PFN_vkAllocateDescriptorSets allocate_descriptor_sets = nullptr;
    PFN_vkUpdateDescriptorSets update_descriptor_sets = nullptr;
    PFN_vkCreateShaderModule create_shader_module = nullptr;
    PFN_vkDestroyShaderModule destroy_shader_module = nullptr;
    PFN_vkCreateComputePipelines create_compute_pipelines = nullptr;
    PFN_vkCreateGraphicsPipelines create_graphics_pipelines = nullptr;
    PFN_vkDestroyPipeline destroy_pipeline = nullptr;

    PFN_vkCreateCommandPool create_command_pool = nullptr;
    PFN_vkDestroyCommandPool destroy_command_pool = nullptr;
    PFN_vkResetCommandPool reset_command_pool = nullptr;
    PFN_vkAllocateCommandBuffers allocate_command_buffers = nullptr;
    PFN_vkBeginCommandBuffer begin_command_buffer = nullptr;
    PFN_vkEndCommandBuffer end_command_buffer = nullptr;
    PFN_vkCreateFence create_fence = nullptr;
    PFN_vkDestroyFence destroy_fence = nullptr;
    PFN_vkResetFences reset_fences = nullptr;
    PFN_vkWaitForFences wait_for_fences = nullptr;
    PFN_vkQueueSubmit2 queue_submit = nullptr;
    PFN_vkQueueWaitIdle queue_wait_idle = nullptr;

    PFN_vkCmdPipelineBarrier2 barrier = nullptr;
    PFN_vkCmdBindPipeline bind_pipeline = nullptr;
    PFN_vkCmdBindDescriptorSets bind_descriptor_sets = nullptr;
    PFN_vkCmdPushConstants push_constants = nullptr;
    PFN_vkCmdDispatch dispatch = nullptr;
    PFN_vkCmdDispatchIndirect dispatch_indirect = nullptr;
    PFN_vkCmdCopyBuffer copy_buffer = nullptr;
    PFN_vkCmdFillBuffer fill_buffer = nullptr;
    PFN_vkCmdCopyBufferToImage copy_buffer_to_image = nullptr;
    PFN_vkCmdCopyImageToBuffer copy_image_to_buffer = nullptr;
    PFN_vkCmdClearColorImage clear_color_image = nullptr;
    PFN_vkCmdBeginRendering begin_rendering = nullptr;
    PFN_vkCmdEndRendering end_rendering = nullptr;
    PFN_vkCmdSetViewport set_viewport = nullptr;
    PFN_vkCmdSetScissor set_scissor = nullptr;
    PFN_vkCmdBindIndexBuffer bind_index_buffer = nullptr;
    PFN_vkCmdDraw draw = nullptr;
    PFN_vkCmdDrawIndexed draw_indexed = nullptr;
    PFN_vkCmdDrawIndirect draw_indirect = nullptr;
    PFN_vkCmdDrawIndexedIndirect draw_indexed_indirect = nullptr;

    // Null unless VK_EXT_debug_utils was enabled.
    PFN_vkSetDebugUtilsObjectNameEXT set_object_name = nullptr;
    PFN_vkCmdBeginDebugUtilsLabelEXT begin_label = nullptr;
    PFN_vkCmdEndDebugUtilsLabelEXT end_label = nullptr;
};

namespace detail {

/// Finds functions by name and remembers the first that is missing.
template <class Find>
struct loader {
    explicit loader(Find f) : find(std::move(f)) {}

    Find find;
    std::string missing;

    template <class Function>
    void operator()(Function& function, const char* name) {
        function = reinterpret_cast<Function>(find(name));
        if (!function && missing.empty()) {
            missing = name;
        }
    }
};

template <class Load>
void load_memory_functions(functions& f, Load& load) {
    load(f.allocate_memory, "vkAllocateMemory");
    load(f.free_memory, "vkFreeMemory");
    load(f.map_memory, "vkMapMemory");
    load(f.create_buffer, "vkCreateBuffer");
    load(f.destroy_buffer, "vkDestroyBuffer");
    load(f.get_buffer_memory_requirements, "vkGetBufferMemoryRequirements");
    load(f.bind_buffer_memory, "vkBindBufferMemory");
    load(f.create_image, "vkCreateImage");
    load(f.destroy_image, "vkDestroyImage");
    load(f.get_image_memory_requirements, "vkGetImageMemoryRequirements");
    load(f.bind_image_memory, "vkBindImageMemory");
    load(f.create_image_view, "vkCreateImageView");
    load(f.destroy_image_view, "vkDestroyImageView");
    load(f.create_sampler, "vkCreateSampler");
    load(f.destroy_sampler, "vkDestroySampler");
}

template <class Load>
void load_pipeline_functions(functions& f, Load& load) {
    load(f.create_descriptor_set_layout, "vkCreateDescriptorSetLayout");
    load(f.destroy_descriptor_set_layout, "vkDestroyDescriptorSetLayout");
    load(f.create_pipeline_layout, "vkCreatePipelineLayout");
    load(f.destroy_pipeline_layout, "vkDestroyPipelineLayout");
    load(f.create_descriptor_pool, "vkCreateDescriptorPool");
    load(f.destroy_descriptor_pool, "vkDestroyDescriptorPool");
    load(f.allocate_descriptor_sets, "vkAllocateDescriptorSets");
    load(f.update_descriptor_sets, "vkUpdateDescriptorSets");
    load(f.create_shader_module, "vkCreateShaderModule");
    load(f.destroy_shader_module, "vkDestroyShaderModule");
    load(f.create_compute_pipelines, "vkCreateComputePipelines");
    load(f.create_graphics_pipelines, "vkCreateGraphicsPipelines");
    load(f.destroy_pipeline, "vkDestroyPipeline");
}

template <class Load>
void load_submission_functions(functions& f, Load& load) {
    load(f.create_command_pool, "vkCreateCommandPool");
    load(f.destroy_command_pool, "vkDestroyCommandPool");
    load(f.reset_command_pool, "vkResetCommandPool");
    load(f.allocate_command_buffers, "vkAllocateCommandBuffers");
    load(f.begin_command_buffer, "vkBeginCommandBuffer");
    load(f.end_command_buffer, "vkEndCommandBuffer");
    load(f.create_fence, "vkCreateFence");
    load(f.destroy_fence, "vkDestroyFence");
    load(f.reset_fences, "vkResetFences");
    load(f.wait_for_fences, "vkWaitForFences");
    load(f.queue_submit, "vkQueueSubmit2");
    load(f.queue_wait_idle, "vkQueueWaitIdle");
}

template <class Load>
void load_command_functions(functions& f, Load& load) {
    load(f.barrier, "vkCmdPipelineBarrier2");
    load(f.bind_pipeline, "vkCmdBindPipeline");
    load(f.bind_descriptor_sets, "vkCmdBindDescriptorSets");
    load(f.push_constants, "vkCmdPushConstants");
    load(f.dispatch, "vkCmdDispatch");
    load(f.dispatch_indirect, "vkCmdDispatchIndirect");
    load(f.copy_buffer, "vkCmdCopyBuffer");
    load(f.fill_buffer, "vkCmdFillBuffer");
    load(f.copy_buffer_to_image, "vkCmdCopyBufferToImage");
    load(f.copy_image_to_buffer, "vkCmdCopyImageToBuffer");
    load(f.clear_color_image, "vkCmdClearColorImage");
    load(f.begin_rendering, "vkCmdBeginRendering");
    load(f.end_rendering, "vkCmdEndRendering");
    load(f.set_viewport, "vkCmdSetViewport");
    load(f.set_scissor, "vkCmdSetScissor");
    load(f.bind_index_buffer, "vkCmdBindIndexBuffer");
    load(f.draw, "vkCmdDraw");
    load(f.draw_indexed, "vkCmdDrawIndexed");
    load(f.draw_indirect, "vkCmdDrawIndirect");
    load(f.draw_indexed_indirect, "vkCmdDrawIndexedIndirect");
}

} // namespace detail

/// The table of one device. `get_device_proc_addr` may be null: it is then asked of the instance.
/// Names and labels are left out unless VK_EXT_debug_utils was enabled.
[[nodiscard]] inline result<functions> load_functions(VkInstance instance, VkDevice device,
                                                      PFN_vkGetInstanceProcAddr get_instance_proc,
                                                      PFN_vkGetDeviceProcAddr get_device_proc,
                                                      bool debug_utils) {
    functions f;
    detail::loader from_instance(
        [&](const char* name) { return get_instance_proc(instance, name); });
    from_instance(f.get_device_proc_addr, "vkGetDeviceProcAddr");
    from_instance(f.get_properties, "vkGetPhysicalDeviceProperties2");
    from_instance(f.get_memory_properties, "vkGetPhysicalDeviceMemoryProperties");
    from_instance(f.get_format_properties, "vkGetPhysicalDeviceFormatProperties");
    from_instance(f.get_image_format_properties, "vkGetPhysicalDeviceImageFormatProperties");
    if (!from_instance.missing.empty()) {
        return fail(error_code::unavailable,
                    "This Vulkan instance has no " + from_instance.missing + ".");
    }
    if (get_device_proc) {
        f.get_device_proc_addr = get_device_proc;
    }
    detail::loader load([&](const char* name) { return f.get_device_proc_addr(device, name); });
    detail::load_memory_functions(f, load);
    detail::load_pipeline_functions(f, load);
    detail::load_submission_functions(f, load);
    detail::load_command_functions(f, load);
    if (!load.missing.empty()) {
        return fail(error_code::unavailable,
                    "This Vulkan device has no " + load.missing + "; Skybark needs Vulkan 1.3.");
    }
    if (debug_utils) { // an instance extension: its device functions come from the instance
        detail::loader optional(
            [&](const char* name) { return get_instance_proc(instance, name); });
        optional(f.set_object_name, "vkSetDebugUtilsObjectNameEXT");
        optional(f.begin_label, "vkCmdBeginDebugUtilsLabelEXT");
        optional(f.end_label, "vkCmdEndDebugUtilsLabelEXT");
    }
    return f;
}

} // namespace skybark::vulkan
