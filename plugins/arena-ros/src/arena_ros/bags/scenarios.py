"""``arena ros scenario-from``: the problems that a recording shows, as a scenario file: start, goal, and
the ways that people went.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, EpisodeRecord
from arena_core.commands import print_notice
from arena_core.files import write_text_whole
from arena_core.records import read_record, record_paths
from arena_ros.bags.importing import Request, import_bags

CORNER = 0.3  # m that a way of a person may be off the one that was recorded
STANDS = 0.5  # m within which a person who moves no farther stands
SLOWEST = 0.1  # m/s, slower than anybody walks


def scenario_from(paths: Sequence[Path], target: Path, request: Request) -> int:
    """Write the problems of recordings to a scenario file in our own format; return how many there are."""
    if target.exists():
        raise ConfigurationError(f"{target} is there already; allowed: a name that is free")
    with tempfile.TemporaryDirectory() as folder:
        import_bags(paths, Path(folder) / "run", request)
        records = [read_record(path) for path in record_paths(Path(folder) / "run")]
    problems = [_make_problem(record) for record in records]
    content: dict[str, Any] = {"format": "arena-scenario", "version": 2, "title": f"Recorded: {paths[0].name}"[:80]}
    if request.map is not None:
        content["map"] = str(request.map)
    target.parent.mkdir(parents=True, exist_ok=True)
    write_text_whole(target, json.dumps({**content, "scenarios": problems}, indent=2) + "\n")
    if all(record.meta.get("truth") == "odometry" for record in records):
        print_notice("start and goal are in the frame of the odometry, which has no map: no pose in map was recorded")
    return len(problems)


def _make_problem(record: EpisodeRecord) -> dict[str, Any]:
    scenario = record.meta["scenario"]
    people = [_make_person(record, k) for k in range(len(record["pedestrian_ids"]))]
    return {
        "name": scenario["name"],
        "start": [round(value, 3) for value in scenario["start"]],
        "goal": [round(value, 3) for value in scenario["goal"]],
        "goal_radius": scenario["goal_radius"],
        "time_limit": scenario["time_limit"],
        "pedestrians": [person for person in people if person is not None],
        "obstacles": [],
    }


def _make_person(record: EpisodeRecord, k: int) -> dict[str, Any] | None:
    """Return how a person starts, where it goes and how fast; None for who was seen but once."""
    seen = np.isfinite(record["pedestrian_positions"][:, k]).all(axis=1)
    if np.count_nonzero(seen) < 2:
        return None
    way, stamps = record["pedestrian_positions"][seen, k].astype(np.float64), record["stamp"][seen]
    person: dict[str, Any] = {"position": np.round(way[0], 3).tolist(), "radius": float(record["pedestrian_radii"][k])}
    if np.hypot(*(way - way[0]).T).max() < STANDS:
        return {**person, "waypoints": []}
    corners = way[simplify_path(way, CORNER)]
    steps, times = np.hypot(*np.diff(way, axis=0).T), np.diff(stamps)
    walking = steps / np.maximum(times, 1e-9) > SLOWEST
    speed = float(steps[walking].sum() / times[walking].sum()) if walking.any() else SLOWEST
    return {**person, "waypoints": np.round(corners, 3).tolist(), "desired_speed": round(speed, 3)}


def simplify_path(way: NDArray[np.float64], off: float) -> list[int]:
    """Return which points of a way (K, 2) are enough, none being farther off than ``off`` m
    (Douglas and Peucker 1973).
    """
    kept, parts = {0, len(way) - 1}, [(0, len(way) - 1)]
    while parts:
        first, last = parts.pop()
        if last - first < 2:
            continue
        along, inner = way[last] - way[first], way[first + 1 : last] - way[first]
        length = float(along @ along)
        share = np.clip(inner @ along / length, 0.0, 1.0) if length > 0.0 else np.zeros(len(inner))
        gaps = np.hypot(*(inner - share[:, None] * along).T)
        if gaps.max() > off:
            middle = first + 1 + int(gaps.argmax())
            kept.add(middle)
            parts += [(first, middle), (middle, last)]
    return sorted(kept)
