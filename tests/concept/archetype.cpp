// A backend from a foreign namespace that has what the concepts say and nothing else: no default
// constructors, no copies, no base classes, no conversions.

#include <skybark/kernels/probe_level.hpp>
#include <skybark/kernels/probe_map.hpp>
#include <skybark/kernels/probe_rings.hpp>
#include <skybark/kernels/probe_strips.hpp>
#include <skybark/kernels/probe_surface.hpp>

#include <skybark/core/backend.hpp>
#include <skybark/core/validated.hpp>

#include <gtest/gtest.h>

namespace elsewhere {

struct pinned { // cannot be copied, only moved
    explicit pinned(int) {}
    pinned(pinned&&) = default;
    pinned& operator=(pinned&&) = default;
};

struct memory : pinned {
    using pinned::pinned;
    [[nodiscard]] std::uint64_t size_bytes() const { return 0; }
};
struct raster : pinned {
    using pinned::pinned;
    [[nodiscard]] skybark::image_description description() const { return {}; }
};

/// The base concept and no pattern.
struct least {
    using backend_tag = skybark::backend_tag;
    using buffer = memory;
    using image = raster;
    struct recorder : pinned {
        using pinned::pinned;
        void upload(const skybark::buffer_view<least>&, std::span<const std::byte>) {}
        void copy(const skybark::buffer_view<least>&, const skybark::buffer_view<least>&) {}
    };

    least(const least&) = delete;
    least& operator=(const least&) = delete;
    explicit least(int) {}

    [[nodiscard]] const char* name() const { return "least"; }
    [[nodiscard]] const char* device_name() const { return "archetype"; }
    [[nodiscard]] skybark::device_limits limits() const { return {}; }
    [[nodiscard]] skybark::device_traffic traffic() const { return {}; }
    [[nodiscard]] skybark::result<buffer> create_buffer(std::uint64_t) { return buffer(0); }
    [[nodiscard]] skybark::result<image> create_image(skybark::image_description) {
        return image(0);
    }
    skybark::result<void> upload(const buffer&, std::uint64_t, std::span<const std::byte>) {
        return {};
    }
    skybark::result<void> download(const buffer&, std::uint64_t, std::span<std::byte>) {
        return {};
    }
    skybark::result<void> upload(const image&, std::span<const std::byte>) { return {}; }
    skybark::result<void> download(const image&, std::span<std::byte>) { return {}; }
    [[nodiscard]] skybark::result<recorder> begin() { return recorder(0); }
    skybark::result<void> submit(recorder&) { return {}; }
};
static_assert(skybark::backend<least>);
static_assert(!skybark::maps<least, skybark::kernels::probe_map>);
static_assert(!skybark::expands<least, skybark::kernels::probe_strips>);
static_assert(!skybark::expands_rings<least, skybark::kernels::probe_rings>);
static_assert(!skybark::draws<least, skybark::kernels::probe_surface>);

/// One kernel of one pattern: the concepts ask about each pair of a backend and a kernel alone.
struct mapper : least {
    using kernel = skybark::kernels::probe_level;
    struct recorder : pinned {
        using pinned::pinned;
        using bound = skybark::bindings<mapper, kernel>;
        void upload(const skybark::buffer_view<mapper>&, std::span<const std::byte>) {}
        void copy(const skybark::buffer_view<mapper>&, const skybark::buffer_view<mapper>&) {}
        void map(const kernel&, const bound&, skybark::range) { ++maps; }
        void map(const kernel&, const bound&, std::span<const skybark::range>) { ++maps; }
        void map(const kernel&, const bound&, const skybark::counted<mapper>&) { ++maps; }
        int maps = 0;
    };
    using least::least;
    [[nodiscard]] skybark::result<recorder> begin() { return recorder(0); }
    skybark::result<void> submit(recorder& done) {
        submitted += done.maps;
        return {};
    }
    int submitted = 0;
};
static_assert(skybark::backend<mapper>);
static_assert(skybark::maps<mapper, skybark::kernels::probe_level>);
static_assert(!skybark::maps<mapper, skybark::kernels::probe_map>);

/// The same shape without the tag is no backend.
struct untagged : least {
    struct backend_tag {};
    using least::least;
};
static_assert(!skybark::backend<untagged>);

// validated<B> models what B models, no more and no less.
static_assert(skybark::backend<skybark::validated<least>>);
static_assert(!skybark::maps<skybark::validated<least>, skybark::kernels::probe_map>);
static_assert(skybark::maps<skybark::validated<mapper>, skybark::kernels::probe_level>);
static_assert(!skybark::maps<skybark::validated<mapper>, skybark::kernels::probe_map>);
static_assert(!skybark::expands<skybark::validated<mapper>, skybark::kernels::probe_strips>);

} // namespace elsewhere

namespace {

TEST(archetype, runs_what_it_models) {
    elsewhere::mapper device(0);
    const auto done = skybark::run(device, [](auto& r) {
        r.map(skybark::kernels::probe_level{}, {}, skybark::range{0, 1});
        r.map(skybark::kernels::probe_level{}, {}, std::span<const skybark::range>{});
    });
    EXPECT_TRUE(done);
    EXPECT_EQ(device.submitted, 2);
}

TEST(archetype, gives_buffers_by_value) {
    elsewhere::least device(0);
    const std::uint32_t numbers[] = {1, 2, 3};
    EXPECT_TRUE(skybark::make_buffer(device, std::span<const std::uint32_t>(numbers)));
}

} // namespace
