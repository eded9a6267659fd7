#!/usr/bin/env python3
"""Compiles every GLSL snippet of the documentation that is a whole shader, as it stands there: one with a #version.
Its first line is a comment with a file's name, whose suffix is the stage. Excerpts are left alone."""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
from blocks import PAGES, ROOT, blocks


def fault(name, code):
    """A sentence about what the compiler has to say, or None."""
    stage = re.match(r"// \w+\.(\w+)\n", code)
    if not stage:
        return f"{name}: it begins with no file's name."
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / f"snippet.{stage[1]}"
        source.write_text(code, encoding="utf-8")
        done = subprocess.run(["glslangValidator", "--target-env", "vulkan1.2", f"-I{ROOT / 'include'}", "-o",
                               f"{source}.spv", source], capture_output=True, text=True)
    return f"{name}: {done.stdout}{done.stderr}" if done.returncode != 0 else None


def main():
    if not shutil.which("glslangValidator"):
        print("Skipped: glslangValidator isn't installed.")
        return 77
    snippets = [(f"{page}, shader {number}", code) for page in PAGES
                for number, code in enumerate(blocks(page, "glsl"), 1) if "#version" in code]
    if not snippets:
        sys.exit("There are no shaders.")
    faults = [said for said in (fault(*each) for each in snippets) if said]
    print(f"{len(snippets)} shaders.", *faults, sep="\n")
    return 1 if faults else 0


sys.exit(main())
