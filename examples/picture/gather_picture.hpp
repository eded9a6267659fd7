#pragma once
// A picture of gathered light: what each pixel sees asks for light itself, so that nothing lies
// between the light and the picture: no vertices, no texels.
//
//     auto places = picture::see(device, triangles, alpha, on_host, materials, view);
//     … irradiance at places->samples, by any means …
//     auto light = picture::radiance_seen(*places, irradiance, on_host, materials, view, sky);
//     auto pixels = picture::develop(device, light, view, exposure); // for write_png

#include <skybark/core/backend.hpp>
#include <skybark/kernels/develop.hpp>
#include <skybark/kernels/seen_surface.hpp>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <vector>

namespace skybark::picture {

/// From where, and how finely.
struct gather_view {
    glm::vec3 eye{0, 0, 1};
    glm::vec3 target{0};
    float field_of_view = 40; ///< degrees, vertical
    float nearest = 0.01f;    ///< m; what is nearer is not seen
    std::uint32_t width = 960;
    std::uint32_t height = 540;
    std::uint32_t supersampling = 2; ///< places a pixel in each direction

    [[nodiscard]] std::uint32_t columns() const { return width * std::max(1u, supersampling); }
    [[nodiscard]] std::uint32_t rows() const { return height * std::max(1u, supersampling); }
};

/// A view of all that lies between `low` and `high`, from the south and above.
[[nodiscard]] inline gather_view view_around(glm::vec3 low, glm::vec3 high, std::uint32_t width,
                                             std::uint32_t height) {
    gather_view view;
    view.width = width;
    view.height = height;
    const glm::vec3 half = 0.5f * (high - low);
    const float radius = std::max(glm::length(half), 1e-6f);
    const float aspect = static_cast<float>(width) / static_cast<float>(std::max(1u, height));
    const float half_field = std::tan(glm::radians(0.5f * view.field_of_view));
    const float distance = radius / std::sin(std::atan(half_field * std::min(1.0f, aspect)));
    view.target = 0.5f * (low + high);
    view.eye = view.target + distance * glm::normalize(glm::vec3(0.25f, 0.45f, 1.0f));
    view.nearest = 0.01f * distance;
    return view;
}

[[nodiscard]] inline glm::mat4 to_clip(const gather_view& view) {
    const glm::vec3 ahead = glm::normalize(view.target - view.eye);
    const glm::vec3 above = std::abs(ahead.y) > 0.999f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
    const float aspect = static_cast<float>(view.width) / static_cast<float>(view.height);
    return glm::perspectiveRH_ZO(glm::radians(view.field_of_view), aspect, view.nearest,
                                 100000 * view.nearest) *
           glm::lookAtRH(view.eye, view.target, above);
}

inline constexpr std::uint32_t no_sample = 0xffffffffu;

/// The places that a picture sees. Pixels have `supersampling`² of them, row after row from the
/// top.
struct seen_places {
    struct place {
        std::uint32_t surface = no_surface; ///< 2 · triangle, + 1 where its back is seen
        std::uint32_t here = no_sample;     ///< which sample has the light on the side that is seen
        std::uint32_t behind = no_sample;   ///< … and on the other, where light comes through
    };
    std::vector<place> places;
    std::vector<gather_sample> samples;
};

namespace detail {

[[nodiscard]] inline std::uint32_t surface_of(glm::vec4 seen) {
    return 4096 * static_cast<std::uint32_t>(seen.w) + static_cast<std::uint32_t>(seen.z);
}

/// The middle of the surface that `seen` says, its normal on the side that is seen.
[[nodiscard]] inline gather_sample sample_of(glm::vec4 seen, const gather_triangle& t, bool back) {
    gather_sample made;
    made.position = t.a + seen.x * (t.b - t.a) + seen.y * (t.c - t.a);
    const glm::vec3 across = glm::cross(t.b - t.a, t.c - t.a);
    const float size = glm::length(across);
    made.normal = size > 0 ? across * ((back ? -1.0f : 1.0f) / size) : glm::vec3(0);
    return made;
}

} // namespace detail

/// Draws once, to find what a picture of these triangles sees. `alpha` as for a bundle; it may be
/// empty where no triangle has holes. `on_host` are the same triangles. Backs of materials with one
/// side are black and ask for nothing.
template <backend B>
[[nodiscard]] result<seen_places> see(B& device, buffer_view<B> triangles, buffer_view<B> alpha,
                                      std::span<const gather_triangle> on_host,
                                      std::span<const gather_material> materials,
                                      const gather_view& view) {
    const image_description size{view.columns(), view.rows(), image_format::rgba32f};
    auto seen = device.create_image(size);
    if (!seen) {
        return failure(seen.error());
    }
    auto depth = device.create_image({size.width, size.height, image_format::depth32f});
    if (!depth) {
        return failure(depth.error());
    }
    auto empty = device.create_buffer(sizeof(alpha_coordinates));
    if (!empty) {
        return failure(empty.error());
    }
    const glm::mat4 rows = glm::transpose(to_clip(view));
    const auto drawn = run(device, [&](typename B::recorder& r) {
        draw_geometry<B> all;
        all.count = static_cast<std::uint32_t>(3 * on_host.size());
        r.draw(kernels::seen_surface{rows[0], rows[1], rows[2], rows[3]},
               {triangles, alpha ? alpha : skybark::view<B>(*empty)}, {}, all,
               draw_target<B>{&*seen, &*depth, glm::vec4(0, 0, 0, -1), 1.0f}, draw_state{});
    });
    if (!drawn) {
        return failure(drawn.error());
    }
    std::vector<glm::vec4> texels(std::size_t{size.width} * size.height);
    if (auto done = device.download(*seen, std::as_writable_bytes(std::span(texels))); !done) {
        return failure(done.error());
    }
    seen_places found;
    found.places.resize(texels.size());
    for (std::size_t i = 0; i < texels.size(); ++i) {
        if (!(texels[i].w >= 0)) {
            continue;
        }
        seen_places::place& place = found.places[i];
        place.surface = detail::surface_of(texels[i]);
        const gather_triangle& t = on_host[place.surface / 2];
        const gather_material& material = materials[t.material];
        const bool back = place.surface % 2 == 1;
        if (back && material.two_sided == 0) {
            continue;
        }
        gather_sample here = detail::sample_of(texels[i], t, back);
        place.here = static_cast<std::uint32_t>(found.samples.size());
        found.samples.push_back(here);
        if (material.two_sided != 0 && material.transmission != glm::vec3(0)) {
            place.behind = static_cast<std::uint32_t>(found.samples.size());
            here.normal = -here.normal;
            found.samples.push_back(here);
        }
    }
    return found;
}

/// The radiance that each place sends to the eye, from the irradiance at its samples (rgb);
/// `sky(direction)` where nothing is seen.
template <class Sky>
[[nodiscard]] std::vector<glm::vec4>
radiance_seen(const seen_places& of, std::span<const glm::vec4> irradiance,
              std::span<const gather_triangle> triangles,
              std::span<const gather_material> materials, const gather_view& view, Sky&& sky) {
    const glm::mat4 from_clip = glm::inverse(to_clip(view));
    const auto light = [&](std::uint32_t sample) {
        return sample == no_sample ? glm::vec3(0) : glm::vec3(irradiance[sample]);
    };
    std::vector<glm::vec4> out(of.places.size(), glm::vec4(0));
    for (std::size_t i = 0; i < out.size(); ++i) {
        const seen_places::place& place = of.places[i];
        if (place.surface == no_surface) {
            const auto column = static_cast<float>(i % view.columns()) + 0.5f;
            const auto row = static_cast<float>(i / view.columns()) + 0.5f;
            const glm::vec4 far =
                from_clip * glm::vec4(2 * column / static_cast<float>(view.columns()) - 1,
                                      1 - 2 * row / static_cast<float>(view.rows()), 1, 1);
            out[i] = glm::vec4(sky(glm::normalize(glm::vec3(far) / far.w - view.eye)), 1);
        } else if (place.here != no_sample) {
            const gather_material& m = materials[triangles[place.surface / 2].material];
            const glm::vec3 scattered =
                m.diffuse * light(place.here) + m.transmission * light(place.behind);
            out[i] = glm::vec4(m.emission + scattered * 0.318309886f, 1);
        }
    }
    return out;
}

/// Pixels for a display, RGBA8 rows from the top, of one radiance a place.
template <backend B>
[[nodiscard]] result<std::vector<std::uint8_t>>
develop(B& device, std::span<const glm::vec4> radiance, const gather_view& view, float exposure) {
    auto from = device.create_image({view.columns(), view.rows(), image_format::rgba32f});
    if (!from) {
        return failure(from.error());
    }
    auto to = device.create_image({view.width, view.height, image_format::rgba8});
    if (!to) {
        return failure(to.error());
    }
    if (auto done = device.upload(*from, std::as_bytes(radiance)); !done) {
        return failure(done.error());
    }
    const auto drawn = run(device, [&](typename B::recorder& r) {
        draw_geometry<B> screen;
        screen.count = 3;
        r.draw(kernels::develop{std::max(1u, view.supersampling), exposure}, {},
               {sampled_image<B>{&*from, filter_mode::nearest, wrap_mode::clamp}}, screen,
               draw_target<B>{&*to, nullptr, {}, {}}, draw_state{false, false});
    });
    if (!drawn) {
        return failure(drawn.error());
    }
    std::vector<std::uint8_t> pixels(std::size_t{4} * view.width * view.height);
    if (auto done = device.download(*to, std::as_writable_bytes(std::span(pixels))); !done) {
        return failure(done.error());
    }
    return pixels;
}

} // namespace skybark::picture
