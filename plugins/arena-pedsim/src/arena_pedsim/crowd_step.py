"""One step of N crowds, as one compiled call."""

from __future__ import annotations

from math import ceil, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_pedsim.compiled import compiled
from arena_pedsim.forces import sight_weight, social_force, wall_force
from arena_pedsim.giving_way import detour, hold_back, keeps_off
from arena_pedsim.ground import Ground, clearance_and_gradient, ground_of
from arena_pedsim.neighbours import CELLS_FROM, near_pairs
from arena_pedsim.people import NOTHING
from arena_pedsim.separation import push_apart
from arena_pedsim.states import desired_speed, feels_forces
from arena_pedsim.walls import slide
from arena_pedsim.wayfinding import follow_way

FREE_STRIDE = 2.0  # no wall is met on a move of half the gap: the interpolated field rises a little more steeply than a distance

Floats = NDArray[np.float64]


@compiled
def step_crowds(
    counts: NDArray[np.int32],
    positions: Floats,
    velocities: Floats,
    radii: Floats,
    states: NDArray[np.int8],
    people: NDArray[np.void],
    corners: Floats,
    grids: NDArray[np.int64],
    stack: Any,
    robot_poses: Floats,
    robot_velocities: Floats,
    robot_radius: float,
    dt: float,
    parameters: NDArray[np.void],
) -> tuple[Floats, Floats, NDArray[np.int8], int]:
    """Return positions (N, P, 2), velocities (N, P, 2) and states (N, P) after ``dt`` s, and how many people wish for a route.

    ``people`` (N, P) and ``corners`` (N, P, C, 2) are the model's memory, ``grids`` (N,) says which of the stack's each world uses.
    """
    new_positions, new_velocities, new_states = positions.copy(), velocities.copy(), states.copy()
    slots = positions.shape[1]
    headings, forces = np.empty((slots, 4)), np.empty((slots, 2))
    small = min(slots, CELLS_FROM)
    pairs = np.empty((small * small // 2, 2), np.int32)
    substeps = max(int(ceil(dt / parameters[0].longest_step - 1e-9)), 1)
    wishes = 0
    for world in range(len(counts)):
        n = counts[world]
        if n == 0:
            continue
        robot = (robot_poses[world, 0], robot_poses[world, 1], robot_velocities[world, 0], robot_velocities[world, 1], robot_radius)
        ground = ground_of(stack, grids[world])
        for _ in range(substeps):
            pairs = _step_crowd(
                new_positions[world, :n],
                new_velocities[world, :n],
                radii[world, :n],
                new_states[world, :n],
                people[world],
                corners[world],
                ground,
                robot,
                dt / substeps,
                parameters[0],
                headings[:n],
                forces[:n],
                pairs,
            )
        for i in range(n):
            wishes += people[world, i].wish != NOTHING
    return new_positions, new_velocities, new_states, wishes


@compiled
def _step_crowd(
    positions: Floats,
    velocities: Floats,
    radii: Floats,
    states: NDArray[np.int8],
    people: NDArray[np.void],
    corners: Floats,
    ground: Ground,
    robot: Any,
    dt: float,
    parameters: Any,
    headings: Floats,
    forces: Floats,
    pairs: NDArray[np.int32],
) -> NDArray[np.int32]:
    """Move the people of one world in place; return the pair list for further use."""
    _choose_headings(positions, radii, states, people, corners, ground, robot, dt, parameters, headings)
    pairs, found = near_pairs(positions, parameters.social_range, pairs)
    _sum_forces(positions, velocities, radii, states, people, ground, robot, parameters, headings, pairs, found, forces)
    _accelerate(positions, velocities, radii, people, robot, dt, parameters, forces)
    _walk(positions, velocities, radii, people, ground, robot, dt, parameters, pairs, found, headings, forces)
    return pairs


@compiled
def _choose_headings(
    positions: Floats,
    radii: Floats,
    states: NDArray[np.int8],
    people: NDArray[np.void],
    corners: Floats,
    ground: Ground,
    robot: Any,
    dt: float,
    parameters: Any,
    headings: Floats,
) -> None:
    """Write each person's unit vector of the desired direction and the desired speed."""
    for i in range(len(positions)):
        x, y = positions[i, 0], positions[i, 1]
        state, hx, hy, to_goal = follow_way(people[i], states[i], x, y, radii[i], corners[i], ground, dt, parameters)
        if parameters.reaction == 1:
            hx, hy = detour(ground, x, y, hx, hy, to_goal, radii[i], robot, parameters)
        states[i] = state
        headings[i, 0], headings[i, 1], headings[i, 2] = hx, hy, desired_speed(state, people[i].max_speed)


@compiled
def _sum_forces(
    positions: Floats,
    velocities: Floats,
    radii: Floats,
    states: NDArray[np.int8],
    people: NDArray[np.void],
    ground: Ground,
    robot: Any,
    parameters: Any,
    headings: Floats,
    pairs: NDArray[np.int32],
    found: int,
    forces: Floats,
) -> None:
    """Write each person's acceleration: towards the desired velocity, away from people, walls and (if seen) the robot.

    ``headings`` (P, 4) gets the gap between body and walls in its last column.
    """
    forces[:] = 0.0
    rear = parameters.social_rear_weight
    for pair in range(found):
        i, j = pairs[pair, 0], pairs[pair, 1]
        dx, dy = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
        dvx, dvy = velocities[i, 0] - velocities[j, 0], velocities[i, 1] - velocities[j, 1]
        fx, fy, ex, ey = social_force(dx, dy, dvx, dvy, radii[i] + radii[j], parameters)
        weight_i = people[i].factor_social * sight_weight(headings[i, 0], headings[i, 1], ex, ey, rear)
        weight_j = people[j].factor_social * sight_weight(headings[j, 0], headings[j, 1], -ex, -ey, rear)
        forces[i, 0] += weight_i * fx
        forces[i, 1] += weight_i * fy
        forces[j, 0] -= weight_j * fx
        forces[j, 1] -= weight_j * fy
    for i in range(len(positions)):
        person = people[i]
        x, y, vx, vy = positions[i, 0], positions[i, 1], velocities[i, 0], velocities[i, 1]
        hx, hy, speed = headings[i, 0], headings[i, 1], headings[i, 2]
        ax, ay = 0.0, 0.0
        room, gx, gy = clearance_and_gradient(ground, x, y)
        headings[i, 3] = room - radii[i]
        if feels_forces(states[i]):
            push = person.factor_obstacle * wall_force(headings[i, 3], parameters)
            ax, ay = forces[i, 0] + push * gx, forces[i, 1] + push * gy
            if parameters.reaction == 1:
                fx, fy, ex, ey = social_force(robot[0] - x, robot[1] - y, vx - robot[2], vy - robot[3], radii[i] + robot[4], parameters)
                weight = person.factor_robot * sight_weight(hx, hy, ex, ey, rear)
                ax, ay = ax + weight * fx, ay + weight * fy
        drive = person.factor_desired / parameters.relaxation_time
        forces[i, 0] = ax + drive * (speed * hx - vx)
        forces[i, 1] = ay + drive * (speed * hy - vy)


@compiled
def _accelerate(
    positions: Floats, velocities: Floats, radii: Floats, people: NDArray[np.void], robot: Any, dt: float, parameters: Any, forces: Floats
) -> None:
    """Integrate the velocities, hold people back from a robot they see, and clip at their own greatest speeds."""
    for i in range(len(positions)):
        vx, vy = velocities[i, 0] + dt * forces[i, 0], velocities[i, 1] + dt * forces[i, 1]
        vx, vy = clipped(vx, vy, people[i].max_speed)
        if parameters.reaction == 1:
            vx, vy = hold_back(positions[i, 0], positions[i, 1], vx, vy, radii[i], robot, parameters)
            vx, vy = clipped(vx, vy, people[i].max_speed)
        velocities[i, 0], velocities[i, 1] = vx, vy


@compiled
def _walk(
    positions: Floats,
    velocities: Floats,
    radii: Floats,
    people: NDArray[np.void],
    ground: Ground,
    robot: Any,
    dt: float,
    parameters: Any,
    pairs: NDArray[np.int32],
    found: int,
    starts: Floats,
    pushes: Floats,
) -> None:
    """Move the bodies, apart from each other and out of walls; a body that was hindered has the velocity it really moved with.

    ``starts`` (P, 4) comes with the gap to the walls in its last column; it and ``pushes`` (P, 2) are overwritten.
    """
    for i in range(len(positions)):
        x, y, dx, dy = positions[i, 0], positions[i, 1], dt * velocities[i, 0], dt * velocities[i, 1]
        if starts[i, 3] > FREE_STRIDE * people[i].max_speed * dt:
            positions[i, 0], positions[i, 1] = x + dx, y + dy
        else:
            positions[i, 0], positions[i, 1] = slide(ground, x, y, dx, dy, radii[i])
        starts[i, 0], starts[i, 1] = x, y
        starts[i, 2] = 1.0 if positions[i, 0] != x + dx or positions[i, 1] != y + dy else 0.0
    touching = push_apart(positions, radii, pairs, found, pushes)
    for i in range(len(positions)):
        if touching and (pushes[i, 0] != 0.0 or pushes[i, 1] != 0.0):
            dx, dy = positions[i, 0] + pushes[i, 0] - starts[i, 0], positions[i, 1] + pushes[i, 1] - starts[i, 1]
            dx, dy = clipped(dx, dy, people[i].max_speed * dt)
            positions[i, 0], positions[i, 1] = slide(ground, starts[i, 0], starts[i, 1], dx, dy, radii[i])
            starts[i, 2] = 1.0
        if parameters.reaction == 1 and not keeps_off(
            starts[i, 0], starts[i, 1], positions[i, 0], positions[i, 1], radii[i], robot, parameters
        ):
            positions[i, 0], positions[i, 1] = starts[i, 0], starts[i, 1]
            starts[i, 2] = 1.0
        if starts[i, 2] == 1.0:
            vx, vy = (positions[i, 0] - starts[i, 0]) / dt, (positions[i, 1] - starts[i, 1]) / dt
            velocities[i, 0], velocities[i, 1] = clipped(vx, vy, people[i].max_speed)


@compiled
def clipped(x: float, y: float, longest: float) -> tuple[float, float]:
    """Return a vector, shortened to ``longest`` if it is longer."""
    squared = x * x + y * y
    if squared <= longest * longest:
        return x, y
    shrink = longest / sqrt(squared)
    return shrink * x, shrink * y
