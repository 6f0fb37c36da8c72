"""One step ahead: what each action leads to, as numbers for a value network, and what it is worth until then."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_cadrl.motion import (
    LAPSE,
    PlanarPose,
    Velocity,
    can_stop,
    gap_to_disc,
    gap_to_people,
    next_pose,
    next_velocity,
    wall_gap,
)
from arena_cadrl.parameters import (
    GAP,
    GOAL_WAY,
    OWN,
    PERSON,
    PERSON_SPEED,
    PERSON_WAY,
    ROOM,
    ROOM_POINTS,
    TARGET_WAY,
    Floats,
    Rules,
)
from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import CostmapWindow, Outline, allowed_gap, distance_at

Numbers = NDArray[np.float32]
Flags = NDArray[np.bool_]


@borrowing
def evaluate_actions(
    window: CostmapWindow,
    outline: Outline,
    target: tuple[float, float, float],
    state: Floats,
    people: Floats,
    commands: Floats,
    rules: Rules,
    rows: Numbers,
    gains: Floats,
    weights: Floats,
    allowed: Flags,
) -> None:
    """Fill what is seen now and one step ahead, for a robot in ``state`` (x, y, theta, vx, vy, wz).

    ``window`` holds what stands; ``target`` is what ``target_on`` found; ``people`` are rows (x, y, vx, vy, radius),
    nearest first; ``commands`` (A, 3). ``rows`` (1 + A, D): the state now, then after each action, followed for the
    horizon. The value of action a is ``gains[a] + weights[a]`` times the network's of its row. ``allowed`` (A,) says
    which the safety layer lets pass.
    """
    stand, velocity = (state[0], state[1], state[2]), (state[3], state[4], state[5])
    write_joint_state(window, outline, people, rules, target, stand, velocity, 0.0, rows[0])
    gap = allowed_gap(wall_gap(window, outline, stand, rules.padding), rules.padding, 0.0)
    for a in range(len(commands)):
        command = (commands[a, 0], commands[a, 1], commands[a, 2])
        allowed[a] = can_stop(window, outline, rules.limits, stand, velocity, command, rules.hold, gap)
        gains[a], weights[a] = follow_command(
            window, outline, people, rules, target, stand, velocity, command, gap, rows[1 + a]
        )


@borrowing
def follow_command(
    window: CostmapWindow,
    outline: Outline,
    people: Floats,
    rules: Rules,
    target: tuple[float, float, float],
    stand: PlanarPose,
    velocity: Velocity,
    command: Velocity,
    gap: float,
    row: Numbers,
) -> tuple[float, float]:
    """Follow a command for the horizon; write the state at its end, and return its gain and the weight of the value
    there.

    A foreseen gap to a person below the margin is a contact, for tracks err. A robot that comes nearer than ``gap`` to
    a wall stands from there on: the safety layer will brake it.
    """
    gain, weight, done = 0.0, 1.0, False
    factor, pace = rules.discount**LAPSE, rules.limits.vx_max * LAPSE
    way = distance_to_goal(target, stand)
    gap_now = gap_to_people(outline, stand, people, 0.0)
    contact = min(rules.margin, max(0.5 * gap_now, 0.0))  # who stands nearer already may leave
    deepest = math.inf
    for look in range(round(rules.horizon / LAPSE)):
        velocity = next_velocity(rules.limits, velocity, command)
        ahead = next_pose(stand, velocity)
        if wall_gap(window, outline, ahead, gap) < gap:
            velocity = (0.0, 0.0, 0.0)
        else:
            stand = ahead
        least = gap_to_people(outline, stand, people, (look + 1) * LAPSE)
        deepest = min(deepest, least)
        if done:
            continue
        left = distance_to_goal(target, stand)
        missing = max(0.0, 1.0 - least / rules.comfort)
        gain += weight * (1.0 - factor) * ((way - left) / pace - rules.discomfort * missing)
        weight *= factor
        way = left
        if least < contact:
            gain -= weight * rules.collision
            done = True
        elif left <= rules.goal_radius:
            gain += weight
            done = True
    if deepest < contact:  # who cannot avoid a contact makes it a light one
        gain += rules.collision * max(-1.0, min(deepest, 0.0))
    if done:
        weight = 0.0
    write_joint_state(window, outline, people, rules, target, stand, velocity, rules.horizon, row)
    return gain, weight


@borrowing
def distance_to_goal(target: tuple[float, float, float], stand: PlanarPose) -> float:
    """Return the way to the goal by way of the target, m."""
    return math.hypot(target[0] - stand[0], target[1] - stand[1]) + target[2]


@borrowing
def write_joint_state(
    window: CostmapWindow,
    outline: Outline,
    people: Floats,
    rules: Rules,
    target: tuple[float, float, float],
    stand: PlanarPose,
    velocity: Velocity,
    later: float,
    row: Numbers,
) -> None:
    """Write the joint state, in the frame of the robot whose x axis points to the target (Chen
    et al. 2017, eq. 13 and 14).
    """
    limits = rules.limits
    dx, dy = target[0] - stand[0], target[1] - stand[1]
    distance = math.hypot(dx, dy)
    along = math.atan2(dy, dx) if distance > 1e-6 else stand[2]
    c, s = math.cos(along), math.sin(along)
    turned = stand[2] - along
    ct, st = math.cos(turned), math.sin(turned)
    row[0] = min((distance + target[2]) / GOAL_WAY, 2.0)
    row[1] = min(distance / TARGET_WAY, 2.0)
    row[2] = (ct * velocity[0] - st * velocity[1]) / limits.vx_max
    row[3] = (st * velocity[0] + ct * velocity[1]) / limits.vx_max
    row[4] = velocity[2] / limits.wz_max
    row[5], row[6] = ct, st
    row[7] = clearance_at(window, stand[0], stand[1], outline)
    for k in range(ROOM_POINTS):
        angle = along + 2.0 * math.pi * k / ROOM_POINTS
        x, y = stand[0] + rules.room_radius * math.cos(angle), stand[1] + rules.room_radius * math.sin(angle)
        row[8 + k] = clearance_at(window, x, y, outline)
    for k in range((len(row) - OWN) // PERSON):
        first = OWN + k * PERSON
        if k >= len(people):
            row[first : first + PERSON] = 0.0
            continue
        px, py = people[k, 0] + later * people[k, 2] - stand[0], people[k, 1] + later * people[k, 3] - stand[1]
        gap = gap_to_disc(
            outline, stand, people[k, 0] + later * people[k, 2], people[k, 1] + later * people[k, 3], people[k, 4]
        )
        row[first] = clip_feature((c * px + s * py) / PERSON_WAY)
        row[first + 1] = clip_feature((c * py - s * px) / PERSON_WAY)
        row[first + 2] = clip_feature((c * people[k, 2] + s * people[k, 3]) / PERSON_SPEED)
        row[first + 3] = clip_feature((c * people[k, 3] - s * people[k, 2]) / PERSON_SPEED)
        row[first + 4] = people[k, 4]
        row[first + 5] = clip_feature(gap / GAP)
        row[first + 6] = 1.0


@borrowing
def clip_feature(value: float) -> float:
    """Return a number cut to -2 .. 2."""
    return min(max(value, -2.0), 2.0)


@borrowing
def clearance_at(window: CostmapWindow, x: float, y: float, outline: Outline) -> float:
    """Return how much room there is at a position, 0 .. 1: m to the nearest wall beyond the circle inside the
    footprint, over ``ROOM``.
    """
    return min(max(distance_at(window, x, y) - outline.inscribed_radius, 0.0), ROOM) / ROOM
