"""The state of N worlds, and how single ones begin anew."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import Crowd, Robot, Scenario, stream_key
from arena_kernels.footprint import make_body
from arena_kernels.grids import stack_grids
from arena_sim2d.bodies import Moving, People, Robots, Touch, chassis
from arena_sim2d.obstacles import pack_obstacles
from arena_sim2d.odometry import Odometers
from arena_sim2d.scanning import Scans
from arena_sim2d.scene import Scene

Slots = NDArray[np.int64]


class Worlds:
    """N worlds as the kernels step them; the people of ``moving`` are where they really are, ``states`` as the crowd gave them."""

    scenarios: list[Scenario]
    moving: Moving
    states: NDArray[np.int8]
    odometers: Odometers
    scans: Scans

    def __init__(self, robot: Robot, scenarios: Sequence[Scenario], crowd: Crowd, crowd_ticks: int) -> None:
        """Begin ``scenarios``; the crowd is asked every ``crowd_ticks`` ticks."""
        total = len(scenarios)
        self._edges = (crowd_ticks + 1) // 2  # a contact ends a tick after it began at the earliest
        self.scenarios = list(scenarios)
        self.odometers = Odometers(
            np.zeros((total, 3)), np.zeros((total, 3)), np.zeros(total, np.int64), np.zeros((total, 3)), np.zeros(total, np.uint64)
        )
        self.scans = Scans(np.zeros((total, robot.lidar.beams), np.float32), np.zeros(total, np.int64), np.zeros(total, np.uint64))
        robots = Robots(np.zeros((total, 3)), np.zeros((total, 3)), np.zeros(total, np.int64))
        body = make_body(robot.footprint.vertices_xy, robot.footprint.radius)
        person = make_body(np.empty((0, 2)), 1.0)
        people = _people(crowd)
        self.moving = Moving(self._scene(), chassis(robot), robots, people, self._no_touch(people), body, person)
        self.begin(np.arange(total), scenarios, crowd)

    def begin(self, slots: Slots, scenarios: Sequence[Scenario], crowd: Crowd) -> None:
        """Begin ``scenarios`` in these slots; ``crowd`` holds the people of all worlds, of which only those in ``slots`` are taken."""
        for slot, scenario in zip(slots.tolist(), scenarios, strict=True):
            self._begin_one(slot, scenario)
        kept = np.setdiff1d(np.arange(len(self.scenarios)), slots)
        people = _people(crowd)
        self.states = crowd.states.copy()
        common = min(people.ids.shape[1], self.moving.people.ids.shape[1])
        for old, new in zip(self.moving.people[2:], people[2:], strict=True):
            new[kept, :common] = old[kept, :common]
        touch = self._no_touch(people)
        _keep_touch(self.moving.touch, touch, kept)
        self.moving = self.moving._replace(scene=self._scene(), people=people, touch=touch)

    def _begin_one(self, slot: int, scenario: Scenario) -> None:
        self.scenarios[slot] = scenario
        for array in (*self.moving.robots, *self.odometers):
            array[slot] = 0
        self.moving.robots.poses[slot] = self.odometers.true_poses[slot] = scenario.start.array()
        self.odometers.keys[slot] = stream_key(scenario.seed, scenario.name, "odometry")
        self.scans.keys[slot] = stream_key(scenario.seed, scenario.name, "lidar")

    def _scene(self) -> Scene:
        stack, grid_of = stack_grids([scenario.world.grid for scenario in self.scenarios])
        return Scene(stack, grid_of, pack_obstacles(self.scenarios))

    def _no_touch(self, people: People) -> Touch:
        total, slots = people.ids.shape
        first_person = 1 + max((len(scenario.obstacles) for scenario in self.scenarios), default=0)
        things = first_person + slots
        held = np.zeros((total, things), np.bool_)
        edges = np.zeros((total, things * self._edges, 7))
        return Touch(held, np.zeros(total, np.int64), edges, np.zeros(total, np.int64), first_person)

    def crowd(self) -> Crowd:
        """Return copies of the people as they are."""
        people = self.moving.people
        positions, velocities = people.positions.copy(), people.velocities.copy()
        return Crowd(people.counts.copy(), people.ids.copy(), positions, velocities, people.radii.copy(), self.states.copy())

    def follow(self, wanted: Crowd, ticks: int) -> None:
        """Let people go in ``ticks`` equal strides to where the pedestrian model wants them."""
        people = self.moving.people
        np.subtract(wanted.positions, people.positions, out=people.strides)
        people.strides[...] /= ticks
        people.velocities[...] = wanted.velocities
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


def _keep_touch(old: Touch, new: Touch, kept: Slots) -> None:
    """Take over what the robots of ``kept`` worlds touch; obstacles and people may have got other numbers."""
    new.ticks[kept] = old.ticks[kept]
    obstacles = min(old.first_person, new.first_person)
    people = min(old.held.shape[1] - old.first_person, new.held.shape[1] - new.first_person)
    new.held[kept, :obstacles] = old.held[kept, :obstacles]
    new.held[kept, new.first_person : new.first_person + people] = old.held[kept, old.first_person : old.first_person + people]
