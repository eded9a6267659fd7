#!/usr/bin/env python3
"""Writes Skybark with one backend as a single header.

    single_header.py BACKEND [OUTPUT]    BACKEND: cpu, opengl or vulkan; without OUTPUT, to stdout

The algorithms, the backend and, where there is one, its headless device, out of include/ and
backends/: every header of ours once, in the order in which a compiler meets them. Each stands in a
guard of its own, so that several of these files may be included in one. What is included from
outside, the standard library, GLM, tl::expected and Vulkan's headers, stays an #include.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BACKENDS = ("cpu", "opengl", "vulkan")
OURS = re.compile(r"\s*#\s*include\s*<(skybark/[^>]+)>")

BANNER = """\
// Skybark {version}, with the {backend} backend, as one header.
//
// GPU algorithms for natural scenes: trees, clouds, gathered light. In one source file, include
// either headers such as this one, of one version, or <skybark/...>, not both.
//
// Needs C++20, GLM, {needs}.
//
// Made by cmake/single_header.py. Edit the headers that it is made of instead.
//
{licence}
"""
NEEDS = {"cpu": "tl::expected; link with -pthread",
         "opengl": "tl::expected; link with -ldl if dlopen asks for it",
         "vulkan": "tl::expected, Vulkan's headers; link with -ldl if dlopen asks for it"}


def path_of(header):
    """The file that <header> names."""
    for root in ("include", "backends"):
        if (ROOT / root / header).is_file():
            return ROOT / root / header
    sys.exit(f"There is no header <{header}> in include/ or backends/.")


def parts(header):
    """The lines of a header without its #pragma once: those up to the last of our includes that it
    begins with, and the others. Anywhere else one of ours could depend on what stands before it."""
    lines = path_of(header).read_text("utf-8").splitlines()
    lines = [line for line in lines if not re.match(r"\s*#\s*pragma\s+once\b", line)]
    depth = 0
    code = False
    for number, line in enumerate(lines, 1):
        if OURS.match(line) and (code or depth):
            sys.exit(f"{header}:{number}: includes one of ours after code or in an #if.")
        depth += bool(re.match(r"\s*#\s*if", line)) - bool(re.match(r"\s*#\s*endif", line))
        code = code or not re.match(r"\s*(#|//|$)", line)
    return ([OURS.match(line)[1] for line in lines if OURS.match(line)],
            [line for line in lines if not OURS.match(line)])


def in_order(header, seen):
    """Yields (header, lines) for each header that `header` needs, and for itself, each once."""
    if header in seen:
        return
    seen.add(header)
    needed, lines = parts(header)
    for other in needed:
        yield from in_order(other, seen)
    yield header, lines


def single_header(backend):
    """The text of the single header."""
    version = re.search(r"project\(skybark VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    licence = [f"// {line}".rstrip() for line in (ROOT / "LICENSE").read_text("utf-8").splitlines()]
    tops = ["skybark/skybark.hpp", f"skybark/{backend}/{backend}.hpp"]
    if (ROOT / "backends/skybark" / backend / "headless.hpp").is_file():
        tops.append(f"skybark/{backend}/headless.hpp")

    text = ["// clang-format off",
            BANNER.format(version=version, backend=backend, needs=NEEDS[backend],
                          licence="\n".join(licence)),
            "#pragma once"]
    seen = set()
    for top in tops:
        for header, lines in in_order(top, seen):
            guard = "SKYBARK_HEADER_" + re.sub(r"\W", "_", header.removeprefix("skybark/")).upper()
            body = re.sub(r"\n{3,}", "\n\n", "\n".join(lines).strip("\n"))
            text += ["", f"// ---- {header} ".ljust(100, "-"), f"#ifndef {guard}", f"#define {guard}",
                     body, f"#endif // {guard}"]
    return "\n".join(text) + "\n"


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[1] not in BACKENDS:
        sys.exit(__doc__)
    text = single_header(sys.argv[1])
    if len(sys.argv) == 2:
        sys.stdout.write(text)
        return
    output = Path(sys.argv[2])
    output.parent.mkdir(parents=True, exist_ok=True)
    output.write_text(text, "utf-8")


main()
