"""Refuses scenarios whose robot cannot stand where it is to start."""

from __future__ import annotations

from arena_core import ImpossibleScenario
from arena_kernels.footprint import gap_to_cells, place
from arena_kernels.grids import to_grid
from arena_sim2d.bodies import Moving
from arena_sim2d.contact import TOLERANCE
from arena_sim2d.gaps import gap_to_people, gap_to_things
from arena_sim2d.worlds import Slots, Worlds


def check_starts(worlds: Worlds, slots: Slots) -> None:
    """Raise ImpossibleScenario if a robot in these slots starts outside its grid or inside something."""
    for k in slots.tolist():
        x, y, theta = worlds.moving.robots.poses[k].tolist()
        place(worlds.moving.body, x, y, theta)
        reason = _reason(worlds.moving, k, x, y)
        if reason is not None:
            raise ImpossibleScenario(f"{worlds.scenarios[k].name}: the robot's start ({x:.2f}, {y:.2f}) {reason}")


def _reason(world: Moving, k: int, x: float, y: float) -> str | None:
    """Say what is wrong with a start, None when it is free."""
    stack, g = world.scene.stack, world.scene.grid_of[k]
    u, v = to_grid(stack, g, x, y)
    if not (0.0 <= u < stack.shapes[g, 1] and 0.0 <= v < stack.shapes[g, 0]):
        return "lies outside the map"
    if gap_to_cells(stack, g, world.body, -TOLERANCE)[0] < 0.0:
        return "overlaps a wall"
    if gap_to_things(world.scene, k, world.body, -TOLERANCE)[0] < 0.0:
        return "overlaps an obstacle"
    if gap_to_people(world.people, k, world.body, -TOLERANCE) < 0.0:
        return "overlaps a person"
    return None
