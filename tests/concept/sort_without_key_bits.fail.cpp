// expect: sorts[\s\S]*key_bits
#include <skybark/core/backend.hpp>

namespace {
struct memory {
    std::uint64_t size_bytes() const;
};
struct raster {
    skybark::image_description description() const;
};
} // namespace

struct slow { // sorts, and always by all bits
    using backend_tag = skybark::backend_tag;
    using buffer = memory;
    using image = raster;
    struct recorder {
        using view = skybark::buffer_view<slow>;
        void upload(const view&, std::span<const std::byte>);
        void copy(const view&, const view&);
        void sort(const view&, const view&);
        void sort(const view&, const view&, const skybark::counted<slow>&);
    };
    const char* name() const;
    const char* device_name() const;
    skybark::device_limits limits() const;
    skybark::device_traffic traffic() const;
    skybark::result<buffer> create_buffer(std::uint64_t);
    skybark::result<image> create_image(skybark::image_description);
    skybark::result<void> upload(const buffer&, std::uint64_t, std::span<const std::byte>);
    skybark::result<void> download(const buffer&, std::uint64_t, std::span<std::byte>);
    skybark::result<void> upload(const image&, std::span<const std::byte>);
    skybark::result<void> download(const image&, std::span<std::byte>);
    skybark::result<recorder> begin();
    skybark::result<void> submit(recorder&);
};
static_assert(skybark::backend<slow>);

template <class B>
requires skybark::sorts<B>
void order(B&) {}

void use(slow& device) { order(device); }
