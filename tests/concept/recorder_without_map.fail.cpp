// expect: r\.map\(k, b, ?range
#include <skybark/conformance/null_backend.hpp>
#include <skybark/kernels/probe_map.hpp>

struct without_map {
    using backend_tag = skybark::backend_tag;
    using buffer = skybark::conformance::null_device::buffer;
    using image = skybark::conformance::null_device::image;
    struct recorder {
        void upload(const skybark::buffer_view<without_map>&, std::span<const std::byte>);
        void copy(const skybark::buffer_view<without_map>&,
                  const skybark::buffer_view<without_map>&);
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
static_assert(skybark::backend<without_map>);

template <class B>
requires skybark::maps<B, skybark::kernels::probe_map>
void sway(B&) {}

void use(without_map& device) { sway(device); }
