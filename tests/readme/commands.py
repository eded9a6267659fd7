#!/usr/bin/env python3
"""Runs every command of the README that calls the tool, in a folder of its own with small files of the names that the
README uses, and made small itself. What else its blocks of commands call has to exist.

    commands.py TOOL
"""
import json
import os
import re
import shlex
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
from blocks import PAGES, ROOT, blocks

TOOL = re.compile(r"build/\w+/bin/skybark ")
UNAVAILABLE = 3
SMALL = "40x30"
# What makes each command quick: options whose value is replaced, and added where they are missing.
SMALLER = {"tree": {"--size": SMALL, "--lod": "16"},
           "cloud": {"--volume": "16"},
           "gather": {"--size": SMALL},
           "meadow": {"--size": SMALL, "--trees": "1", "--grass": "0.02", "--directions": "2", "--bounces": "1",
                      "--cloud-voxels": "16", "--supersampling": "1"}}
# … and those that are replaced only where they are given.
REPLACED = {"--frames": "2", "--at": "0.1", "--seconds": "0.1", "--lightmap": "32", "--error": "10"}

ROOM_OBJ = """mtllib room.mtl
usemtl wall
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v -1 2 -1
v 1 2 -1
f 1 3 2
f 1 4 3
f 1 2 6
f 1 6 5
"""
FILES = {"room.obj": ROOM_OBJ,
         "room.mtl": "newmtl wall\nKd 0.7 0.6 0.5\n",
         "places.csv": "x,y,z\n0,0,0\n0,20,0\n",
         "points.csv": "x,y,z,nx,ny,nz\n0,0.1,0,0,1,0\n",
         "particles.csv": "x,y,z,radius,optical_depth,albedo\n0,0,0,10,2,1\n5,8,0,10,2,1\n",
         "scan.csv": (ROOT / "tests/fuzz/corpus/qsm/comma.csv").read_text(encoding="utf-8")}
# Files that the tool itself makes of those.
MADE = {"density.vdb": ["cloud", "particles.csv", "--volume", "16", "--light", "octaves", "-o", "density.vdb"],
        "room.glb": ["tree", "scan.csv", "--no-leaves", "-o", "room.glb"]}


def commands(page):
    """Lines of its blocks of commands, without comments."""
    for block in blocks(page, "sh"):
        for line in re.sub(r"\\\n\s*", "", block).splitlines():
            line = re.sub(r"(^|\s)#.*", "", line).strip()
            if line:
                yield line


# ---- Commands that call the tool -----------------------------------------------------------------

def with_option(words, name, value):
    if name in words:
        at = words.index(name)
        return [*words[:at + 1], value, *words[at + 2:]]
    return [*words, name, value]


def made_small(words):
    """The tool's arguments, changed to those of a quick run."""
    for name, value in REPLACED.items():
        if name in words:
            words = with_option(words, name, value)
    if words[0] == "tree" and "--list" in words:
        return words
    for name, value in SMALLER.get(words[0], {}).items():
        if name == "--lod" and "--frames" in words and any(word.endswith(".glb") for word in words):
            continue  # all frames share their vertices
        words = with_option(words, name, value)
    if words[0] == "gather" and "--error" not in words:
        words = with_option(words, "--directions", "2")
    if "--bounces" in words and words[0] == "gather":
        words = with_option(words, "--bounce-directions", "2")
    if words[0] == "cloud" and any(word.endswith(".png") for word in words):
        words = with_option(words, "--size", SMALL)
    if words[0] == "cloud" and words[1].startswith("cumulus"):
        words = with_option(words, "--particles", "100")
    return words


def stand_upright(path):
    """A volume of the tool's stands towards the sun; as an input it has to stand along the axes."""
    data = path.read_bytes()
    at = data.index(b"AffineMap") + len(b"AffineMap")
    matrix = struct.pack("<16d", 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, -16, -16, -16, 1)
    path.write_bytes(data[:at] + matrix + data[at + len(matrix):])


def run(tool, words, folder):
    return subprocess.run([tool, *words], cwd=folder, capture_output=True, text=True, timeout=300)


def is_missing_backend(done, words):
    required = os.environ.get("SKYBARK_REQUIRE_BACKENDS", "").split(",")
    backend = words[words.index("--backend") + 1] if "--backend" in words else "cpu"
    return done.returncode == UNAVAILABLE and backend not in required


def fault_of(tool, line, folder):
    words = made_small(shlex.split(line)[1:])
    done = run(tool, words, folder)
    if is_missing_backend(done, words):
        return None
    if done.returncode != 0:
        return f"{line}\n  as: skybark {shlex.join(words)}\n  exit code {done.returncode}: {done.stderr.strip()}"
    if "-o" in words:
        out = folder / words[words.index("-o") + 1]
        if not out.is_file() or out.stat().st_size == 0:
            return f"{line}\n  wrote no {out.name}"
    return None


# ---- Other commands ------------------------------------------------------------------------------

def presets():
    listed = json.loads((ROOT / "CMakePresets.json").read_text(encoding="utf-8"))
    return {kind: {preset["name"] for preset in listed[f"{kind}Presets"]} for kind in ("configure", "build", "test")}


def program_exists(name):
    """Whether a CMake file makes the program `name`."""
    if name.startswith("test_"):
        return (ROOT / "tests" / name.removeprefix("test_")).is_dir()
    files = [*(ROOT / "examples").rglob("CMakeLists.txt"), ROOT / "benchmarks/CMakeLists.txt"]
    texts = "".join(file.read_text(encoding="utf-8") for file in files)
    stem = name.removeprefix("skybark_")
    return bool(re.search(rf"\b{name}\b|foreach\(table [^)]*\b{stem}\b", texts))


def missing(page, line, known):
    for part in re.split(r"&&|\|", line):
        words = shlex.split(part)
        if not words:
            continue
        program = words[0]
        if program.startswith("build/"):
            if not program_exists(Path(program).name):
                yield f"{page}: no program {Path(program).name}: {line}"
        elif "/" in program and not os.access(ROOT / program, os.X_OK):
            yield f"{page}: {program} is not a program: {line}"
        if "--preset" in words:
            kind = "test" if program == "ctest" else "build" if "--build" in words else "configure"
            name = words[words.index("--preset") + 1]
            if name not in known[kind]:
                yield f"{page}: no {kind} preset {name}: {line}"


def main():
    tool = Path(sys.argv[1]).resolve()
    known = presets()
    faults = [fault for page in [*PAGES, "CONTRIBUTING.md", "docs/figures.md"]
              for line in commands(page) for fault in missing(page, line, known)]
    lines = [line for line in commands("README.md") if TOOL.match(line)]
    if not lines:
        faults.append("The README has no command of the tool.")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in FILES.items():
            (folder / file).write_text(text, encoding="utf-8")
        for file, words in MADE.items():
            done = run(tool, words, folder)
            if done.returncode != 0:
                faults.append(f"{file} could not be made: {done.stderr.strip()}")
            elif file.endswith(".vdb"):
                stand_upright(folder / file)
        faults += [fault for line in lines if (fault := fault_of(tool, line, folder))]
    print(f"{len(lines)} commands.", *faults, sep="\n")
    return 1 if faults else 0


sys.exit(main())
