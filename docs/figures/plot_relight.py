"""What a change of a cloud's light costs: milliseconds against the number of particles, their
radius, and the voxels along a side. Both axes are logarithmic."""
import math

from rows import Rows
from svg import dots, line, number, picture, powers, span, text

PANELS = [("particles", "particles (radius 3 % of the box, 128³ voxels)", 1),
          ("radius", "radius, % of the box (16,000 particles, 128³ voxels)", 0.1),
          ("volume", "voxels along a side (16,000 particles, radius 3 %)", 1)]
COLORS = {"cpu": "#1b6ca8", "vulkan": "#b3261e", "opengl": "#3d7d2c"}
DASHES = {"impulse_scan": "", "impulse_scan_erf": "12 3", "shadow_polygons": "7 4", "harris": "2 3", "floor": "1 6"}
NAMES = {"cpu": "CPU", "vulkan": "Vulkan", "opengl": "OpenGL", "impulse_scan": "impulse_scan, step",
         "impulse_scan_erf": "erf", "shadow_polygons": "shadow_polygons", "harris": "Harris", "floor": "writing the volume once"}
WIDTH, HEIGHT, LEFT, TOP, GAP, BOTTOM = 370, 400, 56, 44, 62, 104


def read():
    """{panel: {(method, backend): [(x, ms), …]}}"""
    panels = {}
    for name, row in Rows("relight_curves.json").medians.items():
        parts = name.split("/")
        if parts[1] == "floor":
            panel, curve, x = "volume", ("floor", parts[2]), parts[3]
        else:
            panel, curve, x = parts[1].removeprefix("by_"), tuple(parts[2].rsplit("_", 1)), parts[3]
        panels.setdefault(panel, {}).setdefault(curve, []).append((float(x), row["ms"]))
    return panels


def axes(left, title, values, x_span, y_span, first, place):
    out = [f'<rect x="{left}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>',
           text(left + WIDTH / 2, TOP + HEIGHT + 40, title)]
    for value in values:
        x, _ = place(math.log10(value), y_span[0])
        out.append(f'<path d="M{x:.1f} {TOP}v{HEIGHT}" stroke="#ddd"/>')
        out.append(text(x, TOP + HEIGHT + 18, number(value)))
    for power in powers(*y_span):
        _, y = place(x_span[0], power)
        out.append(f'<path d="M{left} {y:.1f}h{WIDTH}" stroke="#ddd"/>')
        if first:
            out.append(text(left - 8, y + 4, number(10.0 ** power), "end"))
    return out


def panel(left, title, curves, unit, y_span, first):
    values = sorted({x * unit for points in curves.values() for x, _ in points})
    x_span = span(values, 0.04)

    def place(x, y):
        return (left + (x - x_span[0]) / (x_span[1] - x_span[0]) * WIDTH,
                TOP + HEIGHT - (y - y_span[0]) / (y_span[1] - y_span[0]) * HEIGHT)

    out = axes(left, title, values, x_span, y_span, first, place)
    for (method, backend), points in sorted(curves.items()):
        spots = [place(math.log10(x * unit), math.log10(y)) for x, y in sorted(points)]
        out.append(line(spots, COLORS[backend], DASHES[method]))
        if method != "floor":
            out += dots(spots, COLORS[backend], 2.6)
    return out


def legend(top, methods):
    out, x = [], LEFT
    entries = [(NAMES[b], COLORS[b], "") for b in COLORS]
    entries += [(NAMES[m], "#444", DASHES[m]) for m in DASHES if m in methods]
    for words, color, dash in entries:
        out.append(f'<path d="M{x} {top}h34" stroke="{color}" stroke-width="2" '
                   f'stroke-dasharray="{dash}"/>')
        out.append(text(x + 42, top + 4, words, "start", 13))
        x += 66 + 7.4 * len(words)
    return out


def draw():
    panels = read()
    every = [y for curves in panels.values() for points in curves.values() for _, y in points]
    parts = []
    for i, (name, title, unit) in enumerate(PANELS):
        parts += panel(LEFT + i * (WIDTH + GAP // 2), title, panels[name], unit, span(every, 0.04),
                       i == 0)
    methods = {method for curves in panels.values() for method, _ in curves}
    parts += legend(TOP + HEIGHT + 76, methods)
    width = LEFT + len(PANELS) * WIDTH + (len(PANELS) - 1) * GAP // 2 + 24
    return picture(width, TOP + HEIGHT + BOTTOM, "Milliseconds for a change of light", LEFT, parts)
