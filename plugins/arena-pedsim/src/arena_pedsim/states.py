"""What people are doing, and how that changes their desired speed and the forces on them.

Every kernel asks this module and none compares states itself, so a further state is a constant and a line in each function here.
"""

from __future__ import annotations

from arena_kernels.compiled import compiled

NONE = 0  # an empty slot
STANDING = 1  # has no waypoint, or has arrived at its only one
WALKING = 2


@compiled
def desired_speed(state: int, max_speed: float) -> float:
    """Return how fast somebody in this state wants to go, m/s."""
    return max_speed if state == WALKING else 0.0


@compiled
def feels_forces(state: int) -> bool:
    """Tell whether people and walls at a distance push somebody in this state; who stands holds the place, and is moved by contact only."""
    return state == WALKING


@compiled
def seeks_waypoint(state: int) -> bool:
    """Tell whether somebody in this state is on the way to a waypoint."""
    return state == WALKING
