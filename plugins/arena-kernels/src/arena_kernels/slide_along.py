"""Bodies against walls: no one passes through one, or is pressed into one."""

from __future__ import annotations

from math import sqrt

from arena_kernels.compiled import borrowing
from arena_kernels.ground import Ground, clearance_and_gradient, wall_clearance

STRIDE = 0.5  # longest single move, in radii: a centre cannot cross a wall that the body does not fit through
SIGHT = 0.9  # share of the radius that must be free on both sides of a straight way for it to be chosen
ROUNDING = 1e-9  # m, more than what is rounded off a distance
LOSING_SIGHT = 0.5  # and for it to be kept: a body slides round an edge that its centre passes by


@borrowing
def slide_along(ground: Ground, disc: tuple[float, float, float], dx: float, dy: float) -> tuple[float, float]:
    """Return where a body at (x, y) gets to when it moves by (dx, dy) and slides along what is in its way.

    The distance to the walls never falls below ``radius``, or below what it was where that is less.
    """
    x, y, radius = disc
    length = sqrt(dx * dx + dy * dy)
    moves = int(length / (STRIDE * radius)) + 1
    for _ in range(moves):
        x, y = _move_body(ground, (x, y, radius), dx / moves, dy / moves)
    return x, y


@borrowing
def _move_body(ground: Ground, disc: tuple[float, float, float], dx: float, dy: float) -> tuple[float, float]:
    x, y, radius = disc
    new_x, new_y = x + dx, y + dy
    distance, gx, gy = clearance_and_gradient(ground, new_x, new_y)
    if distance >= radius:
        return new_x, new_y
    for _ in range(3):  # the interpolated field is not quite a distance: a second push mends the first
        steepness = gx * gx + gy * gy
        if steepness < 1e-6:
            break
        push = (radius - distance) / max(steepness, 0.25)
        new_x, new_y = new_x + push * gx, new_y + push * gy
        distance, gx, gy = clearance_and_gradient(ground, new_x, new_y)
        if distance >= radius:
            return new_x, new_y
    before, _, _ = clearance_and_gradient(ground, x, y)
    return (new_x, new_y) if distance >= min(before, radius) - ROUNDING else (x, y)


@borrowing
def is_visible(ground: Ground, line: tuple[float, float, float, float], room: float) -> bool:
    """Return whether a straight way has this room (m) on both sides, or as much as there is at its ends where that is
    less.

    Sphere tracing: Hart, Sphere tracing, The Visual Computer 12, 1996.
    """
    x, y, to_x, to_y = line
    dx, dy = to_x - x, to_y - y
    length = sqrt(dx * dx + dy * dy)
    needed = min(room, SIGHT * wall_clearance(ground, x, y), SIGHT * wall_clearance(ground, to_x, to_y))
    if not needed > 0.0:
        return False
    least = 0.5 * ground.cell
    way = 0.0
    while way < length:
        spare = wall_clearance(ground, x + dx * way / length, y + dy * way / length) - needed
        if spare < 0.0:
            return False
        way += max(spare, least)
    return True
