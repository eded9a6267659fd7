// A caller's own pipeline of Vulkan, on his own device and in his own command buffer, asks for a
// cloud's light and for gathered light: the texts of skybark/glsl, compiled with his shader by
// glslangValidator, and the views of the volumes are all that it needs.

#include "support/caller_light.hpp"
#include "vulkan/raw_vulkan.hpp"

#include <caller_light.spv.hpp> // the words of tests/support/caller_light.comp

namespace skybark::testing {
namespace {

using support::caller_found;
using support::caller_lights;
using support::caller_place;

/// Memory that the host sees, with a VkBuffer on it.
struct seen_buffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    void* mapped = nullptr;
};

/// The caller's Vulkan: a compute pipeline with a block, three samplers and two buffers.
class caller_pipeline {
    /// A function of Vulkan's that takes the device first.
    template <class Function, class... Arguments>
    auto call(const char* name, Arguments... arguments) const {
        return raw_.call<Function>(name)(raw_.device, arguments...);
    }

  public:
    explicit caller_pipeline(raw_vulkan& raw) : raw_(raw) {
        make_sampler();
        make_layouts();
        make_pipeline();
        make_pool();
    }
    caller_pipeline(const caller_pipeline&) = delete;
    caller_pipeline& operator=(const caller_pipeline&) = delete;
    ~caller_pipeline() {
        for (const seen_buffer& b : buffers_) {
            call<PFN_vkDestroyBuffer>("vkDestroyBuffer", b.buffer, nullptr);
            call<PFN_vkFreeMemory>("vkFreeMemory", b.memory, nullptr);
        }
        call<PFN_vkDestroyDescriptorPool>("vkDestroyDescriptorPool", pool_, nullptr);
        call<PFN_vkDestroyPipeline>("vkDestroyPipeline", pipeline_, nullptr);
        call<PFN_vkDestroyPipelineLayout>("vkDestroyPipelineLayout", layout_, nullptr);
        call<PFN_vkDestroyDescriptorSetLayout>("vkDestroyDescriptorSetLayout", set_layout_,
                                               nullptr);
        call<PFN_vkDestroySampler>("vkDestroySampler", sampler_, nullptr);
    }

    /// Appends a dispatch that asks for the light of a moment. What it finds is in what is returned
    /// when the command buffer has run.
    [[nodiscard]] std::span<const caller_found> ask(VkCommandBuffer commands,
                                                    const support::caller_light<device>& light,
                                                    const support::caller_moment& of) {
        const auto places = light.places(of);
        const caller_lights lights = light.lights(of);
        const seen_buffer block = make(sizeof lights, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
        const seen_buffer asked =
            make(places.size() * sizeof(caller_place), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        const seen_buffer found =
            make(places.size() * sizeof(caller_found), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        std::memcpy(block.mapped, &lights, sizeof lights);
        std::memcpy(asked.mapped, places.data(), places.size() * sizeof(caller_place));
        const VkDescriptorSet set = describe(light, block, asked, found);
        const auto record = [&]<class Function>(const char* name, auto... arguments) {
            raw_.call<Function>(name)(commands, arguments...);
        };
        record.operator()<PFN_vkCmdBindPipeline>("vkCmdBindPipeline",
                                                 VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
        record.operator()<PFN_vkCmdBindDescriptorSets>("vkCmdBindDescriptorSets",
                                                       VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0u,
                                                       1u, &set, 0u, nullptr);
        record.operator()<PFN_vkCmdDispatch>(
            "vkCmdDispatch", static_cast<std::uint32_t>((places.size() + 63) / 64), 1u, 1u);
        auto barrier = vulkan::make<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
        barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
        barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
        record.operator()<PFN_vkCmdPipelineBarrier>(
            "vkCmdPipelineBarrier", VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
            VK_PIPELINE_STAGE_HOST_BIT, 0u, 1u, &barrier, 0u, nullptr, 0u, nullptr);
        return {static_cast<const caller_found*>(found.mapped), places.size()};
    }

  private:
    void make_sampler() {
        auto info = vulkan::make<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
        info.magFilter = info.minFilter = VK_FILTER_LINEAR;
        info.addressModeU = info.addressModeV = info.addressModeW =
            VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
        EXPECT_EQ(VK_SUCCESS,
                  call<PFN_vkCreateSampler>("vkCreateSampler", &info, nullptr, &sampler_));
    }

    [[nodiscard]] static VkDescriptorType type_of(std::uint32_t binding) {
        return binding == 0  ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
               : binding < 4 ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER
                             : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    }

    void make_layouts() {
        std::array<VkDescriptorSetLayoutBinding, 6> bindings{};
        for (std::uint32_t i = 0; i < bindings.size(); ++i) {
            bindings[i] = {i, type_of(i), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
        }
        auto info = vulkan::make<VkDescriptorSetLayoutCreateInfo>(
            VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
        info.bindingCount = static_cast<std::uint32_t>(bindings.size());
        info.pBindings = bindings.data();
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkCreateDescriptorSetLayout>("vkCreateDescriptorSetLayout",
                                                                    &info, nullptr, &set_layout_));
        auto whole =
            vulkan::make<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
        whole.setLayoutCount = 1;
        whole.pSetLayouts = &set_layout_;
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkCreatePipelineLayout>("vkCreatePipelineLayout", &whole,
                                                               nullptr, &layout_));
    }

    void make_pipeline() {
        auto code =
            vulkan::make<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
        code.codeSize = sizeof caller_light_comp;
        code.pCode = caller_light_comp;
        VkShaderModule shader = VK_NULL_HANDLE;
        EXPECT_EQ(VK_SUCCESS,
                  call<PFN_vkCreateShaderModule>("vkCreateShaderModule", &code, nullptr, &shader));
        auto info = vulkan::make<VkComputePipelineCreateInfo>(
            VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
        info.stage = vulkan::make<VkPipelineShaderStageCreateInfo>(
            VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
        info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
        info.stage.module = shader;
        info.stage.pName = "main";
        info.layout = layout_;
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkCreateComputePipelines>("vkCreateComputePipelines",
                                                                 VkPipelineCache(VK_NULL_HANDLE),
                                                                 1u, &info, nullptr, &pipeline_));
        call<PFN_vkDestroyShaderModule>("vkDestroyShaderModule", shader, nullptr);
    }

    void make_pool() {
        const std::array<VkDescriptorPoolSize, 3> sizes{
            VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, most_sets},
            VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 3 * most_sets},
            VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2 * most_sets}};
        auto info =
            vulkan::make<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
        info.maxSets = most_sets;
        info.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
        info.pPoolSizes = sizes.data();
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkCreateDescriptorPool>("vkCreateDescriptorPool", &info,
                                                               nullptr, &pool_));
    }

    [[nodiscard]] seen_buffer make(VkDeviceSize size, VkBufferUsageFlags usage) {
        seen_buffer b;
        auto info = vulkan::make<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
        info.size = size;
        info.usage = usage;
        EXPECT_EQ(VK_SUCCESS,
                  call<PFN_vkCreateBuffer>("vkCreateBuffer", &info, nullptr, &b.buffer));
        VkMemoryRequirements need{};
        call<PFN_vkGetBufferMemoryRequirements>("vkGetBufferMemoryRequirements", b.buffer, &need);
        VkPhysicalDeviceMemoryProperties has{};
        raw_.call<PFN_vkGetPhysicalDeviceMemoryProperties>("vkGetPhysicalDeviceMemoryProperties")(
            raw_.physical, &has);
        constexpr VkMemoryPropertyFlags seen =
            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        auto memory = vulkan::make<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
        memory.allocationSize = need.size;
        std::uint32_t& type = memory.memoryTypeIndex;
        while ((need.memoryTypeBits >> type & 1u) == 0 ||
               (has.memoryTypes[type].propertyFlags & seen) != seen) {
            ++type; // Vulkan promises one
        }
        EXPECT_EQ(VK_SUCCESS,
                  call<PFN_vkAllocateMemory>("vkAllocateMemory", &memory, nullptr, &b.memory));
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkBindBufferMemory>("vkBindBufferMemory", b.buffer, b.memory,
                                                           VkDeviceSize{0}));
        EXPECT_EQ(VK_SUCCESS, call<PFN_vkMapMemory>("vkMapMemory", b.memory, VkDeviceSize{0},
                                                    VK_WHOLE_SIZE, VkMemoryMapFlags{0}, &b.mapped));
        buffers_.push_back(b);
        return b;
    }

    [[nodiscard]] VkDescriptorSet describe(const support::caller_light<device>& light,
                                           const seen_buffer& block, const seen_buffer& asked,
                                           const seen_buffer& found) {
        auto info = vulkan::make<VkDescriptorSetAllocateInfo>(
            VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
        info.descriptorPool = pool_;
        info.descriptorSetCount = 1;
        info.pSetLayouts = &set_layout_;
        VkDescriptorSet set = VK_NULL_HANDLE;
        EXPECT_EQ(VK_SUCCESS,
                  call<PFN_vkAllocateDescriptorSets>("vkAllocateDescriptorSets", &info, &set));
        // Skybark's own volumes are always in VK_IMAGE_LAYOUT_GENERAL.
        const auto image = [&](const vulkan::volume& from) {
            return VkDescriptorImageInfo{sampler_, from.view(), VK_IMAGE_LAYOUT_GENERAL};
        };
        const std::array<VkDescriptorImageInfo, 3> images{
            image(light.attenuation()), image(light.fluence()), image(light.gathered())};
        const std::array<VkDescriptorBufferInfo, 3> buffers{
            VkDescriptorBufferInfo{block.buffer, 0, VK_WHOLE_SIZE},
            VkDescriptorBufferInfo{asked.buffer, 0, VK_WHOLE_SIZE},
            VkDescriptorBufferInfo{found.buffer, 0, VK_WHOLE_SIZE}};
        std::array<VkWriteDescriptorSet, 6> writes{};
        for (std::uint32_t i = 0; i < writes.size(); ++i) {
            writes[i] = vulkan::make<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
            writes[i].dstSet = set;
            writes[i].dstBinding = i;
            writes[i].descriptorCount = 1;
            writes[i].descriptorType = type_of(i);
            if (i >= 1 && i < 4) {
                writes[i].pImageInfo = &images[i - 1];
            } else {
                writes[i].pBufferInfo = &buffers[i == 0 ? 0 : i - 3];
            }
        }
        call<PFN_vkUpdateDescriptorSets>("vkUpdateDescriptorSets",
                                         static_cast<std::uint32_t>(writes.size()), writes.data(),
                                         0u, nullptr);
        return set;
    }

    static constexpr std::uint32_t most_sets = 2;

    raw_vulkan& raw_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    std::vector<seen_buffer> buffers_;
};

/// Two suns in one command buffer, without a barrier of the caller's between Skybark's work and his
/// own; validation, which watches hazards, stays silent.
TEST(caller_shader, finds_light_in_the_volumes) {
    log said;
    raw_vulkan raw(said);
    if (!raw.device) {
        ASSERT_FALSE(vulkan_required()) << "no Vulkan device with validation";
        GTEST_SKIP() << "no Vulkan device with validation";
    }
    {
        device gpu = must(device::create(raw.description()));
        support::caller_light<device> light(gpu);
        caller_pipeline mine(raw);
        const VkCommandBuffer commands = raw.begin();
        std::vector<vulkan::ticket> tickets;
        const auto relight = [&](glm::vec3 to_sun) {
            auto recorder = must(gpu.record_into(commands));
            const support::caller_moment now = light.relight(recorder, to_sun);
            tickets.push_back(must(gpu.finish(recorder)));
            return now;
        };
        const support::caller_moment noon = relight({0.3f, 0.9f, 0.2f});
        const std::span<const caller_found> at_noon = mine.ask(commands, light, noon);
        const support::caller_moment evening = relight({-0.8f, 0.25f, 0.1f});
        const std::span<const caller_found> in_the_evening = mine.ask(commands, light, evening);
        raw.submit_and_wait();
        light.expect_right(at_noon, noon, {});
        light.expect_right(in_the_evening, evening, light.fluence_cells());
    }
    EXPECT_TRUE(said.messages.empty()) << said.text();
}

} // namespace
} // namespace skybark::testing
