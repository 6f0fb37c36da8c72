"""Synthetic records whose figures can be worked out by hand."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from arena_core import EpisodeRecord, Metric
from arena_core.hosting import compose, to_plain
from arena_core.records import EPISODE_COLUMNS
from arena_metrics.packs.si import SiMetrics
from arena_metrics.packs.social import SocialMetrics
from arena_replication.paper_legacy import PaperLegacyMetrics

RecordMaker = Callable[..., EpisodeRecord]


@cache
def preset(name: str) -> Mapping[str, Any]:
    values: dict[str, Any] = to_plain(compose([f"metrics=[{name}]"], "component")["metrics"][name])
    return {key: value for key, value in values.items() if key != "name"}


def make_record(
    poses: ArrayLike, dt: float = 0.1, meta: Mapping[str, Any] | None = None, **arrays: ArrayLike
) -> EpisodeRecord:
    """Make a record from poses (T, 3); the twist follows from them, everything else is uneventful unless given."""
    pose = np.asarray(poses, dtype=float).reshape(-1, 3)
    steps, people = len(pose), np.shape(arrays.get("pedestrian_positions", np.empty((0, 0, 2))))[1]
    usual = {
        "stamp": dt * np.arange(steps),
        "pose": pose,
        "twist": twists(pose, dt),
        "estimate": pose.copy(),
        "estimate_covariance": np.zeros((steps, 3, 3), np.float32),
        "command": np.zeros((steps, 3)),
        "waypoint": pose.copy(),
        "clearance": np.ones(steps),
        "clearance_people": np.full(steps, np.inf),
        "scan_min": np.concatenate((np.ones(steps - 1), [np.nan])),
        "in_contact": np.zeros(steps, bool),
        "contact_time": np.zeros(steps),
        "pedestrian_ids": np.arange(people, dtype=np.int32),
        "pedestrian_radii": np.full(people, 0.3),
        "pedestrian_positions": np.zeros((steps, people, 2), np.float32),
        "pedestrian_velocities": np.zeros((steps, people, 2), np.float32),
        "pedestrian_states": np.zeros((steps, people), np.int8),
        "contact_stamp": np.empty(0),
        "contact_kind": np.empty(0, np.int8),
        "contact_person": np.empty(0, np.int32),
        "contact_speed": np.empty(0),
        "contact_caused": np.empty(0, bool),
        "contact_position": np.empty((0, 2)),
        "path_poses": np.empty((0, 3)),
        "path_offsets": np.zeros(1, np.int64),
        "path_stamps": np.empty(0),
    }
    scenario = {
        "name": "s0",
        "seed": 0,
        "start": pose[0].tolist(),
        "goal": pose[-1].tolist(),
        "goal_radius": 0.3,
        "time_limit": 180.0,
        "obstacles": [],
    }
    robot = {
        "name": "turtlebot3",
        "kinematics": "differential",
        "footprint": {"radius": 0.2, "vertices_xy": []},
        "control_period": dt,
    }
    usual_meta = {
        "format": 1,
        "outcome": "goal_reached",
        "error": "",
        "scenario": scenario,
        "robot": robot,
        "events": [],
    }
    timing = {"planner_seconds": np.full(max(steps - 1, 0), 0.002)}
    merged = {name: np.asarray(arrays[name]) if name in arrays else value for name, value in usual.items()}
    return EpisodeRecord(merged, {**usual_meta, **(meta or {})}, timing)


def twists(pose: np.ndarray, dt: float) -> np.ndarray:
    """Return the body velocities that lead from each pose to the next; the last is repeated."""
    if len(pose) < 2:
        return np.zeros((len(pose), 3))
    delta = np.diff(pose, axis=0) / dt
    c, s = np.cos(pose[:-1, 2]), np.sin(pose[:-1, 2])
    body = np.stack((c * delta[:, 0] + s * delta[:, 1], -s * delta[:, 0] + c * delta[:, 1], delta[:, 2]), axis=1)
    return np.concatenate((body, body[-1:]))


def straight(length: float = 4.0, speed: float = 0.5, dt: float = 0.1) -> np.ndarray:
    """Return poses along x at constant speed, from the origin."""
    x = np.arange(round(length / (speed * dt)) + 1) * speed * dt
    return np.stack((x, np.zeros_like(x), np.zeros_like(x)), axis=1)


def circle(radius: float = 2.0, speed: float = 0.5, dt: float = 0.1, turns: float = 1.0) -> np.ndarray:
    """Return poses on a circle about the origin, counter-clockwise, heading along it and wrapped to [-pi, pi)."""
    angle = np.arange(round(turns * 2.0 * np.pi * radius / (speed * dt)) + 1) * speed * dt / radius
    heading = (angle + 1.5 * np.pi) % (2.0 * np.pi) - np.pi
    return np.stack((radius * np.cos(angle), radius * np.sin(angle), heading), axis=1)


@pytest.fixture(scope="session")
def record_of() -> RecordMaker:
    return make_record


@pytest.fixture(scope="session")
def straight_line() -> Callable[..., np.ndarray]:
    return straight


@pytest.fixture(scope="session")
def round_trip() -> Callable[..., np.ndarray]:
    return circle


@pytest.fixture(scope="session")
def si() -> dict[str, Callable[[EpisodeRecord], float]]:
    return {metric.name: metric.compute for metric in SiMetrics(**preset("si")).metrics()}


@pytest.fixture(scope="session")
def social() -> dict[str, Callable[[EpisodeRecord], float]]:
    return {metric.name: metric.compute for metric in SocialMetrics(**preset("social")).metrics()}


@pytest.fixture(scope="session")
def legacy() -> dict[str, Callable[[EpisodeRecord], float]]:
    return {metric.name: metric.compute for metric in PaperLegacyMetrics(**preset("paper_legacy")).metrics()}


def columns(planner: str, robot: str, people: int, variant: float) -> dict[str, Any]:
    """Return the identification columns of a cell, whose hash follows from its factors."""
    named = {"planner": planner, "preset": planner, "robot": robot, "n_pedestrians": people}
    rest = {
        "simulator": "sim2d",
        "world": "hall",
        "task": "random",
        "pedestrian_model": "social_force",
        "reaction": "ignore",
    }
    return {
        "config_hash": f"{planner}-{robot}-{people}-{variant}",
        **named,
        **rest,
        "localizer": "amcl",
        "timing": "ideal",
    }


def write_run(
    folder: Path,
    planner: str = "dwa",
    robot: str = "jackal",
    people: int = 5,
    episodes: int = 3,
    seed: int = 0,
    sim_time: float = 1.5,
    errors: Sequence[int] = (),
    packs: Sequence[str] = ("si",),
    records: bool = True,
    only: Sequence[str] = (),
    stages: Sequence[int] = (),
    block: int | None = None,
    problems: int = 0,
    code: str = "",
    parts: Mapping[str, str] | None = None,
    fails: Sequence[int] = (),
) -> Path:
    """Write a run's folder as ``arena run`` leaves it; the robot drives straight lines, and reaches the goal in even
    episodes.

    With ``problems`` the episodes are those of a file, in turn. In ``fails`` the goal is not reached, in all others
    then it is.
    """
    base = (
        columns(planner, robot, people, sim_time)
        | {"code": code}
        | ({"task": "scenario", "scenario_hash": "h"} if problems else {})
    )
    name = (lambda i: f"p{i % problems}/{i // problems:04d}") if problems else (lambda i: f"random/{i:04d}")
    levels = dict(enumerate(stages))
    config = {
        "planner": {"name": planner, "sim_time": sim_time},
        "robot": {"name": robot},
        "task": {"name": "random", "pedestrians": people, **({"block": block} if block else {})},
        "metrics": {pack: {"name": pack, **preset(pack)} for pack in packs},
        "seed": seed,
    }
    folder.mkdir(parents=True)
    rows = [
        {**base, "episode": i, "seed": seed, "n_pedestrians": "", "outcome": "error", "error": "NoPath: <none>"}
        if i in errors
        else _episode_row(
            folder,
            {**base, "scenario": name(i), "stage": levels.get(i, ""), "episode": i, "seed": seed},
            packs,
            records,
            fails,
        )
        for i in range(episodes)
    ]
    provenance = {
        "config_hash": base["config_hash"],
        "seed": seed,
        "episodes": episodes,
        "config": config,
        "commit": "abc123",
    }
    provenance |= {"versions": {"arena-core": "0.1.0", "zlib": "1"}, "python": "3.11", "machine": {"system": "test"}}
    provenance |= {"code": {"digest": code, "parts": dict(parts or {})}} if code else {}
    (folder / "provenance.json").write_text(json.dumps(provenance))
    names = [m.name if pack == "si" else f"{pack}.{m.name}" for pack in packs for m in PACKS[pack]]
    names = [name for name in names if not only or name in only]
    with (folder / "episodes.csv").open("w", newline="") as file:
        writer = csv.DictWriter(
            file,
            [*(column for column in EPISODE_COLUMNS if code or column != "code"), *names],
            restval="",
            extrasaction="ignore",
            lineterminator="\n",
        )
        writer.writeheader()
        writer.writerows({k: "" if v != v else v for k, v in row.items()} for row in rows)
    return folder


def _episode_row(
    folder: Path, base: dict[str, Any], packs: Sequence[str], records: bool, fails: Sequence[int]
) -> dict[str, Any]:
    episode, people = base["episode"], base["n_pedestrians"]
    pose = straight(length=4.0 + 0.5 * episode, speed=0.5)
    reached = episode not in fails if fails else episode % 2 == 0
    outcome = "goal_reached" if reached else "time_out"
    walking = np.tile(np.linspace((1.0, 2.0), (3.0, 2.0), len(pose))[:, None], (1, people, 1)).astype(np.float32)
    meta = {"outcome": outcome, "columns": base, "world": {"name": "hall", "grid": "worlds/hall.npz"}, "config": {}}
    crowd = {"pedestrian_ids": np.arange(people, dtype=np.int32), "pedestrian_positions": walking}
    crowd |= {"pedestrian_radii": np.full(people, 0.3), "pedestrian_velocities": np.zeros_like(walking)}
    hit = {
        "contact_stamp": [1.0],
        "contact_kind": [episode % 3],
        "contact_person": [0],
        "contact_speed": [0.2],
        "contact_caused": [True],
        "contact_position": [[1, 0]],
    }
    record = make_record(pose, meta=meta, **crowd, **(hit if episode % 4 == 1 else {}))
    if records:
        _write_record(folder, record, episode)
    metrics = {m.name if pack == "si" else f"{pack}.{m.name}": m.compute(record) for pack in packs for m in PACKS[pack]}
    return {**base, "outcome": outcome, "error": "", **metrics}


def _write_record(folder: Path, record: EpisodeRecord, episode: int) -> None:
    for name in ("records", "timing", "worlds"):
        (folder / name).mkdir(exist_ok=True)
    np.savez(folder / "records" / f"{episode:04d}.npz", meta=np.array(json.dumps(record.meta)), **record.arrays)
    np.savez(folder / "timing" / f"{episode:04d}.npz", **record.timing)
    data = np.zeros((60, 120), np.int8)
    data[0], data[:, 0] = 100, -1
    np.savez(folder / "worlds" / "hall.npz", data=data, resolution=np.array(0.1), origin=np.array([-2.0, -1.0, 0.2]))


PACKS = {
    "si": list(SiMetrics(**preset("si")).metrics()),
    "paper_legacy": list(PaperLegacyMetrics(**preset("paper_legacy")).metrics()),
}


@pytest.fixture(scope="session")
def run_folder() -> Callable[..., Path]:
    return write_run


@pytest.fixture(scope="session")
def pack_metrics() -> Mapping[str, Sequence[Metric]]:
    return {"": PACKS["si"]}


@pytest.fixture(scope="session")
def preset_of() -> Callable[[str], dict[str, Any]]:
    return preset
