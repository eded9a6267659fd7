#pragma once
// Layouts, samplers and pipelines of a device, made when first needed and kept.
//
// Compute programs have buffers at bindings 0–11, draw programs at 0–7, those that peel one more.
// From 16 on come the images of each kind (image_slot) that a program has; programs with equally
// many of each share a layout. Push constants are the 16 bytes of the skeletons and then the
// kernel's own.

#include <skybark/vulkan/image.hpp>
#include <skybark/vulkan/program.hpp>
#include <skybark/vulkan/volume.hpp>

#include <array>
#include <compare>
#include <map>
#include <memory>
#include <vector>

namespace skybark::vulkan {

inline constexpr std::uint32_t compute_bindings = 12;
inline constexpr std::uint32_t vertices_binding = 8;
inline constexpr std::uint32_t offsets_binding = 9;
inline constexpr std::uint32_t length_binding = 10;
inline constexpr std::uint32_t ranges_binding = 11;
inline constexpr std::uint32_t images_binding = 16;

/// The kinds of images that a program is given: the binding of each is images_binding + kind.
enum image_slot : std::uint32_t {
    sampled_images,
    sampled_volumes,
    target_volumes, ///< written
    sum_volumes,    ///< added to, or the source of a scan
    image_slots,
};
[[nodiscard]] constexpr VkDescriptorType descriptor_of(std::uint32_t slot) noexcept {
    return slot <= sampled_volumes ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER
                                   : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
}
inline constexpr std::uint32_t push_bytes = 16 + max_kernel_bytes;

inline constexpr VkShaderStageFlags draw_stages =
    VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

/// What layouts differ by.
struct layout_shape {
    bool draws = false;
    bool peels = false;                              ///< a draw that reads one buffer more
    std::array<std::uint32_t, image_slots> images{}; ///< how many of each kind

    [[nodiscard]] auto operator<=>(const layout_shape&) const noexcept = default;
    [[nodiscard]] VkShaderStageFlags stages() const noexcept {
        return draws ? draw_stages : VkShaderStageFlags{VK_SHADER_STAGE_COMPUTE_BIT};
    }
    [[nodiscard]] std::uint32_t buffers() const noexcept {
        const auto drawn = static_cast<std::uint32_t>(max_kernel_buffers) + (peels ? 1 : 0);
        return draws ? drawn : compute_bindings;
    }
};

/// A descriptor set layout and the pipeline layout over it.
struct program_layout {
    VkDescriptorSetLayout set = VK_NULL_HANDLE;
    VkPipelineLayout pipeline = VK_NULL_HANDLE;
    layout_shape shape;
};

/// What a graphics pipeline is made for.
struct draw_program {
    spirv_words vertex;
    spirv_words fragment;
    layout_shape shape;
    VkFormat color = VK_FORMAT_UNDEFINED;
    VkFormat depth = VK_FORMAT_UNDEFINED;
    draw_state state; ///< a peel looks for the farthest in place of the nearest
};

namespace detail {

class pipeline_cache {
  public:
    explicit pipeline_cache(context& c) : context_(&c) {}
    pipeline_cache(const pipeline_cache&) = delete;
    pipeline_cache& operator=(const pipeline_cache&) = delete;
    ~pipeline_cache() {
        const context& c = *context_;
        for (const auto& [key, pipeline] : pipelines_) {
            c.call.destroy_pipeline(c.device(), pipeline, c.callbacks());
        }
        for (const auto& [shape, layout] : layouts_) {
            release(*layout);
        }
        for (const VkSampler sampler : samplers_) {
            if (sampler != VK_NULL_HANDLE) {
                c.call.destroy_sampler(c.device(), sampler, c.callbacks());
            }
        }
    }

    [[nodiscard]] result<const program_layout*> layout(const layout_shape& shape) {
        std::unique_ptr<program_layout>& l = layouts_[shape];
        if (!l) {
            auto made = std::make_unique<program_layout>();
            made->shape = shape;
            if (auto done = fill_layout(*made); !done) {
                release(*made);
                return failure(done.error());
            }
            l = std::move(made);
        }
        return l.get();
    }

    [[nodiscard]] result<VkPipeline> compute(spirv_words words, const layout_shape& shape,
                                             const char* name) {
        pipeline_key key;
        key.words = words.data();
        if (const auto found = pipelines_.find(key); found != pipelines_.end()) {
            return found->second;
        }
        auto made = watch_compilation(name, [&] { return make_compute(words, shape, name); });
        if (made) {
            pipelines_.emplace(key, *made);
        }
        return made;
    }

    [[nodiscard]] result<VkPipeline> draw(const draw_program& program, const char* name) {
        const pipeline_key key{program.vertex.data(),
                               program.color,
                               program.depth,
                               program.state.depth_test,
                               program.state.depth_write,
                               program.state.blend,
                               program.state.cull};
        if (const auto found = pipelines_.find(key); found != pipelines_.end()) {
            return found->second;
        }
        auto made = watch_compilation(name, [&] { return make_draw(program, name); });
        if (made) {
            pipelines_.emplace(key, *made);
        }
        return made;
    }

    [[nodiscard]] result<VkSampler> sampler(filter_mode filter, wrap_mode wrap) {
        VkSampler& sampler = samplers_[(filter == filter_mode::linear ? 1u : 0u) +
                                       (wrap == wrap_mode::repeat ? 2u : 0u)];
        if (sampler == VK_NULL_HANDLE) {
            auto info = make<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
            info.magFilter = info.minFilter =
                filter == filter_mode::linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
            info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
            info.addressModeU = info.addressModeV = info.addressModeW =
                wrap == wrap_mode::repeat ? VK_SAMPLER_ADDRESS_MODE_REPEAT
                                          : VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
            if (auto done =
                    context_->check(context_->call.create_sampler(context_->device(), &info,
                                                                  context_->callbacks(), &sampler),
                                    "make a sampler");
                !done) {
                return failure(done.error());
            }
            context_->name_own(VK_OBJECT_TYPE_SAMPLER, sampler, "sampler");
        }
        return sampler;
    }

  private:
    /// The words of the first shader, and what else a draw's pipeline is made for.
    struct pipeline_key {
        const void* words = nullptr;
        VkFormat color = VK_FORMAT_UNDEFINED;
        VkFormat depth = VK_FORMAT_UNDEFINED;
        bool depth_test = false;
        bool depth_write = false;
        blend_mode blend{};
        cull_mode cull{};

        [[nodiscard]] auto operator<=>(const pipeline_key&) const = default;
    };

    /// Names what was made, and logs how long it took, or why it was not.
    template <class Make>
    [[nodiscard]] result<VkPipeline> watch_compilation(const char* name, Make&& make_pipeline) {
        const context& c = *context_;
        const bool logs = c.description.hooks.log != nullptr;
        const double begin = logs ? skybark::detail::milliseconds_now() : 0;
        auto made = make_pipeline();
        if (made) {
            c.name_own(VK_OBJECT_TYPE_PIPELINE, *made, name);
            c.say(log_level::debug, [&] {
                return std::string(c.properties.deviceName) + " has compiled \"" + name + "\" in " +
                       skybark::detail::milliseconds_text(skybark::detail::milliseconds_now() -
                                                          begin) +
                       ".";
            });
        } else {
            c.say(log_level::error, [&] {
                return std::string("No program \"") + name + "\": " + made.error().message;
            });
        }
        return made;
    }

    void release(const program_layout& l) {
        const context& c = *context_;
        if (l.pipeline != VK_NULL_HANDLE) {
            c.call.destroy_pipeline_layout(c.device(), l.pipeline, c.callbacks());
        }
        if (l.set != VK_NULL_HANDLE) {
            c.call.destroy_descriptor_set_layout(c.device(), l.set, c.callbacks());
        }
    }

    [[nodiscard]] result<void> fill_layout(program_layout& l) {
        context& c = *context_;
        std::vector<VkDescriptorSetLayoutBinding> places;
        const VkShaderStageFlags stages = l.shape.stages();
        for (std::uint32_t i = 0; i < l.shape.buffers(); ++i) {
            places.push_back({i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, stages, nullptr});
        }
        const VkShaderStageFlags readers =
            l.shape.draws ? VkShaderStageFlags{VK_SHADER_STAGE_FRAGMENT_BIT} : stages;
        for (std::uint32_t slot = 0; slot < image_slots; ++slot) {
            if (l.shape.images[slot] != 0) {
                places.push_back({images_binding + slot, descriptor_of(slot), l.shape.images[slot],
                                  readers, nullptr});
            }
        }
        auto set = make<VkDescriptorSetLayoutCreateInfo>(
            VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
        set.bindingCount = static_cast<std::uint32_t>(places.size());
        set.pBindings = places.data();
        if (auto done = c.check(
                c.call.create_descriptor_set_layout(c.device(), &set, c.callbacks(), &l.set),
                "make a descriptor set layout");
            !done) {
            return done;
        }
        c.name_own(VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT, l.set,
                   l.shape.draws ? "set layout of draws" : "set layout of dispatches");
        const VkPushConstantRange push{stages, 0, push_bytes};
        auto info = make<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
        info.setLayoutCount = 1;
        info.pSetLayouts = &l.set;
        info.pushConstantRangeCount = 1;
        info.pPushConstantRanges = &push;
        auto done =
            c.check(c.call.create_pipeline_layout(c.device(), &info, c.callbacks(), &l.pipeline),
                    "make a pipeline layout");
        if (done) {
            c.name_own(VK_OBJECT_TYPE_PIPELINE_LAYOUT, l.pipeline,
                       l.shape.draws ? "pipeline layout of draws"
                                     : "pipeline layout of dispatches");
        }
        return done;
    }

    [[nodiscard]] result<VkShaderModule> make_module(spirv_words words, const char* name) {
        context& c = *context_;
        auto info = make<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
        info.codeSize = words.size_bytes();
        info.pCode = static_cast<const std::uint32_t*>(words.data());
        VkShaderModule module = VK_NULL_HANDLE;
        if (auto done =
                rejected(c.call.create_shader_module(c.device(), &info, c.callbacks(), &module));
            !done) {
            return failure(done.error());
        }
        c.name_own(VK_OBJECT_TYPE_SHADER_MODULE, module, name);
        return module;
    }

    /// Failures that are not of memory or the device are the shader's.
    [[nodiscard]] result<void> rejected(VkResult returned) {
        auto done = context_->check(returned, "compile a device program");
        if (!done && done.error().code == error_code::unavailable) {
            return fail(error_code::shader_rejected, done.error().message);
        }
        return done;
    }

    [[nodiscard]] static VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits stage,
                                                               VkShaderModule module) {
        auto info = make<VkPipelineShaderStageCreateInfo>(
            VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
        info.stage = stage;
        info.module = module;
        info.pName = "main";
        return info;
    }

    [[nodiscard]] result<VkPipeline> make_compute(spirv_words words, const layout_shape& shape,
                                                  const char* name) {
        context& c = *context_;
        auto l = layout(shape);
        if (!l) {
            return failure(l.error());
        }
        auto module = make_module(words, name);
        if (!module) {
            return failure(module.error());
        }
        auto info =
            make<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
        info.stage = stage(VK_SHADER_STAGE_COMPUTE_BIT, *module);
        // Only accumulate.comp has a constant.
        const std::uint32_t group = c.slab_group();
        const VkSpecializationMapEntry entry{0, 0, sizeof group};
        const VkSpecializationInfo constants{1, &entry, sizeof group, &group};
        info.stage.pSpecializationInfo = &constants;
        info.layout = (*l)->pipeline;
        VkPipeline pipeline = VK_NULL_HANDLE;
        auto done = rejected(c.call.create_compute_pipelines(c.device(), VK_NULL_HANDLE, 1, &info,
                                                             c.callbacks(), &pipeline));
        c.call.destroy_shader_module(c.device(), *module, c.callbacks());
        if (!done) {
            return failure(done.error());
        }
        return pipeline;
    }

    [[nodiscard]] result<VkPipeline> make_draw(const draw_program& program, const char* name) {
        context& c = *context_;
        auto vertex = make_module(program.vertex, name);
        if (!vertex) {
            return failure(vertex.error());
        }
        auto fragment = make_module(program.fragment, name);
        result<VkPipeline> made = fragment ? make_draw(program, *vertex, *fragment)
                                           : result<VkPipeline>(failure(fragment.error()));
        c.call.destroy_shader_module(c.device(), *vertex, c.callbacks());
        if (fragment) {
            c.call.destroy_shader_module(c.device(), *fragment, c.callbacks());
        }
        return made;
    }

    [[nodiscard]] static VkPipelineColorBlendAttachmentState blending(blend_mode mode) {
        VkPipelineColorBlendAttachmentState blend{};
        blend.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                               VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
        blend.blendEnable = mode == blend_mode::alpha ? VK_TRUE : VK_FALSE;
        blend.srcColorBlendFactor = blend.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
        blend.dstColorBlendFactor = blend.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
        blend.colorBlendOp = blend.alphaBlendOp = VK_BLEND_OP_ADD;
        return blend;
    }

    [[nodiscard]] result<VkPipeline> make_draw(const draw_program& program, VkShaderModule vertex,
                                               VkShaderModule fragment) {
        context& c = *context_;
        auto l = layout(program.shape);
        if (!l) {
            return failure(l.error());
        }
        const std::array stages{stage(VK_SHADER_STAGE_VERTEX_BIT, vertex),
                                stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment)};
        // Kernels fetch their vertices themselves.
        const auto input = make<VkPipelineVertexInputStateCreateInfo>(
            VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
        auto assembly = make<VkPipelineInputAssemblyStateCreateInfo>(
            VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
        assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
        auto viewport = make<VkPipelineViewportStateCreateInfo>(
            VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
        viewport.viewportCount = viewport.scissorCount = 1;
        auto raster = make<VkPipelineRasterizationStateCreateInfo>(
            VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
        raster.polygonMode = VK_POLYGON_MODE_FILL;
        raster.cullMode = program.state.cull == cull_mode::back
                              ? VkCullModeFlags{VK_CULL_MODE_BACK_BIT}
                              : VkCullModeFlags{VK_CULL_MODE_NONE};
        raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
        raster.lineWidth = 1;
        auto samples = make<VkPipelineMultisampleStateCreateInfo>(
            VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
        samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
        auto depth = make<VkPipelineDepthStencilStateCreateInfo>(
            VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
        const bool has_depth = program.depth != VK_FORMAT_UNDEFINED;
        // Without the test nothing is written either, so "no test" is a test that always passes.
        depth.depthTestEnable = has_depth && (program.state.depth_test || program.state.depth_write)
                                    ? VK_TRUE
                                    : VK_FALSE;
        depth.depthWriteEnable = has_depth && program.state.depth_write ? VK_TRUE : VK_FALSE;
        depth.depthCompareOp = program.shape.peels        ? VK_COMPARE_OP_GREATER
                               : program.state.depth_test ? VK_COMPARE_OP_LESS_OR_EQUAL
                                                          : VK_COMPARE_OP_ALWAYS;
        const bool has_color = program.color != VK_FORMAT_UNDEFINED;
        const VkPipelineColorBlendAttachmentState blend_one = blending(program.state.blend);
        auto blend = make<VkPipelineColorBlendStateCreateInfo>(
            VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
        blend.attachmentCount = has_color ? 1 : 0;
        blend.pAttachments = &blend_one;
        const std::array dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
        auto dynamic = make<VkPipelineDynamicStateCreateInfo>(
            VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO);
        dynamic.dynamicStateCount = static_cast<std::uint32_t>(dynamic_states.size());
        dynamic.pDynamicStates = dynamic_states.data();
        auto rendering =
            make<VkPipelineRenderingCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO);
        rendering.colorAttachmentCount = has_color ? 1 : 0;
        rendering.pColorAttachmentFormats = &program.color;
        rendering.depthAttachmentFormat = program.depth;

        auto info =
            make<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
        info.pNext = &rendering;
        info.stageCount = static_cast<std::uint32_t>(stages.size());
        info.pStages = stages.data();
        info.pVertexInputState = &input;
        info.pInputAssemblyState = &assembly;
        info.pViewportState = &viewport;
        info.pRasterizationState = &raster;
        info.pMultisampleState = &samples;
        info.pDepthStencilState = &depth;
        info.pColorBlendState = &blend;
        info.pDynamicState = &dynamic;
        info.layout = (*l)->pipeline;
        VkPipeline pipeline = VK_NULL_HANDLE;
        if (auto done = rejected(c.call.create_graphics_pipelines(c.device(), VK_NULL_HANDLE, 1,
                                                                  &info, c.callbacks(), &pipeline));
            !done) {
            return failure(done.error());
        }
        return pipeline;
    }

    context* context_;
    std::map<pipeline_key, VkPipeline> pipelines_;
    std::map<layout_shape, std::unique_ptr<program_layout>> layouts_;
    std::array<VkSampler, 4> samplers_{};
};

} // namespace detail
} // namespace skybark::vulkan
