"""Trajectories for social navigation surveys, in the layout of SocNav3.

Source of the layout: P. Bachiller-Burgos et al., *Towards Data-Driven Metrics for Social Robot Navigation
Benchmarking*, arXiv 2509.01251, and what its dataset's tools read. One file holds one trajectory.
"""

from __future__ import annotations

import json
import math
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core import ArenaError, EpisodeRecord, OccupancyGrid
from arena_core.files import write_text_whole
from arena_core.records import Export, read_grid, read_record, record_digest, record_path
from arena_export.walls import wall_segments

DIGITS = 4  # of lengths (m), angles (rad) and times (s): a tenth of a millimetre
DRIVES = {"differential": "differential", "omnidirectional": "omni", "ackermann": "ackerman"}  # theirs has one n
GOALS = {"follow": "follow", "lead": "guide-to"}  # by how a robot keeps a person company; all else is go-to
UNKNOWN, FREE, OCCUPIED = -1, 0, 1
ALL_ROUND = math.pi  # rad: a goal's heading does not count


class SocNavExport(Export):
    """One JSON file an episode, for SocNav3's tools and surveys."""

    help: ClassVar[str] = "trajectories in the layout of SocNav3, one file an episode, to be rated by people"
    ending: ClassVar[str] = ""

    def write(self, folder: Path, target: Path, episodes: Sequence[int]) -> None:
        """Write a folder of files named by ``trajectory_name``, whole or not at all."""
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=target.parent, prefix=f".{target.name}.") as beside:
                for number in episodes:
                    record = read_record(record_path(folder, number))
                    text = json.dumps(trajectory_of(record, _grid_of(folder, record)), separators=(",", ":"))
                    write_text_whole(Path(beside) / "all" / f"{trajectory_name(record)}.json", text + "\n")
                (Path(beside) / "all").rename(target)
        except OSError as error:
            raise ArenaError(f"cannot write {target}: {error.strerror or error}") from None


def trajectory_name(record: EpisodeRecord) -> str:
    """Return what a rating calls a trajectory: planner, robot, episode, and the record's digest, which no other has."""
    columns = record.meta["columns"]
    plain = "".join(c if c.isalnum() or c == "-" else "_" for c in f"{columns['preset']}-{columns['robot']}")
    return f"{plain}-{int(columns['episode']):04d}-{record_digest(record)}"


def trajectory_of(record: EpisodeRecord, grid: OccupancyGrid | None) -> dict[str, Any]:
    """Return an episode in the layout of SocNav3: lengths m, angles rad, times s, all in the map's frame.

    The robot's speeds are those along the map's axes. People face the way they walk, and keep that while they stand.
    Who is not there in a row is left out of it. A goal has no heading: its tolerance is all round.
    """
    columns = record.meta["columns"]
    return {
        "metadata": {
            "name": trajectory_name(record),
            "source": "arena suite",
            "outcome": record.meta["outcome"],
            **{key: columns[key] for key in ("planner", "preset", "robot", "world", "scenario", "seed", "episode")},
        },
        "context_description": _context(record),
        "sequence": _sequence(record),
        "grid": _grid_part(grid),
        "walls": [] if grid is None else _rounded(wall_segments(grid)),
    }


def _grid_of(folder: Path, record: EpisodeRecord) -> OccupancyGrid | None:
    name = record.meta["world"].get("grid")
    return read_grid(folder / name) if name else None


def _context(record: EpisodeRecord) -> str:
    """Return the situation in a sentence, which a survey may replace by another."""
    manner = (record.meta["scenario"].get("company") or {}).get("manner")
    if manner is None:
        return "A robot goes to a place."
    return {"follow": "A robot follows a person.", "lead": "A robot leads a person to a place."}.get(
        manner, "A robot accompanies a person."
    )


def _sequence(record: EpisodeRecord) -> list[dict[str, Any]]:
    pose, twist = record["pose"], record["twist"]
    cosine, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    speeds = [cosine * twist[:, 0] - sine * twist[:, 1], sine * twist[:, 0] + cosine * twist[:, 1], twist[:, 2]]
    rows = _rounded(np.column_stack([record["stamp"], pose, *speeds]))
    people = _people(record)
    shape, goal, objects = _robot_shape(record), _goal(record), _objects(record)
    drive = DRIVES[record.meta["robot"]["kinematics"]]
    return [
        {
            "timestamp": stamp,
            "robot": {
                "shape": shape,
                "drive": drive,
                **dict(zip(("x", "y", "angle", "speed_x", "speed_y", "speed_a"), state, strict=True)),
            },
            "goal": goal,
            "people": present,
            "objects": objects,
        }
        for (stamp, *state), present in zip(rows, people, strict=True)
    ]


def _people(record: EpisodeRecord) -> list[list[dict[str, Any]]]:
    ids = record["pedestrian_ids"].tolist()
    places = np.asarray(record["pedestrian_positions"], np.float64)
    facing = facings(np.asarray(record["pedestrian_velocities"], np.float64))
    found = _rounded(np.concatenate([places, facing[..., None]], axis=2))
    there = np.isfinite(places[..., 0])
    return [
        [
            {"id": number, "x": x, "y": y, "angle": angle}
            for number, (x, y, angle), known in zip(ids, row, present.tolist(), strict=True)
            if known
        ]
        for row, present in zip(found, there, strict=True)
    ]


def facings(velocities: NDArray[np.float64], least: float = 0.1) -> NDArray[np.float64]:
    """Return (T, P) rad: the directions of velocities (T, P, 2) m/s; below ``least`` m/s the last one, or the first
    one to come, or 0.
    """
    moving = np.hypot(velocities[..., 0], velocities[..., 1]) >= least  # of NaN: not
    rows = np.arange(len(velocities))[:, None]
    last = np.maximum.accumulate(np.where(moving, rows, -1), axis=0)
    first = np.where(moving.any(axis=0), moving.argmax(axis=0), 0)
    taken = np.where(last < 0, first, last)
    chosen = np.take_along_axis(velocities, taken[..., None], axis=0)
    still = ~np.take_along_axis(moving, taken, axis=0)
    return np.asarray(np.where(still, 0.0, np.arctan2(chosen[..., 1], chosen[..., 0])))


def _robot_shape(record: EpisodeRecord) -> dict[str, Any]:
    """Return the footprint: a circle, or the polygon with the rectangle around it, length along the robot's x."""
    footprint = record.meta["robot"]["footprint"]
    return _shape(footprint["vertices_xy"], footprint["radius"])


def _shape(vertices: Sequence[Sequence[float]], radius: float) -> dict[str, Any]:
    if not len(vertices):
        return {"type": "circle", "width": round(2.0 * radius, DIGITS), "length": round(2.0 * radius, DIGITS)}
    points = np.asarray(vertices, np.float64)
    length, width = (points.max(axis=0) - points.min(axis=0)).tolist()
    sides = {"width": round(width, DIGITS), "length": round(length, DIGITS)}
    if math.isclose(_area(points), length * width, rel_tol=1e-6):
        return {"type": "rectangle", **sides}
    return {"type": "polygon", **sides, "points": _rounded(points)}


def _area(points: NDArray[np.float64]) -> float:
    """Return the area of a polygon (shoelace formula)."""
    x, y = points.T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0)


def _goal(record: EpisodeRecord) -> dict[str, Any]:
    """Return the scenario's goal, with the person whom the robot follows or leads."""
    scenario = record.meta["scenario"]
    company = scenario.get("company") or {}
    x, y, angle = _rounded(np.array(scenario["goal"]))
    return {
        "type": GOALS.get(company.get("manner", ""), "go-to"),
        "human": company.get("person"),
        "x": x,
        "y": y,
        "angle": angle,
        "pos_threshold": round(float(scenario["goal_radius"]), DIGITS),
        "angle_threshold": round(ALL_ROUND, DIGITS),
    }


def _objects(record: EpisodeRecord) -> list[dict[str, Any]]:
    """Return the obstacles and the furniture of the scenario."""
    scenario = record.meta["scenario"]
    found = [*_obstacles(scenario["obstacles"]), *map(_piece, scenario.get("furniture", ()))]
    return [{"id": number, **thing} for number, thing in enumerate(found)]


def _obstacles(obstacles: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return obstacles, each about its own middle."""
    found = []
    for obstacle in obstacles:
        points = np.asarray(obstacle["vertices_xy"], np.float64)
        low, high = points.min(axis=0), points.max(axis=0)
        middle = (low + high) / 2.0
        shape = _shape((points - middle).tolist() if len(points) > 2 else [], obstacle["radius"])
        x, y = _rounded(middle)
        found.append({"type": "obstacle", "x": x, "y": y, "angle": 0.0, "shape": shape})
    return found


def _piece(furniture: Mapping[str, Any]) -> dict[str, Any]:
    """Return a piece of furniture as the rectangle about its pose that holds its solids."""
    reaches = [
        (abs(x) + _half(length, width, yaw), abs(y) + _half(width, length, yaw))
        for x, y, yaw, length, width, *_ in furniture["boxes"]
    ]
    reaches += [(abs(x) + radius, abs(y) + radius) for x, y, radius, *_ in furniture["cylinders"]]
    length, width = 2.0 * max(along for along, _ in reaches), 2.0 * max(across for _, across in reaches)
    x, y, angle = _rounded(np.array(furniture["pose"]))
    shape = {"type": "rectangle", "width": round(width, DIGITS), "length": round(length, DIGITS)}
    return {"type": furniture["kind"], "x": x, "y": y, "angle": angle, "shape": shape}


def _half(along: float, across: float, yaw: float) -> float:
    """Return how far a turned rectangle reaches from its middle."""
    return abs(along * math.cos(yaw)) / 2.0 + abs(across * math.sin(yaw)) / 2.0


def _grid_part(grid: OccupancyGrid | None) -> Mapping[str, Any]:
    """Return the map: cells by rows, the first at the top; x_orig and y_orig are its lower left corner."""
    if grid is None:
        return {"width": 0, "height": 0, "cell_size": 0.05, "x_orig": 0.0, "y_orig": 0.0, "angle_orig": 0.0, "data": []}
    cells = np.full(grid.data.shape, FREE, np.int8)
    cells[grid.data < 0], cells[grid.occupied] = UNKNOWN, OCCUPIED
    x, y, theta = _rounded(grid.origin.array())
    place = {"x_orig": x, "y_orig": y, "angle_orig": theta}
    sides = {"width": grid.data.shape[1], "height": grid.data.shape[0], "cell_size": grid.resolution}
    return {**sides, **place, "data": cells[::-1].tolist()}


def _rounded(values: NDArray[Any]) -> Any:
    """Return figures as plain numbers, rounded; there is no minus zero."""
    return (np.round(np.asarray(values, np.float64), DIGITS) + 0.0).tolist()
