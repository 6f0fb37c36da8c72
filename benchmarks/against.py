"""CPU time of this checkout against an earlier commit: ``python -m benchmarks --against COMMIT [--only NAME ...]
[--rounds 8]``.

The commit is built beside, in a folder of its own with an environment of its own. Both do the same units of work in
turn, here, there, there, here ..., so that what else the machine does strikes both. The ratio is that of the sums; its
95 % interval is bootstrapped over rounds. Where that holds 1, the line says "noise".
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parents[1]
HISTORY = HERE / "benchmarks" / "history"
CROWD = ("world=warehouse", "task.pedestrians=10")
TRIVIAL = ("run", "robot=jackal", "world=empty", "task.pedestrians=0", "executor=serial", "episodes=1", "report=false")
EPISODES = {
    f"{planner} {robot}": [f"planner={planner}", f"robot={robot}", *CROWD]
    for planner, robots in (
        ("dwa", ("turtlebot3", "jackal", "robotino")),
        ("teb", ("turtlebot3", "jackal")),
        ("mppi", ("turtlebot3", "jackal")),
        ("mpc", ("turtlebot3", "jackal")),
        ("orca", ("jackal",)),
        ("rosnav", ("jackal",)),
        ("gring", ("jackal",)),
        ("navrep", ("jackal",)),
        ("aio", ("jackal",)),
    )
    for robot in robots
}
COMMANDS = {
    "arena list": ["arena", "list", "planner"],
    "trivial pure_pursuit": ["arena", *TRIVIAL, "planner=pure_pursuit"],
    "trivial dwa": ["arena", *TRIVIAL, "planner=dwa"],
    "multirun of 12": ["arena", TRIVIAL[0], "-m", *TRIVIAL[1:], "planner=pure_pursuit", "seed=range(0,12)"],
}


class WorkerEnded(Exception):
    """A unit of work ended its worker: what one of two commits cannot do cannot be compared."""


class Checkout:
    """A checkout that works when told."""

    def __init__(self, folder: Path) -> None:
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        self._process = subprocess.Popen(
            [folder / ".venv" / "bin" / "python", HERE / "benchmarks" / "against_worker.py"],
            cwd=folder,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def run_unit(self, unit: dict[str, Any]) -> dict[str, float]:
        """Have a unit of work done and return what it took."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(json.dumps(unit), file=self._process.stdin, flush=True)
        answer = self._process.stdout.readline()
        if not answer:
            raise WorkerEnded(f"could not be compared: a worker ended with status {self._process.wait()} at {unit}")
        return json.loads(answer)  # type: ignore[no-any-return]

    def end(self) -> None:
        """Let the process end."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()


@contextmanager
def build_checkout(commit: str) -> Iterator[tuple[Path, str]]:
    """Check out a commit beside and set it up; a folder that holds such a checkout already is used as it is."""
    if Path(commit, ".venv").is_dir():
        yield Path(commit).resolve(), _run_git(Path(commit), "rev-parse", "--short", "HEAD")
        return
    with tempfile.TemporaryDirectory() as parent:
        folder = Path(parent) / "before"
        subprocess.run(["git", "clone", "--quiet", HERE, folder], check=True)
        _run_git(folder, "checkout", "--quiet", _run_git(HERE, "rev-parse", commit))
        print(f"building {commit} ...", file=sys.stderr)
        subprocess.run(["make", "setup"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        yield folder, _run_git(folder, "rev-parse", "--short", "HEAD")


def compare_unit(name: str, before: Checkout, after: Checkout, rounds: int) -> dict[str, Any]:
    """Do the unit of this name in both checkouts in turn; return seconds a control step or
    command, and the ratio with its interval.
    """
    units: list[dict[str, Any]]
    if name in EPISODES:
        units = [{"work": "episode", "overrides": EPISODES[name], "episode": episode} for episode in range(rounds)]
    else:
        units = [{"work": "command", "words": COMMANDS[name]} for _ in range(rounds)]
    for checkout in (before, after):  # compiles
        checkout.run_unit(units[0])
    took: dict[str, list[dict[str, float]]] = {"before": [], "after": []}
    for k, unit in enumerate(units):
        both = [("before", before), ("after", after)]
        for which, checkout in both if k % 2 else both[::-1]:
            took[which].append(checkout.run_unit(unit))
    return {
        "name": name,
        **_summarise_unit(took["before"], took["after"], "seconds"),
        "planner": _summarise_unit(took["before"], took["after"], "planner"),
    }


def _summarise_unit(before: Sequence[dict[str, float]], after: Sequence[dict[str, float]], what: str) -> dict[str, Any]:
    b, a = (np.array([(one[what], one["count"]) for one in side]) for side in (before, after))
    if b[:, 0].sum() == 0.0:
        return {}
    each_before, each_after = b[:, 0].sum() / b[:, 1].sum(), a[:, 0].sum() / a[:, 1].sum()
    draws = np.random.default_rng(0).integers(0, len(b), (2000, len(b)))
    drawn = (a[draws, 0].sum(1) / a[draws, 1].sum(1)) / (b[draws, 0].sum(1) / b[draws, 1].sum(1))
    low, high = np.percentile(drawn, (2.5, 97.5)).tolist()
    return {
        "before_ms": 1e3 * each_before,
        "after_ms": 1e3 * each_after,
        "ratio": each_after / each_before,
        "low": low,
        "high": high,
        "noise": low <= 1.0 <= high,
        "spread": float(np.std(a[:, 0] / a[:, 1] / (b[:, 0] / b[:, 1]))),
    }


def format_line(row: dict[str, Any]) -> str:
    """Return the line of one unit."""
    planner = row["planner"]
    own = (
        f"   planner {planner['before_ms']:6.2f} {planner['after_ms']:6.2f} {planner['ratio']:5.2f}" if planner else ""
    )
    verdict = "noise" if row["noise"] else ""
    interval = f"[{row['low']:.2f}, {row['high']:.2f}]"
    return (
        f"{row['name']:22}{row['before_ms']:9.2f}{row['after_ms']:9.2f}{row['ratio']:7.2f} {interval:14} "
        f"{verdict:6}{own}"
    )


def machine_facts() -> dict[str, Any]:
    """Return what the figures were measured on."""
    cpuinfo = Path("/proc/cpuinfo")
    names = (
        [text.partition(":")[2].strip() for text in cpuinfo.read_text().splitlines() if text.startswith("model name")]
        if cpuinfo.exists()
        else []
    )
    return {
        "processor": names[0] if names else platform.processor(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
    }


def main(words: Sequence[str]) -> int:
    """Compare, print a line a unit, and keep the figures in the history."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument(
        "--against", required=True, metavar="COMMIT", help="a commit, or the folder of a checkout that is set up"
    )
    parser.add_argument("--only", nargs="+", choices=[*EPISODES, *COMMANDS], default=[*EPISODES, *COMMANDS])
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--keep", action="store_true", help=f"write the figures to {HISTORY.relative_to(HERE)}")
    given = parser.parse_args(list(words))
    rows = []
    with build_checkout(given.against) as (folder, commit):
        before, after = Checkout(folder), Checkout(HERE)
        print(f"{'CPU time in ms':22}{commit:>9}{'here':>9}{'ratio':>7}")
        for name in given.only:
            try:
                rows.append(compare_unit(name, before, after, given.rounds))
            except WorkerEnded as error:
                print(f"{name:22}{error}", flush=True)
                before, after = Checkout(folder), Checkout(HERE)
            else:
                print(format_line(rows[-1]), flush=True)
        before.end()
        after.end()
    if given.keep:
        now = _run_git(HERE, "rev-parse", "--short", "HEAD")
        HISTORY.mkdir(exist_ok=True)
        content = {"before": commit, "after": now, "machine": machine_facts(), "rounds": given.rounds, "rows": rows}
        (HISTORY / f"{commit}_{now}.json").write_text(json.dumps(content, indent=2) + "\n")
    return 0


def _run_git(folder: Path, *words: str) -> str:
    return subprocess.run(["git", "-C", folder, *words], check=True, capture_output=True, text=True).stdout.strip()
