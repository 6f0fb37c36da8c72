"""``arena iso18646``: navigation as ISO 18646-2 names it, from the trials of ``experiment=iso18646``.

The standard's scope is public, its text is not. Accuracy and repeatability are those of ISO 9283; how many trials there
are, how long the courses are and what a deviation is measured from are ours (docs/iso18646.md).
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, InputFileError
from arena_core.commands import Command, align_columns, read_words
from arena_core.records import find_runs, is_success, read_record, record_paths

USAGE = "arena iso18646 DIR..."
COURSES = ("pose_accuracy", "path_deviation", "obstacle_static", "obstacle_moving")
PASSAGE = "passage_"
HEAD = (
    "robot",
    "planner",
    "localizer",
    "trials",
    "accuracy [m]",
    "repeatability [m]",
    "deviation [m]",
    "static avoided",
    "gap [m]",
    "moving avoided",
    "gap [m]",
    "narrowest [m]",
    "over the robot [m]",
)


@dataclass(frozen=True, slots=True)
class Trial:
    """What one episode tells: where it ended off the goal (2,) m, how far it left the straight line, whether it arrived
    without contact, and its least gap, m.
    """

    off: NDArray[np.float64]
    deviation: float
    clean: bool
    gap: float
    width: float


class Iso18646Command(Command):
    """Print a table of a row a robot and planner."""

    help: ClassVar[str] = f"pose accuracy, path deviation, obstacles and narrow passages: {USAGE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Read the records of the runs below the folders; raise InputFileError where no trial is among them."""
        if "-h" in arguments or "--help" in arguments:
            print(self.help)
            return 0
        words = read_words(USAGE, arguments, names=None)
        folders = list(dict.fromkeys(run for name in words.names or (".",) for run in find_runs(Path(name))))
        trials = read_trials(folders)
        if not trials:
            raise InputFileError(f"{folders[0]}: holds no trial; allowed: runs of experiment=iso18646")
        print("\n".join(align_columns([HEAD, *(table_row(key, found) for key, found in sorted(trials.items()))])))
        return 0


Key = tuple[str, str, str]  # robot, planner, localiser


def read_trials(runs: Sequence[Path]) -> dict[Key, dict[str, list[Trial]]]:
    """Return the trials by robot, planner and localiser, then by course."""
    found: dict[Key, dict[str, list[Trial]]] = defaultdict(lambda: defaultdict(list))
    for run in runs:
        for path in record_paths(run):
            record = read_record(path)
            columns = record.meta["columns"]
            if str(columns.get("scenario_hash", "")).startswith("iso18646@"):
                course = record.meta["scenario"]["name"].partition("/")[0].removesuffix("_a")
                key = tuple(str(columns.get(name, "")) for name in ("robot", "planner", "localizer"))
                found[key][course].append(trial_of(record))  # type: ignore[index]
    return {key: dict(courses) for key, courses in found.items()}


def trial_of(record: EpisodeRecord) -> Trial:
    """Return what an episode tells, from the truth."""
    scenario, places = record.meta["scenario"], record["pose"][:, :2]
    start, goal = np.array(scenario["start"][:2]), np.array(scenario["goal"][:2])
    along = (goal - start) / math.dist(start, goal)
    offsets = places - start
    away = np.abs(offsets[:, 0] * along[1] - offsets[:, 1] * along[0])
    outline = record.meta["robot"]["footprint"]
    width = float(np.ptp(np.array(outline["vertices_xy"])[:, 1])) if outline["vertices_xy"] else 2.0 * outline["radius"]
    clean = is_success(record, collisions_allowed=0)
    return Trial(places[-1] - goal, float(away.max()), clean, float(record["clearance"].min()), width)


def pose_accuracy(off: NDArray[np.float64]) -> float:
    """Return the distance from the goal to the mean of the places attained, (N, 2) m off it (ISO 9283, AP)."""
    return float(np.hypot(*off.mean(axis=0)))


def pose_repeatability(off: NDArray[np.float64]) -> float:
    """Return the mean distance from the places' own mean and three standard deviations of it, m (ISO 9283, RP); NaN for
    a single trial.
    """
    if len(off) < 2:
        return math.nan
    away = np.hypot(*(off - off.mean(axis=0)).T)
    return float(away.mean() + 3.0 * away.std(ddof=1))


def narrowest_passage(courses: Mapping[str, Sequence[Trial]]) -> float:
    """Return the least width, m, from which on every trial of all passages was without contact; NaN for none."""
    widths = {int(name.removeprefix(PASSAGE)) / 100.0: trials for name, trials in courses.items() if PASSAGE in name}
    passed = math.nan
    for width in sorted(widths, reverse=True):
        if not all(trial.clean for trial in widths[width]):
            break
        passed = width
    return passed


def table_row(key: Key, courses: Mapping[str, Sequence[Trial]]) -> tuple[str, ...]:
    """Return the cells of a robot and planner; what was not driven is a dash."""
    pose, path, *obstacles = (courses.get(course, ()) for course in COURSES)
    off = np.array([trial.off for trial in pose]).reshape(-1, 2)
    narrowest = narrowest_passage(courses)
    wide = next(iter(courses.values()))[0].width
    return (
        *key,
        str(sum(map(len, courses.values()))),
        _number(pose_accuracy(off) if len(off) else math.nan),
        _number(pose_repeatability(off)),
        _number(float(np.mean([trial.deviation for trial in path])) if path else math.nan),
        *(cell for trials in obstacles for cell in _avoided(trials)),
        _number(narrowest, 2),
        _number(narrowest - wide, 2),
    )


def _avoided(trials: Sequence[Trial]) -> tuple[str, str]:
    if not trials:
        return "-", "-"
    return f"{sum(trial.clean for trial in trials)} of {len(trials)}", _number(min(trial.gap for trial in trials), 2)


def _number(value: float, digits: int = 3) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"
