"""Measure the import of recordings: a bag of 60 s, and the most memory of one of 100 MB beside that of a longer one.

    python benchmarks/ros_bags.py [--megabytes 1000]

Recordings are of a laboratory: odometry, transforms, a scan of 360 beams, five people and commands 20 times a second;
the long ones have pictures beside. Each is imported in a process of its own.
"""

from __future__ import annotations

import argparse
import os
import statistics
from dataclasses import astuple
from pathlib import Path
from tempfile import TemporaryDirectory

from arena_ros.testing.recordings import PICTURES, import_apart, write_laboratory

ENDINGS = (".bag", ".mcap")
SHORT = 60.0  # s
REPEATS = 5
PICTURE = 200_000  # bytes; with PICTURES, 2 MB/s


def measure_short(folder: Path, ending: str) -> None:
    """Print what a bag of a minute takes."""
    bag = write_laboratory(folder / f"short{ending}", SHORT)
    found = [import_apart(bag, folder / f"short{ending}_{k}") for k in range(REPEATS)]
    wall, cpu, whole, memory = (statistics.median(each) for each in zip(*map(astuple, found), strict=True))
    size = bag.stat().st_size / 1e6
    print(
        f"{ending}: {SHORT:g} s, {size:.1f} MB: {wall:.2f} s, of CPU {cpu:.2f} s, with its process {whole:.2f} s; "
        f"{memory:.0f} MB",
        flush=True,
    )


def measure_long(folder: Path, ending: str, megabytes: float) -> None:
    """Print the memory and the pace of one long recording."""
    seconds = megabytes * 1e6 / (PICTURE * PICTURES)
    bag = write_laboratory(folder / f"{megabytes:.0f}{ending}", seconds, PICTURE)
    took, size = import_apart(bag, folder / f"{megabytes:.0f}{ending}_out"), bag.stat().st_size / 1e6
    print(
        f"{ending}: {seconds:.0f} s, {size:.0f} MB: {took.seconds:.1f} s, of CPU {took.cpu_seconds:.1f} s; "
        f"{took.megabytes:.0f} MB",
        flush=True,
    )
    bag.unlink()


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--megabytes", type=float, default=1000.0)
    chosen = parser.parse_args()
    with TemporaryDirectory() as name:
        for ending in ENDINGS:
            measure_short(Path(name), ending)
            for megabytes in (100.0, chosen.megabytes):
                measure_long(Path(name), ending, megabytes)
    print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} hyperthreads")


if __name__ == "__main__":
    main()
