"""Ways of a car: the curves of Dubins (1957) that turn, drive straight and turn again, after a way back; or forwards,
then back.

L. E. Dubins: On curves of minimal length with a constraint on average curvature, American Journal of Mathematics 79(3),
1957.
"""

from __future__ import annotations

import math

import numpy as np

from arena_dwa.columns import COSINE, CURVATURE, END_GAP, LENGTH, SINE, THETA, X, Y
from arena_dwa.settings import Body, BodyOnWindow, FloatArray
from arena_dwa.trajectory import PlanarPose, compose_poses
from arena_kernels.compiled import borrowing, compiled
from arena_kernels.costmap_window import CLOSE, CostmapWindow, keeps_from_walls, outline_clearance

SPACING = 0.05  # m between two poses of a curve that are looked at: a usual cell
LEAVING = 0.3  # m of way on which a robot that begins too near to something may get away from it
BACK_COSTS = 2.0  # times what forwards costs: the scanner may see nothing behind
TIGHT_COSTS = 5.0  # m of way that a metre of gap is worth at the end
LONGEST = 6.0  # m, at such costs: two circles
WHOLE = 2.0 * math.pi - 1e-6  # rad; a turn so long is none, but for rounding


@borrowing
def wrap_turn(angle: float) -> float:
    """Return an angle from 0 to 2 pi, rad."""
    angle %= 2.0 * math.pi
    return angle if angle < WHOLE else 0.0


@borrowing
def dubins_lengths(x: float, y: float, theta: float, first: float, last: float) -> tuple[float, float, float]:
    """Return turn (rad), straight way and turn (rad) from the origin to a pose, all lengths in turning radii; infinite:
    there is none.

    ``first`` and ``last`` are 1 for a turn to the left, -1 for one to the right.
    """
    east, north = x - last * math.sin(theta), y + last * math.cos(theta) - first
    apart, heading = math.hypot(east, north), math.atan2(north, east)
    straight = apart
    if first != last:
        if apart < 2.0:
            return math.inf, math.inf, math.inf
        straight = math.sqrt(apart * apart - 4.0)
        heading += first * math.asin(2.0 / apart)
    return wrap_turn(first * heading), straight, wrap_turn(last * (theta - heading))


@borrowing
def pose_along_arc(length: float, curvature: float) -> PlanarPose:
    """Return the pose at the end of an arc, seen from where it begins; backwards where its ``length`` is negative."""
    angle = length * curvature
    c, s = math.cos(angle), math.sin(angle)
    return (length, 0.0, c, s) if abs(angle) < 1e-6 else (s / curvature, (1.0 - c) / curvature, c, s)


@borrowing
def is_pose_free(window: CostmapWindow, body: Body, start: PlanarPose, way: float, stand: PlanarPose) -> bool:
    """Return whether a robot keeps its padding ``way`` m from ``start``; near it, where it may
    have less, what it keeps there.
    """
    if way < LEAVING:
        return keeps_from_walls(window, body.outline, start, stand, body.padding, CLOSE)
    return outline_clearance(window, body.outline, stand, body.padding) >= body.padding


@borrowing
def is_curve_free(ground: BodyOnWindow, start: PlanarPose, way: float, stand: PlanarPose, pieces: FloatArray) -> bool:
    """Return whether arcs (K, 2) of lengths and curvatures, one after the other, are free from ``stand``,
    ``way`` m from ``start``.
    """
    for piece in range(len(pieces)):
        length, curvature = pieces[piece, LENGTH], pieces[piece, CURVATURE]
        parts = math.ceil(abs(length) / SPACING)
        if parts == 0:
            continue
        step = pose_along_arc(length / parts, curvature)
        for _ in range(parts):
            stand, way = compose_poses(stand, step), way + abs(length) / parts
            if not is_pose_free(ground.window, ground.body, start, way, stand):
                return False
    return True


@compiled
def shortest_dubins_path(
    ground: BodyOnWindow,
    start: PlanarPose,
    ends: FloatArray,
    gear: float,
    radius: float,
    first: float,
    bends: FloatArray,
) -> FloatArray:
    """Return length (m, negative: backwards) and curvature (1/m) of the pieces of the shortest free way to one of
    ``ends``, (4, 2).

    It ends with a curve of Dubins in ``gear``: 1, or -1 backwards. Before that it may lead the other way for at most
    ``first`` m, along one of ``bends`` (1/m). ``ends`` (K, 4) are x, y (m), heading (rad) and gap (m). Where there is
    no way, its lengths are 0.
    """
    best, least, pieces = np.zeros((4, 2)), LONGEST, np.zeros((4, 2))
    costs, first_costs = (1.0, BACK_COSTS) if gear > 0.0 else (BACK_COSTS, 1.0)
    for i in range(len(bends)):
        stand, step = start, pose_along_arc(-gear * SPACING, bends[i])
        for k in range(int(first / SPACING) + 1):
            way = k * SPACING
            if k > 0:
                stand = compose_poses(stand, step)
                if not is_pose_free(ground.window, ground.body, start, way, stand):
                    break
            elif i > 0:
                continue
            pieces[0, LENGTH], pieces[0, CURVATURE] = -gear * way, bends[i]
            for end in ends:
                for word in range(4):
                    length = fill_dubins_curve(
                        stand, end, gear, radius, 1.0 - 2.0 * (word % 2), 1.0 - 2.0 * (word // 2), pieces[1:]
                    )
                    cost = first_costs * way + costs * length - TIGHT_COSTS * end[END_GAP]
                    if cost < least and is_curve_free(ground, start, way, stand, pieces[1:]):
                        best[:], least = pieces, cost
    return best


@borrowing
def fill_dubins_curve(
    stand: PlanarPose, end: FloatArray, gear: float, radius: float, first: float, last: float, pieces: FloatArray
) -> float:
    """Fill ``pieces`` (3, 2) with the curve of Dubins that leads in ``gear`` from ``stand`` to
    ``end``, and return its length, m.
    """
    # backwards: as a car that looks the other way
    dx, dy = gear * (end[X] - stand[X]) / radius, gear * (end[Y] - stand[Y]) / radius
    x, y = stand[COSINE] * dx + stand[SINE] * dy, stand[COSINE] * dy - stand[SINE] * dx
    turned, straight, turned_last = dubins_lengths(
        x, y, end[THETA] - math.atan2(stand[SINE], stand[COSINE]), first, last
    )
    pieces[0, LENGTH], pieces[0, CURVATURE] = gear * radius * turned, gear * first / radius
    pieces[1, LENGTH], pieces[1, CURVATURE] = gear * radius * straight, 0.0
    pieces[2, LENGTH], pieces[2, CURVATURE] = gear * radius * turned_last, gear * last / radius
    return radius * (turned + straight + turned_last)
