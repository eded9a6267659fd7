#include <first_pass/form_factor.hpp>
#include <first_pass/radiosity.hpp>
#include <first_pass/random.hpp>
#include <first_pass/rays.hpp>
#include <first_pass/threads.hpp>

#include <string>
#include <utility>

namespace skybark::first_pass {

namespace {

class solver {
  public:
    solver(const surfaces& scene, std::span<const patch_table> tables, const far_lights& lights,
           const radiosity_options& options)
        : scene_(scene), lights_(lights), options_(options), rays_(scene),
          patches_(patches_of(scene, tables)), irradiance_(patches_.size(), glm::vec3(0)),
          unshot_(patches_.size(), glm::vec3(0)) {}

    [[nodiscard]] radiosity_solution solve() {
        each_patch([&](std::size_t i) { irradiance_[i] = from_afar(i); });
        each_patch(
            [&](std::size_t i) { unshot_[i] = material(i).emission + scattered(i, irradiance_); });
        const double first = light_to_give();
        radiosity_solution out;
        std::vector<glm::vec3> arrived(patches_.size());
        double left = first;
        while (out.shots < options_.most_shots && left > options_.left * first) {
            const std::size_t brightest = most_to_give();
            const glm::vec3 radiance = std::exchange(unshot_[brightest], glm::vec3(0));
            each_patch([&](std::size_t i) { arrived[i] = from_patch(brightest, radiance, i); });
            each_patch([&](std::size_t i) {
                irradiance_[i] += arrived[i];
                unshot_[i] += scattered(i, arrived);
            });
            ++out.shots;
            left = light_to_give();
        }
        out.left = first > 0 ? left / first : 0;
        out.irradiance.resize(patches_.size());
        each_patch([&](std::size_t i) { out.irradiance[i] = glm::vec4(irradiance_[i], 0); });
        out.radiance = leaving_radiance(scene_, patches_, out.irradiance);
        return out;
    }

  private:
    static constexpr std::size_t patches_a_piece = 64;

    template <class Work>
    void each_patch(Work&& work) const {
        const std::size_t pieces = (patches_.size() + patches_a_piece - 1) / patches_a_piece;
        for_each_piece(pieces, options_.threads, [&](std::size_t piece) {
            const std::size_t last = std::min(patches_.size(), (piece + 1) * patches_a_piece);
            for (std::size_t i = piece * patches_a_piece; i < last; ++i) {
                work(i);
            }
        });
    }

    [[nodiscard]] const gather_material& material(std::size_t i) const {
        return scene_.materials[scene_.triangles[patches_[i].triangle].material];
    }

    /// The radiance that patch i sends on of this irradiance.
    [[nodiscard]] glm::vec3 scattered(std::size_t i, std::span<const glm::vec3> of) const {
        const glm::vec3 behind =
            patches_[i].other == no_surface ? glm::vec3(0) : of[patches_[i].other];
        return (material(i).diffuse * of[i] + material(i).transmission * behind) / pi;
    }

    [[nodiscard]] double flux(std::size_t i) const {
        return static_cast<double>(pi * patches_[i].area * luminance(unshot_[i]));
    }
    [[nodiscard]] double light_to_give() const {
        double sum = 0;
        for (std::size_t i = 0; i < patches_.size(); ++i) {
            sum += flux(i);
        }
        return sum;
    }
    [[nodiscard]] std::size_t most_to_give() const {
        std::size_t most = 0;
        for (std::size_t i = 1; i < patches_.size(); ++i) {
            most = flux(i) > flux(most) ? i : most;
        }
        return most;
    }

    [[nodiscard]] glm::vec3 origin_of(const patch& p) const {
        return p.middle() + rays_.lift() * p.normal;
    }

    /// Irradiance at a patch by sun and sky.
    [[nodiscard]] glm::vec3 from_afar(std::size_t i) const {
        const patch& p = patches_[i];
        if (p.area <= 0) {
            return glm::vec3(0);
        }
        const float reach = 4 * rays_.radius();
        glm::vec3 sum(0);
        const float cosine = glm::dot(p.normal, lights_.to_sun);
        if (cosine > 0 && lights_.sun != glm::vec3(0) &&
            rays_.is_clear(origin_of(p), lights_.to_sun, reach)) {
            sum += cosine * lights_.sun;
        }
        if (!lights_.sky || options_.sky_rays == 0) {
            return sum;
        }
        random_sequence random(options_.seed, i);
        const float u = random.next();
        const float v = random.next();
        glm::vec3 sky(0);
        for (std::uint32_t k = 0; k < options_.sky_rays; ++k) {
            const glm::vec2 at = spread(k, u, v);
            const glm::vec3 direction = cosine_direction(p.normal, at.x, at.y);
            if (rays_.is_clear(origin_of(p), direction, reach)) {
                sky += lights_.sky(direction);
            }
        }
        return sum + sky * (pi / static_cast<float>(options_.sky_rays));
    }

    /// Irradiance at the middle of patch `to` by patch `from`, which gives this radiance.
    [[nodiscard]] glm::vec3 from_patch(std::size_t from, glm::vec3 radiance, std::size_t to) const {
        const patch& light = patches_[from];
        const patch& p = patches_[to];
        const glm::vec3 origin = origin_of(p);
        if (to == from || p.area <= 0 || glm::dot(light.normal, origin - light.corners[0]) <= 0) {
            return glm::vec3(0);
        }
        const double seen = form_factor(glm::dvec3(origin), glm::dvec3(p.normal), light.corners);
        if (seen <= 1e-12) {
            return glm::vec3(0);
        }
        return radiance * (pi * static_cast<float>(seen) * visibility(origin, light, to));
    }

    /// The part of rays from a point, to places all over a patch, that get there.
    [[nodiscard]] float visibility(glm::vec3 origin, const patch& light, std::size_t to) const {
        random_sequence random(options_.seed, patches_.size() + to);
        const float u = random.next();
        const float v = random.next();
        std::uint32_t through = 0;
        for (std::uint32_t k = 0; k < options_.visibility_rays; ++k) {
            const glm::vec2 at = spread(k, u, v);
            const float away = std::sqrt(at.x);
            const glm::vec3 place = (1 - away) * light.corners[0] +
                                    away * (1 - at.y) * light.corners[1] +
                                    away * at.y * light.corners[2] + rays_.lift() * light.normal;
            const float distance = glm::distance(origin, place);
            through +=
                distance <= 0 || rays_.is_clear(origin, (place - origin) / distance, distance);
        }
        return static_cast<float>(through) / static_cast<float>(options_.visibility_rays);
    }

    /// Point k of a sequence that fills the unit square evenly: Roberts' R2, shifted.
    [[nodiscard]] static glm::vec2 spread(std::uint32_t k, float u, float v) {
        const auto n = static_cast<double>(k) + 0.5;
        const double x = static_cast<double>(u) + 0.7548776662466927 * n;
        const double y = static_cast<double>(v) + 0.5698402909980532 * n;
        return {static_cast<float>(x - std::floor(x)), static_cast<float>(y - std::floor(y))};
    }

    surfaces scene_;
    const far_lights& lights_;
    radiosity_options options_;
    rays rays_;
    std::vector<patch> patches_;
    std::vector<glm::vec3> irradiance_;
    std::vector<glm::vec3> unshot_; ///< radiance that a patch has yet to give
};

} // namespace

result<radiosity_solution> radiosity(const surfaces& scene, std::span<const patch_table> tables,
                                     const far_lights& lights, const radiosity_options& options) {
    if (scene.triangles.empty()) {
        return fail(error_code::bad_input, "Radiosity needs triangles: there are none.");
    }
    if (tables.size() != scene.triangles.size()) {
        return fail(error_code::bad_input, "Radiosity needs a patch table a triangle: there are " +
                                               std::to_string(tables.size()) + " tables and " +
                                               std::to_string(scene.triangles.size()) +
                                               " triangles.");
    }
    return solver(scene, tables, lights, options).solve();
}

} // namespace skybark::first_pass
