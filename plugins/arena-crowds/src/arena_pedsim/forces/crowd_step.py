"""One step of N crowds, as one compiled call."""

from __future__ import annotations

from math import ceil, isnan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.crowds import Crowds, NearPairs, RobotStack, bodies_of, robot_at, robots_of
from arena_kernels.doorways import door_ahead
from arena_kernels.ground import GroundStack, world_ground
from arena_kernels.neighbours import CELLS_FROM, near_pairs
from arena_pedsim.crowd_scene import CrowdScene, KnownWay, Step
from arena_pedsim.forces.acceleration import integrate_velocities, sum_forces
from arena_pedsim.forces.deadlock import detect_deadlocks, drop_passing_pairs
from arena_pedsim.forces.reactions import notice_robots, turn_to_robot
from arena_pedsim.forces.walking import move_bodies
from arena_pedsim.forces.yielding import detour_heading
from arena_pedsim.people import COME, NOTHING, ON_ERRAND
from arena_pedsim.routes.wayfinding import SLOWING, follow_way
from arena_pedsim.state_ids import APPROACHING_ROBOT, NONE, desired_speed, turns_to_robot, walks_on

Floats = NDArray[np.float64]


@compiled
def step_crowds(
    crowds: Crowds,
    people: NDArray[np.void],
    corners: Floats,
    land: GroundStack,
    robots: RobotStack,
    dt: float,
    parameters: NDArray[np.void],
) -> int:
    """Move everybody by ``dt`` s, in place; return how many people wish for a route, to come or to leave.

    ``people`` (N, P) and ``corners`` (N, P, C, 2) are the model's memory.
    """
    slots = crowds.positions.shape[1]
    headings, forces = np.empty((slots, 4)), np.empty((slots, 2))
    small = min(slots, CELLS_FROM)
    pairs = np.empty((small * small // 2, 2), np.int32)
    substeps = max(ceil(dt / parameters[0].longest_step - 1e-9), 1)
    wishes = 0
    for world in range(len(crowds.counts)):
        n = crowds.counts[world]
        if n == 0:
            continue
        bodies, near, ground = bodies_of(crowds, world), robots_of(robots, world), world_ground(land, world)
        for _ in range(substeps):
            pairs = _step_crowd(
                CrowdScene(bodies, people[world], ground, near),
                corners[world],
                Step(dt / substeps, parameters[0]),
                headings[:n],
                forces[:n],
                pairs,
            )
        for i in range(n):
            if bodies.states[i] == NONE:
                _await_spawn(people[world, i], dt)
            wishes += people[world, i].wish != NOTHING
    return wishes


@compiled
def _await_spawn(person: Any, dt: float) -> None:
    """Let a person who is not in the world wish to come when the time is up."""
    person.absence -= dt
    person.wish = COME if person.absence <= 0.0 else NOTHING


@compiled
def _step_crowd(
    scene: CrowdScene, corners: Floats, step: Step, headings: Floats, forces: Floats, pairs: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Move the people of one world in place; return the pair list for further use."""
    _choose_headings(scene, corners, step, headings)
    pairs, found = near_pairs(scene.bodies.positions, step.parameters.social_range, pairs)
    found = drop_passing_pairs(
        scene.bodies.positions, scene.bodies.radii, headings, scene.ground, NearPairs(pairs, found)
    )
    detect_deadlocks(scene.bodies.positions, scene.bodies.radii, scene.people, headings, NearPairs(pairs, found))
    sum_forces(scene, step.parameters, headings, NearPairs(pairs, found), forces)
    integrate_velocities(scene.bodies, scene.people, scene.robots, step.dt, step.parameters, forces)
    move_bodies(scene, step, NearPairs(pairs, found), headings, forces)
    return pairs


@compiled
def _choose_headings(scene: CrowdScene, corners: Floats, step: Step, headings: Floats) -> None:
    """Write each person's unit vector of the desired direction and the desired speed; who is nowhere gets
    state NONE and nothing else.
    """
    positions, _, radii, states = scene.bodies
    for i in range(len(positions)):
        x, y, person = positions[i, 0], positions[i, 1], scene.people[i]
        if isnan(x):
            states[i] = NONE
            continue
        state = states[i]
        if person.reaction_state != NONE:
            state = notice_robots(person, state, (x, y), scene.ground, scene.robots, step)
        if turns_to_robot(state):
            watched = robot_at(scene.robots, person.watched)
            hx, hy, to_goal, speed = turn_to_robot(person, state, (x, y, radii[i]), watched, step.parameters)
        else:
            state, hx, hy, to_goal = follow_way(
                person, state, (x, y, radii[i]), KnownWay(corners[i], scene.ground), step
            )
            if person.waiting == 1 and door_ahead(scene.ground, (x, y, radii[i]), hx, hy):
                hx, hy = 0.0, 0.0
            speed = desired_speed(person, state, step.parameters)
            if person.errand == ON_ERRAND and not walks_on(person, state):
                speed = min(speed, to_goal / (SLOWING * step.parameters.relaxation_time))
        if person.gives_way == 1 and state != APPROACHING_ROBOT:
            hx, hy = detour_heading(scene.ground, (x, y, radii[i]), hx, hy, to_goal, scene.robots, step.parameters)
        states[i] = state
        headings[i, 0], headings[i, 1], headings[i, 2] = hx, hy, speed
