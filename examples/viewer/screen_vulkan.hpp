#pragma once
// A screen by Vulkan: a device of the viewer's own, as a caller's would be. Stages go into its
// command buffer, with a timestamp between; pictures reach a GLFW window through a swapchain.

#include "glfw_window.hpp"
#include "screen.hpp"

#include <skybark/vulkan/vulkan.hpp>

#include <memory>
#include <optional>
#include <span>
#include <vulkan/vulkan.h>

namespace skybark::viewer {

class screen_vulkan {
  public:
    using device_type = vulkan::device;

    [[nodiscard]] static result<std::unique_ptr<screen_vulkan>>
    create(const screen_options& options);
    screen_vulkan(const screen_vulkan&) = delete;
    screen_vulkan& operator=(const screen_vulkan&) = delete;
    ~screen_vulkan();

    [[nodiscard]] vulkan::device& device() { return *ours_; }
    [[nodiscard]] glfw_window* window() { return window_.get(); }

    template <class Record>
    [[nodiscard]] result<void> run(std::size_t count, Record&& record, std::span<double> seconds) {
        if (auto begun = begin_commands(count + 1); !begun) {
            return begun;
        }
        auto recorder = ours_->record_into(commands_);
        if (!recorder) {
            return failure(recorder.error());
        }
        mark(0);
        for (std::size_t i = 0; i < count; ++i) {
            record(*recorder, i);
            mark(i + 1);
        }
        auto ticket = ours_->finish(*recorder); // held until the device is done
        if (!ticket) {
            return failure(ticket.error());
        }
        auto done = submit_and_wait(VK_NULL_HANDLE, VK_NULL_HANDLE);
        return done ? read_marks(seconds) : done;
    }

    void begin_panel();
    [[nodiscard]] result<void> show(const vulkan::image& picture);
    [[nodiscard]] result<shown> read();

  private:
    /// A VkImage with its memory.
    struct owned_image {
        VkImage image = VK_NULL_HANDLE;
        VkDeviceMemory memory = VK_NULL_HANDLE;
        VkImageView view = VK_NULL_HANDLE;
    };

    explicit screen_vulkan(const screen_options& options) : options_(options) {}
    [[nodiscard]] result<void> make_instance();
    [[nodiscard]] result<void> make_messenger();
    [[nodiscard]] result<void> choose_device();
    [[nodiscard]] bool suits(VkPhysicalDevice candidate);
    [[nodiscard]] result<void> make_device();
    [[nodiscard]] result<void> make_ours();
    [[nodiscard]] result<void> make_commands();
    [[nodiscard]] result<void> start_panel();
    [[nodiscard]] result<void> upload_fonts();
    [[nodiscard]] result<void> make_image(glm::uvec2 size);
    [[nodiscard]] result<void> make_swapchain(glm::uvec2 size);
    [[nodiscard]] result<std::uint32_t> memory_type(std::uint32_t among,
                                                    VkMemoryPropertyFlags wanted) const;
    void destroy_image();
    void destroy_swapchain();

    [[nodiscard]] result<void> begin_commands(std::size_t marks);
    [[nodiscard]] result<void> submit_and_wait(VkSemaphore before, VkSemaphore after);
    void mark(std::size_t number);
    [[nodiscard]] result<void> read_marks(std::span<double> seconds);
    void draw_all(const vulkan::image& picture);
    void to_layout(VkImage image, VkImageLayout from, VkImageLayout to);
    [[nodiscard]] result<void> present();

    screen_options options_;
    std::unique_ptr<glfw_window> window_;
    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    std::uint32_t family_ = 0;
    double tick_ = 0; ///< s, of a timestamp; 0: the queue has none
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    bool float16_volumes_ = false;
    std::optional<vulkan::device> ours_;

    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
    VkSemaphore acquired_ = VK_NULL_HANDLE;
    VkQueryPool timestamps_ = VK_NULL_HANDLE;

    VkRenderPass pass_ = VK_NULL_HANDLE;
    VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
    bool panel_ = false;

    owned_image image_; ///< that all is drawn into, in the window's size
    VkFramebuffer frame_ = VK_NULL_HANDLE;
    glm::uvec2 size_{0};

    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    std::vector<VkImage> targets_;
    std::vector<VkSemaphore> drawn_; ///< one for each of them
    glm::uvec2 swapchain_size_{0};
};

} // namespace skybark::viewer
