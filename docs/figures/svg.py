"""What both plots are drawn with."""
import math


def text(x, y, words, anchor="middle", size=12):
    return (f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}">'
            f"{words}</text>")


def span(values, margin):
    """Ends of a logarithmic axis, a little beyond the values."""
    low, high = math.log10(min(values)), math.log10(max(values))
    beyond = margin * (high - low) + 0.02
    return low - beyond, high + beyond


def powers(low, high):
    """The powers of ten between the ends of a logarithmic axis."""
    return range(math.ceil(low), math.floor(high) + 1)


def number(value):
    if value >= 1e6:
        return f"{value / 1e6:g} M"
    return f"{value:,.0f}" if value >= 1000 else f"{value:g}"


def line(points, color, dash):
    spots = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return (f'<polyline points="{spots}" fill="none" stroke="{color}" stroke-width="2" '
            f'stroke-dasharray="{dash}"/>')


def dots(points, color, radius):
    return [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{color}"/>' for x, y in points]


def picture(width, height, title, left, parts):
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family="sans-serif" fill="#222">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
        text(left, 26, title, "start", 15), *parts, "</svg>"]) + "\n"
