"""Inputs that once took gigabytes or minutes: each is refused in one line by the command that
reads it, within 5 s and 1 GB.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arena_core.loop.record_files import write_record
from arena_core.records import read_record
from tests.fuzz.readers import beside_run

SECONDS, KILOBYTES = 5.0, 1_000_000  # of the processor's time, of memory
BOMB = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{new}: &{new} [{','.join([f'*{old}'] * 9)}]\n" for old, new in zip("abcdef", "bcdefg", strict=True)
)


def far(name: str, place: object, value: float) -> Callable[[Path], None]:
    """Return what writes a run with one number of one record far off."""

    def write(folder: Path) -> None:
        beside_run(folder / "run")
        good = read_record(folder / "run" / "records" / "0001.npz")
        array = np.array(good[name], np.float64)
        array[place] = value  # type: ignore[index]
        write_record(folder / "run", 1, replace(good, arrays={**good.arrays, name: array}))

    return write


def text(name: str, content: str | bytes) -> Callable[[Path], None]:
    """Return what writes one file."""

    def write(folder: Path) -> None:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)

    return write


def picture(content: bytes) -> Callable[[Path], None]:
    """Return what writes a map of one picture."""

    def write(folder: Path) -> None:
        text(
            "map.yaml",
            "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: "
            "0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        )(folder)
        text("map.pgm", content)(folder)

    return write


def model(content: str) -> Callable[[Path], None]:
    """Return what writes a body's own model."""
    body = "<worldbody><body name='a'><freejoint/><geom size='1'/></body></worldbody>"
    return text("own.xml", f"<mujoco>{content}{body}</mujoco>")


FAR_POSE, FAR_STAMP = far("pose", (5, 0), 6e6), far("stamp", slice(7, None), 1e8)
MAP = ["run", "planner=dwa", "world=ros_map", "world.path=map.yaml"]
OWN = ["run", "planner=dwa", "simulator=mujoco", "simulator.body.model=own.xml"]
INPUTS = {
    "a pose far off, evaluated": (FAR_POSE, ["evaluate", "run"]),
    "a pose far off, reported": (FAR_POSE, ["report", "run"]),
    "a pose far off, replayed": (FAR_POSE, ["replay", "run", "1", "--to", "a.html"]),
    "a stamp far off, evaluated": (FAR_STAMP, ["evaluate", "run"]),
    "a stamp far off, reported": (FAR_STAMP, ["report", "run"]),
    "a stamp without end, replayed": (far("stamp", -1, np.inf), ["replay", "run", "1", "--to", "a.png"]),
    "a stamp without end, exported": (far("stamp", -1, np.inf), ["ros", "export", "run", "--to", "a.mcap"]),
    "a configuration of aliases": (text("conf/planner/mine.yaml", f"{BOMB}name: dwa\n"), ["run", "planner=mine"]),
    "a list of aliases": (text("conf/planner/mine.yaml", f"{BOMB}name: dwa\n"), ["list", "planner"]),
    "a comment without end": (picture(b"P5\n#" + b"x" * 60_000_000 + b"\n2 2\n255\n0000"), MAP),
    "a picture of one row": (picture(b"P5\n49000000 1\n255\n" + bytes(49_000_000)), MAP),
    "a height field": (model("<asset><hfield name='h' nrow='60000' ncol='60000' size='1 1 1 1'/></asset>"), OWN),
    "user data": (model("<size nuserdata='2000000000'/>"), OWN),
    "replicates": (model("<worldbody><replicate count='1000000000'><geom size='1'/></replicate></worldbody>"), OWN),
}


# The peak is that of the program alone: what the kernel tells of a child begins with the memory of the program that
# started it.
APART = r"""
import os, re, sys
from pathlib import Path
folder = Path(sys.argv.pop(1))
os.chdir(folder)
from arena_core.cli.main import main
try:
    status = main()
finally:
    own = Path("/proc/self/status")
    if own.is_file():
        (folder / "peak").write_text(re.search(r"VmHWM:\s+(\d+) kB", own.read_text())[1])
sys.exit(status)
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", INPUTS)
def test_an_input_takes_neither_the_machines_memory_nor_its_time(name: str, tmp_path: Path) -> None:
    write, words = INPUTS[name]
    write(tmp_path)
    pid = os.posix_spawn(
        sys.executable,
        [sys.executable, "-c", APART, str(tmp_path), *words],
        os.environ,
        file_actions=[(os.POSIX_SPAWN_OPEN, 2, str(tmp_path / "errors"), os.O_WRONLY | os.O_CREAT, 0o600)],
    )
    _, status, taken = os.wait4(pid, 0)
    lines = (tmp_path / "errors").read_text().splitlines()
    assert os.waitstatus_to_exitcode(status) == 2, lines
    assert len(lines) == 1 and lines[0].startswith("arena: "), lines  # noqa: PT018
    assert taken.ru_utime + taken.ru_stime < SECONDS
    assert not (tmp_path / "peak").exists() or int((tmp_path / "peak").read_text()) < KILOBYTES
