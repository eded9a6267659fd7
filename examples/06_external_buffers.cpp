// Memory that is the caller's: patterns read and write it where it lies, and nobody copies it.
//
// On each backend that there is, a buffer of the caller's holds 1, 2, 3, …; a device turns it into
// running sums, in place, and writes the total into another; the caller looks at them himself.

#include <skybark/cpu/cpu.hpp>
#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/opengl.hpp>
#include <skybark/vulkan/headless.hpp>
#include <skybark/vulkan/vulkan.hpp>

#include <GL/glcorearb.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <numeric>
#include <vector>

namespace {

constexpr std::uint32_t count = 10000;
constexpr std::uint64_t bytes = count * sizeof(std::uint32_t);

std::vector<std::uint32_t> first_numbers() {
    std::vector<std::uint32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 1u);
    return numbers;
}

/// Skybark's part: the same for whatever buffers of a backend these are.
template <skybark::backend B>
skybark::result<void> sum(B& device, const typename B::buffer& words,
                          const typename B::buffer& total) {
    return skybark::run(device, [&](auto& recorder) {
        recorder.scan(skybark::view<B>(words), skybark::view<B>(total));
    });
}

/// What the caller finds: the sum of all words before each.
bool report(const char* backend, const std::uint32_t* sums, std::uint32_t total) {
    bool right = total == count * (count + 1) / 2;
    for (std::uint32_t i = 0; i < count; ++i) {
        right = right && sums[i] == i * (i + 1) / 2;
    }
    std::printf("%-7s %u words in the caller's memory, in all %u: %s\n", backend, count, total,
                right ? "right" : "wrong");
    return right;
}

bool absent(const char* backend, const skybark::error& why) {
    std::printf("%-7s not here: %s\n", backend, why.message.c_str());
    return true;
}

// ---- CPU: any memory that is aligned to 16 bytes ------------------------------------------------

bool on_the_cpu() {
    skybark::cpu::device device;
    struct alignas(16) block {
        std::uint32_t words[count];
        std::uint32_t total[4];
    };
    const auto mine = std::make_unique<block>();
    std::ranges::copy(first_numbers(), mine->words);

    const auto words = skybark::cpu::buffer::wrap(std::as_writable_bytes(std::span(mine->words)));
    const auto total = skybark::cpu::buffer::wrap(std::as_writable_bytes(std::span(mine->total)));
    return sum(device, words, total) && report("cpu", mine->words, mine->total[0]);
}

// ---- OpenGL: buffer objects by their names ------------------------------------------------------

bool on_opengl() {
    // The context could be yours as well: see 05_caller_opengl_context.cpp.
    auto made = skybark::opengl::headless::create();
    if (!made) {
        return absent("opengl", made.error());
    }
    auto& device = made->device();
    const auto create = reinterpret_cast<PFNGLCREATEBUFFERSPROC>(made->find("glCreateBuffers"));
    const auto fill =
        reinterpret_cast<PFNGLNAMEDBUFFERSTORAGEPROC>(made->find("glNamedBufferStorage"));
    const auto read =
        reinterpret_cast<PFNGLGETNAMEDBUFFERSUBDATAPROC>(made->find("glGetNamedBufferSubData"));
    const auto destroy = reinterpret_cast<PFNGLDELETEBUFFERSPROC>(made->find("glDeleteBuffers"));
    const auto numbers = first_numbers();
    GLuint mine[2] = {};
    create(2, mine);
    fill(mine[0], bytes, numbers.data(), 0); // no flags: we neither map nor upload
    fill(mine[1], 16, nullptr, 0);

    const auto words = device.wrap_buffer(mine[0], bytes);
    const auto total = device.wrap_buffer(mine[1], 16);
    const bool done = sum(device, words, total).has_value();

    std::vector<std::uint32_t> sums(count);
    std::uint32_t all = 0;
    read(mine[0], 0, bytes, sums.data());
    read(mine[1], 0, sizeof all, &all);
    destroy(2, mine); // ours to delete, always
    return done && report("opengl", sums.data(), all);
}

// ---- Vulkan: VkBuffers, with what else touches them ---------------------------------------------

/// A VkBuffer with memory that the host sees.
struct vulkan_buffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    std::uint32_t* mapped = nullptr;
};

/// The caller's own Vulkan.
class caller {
  public:
    explicit caller(const skybark::vulkan::device_description& on) : on_(on) {}

    [[nodiscard]] vulkan_buffer make(VkDeviceSize size) const {
        vulkan_buffer b;
        VkBufferCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
        info.size = size;
        info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT; // all that a scan needs
        call<PFN_vkCreateBuffer>("vkCreateBuffer")(on_.device, &info, nullptr, &b.buffer);
        VkMemoryRequirements need{};
        call<PFN_vkGetBufferMemoryRequirements>("vkGetBufferMemoryRequirements")(on_.device,
                                                                                 b.buffer, &need);
        VkPhysicalDeviceMemoryProperties has{};
        call<PFN_vkGetPhysicalDeviceMemoryProperties>("vkGetPhysicalDeviceMemoryProperties")(
            on_.physical_device, &has);
        constexpr VkMemoryPropertyFlags wanted =
            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        VkMemoryAllocateInfo memory{};
        memory.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
        memory.allocationSize = need.size;
        std::uint32_t& type = memory.memoryTypeIndex;
        while ((need.memoryTypeBits >> type & 1u) == 0 ||
               (has.memoryTypes[type].propertyFlags & wanted) != wanted) {
            ++type; // Vulkan promises one
        }
        call<PFN_vkAllocateMemory>("vkAllocateMemory")(on_.device, &memory, nullptr, &b.memory);
        call<PFN_vkBindBufferMemory>("vkBindBufferMemory")(on_.device, b.buffer, b.memory, 0);
        void* mapped = nullptr;
        call<PFN_vkMapMemory>("vkMapMemory")(on_.device, b.memory, 0, VK_WHOLE_SIZE, 0, &mapped);
        b.mapped = static_cast<std::uint32_t*>(mapped);
        return b;
    }
    void destroy(const vulkan_buffer& b) const {
        call<PFN_vkDestroyBuffer>("vkDestroyBuffer")(on_.device, b.buffer, nullptr);
        call<PFN_vkFreeMemory>("vkFreeMemory")(on_.device, b.memory, nullptr);
    }

  private:
    template <class Function>
    [[nodiscard]] Function call(const char* name) const {
        return reinterpret_cast<Function>(on_.get_instance_proc_addr(on_.instance, name));
    }

    skybark::vulkan::device_description on_;
};

bool on_vulkan() {
    // The device could be yours as well: see 04_caller_vulkan_device.cpp.
    auto made = skybark::vulkan::headless::create({});
    if (!made) {
        return absent("vulkan", made.error());
    }
    auto& device = made->device();
    const caller mine(made->description());
    const vulkan_buffer numbers = mine.make(bytes);
    const vulkan_buffer all = mine.make(16);
    std::ranges::copy(first_numbers(), numbers.mapped);

    // Who used a buffer last, and who will use it next: here the host, outside the queue.
    skybark::vulkan::foreign_buffer foreign;
    foreign.before = {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_WRITE_BIT};
    foreign.after = {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT};
    foreign.buffer = numbers.buffer;
    foreign.size = bytes;
    const auto words = device.wrap(foreign);
    foreign.buffer = all.buffer;
    foreign.size = 16;
    const auto total = device.wrap(foreign);
    const bool done = sum(device, words, total).has_value();

    const bool right = done && report("vulkan", numbers.mapped, all.mapped[0]);
    mine.destroy(numbers); // ours to destroy, always
    mine.destroy(all);
    return right;
}

} // namespace

int main() {
    const bool right[] = {on_the_cpu(), on_opengl(), on_vulkan()};
    return right[0] && right[1] && right[2] ? 0 : 1;
}
