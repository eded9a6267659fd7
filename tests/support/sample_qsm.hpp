#pragma once
// sample_qsm: the text of a QSM as a scan of a tree gives one, where no real scan is at hand.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace skybark::support {

/// What the text was written from, so that a test need not read it to know it.
struct sample_cylinder {
    double start[3]; ///< m, z up
    double end[3];
    double radius; ///< m
    int id;
    int parent_id; ///< -1 at the root
};

/// A trunk of a few dozen cylinders with boughs and twigs, z up, standing away from the origin.
/// Like real scans it begins with fat cylinders much shorter than they are wide that zigzag, and
/// has joints that turn by more than 90 degrees. `boughs` = 12 gives some 400 cylinders.
inline std::vector<sample_cylinder> sample_cylinders(int boughs = 12) {
    std::vector<sample_cylinder> tree;
    std::uint32_t state = 12345;
    const auto random = [&state] { // in [-1, 1)
        state = state * 1664525u + 1013904223u;
        return static_cast<double>(state >> 8u) / 8388608.0 - 1;
    };
    const auto add = [&tree](int parent, double dx, double dy, double dz, double radius) {
        sample_cylinder c{{-0.3, 2.5, -0.6}, {}, radius, static_cast<int>(tree.size()), parent};
        if (parent >= 0)
            for (int k = 0; k < 3; ++k)
                c.start[k] = tree[static_cast<std::size_t>(parent)].end[k];
        const double step[3] = {dx, dy, dz};
        for (int k = 0; k < 3; ++k)
            c.end[k] = c.start[k] + step[k];
        tree.push_back(c);
        return c.id;
    };
    int trunk = add(-1, 0, 0, 0.05, 0.55);
    for (int i = 0; i < 5; ++i) // fat, short, and back and forth
        trunk = add(trunk, i % 2 == 0 ? 0.2 : -0.2, 0.02 * i, 0.03, 0.53 - 0.01 * i);
    for (int b = 0; b < boughs; ++b) {
        const double thick = 0.4 * (1 - static_cast<double>(b) / boughs) + 0.02;
        trunk = add(trunk, 0.05 * random(), 0.05 * random(), 0.7, thick);
        const double heading = 2.4 * b;
        int bough = trunk;
        for (int i = 0; i < 12; ++i) {
            bough = add(bough, 0.25 * std::cos(heading) + 0.05 * random(),
                        0.25 * std::sin(heading) + 0.05 * random(), 0.1 * random(),
                        thick * 0.3 * (1 - i / 13.0));
            if (i % 2 == 0)
                continue;
            // a twig that starts off backwards: a turn of more than 90 degrees
            int twig = add(bough, -0.1 * std::cos(heading), -0.1 * std::sin(heading), 0.02, 0.005);
            for (int k = 0; k < 2; ++k)
                twig = add(twig, 0.08 * random(), 0.08 * random(), 0.08, 0.0025);
        }
    }
    return tree;
}

/// The cylinders as SimpleForest writes them: its column names, a space after each comma of the
/// header, columns that nobody asked for in between.
inline std::string qsm_text(const std::vector<sample_cylinder>& tree) {
    std::string text = "type, ID, parentID, startX, startY, startZ, endX, endY, endZ, radius, "
                       "volume, FittingType, branchOrder\n";
    char line[512];
    for (const sample_cylinder& c : tree) {
        std::snprintf(line, sizeof line,
                      "cylinder,%d,%d,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,0.1, SPHEREFOLLOWING,0\n",
                      c.id, c.parent_id, c.start[0], c.start[1], c.start[2], c.end[0], c.end[1],
                      c.end[2], c.radius);
        text += line;
    }
    return text;
}

} // namespace skybark::support
