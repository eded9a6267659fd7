#include <first_pass/photon_map.hpp>
#include <first_pass/random.hpp>
#include <first_pass/rays.hpp>
#include <first_pass/threads.hpp>

#include <nanoflann.hpp>

#include <algorithm>
#include <utility>

namespace skybark::first_pass {

namespace {

/// The photons, as nanoflann wants points.
struct photon_cloud {
    std::vector<photon> photons;

    [[nodiscard]] std::size_t kdtree_get_point_count() const { return photons.size(); }
    [[nodiscard]] float kdtree_get_pt(std::size_t i, std::size_t axis) const {
        return photons[i].position[static_cast<glm::length_t>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using photon_tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, photon_cloud>,
                                        photon_cloud, 3, std::uint32_t>;

/// The nearest photons that arrived on sides which look about where a sample looks.
class nearest_facing {
  public:
    nearest_facing(std::span<const photon> photons, std::uint32_t most, float farthest)
        : photons_(photons), most_(most), farthest_(farthest) {
        found_.reserve(most);
    }

    void begin(glm::vec3 normal) {
        normal_ = normal;
        found_.clear();
    }

    /// Over the disk of the farthest, which is left out: with the k-th at r, k − 1 others over π r²
    /// are right on average, k would be too many.
    [[nodiscard]] glm::vec3 irradiance() const {
        if (found_.size() == most_) {
            glm::vec3 sum = -photons_[found_.front().second].power;
            for (const auto& one : found_) {
                sum += photons_[one.second].power;
            }
            return found_.front().first > 0 ? sum / (pi * found_.front().first) : glm::vec3(0);
        }
        glm::vec3 sum(0);
        for (const auto& one : found_) {
            sum += photons_[one.second].power;
        }
        return farthest_ < 1e15f ? sum / (pi * farthest_ * farthest_) : glm::vec3(0);
    }

    // What nanoflann asks of a result set.
    using DistanceType = float;
    [[nodiscard]] std::size_t size() const { return found_.size(); }
    [[nodiscard]] bool full() const { return true; }
    [[nodiscard]] float worstDist() const {
        return found_.size() == most_ ? found_.front().first
               : farthest_ < 1e15f    ? farthest_ * farthest_
                                      : 1e30f;
    }
    bool addPoint(float distance2, std::uint32_t index) {
        if (distance2 >= worstDist() || glm::dot(photons_[index].normal, normal_) < 0.7071f) {
            return true;
        }
        if (found_.size() == most_) {
            std::pop_heap(found_.begin(), found_.end());
            found_.pop_back();
        }
        found_.emplace_back(distance2, index);
        std::push_heap(found_.begin(), found_.end());
        return true;
    }

  private:
    std::span<const photon> photons_;
    std::size_t most_;
    float farthest_;
    glm::vec3 normal_{0};
    std::vector<std::pair<float, std::uint32_t>> found_;
};

/// Something that sends out photons: a side of a triangle, the sun, or the sky.
struct source {
    enum class kind { front, back, sun, sky } what = kind::front;
    std::uint32_t triangle = 0;
    double power = 0; ///< luminance, W
};

class light_sources {
  public:
    light_sources(const surfaces& scene, const far_lights& lights, const rays& through)
        : scene_(scene), lights_(lights), through_(through) {
        for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) {
            const gather_triangle& t = scene.triangles[i];
            const gather_material& m = scene.materials[t.material];
            const float area = 0.5f * glm::length(glm::cross(t.b - t.a, t.c - t.a));
            const double power = static_cast<double>(luminance(m.emission) * pi * area);
            add({source::kind::front, i, power});
            add({source::kind::back, i, m.two_sided != 0 ? power : 0});
        }
        const double disk = static_cast<double>(pi * through.radius() * through.radius());
        add({source::kind::sun, 0, disk * static_cast<double>(luminance(lights.sun))});
        add({source::kind::sky, 0, disk * mean_sky() * 4 * static_cast<double>(pi)});
    }

    [[nodiscard]] double power() const { return sources_.empty() ? 0 : sums_.back(); }

    struct start {
        glm::vec3 origin{0};
        glm::vec3 direction{0};
        glm::vec3 power{0}; ///< W, of one photon of `count`
    };
    /// How photon `i` of `count` begins: sources in turn, by their share of the power.
    [[nodiscard]] start begin(std::uint32_t i, std::uint32_t count, random_sequence& random) const {
        const double at = (i + static_cast<double>(random.next())) / count * power();
        const auto found = std::min<std::ptrdiff_t>(
            std::upper_bound(sums_.begin(), sums_.end(), at) - sums_.begin(),
            std::ssize(sums_) - 1);
        const source& from = sources_[static_cast<std::size_t>(found)];
        start made = from.what == source::kind::sun   ? from_sun(random)
                     : from.what == source::kind::sky ? from_sky(random)
                                                      : from_triangle(from, random);
        // Its power over the chance to be chosen.
        made.power *= static_cast<float>(power() / from.power / count);
        return made;
    }

  private:
    void add(const source& one) {
        if (one.power > 0) {
            sources_.push_back(one);
            sums_.push_back(power_sum_ += one.power);
        }
    }

    [[nodiscard]] double mean_sky() const {
        if (!lights_.sky) {
            return 0;
        }
        double sum = 0;
        constexpr int count = 1024;
        for (int i = 0; i < count; ++i) {
            const auto u = (static_cast<float>(i) + 0.5f) / count;
            sum += static_cast<double>(
                luminance(lights_.sky(any_direction(u, static_cast<float>(i) * 0.61803399f))));
        }
        return sum / count;
    }

    [[nodiscard]] start from_triangle(const source& from, random_sequence& random) const {
        const gather_triangle& t = scene_.triangles[from.triangle];
        const glm::vec3 across = glm::cross(t.b - t.a, t.c - t.a);
        const float size = glm::length(across);
        const float side = from.what == source::kind::back ? -1.0f : 1.0f;
        const glm::vec3 normal = across * (side / size);
        const float away = std::sqrt(random.next());
        const float along = random.next();
        const glm::vec3 at = (1 - away) * t.a + away * (1 - along) * t.b + away * along * t.c;
        start made;
        made.origin = at + through_.lift() * normal;
        const float u = random.next();
        made.direction = cosine_direction(normal, u, random.next());
        made.power = scene_.materials[t.material].emission * (pi * 0.5f * size);
        return made;
    }

    [[nodiscard]] start from_afar(glm::vec3 to_light, random_sequence& random) const {
        start made;
        const float u = random.next();
        const glm::vec3 beside = in_disk(to_light, u, random.next());
        made.origin = through_.centre() + through_.radius() * (beside + 1.01f * to_light);
        made.direction = -to_light;
        return made;
    }

    [[nodiscard]] start from_sun(random_sequence& random) const {
        start made = from_afar(lights_.to_sun, random);
        made.power = lights_.sun * (pi * through_.radius() * through_.radius());
        return made;
    }

    [[nodiscard]] start from_sky(random_sequence& random) const {
        const float u = random.next();
        const glm::vec3 to_sky = any_direction(u, random.next());
        start made = from_afar(to_sky, random);
        made.power = lights_.sky(to_sky) * (4 * pi * pi * through_.radius() * through_.radius());
        return made;
    }

    const surfaces& scene_;
    const far_lights& lights_;
    const rays& through_;
    std::vector<source> sources_;
    std::vector<double> sums_; // of their powers, up to each
    double power_sum_ = 0;
};

/// What some of the photons became.
struct harvest {
    std::vector<photon> photons;
    photon_balance balance;
};

class tracer {
  public:
    tracer(const surfaces& scene, const rays& through, const light_sources& from,
           const photon_options& options)
        : scene_(scene), through_(through), from_(from), options_(options) {}

    [[nodiscard]] harvest trace(std::uint32_t first, std::uint32_t last) const {
        harvest out;
        for (std::uint32_t i = first; i < last; ++i) {
            random_sequence random(options_.seed, i);
            light_sources::start ray = from_.begin(i, options_.photons, random);
            out.balance.emitted += glm::dvec3(ray.power);
            follow(ray, random, out);
        }
        return out;
    }

  private:
    void follow(light_sources::start ray, random_sequence& random, harvest& out) const {
        for (std::uint32_t bounce = 0;; ++bounce) {
            const gather_hit hit = through_.first_hit(ray.origin, ray.direction);
            if (hit.surface == no_surface) {
                out.balance.escaped += glm::dvec3(ray.power);
                return;
            }
            const gather_triangle& t = scene_.triangles[hit.surface / 2];
            const gather_material& m = scene_.materials[t.material];
            if (hit.surface % 2 == 1 && m.two_sided == 0) {
                out.balance.absorbed += glm::dvec3(ray.power);
                return;
            }
            const glm::vec3 across = glm::normalize(glm::cross(t.b - t.a, t.c - t.a));
            const glm::vec3 normal = hit.surface % 2 == 1 ? -across : across;
            const glm::vec3 at = t.a + hit.u * (t.b - t.a) + hit.v * (t.c - t.a);
            out.photons.push_back({at, normal, ray.power});
            const glm::vec3 through = m.two_sided != 0 ? m.transmission : glm::vec3(0);
            if (bounce == options_.most_bounces ||
                !scatter(ray, m, through, normal, at, random, out.balance)) {
                return;
            }
        }
    }

    /// Whether the photon goes on, and how. By roulette its chance is the part of its brightest
    /// colour that goes on, so that photons stay about equally bright (Jensen 1996, 2.1).
    bool scatter(light_sources::start& ray, const gather_material& m, glm::vec3 through,
                 glm::vec3 normal, glm::vec3 at, random_sequence& random,
                 photon_balance& balance) const {
        const glm::vec3 back = ray.power * m.diffuse;
        const glm::vec3 on = ray.power * through;
        balance.absorbed += glm::dvec3(ray.power - back - on);
        const float whole = std::max({ray.power.x, ray.power.y, ray.power.z});
        float p_back = std::max({back.x, back.y, back.z}) / whole;
        float p_on = std::max({on.x, on.y, on.z}) / whole;
        const float over = std::max(1.0f, p_back + p_on);
        p_back /= over;
        p_on /= over;
        const float chance = random.next();
        const float u = random.next();
        const float v = random.next();
        if (chance < p_back) {
            ray = {at + through_.lift() * normal, cosine_direction(normal, u, v), back / p_back};
            return true;
        }
        if (chance < p_back + p_on) {
            ray = {at - through_.lift() * normal, cosine_direction(-normal, u, v), on / p_on};
            return true;
        }
        return false;
    }

    const surfaces& scene_;
    const rays& through_;
    const light_sources& from_;
    const photon_options& options_;
};

constexpr std::uint32_t photons_a_piece = 16384;

} // namespace

struct photon_map::contents {
    photon_cloud cloud;
    photon_balance balance;
    std::uint32_t threads = 0;
    std::unique_ptr<photon_tree> tree;
};

photon_map::photon_map(std::unique_ptr<contents> of) : of_(std::move(of)) {}
photon_map::~photon_map() = default;
photon_map::photon_map(photon_map&&) noexcept = default;
photon_map& photon_map::operator=(photon_map&&) noexcept = default;

result<photon_map> photon_map::trace(const surfaces& scene, const far_lights& lights,
                                     const photon_options& options) {
    if (scene.triangles.empty()) {
        return fail(error_code::bad_input, "A photon map needs triangles: there are none.");
    }
    if (options.photons == 0) {
        return fail(error_code::bad_input, "A photon map needs photons: 0 are asked for.");
    }
    const rays through(scene);
    const light_sources from(scene, lights, through);
    if (!(from.power() > 0)) {
        return fail(error_code::bad_input,
                    "A photon map needs light: nothing emits, and sun and sky are black.");
    }
    const tracer each(scene, through, from, options);
    std::vector<harvest> pieces((options.photons + photons_a_piece - 1) / photons_a_piece);
    for_each_piece(pieces.size(), options.threads, [&](std::size_t i) {
        const auto first = static_cast<std::uint32_t>(i) * photons_a_piece;
        pieces[i] = each.trace(first, std::min(options.photons, first + photons_a_piece));
    });
    auto made = std::make_unique<contents>();
    for (const harvest& piece : pieces) {
        made->cloud.photons.insert(made->cloud.photons.end(), piece.photons.begin(),
                                   piece.photons.end());
        made->balance.emitted += piece.balance.emitted;
        made->balance.absorbed += piece.balance.absorbed;
        made->balance.escaped += piece.balance.escaped;
    }
    made->threads = options.threads;
    made->tree = std::make_unique<photon_tree>(3, made->cloud);
    return photon_map(std::move(made));
}

std::vector<glm::vec4> photon_map::irradiance(std::span<const gather_sample> samples,
                                              std::uint32_t neighbours, float farthest) const {
    std::vector<glm::vec4> out(samples.size(), glm::vec4(0));
    constexpr std::size_t a_piece = 1024;
    for_each_piece((samples.size() + a_piece - 1) / a_piece, of_->threads, [&](std::size_t piece) {
        nearest_facing found(of_->cloud.photons, std::max(2u, neighbours), farthest);
        const std::size_t last = std::min(samples.size(), (piece + 1) * a_piece);
        for (std::size_t i = piece * a_piece; i < last; ++i) {
            found.begin(samples[i].normal);
            of_->tree->findNeighbors(found, &samples[i].position.x, nanoflann::SearchParams());
            out[i] = glm::vec4(found.irradiance(), 0);
        }
    });
    return out;
}

std::span<const photon> photon_map::photons() const { return of_->cloud.photons; }
const photon_balance& photon_map::balance() const { return of_->balance; }

} // namespace skybark::first_pass
