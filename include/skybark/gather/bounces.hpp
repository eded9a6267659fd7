#pragma once
// bounced_light: the light that surfaces pass on, bounce after bounce, on the device alone.
//
//     auto light = bounced_light<B>::create(device, scene, options);
//     light->light_from(to_sun, irradiance);
//     light->bounce(3);
//     … final_gather over the same scene: sky, emitters, and three bounces …
//
// Radiosity by gathering (Hachisuka 2005, GPU Gems 2, ch. 38: the gathered result is the next
// bounce's radiance). A scene begins with what its materials emit. Each bounce gathers at the
// middle of every patch, from the sky and from what the other patches sent before, and makes of
// that
//
//     L_{k+1} = emission + (diffuse · E + transmission · E of the other side) / π,
//
// so that L_k holds the light of at most k bounces; the first one is direct light: that of the sun,
// the sky and of emitters. In its place a caller may give radiance or irradiance from elsewhere, a
// photon map or a radiosity solution.
//
// The axes of each bounce are turned at random anew, so that their errors don't add up.

#include <skybark/gather/final_gather.hpp>

#include <utility>

namespace skybark::gather {

struct bounce_options {
    std::uint64_t axes = 256; ///< that each bounce gathers along
    final_gather_options gather;
};

template <gathers B>
class bounced_light {
  public:
    /// Bytes of device memory that `create` takes.
    [[nodiscard]] static std::uint64_t required_bytes(const B& device, std::uint64_t patches,
                                                      std::uint64_t triangles,
                                                      const bounce_options& options = {}) {
        return patches * sizeof(glm::vec4) +
               final_gather<B>::required_bytes(device, patches, triangles, options.gather, false);
    }

    /// Of a scene that must stay where it is. Errors as those of final_gather.
    [[nodiscard]] static result<bounced_light> create(B& device, const gather_scene<B>& scene,
                                                      const bounce_options& options = {}) {
        auto gather = final_gather<B>::create(device, scene, scene.patch_samples(), options.gather);
        if (!gather) {
            return failure(gather.error());
        }
        auto irradiance = device.create_buffer(scene.patch_count() * sizeof(glm::vec4));
        if (!irradiance) {
            return failure(irradiance.error());
        }
        return bounced_light(device, scene, options, std::move(*gather), std::move(*irradiance));
    }

    /// A distant source, such as the sun: `irradiance` across its beam, W/m². From the next bounce
    /// on, with all those that were named before. `arriving` may hold, in the y of a vec4 a patch,
    /// the part of the beam that gets to the scene, as in final_gather::record_light_from.
    void light_from(glm::vec3 towards, glm::vec3 irradiance, const buffer_view<B>& arriving = {}) {
        sources_.push_back({towards, irradiance, arriving});
    }
    void forget_sources() { sources_.clear(); }

    /// So many bounces more. Nothing crosses between host and device but what the passes are told.
    [[nodiscard]] result<void> bounce(std::uint32_t count = 1) {
        for (std::uint32_t i = 0; i < count; ++i) {
            auto done = run(*device_, [&](auto& recorder) { record_first(recorder); });
            if (done) {
                done = gather_.add(options_.axes);
            }
            if (done) {
                done = run(*device_, [&](auto& recorder) { record_last(recorder); });
            }
            if (!done) {
                return done;
            }
        }
        return {};
    }

    /// One bounce in a recording of the caller's. Not with gather_method::peel.
    void record(typename B::recorder& recorder) {
        record_first(recorder);
        gather_.record(recorder, options_.axes);
        record_last(recorder);
    }

    /// Back to what the materials emit, and to no bounce.
    [[nodiscard]] result<void> restart() {
        return run(*device_, [&](auto& recorder) { record_restart(recorder); });
    }
    void record_restart(typename B::recorder& recorder) {
        bounces_ = 0;
        gather_.record_restart(recorder, options_.gather.seed);
        record_radiance(recorder);
    }

    /// The first pass is the caller's: the radiance that leaves each patch, W/(m² sr), a vec4 each,
    /// emission included. (On the device: write scene.radiance().)
    [[nodiscard]] result<void> set_radiance(std::span<const glm::vec4> radiance) {
        assert(radiance.size() == scene_->patch_count() && "one vec4 a patch");
        const buffer_view<B> to = scene_->radiance();
        return device_->upload(*to.buffer, to.offset, std::as_bytes(radiance));
    }
    /// … or the irradiance of each patch, W/m², of which its material makes radiance. (On the
    /// device: scene.record_radiance.)
    [[nodiscard]] result<void> set_irradiance(std::span<const glm::vec4> irradiance) {
        assert(irradiance.size() == scene_->patch_count() && "one vec4 a patch");
        if (auto done = device_->upload(irradiance_, 0, std::as_bytes(irradiance)); !done) {
            return done;
        }
        return run(*device_, [&](auto& recorder) {
            scene_->record_radiance(recorder, view<B>(irradiance_));
        });
    }

    /// What leaves each patch now, W/(m² sr): a vec4 each.
    [[nodiscard]] result<void> read_radiance(std::span<glm::vec4> radiance) {
        assert(radiance.size() == scene_->patch_count() && "one vec4 a patch");
        const buffer_view<B> from = scene_->radiance();
        return device_->download(*from.buffer, from.offset, std::as_writable_bytes(radiance));
    }
    /// What arrived at each patch in the last bounce, W/m², and its standard error: a vec4 each.
    [[nodiscard]] buffer_view<B> irradiance() const { return view<B>(irradiance_); }

    [[nodiscard]] std::uint32_t bounces() const noexcept { return bounces_; }
    [[nodiscard]] const bounce_options& options() const noexcept { return options_; }

  private:
    struct source {
        glm::vec3 towards;
        glm::vec3 irradiance;
        buffer_view<B> arriving;
    };

    bounced_light(B& device, const gather_scene<B>& scene, const bounce_options& options,
                  final_gather<B>&& gather, typename B::buffer&& irradiance)
        : device_(&device), scene_(&scene), options_(options), gather_(std::move(gather)),
          irradiance_(std::move(irradiance)) {}

    void record_first(typename B::recorder& recorder) {
        gather_.record_restart(recorder, options_.gather.seed + bounces_);
        for (const source& from : sources_) {
            gather_.record_light_from(recorder, from.towards, from.irradiance, from.arriving);
        }
    }
    void record_last(typename B::recorder& recorder) {
        record_radiance(recorder);
        ++bounces_;
    }
    void record_radiance(typename B::recorder& recorder) {
        gather_.record_irradiance(recorder, view<B>(irradiance_));
        scene_->record_radiance(recorder, view<B>(irradiance_));
    }

    B* device_;
    const gather_scene<B>* scene_;
    bounce_options options_;
    final_gather<B> gather_;
    typename B::buffer irradiance_;
    std::vector<source> sources_;
    std::uint32_t bounces_ = 0;
};

} // namespace skybark::gather
