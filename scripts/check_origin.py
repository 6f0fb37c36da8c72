#!/usr/bin/env python3
"""Check that every installed distribution arena-* is the wheel of that name in a folder, file by file.

usage: ENVIRONMENT/bin/python scripts/check_origin.py DIR
"""

from __future__ import annotations

import sys
import zipfile
from importlib.metadata import Distribution, distributions
from pathlib import Path


def main(folder: Path) -> None:
    """Exit with a line for the first distribution that is another's."""
    installed = [found for found in distributions() if found.metadata["Name"].startswith("arena-")]
    if not installed:
        sys.exit("no distribution arena-* is installed")
    for found in installed:
        name = found.metadata["Name"]
        wheel = folder / f"{name.replace('-', '_')}-{found.version}-{tag_of(found)}.whl"
        if not wheel.is_file():
            sys.exit(f"{name} {found.version} is installed, which is not in {folder}")
        if different := other_files(found, wheel):
            sys.exit(f"{name} is not the one of {folder}: {different[0]} differs")


def tag_of(found: Distribution) -> str:
    """Return for which Pythons and platforms the wheel is that was installed."""
    lines = (found.read_text("WHEEL") or "").splitlines()
    return next((line.removeprefix("Tag: ") for line in lines if line.startswith("Tag: ")), "py3-none-any")


def other_files(found: Distribution, wheel: Path) -> list[str]:
    """Return the files of a wheel that are not installed as they are in it; RECORD is the installer's."""
    with zipfile.ZipFile(wheel) as archive:
        names = [name for name in archive.namelist() if not name.endswith("/RECORD")]
        return [name for name in names if not is_same_file(Path(str(found.locate_file(name))), archive.read(name))]


def is_same_file(path: Path, content: bytes) -> bool:
    """Return whether a file has this content."""
    return path.is_file() and path.read_bytes() == content


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
