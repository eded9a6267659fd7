#!/usr/bin/env python3
"""What each public header costs a user's compiler, above what it includes from outside.

    cost.py [HEADER...]          a table of seconds: the header, the headers from outside that it
                                 reaches, and the difference, which is ours; dearest first
    cost.py --check              no clock: the memory that g++ takes for the difference must stay
                                 within bounds, for those headers that include the others; 77 where
                                 the compiler is another

Options: --compiler C (c++), --runs N (3, the median counts), --json FILE, --include FOLDER (of the
headers from outside, repeatable).
"""
import argparse
import json
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOTS = [ROOT / "include", ROOT / "backends"]

# MB that g++ 12 may take for the part of a header that is ours. It goes with time (7 ms a MB on the
# machine of the README's figures) and, unlike time, is the same in every run.
BOUNDS = {
    "skybark/skybark.hpp": 145,
    "skybark/cpu/cpu.hpp": 79,
    "skybark/opengl/opengl.hpp": 93,
    "skybark/vulkan/vulkan.hpp": 133,
}


def headers():
    """All that a user may include by itself: not the device programs, which belong to a backend."""
    for root in ROOTS:
        for path in sorted(root.rglob("*.hpp")):
            name = path.relative_to(root)
            if "programs" not in name.parts and "conformance" not in name.parts:
                yield str(name)


class Compiler:
    def __init__(self, command, include):
        self.base = [command, "-std=c++20", "-fsyntax-only", *(f"-I{r}" for r in ROOTS),
                     *(f"-isystem{i}" for i in include)]
        self.folder = tempfile.TemporaryDirectory()
        self.known = {}

    def run(self, includes, *options):
        source = pathlib.Path(self.folder.name) / "one.cpp"
        source.write_text("".join(f"#include <{i}>\n" for i in includes))
        done = subprocess.run([*self.base, *options, source], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(done.stderr)
        return done.stderr

    def outside(self, header):
        """The headers of others that ours name, in order: what -H lists right below one of ours."""
        found, ours = [], {0: True}
        for line in self.run([header], "-H").splitlines():
            match = re.match(r"(\.+) (.*)", line)
            if not match:
                continue
            depth, path = len(match.group(1)), pathlib.Path(match.group(2)).resolve()
            ours[depth] = any(path.is_relative_to(r) for r in ROOTS)
            if not ours[depth] and ours[depth - 1]:
                found.append(str(path))
        return tuple(found)

    def measure(self, includes, once):
        key = (once.__qualname__, includes)
        if key not in self.known:
            self.known[key] = once(includes)
        return self.known[key]

    def seconds(self, includes, runs):
        def once(includes):
            times = []
            for _ in range(runs):
                before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
                self.run(includes)
                times.append(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)
            return statistics.median(times)

        return self.measure(includes, once)

    def megabytes(self, includes):
        def once(includes):
            total = re.search(r"^ *TOTAL .* (\d+)([kMG])\s*$", self.run(includes, "-ftime-report"), re.M)
            return int(total.group(1)) * {"k": 1e-3, "M": 1, "G": 1e3}[total.group(2)]

        return self.measure(includes, once)


def check(compiler):
    version = subprocess.run([*compiler.base[:1], "-v"], capture_output=True, text=True).stderr
    if "gcc version 12." not in version:
        print("The bounds are for g++ 12.")
        sys.exit(77)
    failed = False
    for header, most in BOUNDS.items():
        own = compiler.megabytes((header,)) - compiler.megabytes(compiler.outside(header))
        print(f"{header}: {own:.0f} MB of at most {most}")
        failed |= own > most
    sys.exit(failed)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    arguments.add_argument("headers", nargs="*")
    arguments.add_argument("--compiler", default="c++")
    arguments.add_argument("--include", action="append", default=[])
    arguments.add_argument("--runs", type=int, default=3)
    arguments.add_argument("--json")
    arguments.add_argument("--check", action="store_true")
    given = arguments.parse_args()
    compiler = Compiler(given.compiler, given.include)
    if given.check:
        check(compiler)
    rows = []
    for header in given.headers or list(headers()):
        theirs = compiler.outside(header)
        whole = compiler.seconds((header,), given.runs)
        outside = compiler.seconds(theirs, given.runs)
        rows.append({"header": header, "seconds": whole, "outside": outside, "own": whole - outside})
    rows.sort(key=lambda r: -r["own"])
    print("    own  outside  whole  header")
    for r in rows:
        print(f"{r['own']:7.2f}  {r['outside']:7.2f}{r['seconds']:7.2f}  {r['header']}")
    if given.json:
        pathlib.Path(given.json).write_text(json.dumps(rows, indent=2) + "\n")


main()
