#pragma once
// meadow<B>: trees, clouds and gathered light in one scene, frame after frame, all on the device.
//
//     auto scene = meadow<B>::create(device, what, {}, {});
//     scene->begin_frame(seconds);
//     run(device, [&](auto& recorder) { scene->record(recorder); });
//     scene->download();                    // or show scene->picture()
//
// A frame has five stages. Each goes by what the ones before it left on the device; nothing waits
// for the host, and nothing crosses but parameters. A frame depends on the weather, the camera and
// the steps of the sway so far, on nothing else.
//
// The members are compiled once for each backend: meadow_cpu.cpp, meadow_opengl.cpp, …

#include <meadow/description.hpp>
#include <skybark/core/backend.hpp>

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace skybark::meadow {

enum class stage {
    sway,   ///< the wind, and where it carries every branch, stem and leaf
    mesh,   ///< their triangles
    clouds, ///< where they have drifted, and the light in them
    light,  ///< gathered from sun, sky, clouds and all that grows
    draw,   ///< the picture
};
inline constexpr std::array stages{stage::sway, stage::mesh, stage::clouds, stage::light,
                                   stage::draw};
inline constexpr std::array<std::string_view, stages.size()> stage_names{"sway", "mesh", "clouds",
                                                                         "light", "draw"};

/// How much there is of everything.
struct contents {
    std::uint64_t trees = 0;
    std::uint64_t segments = 0;        ///< that sway
    std::uint64_t leaves = 0;          ///< and blades of grass
    std::uint64_t particles = 0;       ///< of clouds
    std::uint64_t light_triangles = 0; ///< that light meets
    std::uint64_t light_patches = 0;   ///< and those that pass it on
    std::uint64_t gather_points = 0;   ///< at which it is gathered for the picture
    /// Bytes of device memory, where the device says.
    std::uint64_t stand_bytes = 0; ///< of trees and grass: skeletons, triangles
    std::uint64_t cloud_bytes = 0;
    std::uint64_t light_bytes = 0;
    std::uint64_t picture_bytes = 0;
};

template <backend B>
class meadow {
  public:
    /// Grows everything and sends it to the device. Errors: bad_input with the name and the value
    /// of what cannot be; out_of_memory; those of the device.
    [[nodiscard]] static result<meadow> create(B& device, const description& what,
                                               const weather& now, const camera& from);
    meadow(meadow&&) noexcept;
    meadow& operator=(meadow&&) noexcept;
    ~meadow();

    /// From the next frame on. Another wind is worked out on the host, and sent.
    [[nodiscard]] result<void> change(const weather& now);
    /// From the next frame on. `detail` is 1 for surfaces as exact as a quarter of a pixel, 2 for
    /// half a pixel, and so on.
    void look(const camera& from, float detail = 1);
    /// Bounces of light, from the next frame on: up to the number in the description.
    void bounce(std::uint32_t bounces);

    /// Sways until `seconds`, in steps of `longest_step` at most, and makes nothing else of it.
    [[nodiscard]] result<void> settle(double seconds);
    /// The next `record` is of the frame at `seconds`, which lies beyond the last one by no more
    /// than a few steps: they are all recorded at once. Back in time, or at the same, nothing
    /// sways.
    void begin_frame(double seconds);
    /// Appends a stage of the frame, or all of them. They are to be appended in their order.
    /// Allocates nothing.
    void record(typename B::recorder& to, stage which);
    void record(typename B::recorder& to) {
        for (const stage each : stages) {
            record(to, each);
        }
    }

    /// Makes more room where the last frame's triangles did not fit, as when the camera has come
    /// near: true if it did; the frame is worth recording again, from stage::mesh on. Waits for the
    /// device.
    [[nodiscard]] result<bool> update();

    /// RGBA8, description().width × height, on the device.
    [[nodiscard]] const typename B::image& picture() const;
    /// The same on the host, rows from the top.
    [[nodiscard]] result<std::vector<std::uint8_t>> download() const;

    [[nodiscard]] contents holds() const;
    /// Triangles of the last frame: waits for the device.
    [[nodiscard]] result<std::uint64_t> triangles() const;
    /// The height of the land at a place, m.
    [[nodiscard]] float ground(float x, float z) const;
    [[nodiscard]] double seconds() const;

    static constexpr double longest_step = 1.0 / 60;

  private:
    struct parts;
    explicit meadow(std::unique_ptr<parts> all);

    std::unique_ptr<parts> all_;
};

} // namespace skybark::meadow
