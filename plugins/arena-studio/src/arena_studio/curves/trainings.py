"""A training's curves: its validations, and what it told TensorBoard, by steps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from arena_core import InputFileError
from arena_core.files import is_file, read_json
from arena_studio.curves.event_file import Scalars, join_scalars, read_scalars

ALLOWED = "what a training of the suite wrote"
AXES = ("steps", "epoch", "episodes")  # columns of a curve that others are drawn over, the first that is there
MOST_POINTS = 600  # of a line; a screen shows no more
VALIDATED = "validation: "
# Title, unit, and what is drawn: a name, the column of curve.json or the tag, and the factor it is shown with.
PANELS: tuple[tuple[str, str, tuple[tuple[str, str, float], ...]], ...] = (
    (
        "Success",
        "share of episodes",
        (
            ("validation: success", f"{VALIDATED}success", 1.0),
            ("validation: collision", f"{VALIDATED}collision", 1.0),
            ("validation: time out", f"{VALIDATED}time_out", 1.0),
            ("training: success", "train/success", 1.0),
        ),
    ),
    ("Reward", "of an episode", (("mean of the last 100", "rollout/ep_rew_mean", 1.0),)),
    ("Entropy", "nats, of the policy", (("entropy", "train/entropy_loss", -1.0),)),  # the loss is its negative
    ("Length", "steps of an episode", (("mean of the last 100", "rollout/ep_len_mean", 1.0),)),
    ("Collisions", "an episode, in training", (("training", "train/collisions", 1.0),)),
    ("Level", "of the curriculum", (("mean of the worlds", "train/level", 1.0),)),
    ("Exploration", "standard deviation of actions", (("standard deviation", "train/std", 1.0),)),
)
SAME = {
    "validation/success",
    "validation/collision",
    "training",
    "training_collisions",
    "level",
    "episodes",
}  # drawn already


def read_training(folder: Path) -> dict[str, Any]:
    """Return what a training wrote: its ``panels`` of lines, each of points (step, value), facts, test and choice.

    Raises InputFileError (one line) where a file is not what `arena train` writes.
    """
    config = _read_mapping(folder / "config.json")
    axis, columns = read_curve(folder / "curve.json")
    tags = join_scalars([read_scalars(path) for path in _event_files(folder)])
    lines = {**columns, **{name: points for name, points in tags.items() if points}}
    robot = config.get("robot")
    trained = _optional(folder / "policy.json").get("training")
    choice = trained.get("choice") if isinstance(trained, Mapping) else None
    score = _optional(folder / "test.json").get("score")
    return {
        "planner": _text(config.get("planner")),
        "robot": _text(robot.get("name") if isinstance(robot, Mapping) else robot),
        "seed": _number(config.get("seed")),
        "total": _number(config.get("total_steps")),
        "axis": axis,
        "last": max((points[-1][0] for points in lines.values() if points), default=0),
        "panels": make_panels(lines),
        "choice": choice.get("steps") if isinstance(choice, Mapping) else None,
        "test": score if isinstance(score, Mapping) else None,
    }


def read_curve(path: Path) -> tuple[str, Scalars]:
    """Return what a curve is over, and its columns; those of validations stand under ``validation: ``.

    Rows and values that are no numbers are left out.
    """
    if not is_file(path):
        return AXES[0], {}
    rows = read_json(path, ALLOWED)
    if not isinstance(rows, list) or not all(isinstance(row, Mapping) for row in rows):
        raise InputFileError(f"{path}: holds no list of rows; allowed: {ALLOWED}")
    axis = next((name for name in AXES if rows and _number(rows[0].get(name)) is not None), "")
    names = [name for name in dict.fromkeys(name for row in rows for name in row) if name != axis]
    validated = axis == AXES[0]
    found: Scalars = {}
    for name in names:
        points = [(_number(row.get(axis, place)), _number(row.get(name))) for place, row in enumerate(rows, 1)]
        known = [(int(at), value) for at, value in points if at is not None and value is not None]
        if known:
            found[f"{VALIDATED}{name}" if validated and name not in SAME else name] = known
    return axis or "row", found


def make_panels(lines: Scalars) -> list[dict[str, Any]]:
    """Return the panels that have something to show, the known ones first; each other line has one of its own.

    ``more`` are those that are folded: lines that are not known, and those that never change.
    """
    panels = []
    used = {key for _, _, series in PANELS for _, key, _ in series} | SAME
    for title, unit, series in PANELS:
        drawn = [(name, lines[key], factor) for name, key, factor in series if key in lines]
        if drawn:
            constant = all(value == points[0][1] for _, points, _ in drawn for _, value in points)
            panels.append(_panel(title, unit, drawn, more=constant))
    others = [name for name in lines if name not in used]
    known = bool(panels)
    return [*panels, *(_panel(name, "", [(name, lines[name], 1.0)], more=known) for name in others)]


def _panel(
    title: str, unit: str, drawn: Sequence[tuple[str, Sequence[tuple[int, float]], float]], *, more: bool
) -> dict[str, Any]:
    lines = [
        {"name": name, "points": [[at, factor * value] for at, value in thin(points)]} for name, points, factor in drawn
    ]
    return {"title": title, "unit": unit, "lines": lines, "more": more}


def thin(points: Sequence[tuple[int, float]]) -> list[tuple[int, float]]:
    """Return at most ``MOST_POINTS`` finite points of a line, the last among them."""
    known = [point for point in points if math.isfinite(point[1])]
    step = -(-len(known) // MOST_POINTS)
    return known[::-1][:: max(step, 1)][::-1]


def _event_files(folder: Path) -> list[Path]:
    """Return the event files of a training in order of time, which stands in their names."""
    return sorted((path for path in folder.glob("tensorboard/*/events*") if is_file(path)), key=lambda path: path.name)


def _read_mapping(path: Path) -> Mapping[str, Any]:
    found = read_json(path, ALLOWED)
    if not isinstance(found, Mapping):
        raise InputFileError(f"{path}: holds no mapping; allowed: {ALLOWED}")
    return found


def _optional(path: Path) -> Mapping[str, Any]:
    return _read_mapping(path) if is_file(path) else {}


def _text(value: object) -> str:
    if isinstance(value, Mapping):
        value = value.get("name")
    return value if isinstance(value, str) else ""


def _number(value: object) -> float | None:
    real = isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
    return float(value) if real else None  # type: ignore[arg-type]
