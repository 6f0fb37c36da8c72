"""What is known of a problem before a way is searched: the ground, and the people's future."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from arena_core import Pose, Robot, Scenario
from arena_core.hosting import Truth
from arena_reference.arrays import Floats, Mask, Values
from arena_reference.body import Walkers
from arena_reference.terrain import Terrain, terrain_of
from arena_reference.values import FINE, NEVER, STRIDE, goal_values, static_times

LONGEST_PERIOD = 0.1  # s between two positions: people go straight between two calls of their model


def foresee(truth: Truth, until: float, period: float) -> Walkers:
    """Return where people will be from now until so many seconds later, ``period`` s apart, without the robot."""
    now = truth.state().stamp
    ahead = truth.people_ahead(np.arange(math.ceil(until / period) + 1) * period)
    positions = np.ascontiguousarray(ahead.positions.transpose(1, 0, 2), np.float64)
    return Walkers(positions, np.asarray(ahead.radii, np.float64), float(now), period)


def part_of(control_period: float) -> float:
    """Return the part of a control period, s, at whose ends people are looked at."""
    return control_period / math.ceil(control_period / LONGEST_PERIOD - 1e-9)


def fastest(robot: Robot, share: float = 1.0) -> float:
    """Return the greatest speed of a robot in any direction, m/s, with a share of its speed limits."""
    limits = robot.limits
    return share * math.hypot(max(limits.vx_max, -limits.vx_min), limits.vy_max)


def strongest(robot: Robot) -> float:
    """Return the greatest acceleration of a robot in any direction, m/s^2."""
    return math.hypot(robot.limits.ax_max, robot.limits.ay_max)


@dataclass(frozen=True, slots=True, eq=False)
class Grounds:
    """Where the middle of a disc may be, and how long it needs to the goal among what stands.

    ``free`` (H, W), ``goal`` and ``left`` (H, W) in parts of a step (``arena_reference.values``).
    """

    terrain: Terrain
    free: Mask
    goal: Values
    left: Values

    def steps_from(self, place: Pose) -> float:
        """Return how many steps are left from a place, by the least of the cells about it; inf if there is no way."""
        column, row = self.terrain.cells_of(place.x, place.y)
        about = self.left[max(int(row) - 1, 0) : int(row) + 2, max(int(column) - 1, 0) : int(column) + 2]
        least = int(about.min()) if about.size else int(NEVER)
        return math.inf if least == NEVER else max(least - FINE, 0) / FINE


def walkers_in_cells(ground: Terrain, walkers: Walkers) -> Walkers:
    """Return people with positions and radii in cells of a ground."""
    dx, dy = ((walkers.positions[..., i] - (ground.x, ground.y)[i]) / ground.cell for i in range(2))
    turned = np.stack((ground.cosine * dx + ground.sine * dy, ground.cosine * dy - ground.sine * dx), axis=-1)
    return Walkers(np.ascontiguousarray(turned), walkers.radii / ground.cell, walkers.start, walkers.period)


def make_grounds(terrain: Terrain, scenario: Scenario, room: float, within: float) -> Grounds:
    """Return the ground for a disc that keeps ``room`` m from what stands, and has arrived ``within`` m of the goal."""
    free = terrain.distance > room
    goal_x, goal_y = terrain.cells_of(scenario.goal.x, scenario.goal.y)
    goal = goal_values(free.shape[0], free.shape[1], goal_x, goal_y, within / terrain.cell)
    return Grounds(terrain, free, goal, static_times(free, goal))


def stride_time(terrain: Terrain, speed: float) -> float:
    """Return how long a step over the ground's cells takes, s."""
    return STRIDE * terrain.cell / speed


class Site:
    """The grounds of the newest problem, each made once."""

    def __init__(self, robot_height: float) -> None:
        self._height = robot_height
        self._scenario: Scenario | None = None
        self._terrains: dict[float, Terrain] = {}
        self._grounds: dict[tuple[float, float, float], Grounds] = {}

    def _begin(self, scenario: Scenario) -> None:
        if scenario is not self._scenario:
            self._scenario, self._terrains, self._grounds = scenario, {}, {}

    def terrain(self, scenario: Scenario, cell: float, *, keep: bool = True) -> Terrain:
        """Return the ground of a problem with cells of about this size, m; ``keep`` it for whoever asks next."""
        self._begin(scenario)
        ground = self._terrains.get(cell)
        if ground is None:
            ground = terrain_of(scenario, cell, self._height)
        if keep:
            self._terrains[cell] = ground
        return ground

    def grounds(self, scenario: Scenario, cell: float, room: float, within: float) -> Grounds:
        """Return what ``make_grounds`` does, for a disc that keeps ``room`` m from what stands."""
        terrain, key = self.terrain(scenario, cell), (cell, room, within)
        if key not in self._grounds:
            self._grounds[key] = make_grounds(terrain, scenario, room - terrain.error, within)
        return self._grounds[key]


def start_state(truth: Truth) -> Floats:
    """Return the robot's pose in ``map`` and velocity in ``base_link`` now, (6,)."""
    state = truth.state()
    return np.array((*state.pose.array(), *state.twist.array()), np.float64)
