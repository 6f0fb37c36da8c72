"""One step of N crowds of ORCA agents, as one compiled call."""

from __future__ import annotations

from math import cos, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from arena_crowds.orca.avoidance import WALLS, choose_velocity
from arena_crowds.orca.parameters import OrcaRules
from arena_crowds.orca.route_following import allocate_sight_lines, set_out, walk_direction
from arena_crowds.orca.walkers import NOTHING
from arena_kernels.compiled import borrowing, compiled
from arena_kernels.crowds import Bodies, Crowds, NearPairs, Robots, RobotStack, bodies_of, robots_of
from arena_kernels.doorways import door_ahead
from arena_kernels.ground import Ground, GroundStack, world_ground
from arena_kernels.neighbours import CELLS_FROM, near_pairs
from arena_kernels.separation import push_apart
from arena_kernels.slide_along import slide_along

Floats = NDArray[np.float64]


@compiled
def step_crowds(
    crowds: Crowds,
    memory: NDArray[np.void],
    corners: Floats,
    land: GroundStack,
    robots: RobotStack,
    dt: float,
    rules: OrcaRules,
) -> int:
    """Move everybody by ``dt`` s, in place; return how many people wish for a route."""
    small = min(crowds.positions.shape[1], CELLS_FROM)
    pairs = np.empty((small * small // 2, 2), np.int32)
    wishes = 0
    for world in range(len(crowds.counts)):
        if crowds.counts[world] == 0:
            continue
        bodies, team, ground = bodies_of(crowds, world), robots_of(robots, world), world_ground(land, world)
        pairs = _step_crowd(bodies, memory[world], corners[world], ground, team, dt, rules, pairs)
        for i in range(crowds.counts[world]):
            wishes += memory[world, i].wish != NOTHING
    return wishes


@compiled
def _step_crowd(
    bodies: Bodies,
    memory: NDArray[np.void],
    corners: Floats,
    ground: Ground,
    robots: Robots,
    dt: float,
    rules: OrcaRules,
    pairs: NDArray[np.int32],
) -> NDArray[np.int32]:
    """Move the people of one world in place; return the pair list for further use."""
    positions, states = bodies.positions, bodies.states
    people = len(positions)
    pairs, found = near_pairs(positions, rules.range, pairs)
    near, nears = _nearest_neighbours(positions, pairs, found, rules.neighbours)
    most = WALLS + len(robots.radii) + rules.neighbours
    lines, scratch = np.empty((most, 4)), np.empty((most, 4))
    chosen = np.empty((people, 2))
    set_out(bodies, memory, corners, ground, dt, rules.way, allocate_sight_lines(people))
    for i in range(people):
        hx, hy, way = walk_direction(memory[i], states[i], positions[i, 0], positions[i, 1], corners[i])
        if memory[i].waiting == 1 and door_ahead(ground, (positions[i, 0], positions[i, 1], bodies.radii[i]), hx, hy):
            hx, hy = 0.0, 0.0
        speed = memory[i].desired_speed
        wish = _preferred_velocity(hx, hy, min(speed, way / dt), rules.side if nears[i] > 0 or rules.yields else 0.0)
        chosen[i, 0], chosen[i, 1] = choose_velocity(
            i, bodies, near[i, : nears[i]], wish, speed, ground, robots, rules, lines, scratch
        )
    _move_bodies(bodies, memory, ground, dt, NearPairs(pairs, found), chosen)
    return pairs


@borrowing
def _preferred_velocity(hx: float, hy: float, speed: float, right: float) -> tuple[float, float]:
    """Return the preferred velocity: along a unit vector that is turned to the right by an angle."""
    c, s = cos(right), sin(right)
    return speed * (c * hx + s * hy), speed * (c * hy - s * hx)


@compiled
def _nearest_neighbours(
    positions: Floats, pairs: NDArray[np.int32], found: int, most: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Return each person's nearest neighbours (P, most), nearest first, and how many they are (P,)."""
    people = len(positions)
    near, apart, counts = np.empty((people, most), np.int32), np.empty((people, most)), np.zeros(people, np.int32)
    for pair in range(found):
        i, j = pairs[pair, 0], pairs[pair, 1]
        squared = (positions[i, 0] - positions[j, 0]) ** 2 + (positions[i, 1] - positions[j, 1]) ** 2
        counts[i] = _insert_neighbour(near[i], apart[i], counts[i], j, squared)
        counts[j] = _insert_neighbour(near[j], apart[j], counts[j], i, squared)
    return near, counts


@borrowing
def _insert_neighbour(near: NDArray[np.int32], apart: Floats, count: int, other: int, squared: float) -> int:
    """Put a neighbour in its place among those so far, and drop the farthest if they are too
    many; return how many they are.
    """
    if count == len(near):
        if squared >= apart[count - 1]:
            return count
        count -= 1
    place = count
    while place > 0 and apart[place - 1] > squared:
        near[place], apart[place] = near[place - 1], apart[place - 1]
        place -= 1
    near[place], apart[place] = other, squared
    return count + 1


@compiled
def _move_bodies(
    bodies: Bodies, memory: NDArray[np.void], ground: Ground, dt: float, near: NearPairs, chosen: Floats
) -> None:
    """Move the bodies, apart from each other and out of walls; who was hindered has the velocity of the real move."""
    positions, velocities, radii, _ = bodies
    people = len(positions)
    starts, pushes = positions.copy(), np.empty((people, 2))
    for i in range(people):
        positions[i, 0], positions[i, 1] = slide_along(
            ground, (starts[i, 0], starts[i, 1], radii[i]), dt * chosen[i, 0], dt * chosen[i, 1]
        )
    touching = push_apart(positions, radii, near.pairs, near.found, pushes)
    for i in range(people):
        dx, dy = positions[i, 0] - starts[i, 0], positions[i, 1] - starts[i, 1]
        if touching and (pushes[i, 0] != 0.0 or pushes[i, 1] != 0.0):
            dx, dy = _limit_length(dx + pushes[i, 0], dy + pushes[i, 1], memory[i].desired_speed * dt)
            positions[i, 0], positions[i, 1] = slide_along(ground, (starts[i, 0], starts[i, 1], radii[i]), dx, dy)
            dx, dy = positions[i, 0] - starts[i, 0], positions[i, 1] - starts[i, 1]
        velocities[i, 0], velocities[i, 1] = _limit_length(dx / dt, dy / dt, memory[i].desired_speed)


@borrowing
def _limit_length(x: float, y: float, longest: float) -> tuple[float, float]:
    """Return a vector, shortened to ``longest`` if it is longer."""
    squared = x * x + y * y
    if squared <= longest * longest:
        return x, y
    shrink = longest / sqrt(squared)
    return shrink * x, shrink * y
