"""What people are doing, and how that changes their desired speed and the forces on them.

Every kernel asks this module and none compares states itself, so a further state is a constant and a line in each function here.
"""

from __future__ import annotations

from typing import Any

from arena_kernels.compiled import compiled

NONE = 0  # an empty slot
STANDING = 1  # has no waypoint, or has arrived at its only one
WALKING = 2
APPROACHING_ROBOT = 24  # curious: goes to the robot, and stays with it
SHYING_FROM_ROBOT = 25  # scared: goes on, slowly, and pushed far off the robot
BLOCKING_ROBOT = 26  # threatening: goes and stands in front of the robot


@compiled
def desired_speed(person: Any, state: int) -> float:
    """Return how fast somebody in this state wants to go along the own way, m/s."""
    speed = 0.0
    if state == WALKING:
        speed = person.max_speed
    elif state == SHYING_FROM_ROBOT:
        speed = person.pace
    return speed


@compiled
def feels_forces(state: int) -> bool:
    """Tell whether people and walls at a distance push somebody in this state; who stands holds the place, and is moved by contact only."""
    return state == WALKING or state >= APPROACHING_ROBOT


@compiled
def seeks_waypoint(state: int) -> bool:
    """Tell whether somebody in this state is on the way to a waypoint."""
    return state in (WALKING, SHYING_FROM_ROBOT)


@compiled
def turns_to_robot(state: int) -> bool:
    """Tell whether somebody in this state has left the own way for the robot."""
    return state in (APPROACHING_ROBOT, BLOCKING_ROBOT)


@compiled
def is_open_to_robot(state: int) -> bool:
    """Tell whether somebody in this state may begin to react to the robot."""
    return state in (STANDING, WALKING)
