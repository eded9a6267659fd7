// Grass and flowers: tufts and discs cut out of pictures that are drawn here, on stems that sway.

#include "growth.hpp"

#include <scenes/random.hpp>
#include <skybark/shared/noise.hpp>
#include <skybark/trees/build_skeleton.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace skybark::meadow {

namespace {

constexpr std::uint32_t picture_side = 128;
constexpr std::uint32_t samples = 4; ///< a texel, in each direction

/// A picture of colours (sRGB, 0 … 1) where `color_at(x, y, color)` is true, `around` elsewhere.
template <class ColorAt>
material drawn(glm::vec3 around, float through, ColorAt&& color_at) {
    material made;
    made.as = look::leaf;
    made.width = picture_side;
    made.height = picture_side;
    made.through = through;
    made.texels.reserve(std::size_t{4} * picture_side * picture_side);
    constexpr float step = 1.0f / (picture_side * samples);
    for (std::uint32_t row = 0; row < picture_side; ++row) {
        for (std::uint32_t column = 0; column < picture_side; ++column) {
            glm::vec3 sum(0);
            int inside = 0;
            for (std::uint32_t s = 0; s < samples * samples; ++s) {
                const float x = (static_cast<float>(column * samples + s % samples) + 0.5f) * step;
                const float y = (static_cast<float>(row * samples + s / samples) + 0.5f) * step;
                glm::vec3 color(0);
                if (color_at(x, y, color)) {
                    sum += color;
                    ++inside;
                }
            }
            const glm::vec3 color = inside == 0 ? around : sum / static_cast<float>(inside);
            for (int c = 0; c < 3; ++c) {
                made.texels.push_back(
                    static_cast<std::uint8_t>(std::clamp(color[c], 0.0f, 1.0f) * 255 + 0.5f));
            }
            made.texels.push_back(
                static_cast<std::uint8_t>(inside * 255 / static_cast<int>(samples * samples)));
        }
    }
    return made;
}

/// A blade in a picture: it starts at x `foot` on the lower edge, bends towards `tip`, and is
/// `width` wide at the foot.
struct stroke {
    float foot;
    glm::vec2 tip;
    float width;
    float shade;
    bool flowering; ///< a stalk with a spike of seeds
};

/// What a kind of grass looks like: sRGB at the foot and at the tip of its blades, and how many of
/// its stalks flower.
struct grass_look {
    glm::vec3 foot;
    glm::vec3 tip;
    glm::vec3 spike;
    int blades;
    int stalks;
};

/// A tuft of blades that fits a leaf's octagon, and the quadrilateral that stands for it.
material tuft_picture(const grass_look& grass, std::uint32_t seed) {
    scenes::random_numbers random(seed);
    std::vector<stroke> strokes;
    for (int i = 0; i < grass.blades + grass.stalks; ++i) {
        stroke s;
        s.flowering = i * grass.stalks % (grass.blades + grass.stalks) < grass.stalks;
        s.foot = random.between(0.36f, 0.64f);
        const float top = s.flowering ? random.between(0.86f, 0.97f) : random.between(0.5f, 0.93f);
        const float room = top > 0.854f ? 0.354f * (1 - top) / 0.146f : 0.37f;
        s.tip = {0.5f + random.between(-room, room), top};
        s.width = s.flowering ? 0.014f : random.between(0.040f, 0.062f);
        s.shade = random.between(0.82f, 1.12f);
        strokes.push_back(s);
    }
    return drawn(grass.foot, 0.62f, [&](float x, float y, glm::vec3& color) {
        bool hit = false;
        for (const stroke& s : strokes) { // the last is in front
            const float t = y / s.tip.y;
            if (t > 1) {
                continue;
            }
            const float middle = s.foot + (s.tip.x - s.foot) * t * t;
            const bool spike = s.flowering && t > 0.76f;
            const float along = std::max(0.0f, (t - 0.76f) / 0.24f);
            const float half = spike ? 0.004f + 0.02f * std::sin(std::numbers::pi_v<float> * along)
                                     : s.width * std::sqrt(1 - t) * 0.5f;
            if (std::abs(x - middle) > half) {
                continue;
            }
            hit = true;
            const glm::vec3 blade = glm::mix(grass.foot * 0.78f, grass.tip, t);
            const float side = x > middle ? 1.0f : 0.93f; // of the midrib
            color = (spike ? grass.spike : blade * side) * s.shade;
        }
        return hit;
    });
}

constexpr grass_look lush_grass{
    {0.32f, 0.43f, 0.19f}, {0.41f, 0.49f, 0.24f}, {0.47f, 0.47f, 0.29f}, 28, 2};
constexpr grass_look dry_grass{
    {0.36f, 0.42f, 0.22f}, {0.47f, 0.49f, 0.30f}, {0.57f, 0.53f, 0.39f}, 25, 6};

/// A disc of petals around a middle.
material flower_picture(int petals, float slender, glm::vec3 petal, glm::vec3 middle, float eye) {
    return drawn(petal, 0.6f, [=](float x, float y, glm::vec3& color) {
        const float dx = x - 0.5f;
        const float dy = y - 0.5f;
        const float r = std::sqrt(dx * dx + dy * dy);
        const float around = std::atan2(dy, dx) * static_cast<float>(petals) * 0.5f;
        const float outline =
            0.45f * (1 - slender + slender * std::sqrt(std::abs(std::cos(around))));
        if (r < eye) {
            color = middle * (0.8f + 0.2f * (1 - r / eye));
            return true;
        }
        color = petal * (0.86f + 0.14f * r / 0.45f);
        return r < outline;
    });
}

/// How many tufts grow on a square metre so far from the usual camera, ahead of it or elsewhere.
float density(glm::vec2 place) {
    const view_axes usual = usual_view();
    const glm::vec2 from = place - usual.eye;
    const float far = std::max(glm::length(from), 1.0f);
    constexpr float most = 40;
    const float thinned = most * std::pow(std::min(1.0f, 13 / far), 1.2f);
    const bool seen = glm::dot(from, usual.ahead) > 0.72f * far || far < 8;
    return seen ? thinned : 0.35f * thinned;
}

/// Patches of a size in m where something grows more or less well, 0 … 1.
float patch(glm::vec2 place, float size, float layer) {
    return shared::value_noise(place.x / size + 512, place.y / size + 512, layer, 65536);
}

class sower {
  public:
    sower(const land& ground, float amount, std::uint64_t seed)
        : ground_(ground), amount_(amount), random_(static_cast<std::uint32_t>(seed * 104729 + 3)) {
    }

    void sow() {
        constexpr int half = static_cast<int>(land::side) / 2;
        for (int z = -half; z < half; z += 2) {
            for (int x = -half; x < half; x += 2) {
                const glm::vec2 corner(static_cast<float>(x), static_cast<float>(z));
                if (distance(corner + 1.0f) > 40) {
                    sow_square(corner, 2, 12);
                    continue;
                }
                for (int k = 0; k < 4; ++k) {
                    sow_square(corner +
                                   glm::vec2(static_cast<float>(k % 2), static_cast<float>(k / 2)),
                               1, 4);
                }
            }
        }
    }

    std::vector<trees::segment> stems;
    std::vector<float> area;
    std::array<std::vector<leaf>, 4> blades; ///< two kinds of tufts, two of flowers

  private:
    static constexpr float stem_length = 0.3f;

    /// From the usual camera, m.
    [[nodiscard]] static float distance(glm::vec2 place) {
        return glm::distance(place, usual_view().eye);
    }
    [[nodiscard]] glm::vec2 within(glm::vec2 corner, float size) {
        const float x = random_.between(0, size);
        return corner + glm::vec2(x, random_.between(0, size));
    }
    /// So many on the whole: the fraction by chance.
    [[nodiscard]] int number(float expected) {
        return static_cast<int>(expected + random_.between(0, 1));
    }

    /// Tufts share a stem, so many of them; flowers have their own.
    void sow_square(glm::vec2 corner, float size, int shared) {
        const float here = density(corner + size / 2) * amount_ * size * size;
        int tufts = number(here * (0.7f + 0.6f * patch(corner, 7, 11)));
        const float spread = 0.3f * size;
        while (tufts > 0) {
            const glm::vec2 middle = within(corner, size);
            const std::uint32_t stem = add_stem(middle, stem_length, 0.0015f, 0.04f);
            for (int i = 0; i < shared && tufts > 0; ++i, --tufts) {
                const float aside = random_.between(-spread, spread);
                add_tuft(middle + glm::vec2(aside, random_.between(-spread, spread)), stem);
            }
        }
        const float daisies = patch(corner, 8, 21) * patch(corner, 23, 22);
        const float buttercups = patch(corner, 6, 31) * patch(corner, 27, 32);
        add_flowers(corner, size, here, 1.15f * daisies, 2);
        add_flowers(corner, size, here, buttercups, 3);
    }

    void add_flowers(glm::vec2 corner, float size, float here, float share, std::size_t kind) {
        const float far = distance(corner);
        const float part = std::max(0.0f, share - 0.17f) * std::clamp(2 - far / 40, 0.0f, 1.0f);
        // Alone on their stems where that can be seen, in small groups farther away.
        const int together = far < 18 ? 1 : 5;
        for (int n = number(2.2f * here * part); n > 0;) {
            const glm::vec2 middle = within(corner, size);
            const float tall = random_.between(0.42f, 0.62f);
            const std::uint32_t stem = add_stem(middle, tall, 0.001f, 0.008f);
            add_flower(middle, stem, tall, kind);
            --n;
            for (int i = 1; i < together && n > 0; ++i, --n) {
                const float aside = random_.between(-0.25f, 0.25f);
                add_flower(middle + glm::vec2(aside, random_.between(-0.25f, 0.25f)), stem, tall,
                           kind);
            }
        }
    }

    std::uint32_t add_stem(glm::vec2 place, float tall, float radius, float shown) {
        trees::segment s;
        s.base = ground_.on(place.x, place.y);
        s.tip = s.base + glm::vec3(0, tall, 0);
        s.base_radius = radius;
        s.radius = radius;
        stems.push_back(s);
        area.push_back(shown);
        return static_cast<std::uint32_t>(stems.size() - 1);
    }

    /// A leaf that points along `y`, its upper face as near to `z` as that lets it.
    [[nodiscard]] leaf placed(glm::vec3 at, glm::vec3 y, glm::vec3 z, float width, float length) {
        const glm::vec3 up = glm::normalize(y);
        const glm::vec3 across = glm::normalize(glm::cross(up, z));
        const glm::quat turn =
            glm::normalize(glm::quat_cast(glm::mat3(across, up, glm::cross(across, up))));
        leaf made;
        made.position = at;
        made.orientation = {turn.x, turn.y, turn.z, turn.w};
        made.width = width;
        made.length = length;
        made.seed = random_.bits();
        return made;
    }

    [[nodiscard]] glm::vec3 level() {
        const float a = random_.between(0, 2 * std::numbers::pi_v<float>);
        return {std::cos(a), 0, std::sin(a)};
    }

    void add_tuft(glm::vec2 place, std::uint32_t stem) {
        const float far = distance(place);
        const float lush = 0.65f + 0.7f * patch(place, 5, 1) * (0.5f + patch(place, 19, 2));
        const float length = 0.44f * lush * random_.between(0.75f, 1.2f);
        const float width = (0.34f + std::min(0.5f, 0.006f * far)) * random_.between(0.8f, 1.2f);
        const glm::vec3 lean = 0.35f * random_.in_ball();
        leaf made = placed(ground_.on(place.x, place.y) - glm::vec3(0, 0.02f, 0),
                           ground_.normal(place.x, place.y) + glm::vec3(lean.x, 0, lean.z), level(),
                           width, length);
        made.fold = random_.between(0.3f, 0.7f);
        made.carrier = stem;
        const float dry = patch(place, 13, 41) + random_.between(-0.25f, 0.25f);
        blades[dry > 0.62f ? 1 : 0].push_back(made);
    }

    void add_flower(glm::vec2 place, std::uint32_t stem, float tall, std::size_t kind) {
        const float size = (kind == 2 ? 0.085f : 0.06f) * random_.between(0.8f, 1.2f);
        const glm::vec3 up = glm::normalize(glm::vec3(0, 1, 0) + 0.5f * random_.in_ball());
        const glm::vec3 y = glm::normalize(glm::cross(up, level()));
        const glm::vec3 middle = ground_.on(place.x, place.y) + glm::vec3(0, tall, 0);
        leaf made = placed(middle - y * (size / 2), y, up, size, size);
        made.fold = 0.2f;
        made.carrier = stem;
        blades[kind].push_back(made);
    }

    const land& ground_;
    float amount_;
    scenes::random_numbers random_;
};

} // namespace

result<grown_grass> grow_grass(float amount, const land& ground, std::uint64_t seed) {
    grown_grass made;
    if (!(amount > 0)) {
        return made;
    }
    sower all(ground, amount, seed);
    all.sow();
    if (all.stems.empty()) {
        return made;
    }
    auto stems = trees::build_skeleton(all.stems); // roots alone: their order stays
    if (!stems) {
        return failure(stems.error());
    }
    made.stems = std::move(*stems);
    made.area = std::move(all.area);
    const auto own = static_cast<std::uint32_t>(seed + 5);
    const material pictures[] = {
        tuft_picture(lush_grass, own), tuft_picture(dry_grass, own + 1),
        flower_picture(13, 0.55f, {0.93f, 0.93f, 0.90f}, {0.86f, 0.68f, 0.16f}, 0.13f),
        flower_picture(5, 0.35f, {0.93f, 0.80f, 0.14f}, {0.80f, 0.66f, 0.12f}, 0.10f)};
    for (std::size_t kind = 0; kind < all.blades.size(); ++kind) {
        made.kinds.push_back({std::move(all.blades[kind]), pictures[kind]});
    }
    return made;
}

} // namespace skybark::meadow
