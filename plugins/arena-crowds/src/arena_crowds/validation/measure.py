"""``arena crowd measure``: how far and how fast people walk in worlds, and how often a robot meets them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import random_generator
from arena_core.commands import key_value, read_words
from arena_core.files import csv_text, write_text_whole
from arena_core.parameters import Positive, PositiveInt
from arena_crowds.validation.findings import table_lines
from arena_crowds.validation.measured_runs import (
    Extent,
    benchmark_of,
    driven_episodes,
    save_episodes,
    standing_episodes,
)
from arena_crowds.validation.tracks_picture import draw_tracks
from arena_crowds.validation.walk_record import WalkRecord, free_area, waypoint_spans

USAGE = (
    "arena crowd measure [world=W,...] [robot=R,...] [planner=P] [against=SCENARIO.json] [episodes=N] "
    "[seconds=S] [minutes=M] [out=DIR] "
    "[OVERRIDE ...]"
)
WORLDS, ROBOTS = "warehouse,indoor,outdoor", "turtlebot3"
EXTENT = {"episodes": (PositiveInt, 10), "seconds": (Positive, 60.0), "minutes": (Positive, 30.0)}
OURS = ("world", "robot", "against", "out", *EXTENT)
RESAMPLES = 5000
DENSE = 100.0  # m^2


@dataclass(frozen=True, slots=True)
class MeasureRequest:
    """What is measured: every world with every robot; with ``against`` the random task and that
    scenario file, phases drawn.
    """

    worlds: tuple[str, ...]
    robots: tuple[str, ...]
    against: str | None
    extent: Extent
    out: Path
    overrides: tuple[str, ...]

    @property
    def planner(self) -> str | None:
        """Return who drives, None for a robot that stands."""
        return dict(map(key_value, self.overrides)).get("planner")


def run_measurement(words: Sequence[str]) -> int:
    """Measure, print the table and write it with records and pictures."""
    request = read_request(words)
    rows = []
    for world in request.worlds:
        for robot in request.robots:
            rows += _measure_rows(request, world, robot)
    print(table_lines(rows))
    write_text_whole(request.out / "measure.csv", csv_text([rows[0], *([row[key] for key in rows[0]] for row in rows)]))
    print(f"written: {request.out / 'measure.csv'}, and records and tracks.png below {request.out}")
    return 0


def read_request(words: Sequence[str]) -> MeasureRequest:
    """Read the command line; raise ConfigurationError for what is no number, or no word of the form KEY=VALUE."""
    given = read_words(USAGE, words, keys=OURS, overrides=None)
    worlds, robots = (
        tuple(given.keys.get(name, usual).split(",")) for name, usual in (("world", WORLDS), ("robot", ROBOTS))
    )
    extent = Extent(*(given.value(name, *how) for name, how in EXTENT.items()))
    return MeasureRequest(
        worlds, robots, given.keys.get("against"), extent, Path(given.keys.get("out", "walks")), given.overrides
    )


def _measure_rows(request: MeasureRequest, world: str, robot: str) -> list[dict[str, Any]]:
    """Return the rows of one world and robot: of the task, or of the scenario file and of a
    random task with as many people.
    """
    base = [f"world={world}", f"robot={robot}", *request.overrides]
    if request.against is None:
        return [_table_row(request, world, robot, _record_walks(request, base, f"{world}-{robot}", phased=False))]
    fixed = [*base, "task=scenario", f"task.path={request.against}"]
    theirs = _record_walks(
        request, [word for word in fixed if not _is_random_override(word)], f"{world}-{robot}-scenario", phased=True
    )
    people = f"task.pedestrians={len(theirs[0].scenario.pedestrians)}"
    ours = _record_walks(request, [*base, "task=random", people], f"{world}-{robot}-random", phased=False)
    row, other = _table_row(request, world, robot, ours), _table_row(request, world, robot, theirs)
    low, high = ratio_interval(ours, theirs)
    ratio = float(row["encounters_per_min"]) / max(float(other["encounters_per_min"]), 1e-9)
    return [{**other, "ratio": "1"}, {**row, "ratio": f"{ratio:.2f} [{low:.2f}-{high:.2f}]"}]


def _is_random_override(word: str) -> bool:
    """Return whether an override is of the random task alone."""
    return word.startswith("task.") and not word.startswith("task.path=")


def _record_walks(request: MeasureRequest, overrides: Sequence[str], name: str, *, phased: bool) -> list[WalkRecord]:
    folder = request.out / name
    benchmark = benchmark_of(overrides, phased=phased)
    walked = (
        standing_episodes(benchmark, request.extent)
        if request.planner is None
        else driven_episodes(benchmark, request.extent, folder)
    )
    save_episodes(walked, folder)
    draw_tracks(walked, folder / "tracks.png")
    return walked


def _table_row(request: MeasureRequest, world: str, robot: str, walked: Sequence[WalkRecord]) -> dict[str, Any]:
    scenario = walked[0].scenario
    free = float(np.mean([free_area(each.scenario.world.grid) for each in walked]))
    people = float(np.mean([len(each.scenario.pedestrians) for each in walked]))
    spans, paces = np.concatenate([each.spans() for each in walked]), np.concatenate([each.paces() for each in walked])
    standing = np.concatenate([each.standing() for each in walked])
    low, high = rate_interval(walked)
    return {
        "world": scenario.world.name if scenario.world.name != world else world,
        "robot": robot,
        "driven_by": request.planner or "stands",
        "problems": scenario.name.split("/")[0],
        "people": f"{people:.3g}",
        "free_m2": f"{free:.0f}",
        "people_per_100_m2": f"{DENSE * people / free:.2f}",
        "waypoint_span_m": f"{np.concatenate([waypoint_spans(each.scenario) for each in walked]).mean():.1f}",
        "track_span_m": f"{spans.mean():.1f}",
        "within_1_m_%": f"{100 * (spans < 1.0).mean():.1f}",
        "pace": f"{paces.mean():.2f}",
        "longest_stand_s": f"{standing[:, 0].max():.1f}",
        "at_wall_s": f"{standing[:, 1].max():.1f}",
        "minutes": f"{sum(each.minutes for each in walked):.0f}",
        "encounters_per_min": f"{_encounter_rate(_encounter_counts(walked)):.2f}",
        "low": f"{low:.2f}",
        "high": f"{high:.2f}",
    }


def rate_interval(walked: Sequence[WalkRecord]) -> tuple[float, float]:
    """Return the 95 % bootstrap interval of encounters a minute, over episodes."""
    return _percentile_interval(_bootstrap_rates(walked, "rate"))


def ratio_interval(walked: Sequence[WalkRecord], others: Sequence[WalkRecord]) -> tuple[float, float]:
    """Return the 95 % bootstrap interval of the ratio of two rates, over the episodes of each."""
    return _percentile_interval(
        _bootstrap_rates(walked, "ratio") / np.maximum(_bootstrap_rates(others, "ratio of"), 1e-9)
    )


def _encounter_counts(walked: Sequence[WalkRecord]) -> NDArray[np.float64]:
    """Return encounters and minutes of each episode, (E, 2)."""
    return np.array([(each.encounters(), each.minutes) for each in walked], float)


def _encounter_rate(counts: NDArray[np.float64]) -> NDArray[np.float64]:
    total = counts.sum(axis=-2)
    return np.asarray(total[..., 0] / total[..., 1])


def _bootstrap_rates(walked: Sequence[WalkRecord], stream: str) -> NDArray[np.float64]:
    counts = _encounter_counts(walked)
    chosen = random_generator(0, "crowd measure", stream).integers(len(counts), size=(RESAMPLES, len(counts)))
    return _encounter_rate(counts[chosen])


def _percentile_interval(values: NDArray[np.float64]) -> tuple[float, float]:
    low, high = np.percentile(values, (2.5, 97.5))
    return float(low), float(high)
