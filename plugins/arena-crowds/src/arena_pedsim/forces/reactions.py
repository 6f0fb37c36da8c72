"""How people react to a robot once they see it: curious, scared or threatening.

Of several robots they watch one: the nearest in sight when the reaction begins, until it is out of sight.

After HuNavSim (Perez-Higueras, Otero, Caballero, Merino, HuNavSim: a ROS 2 human navigation simulator for benchmarking
human-aware robot navigation, IEEE Robotics and Automation Letters 8, 2023), whose people look ahead only, but through
walls.
"""

from __future__ import annotations

from math import cos, inf, sin, sqrt
from typing import Any

import numpy as np

from arena_core import ConfigurationError, PedestrianSpec
from arena_kernels.compiled import compiled
from arena_kernels.crowds import Robot, Robots, robot_at
from arena_kernels.ground import Ground
from arena_kernels.slide_along import is_visible
from arena_pedsim.crowd_scene import Step
from arena_pedsim.parameters import Reactions
from arena_pedsim.people import NEW_ROUTE
from arena_pedsim.state_ids import (
    APPROACHING_ROBOT,
    BLOCKING_ROBOT,
    NONE,
    SHYING_FROM_ROBOT,
    WALKING,
    is_open_to_robot,
)

STATES = {
    "ignore": NONE,
    "yield": NONE,
    "curious": APPROACHING_ROBOT,
    "scared": SHYING_FROM_ROBOT,
    "threatening": BLOCKING_ROBOT,
}
EYE = 0.01  # m, the room that a line of sight needs on both sides
NEARER = 0.1  # m, by which the curious aim nearer than where they stop, so that they get there
LEAST_GAP = 0.1  # m, from which on fear grows no further
BRAKING = 2.0  # relaxation times in which the way that is left is walked: hardly anybody overshoots


def reaction_of(spec: PedestrianSpec, default: str) -> str:
    """Return how a person reacts to robots; raise ConfigurationError if the behaviour names no such reaction."""
    name = spec.behaviour.get("reaction", default)
    if name not in STATES:
        raise ConfigurationError(f"person {spec.id}: reaction is {name!r}; allowed: {', '.join(STATES)}")
    return str(name)


def take_reaction(person: np.void, name: str, reactions: Reactions, share: float) -> None:
    """Write a reaction into a person's memory; ``share`` scales the force."""
    person["gives_way"] = name != "ignore"
    person["reaction_state"] = STATES[name]
    if STATES[name] == NONE:
        return
    rule = getattr(reactions, name)
    person["sight"], person["stop_distance"], person["pace"] = (
        rule.sight,
        rule.distance,
        rule.pace * person["walking_speed"],
    )
    person["fear"] = share * rule.force
    person["interest"] = person["interest_left"] = inf if rule.duration is None else rule.duration
    person["pause"] = rule.pause


@compiled
def notice_robots(
    person: Any, state: int, place: tuple[float, float], ground: Ground, robots: Robots, step: Step
) -> int:
    """Return the state of someone who looks out for robots, as often as at the way ahead.

    A reaction begins in sight of a robot. It ends when the robot that is watched is out of sight, to go on another
    time, or when its time is over.
    """
    x, y = place
    person.glance_clock += step.dt
    if person.glance_clock >= step.parameters.wayfinding_look_period:
        person.glance_clock = 0.0
        _watch_robots(person, state, (x, y), ground, robots)
    if state != person.reaction_state:
        person.pause_left -= step.dt
        begins = person.sees_robot == 1 and person.pause_left <= 0.0 and is_open_to_robot(state, step.parameters)
        return person.reaction_state if begins else state
    person.interest_left -= step.dt
    if person.interest_left <= 0.0:
        person.interest_left, person.pause_left = person.interest, person.pause
    elif person.sees_robot == 1:
        return state
    if state != SHYING_FROM_ROBOT:
        person.wish = NEW_ROUTE
    person.anchor_x, person.anchor_y, person.stuck_clock = x, y, 0.0
    return WALKING


@compiled
def _watch_robots(person: Any, state: int, place: tuple[float, float], ground: Ground, robots: Robots) -> None:
    """Choose whom to watch: the nearest robot in sight, or who reacts the same one while that is in sight.

    Who sees none goes on knowing the last one.
    """
    x, y = place
    keeps = state == person.reaction_state
    person.sees_robot = 1 if keeps and _sees_robot(x, y, person.sight, ground, robot_at(robots, person.watched)) else 0
    if person.sees_robot == 1:
        return
    least = inf
    for one in range(len(robots.radii)):
        robot = robot_at(robots, one)
        squared = (robot.x - x) ** 2 + (robot.y - y) ** 2
        if squared < least and _sees_robot(x, y, person.sight, ground, robot):
            person.sees_robot, person.watched, least = 1, one, squared


@compiled
def _sees_robot(x: float, y: float, sight: float, ground: Ground, robot: Robot) -> bool:
    if (robot.x - x) ** 2 + (robot.y - y) ** 2 > sight * sight:
        return False
    return is_visible(ground, (x, y, robot.x, robot.y), EYE)


@compiled
def turn_to_robot(
    person: Any, state: int, disc: tuple[float, float, float], robot: Robot, parameters: Any
) -> tuple[float, float, float, float]:
    """Return unit vector to, distance from and speed towards where the curious or threatening want to be.

    The curious stop at their distance to the robot. The threatening stand ahead of it at theirs, or nearer when it has
    come nearer: they step aside with it, but never back.
    """
    x, y, radius = disc
    target_x, target_y, keep = robot.x, robot.y, person.stop_distance - NEARER
    if state == BLOCKING_ROBOT:
        c, s = cos(robot.theta), sin(robot.theta)
        ahead = (x - robot.x) * c + (y - robot.y) * s
        touch = radius + robot.radius + parameters.giving_way_margin
        reach = min(max(ahead, touch), person.stop_distance) if ahead > 0.0 else person.stop_distance
        target_x, target_y, keep = robot.x + reach * c, robot.y + reach * s, 0.0
    dx, dy = target_x - x, target_y - y
    distance = sqrt(dx * dx + dy * dy)
    if distance == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    way = distance - keep
    arrived = state == APPROACHING_ROBOT and distance <= person.stop_distance
    speed = 0.0 if arrived else min(person.pace, way / (BRAKING * parameters.relaxation_time))
    return dx / distance, dy / distance, way, speed


@compiled
def fear_of_robot(person: Any, x: float, y: float, radius: float, robot: Robot) -> tuple[float, float]:
    """Return the extra acceleration away from the robot of a person who is scared."""
    dx, dy = x - robot.x, y - robot.y
    separation = sqrt(dx * dx + dy * dy)
    if separation == 0.0:
        return 0.0, 0.0
    size = person.fear / max(separation - radius, LEAST_GAP)
    return size * dx / separation, size * dy / separation


@compiled
def speed_limit(person: Any, vx: float, vy: float, dt: float, parameters: Any) -> float:
    """Return how fast a person who is scared may go: down to the person's own pace within about a relaxation time."""
    slower = sqrt(vx * vx + vy * vy) * (1.0 - dt / parameters.relaxation_time)
    return min(max(person.pace, slower), person.max_speed)  # type: ignore[no-any-return]
