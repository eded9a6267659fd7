#!/usr/bin/env python3
"""No tracked text file names a folder of the machine that it was written on, or a text that is not
here, or leaves work undone.

    words.py              checks the tracked files
    words.py --self-test  checks that planted words are found
"""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from sources import ROOT, tracked

# A path starts where no other path is going on: ../work/ and network/root/ are none of ours.
# METHODS is fine as a name in Python.
UNWANTED = re.compile(r"(?<![\w./-])/(?:work|root|home/\w+)/|\b(?:TODO|FIXME|XXX)\b|\bMETHODS\b(?! =|\.\w)")


def self_test():
    bad = ["see /work/x", '"/root/.cache"', "/home/me/x", "// TODO: later", "FIXME", "XXX",
           "(METHODS: a proof)", "as METHODS says."]
    good = ["../work/x", "a/root/b", "mktemp XXXXXX", "todo", "${HOME}/x",
            "METHODS = {", "METHODS.items()"]
    wrong = [t for t in bad if not UNWANTED.search(t)] + [t for t in good if UNWANTED.search(t)]
    print(*[f"Wrong about: {text}" for text in wrong], sep="\n")
    return 1 if wrong else 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    found = 0
    for path in tracked():
        data = (ROOT / path).read_bytes()
        if b"\0" in data or (ROOT / path).samefile(__file__):
            continue
        for number, line in enumerate(data.decode("utf-8", "replace").splitlines(), 1):
            for word in UNWANTED.findall(line):
                print(f"{path}:{number}: unwanted {word!r}: {line.strip()[:100]}")
                found += 1
    return 1 if found else 0


sys.exit(main())
