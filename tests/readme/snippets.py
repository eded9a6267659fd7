#!/usr/bin/env python3
"""Builds every C++ snippet of the documentation that is a whole file, as it stands there, and runs those that are
programs. Excerpts, which include nothing, are left alone.

    snippets.py COMPILER [FLAGS...]
"""
import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
from blocks import PAGES, ROOT, blocks

CONFORMANCE = "skybark/conformance/"
SECONDS = 300  # for each step; some machines are slow, and a program that hangs is one that fails


def call(name, words, folder):
    """A sentence about what went wrong, or None."""
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=SECONDS, cwd=folder)
    except subprocess.TimeoutExpired:
        return f"{name}: not done after {SECONDS} s: {' '.join(map(str, words))}"
    if done.returncode != 0:
        return f"{name}: exit code {done.returncode}: {' '.join(map(str, words))}\n{done.stdout}{done.stderr}"
    return None


def try_snippet(name, code, compiler):
    with tempfile.TemporaryDirectory() as folder:
        source, program = Path(folder) / "snippet.cpp", Path(folder) / "snippet"
        source.write_text(code, encoding="utf-8")
        compile_it = [*compiler, "-std=c++20", f"-I{ROOT / 'include'}", f"-I{ROOT / 'backends'}", source]
        if not re.search(r"\bint main\(", code):
            return call(name, [*compile_it, "-fsyntax-only"], folder)
        # Of the whole suite a part has to pass: it runs elsewhere.
        is_suite = CONFORMANCE in code
        link = ["-O0" if is_suite else "-O1", "-pthread", "-ldl", *(["-lgtest"] if is_suite else [])]
        run = [program, *(["--gtest_filter=*map*"] if is_suite else [])]
        return call(name, [*compile_it, "-o", program, *link], folder) or call(name, run, folder)


def main():
    # That of including.md is built in each of its six ways by tests/install.
    snippets = [(f"{page}, snippet {number}", code) for page in PAGES if page != "docs/including.md"
                for number, code in enumerate(blocks(page, "cpp"), 1) if "#include" in code]
    if not snippets:
        sys.exit("There are no snippets.")
    with concurrent.futures.ThreadPoolExecutor(min(2, os.cpu_count() or 1)) as pool:
        faults = [fault for fault in pool.map(lambda each: try_snippet(*each, sys.argv[1:]), snippets) if fault]
    print(f"{len(snippets)} snippets.", *faults, sep="\n")
    return 1 if faults else 0


sys.exit(main())
