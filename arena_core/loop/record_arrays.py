"""What was true, measured and decided in an episode, as the arrays of its record."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core.base.stopwatch import Duration
from arena_core.loop.grain import TIME_GRAIN, to_grain
from arena_core.loop.navigator import Decision, Spent
from arena_core.values.episode import Contact, WorldState
from arena_core.values.world import Path as GlobalPath
from arena_core.values.world import PedestrianSpec

CONTACT_KINDS = ("wall", "obstacle", "person", "robot")


def truth_arrays(states: list[WorldState]) -> dict[str, NDArray[Any]]:
    """Stack what was true."""
    doors = {"doors_open": np.array([s.doors_open for s in states])} if len(states[0].doors_open) else {}
    return {
        "stamp": np.array([s.stamp for s in states]),
        "pose": np.array([s.pose.array() for s in states]),
        "twist": np.array([s.twist.array() for s in states]),
        "clearance": np.array([s.clearance for s in states]),
        "clearance_people": np.array([s.clearance_people for s in states]),
        "in_contact": np.array([s.in_contact for s in states]),
        "contact_time": np.array([s.contact_time for s in states]),
        **doors,
    }


def decision_arrays(decisions: list[Decision], last: Decision | None) -> dict[str, NDArray[Any]]:
    """Stack what was decided; the final row has no command, and no estimate either when the
    episode ended by an error.
    """
    nothing = np.full(3, np.nan)
    final = last.estimate.pose.array() if last else nothing
    covariance = last.estimate.covariance if last else np.full((3, 3), np.nan)
    waypoint = last.waypoint.array() if last else nothing
    return {
        "estimate": np.array([*(d.estimate.pose.array() for d in decisions), final]),
        "estimate_covariance": np.array([*(d.estimate.covariance for d in decisions), covariance], dtype=np.float32),
        "command": np.array([*(d.command.array() for d in decisions), nothing]),
        "waypoint": np.array([*(d.waypoint.array() for d in decisions), waypoint]),
    }


def people_arrays(states: list[WorldState]) -> dict[str, NDArray[Any]]:
    """Stack where people were, how they moved and in what state."""
    people = [s.pedestrians for s in states]
    return {
        "pedestrian_ids": people[0].ids,
        "pedestrian_radii": people[0].radii,
        "pedestrian_positions": np.array([p.positions for p in people], dtype=np.float32),
        "pedestrian_velocities": np.array([p.velocities for p in people], dtype=np.float32),
        "pedestrian_states": np.array([p.states for p in people], dtype=np.int8),
    }


def route_arrays(ids: NDArray[Any], people: Sequence[PedestrianSpec]) -> dict[str, NDArray[Any]]:
    """Return where everybody was to go: nowhere for those of whom the scenario does not say."""
    waypoints = {person.id: person.waypoints_xy for person in people}
    routes = [waypoints.get(number, np.empty((0, 2))) for number in ids.tolist()]
    return {
        "route_points": np.concatenate([np.empty((0, 2)), *routes]),
        "route_offsets": np.cumsum([0, *map(len, routes)], dtype=np.int64),
    }


def contact_arrays(contacts: list[Contact]) -> dict[str, NDArray[Any]]:
    """Return what was touched when."""
    return {
        "contact_stamp": np.array([c.stamp for c in contacts], dtype=np.float64),
        "contact_kind": np.array([CONTACT_KINDS.index(c.kind) for c in contacts], dtype=np.int8),
        "contact_person": np.array([c.person for c in contacts], dtype=np.int32),
        "contact_speed": np.array([c.speed for c in contacts], dtype=np.float64),
        "contact_caused": np.array([c.caused for c in contacts], dtype=np.bool_),
        "contact_position": np.array([(c.x, c.y) for c in contacts], dtype=np.float64).reshape(-1, 2),
    }


def path_arrays(decisions: list[Decision]) -> dict[str, NDArray[Any]]:
    """Return all planned paths, one behind the other."""
    planned: list[tuple[float, GlobalPath]] = [
        (d.events[0].stamp, d.planned) for d in decisions if d.planned is not None
    ]
    lengths = [len(path.poses) for _, path in planned]
    return {
        "path_poses": np.concatenate([path.poses for _, path in planned]) if planned else np.empty((0, 3)),
        "path_offsets": np.cumsum([0, *lengths], dtype=np.int64),
        "path_stamps": np.array([stamp for stamp, _ in planned], dtype=np.float64),
    }


def timing_arrays(decisions: list[Decision]) -> dict[str, NDArray[np.float64]]:
    """Return ``PART_seconds`` and ``PART_cpu_seconds`` of every part that was timed, one a decision; NaN of decisions
    that waited for a compiler, which a run meets once on a machine.
    """
    seconds = {
        part: np.array([math.nan if d.compiled else getattr(d.spent, part) for d in decisions], dtype=np.float64)
        for part in Spent.__slots__
    }
    return {f"{part}_seconds": to_grain(array, TIME_GRAIN) for part, array in seconds.items()}


def whole_timing(spent: Duration, *, compiled: bool = False) -> dict[str, NDArray[np.float64]]:
    """Return what a whole episode took, as arrays of one element beside those of its steps; NaN where kernels were
    ``compiled`` in it.
    """
    took = {"episode_seconds": math.nan if compiled else spent.wall}
    took["episode_cpu_seconds"] = math.nan if compiled else spent.cpu
    return {name: to_grain(np.array([seconds]), TIME_GRAIN) for name, seconds in took.items()}
