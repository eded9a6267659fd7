#pragma once
// Buffers, images and volumes of the CPU backend: plain memory, ours or the caller's.

#include <skybark/core/backend.hpp>
#include <skybark/core/hooks.hpp>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <type_traits>

#if __has_include(<sys/mman.h>)
#    include <sys/mman.h>
#endif
#if __has_include(<unistd.h>)
#    include <unistd.h>
#endif

namespace skybark::cpu {

/// Vertices are stored past the cache in 16-byte pieces, and lines are 64 bytes.
inline constexpr std::size_t memory_alignment = 64;

/// Where a device's memory comes from: buffers, images, volumes, and what patterns keep to work in.
/// Both or none. Called on the thread that calls the device, except that draws may ask for memory
/// in their tasks; and on whatever thread destroys a buffer, an image or a volume.
struct memory_hooks {
    void* user = nullptr; ///< given to both
    /// `bytes` bytes, of any content, aligned to `alignment` (64), or null where there are none.
    void* (*allocate)(void* user, std::size_t bytes, std::size_t alignment) = nullptr;
    /// What `allocate` returned, and what it was asked for.
    void (*free)(void* user, void* memory, std::size_t bytes, std::size_t alignment) = nullptr;
};

namespace detail {
struct free_memory {
    memory_hooks hooks = {};
    std::size_t bytes = 0;
    device_usage* usage = nullptr; ///< of the device, where this counts as an object of it
    std::uint64_t size = 0;        ///< of the object

    void operator()(void* memory) const noexcept {
        if (usage != nullptr) {
            usage->remove(size);
        }
        if (hooks.allocate != nullptr) {
            hooks.free(hooks.user, memory, bytes, memory_alignment);
        } else {
            std::free(memory);
        }
    }
};
using memory = std::unique_ptr<void, free_memory>;

/// Zeroed memory. The pages come from the system when they are first touched; large ones, where it
/// has them, are found again faster.
[[nodiscard]] inline memory allocate_zeroed(std::size_t bytes) {
    memory made(std::calloc(bytes + memory_alignment, 1));
#if defined(MADV_HUGEPAGE)
    constexpr std::size_t page = std::size_t{1} << 21;
    void* first = made.get();
    std::size_t space = bytes;
    if (first != nullptr && bytes >= 4 * page && std::align(page, page, first, space) != nullptr) {
        // Advice: where it is not taken, nothing is lost.
        (void)madvise(first, space / page * page, MADV_HUGEPAGE);
    }
#endif
    return made;
}

/// Memory of a caller's, of undefined content. As much more as ours has: reads may go too far.
[[nodiscard]] inline memory allocate_from(const memory_hooks& from, std::size_t bytes) {
    const std::size_t wanted = bytes + memory_alignment;
    return memory(from.allocate(from.user, wanted, memory_alignment), free_memory{from, wanted});
}

/// The same from wherever a device has its memory.
[[nodiscard]] inline memory allocate_zeroed(const memory_hooks& from, std::size_t bytes) {
    if (from.allocate == nullptr) {
        return allocate_zeroed(bytes);
    }
    memory made = allocate_from(from, bytes);
    if (made) {
        std::memset(made.get(), 0, bytes);
    }
    return made;
}

/// What a device's parts have in common. It stays where it is when the device moves.
struct memory_source {
    memory_hooks memory;
    skybark::hooks hooks;
    device_usage usage;
};

[[nodiscard]] inline std::byte* align_up(void* pointer) {
    void* aligned = pointer;
    std::size_t space = memory_alignment;
    return static_cast<std::byte*>(std::align(memory_alignment, 0, aligned, space));
}

/// Says that this will soon be read.
inline void fetch([[maybe_unused]] const void* what) {
#if defined(__GNUC__)
    __builtin_prefetch(what);
    // Or else GCC takes functions that only do this for such that do nothing, and leaves them out.
    asm volatile("");
#endif
}

/// What the machine has, in bytes; as much as there may be where it does not say. Systems promise
/// more than they have, and end the program that takes it.
[[nodiscard]] inline std::uint64_t memory_of_machine() {
#if defined(_SC_PHYS_PAGES) && defined(_SC_PAGESIZE)
    const long pages = sysconf(_SC_PHYS_PAGES);
    const long size = sysconf(_SC_PAGESIZE);
    if (pages > 0 && size > 0) {
        return static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(size);
    }
#endif
    return std::uint64_t{1} << 46;
}

/// Memory that calls use again. It grows and never shrinks.
class scratch_memory {
  public:
    scratch_memory() = default;
    explicit scratch_memory(const memory_source* source) : source_(source) {}

    /// Room for `count` values, of undefined content; null where there is no memory.
    template <class T>
    [[nodiscard]] T* room_for(std::uint64_t count) {
        if (count > most_bytes / sizeof(T)) {
            return nullptr;
        }
        const std::uint64_t bytes = count * sizeof(T);
        if (!owned_ || bytes > size_) {
            owned_.reset();
            size_ = std::max<std::uint64_t>(bytes, std::min(most_bytes, size_ + size_ / 2));
            owned_ = allocate(size_);
        }
        return owned_ ? reinterpret_cast<T*>(align_up(owned_.get())) : nullptr;
    }

  private:
    static constexpr std::uint64_t most_bytes = std::uint64_t{1} << 46;

    [[nodiscard]] memory allocate(std::uint64_t bytes) const {
        if (source_ == nullptr) {
            return allocate_zeroed(bytes);
        }
        memory made = source_->memory.allocate != nullptr ? allocate_from(source_->memory, bytes)
                                                          : allocate_zeroed(bytes);
        log(source_->hooks, made ? log_level::debug : log_level::warning, [&] {
            return std::string("The cpu device ") + (made ? "keeps " : "could not have ") +
                   std::to_string(bytes) + " bytes to work in.";
        });
        return made;
    }

    const memory_source* source_ = nullptr; ///< null: the heap
    memory owned_;
    std::uint64_t size_ = 0;
};

/// A list that grows, and keeps its room when it is cleared. It may be filled in a task: it logs
/// nothing.
template <class T>
class kept_list {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    /// `least`: values that there is room for from the first on.
    explicit kept_list(const memory_source* source, std::size_t least = 64)
        : source_(source), least_(least) {}

    void clear() noexcept { size_ = 0; }
    /// Left out where there is no memory: see `complete`.
    void push_back(const T& value) {
        if (size_ < room_ || grow()) {
            data_[size_++] = value;
        }
    }
    [[nodiscard]] bool complete() const noexcept { return complete_; }
    [[nodiscard]] const T* begin() const noexcept { return data_; }
    [[nodiscard]] const T* end() const noexcept { return data_ + size_; }

  private:
    [[nodiscard]] bool grow() {
        const std::size_t room = std::max(least_, 2 * room_);
        memory larger = source_ != nullptr && source_->memory.allocate != nullptr
                            ? allocate_from(source_->memory, room * sizeof(T))
                            : allocate_zeroed(room * sizeof(T));
        if (!larger) {
            complete_ = false;
            return false;
        }
        T* const to = reinterpret_cast<T*>(align_up(larger.get()));
        std::copy(begin(), end(), to);
        owned_ = std::move(larger);
        data_ = to;
        room_ = room;
        return true;
    }

    const memory_source* source_;
    std::size_t least_;
    memory owned_;
    T* data_ = nullptr;
    std::size_t size_ = 0;
    std::size_t room_ = 0;
    bool complete_ = true;
};
} // namespace detail

/// A buffer: zeroed memory of its own (`device::create_buffer`), or a view of the caller's
/// (`wrap`).
class buffer {
  public:
    buffer() = default;
    buffer(detail::memory owned, std::uint64_t bytes)
        : owned_(std::move(owned)), data_(detail::align_up(owned_.get())), size_(bytes) {}

    /// The caller's memory, 16-byte aligned; it must outlive the buffer.
    [[nodiscard]] static buffer wrap(std::span<std::byte> memory) {
        buffer wrapped;
        wrapped.data_ = memory.data();
        wrapped.size_ = memory.size();
        return wrapped;
    }

    [[nodiscard]] std::uint64_t size_bytes() const noexcept { return size_; }
    [[nodiscard]] std::byte* data() const noexcept { return data_; }

  private:
    detail::memory owned_;
    std::byte* data_ = nullptr;
    std::uint64_t size_ = 0;
};

/// An image: rows from the top, pixels without gaps.
class image {
  public:
    image() = default;
    image(detail::memory owned, image_description what)
        : owned_(std::move(owned)), data_(detail::align_up(owned_.get())), what_(what) {}

    [[nodiscard]] static image wrap(std::span<std::byte> memory, image_description what) {
        image wrapped;
        wrapped.data_ = memory.data();
        wrapped.what_ = what;
        return wrapped;
    }

    [[nodiscard]] image_description description() const noexcept { return what_; }
    [[nodiscard]] std::byte* data() const noexcept { return data_; }
    [[nodiscard]] std::uint64_t size_bytes() const noexcept {
        return std::uint64_t{what_.width} * what_.height * bytes_per_pixel(what_.format);
    }

  private:
    detail::memory owned_;
    std::byte* data_ = nullptr;
    image_description what_;
};

/// A volume: voxels without gaps, x fastest, then y, then z.
class volume {
  public:
    volume() = default;
    volume(detail::memory owned, volume_description what)
        : owned_(std::move(owned)), data_(detail::align_up(owned_.get())), what_(what) {}

    /// The caller's memory of `what.size_bytes()`, 16-byte aligned; it must outlive the volume.
    [[nodiscard]] static volume wrap(std::span<std::byte> memory, volume_description what) {
        volume wrapped;
        wrapped.data_ = memory.data();
        wrapped.what_ = what;
        return wrapped;
    }

    [[nodiscard]] volume_description description() const noexcept { return what_; }
    [[nodiscard]] std::byte* data() const noexcept { return data_; }
    [[nodiscard]] std::uint64_t size_bytes() const noexcept { return what_.size_bytes(); }

  private:
    detail::memory owned_;
    std::byte* data_ = nullptr;
    volume_description what_;
};

/// The records of a view.
template <class B, class Span>
[[nodiscard]] Span records_of(const buffer_view<B>& view) {
    using value = typename Span::element_type;
    if (!view) {
        return {};
    }
    return {reinterpret_cast<value*>(view.buffer->data() + view.offset), view.size / sizeof(value)};
}

} // namespace skybark::cpu
