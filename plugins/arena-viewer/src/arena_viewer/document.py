"""The replay document: what a viewer needs of recorded episodes, in one small file (docs/replay.md has its schema).

Four bytes ``ARPL``, the length of the header (uint32, little-endian), the header as JSON in UTF-8, zeros up to a
multiple of eight, then the arrays one behind the other; the whole packed by gzip. Arrays lie component by component, in
which they pack better.
"""

from __future__ import annotations

import gzip
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core import ConfigurationError, EpisodeRecord, InputFileError, OccupancyGrid
from arena_core.files import read_table
from arena_core.records import FindingMark, read_findings, read_grid, read_record, record_path
from arena_viewer.gait import gait_begin, gait_of

MAGIC, VERSION = b"ARPL", 1
DIGITS = 10  # of lengths, m and rad: multiples of 2^-10, a millimetre
FREE, OCCUPIED, UNKNOWN = 0, 1, 2
PLAIN = (
    "planner",
    "preset",
    "robot",
    "simulator",
    "world",
    "task",
    "scenario",
    "seed",
    "episode",
    "n_pedestrians",
    "reaction",
    "localizer",
)
SHOWN = (
    "success",
    "strict_success",
    "collisions",
    "collisions_caused",
    "time_to_goal",
    "path_length",
    "clearance_min",
)  # metrics of the row
EXTRAS = {  # what a record holds only where its run asked for it, rounded already
    "considered_rows": "int32",
    "considered_offsets": "int32",
    "considered_points": "float32",
    "considered_costs": "float32",
    "considered_chosen": "uint8",
    "track_rows": "int32",
    "track_ids": "int32",
    "track_positions": "float32",
    "track_velocities": "float32",
    "track_radii": "float32",
    "doors_open": "uint8",
}
HORIZON = 10.0  # s, from where on a collision to come is none


@dataclass(slots=True)
class ArrayBuffers:
    """Arrays that are collected for a document: each gets a type, a shape and a place."""

    parts: list[bytes] = field(default_factory=list)
    length: int = 0

    def add(self, values: ArrayLike, kind: str) -> dict[str, Any]:
        """Append an array (T, ...) component by component, as (..., T); return what the header says of it."""
        array = np.ascontiguousarray(np.moveaxis(np.asarray(values), 0, -1), dtype=np.dtype(kind).newbyteorder("<"))
        content = array.tobytes()
        said = {"type": kind, "shape": list(array.shape), "offset": self.length}
        padded = content + bytes(-len(content) % 8)
        self.parts.append(padded)
        self.length += len(padded)
        return said

    def add_rounded(self, values: ArrayLike) -> dict[str, Any]:
        """Append figures, rounded."""
        return self.add(np.round(np.asarray(values, np.float64) * 2.0**DIGITS) / 2.0**DIGITS, "float32")


@dataclass(frozen=True, slots=True, eq=False)
class RecordedEpisode:
    """An episode of a run: its record, its map (None: no one knows it), its row's figures, and the moments that were
    found out about it.
    """

    record: EpisodeRecord
    grid: OccupancyGrid | None
    row: Mapping[str, str]
    name: str
    marks: Sequence[FindingMark] = ()


def read_recorded(folder: Path, number: int) -> RecordedEpisode:
    """Read an episode of the run in ``folder``; raise InputFileError where there is no record of it."""
    _, rows = read_table(folder / "episodes.csv", "a table that `arena run` wrote")
    known = {int(row["episode"]): row for row in rows}
    if number not in known:
        there = ", ".join(map(str, sorted(known)))
        raise ConfigurationError(f"EPISODE is {number}; allowed: {there or 'none: the run has no episode'}")
    path = record_path(folder, number)
    if not path.exists():
        raise InputFileError(
            f"{path}: no record; allowed: episodes that began (this one: "
            f"{known[number].get('error') or 'no reason known'})"
        )
    record = read_record(path)
    name = record.meta["world"].get("grid")
    grid = read_grid(folder / name) if name else None
    marks = [mark for found in read_findings(folder) for mark in found.marks.get(number, ())]
    return RecordedEpisode(record, grid, known[number], str(record.meta["columns"]["preset"]), marks)


def replay_document(episodes: Sequence[RecordedEpisode]) -> bytes:
    """Return the document of some episodes, packed; the same bytes for the same records."""
    buffers = ArrayBuffers()
    maps: list[dict[str, Any]] = []
    places: dict[tuple[Any, ...], int] = {}
    said = []
    for one in episodes:
        key = None if one.grid is None else _grid_key(one.grid)
        if key is not None and one.grid is not None and key not in places:
            places[key] = len(maps)
            maps.append(_map_header(one.grid, buffers))
        said.append({**_episode_header(one, buffers), "map": None if key is None else places[key]})
    header = {"format": "arena-replay", "version": VERSION, "maps": maps, "episodes": said}
    text = json.dumps(null_nonfinite(header), separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
    head = MAGIC + len(text).to_bytes(4, "little") + text
    return gzip.compress(b"".join([head, bytes(-len(head) % 8), *buffers.parts]), compresslevel=9, mtime=0)


def _grid_key(grid: OccupancyGrid) -> tuple[Any, ...]:
    return (grid.data.shape, grid.resolution, tuple(grid.origin.array().tolist()), grid.data.tobytes())


def _map_header(grid: OccupancyGrid, buffers: ArrayBuffers) -> dict[str, Any]:
    cells = np.full(grid.data.shape, FREE, np.uint8)
    cells[grid.data < 0] = UNKNOWN
    cells[grid.occupied] = OCCUPIED
    place = {"offset": buffers.length, "type": "uint8", "shape": list(cells.shape)}
    buffers.add(cells.reshape(-1), "uint8")
    return {"resolution": grid.resolution, "origin": grid.origin.array().tolist(), "cells": place}


def _episode_header(one: RecordedEpisode, buffers: ArrayBuffers) -> dict[str, Any]:
    record, meta = one.record, one.record.meta
    scenario, robot = meta["scenario"], meta["robot"]
    config = meta.get("config", {}).get("robot") or {}
    figures = {name: float(one.row[name]) for name in SHOWN if one.row.get(name)}
    return {
        "name": one.name,
        "columns": {name: meta["columns"].get(name) for name in PLAIN},
        "outcome": meta["outcome"],
        "error": meta["error"],
        "metrics": figures,
        "robot": {
            "name": robot["name"],
            "footprint": robot["footprint"],
            "period": robot["control_period"],
            "lidar": config.get("lidar"),
        },
        "start": scenario["start"],
        "goal": scenario["goal"],
        "goal_radius": scenario["goal_radius"],
        "obstacles": scenario["obstacles"],
        **({"doors": [door["vertices_xy"] for door in scenario["doors"]]} if scenario.get("doors") else {}),
        "gait": gait_of(meta),
        "events": [event for event in meta["events"] if event["kind"] != "no_valid_command"],
        **({"marks": [asdict(mark) for mark in one.marks]} if one.marks else {}),
        "arrays": _record_arrays(record, buffers),
    }


def _record_arrays(record: EpisodeRecord, buffers: ArrayBuffers) -> dict[str, Any]:
    people = np.asarray(record["pedestrian_positions"], np.float64)
    poses = np.asarray(record["pose"], np.float64)
    paths = np.asarray(record["path_poses"], np.float64)[:, :2]
    return {
        "stamp": buffers.add_rounded(record["stamp"]),
        "pose": buffers.add_rounded(poses),
        "estimate": buffers.add_rounded(record["estimate"]),
        "twist": buffers.add_rounded(record["twist"]),
        "waypoint": buffers.add_rounded(np.asarray(record["waypoint"])[:, :2]),
        "clearance": buffers.add_rounded(record["clearance"]),
        "time_to_collision": buffers.add_rounded(time_to_collision(record)),
        "in_contact": buffers.add(record["in_contact"], "uint8"),
        "people": buffers.add_rounded(people),
        "states": buffers.add(record["pedestrian_states"], "int8"),
        "radii": buffers.add_rounded(record["pedestrian_radii"]),
        "contact_stamp": buffers.add_rounded(record["contact_stamp"]),
        "contact_position": buffers.add_rounded(np.asarray(record["contact_position"]).reshape(-1, 2)),
        "contact_kind": buffers.add(record["contact_kind"], "int8"),
        "contact_speed": buffers.add_rounded(record["contact_speed"]),
        "contact_caused": buffers.add(record["contact_caused"], "uint8"),
        "path": buffers.add_rounded(paths),
        "path_offsets": buffers.add(record["path_offsets"], "int32"),
        "path_stamps": buffers.add_rounded(record["path_stamps"]),
        "planner_ms": buffers.add_rounded(1e3 * np.asarray(record.timing.get("planner_seconds", np.empty(0)))),
        **({"scan": buffers.add_rounded(record["scan_ranges"])} if "scan_ranges" in record.arrays else {}),
        **{name: buffers.add(record[name], kind) for name, kind in EXTRAS.items() if name in record.arrays},
        **({"team": buffers.add_rounded(record.teammate_poses())} if "team_pose" in record.arrays else {}),
        **({} if gait_of(record.meta) is None else {"gait_begin": buffers.add_rounded(gait_begin(record))}),
    }


def time_to_collision(record: EpisodeRecord) -> NDArray[np.float64]:
    """Return (T,) after how many s the robot and the next person would touch if all kept their velocities; inf from
    ``HORIZON`` on.

    The robot counts as the disc around its footprint (van der Horst and Hogema 1993, for discs).
    """
    pose, twist = np.asarray(record["pose"], np.float64), np.asarray(record["twist"], np.float64)
    cosine, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    own = np.column_stack((cosine * twist[:, 0] - sine * twist[:, 1], sine * twist[:, 0] + cosine * twist[:, 1]))
    offset = np.asarray(record["pedestrian_positions"], np.float64) - pose[:, None, :2]
    velocity = np.asarray(record["pedestrian_velocities"], np.float64) - own[:, None]
    reach = np.asarray(record["pedestrian_radii"], np.float64) + _outer_radius(record.meta["robot"]["footprint"])
    a, b = (velocity**2).sum(axis=-1), (offset * velocity).sum(axis=-1)
    c = (offset**2).sum(axis=-1) - reach**2
    root = b * b - a * c
    with np.errstate(divide="ignore", invalid="ignore"):
        when = np.where((root > 0.0) & (b < 0.0), c / (-b + np.sqrt(np.maximum(root, 0.0))), np.inf)
    when = np.where(c <= 0.0, 0.0, when)
    when[np.isnan(offset[..., 0])] = np.inf
    nearest: NDArray[np.float64] = when.min(axis=1, initial=np.inf)
    nearest[nearest >= HORIZON] = np.inf
    return nearest


def _outer_radius(footprint: Mapping[str, Any]) -> float:
    vertices = footprint["vertices_xy"]
    return max(math.hypot(x, y) for x, y in vertices) if vertices else float(footprint["radius"])


def null_nonfinite(node: Any) -> Any:
    """Return a header without figures that JSON does not know: they become null."""
    if isinstance(node, Mapping):
        return {key: null_nonfinite(value) for key, value in node.items()}
    if isinstance(node, (list, tuple)):
        return [null_nonfinite(value) for value in node]
    return None if isinstance(node, float) and not math.isfinite(node) else node


def read_document(content: bytes) -> tuple[dict[str, Any], Mapping[tuple[int, str], NDArray[Any]]]:
    """Return a document's header, and its arrays by (episode, name), as (T, ...); raise
    InputFileError where it is none.
    """
    try:
        raw = gzip.decompress(content)
        size = int.from_bytes(raw[4:8], "little")
        header: dict[str, Any] = json.loads(raw[8 : 8 + size])
    except (OSError, EOFError, ValueError) as error:
        raise InputFileError(
            f"no replay document ({type(error).__name__}); allowed: what `arena replay` wrote"
        ) from None
    if raw[:4] != MAGIC or header.get("version") != VERSION:
        raise InputFileError(f"a replay document of version {header.get('version')}; allowed: {VERSION}")
    begin = 8 + size + (-(8 + size) % 8)
    found = {}
    for number, episode in enumerate(header["episodes"]):
        for name, said in episode["arrays"].items():
            kind = np.dtype(said["type"]).newbyteorder("<")
            flat = np.frombuffer(raw, kind, math.prod(said["shape"]), begin + said["offset"])
            found[number, name] = np.moveaxis(flat.reshape(said["shape"]), -1, 0)
    return header, found
