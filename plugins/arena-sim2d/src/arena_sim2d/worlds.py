"""The state of N worlds, and how single ones begin anew."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import Crowd, Scenario, stream_key
from arena_kernels.grids import stack_grids
from arena_sim2d.bodies import People, Robots, Touch
from arena_sim2d.obstacles import pack_obstacles
from arena_sim2d.odometry import Odometers
from arena_sim2d.scanning import Scans
from arena_sim2d.scene import Scene

Slots = NDArray[np.int64]


class Worlds:
    """N worlds as the kernels step them; ``crowd`` is the pedestrian model's latest answer, ``people`` are where they really are."""

    scenarios: list[Scenario]
    scene: Scene
    robots: Robots
    people: People
    states: NDArray[np.int8]
    touch: Touch
    odometers: Odometers
    scans: Scans

    def __init__(self, scenarios: Sequence[Scenario], crowd: Crowd, beams: int, edges: int) -> None:
        """Begin ``scenarios``; a robot has ``beams`` beams and at most ``edges`` rising edges with one thing between two crowd steps."""
        total = len(scenarios)
        self._edges = edges
        self.scenarios = list(scenarios)
        self.robots = Robots(np.zeros((total, 3)), np.zeros((total, 3)), np.zeros(total, np.int64))
        self.odometers = Odometers(
            np.zeros((total, 3)), np.zeros((total, 3)), np.zeros(total, np.int64), np.zeros((total, 3)), np.zeros(total, np.uint64)
        )
        self.scans = Scans(np.zeros((total, beams), np.float32), np.zeros(total, np.int64), np.zeros(total, np.uint64))
        self.people = _people(crowd)
        self.touch = self._no_touch(0)
        self.begin(np.arange(total), scenarios, crowd)

    def begin(self, slots: Slots, scenarios: Sequence[Scenario], crowd: Crowd) -> None:
        """Begin ``scenarios`` in these slots; ``crowd`` holds the people of all worlds, of which only those in ``slots`` are taken."""
        for slot, scenario in zip(slots.tolist(), scenarios, strict=True):
            self._begin_one(slot, scenario)
        stack, grid_of = stack_grids([scenario.world.grid for scenario in self.scenarios])
        self.scene = Scene(stack, grid_of, pack_obstacles(self.scenarios))
        kept = np.setdiff1d(np.arange(len(self.scenarios)), slots)
        self._take_people(kept, crowd)
        self._keep_touch(kept)

    def _begin_one(self, slot: int, scenario: Scenario) -> None:
        self.scenarios[slot] = scenario
        for state in (self.robots, self.odometers):
            for array in state:
                array[slot] = 0
        self.robots.poses[slot] = self.odometers.true_poses[slot] = scenario.start.array()
        self.odometers.keys[slot] = stream_key(scenario.seed, scenario.name, "odometry")
        self.scans.keys[slot] = stream_key(scenario.seed, scenario.name, "lidar")

    def _take_people(self, kept: Slots, crowd: Crowd) -> None:
        before, self.people = self.people, _people(crowd)
        self.states = crowd.states.copy()
        common = min(before.ids.shape[1], self.people.ids.shape[1])
        for old, new in zip(before[2:], self.people[2:], strict=True):
            new[kept, :common] = old[kept, :common]

    def _keep_touch(self, kept: Slots) -> None:
        before = self.touch
        most = max((len(scenario.obstacles) for scenario in self.scenarios), default=0)
        self.touch = self._no_touch(most)
        self.touch.ticks[kept] = before.ticks[kept]
        for old, new in ((0, 0), (before.first_person, self.touch.first_person)):
            end = before.first_person if old == 0 else before.held.shape[1]
            length = min(end - old, (self.touch.first_person if new == 0 else self.touch.held.shape[1]) - new)
            self.touch.held[kept, new : new + length] = before.held[kept, old : old + length]

    def _no_touch(self, obstacles: int) -> Touch:
        total, people = self.people.ids.shape
        things = 1 + obstacles + people
        return Touch(
            np.zeros((total, things), np.bool_),
            np.zeros(total, np.int64),
            np.zeros((total, things * self._edges, 7)),
            np.zeros(total, np.int64),
            1 + obstacles,
        )

    def crowd(self) -> Crowd:
        """Return copies of the people as they are."""
        people = self.people
        return Crowd(
            people.counts.copy(),
            people.ids.copy(),
            people.positions.copy(),
            people.velocities.copy(),
            people.radii.copy(),
            self.states.copy(),
        )

    def follow(self, wanted: Crowd, ticks: int) -> None:
        """Let people go in ``ticks`` equal strides to where the pedestrian model wants them."""
        np.subtract(wanted.positions, self.people.positions, out=self.people.strides)
        self.people.strides[...] /= ticks
        self.people.velocities[...] = wanted.velocities
        self.states = wanted.states.copy()


def _people(crowd: Crowd) -> People:
    return People(
        np.array(crowd.counts, np.int32),
        np.array(crowd.ids, np.int32),
        np.array(crowd.positions, np.float64),
        np.array(crowd.velocities, np.float64),
        np.array(crowd.radii, np.float64),
        np.zeros(crowd.positions.shape),
    )
