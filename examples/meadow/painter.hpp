#pragma once
// painter: draws a meadow in the sun, under clouds, in gathered light: picture after picture, into
// images that it makes once.
//
//     auto paint = painter<B>::create(device, what, materials, land.vertices, land.indices);
//     auto scene = scene_for(from, land.height(from.eye.x, from.eye.z), now, aspect, box);
//     kernels::surroundings_record around = …;
//     run(device, [&](auto& recorder) {
//         paint->record(recorder, scene, around, drawables, light,
//                       [&](auto& to, const buffer_view<B>& scene, const draw_target<B>& target) {
//                           … clouds, behind what has been drawn …
//                       });
//     });
//     paint->download(device); // or show paint->picture()

#include <meadow/description.hpp>
#include <meadow/drawable.hpp>
#include <picture/cloud_picture.hpp>
#include <picture/daylight.hpp>
#include <skybark/kernels/cast_leaf_shadow.hpp>
#include <skybark/kernels/cast_shadow.hpp>
#include <skybark/kernels/clear_sky.hpp>
#include <skybark/kernels/develop.hpp>
#include <skybark/kernels/meadow_bark.hpp>
#include <skybark/kernels/meadow_land.hpp>
#include <skybark/kernels/meadow_leaf.hpp>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>

namespace skybark::meadow {

inline constexpr std::uint32_t shadow_texels = 4096;
inline constexpr float nearest_seen = 0.3f; ///< m
inline constexpr float farthest_seen = 60000;

/// A box along the axes that all that casts shadows on the land lies in, m.
struct shadow_box {
    glm::vec3 low{0};
    glm::vec3 high{1};
};

/// Extinction of the air near the ground by its turbidity, 1/m. Turbidity is the optical thickness
/// of all over that of the molecules (Preetham, Shirley and Smits 1999, section 2). They have
/// 1.2e-5 per metre; haze and molecules thin out by e in 1/0.8333 and 1/0.1136 km (appendix A.3).
[[nodiscard]] constexpr float extinction_of_air(double turbidity) {
    constexpr double molecules = 1.2e-5;
    return static_cast<float>(molecules * (1 + (turbidity - 1) * (0.8333 / 0.1136)));
}

/// Points `scene.to_shadow` from the sun to a box. Texels are as small as the box allows, and stay
/// where they are in the world: the map begins at a whole texel. (Its sides are 1/64 longer than
/// what they hold, so that it can.)
inline void fit_shadow(kernels::scene_record& scene, const shadow_box& box) {
    const glm::dvec3 to_sun(scene.sky.to_sun);
    const bool overhead = std::abs(to_sun.y) > 0.999;
    const glm::dmat4 turn =
        glm::lookAtRH(glm::dvec3(0), -to_sun, overhead ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0));
    glm::dvec3 low(1e30);
    glm::dvec3 high(-1e30);
    for (unsigned corner = 0; corner < 8; ++corner) {
        const glm::dvec3 at((corner & 1) != 0 ? box.high.x : box.low.x,
                            (corner & 2) != 0 ? box.high.y : box.low.y,
                            (corner & 4) != 0 ? box.high.z : box.low.z);
        const glm::dvec3 seen(turn * glm::dvec4(at, 1));
        low = glm::min(low, seen);
        high = glm::max(high, seen);
    }
    const glm::dvec3 size = glm::max(high - low, glm::dvec3(0.01));
    const glm::dvec2 side = glm::dvec2(size) * (1.0 + 1.0 / 64);
    const glm::dvec2 texel = side / double{shadow_texels};
    const glm::dvec2 middle = glm::dvec2(low + high) * 0.5;
    const glm::dvec2 first = glm::floor((middle - side * 0.5) / texel) * texel;
    scene.to_shadow =
        glm::mat4(glm::orthoRH_ZO(first.x, first.x + side.x, first.y, first.y + side.y,
                                  -high.z - 0.01 * size.z, -low.z + 0.01 * size.z) *
                  turn);
    scene.shadow = {static_cast<float>(std::max(texel.x, texel.y)), 1.0f / shadow_texels, 1.5f, 0};
}

/// The camera and the light of a picture `aspect` times as wide as high. `ground` is the height of
/// the land under the camera, m; `box` holds all that casts shadows; the land that lights things
/// from below has `land_albedo`.
[[nodiscard]] inline kernels::scene_record
scene_for(const camera& from, float ground, const weather& now, float aspect, const shadow_box& box,
          glm::vec3 land_albedo = glm::vec3(0.11f, 0.12f, 0.045f)) {
    kernels::scene_record scene{};
    const glm::vec3 eye = from.eye + glm::vec3(0, ground, 0);
    const glm::vec3 ahead = glm::normalize(from.target - eye);
    const glm::vec3 above = std::abs(ahead.y) > 0.999f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
    scene.to_clip = glm::perspectiveRH_ZO(from.field, aspect, nearest_seen, farthest_seen) *
                    glm::lookAtRH(eye, eye + ahead, above);
    scene.from_clip = glm::inverse(scene.to_clip);
    scene.camera = glm::vec4(eye, 0);
    scene.sky = picture::daylight(picture::direction_to_sun(now.sun_azimuth, now.sun_elevation),
                                  now.turbidity);
    picture::set_ambient(scene, land_albedo);
    fit_shadow(scene, box);
    return scene;
}

/// Light that has been made for a picture. Where the surroundings say that no clouds' shadow falls,
/// `clouds` may be absent.
template <volume_backend B>
struct light_sources {
    const typename B::volume* clouds = nullptr;   ///< attenuation of the sun
    const typename B::volume* gathered = nullptr; ///< an irradiance volume
    buffer_view<B> land; ///< a vec4 for each number that the land's vertices have: irradiance
};

template <volume_backend B>
class painter {
  public:
    /// The land's `u` are numbers of irradiances (light_sources::land). Errors: bad_input where a
    /// material's texels are not as many as its size says; those of the device.
    [[nodiscard]] static result<painter> create(B& device, const description& what,
                                                std::span<const material> materials,
                                                std::span<const surface_vertex> land_vertices,
                                                std::span<const std::uint32_t> land_indices) {
        painter made(what);
        const std::uint32_t samples = made.samples();
        const std::uint32_t width = what.width * samples;
        const std::uint32_t height = what.height * samples;
        const image_description wanted[] = {{width, height, image_format::rgba32f},
                                            {width, height, image_format::depth32f},
                                            {shadow_texels, shadow_texels, image_format::depth32f},
                                            {what.width, what.height, image_format::rgba8}};
        for (const image_description& one : wanted) {
            auto image = device.create_image(one);
            if (!image) {
                return failure(image.error());
            }
            made.images_.push_back(std::move(*image));
        }
        for (const material& one : materials) {
            if (auto done = made.add_material(device, one); !done) {
                return failure(done.error());
            }
        }
        if (auto done = made.add_buffers(device, land_vertices, land_indices); !done) {
            return failure(done.error());
        }
        return made;
    }

    /// Appends the drawing of a picture: the shadow map, then `stand` and the land, the clear sky
    /// behind them, clouds, and all of it developed. `draw_clouds(recorder, scene, target)` is
    /// given a view of the scene_record, and the picture so far with its depths, which are to be
    /// tested and not written. What is nearer had better come first in `stand`. Allocates nothing.
    template <class DrawClouds>
    void record(typename B::recorder& to, const kernels::scene_record& scene,
                const kernels::surroundings_record& around, std::span<const drawable<B>> stand,
                const light_sources<B>& light, DrawClouds&& draw_clouds) const {
        to.upload(view<B>(buffers_[scene_buffer]), std::as_bytes(std::span(&scene, 1)));
        to.upload(view<B>(buffers_[around_buffer]), std::as_bytes(std::span(&around, 1)));
        cast_shadows(to, stand);
        draw_target<B> picture{&images_[0], &images_[1], glm::vec4(0), 1.0f};
        for (const look each : {look::bark, look::leaf}) {
            for (const drawable<B>& one : stand) {
                if (one.as == each) {
                    draw_surface(to, one, light, picture);
                    picture = so_far();
                }
            }
        }
        draw_land(to, light, picture);
        draw_geometry<B> screen;
        screen.count = 3;
        to.draw(kernels::clear_sky{}, {view<B>(buffers_[scene_buffer])}, {}, screen, so_far(),
                draw_state{});
        draw_clouds(to, view<B>(buffers_[scene_buffer]), so_far());
        to.draw(kernels::develop{samples(), picture::exposure_for(scene)}, {},
                {sampled_image<B>{&images_[0], filter_mode::nearest, wrap_mode::clamp}}, screen,
                draw_target<B>{&images_[3], nullptr, {}, {}}, draw_state{false, false});
    }

    /// RGBA8, width × height, rows from the top.
    [[nodiscard]] const typename B::image& picture() const { return images_[3]; }
    /// The scene-referred samples it was developed from: RGBA32F, kcd/m².
    [[nodiscard]] const typename B::image& radiance() const { return images_[0]; }

    /// The picture on the host.
    [[nodiscard]] result<std::vector<std::uint8_t>> download(B& device) const {
        std::vector<std::uint8_t> pixels(std::size_t{4} * what_.width * what_.height);
        if (auto done = device.download(picture(), std::as_writable_bytes(std::span(pixels)));
            !done) {
            return failure(done.error());
        }
        return pixels;
    }

    [[nodiscard]] std::uint32_t samples() const { return std::max(1u, what_.supersampling); }

  private:
    /// A material's numbers; its image has the same place in `pictures_`.
    struct surface {
        kernels::meadow_bark bark;
        kernels::meadow_leaf leaf;
    };
    enum buffer_place { scene_buffer, around_buffer, land_buffer, land_index_buffer };

    explicit painter(const description& what) : what_(what) {}

    [[nodiscard]] result<void> add_material(B& device, const material& from) {
        // Flat bark; a leaf of a green that covers all.
        const std::array<std::uint8_t, 4> plain =
            from.as == look::bark ? std::array<std::uint8_t, 4>{128, 128, 255, 128}
                                  : std::array<std::uint8_t, 4>{90, 130, 60, 255};
        std::span<const std::uint8_t> texels = from.texels;
        image_description size{from.width, from.height, image_format::rgba8};
        if (texels.empty()) {
            texels = plain;
            size.width = size.height = 1;
        } else if (texels.size() != std::size_t{4} * from.width * from.height) {
            return fail(error_code::bad_input, std::string("A material of ")
                                                   .append(std::to_string(from.width))
                                                   .append(" x ")
                                                   .append(std::to_string(from.height))
                                                   .append(" texels has ")
                                                   .append(std::to_string(texels.size()))
                                                   .append(" bytes; expected four a texel."));
        }
        auto image = device.create_image(size);
        if (!image) {
            return failure(image.error());
        }
        if (auto done = device.upload(*image, std::as_bytes(texels)); !done) {
            return failure(done.error());
        }
        pictures_.push_back(std::move(*image));
        const kernels::meadow_bark bark{glm::vec4(from.low, 0), glm::vec4(from.high, 0),
                                        from.around, from.along, 1};
        materials_.push_back({bark, kernels::meadow_leaf{from.through}});
        return {};
    }

    [[nodiscard]] result<void> add_buffers(B& device, std::span<const surface_vertex> vertices,
                                           std::span<const std::uint32_t> indices) {
        auto scene = device.create_buffer(sizeof(kernels::scene_record));
        auto around = device.create_buffer(sizeof(kernels::surroundings_record));
        auto land = make_buffer<B, surface_vertex>(device, vertices);
        auto land_indices = make_buffer<B, std::uint32_t>(device, indices);
        for (auto* made : {&scene, &around, &land, &land_indices}) {
            if (!*made) {
                return failure(made->error());
            }
            buffers_.push_back(std::move(**made));
        }
        land_count_ = static_cast<std::uint32_t>(indices.size());
        return {};
    }

    [[nodiscard]] draw_target<B> so_far() const { return {&images_[0], &images_[1], {}, {}}; }
    [[nodiscard]] sampled_image<B> shadow_map() const {
        return {&images_[2], filter_mode::nearest, wrap_mode::clamp};
    }
    [[nodiscard]] sampled_image<B> picture_of(const drawable<B>& one) const {
        return {&pictures_[one.material], filter_mode::linear,
                one.as == look::bark ? wrap_mode::repeat : wrap_mode::clamp};
    }

    void cast_shadows(typename B::recorder& to, std::span<const drawable<B>> stand) const {
        const buffer_view<B> scene = view<B>(buffers_[scene_buffer]);
        draw_target<B> from_sun{nullptr, &images_[2], {}, 1.0f};
        if (std::none_of(stand.begin(), stand.end(), [](const auto& d) { return d.casts; })) {
            to.draw(kernels::cast_shadow{}, {view<B>(buffers_[land_buffer]), scene}, {},
                    draw_geometry<B>{}, from_sun, draw_state{});
        }
        for (const drawable<B>& one : stand) {
            if (!one.casts) {
                continue;
            }
            if (one.as == look::leaf) {
                to.draw(kernels::cast_leaf_shadow{}, {one.vertices, scene}, {picture_of(one)},
                        one.geometry, from_sun, draw_state{});
            } else {
                to.draw(kernels::cast_shadow{}, {one.vertices, scene}, {}, one.geometry, from_sun,
                        draw_state{});
            }
            from_sun.clear_depth.reset();
        }
    }

    void draw_surface(typename B::recorder& to, const drawable<B>& one,
                      const light_sources<B>& light, const draw_target<B>& picture) const {
        const surface& its = materials_[one.material];
        const buffer_view<B> scene = view<B>(buffers_[scene_buffer]);
        const buffer_view<B> around = view<B>(buffers_[around_buffer]);
        const auto* clouds = light.clouds != nullptr ? light.clouds : light.gathered;
        if (one.as == look::leaf) {
            volume_bindings<B, kernels::meadow_leaf> volumes;
            volumes.read = {clouds, light.gathered};
            to.draw(its.leaf, {one.vertices, scene, around}, {shadow_map(), picture_of(one)},
                    volumes, one.geometry, picture, draw_state{});
        } else {
            volume_bindings<B, kernels::meadow_bark> volumes;
            volumes.read = {clouds, light.gathered};
            to.draw(its.bark, {one.vertices, scene, around}, {shadow_map(), picture_of(one)},
                    volumes, one.geometry, picture, draw_state{});
        }
    }

    void draw_land(typename B::recorder& to, const light_sources<B>& light,
                   const draw_target<B>& picture) const {
        volume_bindings<B, kernels::meadow_land> volumes;
        volumes.read = {light.clouds != nullptr ? light.clouds : light.gathered};
        draw_geometry<B> all;
        all.indices = view<B>(buffers_[land_index_buffer]);
        all.count = land_count_;
        to.draw(kernels::meadow_land{},
                {view<B>(buffers_[land_buffer]), view<B>(buffers_[scene_buffer]),
                 view<B>(buffers_[around_buffer]), light.land},
                {shadow_map()}, volumes, all, picture, draw_state{});
    }

    description what_;
    std::vector<surface> materials_;
    std::vector<typename B::image> pictures_; // of the materials
    std::vector<typename B::image> images_;   // samples, their depth, the shadow map, the picture
    std::vector<typename B::buffer> buffers_;
    std::uint32_t land_count_ = 0;
};

} // namespace skybark::meadow
