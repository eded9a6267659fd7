#!/usr/bin/env python3
"""Every relative link of a tracked Markdown file leads somewhere, headings included, and every picture of docs/pictures
is shown, with the command of docs/pictures/run that draws it.

    links.py              checks the tracked files
    links.py --self-test  checks that planted faults are found
"""
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from sources import ROOT, tracked

LINK = re.compile(r"\]\(([^)\s]+)\)")
PICTURES = (".png", ".apng", ".svg")


def prose(text):
    """Without blocks of code and without code between backticks."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```$", "", text, flags=re.S | re.M))


def anchors(text):
    """The names that a page of this text gives to its headings."""
    headings = re.findall(r"^#+ +(.*)$", re.sub(r"^```.*?^```$", "", text, flags=re.S | re.M), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(path, text, exists, read):
    """Sentences about `text`, the file `path` of the repository."""
    for target in LINK.findall(prose(text)):
        if "://" in target or target.startswith("mailto:"):
            continue
        name, _, anchor = target.partition("#")
        to = (path.parent / name) if name else path
        if not exists(to):
            yield f"{path} links to {target}, which does not exist."
        elif anchor and to.suffix == ".md" and anchor not in anchors(read(to)):
            yield f"{path} links to {target}, but {to} has no such heading."


def joined(text):
    """Lines, with those put together that end in a backslash."""
    return re.sub(r"\\\n\s*", "", text).splitlines()


def gallery_faults(run, gallery, pictures, shown):
    """`run`, `gallery`: texts; `pictures`: names in docs/pictures; `shown`: those that some page shows."""
    commands = [line for line in joined(run) if line.startswith("skybark ")]
    of_gallery = joined(gallery)
    for command in commands:
        if command not in of_gallery:
            yield f"docs/pictures/run has a command that docs/gallery.md lacks: {command}"
        name = command.rsplit("/", 1)[1]
        if name not in pictures:
            yield f"docs/pictures/run draws {name}, which is not in docs/pictures."
    for line in of_gallery:
        if line.startswith("skybark ") and line not in commands:
            yield f"docs/gallery.md has a command that docs/pictures/run lacks: {line}"
    for name in sorted(pictures - shown):
        yield f"docs/pictures/{name} is shown on no page."


def self_test():
    files = {Path("a.md"): "# One two\n[x](b.md) [y](#one-two)", Path("b.md"): "## It's `c`, d\n"}
    wrong = []

    def expect(number, text):
        found = list(broken_links(Path("a.md"), text, files.__contains__, files.__getitem__))
        if len(found) != number:
            wrong.append(f"{text!r}: {found}")

    expect(0, files[Path("a.md")])
    expect(0, "[x](b.md#its-c-d) [z](https://x.org/y) `[no](link.md)`\n```\n[no](link.md)\n```\n")
    expect(2, "[x](c.md) ![y](d.png)")
    expect(1, "[x](b.md#its-d)")
    run = "skybark tree a \\\n    -o docs/pictures/a.png\n"
    if list(gallery_faults(run, "skybark tree a -o docs/pictures/a.png", {"a.png"}, {"a.png"})):
        wrong.append("a gallery without faults")
    if len(list(gallery_faults(run, "skybark tree b -o x/b.png", {"c.png"}, set()))) != 4:
        wrong.append("a gallery with four faults")
    print(*[f"Wrong about: {what}" for what in wrong], sep="\n")
    return 1 if wrong else 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    pages = {path: (ROOT / path).read_text(encoding="utf-8") for path in map(Path, tracked(".md"))}
    faults, shown = [], set()
    for path, text in pages.items():
        faults += broken_links(path, text, lambda to: (ROOT / to).exists(),
                               lambda to: (ROOT / to).read_text(encoding="utf-8"))
        shown |= {target.rsplit("/", 1)[-1] for target in LINK.findall(text) if target.endswith(PICTURES)}
    drawn = {path.name for path in (ROOT / "docs/pictures").iterdir() if path.suffix in PICTURES}
    faults += gallery_faults((ROOT / "docs/pictures/run").read_text(encoding="utf-8"),
                             (ROOT / "docs/gallery.md").read_text(encoding="utf-8"), drawn, shown)
    print(*faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
