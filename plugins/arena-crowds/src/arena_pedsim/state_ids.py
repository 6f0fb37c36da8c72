"""What the crowd's kernels ask of a state; all else about states is in ``states.yaml``."""

from __future__ import annotations

from typing import Any

from arena_kernels.compiled import compiled

NONE = 0  # an empty slot, or a person who is not there
STANDING = 1  # has no waypoint, or has arrived at its only one
WALKING = 2
GROUP_WALKING = 4
APPROACHING_ROBOT = 24  # curious: goes to the robot, and stays with it
SHYING_FROM_ROBOT = 25  # scared: goes on, slowly, and pushed far off the robot
BLOCKING_ROBOT = 26  # threatening: goes and stands in front of the robot


@compiled
def desired_speed(person: Any, state: int, parameters: Any) -> float:
    """Return how fast a person in this state wants to go along its own way, m/s."""
    speed: float = person.pace if state == SHYING_FROM_ROBOT else parameters.state_speed[state] * person.walking_speed
    return speed


@compiled
def feels_forces(state: int, parameters: Any) -> bool:
    """Return whether people and walls at a distance push a person in this state; who stands holds the place,
    and is moved by contact only.
    """
    pushed: bool = parameters.state_pushed[state] == 1.0
    return pushed


@compiled
def goes_somewhere(state: int, parameters: Any) -> bool:
    """Return whether a person in this state is on the way to a waypoint, or to another place."""
    moves: bool = parameters.state_speed[state] > 0.0
    return moves


@compiled
def walks_on(person: Any, state: int) -> bool:
    """Return whether a person follows a group that will not stop at its waypoint."""
    return state == GROUP_WALKING and person.waypoints > 1 and not person.stay > 0.0


@compiled
def turns_to_robot(state: int) -> bool:
    """Return whether a person in this state has left its own way for the robot."""
    return state in (APPROACHING_ROBOT, BLOCKING_ROBOT)


@compiled
def is_open_to_robot(state: int, parameters: Any) -> bool:
    """Return whether a person in this state may begin to react to the robot."""
    startled: bool = parameters.state_startled[state] == 1.0
    return startled
