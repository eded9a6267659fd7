"""Which files are the project's own: what git tracks, or all but build folders where there is none."""

import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def tracked(*suffixes):
    """Paths of the project's files, relative to its root, that end in one of `suffixes` (or any)."""
    try:
        # "*": also where another user checked the tree out.
        git = subprocess.run(
            ["git", "-c", "safe.directory=*", "-C", ROOT, "ls-files", "-z"],
            capture_output=True, text=True, check=True)
        paths = [Path(name) for name in git.stdout.split("\0") if name]
    except (OSError, subprocess.CalledProcessError):
        paths = []
        for folder, folders, files in os.walk(ROOT):
            folders[:] = [f for f in folders if not f.startswith((".", "build"))]
            paths += [(Path(folder) / name).relative_to(ROOT) for name in files]
    return sorted(p for p in paths
                  if (ROOT / p).is_file() and (not suffixes or p.suffix in suffixes))
