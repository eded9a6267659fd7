#pragma once
// Trees to test meshes on: a scan, the built-in species, and scans worse than any.

#include <io/read_qsm.hpp>
#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/species.hpp>

#include "support/random.hpp"
#include "support/sample_qsm.hpp"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace skybark::support {

struct test_tree {
    std::string name;
    trees::skeleton skeleton;
};

[[nodiscard]] inline trees::skeleton built(const std::vector<trees::segment>& segments) {
    auto made = trees::build_skeleton(segments);
    if (!made) {
        throw std::runtime_error(made.error().message);
    }
    return *std::move(made);
}

/// The scanned tree where there is one, else one written like it.
[[nodiscard]] inline test_tree scanned_tree() {
    const char* folder = std::getenv("SKYBARK_TEST_DATA");
    const std::string scan = std::string(folder ? folder : "") + "/small_tree_qsm.csv";
    const bool real = folder != nullptr && std::filesystem::exists(scan);
    const auto read =
        real ? io::read_qsm(scan, io::placement::settled)
             : io::parse_qsm(qsm_text(sample_cylinders()), "sample", io::placement::settled);
    if (!read) {
        throw std::runtime_error(read.error().message);
    }
    return {real ? "scan" : "sample", built(*read)};
}

[[nodiscard]] inline std::vector<test_tree> grown_trees() {
    std::vector<test_tree> trees;
    for (const trees::species_entry& species : trees::all_species()) {
        const auto grown = trees::grow(species.parameters, 1);
        if (!grown) {
            throw std::runtime_error(grown.error().message);
        }
        trees.push_back({std::string(species.name), built(*grown)});
    }
    return trees;
}

/// Segments that turn by anything up to straight back, with gaps, without length, without radius
/// and thicker than long.
[[nodiscard]] inline test_tree wild_scan(std::uint32_t seed, std::uint32_t count = 300) {
    random_source random(seed);
    std::vector<trees::segment> segments;
    std::vector<glm::dvec3> directions;
    for (std::uint32_t i = 0; i < count; ++i) {
        trees::segment s;
        glm::dvec3 direction(0, 1, 0);
        double radius = 0.3;
        if (i > 0) {
            s.parent = random.below(4) == 0 ? random.below(i) : i - 1;
            const double bend = random.between(0, 1) * (random.below(3) == 0 ? 2 : 0.3);
            const glm::dvec3 turned = directions[s.parent] + bend * random.direction();
            direction = random.below(20) == 0 ? -directions[s.parent] : glm::normalize(turned);
            s.base = segments[s.parent].tip;
            radius = std::clamp(double{segments[s.parent].radius}, 0.02, 1.0);
            if (random.below(6) == 0) {
                s.base += glm::vec3(random.direction() * random.between(0, 2 * radius + 0.01));
            }
        }
        const double length = random.below(12) == 0 ? 0 : std::exp2(random.between(-6, 1));
        s.tip = s.base + glm::vec3(direction * length);
        s.base_radius = static_cast<float>(radius);
        const std::uint32_t kind = random.below(15);
        s.radius = static_cast<float>(kind == 0   ? 0
                                      : kind == 1 ? length * random.between(1, 4)
                                                  : radius * random.between(0.8, 1.02));
        directions.push_back(direction);
        segments.push_back(s);
    }
    return {"wild scan " + std::to_string(seed), built(segments)};
}

/// Every species, the scan that there is or what stands for it, and a wild one. Made once.
[[nodiscard]] inline const std::vector<test_tree>& all_trees() {
    static const std::vector<test_tree> all = [] {
        auto trees = grown_trees();
        trees.push_back(scanned_tree());
        trees.push_back(wild_scan(1));
        return trees;
    }();
    return all;
}

} // namespace skybark::support
