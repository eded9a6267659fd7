#pragma once
// Cases: kernels that read and write volumes: maps over records, maps over voxels, draws.
//
// How exact a sample is: devices make the weight of a neighbour in steps of 2^-8 (Vulkan's
// subTexelPrecisionBits, of which D3D asks for 8), so that along each of three axes up to 2^-8 of
// the difference of two neighbours is lost: 3 · 2^-8 of the largest difference of eight. Places
// on sixteenths between the centres of voxels have weights in steps of 2^-4, which any device has
// exactly; there, 2^-10 of the largest value is for a filter that computes in 16 bits.

#include <skybark/conformance/images.hpp>
#include <skybark/conformance/volume_scans.hpp>
#include <skybark/kernels/probe_volume.hpp>
#include <skybark/kernels/probe_volume_draw.hpp>
#include <skybark/kernels/probe_voxels.hpp>

#include <array>

namespace skybark::conformance {

/// A volume that a kernel reads, and its numbers, which its format holds exactly.
template <volume_backend B>
struct grid_probe {
    glm::ivec3 size;
    volume_format format;
    std::vector<double> numbers;
    typename B::volume volume;

    [[nodiscard]] double at(glm::ivec3 voxel) const { return numbers[voxel_index(voxel, size)]; }
};

/// Whole numbers from −1000 to 1000.
template <volume_backend B>
[[nodiscard]] grid_probe<B> random_grid(context<B>& c, glm::ivec3 size, volume_format format) {
    std::vector<double> numbers(voxels_of(size));
    std::vector<float> floats;
    std::vector<std::uint16_t> halves;
    for (double& number : numbers) {
        number = double{c.small_number()};
        floats.push_back(static_cast<float>(number));
        halves.push_back(nearest_float16(number));
    }
    auto volume = format == volume_format::float16 ? put_volume(c, size, format, halves)
                                                   : put_volume(c, size, format, floats);
    return {size, format, std::move(numbers), std::move(volume)};
}

/// Whether a device's `sample` is trilinear on the format.
template <backend B>
[[nodiscard]] bool is_filtered(const B& device, volume_format format) {
    return format == volume_format::float16 || device.limits().filters_float32;
}

/// The trilinear value at a place, 0…1 from edge to edge, and the interval that a device may give.
struct sample_bounds {
    double low;
    double high;
};
template <volume_backend B>
[[nodiscard]] sample_bounds expected_sample(const grid_probe<B>& grid, const glm::dvec3& place,
                                            bool on_sixteenths) {
    double sum = 0;
    double low = 1e30;
    double high = -1e30;
    for (int corner = 0; corner < 8; ++corner) {
        glm::ivec3 voxel;
        double share = 1;
        for (int k = 0; k < 3; ++k) {
            const double at = place[k] * grid.size[k] - 0.5;
            const bool upper = (corner >> k & 1) != 0;
            const double t = at - std::floor(at);
            share *= upper ? t : 1 - t;
            voxel[k] =
                std::clamp(static_cast<int>(std::floor(at)) + (upper ? 1 : 0), 0, grid.size[k] - 1);
        }
        sum += share * grid.at(voxel);
        low = std::min(low, grid.at(voxel));
        high = std::max(high, grid.at(voxel));
    }
    const double tolerance = (on_sixteenths ? 0 : 3 * 0x1p-8 * (high - low)) +
                             0x1p-10 * std::max(std::fabs(low), std::fabs(high));
    return {sum - tolerance, sum + tolerance};
}

/// Places of a volume with sides of powers of two: on sixteenths from the middle of a voxel, also
/// beyond the edges, or anywhere.
template <backend B>
[[nodiscard]] glm::vec3 random_place(context<B>& c, glm::ivec3 size, bool on_sixteenths) {
    glm::vec3 place;
    for (int k = 0; k < 3; ++k) {
        const auto side = static_cast<std::uint32_t>(size[k]);
        if (on_sixteenths) { // from −1 to side + 1 voxels
            const std::uint32_t sixteenths = c.below(16 * (side + 2) + 1);
            place[k] = (static_cast<float>(sixteenths) / 16.0f - 1.0f) / static_cast<float>(side);
        } else {
            place[k] = static_cast<float>(c.below(1 << 20)) * 0x1.8p-20f - 0.25f;
        }
    }
    return place;
}

/// Records look into two volumes and write to cells of a third one.
template <volume_backend B>
void map_grids(context<B>& c, std::uint32_t count, volume_format format, bool on_sixteenths) {
    const auto a = random_grid(c, {8, 4, 16}, format);
    const auto b = random_grid(c, {4, 8, 32}, volume_format::float16);
    const glm::ivec3 size{9, 7, 33};
    const std::vector<float> kept(voxels_of(size), -7.0f);
    const auto target = put_volume(c, size, volume_format::float32, kept);
    std::vector<kernels::probe_place> places(count);
    std::vector<double> expected(kept.begin(), kept.end());
    constexpr float first_number = 1000;
    const range part = count < 10 ? range{0, count} : range{4, count - 7};
    for (std::uint32_t i = 0; i < count; ++i) {
        places[i].place = {random_place(c, a.size, on_sixteenths), 0};
        const auto cell = static_cast<int>(i % 512); // each at most once
        places[i].cell = {cell % 4, cell / 4 % 4, cell / 16 % 16, i % 3 == 0 && i < 256 ? 1 : 0};
        if (places[i].cell.w != 0 && i - part.first < part.count) {
            expected[voxel_index(glm::ivec3(places[i].cell), size)] = double{first_number} + i;
        }
    }
    const auto places_in = c.put(places);
    const auto values = c.template room<glm::vec4>(count);
    const auto sizes = c.template room<glm::ivec4>(count);
    c.run([&](auto& r) {
        r.map(kernels::probe_volume{first_number}, {places_in.view(), values.view(), sizes.view()},
              volume_bindings<B, kernels::probe_volume>{{&a.volume, &b.volume}, {&target}}, part);
    });
    const auto actual = c.template get<glm::vec4>(values);
    const auto actual_sizes = c.template get<glm::ivec4>(sizes);
    comparison sample_check = c.compare("samples");
    comparison load_check = c.compare("loaded voxels");
    comparison size_check = c.compare("sides of volumes");
    comparison untouched = c.compare("values outside the range");
    for (std::uint32_t i = 0; i < count; ++i) {
        if (i - part.first >= part.count) {
            std::uint32_t bits = 0;
            std::memcpy(&bits, &actual[i], sizeof bits);
            untouched.same(bits, 0xa5a5a5a5u);
            continue;
        }
        const glm::ivec3 cell(places[i].cell);
        const glm::dvec3 place(places[i].place);
        if (is_filtered(c.device, format)) {
            const sample_bounds in_a = expected_sample(a, place, on_sixteenths);
            sample_check.within(actual[i].x, in_a.low, in_a.high);
        }
        // b's sides are others: what are sixteenths in a are eighths or thirty-seconds in it.
        const sample_bounds in_b = expected_sample(b, place, false);
        sample_check.within(actual[i].y, in_b.low, in_b.high);
        load_check.same(actual[i].z, a.at(cell));
        load_check.same(actual[i].w, b.at(cell));
        for (int k = 0; k < 3; ++k) {
            size_check.same(actual_sizes[i][k], (i % 2 == 0 ? a.size : b.size)[k]);
        }
    }
    const auto written = get_numbers(c, target);
    comparison target_check = c.compare("voxels of the target");
    for (std::size_t i = 0; i < expected.size(); ++i) {
        target_check.same(written[i], expected[i]);
    }
}

/// Cells of one recorder's maps: the second reads what the first wrote; another recorder's work
/// lies between them.
template <volume_backend B>
void map_grids_twice(context<B>& c) {
    const glm::ivec3 size{4, 4, 4};
    const auto other = random_grid(c, size, volume_format::float16);
    std::vector<kernels::probe_place> places(64);
    for (int i = 0; i < 64; ++i) {
        places[static_cast<std::size_t>(i)].cell = {i % 4, i / 4 % 4, i / 16, 1};
    }
    const auto places_in = c.put(places);
    const auto zeros = std::vector<float>(64);
    const auto middle = put_volume(c, size, volume_format::float32, zeros);
    const auto last = put_volume(c, size, volume_format::float32, zeros);
    const auto apart = put_volume(c, size, volume_format::float32, zeros);
    const auto values = c.template room<glm::vec4>(64);
    const auto unused = c.template room<glm::vec4>(64);
    const auto sizes = c.template room<glm::ivec4>(64);
    using bound = volume_bindings<B, kernels::probe_volume>;
    const auto map = [&](auto& r, float first, const auto& from, const auto& to,
                         const guarded<B>& into_values) {
        r.map(kernels::probe_volume{first}, {places_in.view(), into_values.view(), sizes.view()},
              bound{{&from, &other.volume}, {&to}}, range{0, 64});
    };
    auto first = c.begin();
    auto second = c.begin();
    map(first, 100, last, middle, unused);
    map(second, 500, other.volume, apart, unused);
    map(first, 300, middle, last, values);
    c.submit(second);
    c.submit(first);
    const auto actual = c.template get<glm::vec4>(values);
    const auto in_last = get_numbers(c, last);
    const auto in_apart = get_numbers(c, apart);
    comparison check = c.compare("numbers written and loaded again");
    for (std::uint32_t i = 0; i < 64; ++i) {
        check.same(actual[i].z, 100 + i);
        check.same(in_last[i], 300 + i);
        check.same(in_apart[i], 500 + i);
    }
}

/// What map_voxels must leave in its targets and buffer.
template <volume_backend B>
struct voxel_probe {
    grid_probe<B> loaded, sampled;
    glm::ivec3 target_size;
    typename B::volume sums, samples;
    std::vector<glm::vec4> weights;
    guarded<B> weights_in, numbers;
};

template <volume_backend B>
[[nodiscard]] voxel_probe<B> make_voxel_probe(context<B>& c, glm::ivec3 loaded, glm::ivec3 sampled,
                                              glm::ivec3 target, glm::ivec3 extent) {
    const std::vector<float> kept(voxels_of(target), -7.0f);
    std::vector<glm::vec4> weights(static_cast<std::size_t>(std::max(extent.z, 1)));
    for (glm::vec4& weight : weights) {
        weight = c.small_vector();
    }
    auto weights_in = c.put(weights);
    return {random_grid(c, loaded, volume_format::float32),
            random_grid(c, sampled, volume_format::float16),
            target,
            put_volume(c, target, volume_format::float32, kept),
            put_volume(c, target, volume_format::float32, kept),
            std::move(weights),
            std::move(weights_in),
            c.template room<std::uint32_t>(voxels_of(extent))};
}

template <volume_backend B>
void expect_voxels(const context<B>& c, const voxel_probe<B>& p, glm::ivec3 extent, float shift) {
    const auto sums = get_numbers(c, p.sums);
    const auto samples = get_numbers(c, p.samples);
    comparison sum_check = c.compare("sums of neighbours");
    comparison sample_check = c.compare("samples");
    const auto loaded = [&](glm::ivec3 at) {
        for (int k = 0; k < 3; ++k) {
            if (at[k] < 0 || at[k] >= p.loaded.size[k]) {
                return 0.0;
            }
        }
        return p.loaded.at(at);
    };
    each_voxel(p.target_size, [&](glm::ivec3 at) {
        const std::size_t i = voxel_index(at, p.target_size);
        if (at.x >= extent.x || at.y >= extent.y || at.z >= extent.z) {
            sum_check.same(sums[i], -7);
            sample_check.same(samples[i], -7);
            return;
        }
        double sum = loaded(at);
        for (int k = 0; k < 3; ++k) {
            glm::ivec3 step{0};
            step[k] = 1;
            sum += loaded(at + step) + loaded(at - step);
        }
        sum_check.same(sums[i], sum * double{p.weights[static_cast<std::size_t>(at.z)].x});
        const glm::dvec3 place =
            (glm::dvec3(at) + 0.5 + double{shift}) / glm::dvec3(p.sampled.size);
        const sample_bounds bounds = expected_sample(p.sampled, place, true);
        sample_check.within(samples[i], bounds.low, bounds.high);
    });
    std::vector<std::uint32_t> numbers(voxels_of(extent));
    for (std::uint32_t i = 0; i < numbers.size(); ++i) {
        numbers[i] = i + (static_cast<std::uint32_t>(p.loaded.size.x) << 24);
    }
    expect_numbers(c, p.numbers, numbers, "numbers of voxels");
}

template <volume_backend B>
void map_these_voxels(context<B>& c, glm::ivec3 loaded, glm::ivec3 sampled, glm::ivec3 target,
                      glm::ivec3 extent, float shift) {
    const auto p = make_voxel_probe(c, loaded, sampled, target, extent);
    const kernels::probe_voxels kernel{extent.x, extent.y, shift};
    c.run([&](auto& r) {
        r.map_voxels(kernel, {p.weights_in.view(), p.numbers.view()},
                     volume_bindings<B, kernels::probe_voxels>{
                         {&p.loaded.volume, &p.sampled.volume}, {&p.sums, &p.samples}},
                     glm::uvec3(extent));
    });
    expect_voxels(c, p, extent, shift);
}

/// Neighbours are summed again and again, from one volume to the other and back, against sums in
/// integers. The total grows sevenfold at most each time, and stays exact.
template <volume_backend B>
void map_voxels_to_and_fro(context<B>& c) {
    const glm::ivec3 size{6, 5, 7};
    constexpr int times = 4; // 1000 · 7⁴ < 2^24
    auto p = make_voxel_probe(c, size, {2, 2, 2}, size, size);
    const auto weights = c.put(std::vector<glm::vec4>(7, glm::vec4(1)));
    const typename B::volume* turns[] = {&p.loaded.volume, &p.sums};
    c.run([&](auto& r) {
        for (int i = 0; i < times; ++i) {
            r.map_voxels(kernels::probe_voxels{size.x, size.y, 0},
                         {weights.view(), p.numbers.view()},
                         volume_bindings<B, kernels::probe_voxels>{
                             {turns[i % 2], &p.sampled.volume}, {turns[1 - i % 2], &p.samples}},
                         glm::uvec3(size));
        }
    });
    std::vector<double> now = p.loaded.numbers;
    for (int i = 0; i < times; ++i) {
        std::vector<double> next(now.size());
        each_voxel(size, [&](glm::ivec3 at) {
            double sum = now[voxel_index(at, size)];
            for (int k = 0; k < 3; ++k) {
                glm::ivec3 step{0};
                step[k] = 1;
                sum += at[k] > 0 ? now[voxel_index(at - step, size)] : 0;
                sum += at[k] + 1 < size[k] ? now[voxel_index(at + step, size)] : 0;
            }
            next[voxel_index(at, size)] = sum;
        });
        now = std::move(next);
    }
    const auto actual = get_numbers(c, *turns[times % 2]);
    comparison check = c.compare("sums of neighbours of neighbours");
    for (std::size_t i = 0; i < now.size(); ++i) {
        check.same(actual[i], now[i]);
    }
}

/// An rgba32f image, each pixel by probe_volume_draw; the vertices' colour runs over the image from
/// (0, 0, z) to (1, 1, z).
template <volume_backend B>
[[nodiscard]] picture draw_volumes(const context<B>& c, const kernels::probe_volume_draw& kernel,
                                   const grid_probe<B>& a, const grid_probe<B>& b,
                                   const typename B::image& image, image_description what,
                                   float z) {
    auto corners = textured(what, 0, 0, 1, 1);
    for (kernels::probe_vertex& corner : corners) {
        corner.color.z = z;
    }
    const auto vertices = c.put(corners);
    const auto target = new_image(c, what);
    draw_geometry<B> geometry;
    geometry.count = static_cast<std::uint32_t>(corners.size());
    draw_target<B> to;
    to.color = &target;
    to.clear_color = glm::vec4{-1, -1, -1, -1};
    c.run([&](auto& r) {
        r.draw(kernel, {vertices.view()},
               {sampled_image<B>{&image, filter_mode::nearest, wrap_mode::clamp}},
               volume_bindings<B, kernels::probe_volume_draw>{{&a.volume, &b.volume}, {}}, geometry,
               to, draw_state{});
    });
    return read_image(c, target);
}

/// The image has as many pixels as the volumes have voxels along x and y, or four times as many, so
/// that a pixel's middle lies on eighths of a voxel. What a rasteriser loses of the varyings is
/// less than 2^-16 of the image's side, 16 voxels, for x and for y; neighbours differ by up to
/// 2000.
template <volume_backend B>
void draw_with_volumes(context<B>& c, volume_format format) {
    const auto a = random_grid(c, {16, 8, 4}, format);
    const auto b = random_grid(c, {16, 8, 8}, volume_format::float16);
    const picture p = random_picture(c, {16, 8, image_format::rgba32f});
    const auto image = put_image(c, p);
    const image_description same{16, 8, image_format::rgba32f};
    const image_description finer{64, 32, image_format::rgba32f};
    using read = kernels::probe_volume_read;

    const picture loaded = draw_volumes(c, {read::load, 3}, a, b, image, same, 0);
    const picture sizes = draw_volumes(c, {read::size, 0}, a, b, image, same, 0);
    comparison load_check = c.compare("voxels and texels loaded by a fragment");
    comparison size_check = c.compare("sides seen by a fragment");
    for (std::uint32_t y = 0; y < same.height; ++y) {
        for (std::uint32_t x = 0; x < same.width; ++x) {
            const glm::ivec3 at{x, y, 3};
            load_check.same(loaded.at(x, y).x, a.at(at));
            load_check.same(loaded.at(x, y).y, b.at(at));
            load_check.same(loaded.at(x, y).z, double{p.at(x, y).x});
            size_check.same(sizes.at(x, y), {16, 8, 4, 16});
        }
    }

    const float z = 0.40625f; // 1 + 1/8 voxels above the middle of a's first, 2 + 3/4 of b's
    const picture sampled = draw_volumes(c, {read::sample, 0}, a, b, image, finer, z);
    comparison sample_check = c.compare("samples by a fragment");
    const double varying = 2 * 0x1p-16 * 16 * 2000;
    for (std::uint32_t y = 0; y < finer.height; ++y) {
        for (std::uint32_t x = 0; x < finer.width; ++x) {
            const glm::dvec3 place{(x + 0.5) / finer.width, (y + 0.5) / finer.height, double{z}};
            const glm::vec4 pixel = sampled.at(x, y);
            if (is_filtered(c.device, format)) {
                const sample_bounds in_a = expected_sample(a, place, true);
                sample_check.within(pixel.x, in_a.low - varying, in_a.high + varying);
            }
            const sample_bounds in_b = expected_sample(b, place, true);
            sample_check.within(pixel.y, in_b.low - varying, in_b.high + varying);
            sample_check.same(pixel.z, double{p.at(x / 4, y / 4).x});
        }
    }
}

template <backend B>
void add_grid_cases(cases<B>& to) {
    using enum volume_format;
    const auto add = [&](std::string pattern, std::string name,
                         std::function<void(context<B>&)> body) {
        to.push_back({std::move(pattern), std::move(name), std::move(body)});
    };
    if constexpr (maps_grids<B, kernels::probe_volume>) {
        for (const named_size n : {named_size{"empty", 0},
                                   {"one", 1},
                                   {"limit_plus_1", 65},
                                   {"block_plus_1", 257},
                                   {"thousand", 1000}}) {
            add("map", std::string("grids_") + n.name,
                [n](context<B>& c) { map_grids(c, n.size, float32, true); });
        }
        add("map", "grids_float16", [](context<B>& c) { map_grids(c, 1000, float16, true); });
        add("map", "grids_anywhere_float32",
            [](context<B>& c) { map_grids(c, 5000, float32, false); });
        add("map", "grids_anywhere_float16",
            [](context<B>& c) { map_grids(c, 5000, float16, false); });
        add("map", "grids_twice", map_grids_twice<B>);
    }
    if constexpr (maps_voxels<B, kernels::probe_voxels>) {
        add("voxels", "sizes", [](context<B>& c) {
            for (const glm::ivec3 size : odd_sizes) {
                map_these_voxels(c, size, {4, 8, 2}, size, size, 0);
            }
        });
        add("voxels", "part", [](context<B>& c) {
            map_these_voxels(c, {9, 9, 9}, {8, 8, 8}, {21, 14, 17}, {13, 7, 11}, 0.5f);
            map_these_voxels(c, {20, 3, 5}, {8, 8, 8}, {21, 14, 17}, {21, 1, 17}, 0.25f);
        });
        add("voxels", "none", [](context<B>& c) {
            for (const glm::ivec3 extent : {glm::ivec3{0, 0, 0}, {0, 3, 4}, {3, 0, 4}, {3, 4, 0}}) {
                map_these_voxels(c, {3, 3, 3}, {2, 2, 2}, {5, 5, 5}, extent, 0);
            }
        });
        add("voxels", "samples_between", [](context<B>& c) {
            for (const float shift : {-1.5f, -0.0625f, 0.3125f, 0.5f, 2.0f}) {
                map_these_voxels(c, {4, 4, 4}, {16, 8, 8}, {17, 9, 9}, {17, 9, 9}, shift);
            }
        });
        add("voxels", "long", [](context<B>& c) {
            map_these_voxels(c, {255, 2, 2}, {2, 2, 2}, {255, 2, 3}, {255, 2, 3}, 0);
            map_these_voxels(c, {2, 255, 2}, {2, 2, 2}, {2, 255, 3}, {2, 255, 3}, 0);
            map_these_voxels(c, {2, 2, 255}, {2, 2, 2}, {3, 2, 255}, {3, 2, 255}, 0);
        });
        add("voxels", "to_and_fro", map_voxels_to_and_fro<B>);
    }
    if constexpr (draws_volumes<B, kernels::probe_volume_draw>) {
        add("draw", "volumes_float32", [](context<B>& c) { draw_with_volumes(c, float32); });
        add("draw", "volumes_float16", [](context<B>& c) { draw_with_volumes(c, float16); });
    }
}

} // namespace skybark::conformance
