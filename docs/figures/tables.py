"""The tables of figures: each function gives one as a list of lines of Markdown."""
import re

from measurements import MEASUREMENTS
from rows import DATA, Rows, read_errors, read_stats

BACKENDS = ["cpu", "opengl", "vulkan"]


def figure(value):
    """Three digits at most; a dash for what wasn't measured."""
    if value is None:
        return "–"
    if value >= 100:
        return f"{value:,.0f}"
    if value >= 10:
        return f"{value:.3g}"
    return f"{value:.1f}" if value >= 1 else f"{value:.2g}"


def ratio(above, below):
    return above / below if above and below else None


def bold(value):
    return "–" if value is None else f"**{figure(value)}**"


def table(head, rows):
    lines = ["| " + " | ".join(row) + " |" for row in [head, *rows]]
    return [lines[0], "|---" * len(head) + "|", *lines[1:]]


def short_name(backend, device):
    """Of a device. Mesa's driver for Vulkan, lavapipe, names its device after that for OpenGL."""
    name = re.split(",| [(]", device)[0]
    return "lavapipe" if backend == "vulkan" and name == "llvmpipe" else name


def on(context, backend):
    """The backend, and the device that it ran on."""
    device = context.get("drivers", {}).get(backend)
    if device is None or backend == "cpu":
        return f"`{backend}`"
    return f"`{backend}` ({short_name(backend, device)})"


def measured(context, measurement):
    """Where and when, and by which command."""
    about = f"{context['date']}, {context['machine']}"
    if "note" in context:
        about += f" ({context['note']})"
    return ["", f"<sub>{about}; again: `docs/figures/make --measure {measurement}`</sub>"]


# ---- The meadow ----------------------------------------------------------------------------------

STAGES = [("sway", "wind and sway"), ("mesh", "all triangles"), ("clouds", "clouds and their light"),
          ("light", "light, gathered"), ("draw", "the picture")]
MEMORY = [("stand", "trees and grass"), ("clouds", "clouds"), ("light", "light"),
          ("picture", "images that are drawn into")]
MEADOW_FILES = [("meadow_cpu.json", "`cpu`"), ("meadow_opengl.json", "`opengl`"),
                ("meadow_vulkan.json", "`vulkan`"), ("meadow_opengl_gpu.json", "`opengl`"),
                ("meadow_vulkan_gpu.json", "`vulkan`")]


def seconds(value):
    if value is None:
        return "–"
    return f"{1e3 * value:.3g} ms" if value < 1 else f"{value:.3g} s"


def mebibytes(value):
    return "–" if value is None else f"{value / 2**20:,.0f} MiB"


def stage_seconds(report, stage):
    """Of one frame."""
    return report["seconds"].get(stage, 0) / report["counts"]["frames"] if report else None


def scene_of(report):
    """What was drawn, on what."""
    context, counts = report.get("context", {}), report["counts"]
    about = [context.get("size", "1280 × 720"), f"{counts['trees']} trees",
             f"{counts['triangles']:,} triangles", f"{counts['particles']:,} particles of clouds",
             f"light at {counts['gather_points']:,} points along {counts['directions']} axes",
             f"{counts['bounces']} bounces"]
    where = [context[key] for key in ("date", "machine") if key in context]
    return "<sub>" + ", ".join(where + about) + "</sub>"


def meadow():
    reports = [(read_stats(file), title) for file, title in MEADOW_FILES]
    # A software driver that wasn't measured yet has its column; a GPU only where there was one.
    reports = [(r, t) for i, (r, t) in enumerate(reports) if r or i < 3]
    heads = [f"{title} ({short_name(r['backend'], r['device'])})" if r else title for r, title in reports]
    frames = [sum(stage_seconds(r, s) for s, _ in STAGES) if r else None for r, _ in reports]
    rows = [[f"{words} (`{stage}`)", *(seconds(stage_seconds(r, stage)) for r, _ in reports)]
            for stage, words in STAGES]
    rows.append(["**a frame**", *(f"**{seconds(f)}**" if f else "–" for f in frames)])
    rows.append(["frames a second", *(figure(1 / f if f else None) for f in frames)])
    rows.append(["once: growing it, and swaying it in", *(seconds(
        r["seconds"]["grow"] + r["seconds"]["settle"]) if r else "–" for r, _ in reports)])
    rows += [[f"memory: {words}", *(mebibytes(r["memory"][part] if r else None) for r, _ in reports)]
             for part, words in MEMORY]
    notes = dict.fromkeys(scene_of(report) for report, _ in reports if report)
    again = "<sub>again: `docs/figures/make --measure meadow_cpu meadow_opengl meadow_vulkan`</sub>"
    return table(["", *heads], rows) + [""] + "<br>\n".join([*notes, again]).split("\n")


# ---- Clouds --------------------------------------------------------------------------------------

COUNTS, SIDES = [9382, 32914, 60134, 1000000], [128, 256, 384]
PAPERS_MOST = 60134  # particles in its table 1


def relight_sizes(rows, method, counts, key="ms", scale=1):
    """For each count: the figures of all volumes."""
    return [" / ".join(figure(rows.get(f"clouds/relight/{method}/{n}_{side}", key, scale)) for side in SIDES)
            for n in counts]


def relight():
    rows = Rows("relight.json")

    def ms(method, count, side, backend="cpu"):
        return rows.get(f"clouds/relight/{method}_{backend}/{count}_{side}")

    lines = [["Harris, 128² / 256² / 384²", *relight_sizes(rows, "harris_cpu", COUNTS), "", ""],
             ["… million particles a second, on one thread",
              *relight_sizes(rows, "harris_cpu", COUNTS, "items_per_second", 1e-6), "", ""],
             ["`shadow_polygons`, 128³ / 256³ / 384³",
              *relight_sizes(rows, "shadow_polygons_stage_cpu", COUNTS), "", ""]]
    for method, words in (("impulse_scan", "step"), ("impulse_scan_erf", "erf")):
        for side in SIDES:
            last = ms(method, PAPERS_MOST, side)
            of_floor = rows.get(f"clouds/relight/{method}_cpu/{PAPERS_MOST}_{side}", "floor")
            lines.append([f"`impulse_scan`, {words}, {side}³",
                          *(bold(ms(method, n, side)) for n in COUNTS), figure(of_floor),
                          figure(ratio(ms("harris", PAPERS_MOST, side), last))])
    lines.append(["fitting the box, on the host, beside it",
                  *(figure(rows.get(f"clouds/fit/{n}")) for n in COUNTS), "", ""])
    head = ["`cpu`, ms", *(f"{n:,} particles" if n == COUNTS[0] else f"{n:,}" for n in COUNTS),
            f"{PAPERS_MOST:,}: × the floor", "× as fast as Harris"]
    return table(head, lines) + measured(rows.context, "relight")


def relight_backends():
    rows = Rows("relight.json")

    def ms(method, backend):
        return rows.get(f"clouds/relight/{method}_{backend}/60134_256")

    order = ["cpu", "vulkan", "opengl"]
    harris = [ms("harris", b) for b in order]
    rectangles = [ms("shadow_polygons_stage", "cpu"), ms("shadow_polygons_stage", "vulkan"),
                  ms("shadow_polygons", "opengl")]
    floors = [rows.get(f"clouds/floor/{b}/256") for b in order]

    def times(words, method, others):
        return [words, *(figure(ratio(other, ms(method, b))) for b, other in zip(order, others))]

    def drawn_way(words, method):
        return [words, "", "", figure(ms(f"shadow_polygons_{method}", "opengl"))]
    lines = [["Harris: one after another, read back", *map(figure, harris)],
             ["`shadow_polygons`: the paper's rectangles (OpenGL's out of a list)", *map(figure, rectangles)],
             drawn_way("… into tiles, padded in the vertex stage, copied", "tiles_copied_degenerate"),
             drawn_way("… the same, the slices drawn from the tiles", "tiles_drawn_degenerate"),
             drawn_way("… into layers, by the geometry stage (its future work)", "layers_compact"),
             ["`impulse_scan`, step", *(bold(ms("impulse_scan", b)) for b in order)],
             ["`impulse_scan`, erf (the default)", *(bold(ms("impulse_scan_erf", b)) for b in order)],
             ["writing the volume once, the floor", *(figure(f) for f in floors)],
             *(times(f"{profile}: × as fast as {against}", method, other)
               for profile, method in (("step", "impulse_scan"), ("erf", "impulse_scan_erf"))
               for against, other in (("Harris", harris), ("`shadow_polygons`", rectangles))),
             ["step: × the floor",
              *(figure(ratio(ms("impulse_scan", b), f)) for b, f in zip(order, floors))]]
    head = ["60,134 particles, 256³, ms", *(on(rows.context, b) for b in order)]
    return table(head, lines) + measured(rows.context, "relight")


def relight_software():
    rows = Rows("relight.json")
    lines = []
    for backend, polygons in (("vulkan", "shadow_polygons_stage"), ("opengl", "shadow_polygons")):
        for method, words in (("harris", "Harris"), (polygons, "`shadow_polygons`"),
                              ("impulse_scan", "`impulse_scan`, step"),
                              ("impulse_scan_erf", "`impulse_scan`, erf")):
            lines.append([f"{on(rows.context, backend)}: {words}",
                          *relight_sizes(rows, f"{method}_{backend}", COUNTS)])
    head = ["128³ / 256³ / 384³, ms", *(f"{n:,} particles" if n == COUNTS[0] else f"{n:,}" for n in COUNTS)]
    return table(head, lines) + measured(rows.context, "relight")


def relight_gpu():
    if not (DATA / "relight_gpu.json").exists():
        return ["On a graphics card: not measured yet. `docs/figures/make --measure relight_gpu` fills this in where "
                "there is one."]
    rows = Rows("relight_gpu.json")

    def ms(method):
        return [figure(rows.get(f"clouds/relight/{method}_{b}/60134_{side}"))
                for b in ("vulkan", "opengl") for side in (256, 384)]
    lines = [["Harris: one after another, read back", *ms("harris")],
             ["`shadow_polygons`", *ms("shadow_polygons_stage")],
             ["… into tiles, padded in the vertex stage, copied", *ms("shadow_polygons_tiles_copied_degenerate")],
             ["… into layers, by the geometry stage", *ms("shadow_polygons_layers_compact")],
             ["`impulse_scan`, step", *ms("impulse_scan")],
             ["`impulse_scan`, erf (the default)", *ms("impulse_scan_erf")],
             ["writing the volume once", *(figure(rows.get(f"clouds/floor/{b}/{side}"))
                                           for b in ("vulkan", "opengl") for side in (256, 384))]]
    head = ["60,134 particles, ms", *(f"{on(rows.context, b)}, {side}³"
                                      for b in ("vulkan", "opengl") for side in (256, 384))]
    frames = frame_table(rows, [(b, size) for b in ("vulkan", "opengl") for size in FRAME_SIZES])
    return table(head, lines) + [""] + frames + measured(rows.context, "relight_gpu")


FRAME_SIZES = {"60134_256": "60,134 particles, 256³", "20000_128": "20,000, 128³"}


def frame_table(rows, order):
    """A column for each (backend, size)."""
    parts = [("relight", "the sun's volume (`impulse_scan`, erf)"),
             ("scatter", "what is scattered more than once (`multiple_scattering`)"),
             ("draw", "`cloud_billboards`, 1280 × 720"), ("torn", "`torn_billboards`, the same"),
             ("all", "**all: two volumes, scattering, `cloud_billboards`**")]
    lines = [[words, *(figure(rows.get(f"clouds/frame/{part}_{backend}/{size}"))
                       for backend, size in order)] for part, words in parts]
    return table(["a cumulus, ms", *(f"{on(rows.context, b)}: {FRAME_SIZES[size]}" for b, size in order)], lines)


def cloud_frame():
    rows = Rows("cloud_frame.json")
    order = [("cpu", "60134_256"), ("cpu", "20000_128"), ("vulkan", "20000_128"), ("opengl", "20000_128")]
    return frame_table(rows, order) + measured(rows.context, "cloud_frame")


# ---- Gathered light ------------------------------------------------------------------------------

SCENES = [("cornell", "box (36 triangles)", "box"), ("park", "park (202,560)", "park"),
          ("canopy", "canopy (199,200)", "canopy")]


def bundle():
    rows = Rows("bundle.json")
    lines = []
    for samples in (65536, 1048576):
        for scene, words, short in SCENES:
            def rate(method):
                return rows.get(f"gather/bundle/{method}/{scene}_{samples}", "items_per_second", 1e-6)
            cpu, shared = rate("resolve_cpu"), rate("embree_shared")
            times = f" ({ratio(cpu, shared):.2f})" if cpu and shared else ""
            lines.append([f"{words if samples == 65536 else short}, {samples:,}", bold(cpu) + times,
                          *(figure(rate(m)) for m in ("embree_shared", "embree_random",
                                                      "resolve_vulkan", "resolve_opengl",
                                                      "peel_opengl"))])
    head = ["points", "`resolve` on `cpu`", "Embree, shared", "Embree, random", "`resolve` on `vulkan`",
            "`opengl`", "`peel` (the document's) on `opengl`"]
    return table(head, lines) + measured(rows.context, "bundle")


def gather_error():
    scenes = read_errors()
    counts = [8, 32, 128, 512, 2048]
    methods = [("final_gather", "bundles"), ("embree_random", "random rays of each point's own"),
               ("embree_lattice", "evenly spread rays of each point's own")]
    lines = []
    for scene in ("park", "canopy"):
        for method, words in methods:
            of = {int(d): e for d, _, e in scenes[scene].get(method, [])}
            lines.append([f"{scene}, {words}",
                          *(figure(100 * of[n]) if n in of else "" for n in counts)])
    return table(["directions", *(f"{n:,}" for n in counts)], lines)


# ---- Trees ---------------------------------------------------------------------------------------

def generate():
    rows = Rows("generate.json")
    lines = []
    sizes = sorted({int(name.split("/")[3]) for name in rows.medians if "/generate/" in name})
    for n in sizes:
        def rate(method):
            return rows.get(f"trees/generate/{method}/{n}", "triangles", 1e-6)
        lines.append([f"{n:,}" + (", one run" if n == 50000000 else ""), bold(rate("cpu")),
                      figure(rate("paper")), figure(ratio(rate("cpu"), rate("paper"))),
                      figure(rate("floor"))])
    head = ["polygons", "`cpu`", "the paper's CPU path", "ratio", "writing the bytes alone"]
    return table(head, lines) + measured(rows.context, "generate")


def drawn():
    rows = Rows("generate.json")
    size = 1321504
    lines = [["all triangles anew, million a second",
              *(figure(rows.get(f"trees/generate/{b}/{size}", "triangles", 1e-6)) for b in BACKENDS)],
             ["drawing them, 1280 × 800, ms",
              *(figure(rows.get(f"trees/draw/{b}/{size}")) for b in BACKENDS)]]
    head = [f"{size:,} polygons", *(on(rows.context, b) for b in BACKENDS)]
    return table(head, lines) + measured(rows.context, "generate")


def sway():
    rows = Rows("sway.json")
    lines = []
    for name, words in (("one_core", "`cpu`, one core"), ("opengl", on(rows.context, "opengl")),
                        ("vulkan", on(rows.context, "vulkan"))):
        lines.append([words, *(figure(rows.get(f"trees/sway/{name}/{n}"))
                               for n in (15000, 100000, 1000000))])
    head = ["one dynamic step, ms", "15,000 joints", "100,000", "1,000,000"]
    return table(head, lines) + measured(rows.context, "sway")


def branch():
    rows = Rows("branch.json")
    lines = []
    for name, words in (("branch/floor", "writing the bytes, two threads"), ("branch/cpu", "`cpu`, rings"),
                        ("branch/vulkan", on(rows.context, "vulkan") + ", rings"),
                        ("branch/opengl", on(rows.context, "opengl") + ", rings as points"),
                        ("branch/paper", "the paper's loop, one thread, rings"),
                        ("branch_list/vulkan", "`vulkan`, triangle list"),
                        ("branch_list/opengl", "`opengl`, triangle strips, as in the paper")):
        def get(n, key, scale):
            return rows.get(f"trees/{name}/{n}", key, scale)
        sizes = (1000000, 4000000)
        floors = ", ".join(f"{get(n, 'floor', 100) or 0:.0f} %" for n in sizes)
        lines.append([words, *((bold if name == "branch/cpu" else figure)(get(n, "triangles", 1e-6))
                               for n in sizes), "" if name == "branch/floor" else floors])
    head = ["million triangles a second", "1 million", "4 million",
            "bytes, of the floor measured beside the row"]
    return table(head, lines) + measured(rows.context, "branch")


# ---- Together ------------------------------------------------------------------------------------

def headline():
    clouds, rays = Rows("relight.json"), Rows("bundle.json")
    trees, steps, wood = Rows("generate.json"), Rows("sway.json"), Rows("branch.json")
    relit = clouds.get("clouds/relight/impulse_scan_cpu/60134_256")
    through = clouds.get("clouds/relight/impulse_scan_erf_cpu/60134_256")
    harris = clouds.get("clouds/relight/harris_cpu/60134_256")
    park = rays.get("gather/bundle/resolve_cpu/park_1048576", "items_per_second", 1e-6)
    embree = rays.get("gather/bundle/embree_shared/park_1048576", "items_per_second", 1e-6)
    grown = trees.get("trees/generate/cpu/1321504", "triangles", 1e-6)
    paper = trees.get("trees/generate/paper/1321504", "triangles", 1e-6)
    swayed = steps.get("trees/sway/one_core/15000")
    rings = wood.get("trees/branch/cpu/1000000", "triangles", 1e-6)
    floor = wood.get("trees/branch/cpu/1000000", "floor", 100)
    lines = [["a cloud's light, made anew: 60,134 particles, 256³ voxels, the paper's profile",
              f"{figure(relit)} ms",
              f"{figure(ratio(harris, relit))} × as fast as Harris and Lastra's pass", "relight"],
             ["the same, integrated through each particle (the default)", f"{figure(through)} ms",
              f"{figure(ratio(harris, through))} ×", "relight"],
             ["rays in bundles: a million points in a park of 202,560 triangles",
              f"{figure(park)} million rays a second",
              f"{ratio(park, embree):.2f} × Embree's, whose hierarchy is built beforehand", "bundle"],
             ["trees with bark and leaves, swayed and meshed anew: 1,321,504 triangles",
              f"{figure(grown)} million triangles a second",
              f"{figure(ratio(grown, paper))} × the paper's algorithm as a plain loop", "generate"],
             ["branches alone, a million triangles", f"{figure(rings)} million triangles a second",
              f"{figure(floor)} % of writing the bytes and nothing else", "branch"],
             ["one step of sway, 15,000 joints, one core", f"{figure(swayed)} ms",
              f"{1e6 * swayed / 15000:.0f} ns a joint", "sway"]]
    return table(["on `cpu`", "figure", "beside it", "`docs/figures/make --measure …`"],
                 [[*line[:3], f"`{line[3]}`"] for line in lines]) + [
        "", f"<sub>{clouds.context['date']}, {clouds.context['machine']}, medians</sub>"]


def commands():
    lines = []
    for name, (_, each) in MEASUREMENTS.items():
        lines += [f"# {name}", *each]
    return ["```", *(line.replace("{out}", "OUT").replace("{folder}", "FOLDER") for line in lines),
            "```"]


TABLES = {of.__name__: of for of in (headline, meadow, relight, relight_backends, relight_software,
                                     relight_gpu, cloud_frame, bundle, gather_error, generate, drawn,
                                     sway, branch, commands)}
