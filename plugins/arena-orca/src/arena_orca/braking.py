"""The last word: the exact footprint, for one period of a command and while the robot is braked
to rest, among walls and people.
"""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import CostmapWindow, Outline, keeps_from_walls
from arena_kernels.half_planes import FloatArray
from arena_orca.columns import RADIUS, VX, VY, X, Y
from arena_orca.motion import step_towards
from arena_orca.parameters import Limits

LAPSE = 0.02  # s between two poses that are looked at: a cell at most, for robots below 2.5 m/s
MOST_LOOKS = 500
PlanarPose = tuple[float, float, float, float]  # x, y (m, map), cosine and sine of the heading


@borrowing
def next_twist(
    limits: Limits, twist: tuple[float, float, float], command: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return the twist ``LAPSE`` s on, led to ``command`` within the accelerations;
    a car that brakes keeps its bend.
    """
    vx = step_towards(twist[0], command[0], limits.ax_max * LAPSE)
    if limits.turn_radius > 0.0 and command[0] == 0.0:
        return vx, 0.0, twist[2] * vx / twist[0] if twist[0] != 0.0 else 0.0
    return (
        vx,
        step_towards(twist[1], command[1], limits.ay_max * LAPSE),
        step_towards(twist[2], command[2], limits.alpha_max * LAPSE),
    )


@borrowing
def next_pose(stand: PlanarPose, twist: tuple[float, float, float]) -> PlanarPose:
    """Return where a robot with ``twist`` is ``LAPSE`` s on."""
    x, y, cosine, sine = stand
    vx, vy, wz = twist
    half_c, half_s = math.cos(0.5 * wz * LAPSE), math.sin(0.5 * wz * LAPSE)
    cosine, sine = cosine * half_c - sine * half_s, sine * half_c + cosine * half_s
    x, y = x + (cosine * vx - sine * vy) * LAPSE, y + (sine * vx + cosine * vy) * LAPSE
    return x, y, cosine * half_c - sine * half_s, sine * half_c + cosine * half_s


@borrowing
def pose_after(
    limits: Limits,
    stand: PlanarPose,
    twist: tuple[float, float, float],
    command: tuple[float, float, float],
    time: float,
) -> PlanarPose:
    """Return where a robot with ``twist`` is when ``command`` was held for ``time`` s."""
    for _ in range(round(time / LAPSE)):
        twist = next_twist(limits, twist, command)
        stand = next_pose(stand, twist)
    return stand


@borrowing
def can_stop(
    window: CostmapWindow,
    outline: Outline,
    limits: Limits,
    stand: PlanarPose,
    twist: tuple[float, float, float],
    command: tuple[float, float, float],
    time: float,
    gap: float,
) -> bool:
    """Return whether the footprint keeps ``gap`` m when ``command`` is held for ``time`` s and then every axis braked,
    from ``twist`` now.

    Where it is nearer to a wall already, it may stay so near.
    """
    held, now = round(time / LAPSE), stand
    for look in range(MOST_LOOKS):
        twist = next_twist(limits, twist, command if look < held else (0.0, 0.0, 0.0))
        if look >= held and twist[0] == 0.0 and twist[1] == 0.0 and twist[2] == 0.0:
            break
        stand = next_pose(stand, twist)
        if not keeps_from_walls(window, outline, now, stand, gap, 0.0):
            return False
    return True


@borrowing
def gap_to_person(outline: Outline, stand: PlanarPose, x: float, y: float, radius: float, enough: float) -> float:
    """Return how far a footprint is from a disc, m, negative where they overlap; beyond
    ``enough`` a lower bound will do.
    """
    dx, dy = x - stand[0], y - stand[1]
    apart = math.hypot(dx, dy) - radius
    if len(outline.points_xy) == 0 or apart - outline.radius > enough:
        return apart - outline.radius
    px, py = stand[2] * dx + stand[3] * dy, stand[2] * dy - stand[3] * dx
    least = apart - outline.inscribed_radius
    for i in range(len(outline.points_xy)):
        least = min(least, math.hypot(outline.points_xy[i, X] - px, outline.points_xy[i, Y] - py) - radius)
    return least


@borrowing
def stopping_time(limits: Limits, twist: tuple[float, float, float]) -> float:
    """Return how long a robot brakes from ``twist``, s."""
    time = max(abs(twist[0]) / limits.ax_max, abs(twist[2]) / limits.alpha_max)
    return max(time, abs(twist[1]) / limits.ay_max) if limits.ay_max > 0.0 else time


@borrowing
def least_gap(
    people: FloatArray,
    outline: Outline,
    limits: Limits,
    stand: PlanarPose,
    twist: tuple[float, float, float],
    command: tuple[float, float, float],
    times: tuple[float, float],
    enough: float,
) -> float:
    """Return the least gap to ``people`` (x, y, vx, vy, radius), who walk on, in ``times[1]`` s.

    ``command`` is held for ``times[0]`` s, then braked.
    """
    held, least = round(times[0] / LAPSE), enough
    for look in range(min(MOST_LOOKS, math.ceil(times[1] / LAPSE))):
        twist = next_twist(limits, twist, command if look < held else (0.0, 0.0, 0.0))
        stand, later = next_pose(stand, twist), (look + 1) * LAPSE
        for k in range(len(people)):
            x, y = people[k, X] + later * people[k, VX], people[k, Y] + later * people[k, VY]
            least = min(least, gap_to_person(outline, stand, x, y, people[k, RADIUS], least))
    return least
