"""Refuses scenarios whose robot cannot stand where it is to start."""

from __future__ import annotations

import numpy as np

from arena_core import ImpossibleScenario
from arena_kernels.footprint import gap_to_cells, gap_to_disc, place
from arena_kernels.grids import to_grid
from arena_sim2d.bodies import Chassis, Floats
from arena_sim2d.contact import TOLERANCE
from arena_sim2d.gaps import gap_to_obstacle, obstacle_count
from arena_sim2d.worlds import Slots, Worlds


def check_starts(chassis: Chassis, worlds: Worlds, slots: Slots) -> None:
    """Raise ImpossibleScenario if a robot in these slots starts outside its grid or inside something."""
    hull = np.empty((max(len(chassis.vertices), 1), 2))
    for k in slots.tolist():
        x, y, theta = worlds.robots.poses[k].tolist()
        place(chassis.vertices, x, y, theta, hull)
        blocker = _blocker(chassis, worlds, k, hull, x, y)
        if blocker is not None:
            raise ImpossibleScenario(f"{worlds.scenarios[k].name}: the robot's start ({x:.2f}, {y:.2f}) {blocker}")


def _blocker(chassis: Chassis, worlds: Worlds, k: int, hull: Floats, x: float, y: float) -> str | None:
    """Say what is wrong with a start, None when it is free."""
    scene, people, rounding = worlds.scene, worlds.people, chassis.rounding
    g = int(scene.grid_of[k])
    u, v = to_grid(scene.stack, g, x, y)
    if not (0.0 <= u < scene.stack.shapes[g, 1] and 0.0 <= v < scene.stack.shapes[g, 0]):
        return "lies outside the map"
    if gap_to_cells(scene.stack, g, hull, rounding, x, y, chassis.radius, 0.0)[0] < -TOLERANCE:
        return "overlaps a wall"
    for index in range(obstacle_count(scene.obstacles, k)):
        if gap_to_obstacle(scene.obstacles, k, index, hull, rounding)[0] < -TOLERANCE:
            return "overlaps an obstacle"
    for i in range(people.counts[k]):
        px, py = people.positions[k, i].tolist()
        if gap_to_disc(hull, rounding, px, py, float(people.radii[k, i]))[0] < -TOLERANCE:
            return f"overlaps person {people.ids[k, i]} at ({px:.2f}, {py:.2f})"
    return None
