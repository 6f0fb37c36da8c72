#!/usr/bin/env python3
"""Write a version wherever it stands: the distributions, their bounds on each other, arena_core and CITATION.cff.

usage: .venv/bin/python scripts/set_version.py MAJOR.MINOR.PATCH
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]


def main(version: str, top: Path = TOP) -> None:
    """Write it below ``top``; exit where it is none, or where a file has no place for it."""
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        sys.exit(f"version is {version}; allowed: MAJOR.MINOR.PATCH")
    major, minor, _ = version.split(".")
    bounds = rf"\g<1>>={major}.{minor},<{major}.{int(minor) + 1}"
    for project in [top / "pyproject.toml", *sorted(top.glob("plugins/*/pyproject.toml"))]:
        replace_line(project, r'^version = "(.*)"$', f'version = "{version}"')
        text = re.sub(r'("arena-[a-z-]+(?:\[\w+\])?)>=[\d.]+,<[\d.]+', bounds, project.read_text())
        project.write_text(text)
    replace_line(top / "arena_core" / "__init__.py", r'^__version__ = "(.*)"$', f'__version__ = "{version}"')
    replace_line(top / "CITATION.cff", r"^version: (.*)$", f"version: {version}")


def replace_line(path: Path, pattern: str, line: str) -> None:
    """Replace the one line that a pattern finds."""
    text, found = re.subn(pattern, line, path.read_text(), flags=re.M)
    if found != 1:
        sys.exit(f"{path}: {found} lines like {pattern}; allowed: one")
    path.write_text(text)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
