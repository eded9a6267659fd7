#pragma once
// Irradiance caching (Ward, Rubinstein and Clear 1988, "A Ray Tracing Solution for Diffuse
// Interreflection"): irradiance is gathered at sparse points only, and interpolated between them.

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

namespace skybark::benchmarks {

/// Irradiance at a point, and how far away the surfaces are that it sees.
struct cached_irradiance {
    glm::vec3 position{0};
    glm::vec3 normal{0};
    glm::vec3 irradiance{0};
    float spacing = 0; ///< m: harmonic mean of the distances to what is seen
};

/// Their octree: each is in the cell that is two to four times as wide as it reaches.
class irradiance_cache {
  public:
    /// In a cube of `side` m. `accuracy`: what error Ward's formula allows, such as 0.2.
    irradiance_cache(glm::vec3 low, float side, float accuracy)
        : low_(low), side_(side), accuracy_(accuracy), cells_(1) {}

    [[nodiscard]] std::size_t size() const { return records_.size(); }

    void insert(const cached_irradiance& record) {
        const float reach = accuracy_ * record.spacing;
        glm::vec3 low = low_;
        float side = side_;
        std::uint32_t at = 0;
        while (side > 4 * reach) {
            side *= 0.5f;
            const std::uint32_t octant = octant_of(record.position - low, side);
            low += side * corner_of(octant);
            if (cells_[at].children[octant] == 0) {
                cells_[at].children[octant] = static_cast<std::uint32_t>(cells_.size());
                cells_.emplace_back();
            }
            at = cells_[at].children[octant];
        }
        cells_[at].records.push_back(static_cast<std::uint32_t>(records_.size()));
        records_.push_back(record);
    }

    /// Ward's mean, weighted by one over the error; nothing where no record is near enough.
    [[nodiscard]] std::optional<glm::vec3> lookup(glm::vec3 position, glm::vec3 normal) const {
        mean found;
        visit(0, low_, side_, position, normal, found);
        if (found.weights == 0) {
            return std::nullopt;
        }
        return found.sum / found.weights;
    }

  private:
    struct cell {
        std::array<std::uint32_t, 8> children{};
        std::vector<std::uint32_t> records;
    };
    struct mean {
        glm::vec3 sum{0};
        float weights = 0;
    };

    [[nodiscard]] static std::uint32_t octant_of(glm::vec3 offset, float half) {
        return (offset.x >= half ? 1u : 0u) + (offset.y >= half ? 2u : 0u) +
               (offset.z >= half ? 4u : 0u);
    }
    [[nodiscard]] static glm::vec3 corner_of(std::uint32_t octant) {
        return {octant & 1u, octant >> 1 & 1u, octant >> 2};
    }

    void visit(std::uint32_t at, glm::vec3 low, float side, glm::vec3 position, glm::vec3 normal,
               mean& found) const {
        for (const std::uint32_t i : cells_[at].records) {
            add(records_[i], position, normal, found);
        }
        const float half = 0.5f * side;
        for (std::uint32_t octant = 0; octant < 8; ++octant) {
            const std::uint32_t child = cells_[at].children[octant];
            // Records reach out of their cell by half of it at most.
            const glm::vec3 corner = low + half * corner_of(octant);
            const glm::vec3 out = glm::abs(position - (corner + 0.5f * half));
            if (child != 0 && out.x <= half && out.y <= half && out.z <= half) {
                visit(child, corner, half, position, normal, found);
            }
        }
    }

    void add(const cached_irradiance& record, glm::vec3 position, glm::vec3 normal,
             mean& found) const {
        const glm::vec3 offset = position - record.position;
        const float turn = std::sqrt(std::fmax(0.0f, 1 - glm::dot(normal, record.normal)));
        const float error = glm::length(offset) / record.spacing + turn;
        // A record before the point sees what the point does not.
        const bool is_before = glm::dot(offset, normal + record.normal) < -0.02f * record.spacing;
        if (error < accuracy_ && !is_before) {
            const float weight = 1 / std::fmax(error, 1e-6f);
            found.sum += weight * record.irradiance;
            found.weights += weight;
        }
    }

    glm::vec3 low_;
    float side_;
    float accuracy_;
    std::vector<cell> cells_;
    std::vector<cached_irradiance> records_;
};

} // namespace skybark::benchmarks
