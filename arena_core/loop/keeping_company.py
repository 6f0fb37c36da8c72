"""Where a robot that keeps with a person is to be now, and whether it has done what its task asks for."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from arena_core.base.errors import ImpossibleScenario
from arena_core.values.company import Company
from arena_core.values.episode import Scenario, WorldState
from arena_core.values.geometry import FloatArray, Pose
from arena_core.values.success import ARRIVAL_SLACK, AT_WAYPOINT
from arena_core.values.world import FREE

SPACING = 0.1  # m between the points of a person's trail
LOOK_AHEAD = 1.0  # s of a person's walk by which a robot at its side heads ahead of it
RESUME = 0.8  # of the farthest distance, within which a robot that waits for its person drives on
SLOW = 0.05  # m/s, below which a person's velocity says no direction


class CompanyKeeper:
    """Tells the goal of a robot that keeps with a person, as a tracker that never errs would.

    Nav2 calls such a robot's goal a dynamic point, which its behaviour tree follows; here, too, planners only see a
    goal that moves.
    """

    def __init__(self, company: Company, scenario: Scenario) -> None:
        self._company, self._scenario = company, scenario
        self._person = next(person for person in scenario.pedestrians if person.id == company.person)
        start, here = scenario.start.array()[:2], np.asarray(self._person.position_xy, np.float64)
        kept = math.ceil(company.distance / SPACING) + 2  # points that reach back as far as the robot is to be
        self._trail = deque([start, here], kept)
        self._heading = math.atan2(*(here - start)[::-1])
        self._waits = False

    def goal(self, state: WorldState) -> Pose:
        """Return where the robot is to be now, in ``map``; raise ImpossibleScenario where there is no such person."""
        place, velocity = self._look(state)
        if self._company.manner == "lead":
            return self._goal_of_leader(state, place)
        if np.hypot(*(place - self._trail[-1])) >= SPACING:
            self._trail.append(place)
        if np.hypot(*velocity) >= SLOW:
            self._heading = math.atan2(velocity[1], velocity[0])
        beside = self._beside(state, place + LOOK_AHEAD * velocity) if self._company.manner == "accompany" else None
        x, y = self._behind(place) if beside is None else beside
        return Pose(float(x), float(y), self._heading)

    def is_fulfilled(self, state: WorldState) -> bool:
        """Return whether person and robot have come to the end of their way together."""
        place, _ = self._look(state)
        together = math.dist(place, (state.pose.x, state.pose.y)) <= self._company.farthest + ARRIVAL_SLACK
        if self._company.manner == "lead":
            goal = self._scenario.goal
            return together and state.pose.distance(goal) <= self._scenario.goal_radius + ARRIVAL_SLACK
        end = self._person.waypoints_xy[-1] if len(self._person.waypoints_xy) else self._person.position_xy
        return together and math.dist(place, end) <= AT_WAYPOINT

    def _look(self, state: WorldState) -> tuple[FloatArray, FloatArray]:
        """Return position and velocity of the person; who is not there stands where it was last.

        Raises ImpossibleScenario where the pedestrian model has left the person out.
        """
        slots = np.flatnonzero(state.pedestrians.ids == self._company.person)
        if not len(slots):
            raise ImpossibleScenario(
                f"{self._scenario.name}: person {self._company.person}, with whom the robot is to keep, is not among "
                "the people; allowed: pedestrians=social_force, or another model of the task's own people"
            )
        slot = int(slots[0])
        place, velocity = state.pedestrians.positions[slot], state.pedestrians.velocities[slot]
        return (place, velocity) if np.isfinite(place).all() else (self._trail[-1], np.zeros(2))

    def _goal_of_leader(self, state: WorldState, place: FloatArray) -> Pose:
        """Return the scenario's goal, or where the robot stands while it waits for the person."""
        away = math.dist(place, (state.pose.x, state.pose.y))
        self._waits = away > (RESUME if self._waits else 1.0) * self._company.farthest
        return state.pose if self._waits else self._scenario.goal

    def _behind(self, place: FloatArray) -> FloatArray:
        """Return the place on the person's trail that lies the company's distance back along it."""
        trail = np.array([*self._trail, place])[::-1]
        lengths = np.concatenate(((0.0,), np.hypot(*np.diff(trail, axis=0).T).cumsum()))
        return np.array([np.interp(self._company.distance, lengths, trail[:, axis]) for axis in (0, 1)])

    def _beside(self, state: WorldState, place: FloatArray) -> FloatArray | None:
        """Return the place at that side of the person where the robot is, or at the other, None where walls leave
        neither.
        """
        left = np.array((-math.sin(self._heading), math.cos(self._heading)))
        side = 1.0 if (state.pose.array()[:2] - place) @ left >= 0.0 else -1.0
        for sign in (side, -side):
            beside = place + sign * self._company.distance * left
            if self._is_free_line(place, beside):
                return np.asarray(beside)
        return None

    def _is_free_line(self, start: FloatArray, end: FloatArray) -> bool:
        """Return whether the map is free from one place to the other, and a body beyond it."""
        grid = self._scenario.world.grid
        beyond = end + (end - start) / max(math.dist(start, end), 1e-9) * self._person.radius
        cells = grid.cells(np.linspace(start, beyond, 32))
        inside = ((cells >= 0) & (cells < grid.data.shape)).all()
        return bool(inside and (grid.data[tuple(cells.T)] == FREE).all())
