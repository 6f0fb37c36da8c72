"""Records of episodes, collected step by step (docs/records.md lists every array)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core.base.frozen import freeze_array
from arena_core.loop.extras import candidate_arrays, track_arrays
from arena_core.loop.grain import round_arrays
from arena_core.loop.navigator import Decision
from arena_core.loop.record_arrays import (
    contact_arrays,
    decision_arrays,
    path_arrays,
    people_arrays,
    route_arrays,
    timing_arrays,
    truth_arrays,
)
from arena_core.loop.record_files import FORMAT
from arena_core.values.candidate import Candidate
from arena_core.values.doors import door_meta
from arena_core.values.episode import EpisodeRecord, Event, Outcome, Scenario, WorldState
from arena_core.values.furniture import furniture_meta
from arena_core.values.geometry import Pose
from arena_core.values.recorded_walk import RecordedWalk
from arena_core.values.robot import Robot
from arena_core.values.sensing import Sensors

EMPTY: Mapping[str, float | str] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class RecordingSettings:
    """What a record keeps beyond the usual: every scan, the tracks that the planner asked for, what it considered.

    ``live`` tells beside the records where running episodes are. Older configurations have ``scans`` alone.
    """

    scans: bool
    tracks: bool = False
    considered: bool = False
    live: bool = False


USUAL = RecordingSettings(scans=False)


class Recorder:
    """Collects one episode step by step: what is true and measured, then what was decided; ``meta``
    identifies it, plain JSON.
    """

    def __init__(
        self,
        scenario: Scenario,
        robot: Robot,
        meta: Mapping[str, Any],
        keeps: RecordingSettings = USUAL,
    ) -> None:
        self._people = scenario.pedestrians
        self._meta = {"format": FORMAT, **meta, "scenario": _scenario_meta(scenario), "robot": robot_meta(robot)}
        self._keeps = keeps
        self._states: list[WorldState] = []
        self._decisions: list[Decision] = []
        self._scan_minima: list[float] = []
        self._scans: list[NDArray[np.float32]] = []
        self._considered: list[list[Candidate]] = []

    @property
    def keeps_considered(self) -> bool:
        """Return whether what the planner considered is kept."""
        return self._keeps.considered

    def sense(self, state: WorldState, sensors: Sensors) -> None:
        """Take in what is true and what was measured at a control step, before anybody decides; it counts
        once a decision is added.
        """
        self._sensed = (
            state,
            float(sensors.scan.ranges.min()),
            freeze_array(sensors.scan.ranges) if self._keeps.scans else None,
        )

    def add(self, decision: Decision, considered: list[Candidate] | None = None) -> None:
        """Take in what was decided on what was sensed last, and what is kept of what the planner considered."""
        state, scan_minimum, scan = self._sensed
        self._states.append(state)
        self._decisions.append(decision)
        self._scan_minima.append(scan_minimum)
        if scan is not None:
            self._scans.append(scan)
        if self._keeps.considered:
            self._considered.append(considered or [])

    def finish(
        self,
        state: WorldState,
        outcome: Outcome,
        error: str,
        decision: Decision | None = None,
        notes: Mapping[str, float | str] = EMPTY,
    ) -> EpisodeRecord:
        """Close the record with the final state, the decision that ended it, if one did, and the planner's notes."""
        states = [*self._states, state]
        arrays = {
            **truth_arrays(states),
            **decision_arrays(self._decisions, decision),
            **people_arrays(states),
            **route_arrays(states[0].pedestrians.ids, self._people),
            **contact_arrays([c for s in states for c in s.contacts]),
            **path_arrays(self._decisions),
            "scan_min": np.array([*self._scan_minima, np.nan]),
        }
        if self._keeps.scans:
            arrays["scan_ranges"] = np.array(self._scans, dtype=np.float32)
        if self._keeps.tracks:
            arrays |= track_arrays([d.tracks for d in self._decisions])
        if self._keeps.considered:
            arrays |= candidate_arrays(self._considered)
        events = [_event_dict(e) for d in self._decisions for e in d.events]
        meta = {**self._meta, "outcome": outcome, "error": error, "events": events}
        meta |= {"notes": dict(notes)} if notes else {}
        return EpisodeRecord(round_arrays(arrays), meta, timing_arrays(self._decisions))


def robot_meta(robot: Robot) -> dict[str, Any]:
    """Return what a record says of its robot."""
    limits = {name: getattr(robot.limits, name) for name in robot.limits.__slots__}
    footprint = {"radius": robot.footprint.radius, "vertices_xy": robot.footprint.vertices_xy.tolist()}
    return {
        "name": robot.name,
        "kinematics": robot.kinematics,
        "footprint": footprint,
        "limits": limits,
        "control_period": robot.control_period,
    }


def _scenario_meta(scenario: Scenario) -> dict[str, Any]:
    obstacles = [{"vertices_xy": o.vertices_xy.tolist(), "radius": o.radius} for o in scenario.obstacles]
    return {
        "name": scenario.name,
        "seed": scenario.seed,
        "start": _pose_list(scenario.start),
        "goal": _pose_list(scenario.goal),
        "goal_radius": scenario.goal_radius,
        "time_limit": scenario.time_limit,
        "reference_length": scenario.reference_length,
        "pedestrian_types": {str(p.id): p.behaviour["type"] for p in scenario.pedestrians if "type" in p.behaviour},
        "speed_share": scenario.speed_share,
        "obstacles": obstacles,
        **({"doors": list(map(door_meta, scenario.doors))} if scenario.doors else {}),
        **({"company": asdict(scenario.company)} if scenario.company else {}),
        **({"errands": scenario.errands.kind} if scenario.errands else {}),
        **({"replaces": _walk_meta(scenario.replaces)} if scenario.replaces else {}),
        **({"furniture": list(map(furniture_meta, scenario.world.furniture))} if scenario.world.furniture else {}),
    }


def _walk_meta(walk: RecordedWalk) -> dict[str, Any]:
    return {
        "person": walk.person,
        "begin": walk.begin,
        "stamps": walk.stamps.tolist(),
        "positions": walk.positions_xy.tolist(),
    }


def _event_dict(event: Event) -> dict[str, Any]:
    return {"stamp": event.stamp, "kind": event.kind, "detail": event.detail}


def _pose_list(pose: Pose) -> list[float]:
    return [pose.x, pose.y, pose.theta]
