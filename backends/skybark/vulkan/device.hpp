#pragma once
// The device: makes buffers, images and recorders on the VkDevice of the caller.
//
//     auto device = skybark::vulkan::device::create(description);
//     auto buffer = device->create_buffer(bytes);
//     auto recorder = device->begin();                  // our own command buffer: submit() waits
//     auto recorder = device->record_into(commands);    // or the caller's: see finish()
//
// What touches the queue, and waits: create_buffer where the host cannot write the zeros itself,
// create_image, create_volume, upload, download and submit. Nothing else does. Calls on the queue
// need the lock that Vulkan asks of everybody who shares it.
//
// In the caller's command buffer a recorder only appends: barriers, dispatches, copies and dynamic
// rendering, outside any render pass. It begins with a barrier behind what the caller recorded and
// ends with one before what the caller will record. It disturbs the bound pipelines, descriptor set
// 0, push constants, viewport, scissor and index buffer.

#include <skybark/vulkan/recording.hpp>

#include <algorithm>
#include <cassert>

namespace skybark::vulkan {

class recorder;

namespace detail {

/// All of a device that must stay at one address.
struct device_state {
    context shared;
    pipeline_cache pipelines{shared};
    std::vector<std::unique_ptr<recording>> idle;
    buffer_memory unused;

    device_state() = default;
    device_state(const device_state&) = delete;
    device_state& operator=(const device_state&) = delete;
    ~device_state() { release(shared, unused); }

    [[nodiscard]] std::unique_ptr<recording> take_recording() {
        if (idle.empty()) {
            return std::make_unique<recording>(shared);
        }
        std::unique_ptr<recording> one = std::move(idle.back());
        idle.pop_back();
        return one;
    }

    void give_back(std::unique_ptr<recording> one) {
        if (one) {
            one->reset();
            idle.push_back(std::move(one));
        }
    }
};

} // namespace detail

/// Keeps the temporaries of what was recorded into the caller's command buffer. Hold it until that
/// command buffer has finished for the last time; then destroy it, and they are used again.
class ticket {
  public:
    ticket() = default;
    ticket(ticket&& other) noexcept
        : state_(std::exchange(other.state_, nullptr)), recording_(std::move(other.recording_)) {}
    ticket& operator=(ticket&& other) noexcept {
        std::swap(state_, other.state_);
        std::swap(recording_, other.recording_);
        return *this;
    }
    ~ticket() { retire(); }

    /// As its destruction, but now.
    void retire() {
        if (state_) {
            state_->give_back(std::move(recording_));
            state_ = nullptr;
        }
    }

  private:
    friend class device;
    ticket(detail::device_state& state, std::unique_ptr<detail::recording> r)
        : state_(&state), recording_(std::move(r)) {}

    detail::device_state* state_ = nullptr;
    std::unique_ptr<detail::recording> recording_;
};

class device {
  public:
    using backend_tag = skybark::backend_tag;
    using buffer = vulkan::buffer;
    using image = vulkan::image;
    using volume = vulkan::volume;
    using recorder = vulkan::recorder;

    /// `unavailable` where a feature that we rely on was not enabled.
    [[nodiscard]] static result<device> create(const device_description& description);

    [[nodiscard]] std::string_view name() const noexcept { return "vulkan"; }
    [[nodiscard]] std::string device_name() const { return shared().properties.deviceName; }
    [[nodiscard]] device_limits limits() const noexcept { return shared().limits; }
    [[nodiscard]] device_traffic traffic() const noexcept { return shared().traffic; }
    [[nodiscard]] device_usage usage() const noexcept { return shared().usage; }
    [[nodiscard]] const device_description& description() const noexcept {
        return shared().description;
    }

    [[nodiscard]] result<buffer> create_buffer(std::uint64_t bytes);
    [[nodiscard]] result<image> create_image(image_description what);
    [[nodiscard]] result<volume> create_volume(volume_description what);

    /// The caller's objects, which stay the caller's.
    [[nodiscard]] buffer wrap(const foreign_buffer& foreign);
    [[nodiscard]] result<image> wrap(const foreign_image& foreign);
    [[nodiscard]] result<volume> wrap(const foreign_volume& foreign);

    /// Names that debuggers and validation show, where VK_EXT_debug_utils is enabled.
    void set_name(const buffer& what, const char* name) {
        if (what.handle() != VK_NULL_HANDLE) {
            shared().name(VK_OBJECT_TYPE_BUFFER, what.handle(), name);
        }
    }
    void set_name(const image& what, const char* name) {
        shared().name(VK_OBJECT_TYPE_IMAGE, what.handle(), name);
    }
    void set_name(const volume& what, const char* name) {
        shared().name(VK_OBJECT_TYPE_IMAGE, what.handle(), name);
    }

    [[nodiscard]] result<void> upload(const buffer& to, std::uint64_t offset,
                                      std::span<const std::byte> bytes);
    [[nodiscard]] result<void> download(const buffer& from, std::uint64_t offset,
                                        std::span<std::byte> bytes);
    [[nodiscard]] result<void> upload(const image& to, std::span<const std::byte> bytes);
    [[nodiscard]] result<void> download(const image& from, std::span<std::byte> bytes);
    [[nodiscard]] result<void> upload(const volume& to, std::span<const std::byte> bytes);
    [[nodiscard]] result<void> download(const volume& from, std::span<std::byte> bytes);

    [[nodiscard]] result<vulkan::recorder> begin();
    [[nodiscard]] result<void> submit(vulkan::recorder& into);

    /// A recorder that appends to a command buffer that the caller has begun, and will submit. It
    /// goes to `finish`, not to `submit`.
    [[nodiscard]] result<vulkan::recorder> record_into(VkCommandBuffer commands);

    /// Ends what a recorder appends to the caller's command buffer. After an error the command
    /// buffer holds half a job: do not submit it.
    [[nodiscard]] result<ticket> finish(vulkan::recorder& into);

  private:
    explicit device(std::unique_ptr<detail::device_state> state) : state_(std::move(state)) {}

    [[nodiscard]] const context& shared() const noexcept { return state_->shared; }
    [[nodiscard]] context& shared() noexcept { return state_->shared; }

    [[nodiscard]] static result<void> fill_in(context& c);
    /// Hands over what was recorded and waits; the recorder keeps its memory.
    [[nodiscard]] result<void> execute(vulkan::recorder& into);
    [[nodiscard]] result<void> wait_idle();
    template <class Record>
    [[nodiscard]] result<void> at_once(Record&& record);

    std::unique_ptr<detail::device_state> state_;
};

namespace detail {

[[nodiscard]] inline device_limits limits_of(const context& c, VkDeviceSize max_allocation) {
    const VkPhysicalDeviceLimits& l = c.properties.limits;
    device_limits limits;
    limits.max_buffer_bytes = std::min<std::uint64_t>(l.maxStorageBufferRange, max_allocation);
    limits.view_alignment = std::max<std::uint64_t>(16, l.minStorageBufferOffsetAlignment);
    // A compact expansion counts each element's triangles in a word of one buffer.
    limits.max_elements = std::min<std::uint64_t>(limits.max_buffer_bytes / 4, 1u << 31);
    limits.max_image_size =
        std::min({l.maxImageDimension2D, l.maxFramebufferWidth, l.maxFramebufferHeight,
                  l.maxViewportDimensions[0], l.maxViewportDimensions[1]});
    limits.max_volume_size = l.maxImageDimension3D;
    limits.filters_float32 = c.filters(VK_FORMAT_R32_SFLOAT);
    return limits;
}

} // namespace detail

inline result<void> device::fill_in(context& c) {
    auto maintenance3 = make<VkPhysicalDeviceMaintenance3Properties>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES);
    auto maintenance4 = make<VkPhysicalDeviceMaintenance4Properties>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES);
    auto properties =
        make<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
    maintenance3.pNext = &maintenance4;
    properties.pNext = &maintenance3;
    c.call.get_properties(c.description.physical_device, &properties);
    c.call.get_memory_properties(c.description.physical_device, &c.memory);
    c.properties = properties.properties;
    if (c.properties.apiVersion < VK_API_VERSION_1_3) {
        return fail(error_code::unavailable,
                    "The Vulkan device " + std::string(c.properties.deviceName) + " is version " +
                        std::to_string(VK_API_VERSION_MAJOR(c.properties.apiVersion)) + "." +
                        std::to_string(VK_API_VERSION_MINOR(c.properties.apiVersion)) +
                        "; Skybark needs 1.3.");
    }
    c.max_allocation = std::min(maintenance3.maxMemoryAllocationSize, maintenance4.maxBufferSize);
    c.limits = detail::limits_of(c, c.max_allocation);
    return {};
}

inline result<device> device::create(const device_description& description) {
    if (!description.synchronization2 || !description.dynamic_rendering) {
        return fail(error_code::unavailable,
                    "Skybark needs a Vulkan device with the features synchronization2 and "
                    "dynamicRendering enabled, and a description that says so.");
    }
    auto state = std::make_unique<detail::device_state>();
    context& c = state->shared;
    c.description = description;
    auto table =
        load_functions(description.instance, description.device, description.get_instance_proc_addr,
                       description.get_device_proc_addr, description.debug_utils);
    if (!table) {
        return failure(table.error());
    }
    c.call = *table;
    c.watched = description.hooks.has_zones() || c.call.begin_label;
    if (auto done = fill_in(c); !done) {
        return failure(done.error());
    }
    auto unused = detail::make_buffer_memory(c, 256, memory_kind::device, "spare buffer");
    if (!unused) {
        return failure(unused.error());
    }
    state->unused = *unused;
    c.unused = {unused->buffer, 0, unused->size};
    c.say(log_level::info, [&c] {
        const std::uint32_t v = c.properties.apiVersion;
        return "The vulkan device is " + std::string(c.properties.deviceName) + ", Vulkan " +
               std::to_string(VK_API_VERSION_MAJOR(v)) + "." +
               std::to_string(VK_API_VERSION_MINOR(v)) + ", driver " +
               std::to_string(c.properties.driverVersion) + ".";
    });
    return device(std::move(state));
}

} // namespace skybark::vulkan
