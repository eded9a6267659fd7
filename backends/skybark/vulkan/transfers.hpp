#pragma once
// The rest of the device: what records and submits by itself. Making and wrapping objects, uploads
// and downloads, begin and submit, and the caller's command buffer.

#include <skybark/vulkan/recorder.hpp>

namespace skybark::vulkan {

inline buffer device::wrap(const foreign_buffer& foreign) { return buffer(shared(), foreign); }

inline result<image> device::wrap(const foreign_image& foreign) {
    if (auto alive = shared().alive(); !alive) {
        return failure(alive.error());
    }
    image::parts parts;
    parts.foreign = foreign;
    if (parts.foreign.format == VK_FORMAT_UNDEFINED) {
        parts.foreign.format = format_of(foreign.description.format);
    }
    if (auto done = image::add_view(shared(), parts); !done) {
        return failure(done.error());
    }
    return image(shared(), parts);
}

inline result<volume> device::wrap(const foreign_volume& foreign) {
    if (auto alive = shared().alive(); !alive) {
        return failure(alive.error());
    }
    volume::parts parts;
    parts.foreign = foreign;
    if (auto done = volume::add_view(shared(), parts); !done) {
        return failure(done.error());
    }
    return volume(shared(), parts);
}

inline result<recorder> device::begin() {
    if (auto alive = shared().alive(); !alive) {
        return failure(alive.error());
    }
    auto recording = state_->take_recording();
    if (auto done = recording->begin(); !done) {
        state_->give_back(std::move(recording));
        return failure(done.error());
    }
    return vulkan::recorder(*state_, std::move(recording), true);
}

inline result<recorder> device::record_into(VkCommandBuffer commands) {
    if (auto alive = shared().alive(); !alive) {
        return failure(alive.error());
    }
    auto recording = state_->take_recording();
    recording->append_to(commands);
    return vulkan::recorder(*state_, std::move(recording), false);
}

inline result<ticket> device::finish(vulkan::recorder& into) {
    assert(into.recording_ && !into.own_);
    into.close();
    auto recording = into.take_recording();
    if (into.error_) {
        state_->give_back(std::move(recording));
        return failure(*into.error_);
    }
    return ticket(*state_, std::move(recording));
}

inline result<void> device::execute(vulkan::recorder& into) {
    into.close();
    if (into.error_) {
        return failure(*into.error_);
    }
    context& c = shared();
    const hooks& watchers = c.description.hooks;
    const zone here(watchers, "submit");
    const VkFence fence = into.recording_->fence();
    if (auto done = c.check(c.call.end_command_buffer(into.commands()), "end a command buffer");
        !done) {
        return done;
    }
    auto commands = make<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
    commands.commandBuffer = into.commands();
    auto info = make<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
    info.commandBufferInfoCount = 1;
    info.pCommandBufferInfos = &commands;
    if (auto done = c.check(c.call.queue_submit(c.description.queue, 1, &info, fence), "submit");
        !done) {
        return done;
    }
    const zone waiting(watchers, "wait");
    if (auto done = c.check(c.call.wait_for_fences(c.device(), 1, &fence, VK_TRUE, ~0ull),
                            "wait for what was submitted");
        !done) {
        return done;
    }
    return c.check(c.call.reset_fences(c.device(), 1, &fence), "reset a fence");
}

inline result<void> device::submit(vulkan::recorder& into) {
    if (!into.recording_ || !into.own_) {
        return fail(error_code::bad_input, "This recorder has been submitted already, or records "
                                           "into the caller's command buffer: use finish().");
    }
    auto done = execute(into);
    state_->give_back(into.take_recording());
    return done;
}

/// Records with `record(into)` and submits.
template <class Record>
result<void> device::at_once(Record&& record) {
    auto into = begin();
    if (!into) {
        return failure(into.error());
    }
    record(*into);
    return submit(*into);
}

inline result<void> device::wait_idle() {
    context& c = shared();
    if (auto alive = c.alive(); !alive) {
        return alive;
    }
    const zone here(c.description.hooks, "wait");
    return c.check(c.call.queue_wait_idle(c.description.queue), "wait for the queue");
}

inline result<buffer> device::create_buffer(std::uint64_t bytes) {
    context& c = shared();
    if (auto alive = c.alive(); !alive) {
        return failure(alive.error());
    }
    if (bytes == 0) {
        return buffer(c, detail::buffer_memory{}, 0);
    }
    if (bytes > c.max_allocation - 16) {
        return fail(error_code::out_of_memory,
                    "A buffer of " + std::to_string(bytes) + " bytes was asked for; " +
                        device_name() + " has buffers of at most " +
                        std::to_string(c.max_allocation - 16) + " bytes.");
    }
    auto memory =
        detail::make_buffer_memory(c, (bytes + 15) / 16 * 16, memory_kind::device, "buffer");
    if (!memory) {
        return failure(memory.error());
    }
    detail::count(c, memory->memory, bytes);
    buffer made(c, *memory, bytes);
    if (made.mapped()) {
        std::memset(made.mapped(), 0, memory->size);
        return made;
    }
    auto done = at_once([&](vulkan::recorder& r) {
        r.barrier();
        c.call.fill_buffer(r.commands(), made.handle(), 0, VK_WHOLE_SIZE, 0);
    });
    if (!done) {
        return failure(done.error());
    }
    return made;
}

inline result<image> device::create_image(image_description what) {
    context& c = shared();
    if (auto alive = c.alive(); !alive) {
        return failure(alive.error());
    }
    if (what.width == 0 || what.height == 0 ||
        std::max(what.width, what.height) > c.limits.max_image_size) {
        return fail(error_code::out_of_memory,
                    device_name() + " cannot make an image of " + std::to_string(what.width) +
                        " x " + std::to_string(what.height) + " pixels; each side must be 1 to " +
                        std::to_string(c.limits.max_image_size) + ".");
    }
    auto made = image::create(c, what, format_of(what.format));
    if (!made) {
        return made;
    }
    detail::count(c, made->parts_.memory,
                  std::uint64_t{what.width} * what.height * bytes_per_pixel(what.format));
    auto done = at_once([&](vulkan::recorder& r) {
        r.image_barrier(made->handle(), aspect_of(what.format), VK_IMAGE_LAYOUT_UNDEFINED,
                        VK_IMAGE_LAYOUT_GENERAL, foreign_access{}, foreign_access{});
    });
    if (!done) {
        return failure(done.error());
    }
    return made;
}

inline result<volume> device::create_volume(volume_description what) {
    context& c = shared();
    if (auto alive = c.alive(); !alive) {
        return failure(alive.error());
    }
    volume::parts parts;
    parts.foreign.description = what;
    auto done = volume::add_image(c, parts);
    if (done) {
        detail::count(c, parts.memory, what.size_bytes());
        done = volume::add_view(c, parts);
    }
    volume made(c, parts); // gives back what there is
    if (done) {
        done = at_once([&](vulkan::recorder& r) {
            r.image_barrier(made.handle(), VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                            VK_IMAGE_LAYOUT_GENERAL, foreign_access{}, foreign_access{});
        });
    }
    if (!done) {
        return failure(done.error());
    }
    return made;
}

/// Staging memory that an upload or a download takes at once.
inline constexpr std::uint64_t staging_piece = 16 << 20;

/// A foreign image may change its layout with each recording, so all of it goes in one.
[[nodiscard]] inline std::uint32_t rows_at_once(const image& of) {
    const image_description what = of.description();
    const std::uint64_t row = std::uint64_t{what.width} * bytes_per_pixel(what.format);
    return of.is_foreign()
               ? what.height
               : static_cast<std::uint32_t>(std::max<std::uint64_t>(1, staging_piece / row));
}

inline result<void> device::upload(const buffer& to, std::uint64_t offset,
                                   std::span<const std::byte> bytes) {
    const zone here(shared().description.hooks, "upload");
    assert(offset + bytes.size() <= to.size_bytes());
    if (bytes.empty()) {
        return shared().alive();
    }
    if (to.mapped()) {
        if (auto done = wait_idle(); !done) {
            return done;
        }
        std::memcpy(to.mapped() + offset, bytes.data(), bytes.size());
        shared().traffic.up += bytes.size();
        return {};
    }
    for (std::uint64_t at = 0; at < bytes.size(); at += staging_piece) {
        const auto piece = bytes.subspan(at, std::min(staging_piece, bytes.size() - at));
        const buffer_view<device> target{&to, offset + at, piece.size()};
        auto done = at_once([&](vulkan::recorder& r) { r.upload(target, piece); });
        if (!done) {
            return done;
        }
    }
    return {};
}

inline result<void> device::download(const buffer& from, std::uint64_t offset,
                                     std::span<std::byte> bytes) {
    const zone here(shared().description.hooks, "download");
    assert(offset + bytes.size() <= from.size_bytes());
    if (bytes.empty()) {
        return shared().alive();
    }
    if (from.mapped()) {
        if (auto done = wait_idle(); !done) {
            return done;
        }
        std::memcpy(bytes.data(), from.mapped() + offset, bytes.size());
        shared().traffic.down += bytes.size();
        return {};
    }
    for (std::uint64_t at = 0; at < bytes.size(); at += staging_piece) {
        const auto piece = bytes.subspan(at, std::min(staging_piece, bytes.size() - at));
        auto into = begin();
        if (!into) {
            return failure(into.error());
        }
        auto staged = into->recording_->readback.take(piece.size());
        if (!staged) {
            return failure(staged.error());
        }
        into->copy_slice(into->bound({&from, offset + at, piece.size()}), staged->where);
        if (auto done = execute(*into); !done) {
            return done;
        }
        std::memcpy(piece.data(), staged->mapped, piece.size());
        shared().traffic.down += piece.size();
    }
    return {};
}

inline result<void> device::upload(const image& to, std::span<const std::byte> bytes) {
    const zone here(shared().description.hooks, "upload");
    const image_description what = to.description();
    const std::size_t row = what.width * bytes_per_pixel(what.format);
    assert(bytes.size() == row * what.height);
    const std::uint32_t rows = rows_at_once(to);
    for (std::uint32_t y = 0; y < what.height; y += rows) {
        const std::uint32_t n = std::min(rows, what.height - y);
        auto into = begin();
        if (!into) {
            return failure(into.error());
        }
        auto staged = into->recording_->staging.take(n * row);
        if (!staged) {
            return failure(staged.error());
        }
        std::memcpy(staged->mapped, bytes.data() + y * row, n * row);
        shared().traffic.up += n * row;
        into->barrier();
        into->use(to);
        const VkBufferImageCopy region = vulkan::recorder::rows(to, staged->where, y, n);
        shared().call.copy_buffer_to_image(into->commands(), staged->where.buffer, to.handle(),
                                           VK_IMAGE_LAYOUT_GENERAL, 1, &region);
        if (auto done = submit(*into); !done) {
            return done;
        }
    }
    return {};
}

inline result<void> device::download(const image& from, std::span<std::byte> bytes) {
    const zone here(shared().description.hooks, "download");
    const image_description what = from.description();
    const std::size_t row = what.width * bytes_per_pixel(what.format);
    assert(bytes.size() == row * what.height);
    const std::uint32_t rows = rows_at_once(from);
    for (std::uint32_t y = 0; y < what.height; y += rows) {
        const std::uint32_t n = std::min(rows, what.height - y);
        auto into = begin();
        if (!into) {
            return failure(into.error());
        }
        auto staged = into->recording_->readback.take(n * row);
        if (!staged) {
            return failure(staged.error());
        }
        into->barrier();
        into->use(from);
        const VkBufferImageCopy region = vulkan::recorder::rows(from, staged->where, y, n);
        shared().call.copy_image_to_buffer(into->commands(), from.handle(), VK_IMAGE_LAYOUT_GENERAL,
                                           staged->where.buffer, 1, &region);
        if (auto done = execute(*into); !done) {
            return done;
        }
        std::memcpy(bytes.data() + y * row, staged->mapped, n * row);
        shared().traffic.down += n * row;
    }
    return {};
}

namespace detail {

/// A box of a volume that goes through staging memory at once: whole layers, or some rows of one.
struct volume_piece {
    std::uint32_t y = 0, z = 0, rows = 0, layers = 0;
};

/// Calls `go(piece, offset, bytes)` for one piece after another until one fails. A foreign volume
/// goes in one: it may change its layout with each recording.
template <class Go>
[[nodiscard]] result<void> for_pieces(const volume& of, Go&& go) {
    const volume_description what = of.description();
    const std::uint64_t row = std::uint64_t{what.width} * bytes_per_voxel(what.format);
    const std::uint64_t layer = row * what.height;
    const auto fit = [&](std::uint64_t each, std::uint32_t most) {
        const std::uint64_t n = of.is_foreign() ? most : staging_piece / each;
        return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(n, 1, most));
    };
    const std::uint32_t layers = fit(layer, what.depth);
    const std::uint32_t rows = layers > 1 ? what.height : fit(row, what.height);
    for (std::uint32_t z = 0; z < what.depth; z += layers) {
        for (std::uint32_t y = 0; y < what.height; y += rows) {
            const volume_piece piece{y, z, std::min(rows, what.height - y),
                                     std::min(layers, what.depth - z)};
            if (auto done = go(piece, z * layer + y * row, row * piece.rows * piece.layers);
                !done) {
                return done;
            }
        }
    }
    return {};
}

[[nodiscard]] inline VkBufferImageCopy region_of(const volume& of, const volume_piece& piece,
                                                 const slice& in) {
    VkBufferImageCopy region{};
    region.bufferOffset = in.offset;
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageOffset = {0, static_cast<std::int32_t>(piece.y),
                          static_cast<std::int32_t>(piece.z)};
    region.imageExtent = {of.description().width, piece.rows, piece.layers};
    return region;
}

} // namespace detail

inline result<void> device::upload(const volume& to, std::span<const std::byte> bytes) {
    const zone here(shared().description.hooks, "upload");
    assert(bytes.size() == to.description().size_bytes());
    return detail::for_pieces(
        to,
        [&](const detail::volume_piece& piece, std::uint64_t at,
            std::uint64_t size) -> result<void> {
            auto into = begin();
            if (!into) {
                return failure(into.error());
            }
            auto staged = into->recording_->staging.take(size);
            if (!staged) {
                return failure(staged.error());
            }
            std::memcpy(staged->mapped, bytes.data() + at, size);
            shared().traffic.up += size;
            into->barrier();
            into->use(to);
            const VkBufferImageCopy region = detail::region_of(to, piece, staged->where);
            shared().call.copy_buffer_to_image(into->commands(), staged->where.buffer, to.handle(),
                                               VK_IMAGE_LAYOUT_GENERAL, 1, &region);
            return submit(*into);
        });
}

inline result<void> device::download(const volume& from, std::span<std::byte> bytes) {
    const zone here(shared().description.hooks, "download");
    assert(bytes.size() == from.description().size_bytes());
    return detail::for_pieces(from,
                              [&](const detail::volume_piece& piece, std::uint64_t at,
                                  std::uint64_t size) -> result<void> {
                                  auto into = begin();
                                  if (!into) {
                                      return failure(into.error());
                                  }
                                  auto staged = into->recording_->readback.take(size);
                                  if (!staged) {
                                      return failure(staged.error());
                                  }
                                  into->barrier();
                                  into->use(from);
                                  const VkBufferImageCopy region =
                                      detail::region_of(from, piece, staged->where);
                                  shared().call.copy_image_to_buffer(
                                      into->commands(), from.handle(), VK_IMAGE_LAYOUT_GENERAL,
                                      staged->where.buffer, 1, &region);
                                  if (auto done = execute(*into); !done) {
                                      return done;
                                  }
                                  std::memcpy(bytes.data() + at, staged->mapped, size);
                                  shared().traffic.down += size;
                                  return {};
                              });
}

} // namespace skybark::vulkan
