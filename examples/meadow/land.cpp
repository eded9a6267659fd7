#include "land.hpp"

#include <scenes/random.hpp>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>

namespace skybark::meadow {

namespace {

constexpr double turn = 2 * std::numbers::pi;
constexpr double hills_begin = 110; ///< m from the origin: no hills within
constexpr double hills_full = 2200; ///< m: from there on they are as high as they get

} // namespace

land::land(std::uint64_t seed) {
    scenes::random_numbers random(static_cast<std::uint32_t>(seed ^ (seed >> 32)));
    const auto vary = [&](float by) { return static_cast<double>(random.between(-by, by)); };
    // Headings are spread evenly and then disturbed, so that no two swells run alike.
    const auto fill = [&](std::span<swell> all, double longest, double step, double height,
                          double fall) {
        double heading = static_cast<double>(random.between(0, 1)) * turn;
        for (swell& each : all) {
            const double length = longest * (1 + vary(0.12f));
            each.x = turn / length * std::cos(heading);
            each.z = turn / length * std::sin(heading);
            each.phase = static_cast<double>(random.between(0, 1)) * turn;
            each.height = height;
            heading += 2.39996322972865332 + vary(0.4f);
            longest *= step;
            height *= fall;
        }
    };
    fill(floor_, 118, 0.66, 0.62, 0.63);
    fill(hills_, 5200, 0.71, 34, 0.76);
}

land::point land::at(double x, double z) const {
    const auto sum_of = [&](std::span<const swell> all, point start) {
        for (const swell& each : all) {
            const double phase = each.x * x + each.z * z + each.phase;
            const double slope = each.height * std::cos(phase);
            start.height += each.height * std::sin(phase);
            start.dx += slope * each.x;
            start.dz += slope * each.z;
        }
        return start;
    };
    point sum = sum_of(floor_, {});
    const double far = std::sqrt(x * x + z * z);
    if (far <= hills_begin) {
        return sum;
    }
    // A smoothstep in the logarithm of the distance: hills rise gently and go on rising.
    const double span = std::log(hills_full / hills_begin);
    const double t = std::min(std::log(far / hills_begin) / span, 1.0);
    const double part = t * t * (3 - 2 * t);
    const double steep = t < 1 ? 6 * t * (1 - t) / (span * far * far) : 0; // d part / d x, over x
    const point hills = sum_of(hills_, {38, 0, 0});
    sum.height += part * hills.height;
    sum.dx += part * hills.dx + steep * x * hills.height;
    sum.dz += part * hills.dz + steep * z * hills.height;
    return sum;
}

float land::height(float x, float z) const {
    return static_cast<float>(at(static_cast<double>(x), static_cast<double>(z)).height);
}

glm::vec3 land::normal(float x, float z) const {
    const point p = at(static_cast<double>(x), static_cast<double>(z));
    return glm::vec3(glm::normalize(glm::dvec3(-p.dx, 1, -p.dz)));
}

namespace {

/// The vertices of the grid's border, once around, against the clock seen from above.
std::vector<std::uint32_t> border_of(std::uint32_t points) {
    std::vector<std::uint32_t> border;
    const std::uint32_t last = points - 1;
    const auto add = [&](std::uint32_t column, std::uint32_t row) {
        border.push_back(row * points + column);
    };
    for (std::uint32_t i = 0; i < last; ++i) {
        add(0, i); // west, southwards
    }
    for (std::uint32_t i = 0; i < last; ++i) {
        add(i, last); // south, eastwards
    }
    for (std::uint32_t i = last; i > 0; --i) {
        add(last, i); // east, northwards
    }
    for (std::uint32_t i = last; i > 0; --i) {
        add(i, 0); // north, westwards
    }
    return border;
}

} // namespace

land_mesh land::mesh() const {
    land_mesh made;
    const std::vector<std::uint32_t> border = border_of(points);
    const auto around = static_cast<std::uint32_t>(border.size());
    made.vertices.reserve(std::size_t{points} * points + std::size_t{rings} * around);
    const auto add = [&](float x, float z, std::uint32_t shown) {
        surface_vertex v;
        v.position = on(x, z);
        v.normal = normal(x, z);
        v.u = static_cast<float>(shown);
        const glm::vec3 east(v.normal.y, -v.normal.x, 0);
        v.tangent = glm::vec4(glm::normalize(east), 1);
        made.vertices.push_back(v);
    };
    const float step = side / static_cast<float>(points - 1);
    for (std::uint32_t row = 0; row < points; ++row) {
        for (std::uint32_t column = 0; column < points; ++column) {
            add(step * static_cast<float>(column) - side / 2,
                step * static_cast<float>(row) - side / 2, row * points + column);
        }
    }
    const double growth = std::pow(static_cast<double>(horizon) / (side / 2.0), 1.0 / rings);
    for (std::uint32_t ring = 1; ring <= rings; ++ring) {
        const auto scale = static_cast<float>(std::pow(growth, ring));
        for (const std::uint32_t shown : border) {
            const glm::vec3 from = made.vertices[shown].position;
            add(from.x * scale, from.z * scale, shown);
        }
    }
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        made.indices.insert(made.indices.end(), {a, b, c, a, c, d});
    };
    for (std::uint32_t row = 0; row + 1 < points; ++row) {
        for (std::uint32_t column = 0; column + 1 < points; ++column) {
            const std::uint32_t at = row * points + column;
            quad(at, at + points, at + points + 1, at + 1);
        }
    }
    for (std::uint32_t ring = 0; ring < rings; ++ring) {
        const std::uint32_t outer = points * points + ring * around;
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t next = (i + 1) % around;
            const auto inner = [&](std::uint32_t k) {
                return ring == 0 ? border[k] : outer - around + k;
            };
            quad(inner(i), outer + i, outer + next, inner(next));
        }
    }
    return made;
}

void land::add_light_triangles(std::vector<gather_triangle>& to, std::uint32_t material) const {
    const float step = side / static_cast<float>(light_cells);
    const auto corner = [&](std::uint32_t column, std::uint32_t row) {
        return on(step * static_cast<float>(column) - side / 2,
                  step * static_cast<float>(row) - side / 2);
    };
    const auto add = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c) {
        gather_triangle t;
        t.a = a;
        t.material = material;
        t.b = b;
        t.c = c;
        to.push_back(t);
    };
    for (std::uint32_t row = 0; row < light_cells; ++row) {
        for (std::uint32_t column = 0; column < light_cells; ++column) {
            const glm::vec3 a = corner(column, row);
            const glm::vec3 b = corner(column, row + 1);
            const glm::vec3 c = corner(column + 1, row + 1);
            const glm::vec3 d = corner(column + 1, row);
            add(a, b, c);
            add(a, c, d);
        }
    }
}

float land::light_height(float x, float z) const {
    const float step = side / static_cast<float>(light_cells);
    const glm::vec2 at = glm::vec2(x + side / 2, z + side / 2) / step;
    const glm::vec2 cell = glm::clamp(glm::floor(at), 0.0f, static_cast<float>(light_cells - 1));
    const glm::vec2 part = at - cell;
    const auto corner = [&](float column, float row) {
        return height(step * (cell.x + column) - side / 2, step * (cell.y + row) - side / 2);
    };
    const float low = corner(0, 0);
    const float high = corner(1, 1);
    if (part.y >= part.x) {
        const float south = corner(0, 1);
        return low + (south - low) * part.y + (high - south) * part.x;
    }
    const float east = corner(1, 0);
    return low + (east - low) * part.x + (high - east) * part.y;
}

} // namespace skybark::meadow
