"""The error of gathered light against directions and against time: two rows of panels, one column a
scene, all axes logarithmic. Irradiance caches have no directions of their own: they are dots in the
lower row, each an accuracy."""
import math

from rows import read_errors
from svg import dots, line, picture, powers, span, text

METHODS = {"final_gather": ("final_gather", "#1b6ca8", ""),
           "embree_random": ("Embree, random directions", "#b3261e", ""),
           "embree_lattice": ("Embree, evenly spread directions", "#b3261e", "5 4"),
           "irradiance_cache": ("irradiance caching, 256 rays a record", "#3d7d2c", None),
           "irradiance_cache_1024": ("… 1,024 rays", "#8fb339", None)}
SCENES = ["cornell", "park", "canopy"]
WIDTH, HEIGHT, LEFT, TOP, GAP, ROW = 340, 260, 62, 44, 26, 330


def panel(left, top, title, curves, y_span, first):
    """`curves`: {method: [(x, error), …]}"""
    x_span = span([x for points in curves.values() for x, _ in points], 0.05)

    def place(x, y):
        return (left + (math.log10(x) - x_span[0]) / (x_span[1] - x_span[0]) * WIDTH,
                top + HEIGHT - (math.log10(y) - y_span[0]) / (y_span[1] - y_span[0]) * HEIGHT)

    out = [f'<rect x="{left}" y="{top}" width="{WIDTH}" height="{HEIGHT}" fill="none" '
           'stroke="#888"/>', text(left + WIDTH / 2, top + HEIGHT + 36, title)]
    for power in powers(*x_span):
        x, _ = place(10.0 ** power, 1)
        out.append(f'<path d="M{x:.1f} {top}v{HEIGHT}" stroke="#ddd"/>')
        out.append(text(x, top + HEIGHT + 18, f"{10.0 ** power:g}"))
    for power in powers(*y_span):
        _, y = place(1, 10.0 ** power)
        out.append(f'<path d="M{left} {y:.1f}h{WIDTH}" stroke="#ddd"/>')
        if first:
            out.append(text(left - 8, y + 4, f"{10.0 ** power:g}", "end"))
    for method, (_, color, dash) in METHODS.items():
        spots = [place(x, y) for x, y in sorted(curves.get(method, []))]
        if dash is not None and spots:
            out.append(line(spots, color, dash))
        out += dots(spots, color, 2.4 if dash is not None else 4)
    return out


def legend(top, width):
    out, x = [], LEFT
    for words, color, dash in METHODS.values():
        needed = 62 + 6.9 * len(words)
        if x != LEFT and x + needed > width:
            x, top = LEFT, top + 22
        mark = (f'<circle cx="{x + 17}" cy="{top}" r="4" fill="{color}"/>' if dash is None else
                f'<path d="M{x} {top}h34" stroke="{color}" stroke-width="2" '
                f'stroke-dasharray="{dash}"/>')
        out += [mark, text(x + 42, top + 4, words, "start", 13)]
        x += needed
    return out


def draw():
    scenes = read_errors()
    names = [name for name in SCENES if name in scenes]
    y_span = span([e for s in scenes.values() for points in s.values() for _, _, e in points], 0.05)
    width = LEFT + len(names) * (WIDTH + GAP) + 8
    parts = []
    for i, name in enumerate(names):
        left = LEFT + i * (WIDTH + GAP)
        by_directions = {m: [(d, e) for d, _, e in points] for m, points in scenes[name].items()
                         if not m.startswith("irradiance")}
        by_time = {m: [(s, e) for _, s, e in points] for m, points in scenes[name].items()}
        parts += panel(left, TOP, f"{name}: directions", by_directions, y_span, i == 0)
        parts += panel(left, TOP + ROW, f"{name}: seconds", by_time, y_span, i == 0)
    parts += legend(TOP + 2 * ROW + 6, width)
    return picture(width, TOP + 2 * ROW + 58, "Root mean square error of irradiance, over its mean",
                   LEFT, parts)
