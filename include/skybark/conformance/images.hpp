#pragma once
// Cases: images, and how a fragment reads them. And what the draw cases share.

#include <skybark/conformance/context.hpp>
#include <skybark/kernels/probe_image.hpp>

#include <optional>

namespace skybark::conformance {

/// Pixels on the host, rows from the top.
struct picture {
    image_description what;
    std::vector<glm::vec4> pixels;

    [[nodiscard]] const glm::vec4& at(std::uint32_t x, std::uint32_t y) const {
        return pixels[std::size_t{y} * what.width + x];
    }
};

template <backend B>
[[nodiscard]] typename B::image new_image(const context<B>& c, image_description what) {
    return c.need(c.device.create_image(what), "create_image");
}

/// What is stored for these pixels, and read back as.
[[nodiscard]] inline std::vector<std::byte> bytes_of(const picture& p) {
    const std::size_t each = bytes_per_pixel(p.what.format);
    std::vector<std::byte> bytes(p.pixels.size() * each);
    for (std::size_t i = 0; i < p.pixels.size(); ++i) {
        if (p.what.format != image_format::rgba8) {
            std::memcpy(bytes.data() + i * each, &p.pixels[i], each);
            continue;
        }
        for (int k = 0; k < 4; ++k) {
            bytes[i * 4 + static_cast<std::size_t>(k)] =
                static_cast<std::byte>(std::lround(p.pixels[i][k] * 255));
        }
    }
    return bytes;
}

template <backend B>
[[nodiscard]] picture read_image(const context<B>& c, const typename B::image& image) {
    picture p{image.description(), {}};
    const std::size_t count = std::size_t{p.what.width} * p.what.height;
    const std::size_t each = bytes_per_pixel(p.what.format);
    std::vector<std::byte> bytes(count * each);
    c.need(c.device.download(image, bytes), "download of an image");
    p.pixels.assign(count, {0, 0, 0, 1});
    for (std::size_t i = 0; i < count; ++i) {
        if (p.what.format != image_format::rgba8) {
            std::memcpy(&p.pixels[i], bytes.data() + i * each, each);
            continue;
        }
        for (int k = 0; k < 4; ++k) {
            const auto byte = std::to_integer<int>(bytes[i * 4 + static_cast<std::size_t>(k)]);
            p.pixels[i][k] = static_cast<float>(byte / 255.0);
        }
    }
    return p;
}

/// Random pixels that the format holds exactly.
template <backend B>
[[nodiscard]] picture random_picture(context<B>& c, image_description what) {
    picture p{what, {}};
    for (std::uint32_t i = 0; i < what.width * what.height; ++i) {
        glm::vec4 pixel{0, 0, 0, 1};
        for (int k = 0; k < (what.format == image_format::depth32f ? 1 : 4); ++k) {
            pixel[k] = what.format == image_format::rgba32f
                           ? c.small_number()
                           : static_cast<float>(c.below(256) / 255.0);
        }
        p.pixels.push_back(pixel);
    }
    return p;
}

template <backend B>
[[nodiscard]] typename B::image put_image(const context<B>& c, const picture& p) {
    auto image = new_image(c, p.what);
    c.need(c.device.upload(image, bytes_of(p)), "upload of an image");
    return image;
}

template <backend B>
void image_round_trip(context<B>& c, image_format format) {
    for (const glm::uvec2 size : {glm::uvec2{1, 1}, {3, 5}, {64, 64}, {257, 31}}) {
        const picture p = random_picture(c, {size.x, size.y, format});
        const auto image = put_image(c, p);
        const image_description what = image.description();
        comparison check = c.compare("sides and channels of an image");
        check.same(what.width, size.x);
        check.same(what.height, size.y);
        check.same(static_cast<int>(what.format), static_cast<int>(format));
        const picture back = read_image(c, image);
        for (std::size_t i = 0; i < p.pixels.size(); ++i) {
            check.same(back.pixels[i], p.pixels[i]);
        }
    }
}

/// A vertex at a place of the image: x and y in pixels from the top left.
[[nodiscard]] inline kernels::probe_vertex vertex_at(image_description what, double x, double y,
                                                     double z, glm::vec4 color, double w = 1) {
    const double clip_x = (2 * x / what.width - 1) * w;
    const double clip_y = (1 - 2 * y / what.height) * w;
    return {{static_cast<float>(clip_x), static_cast<float>(clip_y), static_cast<float>(z * w),
             static_cast<float>(w)},
            color};
}

/// Two counter-clockwise triangles over [left, right) × [top, bottom), in pixels.
[[nodiscard]] inline std::vector<kernels::probe_vertex> rectangle(image_description what,
                                                                  double left, double top,
                                                                  double right, double bottom,
                                                                  double z, glm::vec4 color) {
    const auto a = vertex_at(what, left, top, z, color);
    const auto b = vertex_at(what, left, bottom, z, color);
    const auto c = vertex_at(what, right, bottom, z, color);
    const auto d = vertex_at(what, right, top, z, color);
    return {a, b, c, a, c, d};
}

/// Two triangles over the whole image, whose colour runs from (u0, v0) to (u1, v1).
[[nodiscard]] inline std::vector<kernels::probe_vertex> textured(image_description what, double u0,
                                                                 double v0, double u1, double v1) {
    auto all = rectangle(what, 0, 0, what.width, what.height, 0.5, {});
    for (kernels::probe_vertex& v : all) {
        v.color = {static_cast<float>(v.position.x < 0 ? u0 : u1),
                   static_cast<float>(v.position.y > 0 ? v0 : v1), 0, 1};
    }
    return all;
}

/// The whole of an rgba32f image, each pixel by probe_image.
template <backend B>
[[nodiscard]] picture read_by_drawing(const context<B>& c, const kernels::probe_image& kernel,
                                      const sampled_image<B>& first, const sampled_image<B>& second,
                                      image_description what,
                                      const std::vector<kernels::probe_vertex>& corners) {
    const auto vertices = c.put(corners);
    const auto target = new_image(c, what);
    draw_geometry<B> geometry;
    geometry.count = static_cast<std::uint32_t>(corners.size());
    draw_target<B> to;
    to.color = &target;
    to.clear_color = glm::vec4{-1, -1, -1, -1};
    c.run([&](auto& r) {
        r.draw(kernel, {vertices.view()}, {first, second}, geometry, to, draw_state{});
    });
    return read_image(c, target);
}

template <backend B>
void image_fetch(context<B>& c, image_format format, bool second) {
    const picture p = random_picture(c, {40, 24, format});
    const picture q = random_picture(c, {24, 40, image_format::rgba8});
    const auto image = put_image(c, p);
    const auto other = put_image(c, q);
    const sampled_image<B> wanted{&image, filter_mode::linear, wrap_mode::repeat};
    const sampled_image<B> unwanted{&other, filter_mode::linear, wrap_mode::repeat};
    const kernels::probe_image kernel{
        second ? kernels::probe_read::fetch_second : kernels::probe_read::fetch, 5, 3};
    const image_description what{32, 16, image_format::rgba32f};
    const picture seen =
        read_by_drawing(c, kernel, second ? unwanted : wanted, second ? wanted : unwanted, what,
                        textured(what, 0, 0, 1, 1));
    comparison check = c.compare("channels of fetched texels");
    for (std::uint32_t y = 0; y < what.height; ++y) {
        for (std::uint32_t x = 0; x < what.width; ++x) {
            check.close_to(seen.at(x, y), p.at(x + 5, y + 3), 1e-6);
        }
    }
}

template <backend B>
void image_size(context<B>& c) {
    const auto image = new_image(c, {7, 33, image_format::rgba8});
    const auto other = new_image(c, {129, 2, image_format::rgba32f});
    const image_description what{8, 8, image_format::rgba32f};
    const picture seen = read_by_drawing<B>(c, {kernels::probe_read::size, 0, 0}, {&image},
                                            {&other}, what, textured(what, 0, 0, 1, 1));
    comparison check = c.compare("sides of bound images");
    for (const glm::vec4& pixel : seen.pixels) {
        check.same(pixel, {7, 33, 129, 2});
    }
}

/// The texel that a coordinate outside the image falls on.
[[nodiscard]] inline std::uint32_t wrapped(std::int64_t i, std::uint32_t size, wrap_mode wrap) {
    const std::int64_t n = size;
    return static_cast<std::uint32_t>(
        wrap == wrap_mode::clamp ? std::clamp<std::int64_t>(i, 0, n - 1) : (i % n + n) % n);
}

/// What `sample` should give at texture coordinate (u, v); `slack`: how much the value changes
/// within 1/128 texel, by which hardware may round coordinates.
[[nodiscard]] inline glm::dvec4 sampled(const picture& p, double u, double v, filter_mode filter,
                                        wrap_mode wrap) {
    const double x = u * p.what.width;
    const double y = v * p.what.height;
    const auto texel = [&](double i, double j) {
        return glm::dvec4(p.at(wrapped(static_cast<std::int64_t>(i), p.what.width, wrap),
                               wrapped(static_cast<std::int64_t>(j), p.what.height, wrap)));
    };
    if (filter == filter_mode::nearest) {
        return texel(std::floor(x), std::floor(y));
    }
    const double i = std::floor(x - 0.5);
    const double j = std::floor(y - 0.5);
    const double s = x - 0.5 - i;
    const double t = y - 0.5 - j;
    return (texel(i, j) * (1 - s) + texel(i + 1, j) * s) * (1 - t) +
           (texel(i, j + 1) * (1 - s) + texel(i + 1, j + 1) * s) * t;
}

template <backend B>
void image_sample(context<B>& c, image_format format, filter_mode filter, wrap_mode wrap,
                  bool second) {
    // Values in 0…1 only, so that one tolerance fits both formats: filters weigh in 1/256 steps.
    picture p = random_picture(c, {16, 8, image_format::rgba8});
    p.what.format = format;
    const auto image = put_image(c, p);
    const auto other = put_image(c, random_picture(c, {4, 4, image_format::rgba8}));
    const sampled_image<B> wanted{&image, filter, wrap};
    const sampled_image<B> unwanted{
        &other, filter == filter_mode::linear ? filter_mode::nearest : filter_mode::linear,
        wrap == wrap_mode::clamp ? wrap_mode::repeat : wrap_mode::clamp};
    const kernels::probe_image kernel{
        second ? kernels::probe_read::sample_second : kernels::probe_read::sample, 0, 0};
    // Coordinates from -1 to 2, so that all sides are crossed; no pixel on the border of a texel.
    const image_description what{64, 64, image_format::rgba32f};
    const double offset = 1.0 / 512;
    const picture seen =
        read_by_drawing(c, kernel, second ? unwanted : wanted, second ? wanted : unwanted, what,
                        textured(what, -1 + offset, -1 + offset, 2 + offset, 2 + offset));
    const double tolerance = filter == filter_mode::nearest ? 1e-6 : 3.0 / 256;
    comparison check = c.compare("channels of sampled texels");
    for (std::uint32_t y = 0; y < what.height; ++y) {
        for (std::uint32_t x = 0; x < what.width; ++x) {
            const double u = -1 + offset + 3 * (x + 0.5) / what.width;
            const double v = -1 + offset + 3 * (y + 0.5) / what.height;
            const glm::dvec4 expected = sampled(p, u, v, filter, wrap);
            for (int k = 0; k < 4; ++k) {
                check.close_to(double{seen.at(x, y)[k]}, expected[k], tolerance);
            }
        }
    }
}

template <backend B>
void add_image_cases(cases<B>& to) {
    using C = context<B>;
    const auto add = [&](std::string name, std::function<void(C&)> body) {
        to.push_back({"images", std::move(name), std::move(body)});
    };
    const std::pair<const char*, image_format> formats[] = {{"rgba8", image_format::rgba8},
                                                            {"rgba32f", image_format::rgba32f},
                                                            {"depth32f", image_format::depth32f}};
    for (const auto& [name, format] : formats) {
        add(std::string("round_trip_") + name,
            [format = format](C& c) { image_round_trip(c, format); });
    }
    if constexpr (draws<B, kernels::probe_image>) {
        for (const auto& [name, format] : formats) {
            add(std::string("fetch_") + name,
                [format = format](C& c) { image_fetch(c, format, false); });
        }
        add("fetch_second", [](C& c) { image_fetch(c, image_format::rgba32f, true); });
        add("size", image_size<B>);
        for (const auto& [name, format] : {formats[0], formats[1]}) {
            for (const filter_mode filter : {filter_mode::nearest, filter_mode::linear}) {
                for (const wrap_mode wrap : {wrap_mode::clamp, wrap_mode::repeat}) {
                    add(std::string("sample_") + name +
                            (filter == filter_mode::nearest ? "_nearest" : "_linear") +
                            (wrap == wrap_mode::clamp ? "_clamp" : "_repeat"),
                        [format = format, filter, wrap](C& c) {
                            image_sample(c, format, filter, wrap, false);
                        });
                }
            }
        }
        add("sample_second", [](C& c) {
            image_sample(c, image_format::rgba8, filter_mode::nearest, wrap_mode::repeat, true);
        });
    }
}

} // namespace skybark::conformance
