"""The terms of the timed elastic band with their analytic derivatives.

Roesmann et al., Trajectory modification considering dynamic constraints of autonomous robots, ROBOTIK 2012; Integrated
online trajectory planning and optimization in distinctive topologies, RAS 88, 2017; Kinodynamic trajectory optimization
and control for car-like robots, IROS 2017.
"""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import borrowing, compiled, inlined, inner
from arena_kernels.footprint import point_gap
from arena_teb.columns import AXES, COLUMNS, NEXT_THETA, NEXT_TIME, NEXT_X, NEXT_Y, SPAN, THETA, TIME, VX, VY, WZ, X, Y
from arena_teb.problem import (
    INTERVAL_ROWS,
    JOINT_ROWS,
    POINT_ROWS,
    REACH,
    BandTerms,
    Ends,
    FloatArray,
    Penalties,
    Rows,
    Shape,
    Surroundings,
)

KINEMATICS, DURATION, LENGTH, ROTATION = 3, 6, 7, 8  # where the terms of an interval begin, behind those of its speeds
ROTATION_INTERVALS = 3  # how many intervals a preferred direction of turning holds for (teb_local_planner)


@compiled
def make_rows(around: Surroundings) -> Rows:
    """Return room for all the terms of a band in its surroundings."""
    count, near = len(around.points), around.points.shape[1] + len(around.radii)
    total = (count - 1) * INTERVAL_ROWS + count * JOINT_ROWS + (count - 2) * POINT_ROWS * near + len(around.via_poses)
    return Rows(
        np.zeros(1, np.int64),
        np.empty(total),
        np.empty((total, REACH)),
        np.empty(total, np.int64),
        np.empty(total, np.int64),
        np.empty(total, np.int64),
        np.zeros((count, AXES)),
        np.zeros((count, AXES, SPAN)),
    )


@borrowing
def evaluate_terms(band: FloatArray, terms: BandTerms, shape: Shape, ends: Ends, around: Surroundings) -> float:
    """Fill the rows for a band (N, 4) and return half the sum of the squared residuals."""
    measure_motion(band, terms.rows)
    count = interval_rows(band, terms.penalties, ends, around, terms.rows)
    count = acceleration_rows(band, terms.penalties, ends, terms.rows, count)
    count = obstacle_rows(band, terms, shape, around, count)
    count = via_rows(band, terms.penalties, around, terms.rows, count)
    terms.rows.used[0] = count
    total = 0.0
    for i in range(count):
        total += terms.rows.residual[i] * terms.rows.residual[i]
    return 0.5 * total


@inlined
def enter_row(rows: Rows, count: int, term: int, first: int, width: int, residual: float) -> int:
    """Give a term the row ``count``, whose derivatives its caller has written; return how many rows there are then."""
    rows.residual[count], rows.first[count], rows.width[count], rows.term[count] = residual, first, width, term
    return count + 1


@inlined
def wrap_to_pi(angle: float) -> float:
    """Wrap an angle to [-pi, pi)."""
    return angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)


@inner
def measure_motion(band: FloatArray, rows: Rows) -> None:
    """Fill in the body velocity of every interval, at the heading half way between its poses, and its derivatives."""
    for k in range(len(band) - 1):
        dx, dy, dt = band[k + 1, X] - band[k, X], band[k + 1, Y] - band[k, Y], band[k, TIME]
        turn = wrap_to_pi(band[k + 1, THETA] - band[k, THETA])
        heading = band[k, THETA] + 0.5 * turn
        rate = 1.0 / dt
        c, s = math.cos(heading) * rate, math.sin(heading) * rate
        vx, vy = c * dx + s * dy, c * dy - s * dx
        speeds, slopes = rows.speeds[k], rows.slopes[k]
        speeds[VX], speeds[VY], speeds[WZ] = vx, vy, turn * rate
        for axis, along, across, by_heading in ((VX, c, s, 0.5 * vy), (VY, -s, c, -0.5 * vx)):
            slope = slopes[axis]
            slope[X], slope[Y], slope[THETA] = -along, -across, by_heading
            slope[TIME] = -speeds[axis] * rate
            slope[NEXT_X], slope[NEXT_Y], slope[NEXT_THETA] = along, across, by_heading
        slopes[WZ, THETA], slopes[WZ, TIME], slopes[WZ, NEXT_THETA] = -rate, -speeds[WZ] * rate, rate


@inner
def interval_rows(band: FloatArray, penalties: Penalties, ends: Ends, around: Surroundings, rows: Rows) -> int:
    """Write the terms of every interval; return how many rows there are."""
    count = 0
    for k in range(len(band) - 1):
        term = INTERVAL_ROWS * k
        for axis in range(AXES):
            cap = around.caps[k] if axis != WZ else 1.0
            speed, root = rows.speeds[k, axis], penalties.root_speed[axis]
            residual = root * signed_excess(speed, cap * penalties.speed_min[axis], cap * penalties.speed_max[axis])
            if residual != 0.0:
                for i in range(SPAN):
                    rows.jacobian[count, i] = root * rows.slopes[k, axis, i]
                count = enter_row(rows, count, term + axis, COLUMNS * k, SPAN, residual)
        count = kinematic_rows(band, k, penalties, rows, count)
        rows.jacobian[count, 0] = penalties.root_time
        count = enter_row(rows, count, term + DURATION, COLUMNS * k + TIME, 1, penalties.root_time * band[k, TIME])
        count = path_row(band, k, penalties, rows, count)
        count = rotation_row(band, k, BandTerms(penalties, rows), ends, count)
    return count


@inlined
def signed_excess(value: float, low: float, high: float) -> float:
    """Return how far a value lies outside an interval, with its sign."""
    return value - high if value > high else (value - low if value < low else 0.0)


@inner
def kinematic_rows(band: FloatArray, k: int, penalties: Penalties, rows: Rows, count: int) -> int:
    """Write that both poses lie on one arc (RAS 2017, eq. 13), that it is driven forwards, and
    that its radius is large enough.
    """
    dt, term = band[k, TIME], INTERVAL_ROWS * k + KINEMATICS
    forward, sideways, turn = dt * rows.speeds[k, VX], dt * rows.speeds[k, VY], dt * rows.speeds[k, WZ]
    slopes = rows.slopes[k]
    root = penalties.root_nonholonomic
    if root > 0.0:
        half_c, half_s = math.cos(0.5 * turn), math.sin(0.5 * turn)
        jacobian = rows.jacobian[count]
        for i in range(SPAN):
            jacobian[i] = root * 2.0 * half_c * dt * slopes[VY, i]
        jacobian[THETA] += root * half_s * sideways
        jacobian[NEXT_THETA] -= root * half_s * sideways
        jacobian[TIME] = 0.0
        count = enter_row(rows, count, term, COLUMNS * k, SPAN, root * 2.0 * half_c * sideways)

    root = penalties.root_forward
    residual = root * min(forward, 0.0)
    if residual != 0.0:
        for i in range(SPAN):
            rows.jacobian[count, i] = root * dt * slopes[VX, i]
        rows.jacobian[count, TIME] = 0.0
        count = enter_row(rows, count, term + 1, COLUMNS * k, SPAN, residual)

    root = penalties.root_turn_radius
    residual = root * max(penalties.turn_radius * abs(turn) - abs(forward), 0.0)
    if residual != 0.0:
        by_turn, by_forward = math.copysign(penalties.turn_radius, turn) * dt, -math.copysign(1.0, forward) * dt
        for i in range(SPAN):
            rows.jacobian[count, i] = root * (by_turn * slopes[WZ, i] + by_forward * slopes[VX, i])
        rows.jacobian[count, TIME] = 0.0
        count = enter_row(rows, count, term + 2, COLUMNS * k, SPAN, residual)
    return count


@inner
def path_row(band: FloatArray, k: int, penalties: Penalties, rows: Rows, count: int) -> int:
    """Write the distance between two poses."""
    root = penalties.root_path
    if root == 0.0:
        return count
    dx, dy = band[k + 1, X] - band[k, X], band[k + 1, Y] - band[k, Y]
    length = math.hypot(dx, dy)
    if length == 0.0:
        return count
    ux, uy = root * dx / length, root * dy / length
    jacobian = rows.jacobian[count]
    jacobian[X], jacobian[Y], jacobian[NEXT_X], jacobian[NEXT_Y] = -ux, -uy, ux, uy
    jacobian[THETA], jacobian[TIME] = 0.0, 0.0
    return enter_row(rows, count, INTERVAL_ROWS * k + LENGTH, COLUMNS * k, NEXT_Y + 1, root * length)


@inner
def rotation_row(band: FloatArray, k: int, terms: BandTerms, ends: Ends, count: int) -> int:
    """Write a turn against the preferred direction of turning."""
    against = min(ends.rotation * band[k, TIME] * terms.rows.speeds[k, WZ], 0.0) if k < ROTATION_INTERVALS else 0.0
    residual = terms.penalties.root_rotation * against
    if residual == 0.0:
        return count
    slope = terms.penalties.root_rotation * ends.rotation
    jacobian = terms.rows.jacobian[count]
    turned = NEXT_THETA - THETA  # the row begins with the heading
    jacobian[:turned], jacobian[turned] = 0.0, slope
    jacobian[0] = -slope
    return enter_row(terms.rows, count, INTERVAL_ROWS * k + ROTATION, COLUMNS * k + THETA, turned + 1, residual)


@inner
def acceleration_rows(band: FloatArray, penalties: Penalties, ends: Ends, rows: Rows, count: int) -> int:
    """Write the accelerations from the start's velocity, between intervals, and to the goal's velocity."""
    last = len(band) - 2
    term = INTERVAL_ROWS * (last + 1)
    for axis in range(AXES):
        count = edge_acceleration_row(
            band, (0, axis), 1.0, ends.start[axis], BandTerms(penalties, rows), count, term + axis
        )
    for k in range(last):
        term += JOINT_ROWS
        for axis in range(AXES):
            count = joint_acceleration_row(band, (k, axis), BandTerms(penalties, rows), count, term + axis)
    term += JOINT_ROWS
    for axis in range(AXES):
        count = edge_acceleration_row(
            band, (last, axis), -ends.stops, ends.goal[axis], BandTerms(penalties, rows), count, term + axis
        )
    return count


@inner
def joint_acceleration_row(band: FloatArray, place: tuple[int, int], terms: BandTerms, count: int, term: int) -> int:
    """Write the acceleration between two intervals."""
    k, axis = place
    rate = 2.0 / (band[k, TIME] + band[k + 1, TIME])
    acceleration = rate * (terms.rows.speeds[k + 1, axis] - terms.rows.speeds[k, axis])
    root = terms.penalties.root_acceleration[axis]
    residual = root * signed_excess(
        acceleration, -terms.penalties.acceleration[axis], terms.penalties.acceleration[axis]
    )
    if residual == 0.0:
        return count
    jacobian = terms.rows.jacobian[count]
    jacobian[SPAN:] = 0.0
    for i in range(SPAN):
        jacobian[i] = -root * rate * terms.rows.slopes[k, axis, i]
    for i in range(SPAN):
        jacobian[COLUMNS + i] += root * rate * terms.rows.slopes[k + 1, axis, i]
    jacobian[TIME] -= 0.5 * root * rate * acceleration
    jacobian[NEXT_TIME] -= 0.5 * root * rate * acceleration
    return enter_row(terms.rows, count, term, COLUMNS * k, REACH, residual)


@inner
def edge_acceleration_row(
    band: FloatArray, place: tuple[int, int], sign: float, other: float, terms: BandTerms, count: int, term: int
) -> int:
    """Write the acceleration between an interval and a velocity at an end of the band."""
    k, axis = place
    rate = 1.0 / band[k, TIME]
    acceleration = sign * rate * (terms.rows.speeds[k, axis] - other)
    root = terms.penalties.root_acceleration[axis]
    residual = root * signed_excess(
        acceleration, -terms.penalties.acceleration[axis], terms.penalties.acceleration[axis]
    )
    if residual == 0.0:
        return count
    for i in range(SPAN):
        terms.rows.jacobian[count, i] = root * sign * rate * terms.rows.slopes[k, axis, i]
    terms.rows.jacobian[count, TIME] -= root * rate * acceleration
    return enter_row(terms.rows, count, term, COLUMNS * k, SPAN, residual)


@inner
def obstacle_rows(band: FloatArray, terms: BandTerms, shape: Shape, around: Surroundings, count: int) -> int:
    """Write how near every pose between start and goal is to static points and to moving discs.

    In a passage that leaves less room than static points are kept away, that room is all that is asked for: the band
    keeps to the middle, and is not pushed out.
    """
    static = max(terms.penalties.near, terms.penalties.inflated) + around.point_radius + shape.radius
    dynamic = max(terms.penalties.dynamic_near, terms.penalties.dynamic_inflated)
    term = INTERVAL_ROWS * (len(band) - 1) + JOINT_ROWS * len(band)
    for k in range(1, len(band) - 1):
        c, s, turned = 1.0, 0.0, False
        near = min(terms.penalties.near, around.room[k])
        inflated = terms.penalties.inflated if near == terms.penalties.near else near
        for i in range(around.points.shape[1]):
            x, y = around.points[k, i, X] - band[k, X], around.points[k, i, Y] - band[k, Y]
            if x * x + y * y < static * static:
                if not turned:
                    c, s, turned = math.cos(band[k, THETA]), math.sin(band[k, THETA]), True
                bounds, roots = (near, inflated), (terms.penalties.root_obstacle, terms.penalties.root_inflation)
                before = count
                count = distance_rows(k, x, y, c, s, around.point_radius, bounds, roots, shape, terms.rows, count, term)
                if terms.penalties.exponent != 1.0 and count > before and terms.rows.term[before] == term:
                    apply_exponent(before, roots[0], terms.penalties, terms.rows)
            term += POINT_ROWS
        for j in range(len(around.radii)):
            x, y = around.moving[k, j, X] - band[k, X], around.moving[k, j, Y] - band[k, Y]
            far = dynamic + around.radii[j] + shape.radius
            if x * x + y * y < far * far:
                if not turned:
                    c, s, turned = math.cos(band[k, THETA]), math.sin(band[k, THETA]), True
                bounds = terms.penalties.dynamic_near, terms.penalties.dynamic_inflated
                roots = terms.penalties.root_dynamic, terms.penalties.root_dynamic_inflation
                count = distance_rows(k, x, y, c, s, around.radii[j], bounds, roots, shape, terms.rows, count, term)
            term += POINT_ROWS
    return count


@inner
def distance_rows(
    k: int,
    x: float,
    y: float,
    c: float,
    s: float,
    radius: float,
    bounds: tuple[float, float],
    roots: tuple[float, float],
    shape: Shape,
    rows: Rows,
    count: int,
    term: int,
) -> int:
    """Write up to two terms for a disc at (x, y) from a pose whose heading has cosine and sine (c, s):
    nearer than each of ``bounds``.
    """
    bx, by = c * x + s * y, c * y - s * x
    gap, nx, ny = hull_distance(shape, bx, by)
    gap -= radius
    for i in range(2):
        lack = bounds[i] - gap
        if lack > 0.0 and roots[i] > 0.0:
            root = roots[i]
            rows.jacobian[count, X] = root * (c * nx - s * ny)
            rows.jacobian[count, Y] = root * (s * nx + c * ny)
            rows.jacobian[count, THETA] = root * (ny * bx - nx * by)
            count = enter_row(rows, count, term + i, COLUMNS * k, 3, root * lack)
    return count


@inner
def apply_exponent(at: int, root: float, penalties: Penalties, rows: Rows) -> None:
    """Raise the lack of a gap, in its unit, to the exponent (teb_local_planner: obstacle_cost_exponent)."""
    share = rows.residual[at] / (root * penalties.unit)
    power = share ** (penalties.exponent - 1.0)
    rows.residual[at] *= power
    for i in range(3):
        rows.jacobian[at, i] *= penalties.exponent * power


@inlined
def hull_distance(shape: Shape, x: float, y: float) -> tuple[float, float, float]:
    """Return the signed distance from the footprint to a point in ``base_link`` and its gradient."""
    if len(shape.corners) > 1:
        gap, nx, ny = point_gap(shape.corners, x, y)
        return gap - shape.rounding, nx, ny
    distance = math.sqrt(x * x + y * y)
    if distance > 0.0:
        return distance - shape.rounding, x / distance, y / distance
    return -shape.rounding, 1.0, 0.0


@inner
def via_rows(band: FloatArray, penalties: Penalties, around: Surroundings, rows: Rows, count: int) -> int:
    """Write how far the pose of each via point lies from it."""
    near = around.points.shape[1] + len(around.radii)
    term = INTERVAL_ROWS * (len(band) - 1) + JOINT_ROWS * len(band) + POINT_ROWS * near * (len(band) - 2)
    for j in range(len(around.via_poses)):
        k, root = around.via_poses[j], penalties.root_via
        dx, dy = band[k, X] - around.vias[j, X], band[k, Y] - around.vias[j, Y]
        distance = math.hypot(dx, dy)
        if root * distance != 0.0:
            rows.jacobian[count, X], rows.jacobian[count, Y] = root * dx / distance, root * dy / distance
            count = enter_row(rows, count, term + j, COLUMNS * k, 2, root * distance)
    return count
