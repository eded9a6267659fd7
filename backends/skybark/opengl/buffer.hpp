#pragma once
// A buffer object, made by a device or wrapped around the caller's.

#include <skybark/opengl/context.hpp>

#include <utility>

namespace skybark::opengl {

/// Bytes in the device's memory. Deletes its object unless it was wrapped.
class buffer {
  public:
    buffer() = default;
    buffer(buffer&& other) noexcept { swap(other); }
    buffer& operator=(buffer&& other) noexcept {
        buffer(std::move(other)).swap(*this);
        return *this;
    }
    ~buffer() {
        if (owner_ != nullptr) {
            owner_->destroy_buffer(name_);
            owner_->usage.remove(bytes_);
        }
    }

    [[nodiscard]] std::uint64_t size_bytes() const noexcept { return bytes_; }
    /// The object's OpenGL name, to use it elsewhere.
    [[nodiscard]] gl::handle name() const noexcept { return name_; }

  private:
    friend class device;
    buffer(detail::context* owner, gl::handle name, std::uint64_t bytes) noexcept
        : owner_(owner), name_(name), bytes_(bytes) {}
    void swap(buffer& other) noexcept {
        std::swap(owner_, other.owner_);
        std::swap(name_, other.name_);
        std::swap(bytes_, other.bytes_);
    }

    detail::context* owner_ = nullptr;
    gl::handle name_ = 0;
    std::uint64_t bytes_ = 0;
};

} // namespace skybark::opengl
