"""How a robot moves when it holds a command, and how near it then comes to what stands and to who walks."""

from __future__ import annotations

import math

from arena_cadrl.parameters import Floats, Limits
from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import CostmapWindow, Outline, outline_clearance

LAPSE = 0.05  # s between two poses that are looked at
MOST_LOOKS = 200
FAR = 0.3  # m beyond which a gap to a person need not be exact
PlanarPose = tuple[float, float, float]  # x, y (m, map), heading (rad)
Velocity = tuple[float, float, float]  # vx, vy (m/s), wz (rad/s) in base_link


@borrowing
def step_towards(value: float, wanted: float, most: float) -> float:
    """Return ``value`` moved towards ``wanted`` by at most ``most``."""
    return value + min(max(wanted - value, -most), most)


@borrowing
def next_velocity(limits: Limits, velocity: Velocity, command: Velocity) -> Velocity:
    """Return the velocity ``LAPSE`` s on, led to ``command`` within the accelerations."""
    return (
        step_towards(velocity[0], command[0], limits.ax_max * LAPSE),
        step_towards(velocity[1], command[1], limits.ay_max * LAPSE),
        step_towards(velocity[2], command[2], limits.alpha_max * LAPSE),
    )


@borrowing
def next_pose(stand: PlanarPose, velocity: Velocity) -> PlanarPose:
    """Return where a robot with this velocity is ``LAPSE`` s on."""
    middle = stand[2] + 0.5 * velocity[2] * LAPSE
    cosine, sine = math.cos(middle), math.sin(middle)
    return (
        stand[0] + (cosine * velocity[0] - sine * velocity[1]) * LAPSE,
        stand[1] + (sine * velocity[0] + cosine * velocity[1]) * LAPSE,
        stand[2] + velocity[2] * LAPSE,
    )


@borrowing
def wall_gap(window: CostmapWindow, outline: Outline, stand: PlanarPose, enough: float) -> float:
    """Return how far the footprint is from what stands, m; beyond ``enough`` a lower bound will do."""
    return outline_clearance(window, outline, (stand[0], stand[1], math.cos(stand[2]), math.sin(stand[2])), enough)


@borrowing
def can_stop(
    window: CostmapWindow,
    outline: Outline,
    limits: Limits,
    stand: PlanarPose,
    velocity: Velocity,
    command: Velocity,
    hold: float,
    gap: float,
) -> bool:
    """Return whether the footprint keeps ``gap`` m when ``command`` is held ``hold`` s and every axis then braked."""
    held = round(hold / LAPSE)
    for look in range(MOST_LOOKS):
        velocity = next_velocity(limits, velocity, command if look < held else (0.0, 0.0, 0.0))
        if look >= held and velocity[0] == 0.0 and velocity[1] == 0.0 and velocity[2] == 0.0:
            break
        stand = next_pose(stand, velocity)
        if wall_gap(window, outline, stand, gap) < gap:
            return False
    return True


@borrowing
def gap_to_disc(outline: Outline, stand: PlanarPose, x: float, y: float, radius: float) -> float:
    """Return how far the footprint is from a disc at (x, y), m, negative where they overlap;
    beyond ``FAR`` a lower bound will do.
    """
    dx, dy = x - stand[0], y - stand[1]
    apart = math.sqrt(dx * dx + dy * dy) - radius
    if len(outline.points_xy) == 0 or apart - outline.radius > FAR:
        return apart - outline.radius
    cosine, sine = math.cos(stand[2]), math.sin(stand[2])
    px, py = cosine * dx + sine * dy, cosine * dy - sine * dx
    nearest = math.inf
    for i in range(len(outline.points_xy)):
        off_x, off_y = outline.points_xy[i, 0] - px, outline.points_xy[i, 1] - py
        nearest = min(nearest, off_x * off_x + off_y * off_y)
    return min(apart - outline.inscribed_radius, math.sqrt(nearest) - radius)


@borrowing
def gap_to_people(outline: Outline, stand: PlanarPose, people: Floats, later: float) -> float:
    """Return the least gap to ``people`` (K, 5: x, y, vx, vy, radius), who walk on
    for ``later`` s; infinite without any.
    """
    least = math.inf
    for k in range(len(people)):
        x, y = people[k, 0] + later * people[k, 2], people[k, 1] + later * people[k, 3]
        least = min(least, gap_to_disc(outline, stand, x, y, people[k, 4]))
    return least
