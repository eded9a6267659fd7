#!/usr/bin/env python3
"""A wrong type must fail to compile, with the message that one would want.

    must_fail.py [--compiler CXX]... CASE.fail.cpp
    must_fail.py [--compiler CXX]... --self-test

The first line of a case is `// expect: REGEX`, matched against what the compiler says, by each
compiler given and by g++ and clang++ where they are installed.
"""

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
INCLUDE = [f"-I{ROOT / folder}" for folder in ("include", "backends", "tests")]


def problem(compiler, path):
    """What is wrong with how `compiler` takes the case `path`, or None."""
    first = path.read_text("utf-8").split("\n", 1)[0]
    expect = re.match(r"// expect: (.+)", first)
    if not expect:
        return "its first line isn't `// expect: REGEX`."
    run = subprocess.run([compiler, "-std=c++20", "-fsyntax-only", *INCLUDE, path],
                         capture_output=True, text=True, errors="replace")
    output = run.stdout + run.stderr
    if run.returncode == 0:
        return "it compiles."
    if not re.search(expect[1], output):
        return f"/{expect[1]}/ isn't in what the compiler said:\n{output[:4000]}"
    return None


def self_test(compilers):
    cases = {"// expect: no_such_name\nint x = no_such_name;\n": True,
             "// expect: another_name\nint x = no_such_name;\n": False,
             "// expect: x\nint x = 1;\n": False,
             "int x = no_such_name;\n": False}
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.fail.cpp"
        for text, passes in cases.items():
            path.write_text(text)
            for compiler in compilers:
                if (problem(compiler, path) is None) != passes:
                    print(f"{compiler}: wrong about:\n{text}")
                    wrong += 1
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--compiler", action="append", default=[])
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("case", nargs="?", type=Path)
    args = parser.parse_args()

    found = map(shutil.which, [*args.compiler, "g++", "clang++"])
    compilers = {str(Path(path).resolve()): path for path in found if path}.values()
    if args.self_test:
        return self_test(compilers)
    problems = {compiler: problem(compiler, args.case) for compiler in compilers}
    for compiler, what in problems.items():
        print(f"{compiler}: {args.case.name}: {what or 'fails to compile, as it should.'}")
    return 1 if any(problems.values()) else 0


sys.exit(main())
