"""The forces on everybody in one world, and the velocities that follow."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.crowds import Bodies, NearPairs, Robots, robot_at
from arena_kernels.ground import clearance_and_gradient
from arena_pedsim.crowd_scene import CrowdScene
from arena_pedsim.forces.forces import sight_weight, social_force, wall_force
from arena_pedsim.forces.reactions import fear_of_robot, speed_limit
from arena_pedsim.forces.yielding import brake_for_robots
from arena_pedsim.state_ids import NONE, SHYING_FROM_ROBOT, feels_forces, turns_to_robot

Floats = NDArray[np.float64]


@compiled
def sum_forces(scene: CrowdScene, parameters: Any, headings: Floats, near: NearPairs, forces: Floats) -> None:
    """Write each person's acceleration: towards the desired velocity, away from people, walls and (if seen) robots.

    ``headings`` (P, 4) gets the gap between body and walls in its last column.
    """
    positions, velocities, radii, states = scene.bodies
    for i in range(len(forces)):
        forces[i, 0], forces[i, 1] = 0.0, 0.0
    rear = parameters.social_rear_weight
    for pair in range(near.found):
        i, j = near.pairs[pair, 0], near.pairs[pair, 1]
        if scene.people[i].party == scene.people[j].party:
            continue
        dx, dy = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
        dvx, dvy = velocities[i, 0] - velocities[j, 0], velocities[i, 1] - velocities[j, 1]
        fx, fy, ex, ey = social_force(dx, dy, dvx, dvy, radii[i] + radii[j], parameters)
        weight_i = scene.people[i].factor_social * sight_weight(headings[i, 0], headings[i, 1], ex, ey, rear)
        weight_j = scene.people[j].factor_social * sight_weight(headings[j, 0], headings[j, 1], -ex, -ey, rear)
        forces[i, 0] += weight_i * fx
        forces[i, 1] += weight_i * fy
        forces[j, 0] -= weight_j * fx
        forces[j, 1] -= weight_j * fy
    for i in range(len(positions)):
        if states[i] == NONE:
            continue
        person = scene.people[i]
        x, y, vx, vy = positions[i, 0], positions[i, 1], velocities[i, 0], velocities[i, 1]
        hx, hy, speed = headings[i, 0], headings[i, 1], headings[i, 2]
        ax, ay = 0.0, 0.0
        room, gx, gy = clearance_and_gradient(scene.ground, x, y)
        headings[i, 3] = room - radii[i]
        if feels_forces(states[i], parameters):
            push = person.factor_obstacle * wall_force(headings[i, 3], parameters)
            ax, ay = forces[i, 0] + push * gx, forces[i, 1] + push * gy
            if person.gives_way == 1 and not turns_to_robot(states[i]):
                for place in range(len(scene.robots.radii)):
                    robot = robot_at(scene.robots, place)
                    fx, fy, ex, ey = social_force(
                        robot.x - x, robot.y - y, vx - robot.vx, vy - robot.vy, radii[i] + robot.radius, parameters
                    )
                    weight = person.factor_robot * sight_weight(hx, hy, ex, ey, rear)
                    ax, ay = ax + weight * fx, ay + weight * fy
            if states[i] == SHYING_FROM_ROBOT:
                fx, fy = fear_of_robot(person, x, y, radii[i], robot_at(scene.robots, person.watched))
                ax, ay = ax + fx, ay + fy
            if person.pushing == 1:
                ax, ay = ax + person.push_x, ay + person.push_y
        drive = person.factor_desired / parameters.relaxation_time
        forces[i, 0] = ax + drive * (speed * hx - vx)
        forces[i, 1] = ay + drive * (speed * hy - vy)


@compiled
def integrate_velocities(
    bodies: Bodies, people: NDArray[np.void], robots: Robots, dt: float, parameters: Any, forces: Floats
) -> None:
    """Integrate the velocities, hold people back from robots they see, and clip at their own greatest speeds."""
    positions, velocities, radii, states = bodies
    for i in range(len(positions)):
        if states[i] == NONE:
            continue
        limit = people[i].max_speed
        if states[i] == SHYING_FROM_ROBOT:
            limit = speed_limit(people[i], velocities[i, 0], velocities[i, 1], dt, parameters)
        vx, vy = velocities[i, 0] + dt * forces[i, 0], velocities[i, 1] + dt * forces[i, 1]
        vx, vy = clip_length(vx, vy, limit)
        if people[i].gives_way == 1:
            vx, vy = brake_for_robots(
                (positions[i, 0], positions[i, 1], radii[i]), (vx, vy), states[i], robots, parameters
            )
            vx, vy = clip_length(vx, vy, people[i].max_speed)
        velocities[i, 0], velocities[i, 1] = vx, vy


@compiled
def clip_length(x: float, y: float, longest: float) -> tuple[float, float]:
    """Return a vector, shortened to ``longest`` if it is longer."""
    squared = x * x + y * y
    if squared <= longest * longest:
        return x, y
    shrink = longest / sqrt(squared)
    return shrink * x, shrink * y
