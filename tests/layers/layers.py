#!/usr/bin/env python3
"""Includes go one way: records <- shared <- core <- kernels <- algorithms; backends -> core, kernels;
conformance -> anything under include/. Nothing outside but what a room is listed with.

    layers.py              checks every header under include/ and backends/
    layers.py --self-test  checks that planted violations are found
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BACKENDS = {"cpu", "opengl", "vulkan"}
# What each room may include; any other room under include/ is an algorithm's. The records of core
# are a room of their own, below the formulas that work on them; glsl is texts, for others' compilers.
GROUND = {"glsl": set(),
          "records": set(),
          "shared": {"records", "shared"},
          "core": {"records", "shared", "core"},
          "kernels": {"records", "shared", "core", "kernels"}}

STANDARD = r"[a-z0-9_]+"  # <vector>, <cstdint>: the standard's names have no dot and no slash
EVERYWHERE = rf"{STANDARD}|glm/.*|tl/expected\.hpp"
# The cpu backend asks the system and the processor what they have, where they can be asked.
EXTRA = {"cpu": r"[a-z]+intrin\.h|arm_neon\.h|cpuid\.h|unistd\.h|sys/mman\.h",
         "opengl": r"[a-z]+intrin\.h",
         "vulkan": r"vulkan/.*|[a-z]+intrin\.h",
         "conformance": r"gtest/.*"}
# Only headless.hpp makes devices and contexts, so only it meets the window system and the loader.
HEADLESS = r"EGL/.*|GLFW/.*|GL/osmesa\.h|dlfcn\.h"


def room_of(header):
    """skybark/core/result.hpp -> core; skybark/skybark.hpp, the umbrella -> ''."""
    if header == "skybark/core/records.hpp":
        return "records"
    parts = header.split("/")
    return parts[1] if len(parts) > 2 else ""


def may_include(root, room, other):
    """Whether a header in `room` of `root` may include one in the room `other` of the library."""
    if root == "backends":
        if other in BACKENDS:
            return other == room
        return other in GROUND["kernels"] or (ROOT / "backends/skybark" / other).is_dir()
    if other in BACKENDS:
        return False
    if room == "conformance":
        return True
    if room == "":
        return other != "conformance"
    return other in GROUND.get(room, GROUND["kernels"] | {room})


def complaints(path, text):
    """Yields a sentence for each #include of the header `path` that breaks a rule."""
    root, header = path.split("/", 1)
    room = room_of(header)
    outside = "|".join(filter(None, [
        EVERYWHERE, EXTRA.get(room), HEADLESS if "headless" in path else None]))
    for number, line in enumerate(text.splitlines(), 1):
        found = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
        if not found:
            continue
        quote, name = found.groups()
        where = f"{path}:{number}: "
        if quote == '"':
            yield where + f'write <skybark/…> instead of "{name}", which depends on the folder.'
        elif name.startswith("skybark/"):
            if not may_include(root, room, room_of(name)):
                yield where + f"{room or 'the umbrella'} must not include <{name}>."
        elif not re.fullmatch(outside, name):
            yield where + f"{room or 'the umbrella'} must not include <{name}> from outside."


GOOD = [("include/skybark/core/a.hpp", "skybark/core/b.hpp"),
        ("include/skybark/shared/a.hpp", "skybark/core/records.hpp"),
        ("include/skybark/kernels/a.hpp", "skybark/shared/b.hpp"),
        ("include/skybark/trees/a.hpp", "skybark/kernels/b.hpp"),
        ("include/skybark/trees/a.hpp", "skybark/trees/b.hpp"),
        ("include/skybark/conformance/a.hpp", "skybark/trees/b.hpp"),
        ("include/skybark/conformance/a.hpp", "gtest/gtest.h"),
        ("include/skybark/skybark.hpp", "skybark/clouds/b.hpp"),
        ("include/skybark/core/a.hpp", "tl/expected.hpp"),
        ("include/skybark/core/a.hpp", "vector"),
        ("backends/skybark/cpu/a.hpp", "immintrin.h"),
        ("backends/skybark/vulkan/a.hpp", "vulkan/vulkan.h"),
        ("backends/skybark/opengl/headless.hpp", "EGL/egl.h")]
BAD = [("include/skybark/glsl/a.hpp", "skybark/core/b.hpp"),
       ("include/skybark/trees/a.hpp", "skybark/glsl/b.hpp"),
       ("include/skybark/core/records.hpp", "skybark/shared/b.hpp"),
       ("include/skybark/shared/a.hpp", "skybark/core/b.hpp"),
       ("include/skybark/core/a.hpp", "skybark/kernels/b.hpp"),
       ("include/skybark/core/a.hpp", "skybark/trees/b.hpp"),
       ("include/skybark/core/a.hpp", "skybark/cpu/cpu.hpp"),
       ("include/skybark/core/a.hpp", "skybark/conformance/b.hpp"),
       ("include/skybark/core/a.hpp", "skybark/skybark.hpp"),
       ("include/skybark/kernels/a.hpp", "skybark/trees/b.hpp"),
       ("include/skybark/trees/a.hpp", "skybark/clouds/b.hpp"),
       ("include/skybark/trees/a.hpp", "skybark/vulkan/vulkan.hpp"),
       ("include/skybark/trees/a.hpp", "gtest/gtest.h"),
       ("include/skybark/skybark.hpp", "skybark/cpu/cpu.hpp"),
       ("include/skybark/skybark.hpp", "skybark/conformance/b.hpp"),
       ("include/skybark/conformance/a.hpp", "skybark/cpu/cpu.hpp"),
       ("include/skybark/core/a.hpp", "vulkan/vulkan.h"),
       ("include/skybark/core/a.hpp", "stb/stb_image.h"),
       ("backends/skybark/cpu/a.hpp", "skybark/trees/b.hpp"),
       ("backends/skybark/cpu/a.hpp", "skybark/vulkan/vulkan.hpp"),
       ("backends/skybark/opengl/a.hpp", "EGL/egl.h"),
       ("backends/skybark/vulkan/a.hpp", "dlfcn.h")]


def self_test():
    wrong = [case for case in GOOD if list(complaints(case[0], f"#include <{case[1]}>"))]
    for before, after in [("#include <", ">"), ("#  include<", "> // why"), ('#include "', '"')]:
        wrong += [case for case in BAD if not list(complaints(case[0], before + case[1] + after))]
    for path, name in wrong:
        print(f"Wrong about {path} including {name}.")
    return 1 if wrong else 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    found = []
    headers = [p for root in ("include", "backends") for p in (ROOT / root).rglob("*.hpp")]
    for header in sorted(headers):
        found += complaints(header.relative_to(ROOT).as_posix(), header.read_text("utf-8"))
    print(*found, f"{len(headers)} headers, {len(found)} violations.", sep="\n")
    return 1 if found else 0


sys.exit(main())
