#!/usr/bin/env python3
"""Doxygen makes the reference of docs/Doxyfile without a warning, and it is that of this version."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    if not shutil.which("doxygen"):
        print("Skipped: Doxygen isn't installed.")
        return 77
    settings = (ROOT / "docs/Doxyfile").read_text(encoding="utf-8")
    version = re.search(r"project\(skybark VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
    if not re.search(rf"^PROJECT_NUMBER\s*= {re.escape(version)}$", settings, re.M):
        print(f"docs/Doxyfile is of another version than CMakeLists.txt, {version}.")
        return 1
    with tempfile.TemporaryDirectory() as folder:
        settings += f"OUTPUT_DIRECTORY = {folder}\nSOURCE_BROWSER = NO\nVERBATIM_HEADERS = NO\n"
        done = subprocess.run(["doxygen", "-"], cwd=ROOT, input=settings, capture_output=True, text=True)
        said = (done.stdout + done.stderr).strip()
        pages = len(list(pathlib.Path(folder).glob("reference/*.html")))
    print(said or f"{pages} pages.")
    # A reference without the headers would be none.
    return 1 if done.returncode != 0 or said or pages < 100 else 0


sys.exit(main())
