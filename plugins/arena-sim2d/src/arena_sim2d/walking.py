"""Legs: who has them, how they begin, and what a lidar sees of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Gait as GaitOfPeople
from arena_core import Scenario, random_generator
from arena_kernels.compiled import borrowing, inner
from arena_kernels.legs import STANDING, Gait, Legs, legs_of, smooth_velocity, step_length
from arena_sim2d.bodies import Row, Rows, Worlds, team_of

NO_LEGS = Gait(*[1.0] * len(Gait._fields))


def gait_of(gait: GaitOfPeople | None) -> Gait:
    """Return a gait as the kernels read it; no one walks where there is none."""
    return NO_LEGS if gait is None else Gait(*map(float, astuple(gait)))


def begin_walking(
    people: Rows, walks: NDArray[np.bool_], scenarios: Sequence[Scenario], slots: NDArray[np.int64]
) -> None:
    """Put those of ``people`` (N, P) in these slots who walk on their legs: each somewhere in a step, who stands
    looking anywhere.

    What is drawn depends on the scenario alone.
    """
    for slot, scenario in zip(slots.tolist(), scenarios, strict=True):
        rows = people[slot]
        drawn = random_generator(scenario.seed, scenario.name, "gait").uniform(
            (0.0, -math.pi), (2.0, math.pi), (len(rows), 2)
        )
        rows["walks"], rows["steps"] = walks[slot], drawn[:, 0]
        rows["leg_vx"] = np.nan_to_num(rows["vx"]) + STANDING * np.cos(drawn[:, 1])
        rows["leg_vy"] = np.nan_to_num(rows["vy"]) + STANDING * np.sin(drawn[:, 1])
        rows["from_x"], rows["from_y"] = rows["x"], rows["y"]


@borrowing
def count_steps(worlds: Worlds, dt: float) -> None:
    """Count the steps of everybody who walks since they were last counted, ``dt`` s ago."""
    for k in range(len(worlds.people)):
        for i in range(worlds.robots[k * team_of(worlds)].people):
            person = worlds.people[k, i]
            dx, dy = person.x - person.from_x, person.y - person.from_y
            person.from_x, person.from_y = person.x, person.y
            if person.walks == 1 and not math.isnan(dx):
                person.leg_vx, person.leg_vy = smooth_velocity(
                    worlds.gait, (person.leg_vx, person.leg_vy), (dx / dt, dy / dt), dt
                )
                person.steps += _step_count(worlds.gait, person, dx, dy)


@inner
def legs_now(gait: Gait, person: Row) -> Legs:
    """Return where a person's legs are, as ``legs_of`` does."""
    steps = person.steps + _step_count(gait, person, person.x - person.from_x, person.y - person.from_y)
    return legs_of(gait, person.x, person.y, person.radius, (person.leg_vx, person.leg_vy), steps)


@inner
def _step_count(gait: Gait, person: Row, dx: float, dy: float) -> float:
    """Return how many steps a way has."""
    pace = math.sqrt(person.leg_vx * person.leg_vx + person.leg_vy * person.leg_vy)
    return math.sqrt(dx * dx + dy * dy) / step_length(gait, pace)
