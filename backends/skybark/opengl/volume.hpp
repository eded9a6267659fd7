#pragma once
// A 3-D texture, made by a device or wrapped around the caller's.

#include <skybark/opengl/context.hpp>

#include <utility>

namespace skybark::opengl {

/// Voxels in the device's memory. Deletes its object unless it was wrapped.
class volume {
  public:
    volume() = default;
    volume(volume&& other) noexcept { swap(other); }
    volume& operator=(volume&& other) noexcept {
        volume(std::move(other)).swap(*this);
        return *this;
    }
    ~volume() {
        if (owner_ != nullptr) {
            owner_->destroy_texture(name_);
            owner_->usage.remove(description_.size_bytes());
        }
    }

    [[nodiscard]] volume_description description() const noexcept { return description_; }
    /// The object's OpenGL name, to use it elsewhere: a GL_TEXTURE_3D of GL_R32I, GL_R32F or
    /// GL_R16F, its one level immutable. Its parameters are OpenGL's defaults and the caller's to
    /// change: patterns sample by sampler objects. What is called after a pattern sees what it
    /// wrote; glMemoryBarrier has been called.
    [[nodiscard]] gl::handle name() const noexcept { return name_; }

  private:
    friend class device;
    volume(detail::context* owner, gl::handle name, volume_description description) noexcept
        : owner_(owner), name_(name), description_(description) {}
    void swap(volume& other) noexcept {
        std::swap(owner_, other.owner_);
        std::swap(name_, other.name_);
        std::swap(description_, other.description_);
    }

    detail::context* owner_ = nullptr;
    gl::handle name_ = 0;
    volume_description description_;
};

namespace detail {

/// The three formats as OpenGL names them.
struct voxel_format {
    gl::token internal = 0;
    gl::token format = 0;
    gl::token type = 0;
};

[[nodiscard]] constexpr voxel_format format_of(volume_format format) noexcept {
    switch (format) {
    case volume_format::int32:
        return {gl::r32i, gl::red_integer, gl::int32};
    case volume_format::float32:
        return {gl::r32f, gl::red, gl::float32};
    case volume_format::float16:
        break;
    }
    return {gl::r16f, gl::red, gl::float16};
}

} // namespace detail
} // namespace skybark::opengl
