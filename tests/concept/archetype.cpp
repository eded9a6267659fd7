// A backend from a foreign namespace that has what the concepts say and nothing else: no default
// constructors, no copies, no base classes, no conversions.

#include <skybark/kernels/probe_level.hpp>
#include <skybark/kernels/probe_map.hpp>
#include <skybark/kernels/probe_peel.hpp>
#include <skybark/kernels/probe_rings.hpp>
#include <skybark/kernels/probe_slabs.hpp>
#include <skybark/kernels/probe_strips.hpp>
#include <skybark/kernels/probe_surface.hpp>
#include <skybark/kernels/probe_volume.hpp>
#include <skybark/kernels/probe_volume_draw.hpp>
#include <skybark/kernels/probe_voxels.hpp>

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
static_assert(!skybark::scans<least> && !skybark::sorts<least>);
static_assert(!skybark::peels<least, skybark::kernels::probe_peel>);
static_assert(!skybark::resolves_bundles<least>);
static_assert(!skybark::volume_backend<least>);
static_assert(!skybark::accumulates<least, skybark::kernels::probe_slabs>);
static_assert(!skybark::maps_grids<least, skybark::kernels::probe_volume>);
static_assert(!skybark::maps_voxels<least, skybark::kernels::probe_voxels>);
static_assert(!skybark::draws_volumes<least, skybark::kernels::probe_volume_draw>);

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

struct lattice : pinned {
    using pinned::pinned;
    [[nodiscard]] skybark::volume_description description() const { return {}; }
};

/// What every backend of the following ones has besides.
template <class B>
struct spare_recorder : pinned {
    using pinned::pinned;
    void upload(const skybark::buffer_view<B>&, std::span<const std::byte>) {}
    void copy(const skybark::buffer_view<B>&, const skybark::buffer_view<B>&) {}
};

/// Words and pairs, and no volumes.
struct sorter : least {
    struct recorder : spare_recorder<sorter> {
        using spare_recorder::spare_recorder;
        using view = skybark::buffer_view<sorter>;
        void scan(const view&, const view&) {}
        void sort(const view&, const view&) {}
        void sort(const view&, const view&, std::uint32_t) {}
        void sort(const view&, const view&, const skybark::counted<sorter>&) {}
        void sort(const view&, const view&, const skybark::counted<sorter>&, std::uint32_t) {}
    };
    using least::least;
    [[nodiscard]] skybark::result<recorder> begin() { return recorder(0); }
    skybark::result<void> submit(recorder&) { return {}; }
};
static_assert(skybark::scans<sorter> && skybark::sorts<sorter>);
static_assert(!skybark::volume_backend<sorter>);

/// A sort of all pairs alone is not what is promised.
struct half_a_sorter : least {
    struct recorder : spare_recorder<half_a_sorter> {
        using spare_recorder::spare_recorder;
        using view = skybark::buffer_view<half_a_sorter>;
        void sort(const view&, const view&) {}
    };
    using least::least;
    [[nodiscard]] skybark::result<recorder> begin() { return recorder(0); }
    skybark::result<void> submit(recorder&) { return {}; }
};
static_assert(skybark::backend<half_a_sorter> && !skybark::sorts<half_a_sorter>);

/// Layers of one kernel, and bundles.
struct gatherer : least {
    using kernel = skybark::kernels::probe_peel;
    struct recorder : spare_recorder<gatherer> {
        using spare_recorder::spare_recorder;
        using bound = skybark::bindings<gatherer, kernel>;
        void peel(const kernel&, const bound&, skybark::range,
                  const skybark::peeled_layer<gatherer>&) {
            ++calls;
        }
        void resolve(const skybark::ray_bundle&, const skybark::bundle_work<gatherer>&) { ++calls; }
        int calls = 0;
    };
    using least::least;
    [[nodiscard]] skybark::result<recorder> begin() { return recorder(0); }
    skybark::result<void> submit(recorder& done) {
        submitted += done.calls;
        return {};
    }
    int submitted = 0;
};
static_assert(skybark::peels<gatherer, skybark::kernels::probe_peel>);
static_assert(!skybark::peels<gatherer, skybark::kernels::probe_map>);
static_assert(skybark::resolves_bundles<gatherer>);
static_assert(!skybark::draws<gatherer, skybark::kernels::probe_surface>);

/// Volumes, their scan, and nothing that a kernel does to them.
template <class Recorder>
struct with_volumes : least {
    using volume = lattice;
    using recorder = Recorder;
    using least::download;
    using least::least;
    using least::upload;
    [[nodiscard]] skybark::result<volume> create_volume(skybark::volume_description) {
        return volume(0);
    }
    skybark::result<void> upload(const volume&, std::span<const std::byte>) { return {}; }
    skybark::result<void> download(const volume&, std::span<std::byte>) { return {}; }
    [[nodiscard]] skybark::result<recorder> begin() { return recorder(0); }
    skybark::result<void> submit(recorder& done) {
        submitted += done.calls;
        return {};
    }
    int submitted = 0;
};
template <class B>
struct volume_recorder : spare_recorder<B> {
    using spare_recorder<B>::spare_recorder;
    void scan(const lattice&, const lattice&, skybark::volume_scan) { ++calls; }
    int calls = 0;
};

struct summer : with_volumes<volume_recorder<summer>> {
    using with_volumes::with_volumes;
};
static_assert(skybark::volume_backend<summer>);
static_assert(!skybark::scans<summer>);
static_assert(!skybark::accumulates<summer, skybark::kernels::probe_slabs>);
static_assert(!skybark::maps_voxels<summer, skybark::kernels::probe_voxels>);

/// One kernel of each pattern that has volumes.
struct painter;
struct painter_recorder : volume_recorder<painter> {
    using volume_recorder::volume_recorder;
    template <class K>
    using bound = skybark::bindings<painter, K>;
    template <class K>
    using grids = skybark::volume_bindings<painter, K>;
    using slabs = skybark::kernels::probe_slabs;
    using places = skybark::kernels::probe_volume;
    using voxels = skybark::kernels::probe_voxels;
    using pixels = skybark::kernels::probe_volume_draw;

    inline void accumulate(const slabs&, const bound<slabs>&, skybark::range,
                           const skybark::accumulation<painter>&);
    inline void accumulate(const slabs&, const bound<slabs>&, const skybark::counted<painter>&,
                           const skybark::accumulation<painter>&);
    inline void map(const places&, const bound<places>&, const grids<places>&, skybark::range);
    inline void map_voxels(const voxels&, const bound<voxels>&, const grids<voxels>&, glm::uvec3);
    inline void draw(const pixels&, const bound<pixels>&,
                     const skybark::image_bindings<painter, pixels>&, const grids<pixels>&,
                     const skybark::draw_geometry<painter>&, const skybark::draw_target<painter>&,
                     skybark::draw_state);
};
struct painter : with_volumes<painter_recorder> {
    using with_volumes::with_volumes;
};
void painter_recorder::accumulate(const slabs&, const bound<slabs>&, skybark::range,
                                  const skybark::accumulation<painter>&) {
    ++calls;
}
void painter_recorder::accumulate(const slabs&, const bound<slabs>&,
                                  const skybark::counted<painter>&,
                                  const skybark::accumulation<painter>&) {
    ++calls;
}
void painter_recorder::map(const places&, const bound<places>&, const grids<places>&,
                           skybark::range) {
    ++calls;
}
void painter_recorder::map_voxels(const voxels&, const bound<voxels>&, const grids<voxels>&,
                                  glm::uvec3) {
    ++calls;
}
void painter_recorder::draw(const pixels&, const bound<pixels>&,
                            const skybark::image_bindings<painter, pixels>&, const grids<pixels>&,
                            const skybark::draw_geometry<painter>&,
                            const skybark::draw_target<painter>&, skybark::draw_state) {
    ++calls;
}
static_assert(skybark::accumulates<painter, skybark::kernels::probe_slabs>);
static_assert(!skybark::fuses_accumulate_scan<painter, skybark::kernels::probe_slabs>);
static_assert(skybark::maps_grids<painter, skybark::kernels::probe_volume>);
static_assert(skybark::maps_voxels<painter, skybark::kernels::probe_voxels>);
static_assert(skybark::draws_volumes<painter, skybark::kernels::probe_volume_draw>);
static_assert(!skybark::maps<painter, skybark::kernels::probe_volume>);
static_assert(!skybark::draws<painter, skybark::kernels::probe_volume_draw>);

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
static_assert(!skybark::volume_backend<skybark::validated<least>>);
static_assert(skybark::sorts<skybark::validated<sorter>>);
static_assert(!skybark::sorts<skybark::validated<half_a_sorter>>);
static_assert(skybark::peels<skybark::validated<gatherer>, skybark::kernels::probe_peel>);
static_assert(!skybark::peels<skybark::validated<least>, skybark::kernels::probe_peel>);
static_assert(skybark::resolves_bundles<skybark::validated<gatherer>>);
static_assert(!skybark::resolves_bundles<skybark::validated<least>>);

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

TEST(archetype, runs_volumes) {
    elsewhere::painter device(0);
    const auto volume = device.create_volume({});
    const auto done = skybark::run(device, [&](auto& r) {
        const skybark::kernels::probe_voxels kernel;
        r.accumulate(skybark::kernels::probe_slabs{}, {}, skybark::range{}, {&*volume, true});
        r.scan(*volume, *volume, skybark::volume_scan{});
        r.map_voxels(kernel, {}, {}, glm::uvec3{1});
    });
    EXPECT_TRUE(done);
    EXPECT_EQ(device.submitted, 3);
}

TEST(archetype, runs_layers_and_bundles) {
    elsewhere::gatherer device(0);
    const auto done = skybark::run(device, [](auto& r) {
        r.peel(skybark::kernels::probe_peel{}, {}, skybark::range{}, {});
        r.resolve(skybark::ray_bundle{}, {});
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
