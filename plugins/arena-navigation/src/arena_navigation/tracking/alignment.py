"""How far the pose estimate has slipped since a past scan: the motion that lays what stands in the new scan on what
stood in the old one.

Point-to-line scan matching (A. Censi, An ICP variant using a point-to-line metric, ICRA 2008) with partners found by
bearing.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.scalars import Integer
from arena_navigation.columns import BEAM_X, BEAM_Y, COSINE, NORMAL_X, NORMAL_Y, OFFSET, SINE, THETA, VX, VY, X, Y
from arena_navigation.local_map.marks import PlacedScan
from arena_navigation.tracking.returns import PastScans, Returns, is_followed, within_a_turn

_STEPS = 8  # of Gauss-Newton at most
_COARSE, _FINE = 1e-2, 1e-4  # m and rad of a step, after which outliers count less, and after which it is done
_WIDEST = 20  # beams to either side
_EDGE = 1e-6  # of a sector at either side, where rounding might tell another beam
_TURN = 2.0 * math.pi


class Alignment(NamedTuple):
    """How to align: ``position`` m and ``heading`` rad are what slips usually, ``noise`` m that of ranges.

    Lines are laid through returns about ``baseline`` m apart; what is off by much more than ``outlier`` m hardly
    counts. About ``points`` returns are used; with fewer than a quarter of them nothing is aligned, for then it may be
    people who moved.
    """

    position: float
    heading: float
    noise: float
    baseline: float
    outlier: float
    points: int


class Points(NamedTuple):
    """Scratch space: where the chosen beams end, ``ends`` (B, 2), and the line each was last laid on.

    That is the direction of the past scan's beam it was laid through, its own normal, both in ``map``, and its distance
    from the past sensor, ``lines`` (B, 5), and how many beams to either side it reaches, ``half`` (B,), 0 to look
    again; ``found`` (B,): whether there is one. ``turns`` are the cosine and sine of so many beams.
    """

    ends: NDArray[np.float64]
    half: NDArray[np.int64]
    lines: NDArray[np.float64]
    found: NDArray[np.uint8]
    turns: NDArray[np.float64]

    @staticmethod
    def room(beams: int) -> Points:
        """Return room for so many beams."""
        lines, turns = np.zeros((beams, 5)), np.zeros((_WIDEST + 1, 2))
        return Points(np.zeros((beams, 2)), np.zeros(beams, np.int64), lines, np.zeros(beams, np.uint8), turns)


@inner
def beam_stride(beams: PlacedScan, rules: Alignment) -> Integer:
    """Return of how many beams one is used."""
    return max(len(beams.ranges) // rules.points, 1)


@borrowing
def estimate_slip(
    beams: PlacedScan,
    returns: Returns,
    past: PastScans,
    k: Integer,
    tracks: NDArray[np.float64],
    rules: Alignment,
    points: Points,
    moved: NDArray[np.float64],
) -> None:
    """Write the motion ``moved`` (3,) = x, y, turn about the sensor, that takes points of the new scan to where scan
    ``k`` saw them.

    The ``returns`` of the new scan are placed. At first all that is less than ten outlier distances off counts almost
    fully.
    """
    count = _standing_ends(beams, returns, tracks, rules, points)
    for half in range(_WIDEST + 1):
        points.turns[half, COSINE], points.turns[half, SINE] = (
            math.cos(half * beams.angle_increment),
            math.sin(half * beams.angle_increment),
        )
    moved[:] = 0.0
    outlier = 10.0 * rules.outlier
    for step in range(_STEPS):
        along, turning = 1.0 / rules.position**2, 1.0 / rules.heading**2
        # normal equations a (symmetric, 3 x 3) d = b over x, y and turn
        axx, axy, ayy, axt, ayt, att = along, 0.0, along, 0.0, 0.0, turning
        bx, by, bt = -along * moved[X], -along * moved[Y], -turning * moved[THETA]
        used = 0
        c, s = math.cos(moved[THETA]), math.sin(moved[THETA])
        for i in range(count):
            rx, ry = c * points.ends[i, X] - s * points.ends[i, Y], s * points.ends[i, X] + c * points.ends[i, Y]
            dx = beams.sensor[X] + rx + moved[X] - past.sensors[k, X]
            dy = beams.sensor[Y] + ry + moved[Y] - past.sensors[k, Y]
            _write_past_line(beams, past, k, dx, dy, rules, points, i)
            nx, ny = points.lines[i, NORMAL_X], points.lines[i, NORMAL_Y]
            off = nx * dx + ny * dy - points.lines[i, OFFSET]
            if not points.found[i] or abs(off) > 10.0 * rules.outlier:
                continue
            used += 1
            weight = 1.0 / (rules.noise**2 * (1.0 + (off / outlier) ** 2))
            t = ny * rx - nx * ry
            axx += weight * nx * nx
            axy += weight * nx * ny
            ayy += weight * ny * ny
            axt += weight * nx * t
            ayt += weight * ny * t
            att += weight * t * t
            bx -= weight * nx * off
            by -= weight * ny * off
            bt -= weight * t * off
        if 4 * used < rules.points:
            moved[:] = 0.0
            return
        cxx, cxy, cxt = ayy * att - ayt * ayt, axt * ayt - axy * att, axy * ayt - ayy * axt
        cyy, cyt, ctt = axx * att - axt * axt, axy * axt - axx * ayt, axx * ayy - axy * axy
        det = axx * cxx + axy * cxy + axt * cxt
        dx, dy, turn = (
            (cxx * bx + cxy * by + cxt * bt) / det,
            (cxy * bx + cyy * by + cyt * bt) / det,
            (cxt * bx + cyt * by + ctt * bt) / det,
        )
        moved[X], moved[Y], moved[THETA] = moved[X] + dx, moved[Y] + dy, moved[THETA] + turn
        settled = abs(dx) + abs(dy) + abs(turn)
        if outlier == rules.outlier and settled < _FINE:
            break
        if settled < _COARSE or 2 * step + 2 >= _STEPS:
            outlier = rules.outlier


@inner
def _standing_ends(
    beams: PlacedScan, returns: Returns, tracks: NDArray[np.float64], rules: Alignment, points: Points
) -> Integer:
    """Write where the chosen beams end, from the sensor in the axes of ``map``, and return how many there are.

    Returns on tracks are left out, and, with a map, those far from its walls: what moves by itself must not be taken
    for the robot's error.
    """
    count: Integer = np.int64(0)
    for beam in range(0, len(beams.ranges), beam_stride(beams, rules)):
        if not beams.range_min <= beams.ranges[beam] <= beams.range_max:
            continue
        x, y = returns.x[beam], returns.y[beam]
        astray = returns.free[beam] and returns.wall[beam] > 10.0 * rules.outlier
        if astray or is_followed(tracks, beams.sensor[X] + x, beams.sensor[Y] + y):
            continue
        points.ends[count, X], points.ends[count, Y] = x, y
        points.half[count] = 0
        count += 1
    return count


@inner
def _write_past_line(
    beams: PlacedScan, past: PastScans, k: Integer, dx: float, dy: float, rules: Alignment, points: Points, i: Integer
) -> None:
    """Write the line that past scan ``k`` saw about point ``i``, ``dx`` and ``dy`` from its sensor, if the one written
    is not that line.

    As long as the point stays in one beam's sector and about as far away, it is.
    """
    away = math.sqrt(dx * dx + dy * dy)
    half = min(max(math.ceil(0.5 * rules.baseline / (max(away, 1e-3) * beams.angle_increment)), 1), _WIDEST)
    if points.half[i] == half:
        c, s = points.lines[i, BEAM_X], points.lines[i, BEAM_Y]
        if abs(c * dy - s * dx) < (0.5 - _EDGE) * beams.angle_increment * (c * dx + s * dy):
            return
    bearing = within_a_turn(math.atan2(dy, dx) - past.sensors[k, THETA] - beams.angle_min) / beams.angle_increment
    at = round(bearing)
    whole = at > 0 and (at + 0.5) * beams.angle_increment < _TURN  # not one that the first beam's sector overlaps
    points.half[i] = half if whole else 0
    angle = past.sensors[k, THETA] + beams.angle_min + at * beams.angle_increment
    points.lines[i, BEAM_X], points.lines[i, BEAM_Y] = math.cos(angle), math.sin(angle)
    points.found[i] = _fit_line(beams, past, k, at, half, rules, points.turns[half], points.lines[i])


@inner
def _fit_line(
    beams: PlacedScan,
    past: PastScans,
    k: Integer,
    at: Integer,
    half: Integer,
    rules: Alignment,
    turn: NDArray[np.float64],
    line: NDArray[np.float64],
) -> bool:
    """Write normal and distance of the straight piece that past scan ``k`` saw about a beam;
    return whether there is one.
    """
    if not half <= at < len(beams.ranges) - half:
        return False
    low, middle, high = past.ranges[k, at - half], past.ranges[k, at], past.ranges[k, at + half]
    if not (beams.range_min <= min(low, middle, high) and max(low, middle, high) <= beams.range_max):
        return False
    # in the frame whose first axis is the beam in the middle
    c, s = turn[COSINE], turn[SINE]
    ax, ay, bx, by = low * c, -low * s, high * c, high * s
    length = math.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
    if not 1e-6 < length < 10.0 * rules.baseline:
        return False
    nx, ny = -(by - ay) / length, (bx - ax) / length
    if abs(nx * (middle - ax) - ny * ay) > rules.outlier:
        return False
    c, s = line[BEAM_X], line[BEAM_Y]
    line[NORMAL_X], line[NORMAL_Y], line[OFFSET] = c * nx - s * ny, s * nx + c * ny, nx * ax + ny * ay
    return True


@borrowing
def move_states(
    beams: PlacedScan,
    moved: NDArray[np.float64],
    states: NDArray[np.float64],
    covariances: NDArray[np.float64],
    sensors: NDArray[np.float64],
) -> None:
    """Move what was believed before to where it lies seen from the new pose.

    These are states (N, 4), covariances (N, 4, 4) and the poses of past ``sensors`` (K, 3).
    """
    c, s = math.cos(moved[THETA]), math.sin(moved[THETA])
    for k in range(len(states)):
        x, y = states[k, X] - beams.sensor[X] - moved[X], states[k, Y] - beams.sensor[Y] - moved[Y]
        states[k, X], states[k, Y] = beams.sensor[X] + c * x + s * y, beams.sensor[Y] + c * y - s * x
        x, y = states[k, VX], states[k, VY]
        states[k, VX], states[k, VY] = c * x + s * y, c * y - s * x
        p = covariances[k]
        for i in range(0, 4, 2):
            for column in range(4):
                x, y = p[i, column], p[i + 1, column]
                p[i, column], p[i + 1, column] = c * x + s * y, c * y - s * x
        for i in range(0, 4, 2):
            for row in range(4):
                x, y = p[row, i], p[row, i + 1]
                p[row, i], p[row, i + 1] = c * x + s * y, c * y - s * x
    for k in range(len(sensors)):
        x, y = sensors[k, X] - beams.sensor[X] - moved[X], sensors[k, Y] - beams.sensor[Y] - moved[Y]
        sensors[k, X], sensors[k, Y] = beams.sensor[X] + c * x + s * y, beams.sensor[Y] + c * y - s * x
        sensors[k, THETA] -= moved[THETA]
