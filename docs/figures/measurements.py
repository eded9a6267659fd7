"""What `docs/figures/make --measure` runs, and where it keeps what that says. All commands are here.

{out} stands for the file that a command writes, {folder} for one that is thrown away.
"""
BENCHMARKS = "build/release/bin/skybark_benchmarks"
TOOL = "build/release/bin/skybark"


def benchmark(pattern, repetitions):
    return (f"{BENCHMARKS} --benchmark_filter='{pattern}' --benchmark_repetitions={repetitions} "
            "--benchmark_out={out}")


PAPERS_COUNTS, MILLION = [9382, 32914, 60134], [1000000]


def sizes(counts, but=""):
    """Particles and voxels a side, each by its name: what takes long runs only if it is named."""
    every = [f"{count}_{side}" for count in counts for side in (128, 256, 384)]
    return "(" + "|".join(size for size in every if size != but) + ")"


def meadow(backend, size="1280x720", seconds=0.25, fps=12):
    return (f"{TOOL} meadow --backend {backend} --size {size} --seconds {seconds} --fps {fps} "
            "-o {folder}/meadow_%04d.png --stats {out} --quiet")


# {name: (file in docs/figures/data, [command, …])}: what several commands say goes into one file.
MEASUREMENTS = {
    "meadow_cpu": ("meadow_cpu.json", [meadow("cpu")]),
    "meadow_opengl": ("meadow_opengl.json", [meadow("opengl")]),
    "meadow_vulkan": ("meadow_vulkan.json", [meadow("vulkan")]),
    # Where there is a graphics card: measured if named.
    "meadow_opengl_gpu": ("meadow_opengl_gpu.json", [meadow("opengl", "1920x1080", 4, 30)]),
    "meadow_vulkan_gpu": ("meadow_vulkan_gpu.json", [meadow("vulkan", "1920x1080", 4, 30)]),
    "relight": ("relight.json", [
        benchmark("clouds/(floor/cpu|fit|relight/(harris|impulse_scan|impulse_scan_erf|"
                  f"shadow_polygons_stage)_cpu/{sizes(PAPERS_COUNTS)}|"
                  f"relight/impulse_scan(_erf)?_cpu/{sizes(MILLION)})", 3),
        benchmark(f"clouds/relight/(harris|shadow_polygons_stage)_cpu/{sizes(MILLION)}", 1),
        benchmark("clouds/(floor/(vulkan|opengl)|relight/((harris|impulse_scan|impulse_scan_erf)_"
                  "(vulkan|opengl)|shadow_polygons_stage_vulkan|shadow_polygons_opengl)/60134_256)", 3),
        # Minutes: software.
        benchmark("clouds/relight/((harris|impulse_scan|impulse_scan_erf)_(vulkan|opengl)|"
                  "shadow_polygons_stage_vulkan|shadow_polygons_opengl)/"
                  f"{sizes(PAPERS_COUNTS, but='60134_256')}", 1),
        benchmark(f"clouds/relight/impulse_scan(_erf)?_(vulkan|opengl)/{sizes(MILLION)}", 1),
        benchmark("clouds/relight/shadow_polygons_"
                  "(tiles_copied_degenerate|tiles_drawn_degenerate|layers_compact)_opengl/60134_256", 1)]),
    # Where there is a graphics card: measured if named.
    "relight_gpu": ("relight_gpu.json", [
        benchmark("clouds/(floor/(vulkan|opengl)|relight/(harris|impulse_scan|impulse_scan_erf|"
                  "shadow_polygons_stage|shadow_polygons_layers_compact|"
                  "shadow_polygons_tiles_copied_degenerate)_(vulkan|opengl)/(60134_256|60134_384)|"
                  "frame/.*_(vulkan|opengl)/)", 5)]),
    "cloud_frame": ("cloud_frame.json", [
        benchmark("clouds/frame/.*_cpu/", 3),
        benchmark("clouds/frame/.*_(vulkan|opengl)/20000_", 1)]),
    "relight_curves": ("relight_curves.json", [benchmark("clouds/(by_|floor)", 3)]),
    "bundle": ("bundle.json", [
        benchmark("^gather/bundle/(resolve_.*|embree_(shared|random)|peel_opengl)/", 3)]),
    "gather_error": ("gather_error.csv", [
        "build/release/bin/skybark_gather_error park 1048576 2560 1",
        "build/release/bin/skybark_gather_error canopy 1048576 512 1"]),
    "generate": ("generate.json", [
        benchmark("trees/generate/(floor|cpu|paper)/[0-9]{6,7}/|"
                  "trees/(generate|draw)/(vulkan|opengl|cpu)/1321504/", 5),
        # Some 8 GB of memory.
        benchmark("trees/generate/(cpu|paper)/50000000/", 1)]),
    "sway": ("sway.json", [
        benchmark("trees/sway/(one_core/(15000|100000|1000000)|(opengl|vulkan)/15000)/", 5)]),
    "branch": ("branch.json", [benchmark("trees/branch.*/[14]000000/", 9)]),
}
