"""How people walked beside a robot in one episode, and the figures that say so."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from arena_core import ABSENT, OccupancyGrid, Scenario
from arena_kernels.distance import grid_distance

Floats = NDArray[np.float64]

NEAR = 1.0  # m between the centres of robot and person: an encounter
RESTING = (ABSENT, 1)  # states of who is not walking; 1 is waiting, in every model
SLOW = 0.1  # share of the person's own speed below which a person who means to walk stands
AT_WALL = 0.3  # m between body and wall
SMOOTHED = 1.0  # s over which a speed is taken: sway is no walking


@dataclass(frozen=True, slots=True, eq=False)
class WalkRecord:
    """One episode at T instants: ``stamps`` (T,) s, ``poses`` (T, 3) of the robot, ``positions``
    (T, P, 2) m and ``states`` (T, P).
    """

    scenario: Scenario
    stamps: Floats
    poses: Floats
    positions: Floats
    states: NDArray[np.int8]

    @property
    def minutes(self) -> float:
        """Return how long it was."""
        return float(self.stamps[-1] - self.stamps[0]) / 60.0

    def encounters(self) -> int:
        """Count how often a person came near the robot."""
        gaps = np.hypot(*np.moveaxis(self.positions - self.poses[:, None, :2], 2, 0))
        near = (np.nan_to_num(gaps, nan=np.inf) < NEAR).any(axis=1)
        return int(near[0]) + int((near[1:] & ~near[:-1]).sum())

    def spans(self) -> Floats:
        """Return the diagonal of the box round everybody's track, (P,) m."""
        return np.asarray(np.hypot(*(np.nanmax(self.positions, axis=0) - np.nanmin(self.positions, axis=0)).T))

    def paces(self) -> Floats:
        """Return everybody's mean speed while walking, as a share of the person's own greatest speed, (P,)."""
        shares, walking = self._speed_shares(), self._is_walking()
        return np.asarray(np.nansum(np.where(walking, shares, 0.0), axis=0) / np.maximum(walking.sum(axis=0), 1))

    def standing(self) -> Floats:
        """Return the longest time for which each person meant to walk and stood, anywhere and at a wall, (P, 2) s."""
        stands = self._is_walking() & (self._smooth_shares() < SLOW)
        gaps = _wall_gaps(self.scenario.world.grid, self.positions[1:]) - np.array(
            [spec.radius for spec in self.scenario.pedestrians]
        )
        steps = np.diff(self.stamps)
        return np.stack([_longest_spells(stands, steps), _longest_spells(stands & (gaps < AT_WALL), steps)], axis=1)

    def _is_walking(self) -> NDArray[np.bool_]:
        return np.asarray(~np.isin(self.states[1:], RESTING) & ~np.isin(self.states[:-1], RESTING))

    def _speed_shares(self) -> Floats:
        steps = np.hypot(*np.moveaxis(np.diff(self.positions, axis=0), 2, 0)) / np.diff(self.stamps)[:, None]
        return np.asarray(steps / self._desired_speeds())

    def _smooth_shares(self) -> Floats:
        """Return speeds over a moment around each step, (T - 1, P) shares."""
        half = max(round(0.5 * SMOOTHED / float(np.diff(self.stamps).mean())), 1)
        now = np.arange(1, len(self.stamps))
        before, after = np.maximum(now - half, 0), np.minimum(now + half, len(self.stamps) - 1)
        moved = np.hypot(*np.moveaxis(self.positions[after] - self.positions[before], 2, 0))
        return np.asarray(moved / (self.stamps[after] - self.stamps[before])[:, None] / self._desired_speeds())

    def _desired_speeds(self) -> Floats:
        return np.array([spec.desired_speed for spec in self.scenario.pedestrians])


def waypoint_spans(scenario: Scenario) -> Floats:
    """Return the diagonal of the box round everybody's start and waypoints, (P,) m."""
    boxes = [np.vstack((spec.position_xy[None], spec.waypoints_xy)) for spec in scenario.pedestrians]
    return np.array([float(np.hypot(*np.ptp(box, axis=0))) for box in boxes])


def free_area(grid: OccupancyGrid) -> float:
    """Return the area of the largest region of known free cells, m^2."""
    return grid.derive(_largest_free) * grid.resolution**2


def _largest_free(grid: OccupancyGrid) -> float:
    labels, _ = ndimage.label((grid.data >= 0) & (grid.data < grid.occupied_from))
    return float(np.bincount(labels.ravel())[1:].max(initial=0))


def _wall_gaps(grid: OccupancyGrid, positions: Floats) -> Floats:
    """Return how far positions (..., 2) are from the nearest wall, m; inf for who is not there."""
    there = np.asarray(np.isfinite(positions).all(axis=-1))
    cells = grid.cells(np.where(there[..., None], positions, 0.0))
    distance = grid.derive(grid_distance)
    rows, columns = (np.clip(cells[..., k], 0, distance.shape[k] - 1) for k in (0, 1))
    return np.asarray(np.where(there, distance[rows, columns] - 0.5 * grid.resolution, np.inf))


def _longest_spells(holds: NDArray[np.bool_], steps: Floats) -> Floats:
    """Return the longest time for which each column (T, P) holds without a break, (P,) s."""
    running, longest = np.zeros(holds.shape[1]), np.zeros(holds.shape[1])
    for row, step in zip(holds, steps, strict=True):
        running = np.where(row, running + step, 0.0)
        longest = np.maximum(longest, running)
    return longest
