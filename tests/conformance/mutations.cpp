// The suite is tested itself: backends that are wrong in one way must each fail the case that is
// about it, and the right one that they are made from must fail none.

#include "run_cases.hpp"

#include "../../examples/02_own_backend.hpp"

namespace {

using namespace skybark;

enum class fault {
    none,
    loses_last_triangle,
    swaps_winding,
    rounds_to_half,
    writes_past_capacity,
    ignores_padding,
    counts_only_what_fits,
    counts_spare_triangles_of_compact,
    reverses_elements,
    reverses_ranges,
    starts_levels_early,
    ignores_first_element,
    ignores_limit_of_count,
    loses_nan,
    rings_leak_into_guard,
    flips_y,
    ignores_depth,
    ignores_culling,
    ignores_blending,
    draws_twice,
    ignores_base_vertex,
    ignores_length,
    never_clears,
    always_clears,
    takes_first_image,
    ignores_wrap,
    ignores_filter,
    uploads_late,
};

/// A kernel whose picture stands on its head.
template <class K>
struct flipped : K {
    template <class... Spans>
    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, K::varyings>& out,
                     Spans... spans) const {
        glm::vec4 p = K::vertex(index, out, spans...);
        p.y = -p.y;
        return p;
    }
};

class mutant_recorder;

/// The serial backend of the example with one fault.
class mutant {
  public:
    using backend_tag = skybark::backend_tag;
    using buffer = own::buffer;
    using image = own::image;
    using recorder = mutant_recorder;

    explicit mutant(fault which) : which_(which) {}

    [[nodiscard]] std::string_view name() const { return "mutant"; }
    [[nodiscard]] std::string device_name() const { return "one thread, one fault"; }
    [[nodiscard]] device_limits limits() const { return inner_.limits(); }
    [[nodiscard]] device_traffic traffic() const { return inner_.traffic(); }
    [[nodiscard]] result<buffer> create_buffer(std::uint64_t size) {
        return inner_.create_buffer(size);
    }
    [[nodiscard]] result<image> create_image(image_description what) {
        return inner_.create_image(what);
    }
    [[nodiscard]] result<void> upload(const buffer& to, std::uint64_t offset,
                                      std::span<const std::byte> in) {
        return inner_.upload(to, offset, in);
    }
    [[nodiscard]] result<void> download(const buffer& from, std::uint64_t offset,
                                        std::span<std::byte> out) {
        return inner_.download(from, offset, out);
    }
    [[nodiscard]] result<void> upload(const image& to, std::span<const std::byte> in) {
        return inner_.upload(to, in);
    }
    [[nodiscard]] result<void> download(const image& from, std::span<std::byte> out) {
        return inner_.download(from, out);
    }
    [[nodiscard]] result<mutant_recorder> begin();
    [[nodiscard]] result<void> submit(mutant_recorder& done);

  private:
    own::device inner_;
    fault which_;
};

class mutant_recorder {
  public:
    mutant_recorder(own::device& device, fault which) : inner_(device), which_(which) {}

    using view = buffer_view<mutant>;

    void upload(const view& to, std::span<const std::byte> in) {
        if (which_ == fault::uploads_late) {
            late_.emplace_back(to, std::vector(in.begin(), in.end()));
        } else {
            inner_.upload(convert(to), in);
        }
    }
    void copy(const view& from, const view& to) { inner_.copy(convert(from), convert(to)); }
    void finish() {
        for (const auto& [to, in] : late_) {
            inner_.upload(convert(to), in);
        }
    }

    template <map_kernel K>
    void map(const K& kernel, const bindings<mutant, K>& buffers, range elements) {
        if (which_ == fault::ignores_first_element) {
            elements.first = 0;
        }
        inner_.map(kernel, convert(buffers), elements);
        if (which_ == fault::loses_nan) {
            without_nan(buffers.back());
        }
    }
    template <map_kernel K>
    void map(const K& kernel, const bindings<mutant, K>& buffers, std::span<const range> ranges) {
        std::vector<range> order(ranges.begin(), ranges.end());
        if (which_ == fault::reverses_ranges) {
            std::reverse(order.begin(), order.end());
        }
        range late{};
        for (range r : order) {
            const range before = late;
            late = {};
            if (which_ == fault::starts_levels_early && r.count > 1) {
                --r.count; // the last element comes after the next range
                late = {r.first + r.count, 1};
            }
            inner_.map(kernel, convert(buffers), r);
            inner_.map(kernel, convert(buffers), before);
        }
        inner_.map(kernel, convert(buffers), late);
    }
    template <map_kernel K>
    void map(const K& kernel, const bindings<mutant, K>& buffers, counted<mutant> elements) {
        inner_.map(kernel, convert(buffers), convert(elements));
    }

    template <strip_kernel K>
    void expand(const K& kernel, const bindings<mutant, K>& buffers, range elements,
                triangle_list<mutant> out) {
        if (which_ == fault::ignores_padding) {
            out.policy = padding::compact;
        }
        inner_.expand(kernel, convert(buffers), elements, convert(out));
        spoil_list(out, 3 * sizeof(typename K::vertex), max_triangles(kernel) * elements.count);
    }
    template <strip_kernel K>
    void expand(const K& kernel, const bindings<mutant, K>& buffers, counted<mutant> elements,
                triangle_list<mutant> out) {
        inner_.expand(kernel, convert(buffers), convert(elements), convert(out));
        spoil_list(out, 3 * sizeof(typename K::vertex), max_triangles(kernel) * elements.limit);
    }
    template <ring_kernel K>
    void expand_rings(const K& kernel, const bindings<mutant, K>& buffers, range elements,
                      const view& vertices) {
        inner_.expand_rings(kernel, convert(buffers), elements, convert(vertices));
        std::byte* data = vertices.buffer->data() + vertices.offset;
        if (which_ == fault::rounds_to_half) {
            round_to_half(data, vertices.size);
        } else if (which_ == fault::rings_leak_into_guard && elements.count != 0) {
            data[vertices.size] = std::byte{0};
        }
    }

    template <draw_kernel K>
    void draw(const K& kernel, const bindings<mutant, K>& buffers,
              const image_bindings<mutant, K>& images, draw_geometry<mutant> geometry,
              const draw_target<mutant>& target, draw_state state) {
        image_bindings<own::device, K> bound{};
        for (std::size_t i = 0; i < images.size(); ++i) {
            bound[i] = {images[i].image, images[i].filter, images[i].wrap};
            if (which_ == fault::takes_first_image) {
                bound[i].image = images[0].image;
            } else if (which_ == fault::ignores_wrap) {
                bound[i].wrap = wrap_mode::clamp;
            } else if (which_ == fault::ignores_filter) {
                bound[i].filter = filter_mode::nearest;
            }
        }
        draw_target<own::device> to{target.color, target.depth, target.clear_color,
                                    target.clear_depth};
        if (which_ == fault::never_clears) {
            to.clear_color.reset();
        } else if (which_ == fault::always_clears && to.color != nullptr) {
            to.clear_color = to.clear_color.value_or(glm::vec4(0));
        }
        state.depth_test &= which_ != fault::ignores_depth;
        state.cull = which_ == fault::ignores_culling ? cull_mode::none : state.cull;
        state.blend = which_ == fault::ignores_blending ? blend_mode::none : state.blend;
        if (which_ == fault::ignores_length && geometry.length) {
            geometry.length = {};
            geometry.count = 6 * 64 - geometry.first;
        }
        const draw_geometry<own::device> what{
            convert(geometry.indices), geometry.first, geometry.count,
            which_ == fault::ignores_base_vertex ? 0 : geometry.base_vertex,
            convert(geometry.length)};
        if (which_ == fault::flips_y) {
            inner_.draw(flipped<K>{kernel}, convert(buffers), bound, what, to, state);
        } else {
            inner_.draw(kernel, convert(buffers), bound, what, to, state);
        }
        if (which_ == fault::draws_twice) {
            to.clear_color.reset();
            to.clear_depth.reset();
            inner_.draw(kernel, convert(buffers), bound, what, to, state);
        }
    }

  private:
    [[nodiscard]] static buffer_view<own::device> convert(const view& v) {
        return {v.buffer, v.offset, v.size};
    }
    template <std::size_t N>
    [[nodiscard]] static std::array<buffer_view<own::device>, N>
    convert(const std::array<view, N>& views) {
        std::array<buffer_view<own::device>, N> out;
        std::transform(views.begin(), views.end(), out.begin(),
                       [](const view& v) { return convert(v); });
        return out;
    }
    [[nodiscard]] counted<own::device> convert(const counted<mutant>& c) const {
        return {convert(c.count), which_ == fault::ignores_limit_of_count ? c.limit + 1 : c.limit};
    }
    [[nodiscard]] static triangle_list<own::device> convert(const triangle_list<mutant>& t) {
        return {convert(t.vertices), convert(t.count), t.policy};
    }

    static void round_to_half(std::byte* data, std::uint64_t size) {
        for (std::uint64_t i = 0; i + 4 <= size; i += 4) {
            std::uint32_t bits = 0;
            std::memcpy(&bits, data + i, 4);
            bits = (bits + 0x1000u) & ~0x1fffu; // 10 of the 23 bits of a mantissa
            std::memcpy(data + i, &bits, 4);
        }
    }
    static void without_nan(const view& v) {
        std::byte* data = v.buffer->data() + v.offset;
        for (std::uint64_t i = 0; i + 4 <= v.size; i += 4) {
            float value = 0;
            std::memcpy(&value, data + i, 4);
            if (std::isnan(value)) {
                std::memset(data + i, 0, 4);
            }
        }
    }
    void spoil_list(const triangle_list<mutant>& out, std::size_t bytes, std::uint64_t most) const {
        std::byte* data = out.vertices.buffer->data() + out.vertices.offset;
        count_record count;
        std::memcpy(&count, out.count.buffer->data() + out.count.offset, sizeof count);
        const std::uint32_t n = count.written;
        switch (which_) {
        case fault::loses_last_triangle:
            std::memset(data + (n == 0 ? 0 : n - 1) * bytes, 0, n == 0 ? 0 : bytes);
            break;
        case fault::swaps_winding:
            for (std::uint32_t t = 0; t < n; ++t) {
                std::swap_ranges(data + t * bytes, data + t * bytes + bytes / 3,
                                 data + t * bytes + bytes / 3);
            }
            break;
        case fault::rounds_to_half:
            round_to_half(data, n * bytes);
            break;
        case fault::writes_past_capacity:
            if (count.required > n) {
                std::memset(data + out.vertices.size, 0, 12);
            }
            break;
        case fault::counts_only_what_fits:
            count.required = n;
            break;
        case fault::counts_spare_triangles_of_compact:
            count.required = static_cast<std::uint32_t>(most);
            break;
        case fault::reverses_elements:
            for (std::uint32_t t = 0; t < n / 2; ++t) {
                std::swap_ranges(data + t * bytes, data + (t + 1) * bytes,
                                 data + (n - 1 - t) * bytes);
            }
            break;
        default:
            break;
        }
        std::memcpy(out.count.buffer->data() + out.count.offset, &count, sizeof count);
    }

    own::recorder inner_;
    fault which_;
    std::vector<std::pair<view, std::vector<std::byte>>> late_;
};

result<mutant_recorder> mutant::begin() { return mutant_recorder(inner_, which_); }
result<void> mutant::submit(mutant_recorder& done) {
    done.finish();
    return {};
}

/// Whether a case is worth its time here: large ones find nothing that small ones don't.
[[nodiscard]] bool is_small(const std::string& name) {
    for (const char* large : {"groups", "huge", "scan", "long_chain", "many"}) {
        if (name.find(large) != std::string::npos) {
            return false;
        }
    }
    return true;
}

/// The small cases that a mutant fails, and what they say.
[[nodiscard]] std::map<std::string, std::string> failed_cases(fault which) {
    std::optional<mutant> device;
    return conformance::failed_cases<mutant>([&]() -> mutant& { return device.emplace(which); },
                                             is_small);
}

[[nodiscard]] std::string listed(const std::map<std::string, std::string>& failed) {
    std::string all;
    for (const auto& [name, why] : failed) {
        all += "\n  " + name;
    }
    return all.empty() ? " none" : all;
}

/// What is wrong with a backend, and the cases that must notice.
struct mutation {
    fault which;
    const char* name;
    std::vector<std::string> must_fail;
};

void PrintTo(const mutation& m, std::ostream* out) { *out << m.name; }

class mutations : public testing::TestWithParam<mutation> {};

TEST_P(mutations, fails_its_case) {
    const auto failed = failed_cases(GetParam().which);
    for (const std::string& name : GetParam().must_fail) {
        EXPECT_TRUE(failed.contains(name))
            << name << " should fail. What failed:" << listed(failed);
    }
}

TEST(mutations_of_nothing, fail_nothing) {
    const auto failed = failed_cases(fault::none);
    EXPECT_TRUE(failed.empty()) << "What failed:" << listed(failed);
}

const mutation all_mutations[] = {
    {fault::loses_last_triangle,
     "loses_last_triangle",
     {"expand.compact_one", "expand.compact_limit", "branch.volume_compact"}},
    {fault::swaps_winding,
     "swaps_winding",
     {"expand.compact_limit", "expand.degenerate_limit", "branch.volume_degenerate"}},
    {fault::rounds_to_half, "rounds_to_half", {"branch.rings_slerp", "branch.list_compact_slerp"}},
    {fault::writes_past_capacity,
     "writes_past_capacity",
     {"expand.compact_short_by_one_triangle", "expand.degenerate_short_by_one_triangle"}},
    {fault::ignores_padding, "ignores_padding", {"expand.degenerate_limit_plus_1"}},
    {fault::counts_only_what_fits,
     "counts_only_what_fits",
     {"expand.compact_short_by_one_triangle", "expand.compact_room_for_none"}},
    {fault::counts_spare_triangles_of_compact,
     "counts_spare_triangles_of_compact",
     {"expand.compact_no_triangles"}},
    {fault::reverses_elements, "reverses_elements", {"expand.compact_block"}},
    {fault::reverses_ranges, "reverses_ranges", {"map.levels_deep", "map.levels_tree"}},
    {fault::starts_levels_early, "starts_levels_early", {"map.levels_deep", "map.levels_limit"}},
    {fault::ignores_first_element, "ignores_first_element", {"map.range_part"}},
    {fault::ignores_limit_of_count,
     "ignores_limit_of_count",
     {"map.counted_above_limit", "expand.compact_counted_above_limit"}},
    {fault::loses_nan, "loses_nan", {"map.nan"}},
    {fault::rings_leak_into_guard, "rings_leak_into_guard", {"rings.one", "rings.limit"}},
    {fault::flips_y, "flips_y", {"draw.orientation", "draw.shapes"}},
    {fault::ignores_depth, "ignores_depth", {"draw.depth_order"}},
    {fault::ignores_culling, "ignores_culling", {"draw.cull_back"}},
    {fault::ignores_blending, "ignores_blending", {"draw.blend_one_layer"}},
    {fault::draws_twice, "draws_twice", {"draw.shared_edges", "draw.shared_edges_on_centres"}},
    {fault::ignores_base_vertex,
     "ignores_base_vertex",
     {"draw.base_vertex", "draw.indexed_base_vertex"}},
    {fault::ignores_length, "ignores_length", {"draw.by_length", "chain.counts_go_on_compact"}},
    {fault::never_clears, "never_clears", {"draw.clear_rgba8", "draw.clear_rgba32f"}},
    {fault::always_clears, "always_clears", {"draw.keeps_what_is_there"}},
    {fault::takes_first_image, "takes_first_image", {"images.fetch_second", "images.size"}},
    {fault::ignores_wrap, "ignores_wrap", {"images.sample_rgba8_nearest_repeat"}},
    {fault::ignores_filter, "ignores_filter", {"images.sample_rgba8_linear_clamp"}},
    {fault::uploads_late, "uploads_late", {"buffers.upload_in_the_stream"}},
};

INSTANTIATE_TEST_SUITE_P(suite, mutations, testing::ValuesIn(all_mutations),
                         [](const auto& each) { return std::string(each.param.name); });

} // namespace
