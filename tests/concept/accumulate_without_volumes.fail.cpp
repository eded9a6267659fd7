// expect: accumulates[\s\S]*volume
#include <skybark/kernels/probe_slabs.hpp>

#include <skybark/core/backend.hpp>

namespace {
struct memory {
    std::uint64_t size_bytes() const;
};
struct raster {
    skybark::image_description description() const;
};
} // namespace

struct flat { // a backend, and no volumes to add to
    using backend_tag = skybark::backend_tag;
    using buffer = memory;
    using image = raster;
    struct recorder {
        void upload(const skybark::buffer_view<flat>&, std::span<const std::byte>);
        void copy(const skybark::buffer_view<flat>&, const skybark::buffer_view<flat>&);
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
static_assert(skybark::backend<flat>);

template <class B>
requires skybark::accumulates<B, skybark::kernels::probe_slabs>
void shade(B&) {}

void use(flat& device) { shade(device); }
