#!/usr/bin/env python3
"""Compiles every C++ snippet of README.md as it stands there, and checks that its links lead somewhere.

    readme.py COMPILER [FLAGS...]
"""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
TEXT = (ROOT / "README.md").read_text()


def broken_links():
    prose = re.sub(r"```.*?```", "", TEXT, flags=re.S)
    for target in re.findall(r"\]\(([^)#]+)\)", prose):
        if "://" not in target and not (ROOT / target).exists():
            yield f"README.md links to {target}, which does not exist"


def broken_snippets(command):
    for number, code in enumerate(re.findall(r"```cpp\n(.*?)```", TEXT, re.S), 1):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder) / f"snippet_{number}.cpp"
            source.write_text(code)
            includes = [f"-I{ROOT / 'include'}", f"-I{ROOT / 'backends'}"]
            done = subprocess.run([*command, "-std=c++20", "-fsyntax-only", *includes, source],
                                  capture_output=True, text=True)
            if done.returncode != 0:
                yield f"README.md, snippet {number} does not compile:\n{done.stderr}"


def main():
    problems = [*broken_links(), *broken_snippets(sys.argv[1:])]
    print("\n".join(problems))
    sys.exit(1 if problems else 0)


main()
