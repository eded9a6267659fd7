#!/usr/bin/env python3
"""Every tracked C++ file is as clang-format would have it, but for generated files, whose first
line is "// clang-format off"."""

import shutil
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from sources import ROOT, tracked

clang_format = shutil.which("clang-format-14") or shutil.which("clang-format")
if not clang_format:
    print("Skipped: clang-format isn't installed.")
    sys.exit(77)

files = []
for path in tracked(".hpp", ".cpp"):
    with open(ROOT / path, encoding="utf-8") as file:
        if not file.readline().startswith("// clang-format off"):
            files.append(str(path))
print(f"{len(files)} files.")
sys.exit(subprocess.run([clang_format, "--dry-run", "-Werror", *files], cwd=ROOT).returncode)
