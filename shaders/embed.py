#!/usr/bin/env python3
"""Makes the checked-in headers from the texts in this folder; see README.md beside this.

    embed.py           write what is out of date
    embed.py NAME...   only of these kernels and formulas
    embed.py --check   write nothing; exit 1 and name what is out of date

A header carries the SHA-256 of the texts that it was made from, so --check needs no compiler.
Writing needs glslangValidator and spirv-val.
"""
import hashlib
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent

# (what the kernel must define, skeleton, member of program<K>); the suffix of the skeleton is its
# stage. A skeleton that is absent for an API is not made for it.
OPENGL = [
    ("kernel_map", "map.comp"),
    ("kernel_map", "levels.comp"),
    ("kernel_strip", "expand.vert"),
    ("kernel_ring", "expand.vert"),
    ("kernel_strip", "strips.geom"),
    ("kernel_ring", "rings.geom"),
    ("kernel_voxel", "voxels.comp"),
    ("kernel_slab", "accumulate.comp"),
    ("kernel_slab", "slabs.vert"),
    ("kernel_slab", "slabs.geom"),
    ("kernel_slab", "slabs.frag"),
    ("kernel_fragment", "draw.vert"),
    ("kernel_fragment", "draw.frag"),
    ("kernel_corner", "peel.vert"),
]
VULKAN = [
    ("kernel_map", "map.comp"),
    ("kernel_map", "levels.comp"),
    ("kernel_strip", "strip_counts.comp"),
    ("kernel_strip", "strips.comp"),
    ("kernel_ring", "rings.comp"),
    ("kernel_voxel", "voxels.comp"),
    ("kernel_slab", "accumulate.comp"),
    ("kernel_fragment", "draw.vert"),
    ("kernel_fragment", "draw.frag"),
    ("kernel_corner", "peel.vert"),
]
# Formulas that the CPU backend computes four at a time.
LANES = {"sway"}
INCLUDE = re.compile(r'^#include\s+(?:"([^"]+)"|(KERNEL))\s*$')
# The line that a struct or a function of shaders/shared and shaders/glsl begins with.
ITEM = re.compile(r"(?:struct\s+(\w+)|\w+\s+(\w+)\()")
# What callers' texts can be pasted into, and what else OpenGL ES asks for.
CALLERS = ["#version 330", "#version 460",
           "#version 300 es\nprecision highp float;\nprecision highp sampler3D;"]


def flatten(path, kernel=None, seen=None):
    """The text with its includes in place, each once, without comments and indentation."""
    seen = set() if seen is None else seen
    path = path.resolve()
    if path in seen:
        return ""
    seen.add(path)
    lines = []
    for line in path.read_text().splitlines():
        match = INCLUDE.match(line)
        if match:
            target = kernel if match.group(2) else path.parent / match.group(1)
            lines.append(flatten(target, kernel, seen))
        elif line := re.sub(r"\s*//.*", "", line).strip():
            lines.append(line + "\n")
    return "".join(line if line.endswith("\n") or not line else line + "\n" for line in lines)


def define(text, *names):
    """The text with macros defined right after its #version line."""
    version, rest = text.split("\n", 1)
    return version + "\n" + "".join(f"#define {n}\n" for n in names) + rest


def run(command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")


def check_glsl(text, stage, name):
    with tempfile.TemporaryDirectory() as folder:
        source = pathlib.Path(folder) / f"{name}.{stage}"
        source.write_text(text)
        run(["glslangValidator", "-S", stage, source])


def glsl(text):
    """A std::string_view of GLSL. Its length is written out: a compiler that has to count the
    characters of a literal does so one by one, and takes seconds over all of them."""
    return f'{{R"glsl({text})glsl", {len(text.encode())}}}'


def spirv(text, stage, name):
    with tempfile.TemporaryDirectory() as folder:
        source = pathlib.Path(folder) / f"{name}.{stage}"
        binary = pathlib.Path(folder) / "out.spv"
        source.write_text(text)
        run(["glslangValidator", "--target-env", "vulkan1.2", "-g0", "-S", stage, "-o", binary, source])
        run(["spirv-val", "--target-env", "vulkan1.2", binary])
        data = binary.read_bytes()
        return [int.from_bytes(data[i : i + 4], "little") for i in range(0, len(data), 4)]


def member(skeleton):
    return skeleton.replace(".", "_")


def skeletons(table, kernel_text):
    for function, skeleton in table:
        path = HERE / "skeletons" / skeleton
        if re.search(rf"\b{function}\s*\(", kernel_text) and path.exists():
            yield path


def words(values):
    """SPIR-V as one literal of char32_t, which compilers read several times as fast as a list of
    numbers. An escape takes all hexadecimal digits that follow, up to the next backslash."""
    lines = []
    for i in range(0, len(values), 64):
        lines.append('U"' + "".join(f"\\x{v:x}" for v in values[i : i + 64]) + '"\n')
    return "".join(lines).rstrip()


def items(path, seen):
    """{name: text} of each struct and function, with the comment above it, of a file and of those
    that it includes, each file once."""
    path, found, comment = path.resolve(), {}, []
    if path in seen:
        return found
    seen.add(path)
    lines = iter(path.read_text().splitlines())
    for line in lines:
        if include := INCLUDE.match(line):
            found |= items(path.parent / include.group(1), seen)
        elif begins := ITEM.match(line):
            text = [line]
            while not line.endswith("}") and not text[-1].startswith("}"):
                text.append(next(lines))
            found[begins.group(1) or begins.group(2)] = "\n".join(comment + text)
        comment = comment + [line] if line.startswith("//") else []
    return found


def caller_text(path):
    """A text of shaders/glsl whole: its functions, or those of what it includes where it has none
    itself, and what they need. Each is in a guard of its own, so that a shader can hold several of
    these texts, which share some."""
    text = path.read_text()
    known = items(path, set())
    needed = [name for name in known if re.search(rf"^\w+ {name}\(", text, re.M)] or list(known)
    for name in needed: # grows
        needed += [n for n in re.findall(r"\w+", re.sub("//.*", "", known[name]))
                   if n in known and n not in needed]
    names = [name for name in known if name in needed]
    defines = textwrap.fill("Defines " + ", ".join(names) + ".", 97, initial_indent="// ",
                            subsequent_indent="// ")
    guarded = [f"#ifndef SKYBARK_{name.upper()}\n#define SKYBARK_{name.upper()}\n{known[name]}\n#endif\n"
               for name in names]
    whole = "\n".join([text[: text.index("#include")] + "//\n" + defines + "\n", *guarded])
    for sign, plain in {"−": "-", "²": "^2", "½": "1/2 ", "…": "..."}.items():
        whole = whole.replace(sign, plain) # before GLSL 4.20 comments are ASCII, too
    if not whole.isascii():
        sys.exit(f"{path}: {''.join(set(c for c in whole if not c.isascii()))} is not ASCII.")
    return whole


class Header:
    """One generated file: its inputs, and how its body is made when they have changed."""

    def __init__(self, path, inputs, body):
        self.path = ROOT / path
        self.hash = hashlib.sha256("\0".join(inputs).encode()).hexdigest()
        self.body = body

    def stale(self):
        return not self.path.exists() or f"// sha256 {self.hash}\n" not in self.path.read_text()

    def write(self):
        self.path.parent.mkdir(parents=True, exist_ok=True)
        made = f"// Made by shaders/embed.py. Edit the text in shaders/ instead.\n// sha256 {self.hash}\n"
        if self.path.suffix == ".hpp":
            made = f"// clang-format off\n{made}#pragma once\n"
        self.path.write_text(f"{made}\n{self.body()}")


def shared_header(path):
    """A formula as C++: the same text in a namespace, its functions inline."""
    text = path.read_text()
    includes = re.findall(r'^#include "(\w+)\.glsl"', text, re.M)
    text = re.sub(r"^#include .*\n", "", text, flags=re.M)

    def body():
        function = re.compile(r"^(?=(?:[a-z_]\w*)\s+[a-z_]\w*\()", re.M)
        lines = function.sub("inline ", text)
        lines = re.sub(r"^inline (struct|return|else)", r"\1", lines, flags=re.M)
        lines = lines.replace("precise ", "")  # C++ says it to its compiler: -ffp-contract=off
        use = "".join(f"#include <skybark/shared/{n}.hpp>\n" for n in includes if n != "records")
        return (
            f"#include <skybark/shared/glsl.hpp>\n{use}\nnamespace skybark::shared {{\n\n{lines}\n"
            "} // namespace skybark::shared\n"
        )

    return Header(f"include/skybark/shared/{path.stem}.hpp", ["cpp 1", *includes, text], body)


def lanes_header(path):
    """A formula without choices for the CPU's vectors: each number becomes four (cpu/four.hpp)."""
    text = re.sub(r"^#include .*\n", "", path.read_text(), flags=re.M)

    def body():
        lines = re.sub(r"^(?=(?!struct|return|else)[a-z_]\w*\s+[a-z_]\w*\()", "inline ", text, flags=re.M)
        lines = re.sub(r"\b(float|uint)\b", "number", lines)
        return (
            "#include <skybark/cpu/four.hpp>\n\n#if defined(__GNUC__)\n\n"
            f"namespace skybark::cpu::four {{\n\n{lines}\n"
            "} // namespace skybark::cpu::four\n\n#endif\n"
        )

    return Header(f"backends/skybark/cpu/programs/{path.stem}.hpp", ["lanes 1", text], body)


def opengl_header(path):
    name, kernel_text = path.stem, path.read_text()
    texts = {}
    for skeleton in skeletons(OPENGL, kernel_text):
        emits = skeleton.suffix == ".geom" and function_of(skeleton.name)
        expand = ["SKYBARK_EXPAND"] if emits else []
        texts[skeleton.name] = define(flatten(skeleton, path), "SKYBARK_OPENGL", *expand)

    def body():
        members = ""
        for skeleton, text in texts.items():
            check_glsl(text, skeleton.split(".")[1], name)
            members += f'    static constexpr std::string_view {member(skeleton)}{glsl(text)};\n'
        return (
            f"#include <skybark/kernels/{name}.hpp>\n#include <skybark/opengl/program.hpp>\n\n"
            f"namespace skybark::opengl {{\n\ntemplate <>\nstruct program<kernels::{name}> {{\n"
            f"{members}}};\n\n}} // namespace skybark::opengl\n"
        )

    return Header(f"backends/skybark/opengl/programs/{name}.hpp", ["gl 2", *texts.values()], body)


def vulkan_header(path):
    name, kernel_text = path.stem, path.read_text()
    texts = {}
    for skeleton in skeletons(VULKAN, kernel_text):
        expand = ["SKYBARK_EXPAND"] if function_of(skeleton.name) else []
        texts[skeleton.name] = define(flatten(skeleton, path), "SKYBARK_VULKAN", *expand)

    def body():
        members = ""
        for skeleton, text in texts.items():
            binary = spirv(text, skeleton.split(".")[1], name)
            members += f"    static constexpr char32_t {member(skeleton)}[] =\n{words(binary)};\n"
        return (
            f"#include <skybark/kernels/{name}.hpp>\n#include <skybark/vulkan/program.hpp>\n\n"
            f"namespace skybark::vulkan {{\n\ntemplate <>\nstruct program<kernels::{name}> {{\n"
            f"{members}}};\n\n}} // namespace skybark::vulkan\n"
        )

    return Header(f"backends/skybark/vulkan/programs/{name}.hpp", ["vk 2", *texts.values()], body)


def function_of(skeleton):
    return skeleton.startswith(("strip", "rings"))


def standalone_headers():
    """Shaders of a backend that no kernel belongs to: shaders/programs/API_NAME.STAGE."""
    for path in sorted((HERE / "programs").glob("*_*.*")):
        stage = path.suffix[1:]
        if stage not in ("comp", "vert", "frag"):
            continue
        api, name = path.stem.split("_", 1)
        text = define(flatten(path), f"SKYBARK_{api.upper()}")

        def body(api=api, name=name, stage=stage, text=text):
            if api == "opengl":
                check_glsl(text, stage, name)
                value = f"inline constexpr std::string_view {name}_{stage}{glsl(text)};\n"
            else:
                binary = spirv(text, stage, name)
                value = f"inline constexpr char32_t {name}_{stage}[] =\n{words(binary)};\n"
            use = "#include <string_view>\n\n" if api == "opengl" else ""
            return (
                f"{use}namespace skybark::{api} {{\n\n{value}\n}} // namespace skybark::{api}\n"
            )

        yield Header(f"backends/skybark/{api}/programs/own_{name}.hpp", ["own 2", text], body)


def caller_headers():
    """shaders/glsl for callers: as a text to include where compilers can, and as a string."""
    for path in sorted((HERE / "glsl").glob("*.glsl")):
        name, text = path.stem, caller_text(path)

        def body(name=name, text=text):
            for version in CALLERS:
                check_glsl(f"{version}\n{text}{text}void main() {{}}\n", "frag", name)
            return text

        def string(name=name, text=text):
            comment = text[: text.index("\n\n") + 1].replace("// ", "/// ").replace("//\n", "///\n")
            return (
                "#include <string_view>\n\nnamespace skybark::glsl {\n\n"
                f"{comment}inline constexpr std::string_view {name}{glsl(text)};\n\n"
                "} // namespace skybark::glsl\n"
            )

        yield Header(f"include/skybark/glsl/{name}.glsl", ["caller 1", text], body)
        yield Header(f"include/skybark/glsl/{name}.hpp", ["caller 1", text], string)


def headers():
    for path in sorted((HERE / "shared").glob("*.glsl")):
        if path.stem != "records":
            yield shared_header(path)
        if path.stem in LANES:
            yield lanes_header(path)
    for path in sorted((HERE / "kernels").glob("*.glsl")):
        yield opengl_header(path)
        yield vulkan_header(path)
    yield from standalone_headers()
    yield from caller_headers()


def main():
    check = "--check" in sys.argv[1:]
    names = [a for a in sys.argv[1:] if not a.startswith("-")]
    stale = [h for h in headers() if h.stale() and (not names or h.path.stem in names)]
    for header in stale:
        if not check:
            header.write()
        print(("stale: " if check else "wrote ") + str(header.path.relative_to(ROOT)))
    known = {h.path for h in headers()}
    for folder in ("include/skybark/shared", "include/skybark/glsl", "backends/skybark/opengl/programs",
                   "backends/skybark/vulkan/programs"):
        for path in (ROOT / folder).glob("*.*"):
            if path not in known and "// Made by shaders/embed.py" in path.read_text():
                stale.append(path)
                print(f"left over: {path.relative_to(ROOT)}")
    sys.exit(1 if check and stale else 0)


main()
