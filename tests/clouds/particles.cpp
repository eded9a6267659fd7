// Particles out of separate spans, and out of buffers of any layout: every number where it belongs,
// with the same bits on the host and on each device.

#include "support/allocations.hpp"
#include "support/devices.hpp"

#include <skybark/clouds/light_box.hpp>
#include <skybark/clouds/particles.hpp>
#include <skybark/core/validated.hpp>

#include <bit>
#include <random>

namespace {

using namespace skybark;
using namespace skybark::clouds;

constexpr std::uint32_t many = 700;

struct separate {
    std::vector<glm::vec3> positions;
    std::vector<float> radii;
    std::vector<float> depths;
    std::vector<float> albedos;
};

/// Numbers that are all different.
separate some(std::uint32_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> number(0.01f, 1);
    separate all;
    for (std::uint32_t i = 0; i < count; ++i) {
        all.positions.emplace_back(1000 * number(random), -50 * number(random), number(random));
        all.radii.push_back(number(random));
        all.depths.push_back(3 * number(random));
        all.albedos.push_back(number(random));
    }
    return all;
}

/// The words of a particle i as records.hpp lays them out, written by hand.
std::array<std::uint32_t, 8> words_of(glm::vec3 at, float radius, float depth, float albedo) {
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
    return {bits(at.x), bits(at.y), bits(at.z), bits(radius), bits(depth), bits(albedo), 0, 0};
}
std::array<std::uint32_t, 8> words_of(const cloud_particle& p) {
    return std::bit_cast<std::array<std::uint32_t, 8>>(p);
}

std::string sentence(const result<void>& done) {
    return done ? std::string("no error") : done.error().message;
}
template <class T>
std::string sentence(const result<T>& made) {
    return made ? std::string("no error") : made.error().message;
}

} // namespace

TEST(particles_of_spans, are_one_for_each_position) {
    const separate all = some(50);
    const auto made = particles_of(all.positions, all.radii, all.depths, all.albedos);
    ASSERT_TRUE(made) << made.error().message;
    ASSERT_EQ(made->size(), 50u);
    for (std::size_t i = 0; i < 50; ++i) {
        EXPECT_EQ(words_of((*made)[i]),
                  words_of(all.positions[i], all.radii[i], all.depths[i], all.albedos[i]));
    }
    EXPECT_TRUE(check_particles(*made));
}

TEST(particles_of_spans, share_what_is_given_once) {
    const separate all = some(5);
    const float radius[] = {7};
    const float depth[] = {0.25f};
    const float albedo[] = {0.5f};
    const auto made = particles_of(all.positions, radius, depth, albedo);
    ASSERT_TRUE(made) << made.error().message;
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(words_of((*made)[i]), words_of(all.positions[i], 7, 0.25f, 0.5f));
    }
    const auto one = particles_of(std::span(all.positions).first(1), radius, depth, albedo);
    ASSERT_TRUE(one);
    EXPECT_EQ(one->size(), 1u);
    const auto none = particles_of({}, radius, depth, albedo);
    ASSERT_TRUE(none);
    EXPECT_TRUE(none->empty());
    EXPECT_TRUE(particles_of({}, {}, {}, {}));
}

TEST(particles_of_spans, name_the_span_of_a_wrong_length) {
    const separate all = some(5);
    const std::span<const float> f(all.radii);
    const auto said = [&](std::span<const float> radii, std::span<const float> depths,
                          std::span<const float> albedos) {
        return sentence(particles_of(all.positions, radii, depths, albedos));
    };
    EXPECT_EQ(said(f.first(4), f, f), "There are 4 radii for 5 positions; expected as many, or one "
                                      "for all of them.");
    EXPECT_EQ(said(f, f.first(0), f), "There are 0 optical depths for 5 positions; expected as "
                                      "many, or one for all of them.");
    EXPECT_EQ(said(f, f, f.first(2)), "There are 2 albedos for 5 positions; expected as many, or "
                                      "one for all of them.");
    EXPECT_EQ(sentence(particles_of({}, f, f.first(1), f.first(1))),
              "There are 5 radii for 0 positions; expected as many, or one for all of them.");
    std::vector<cloud_particle> short_one(4);
    EXPECT_EQ(sentence(particles_of(all.positions, f, f, f, std::span(short_one))),
              "There is room for 4 particles for 5 positions; expected as much.");
}

TEST(particles_of_spans, go_into_a_callers_span_without_allocating) {
    const separate all = some(many);
    std::vector<cloud_particle> to(many);
    const std::uint64_t before = support::allocations;
    const auto done =
        particles_of(all.positions, all.radii, all.depths, all.albedos, std::span(to));
    const std::uint64_t made = support::allocations - before;
    ASSERT_TRUE(done);
    if (SKYBARK_TEST_COUNTS_ALLOCATIONS) {
        EXPECT_EQ(made, 0u);
    }
    EXPECT_EQ(words_of(to[many - 1]), words_of(all.positions[many - 1], all.radii[many - 1],
                                               all.depths[many - 1], all.albedos[many - 1]));
}

namespace {

/// Buffers of floats on a device, and where the attributes are in them.
template <class B>
struct laid_out {
    std::vector<typename B::buffer> buffers;
    particle_attributes<B> attributes;
};

template <class B>
void add(B& device, laid_out<B>& to, std::span<const float> floats) {
    auto made = make_buffer<B, float>(device, floats);
    ASSERT_TRUE(made) << made.error().message;
    to.buffers.push_back(std::move(*made));
}

/// A buffer for each attribute, one after the other. The depths are a view that begins in the
/// middle of its buffer, where a view may, and the albedos one that begins a few floats early.
template <class B>
laid_out<B> apart(B& device, const separate& all) {
    laid_out<B> out;
    std::vector<float> places;
    for (const glm::vec3& p : all.positions) {
        places.insert(places.end(), {p.x, p.y, p.z});
    }
    const std::size_t skip = device.limits().view_alignment / sizeof(float);
    std::vector<float> depths(skip, -1);
    depths.insert(depths.end(), all.depths.begin(), all.depths.end());
    std::vector<float> albedos(3, -1);
    albedos.insert(albedos.end(), all.albedos.begin(), all.albedos.end());
    for (const std::span<const float> each :
         {std::span<const float>(places), std::span<const float>(all.radii),
          std::span<const float>(depths), std::span<const float>(albedos)}) {
        add(device, out, each);
    }
    if (out.buffers.size() == 4) {
        out.attributes.positions = {view<B>(out.buffers[0]), 0, 3};
        out.attributes.radii = {view<B>(out.buffers[1]), 0, 1};
        out.attributes.optical_depths = {view<B, float>(out.buffers[2], skip, all.depths.size()), 0,
                                         1};
        out.attributes.albedos = {view<B>(out.buffers[3]), 3, 1};
    }
    return out;
}

/// One buffer of records of eleven floats: two of padding, the depth, x, y, z, one of padding, the
/// albedo, the radius, two of padding, behind a head of 70 floats. The last record has no padding.
template <class B>
laid_out<B> interleaved(B& device, const separate& all) {
    laid_out<B> out;
    std::vector<float> floats(70, -2);
    for (std::size_t i = 0; i < all.positions.size(); ++i) {
        const glm::vec3& p = all.positions[i];
        floats.insert(floats.end(), {-3, -3, all.depths[i], p.x, p.y, p.z, -3, all.albedos[i],
                                     all.radii[i], -3, -3});
    }
    floats.resize(floats.size() - 2);
    add(device, out, floats);
    if (out.buffers.size() == 1) {
        const buffer_view<B> whole = view<B>(out.buffers[0]);
        out.attributes = {{whole, 73, 11}, {whole, 78, 11}, {whole, 72, 11}, {whole, 77, 11}};
    }
    return out;
}

/// What the device makes, as words, with a particle more than asked for that is left alone.
template <class B>
std::vector<std::array<std::uint32_t, 8>> packed(B& device, const device_limits& limits,
                                                 const particle_attributes<B>& from,
                                                 std::uint32_t count) {
    std::vector<cloud_particle> got(count + 1);
    got.back().radius = 77;
    auto to = make_buffer<B, cloud_particle>(device, got);
    EXPECT_TRUE(to) << to.error().message;
    result<void> recorded;
    const auto done = run(device, [&](auto& recorder) {
        recorded = record_particles<B>(recorder, limits, from, count, view<B>(*to));
    });
    EXPECT_TRUE(done && recorded) << sentence(done) << sentence(recorded);
    EXPECT_TRUE((read_back<B, cloud_particle>(device, *to, std::span(got))));
    EXPECT_EQ(got.back().radius, 77);
    std::vector<std::array<std::uint32_t, 8>> words;
    for (std::uint32_t i = 0; i < count; ++i) {
        words.push_back(words_of(got[i]));
    }
    return words;
}

std::vector<std::array<std::uint32_t, 8>> expected(const separate& all, std::uint32_t count) {
    const auto made = particles_of(all.positions, all.radii, all.depths, all.albedos);
    std::vector<std::array<std::uint32_t, 8>> words;
    for (std::uint32_t i = 0; i < count; ++i) {
        words.push_back(words_of((*made)[i]));
    }
    return words;
}

class particles_of_buffers : public testing::TestWithParam<const char*> {};

} // namespace

TEST_P(particles_of_buffers, have_the_hosts_bits_whatever_their_layout) {
    support::with_device(GetParam(), [](auto& inner) {
        using inner_type = std::remove_reference_t<decltype(inner)>;
        std::vector<std::string> misuse;
        validated<inner_type> device(inner,
                                     [&](std::string_view said) { misuse.emplace_back(said); });
        const separate all = some(many);
        const auto soa = apart(device, all);
        const auto aos = interleaved(device, all);
        for (const std::uint32_t count : {many, many - 1, 1u}) {
            EXPECT_EQ(packed(device, device.limits(), soa.attributes, count), expected(all, count));
            EXPECT_EQ(packed(device, device.limits(), aos.attributes, count), expected(all, count));
        }
        EXPECT_EQ(misuse, std::vector<std::string>{});
    });
}

TEST_P(particles_of_buffers, share_what_has_a_stride_of_zero) {
    support::with_device(GetParam(), [](auto& device) {
        separate all = some(many);
        auto soa = apart(device, all);
        soa.attributes.radii = {soa.attributes.radii.floats, 11, 0};
        soa.attributes.albedos = {soa.attributes.albedos.floats, many + 2, 0}; // the very last
        std::fill(all.radii.begin(), all.radii.end(), float{all.radii[11]});
        std::fill(all.albedos.begin(), all.albedos.end(), float{all.albedos[many - 1]});
        EXPECT_EQ(packed(device, device.limits(), soa.attributes, many), expected(all, many));
        soa.attributes.positions.stride = 0;
        std::fill(all.positions.begin(), all.positions.end(), glm::vec3(all.positions[0]));
        EXPECT_EQ(packed(device, device.limits(), soa.attributes, many), expected(all, many));
    });
}

// As on a device whose views end long before a cloud does: the interleaved records are 30,800
// bytes.
TEST_P(particles_of_buffers, go_through_in_parts_where_views_are_short) {
    support::with_device(GetParam(), [](auto& inner) {
        using inner_type = std::remove_reference_t<decltype(inner)>;
        std::vector<std::string> misuse;
        validated<inner_type> device(inner,
                                     [&](std::string_view said) { misuse.emplace_back(said); });
        const separate all = some(many);
        device_limits limits = device.limits();
        for (const std::uint64_t bytes : {std::uint64_t{4096}, std::uint64_t{12000}}) {
            limits.max_buffer_bytes = bytes + limits.view_alignment;
            EXPECT_LT(particles_at_once(limits, 11), many / 2);
            const auto soa = apart(device, all);
            const auto aos = interleaved(device, all);
            EXPECT_EQ(packed(device, limits, soa.attributes, many), expected(all, many));
            EXPECT_EQ(packed(device, limits, aos.attributes, many), expected(all, many));
        }
        EXPECT_EQ(misuse, std::vector<std::string>{});
    });
}

TEST_P(particles_of_buffers, are_none_where_none_are_asked_for) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        EXPECT_TRUE(packed(device, device.limits(), particle_attributes<B>{}, 0).empty());
    });
}

TEST_P(particles_of_buffers, name_the_attribute_that_does_not_fit) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const separate all = some(20);
        const auto aos = interleaved(device, all); // 288 floats
        auto to = device.create_buffer(20 * sizeof(cloud_particle));
        ASSERT_TRUE(to);
        const auto said = [&](auto change, std::uint32_t count) {
            particle_attributes<B> from = aos.attributes;
            change(from);
            result<void> recorded;
            EXPECT_TRUE(run(device, [&](auto& recorder) {
                recorded =
                    record_particles<B>(recorder, device.limits(), from, count, view<B>(*to));
            }));
            return sentence(recorded);
        };
        EXPECT_EQ(said([](auto&) {}, 20), "no error");
        EXPECT_EQ(said([](auto& f) { f.radii.first = 79; }, 20),
                  "The radii of 20 particles, 11 floats apart from float 79 on, reach beyond a "
                  "view of 288 floats.");
        EXPECT_EQ(said([](auto& f) { f.positions.first = 77; }, 20),
                  "The positions of 20 particles, 11 floats apart from float 77 on, reach beyond a "
                  "view of 288 floats.");
        EXPECT_EQ(said([](auto& f) { f.optical_depths.stride = 0xffffffffu; }, 20),
                  "The optical depths of 20 particles, 4294967295 floats apart from float 72 on, "
                  "reach beyond a view of 288 floats.");
        EXPECT_EQ(said([](auto& f) { f.albedos.first = ~std::uint64_t{0}; }, 20),
                  "The albedos of 20 particles, 11 floats apart from float 18446744073709551615 "
                  "on, reach beyond a view of 288 floats.");
        EXPECT_EQ(said([](auto& f) { f.albedos.floats = {}; }, 20),
                  "The albedos of 20 particles, 11 floats apart from float 77 on, reach beyond a "
                  "view of 0 floats.");
        EXPECT_EQ(said([](auto& f) { f.positions.stride = 1; }, 20),
                  "The positions are 1 floats apart; expected 0 or at least 3.");
        EXPECT_EQ(said(
                      [](auto& f) {
                          f = {{f.positions.floats, 0, 3},
                               {f.radii.floats, 0, 0},
                               {f.radii.floats, 0, 0},
                               {f.radii.floats, 0, 0}};
                      },
                      21),
                  "There is room for 20 particles; expected room for 21.");
    });
}

TEST_P(particles_of_buffers, send_parameters_alone) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto aos = interleaved(device, some(many));
        auto to = device.create_buffer(many * sizeof(cloud_particle));
        ASSERT_TRUE(to);
        const device_traffic before = device.traffic();
        const device_usage used = device.usage();
        ASSERT_TRUE(run(device, [&](auto& recorder) {
            EXPECT_TRUE(
                record_particles<B>(recorder, device.limits(), aos.attributes, many, view<B>(*to)));
        }));
        EXPECT_LE(device.traffic().up - before.up, 128u); // the particles are 22,400 bytes
        EXPECT_EQ(device.traffic().down, before.down);
        EXPECT_EQ(device.usage().objects, used.objects);
    });
}

INSTANTIATE_TEST_SUITE_P(all, particles_of_buffers, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& each) { return std::string(each.param); });
