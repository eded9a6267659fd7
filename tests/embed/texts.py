#!/usr/bin/env python3
"""The texts for callers' shaders, include/skybark/glsl: each by itself and all together, in any version and stage that
they are for; no names but those that their heads list; and each string of a header is the file beside it."""
import itertools
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "include/skybark/glsl"
ES = "precision highp float;\nprecision highp sampler3D;\n"
VERSIONS = {"330": "", "460": "", "300 es": ES, "320 es": ES} # the first and the last of each
STAGES = ("vert", "frag")


def definitions(text):
    """Names of the structs, functions and macros of a text, in order."""
    code = re.sub(r"//.*", "", text)
    return re.findall(r"^(?:struct|\w+)\s+(\w+)\s*[({]", code, re.M), re.findall(r"^#define (\w+)$", code, re.M)


def faults_of(path):
    """Sentences about one text and its header."""
    text = path.read_text("utf-8").split("\n\n", 1)[1] # after the lines on where it comes from
    listed = re.search(r"^// Defines ((?:.|\n// )*)\.$", text, re.M)[1].replace("\n//", "").split(", ")
    names, macros = definitions(text)
    if names != listed:
        yield f"{path.name} lists {listed} and defines {names}."
    if macros != ["SKYBARK_" + name.upper() for name in names]:
        yield f"{path.name} defines the macros {macros}."
    if not text.isascii():
        yield f"{path.name} is not ASCII."
    header = path.with_suffix(".hpp").read_text("utf-8")
    string = re.search(rf'string_view {path.stem}{{R"glsl\((.*?)\)glsl", (\d+)}}', header, re.S)
    if not string or string[1] != text or int(string[2]) != len(text):
        yield f"{path.stem}.hpp has not the text of {path.name}."


def compile_with(folder, version, stage, texts):
    """A sentence where these texts, one after another, are no shader of a version."""
    source = Path(folder) / f"shader.{stage}"
    source.write_text(f"#version {version}\n{VERSIONS[version]}{''.join(texts)}void main() {{}}\n", "utf-8")
    done = subprocess.run(["glslangValidator", source], capture_output=True, text=True)
    if done.returncode != 0:
        yield f"#version {version}, {stage}: {done.stdout}{done.stderr}"


def main():
    paths = sorted(FOLDER.glob("*.glsl"))
    if not paths:
        sys.exit("There are no texts.")
    faults = [fault for path in paths for fault in faults_of(path)]
    if not shutil.which("glslangValidator"):
        print(*faults, "glslangValidator isn't installed: nothing is compiled.", sep="\n")
        return 1 if faults else 77
    texts = [path.read_text("utf-8") for path in paths]
    with tempfile.TemporaryDirectory() as folder:
        for version, stage in itertools.product(VERSIONS, STAGES):
            for some in [*([text] for text in texts), texts, texts[::-1] + texts]:
                faults += compile_with(folder, version, stage, some)
    print(f"{len(paths)} texts.", *faults, sep="\n")
    return 1 if faults else 0


sys.exit(main())
