#pragma once
// A 2-D texture, made by a device or wrapped around the caller's. Row 0 is the top.

#include <skybark/opengl/context.hpp>

#include <utility>

namespace skybark::opengl {

namespace detail {

[[nodiscard]] constexpr std::uint64_t bytes_of(const image_description& d) noexcept {
    return std::uint64_t{d.width} * d.height * bytes_per_pixel(d.format);
}

} // namespace detail

/// Pixels in the device's memory. Deletes its object unless it was wrapped.
class image {
  public:
    image() = default;
    image(image&& other) noexcept { swap(other); }
    image& operator=(image&& other) noexcept {
        image(std::move(other)).swap(*this);
        return *this;
    }
    ~image() {
        if (owner_ != nullptr) {
            owner_->destroy_texture(name_);
            owner_->usage.remove(detail::bytes_of(description_));
        }
    }

    [[nodiscard]] image_description description() const noexcept { return description_; }
    /// The object's OpenGL name, to use it elsewhere.
    [[nodiscard]] gl::handle name() const noexcept { return name_; }

  private:
    friend class device;
    image(detail::context* owner, gl::handle name, image_description description) noexcept
        : owner_(owner), name_(name), description_(description) {}
    void swap(image& other) noexcept {
        std::swap(owner_, other.owner_);
        std::swap(name_, other.name_);
        std::swap(description_, other.description_);
    }

    detail::context* owner_ = nullptr;
    gl::handle name_ = 0;
    image_description description_;
};

namespace detail {

/// The three formats as OpenGL names them.
struct pixel_format {
    gl::token internal = 0;
    gl::token format = 0;
    gl::token type = 0;
};

[[nodiscard]] constexpr pixel_format format_of(image_format format) noexcept {
    switch (format) {
    case image_format::rgba8:
        return {gl::rgba8, gl::rgba, gl::unsigned_byte};
    case image_format::rgba32f:
        return {gl::rgba32f, gl::rgba, gl::float32};
    case image_format::depth32f:
        break;
    }
    return {gl::depth_component32f, gl::depth_component, gl::float32};
}

} // namespace detail
} // namespace skybark::opengl
