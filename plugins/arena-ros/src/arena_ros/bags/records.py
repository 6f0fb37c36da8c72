"""What was gathered of an episode as a record: exactly where our own export wrote it, else as far as the data go."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, Footprint, Pose, Robot
from arena_core.files import LIMITS
from arena_core.records import robot_meta
from arena_ros.bags.episode_messages import EpisodeMessages
from arena_ros.bags.footprint import point_clearances
from arena_ros.bags.series import PersonSightings, Series
from arena_ros.bags.transformed_episode import TransformedEpisode

Arrays = dict[str, NDArray[Any]]
STALE_PEOPLE = 10**9  # ns after which a person who is not seen any more is not there
CONTACT_TYPES = {
    "contact_stamp": np.float64,
    "contact_kind": np.int8,
    "contact_person": np.int32,
    "contact_speed": np.float64,
    "contact_caused": np.bool_,
    "contact_position": np.float64,
}
ALL_CONTACTS = ("in_contact", "contact_time", *CONTACT_TYPES)
UNDESCRIBED = ("contact_kind", "contact_person", "contact_speed", "contact_caused")
ALL_PEOPLE = (
    "clearance_people",
    "pedestrian_ids",
    "pedestrian_radii",
    "pedestrian_positions",
    "pedestrian_velocities",
    "pedestrian_states",
)


@dataclass(frozen=True, slots=True)
class Reading:
    """How a foreign recording is read: periods and limits in s, radii in m; ``without`` names
    what is known not to have been.
    """

    period: float
    goal_radius: float
    time_limit: float
    person_radius: float
    without: frozenset[str]


def restore_record(gathered: EpisodeMessages) -> EpisodeRecord:
    """Return the record that our own export wrote, value for value; raise ValueError where parts of it are missing."""
    own = gathered.meta or {}
    ending, people = gathered.ending, own["people"]
    if not gathered.reference:
        raise ValueError("it has no /ground_truth")
    truth, believed = next(iter(gathered.reference.values())), next(iter(gathered.estimate.values()), Series(12))
    stamps = truth.stamps
    ids = np.array(people["ids"], np.int32)
    reference, amcl = truth.exact_at(stamps), believed.exact_at(stamps)
    width = 6 + len(ids)
    state = np.full((len(stamps), width), np.nan)
    for stamp, numbers in gathered.state:
        place = int(np.searchsorted(stamps, stamp))
        if place < len(stamps) and stamps[place] == stamp and len(numbers) == width:
            state[place] = numbers
    _, seen = next(iter(gathered.people.values()), PersonSightings()).table(stamps, 0, ids)
    arrays: Arrays = {
        "stamp": np.where(np.isfinite(state[:, 0]), state[:, 0], _to_seconds(stamps, gathered.begin)),
        "pose": reference[:, :3],
        "twist": reference[:, 3:],
        "estimate": amcl[:, :3],
        "estimate_covariance": amcl[:, 3:].reshape(-1, 3, 3).astype(np.float32),
        "command": gathered.command.exact_at(stamps),
        "waypoint": gathered.waypoint.exact_at(stamps),
        "clearance": state[:, 1],
        "clearance_people": state[:, 2],
        "in_contact": state[:, 3] == 1.0,
        "contact_time": np.nan_to_num(state[:, 4]),
        "scan_min": state[:, 5],
        "pedestrian_ids": ids,
        "pedestrian_radii": np.array(people["radii"], np.float64),
        "pedestrian_positions": seen[:, :, :2],
        "pedestrian_velocities": seen[:, :, 2:],
        "pedestrian_states": np.nan_to_num(state[:, 6:]).astype(np.int8),
        **_route_arrays(people),
        **_path_arrays([(stamp, poses) for stamp, _, poses in gathered.paths], gathered.begin),
    }
    contacts = ending["contacts"] if ending else {}
    arrays |= {name: np.array(contacts.get(name, []), kind) for name, kind in CONTACT_TYPES.items()}
    arrays["contact_position"] = arrays["contact_position"].reshape(-1, 2)
    arrays |= _scan_arrays(gathered, stamps[:-1])
    if ending and len(ending["path_stamps"]) == len(arrays["path_stamps"]):
        arrays["path_stamps"] = np.array(ending["path_stamps"], np.float64)
    ends = ending or {"outcome": "error", "error": gathered.why_ended, "events": []}
    meta = {**own["meta"], **{key: ends[key] for key in ("outcome", "error", "events")}}
    return EpisodeRecord(arrays, meta)


class EpisodeIdentity(NamedTuple):
    """Which episode of its run a record is, and what its columns and its world are to say."""

    number: int
    columns: Mapping[str, Any]
    world: Mapping[str, Any]


def foreign_record(
    placed: TransformedEpisode, robot: Robot, reading: Reading, identity: EpisodeIdentity
) -> EpisodeRecord:
    """Return the record of a foreign recording; ``meta["unknown"]`` names the arrays that no one
    recorded, with the reason.
    """
    gathered = placed.gathered
    stamps, poses, twists = _motion_arrays(placed, reading)
    goal = placed.goal.array().tolist() if placed.goal is not None else poses[-1].tolist()
    since = (stamps - stamps[0]) * 1e-9
    last, outcome, error = episode_ending(placed.goal, poses, since, reading, placed.why_ended)
    stamps, poses, twists = stamps[: last + 1], poses[: last + 1], twists[: last + 1]
    unknown: dict[str, str] = {}
    arrays: Arrays = {"stamp": _to_seconds(stamps, stamps[0]), "pose": poses, "twist": twists}
    arrays |= _estimate_arrays(placed, stamps, unknown)
    arrays["command"] = gathered.command.in_order().latest_at(stamps)
    arrays["command"][-1] = np.nan
    arrays["waypoint"] = np.full((len(stamps), 3), np.nan)
    arrays |= _scan_clearances(gathered, stamps, unknown)
    if not len(placed.people) and "people" not in reading.without:
        unknown |= dict.fromkeys(ALL_PEOPLE, "no topic says where people were")
    arrays |= _people_arrays(placed, stamps, poses, robot.footprint, reading.person_radius)
    arrays |= (
        _contact_arrays(placed, stamps, unknown)
        if gathered.counts_collisions
        else empty_contacts(len(stamps), reading, unknown)
    )
    arrays |= _path_arrays([each for each in placed.paths if each[0] <= stamps[-1]], stamps[0])
    arrays |= _scan_arrays(gathered, stamps[:-1])
    arrays["clearance"] = np.fmin(arrays["clearance"], arrays["clearance_people"])
    facts: dict[str, Any] = {"outcome": outcome, "error": error, "truth": placed.truth, "unknown": unknown}
    if any(placed.shift):
        facts["shift"] = list(placed.shift)
    return EpisodeRecord(arrays, {**episode_identity(arrays, robot, reading, identity, goal), **facts})


def episode_identity(
    arrays: Arrays, robot: Robot, reading: Reading, identity: EpisodeIdentity, goal: list[float]
) -> dict[str, Any]:
    """Return what identifies a recorded episode: the part of its meta that does not say how it went."""
    scenario = {
        "name": f"recorded_{identity.number:04d}",
        "seed": 0,
        "start": arrays["pose"][0].tolist(),
        "goal": goal,
        "goal_radius": reading.goal_radius,
        "time_limit": reading.time_limit,
        "reference_length": None,
        "speed_share": 1.0,
        "pedestrian_types": {},
        "obstacles": [],
    }
    there = int(np.isfinite(arrays["pedestrian_positions"]).all(axis=2).any(axis=0).sum())
    return {
        "format": 1,
        "columns": {
            **identity.columns,
            "scenario": scenario["name"],
            "episode": identity.number,
            "n_pedestrians": there,
        },
        "world": dict(identity.world),
        "scenario": scenario,
        "robot": {**robot_meta(robot), "control_period": reading.period},
        "events": [],
    }


def _to_seconds(stamps: NDArray[np.int64], begin: int) -> NDArray[np.float64]:
    return np.round((stamps - begin) * 1e-9, 9)


def _motion_arrays(
    placed: TransformedEpisode, reading: Reading
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Return stamps, poses and twists."""
    first, step = max(placed.begin, int(placed.motion.stamps.min())), round(reading.period * 1e9)
    stamps = first + step * np.arange(max((placed.end - first) // step, 0) + 1, dtype=np.int64)
    poses = placed.motion.interpolate_at(stamps)
    twists = placed.gathered.odometry.in_order().latest_at(stamps)[:, 3:]
    own = placed.twists.latest_at(stamps)[:, 3:]
    twists = np.where(np.isfinite(own), own, twists)
    known = np.isfinite(twists)
    return stamps, poses, np.where(known, twists, _pose_twists(stamps, poses))


def _pose_twists(stamps: NDArray[np.int64], poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return velocities in ``base_link`` as differences of poses."""
    if len(stamps) < 2:
        return np.zeros((len(stamps), 3))
    seconds = (stamps - stamps[0]) * 1e-9
    unwrapped = np.column_stack((poses[:, :2], np.unwrap(poses[:, 2])))
    rates = np.gradient(unwrapped, seconds, axis=0)
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    return np.stack((c * rates[:, 0] + s * rates[:, 1], -s * rates[:, 0] + c * rates[:, 1], rates[:, 2]), axis=1)


def episode_ending(
    goal: Pose | None, poses: NDArray[np.float64], stamps: NDArray[np.float64], reading: Reading, why_ended: str
) -> tuple[int, str, str]:
    """Return the last row, the outcome and the error; stamps are s since the begin."""
    if goal is None:
        return len(stamps) - 1, "goal_reached", ""
    near = np.hypot(poses[:, 0] - goal.x, poses[:, 1] - goal.y) <= reading.goal_radius
    late = stamps >= reading.time_limit - 1e-9
    arrival, timeout = (int(flags.argmax()) if flags.any() else len(stamps) for flags in (near, late))
    if arrival <= timeout and arrival < len(stamps):
        return arrival, "goal_reached", ""
    if timeout < len(stamps):
        return timeout, "time_out", ""
    return len(stamps) - 1, "error", f"{why_ended}, and the robot was not at its goal"


def _estimate_arrays(placed: TransformedEpisode, stamps: NDArray[np.int64], unknown: dict[str, str]) -> Arrays:
    rows = placed.estimate.latest_at(stamps)
    estimate = rows[:, :3]
    if placed.truth != "reference":
        unknown["estimate"] = "without a reference pose the truth is itself an estimate"
    elif len(placed.believed):
        estimate = placed.believed.interpolate_at(stamps)
    elif not len(placed.estimate):
        unknown["estimate"] = "no topic says where the robot believed to be"
    return {"estimate": estimate, "estimate_covariance": rows[:, 3:].reshape(-1, 3, 3).astype(np.float32)}


def _scan_clearances(gathered: EpisodeMessages, stamps: NDArray[np.int64], unknown: dict[str, str]) -> Arrays:
    rows = gathered.scan.in_order().latest_at(stamps)
    if not len(gathered.scan):
        unknown |= dict.fromkeys(("clearance", "scan_min"), "no scan was recorded")
    return {"scan_min": rows[:, 0], "clearance": rows[:, 1]}


def _people_arrays(
    placed: TransformedEpisode,
    stamps: NDArray[np.int64],
    poses: NDArray[np.float64],
    footprint: Footprint,
    person_radius: float,
) -> Arrays:
    ids, seen = placed.people.table(stamps, STALE_PEOPLE)
    positions = seen[:, :, :2].astype(np.float64)
    delta = positions - poses[:, None, :2]
    c, s = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
    local = np.stack((c * delta[..., 0] + s * delta[..., 1], -s * delta[..., 0] + c * delta[..., 1]), axis=-1)
    gaps = np.maximum(point_clearances(footprint, local) - person_radius, 0.0)
    nearest = np.where(np.isfinite(gaps), gaps, np.inf).min(axis=1, initial=np.inf)
    return {
        "clearance_people": nearest,
        "pedestrian_ids": ids,
        "pedestrian_radii": np.full(len(ids), person_radius),
        "pedestrian_positions": seen[:, :, :2],
        "pedestrian_velocities": seen[:, :, 2:],
        "pedestrian_states": np.isfinite(positions).all(axis=2).astype(np.int8),
    }


def _contact_arrays(placed: TransformedEpisode, stamps: NDArray[np.int64], unknown: dict[str, str]) -> Arrays:
    """Return the collisions that a topic counts, of which it is not known with what."""
    told = placed.gathered.collisions
    counts, touches = told.values[:, 0].astype(np.int64), told.values[:, 1]
    when = np.repeat(told.stamps, counts)
    when = np.sort(when[(when >= stamps[0]) & (when <= stamps[-1])])
    touching = np.nan_to_num(told.in_order().latest_at(stamps)[:, 1]) > 0.0
    touching[np.searchsorted(stamps, when)] = True
    unknown |= dict.fromkeys(UNDESCRIBED, "collisions were counted, not described")
    if np.isnan(touches).all():
        unknown["contact_time"] = "collisions were counted, not timed"
    return {
        "contact_stamp": _to_seconds(when, int(stamps[0])),
        "contact_kind": np.zeros(len(when), np.int8),
        "contact_person": np.full(len(when), -1, np.int32),
        "contact_speed": np.zeros(len(when)),
        "contact_caused": np.zeros(len(when), np.bool_),
        "contact_position": placed.motion.interpolate_at(when)[:, :2],
        "in_contact": touching,
        "contact_time": np.where(touching, np.diff(stamps, prepend=stamps[0]) * 1e-9, 0.0),
    }


def empty_contacts(rows: int, reading: Reading, unknown: dict[str, str]) -> Arrays:
    """Return no contacts, which are unknown unless it was said that there were none."""
    if "contacts" not in reading.without:
        unknown |= dict.fromkeys(ALL_CONTACTS, "nothing recorded contacts; without=contacts says that there were none")
    none: Arrays = {name: np.empty(0, kind) for name, kind in CONTACT_TYPES.items()}
    none["contact_position"] = np.empty((0, 2))
    return {**none, "in_contact": np.zeros(rows, np.bool_), "contact_time": np.zeros(rows)}


def _path_arrays(paths: Sequence[tuple[int, NDArray[np.float64]]], begin: int) -> Arrays:
    kept = sorted(((max(stamp, begin), poses) for stamp, poses in paths if len(poses)), key=lambda each: each[0])
    return {
        "path_poses": np.concatenate([poses for _, poses in kept]) if kept else np.empty((0, 3)),
        "path_offsets": np.cumsum([0, *(len(poses) for _, poses in kept)], dtype=np.int64),
        "path_stamps": _to_seconds(np.array([stamp for stamp, _ in kept], np.int64), begin),
    }


def _route_arrays(people: Mapping[str, Any]) -> Arrays:
    """Return where everybody was to go, as our export says it; raise ValueError for routes that are none."""
    if "routes" not in people:
        return {}
    routes = [np.array(route, np.float64).reshape(-1, 2) for route in people["routes"]]
    points = np.concatenate([np.empty((0, 2)), *routes])
    if len(routes) != len(people["ids"]) or not (np.abs(points) <= LIMITS.record_farthest).all():
        raise ValueError("its routes are not those of its people")
    return {"route_points": points, "route_offsets": np.cumsum([0, *map(len, routes)], dtype=np.int64)}


def _scan_arrays(gathered: EpisodeMessages, stamps: NDArray[np.int64]) -> Arrays:
    """Return the newest scan at each of some stamps; nothing where none is kept."""
    if not gathered.ranges or not len(stamps):
        return {}
    own = np.array([stamp for stamp, _ in gathered.ranges], np.int64)
    place = np.clip(np.searchsorted(own, stamps, side="right") - 1, 0, None)
    return {"scan_ranges": np.array([gathered.ranges[k][1] for k in place.tolist()], np.float32)}
