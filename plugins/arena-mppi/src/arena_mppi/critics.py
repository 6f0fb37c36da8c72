"""The critics that look at a block of roll-outs while it is driven, one after the other."""

from __future__ import annotations

import numpy as np

from arena_kernels.compiled import inlined, inner
from arena_kernels.costmap_window import OUTLINE_SPACING, distance_at, outline_clearance
from arena_mppi.columns import PLACE_X, PLACE_Y, RADIUS
from arena_mppi.parameters import Body, Critics, Floats, Scene
from arena_mppi.rollout import (
    COLUMN,
    COSINE,
    COST,
    GAP,
    HALF,
    HIT,
    LANES,
    ONE,
    RIGHT,
    ROW,
    SINE,
    SPEED,
    TRAVELLED,
    UP,
    ZERO,
    X,
    Y,
)

COLLISION_COST = np.float32(1e6)
# what costs more has collided: other critics add thousands, and the control cost may be negative
COLLIDED = np.float32(0.5e6)
FAR = np.float32(1e3)  # m, the gap outside the window, of which nothing is known
SPACING = np.float32(0.05)  # m between two points of the path
BETWEEN_CELLS = 1.5  # cells, more than two interpolated distances differ by beyond the way between their places
NEXT = np.uint64(1)
SLACK = np.float32(0.01)  # m, more than what single precision rounds off in a roll-out
FEW = 48  # lanes up to which each is judged by itself instead of all side by side


@inlined
def interpolate_field(field: Floats, u: np.float32, v: np.float32) -> np.float32:
    """Return a field's value at column ``u`` and row ``v`` counted between cell centres, which must be inside."""
    rows, columns = field.shape
    column, row = min(max(int(u), 0), columns - 2), min(max(int(v), 0), rows - 2)
    right, up = u - np.float32(column), v - np.float32(row)
    below = field[row, column] + right * (field[row, column + 1] - field[row, column])
    above = field[row + 1, column] + right * (field[row + 1, column + 1] - field[row + 1, column])
    return below + up * (above - below)  # type: ignore[no-any-return]


@inner
def find_cells(lanes: Floats, scene: Scene, at_x: np.float32, at_y: np.float32) -> None:
    """Write for a point of every lane's body which cells of ``gaps`` it lies between, and where; column -1 outside the
    window.

    All lanes side by side: the field itself, which lanes look up one by one, would keep them out of vector registers.
    """
    rows, columns = scene.gaps.shape
    last_u, last_v = np.float32(columns - 1), np.float32(rows - 1)
    corner_x, corner_y, resolution = scene.gaps_x, scene.gaps_y, scene.gaps_resolution
    for k in range(LANES):
        x = lanes[X + k] + lanes[COSINE + k] * at_x - lanes[SINE + k] * at_y
        y = lanes[Y + k] + lanes[SINE + k] * at_x + lanes[COSINE + k] * at_y
        u, v = (x - corner_x) / resolution - HALF, (y - corner_y) / resolution - HALF
        inside = (u >= ZERO) & (v >= ZERO) & (u < last_u) & (v < last_v)
        u, v = u if inside else ZERO, v if inside else ZERO
        column, row = np.float32(np.int32(u)), np.float32(np.int32(v))
        lanes[COLUMN + k], lanes[ROW + k] = column if inside else -ONE, row
        lanes[RIGHT + k], lanes[UP + k] = u - column, v - row


@inlined
def cost_to_go_at(scene: Scene, x: np.float32, y: np.float32) -> np.float32:
    """Return what is left of the way from a position; beyond the window's edge the way back to it comes on top."""
    rows, columns = scene.left.shape
    u, v = (x - scene.left_x) / scene.left_resolution - HALF, (y - scene.left_y) / scene.left_resolution - HALF
    inside_u, inside_v = min(max(u, ZERO), np.float32(columns - 1)), min(max(v, ZERO), np.float32(rows - 1))
    beyond = np.sqrt((u - inside_u) * (u - inside_u) + (v - inside_v) * (v - inside_v))
    left = interpolate_field(scene.left, inside_u, inside_v)
    return left + beyond * scene.left_resolution  # type: ignore[no-any-return]


@inner
def cover_radius(body: Body) -> np.float32:
    """Return how far from the origin the discs that cover the footprint reach, m."""
    reach = ZERO
    for d in range(len(body.discs)):
        reach = max(
            reach,
            np.sqrt(body.discs[d, PLACE_X] * body.discs[d, PLACE_X] + body.discs[d, PLACE_Y] * body.discs[d, PLACE_Y])
            + body.discs[d, RADIUS],
        )
    return reach


@inner
def add_static_cost(lanes: Floats, scene: Scene, body: Body, critics: Critics, least: float, share: np.float32) -> None:
    """Add what lanes near walls cost: repulsion by the square of the missing gap, and for the first contact
    COLLISION_COST and its speed's.

    To a fast lane walls are nearer, by its speed times ``critics.reaction_time``. The discs that cover the footprint
    tell the gap within centimetres; only where they come nearer than ``least`` to a wall is the outline looked at
    itself.
    """
    if scene.gaps[0, 0] >= FAR:  # a field is infinite everywhere or nowhere
        return
    gaps = scene.gaps
    for k in range(LANES):
        lanes[GAP + k] = FAR
    for d in range(len(body.discs)):
        at_x, at_y, radius = body.discs[d, PLACE_X], body.discs[d, PLACE_Y], body.discs[d, RADIUS]
        find_cells(lanes, scene, at_x, at_y)
        for k in range(LANES):
            if lanes[COLUMN + k] >= ZERO:
                column, row, right = np.uint64(lanes[COLUMN + k]), np.uint64(lanes[ROW + k]), lanes[RIGHT + k]
                below = gaps[row, column] + right * (gaps[row, column + NEXT] - gaps[row, column])
                above = gaps[row + NEXT, column] + right * (gaps[row + NEXT, column + NEXT] - gaps[row + NEXT, column])
                lanes[GAP + k] = min(lanes[GAP + k], below + lanes[UP + k] * (above - below) - radius)
    for k in range(LANES):
        gap = lanes[GAP + k]
        felt = max(gap - critics.reaction_time * lanes[SPEED + k], ZERO)
        if felt >= critics.inflation_radius or lanes[HIT + k] > ZERO:
            continue
        lack = ONE - felt / critics.inflation_radius
        cost = critics.static * lack * lack
        if felt < critics.near_collision_gap:
            cost += critics.critical * (ONE - felt / critics.near_collision_gap)
        lanes[COST + k] += share * cost
        if gap < least and lane_collides(lanes, k, scene, body, least):
            lanes[HIT + k] = ONE
            lanes[COST + k] += COLLISION_COST * (ONE + lanes[SPEED + k])


@inner
def lane_collides(lanes: Floats, k: int, scene: Scene, body: Body, least: float) -> bool:
    """Return whether the outline of lane ``k`` is nearer to a wall than ``least`` m; what reaches beyond the window
    counts as free.

    Points of the outline are not looked at where one before them is so far from walls that they cannot be near: no
    distance changes by more than the way between two places, and an interpolated one by the way between cells besides.
    """
    window, outline, c, s = scene.window, body.outline, float(lanes[COSINE + k]), float(lanes[SINE + k])
    x, y = scene.x + float(lanes[X + k]), scene.y + float(lanes[Y + k])
    rows, columns = window.costs.shape
    right, top = window.origin_x + columns * window.resolution, window.origin_y + rows * window.resolution
    edge = min(min(x - window.origin_x, right - x), min(y - window.origin_y, top - y))
    if edge <= outline.radius + window.resolution:
        gap = outline_clearance(window, outline, (x, y, c, s), least)
        return bool(-100.0 < gap < least)
    centre, count = distance_at(window, x, y), len(outline.points_xy)
    if count == 0 or centre - outline.radius > least:
        return bool(centre - outline.radius < least)
    if centre - outline.inscribed_radius < least:
        return True
    needed, i = least + BETWEEN_CELLS * window.resolution, 0
    while i < count:
        px, py = outline.points_xy[i]
        free = distance_at(window, x + c * px - s * py, y + s * px + c * py)
        if free < least:
            return True
        i += 1 + max(0, int((free - needed) / OUTLINE_SPACING))
    return False


@inner
def add_moving_cost(
    lanes: Floats,
    scene: Scene,
    body: Body,
    critics: Critics,
    t: int,
    fastest: np.float32,
    cover: np.float32,
    dt: np.float32,
) -> None:
    """Add what lanes cost that come near to where a moving obstacle is expected at step ``t``; none drives faster than
    ``fastest``.

    Past people a fast lane needs more room than a slow one, or passing fast would be the cheapest way of passing near.
    """
    weight, contact = critics.moving * scene.belief[t] * dt, critics.contact * scene.belief[t] * dt
    reach = fastest * dt * np.float32(t + 1)
    widest = critics.margin + critics.moving_reaction_time * fastest
    for n in range(scene.moving.shape[1]):
        other_x, other_y, other_radius = (
            scene.moving[t, n, PLACE_X],
            scene.moving[t, n, PLACE_Y],
            scene.moving[t, n, RADIUS],
        )
        nearest = np.sqrt(other_x * other_x + other_y * other_y) - other_radius - body.outline.radius - widest
        if nearest > reach:
            continue
        felt_from = other_radius + cover + widest + SLACK
        squared, near = felt_from * felt_from, 0
        for k in range(LANES):
            dx, dy = lanes[X + k] - other_x, lanes[Y + k] - other_y
            near += 1 if dx * dx + dy * dy < squared else 0
        if near > FEW:
            for d in range(len(body.discs)):
                for k in range(LANES):
                    add_disc_cost(lanes, k, body, d, other_x, other_y, other_radius, critics, weight, contact)
        elif near > 0:
            for k in range(LANES):
                dx, dy = lanes[X + k] - other_x, lanes[Y + k] - other_y
                if dx * dx + dy * dy < squared:
                    for d in range(len(body.discs)):
                        add_disc_cost(lanes, k, body, d, other_x, other_y, other_radius, critics, weight, contact)


@inlined
def add_disc_cost(
    lanes: Floats,
    k: int,
    body: Body,
    d: int,
    other_x: np.float32,
    other_y: np.float32,
    other_radius: np.float32,
    critics: Critics,
    weight: np.float32,
    contact: np.float32,
) -> None:
    """Add what disc ``d`` of lane ``k`` costs beside a moving obstacle."""
    at_x, at_y, radius, inverse = (
        body.discs[d, PLACE_X],
        body.discs[d, PLACE_Y],
        body.discs[d, RADIUS] + other_radius,
        ONE / critics.margin,
    )
    dx = lanes[X + k] + lanes[COSINE + k] * at_x - lanes[SINE + k] * at_y - other_x
    dy = lanes[Y + k] + lanes[SINE + k] * at_x + lanes[COSINE + k] * at_y - other_y
    lack = max(
        ZERO, ONE - (np.sqrt(dx * dx + dy * dy) - radius - critics.moving_reaction_time * lanes[SPEED + k]) * inverse
    )
    lanes[COST + k] += weight * lack * lack + (contact * lack if lack > ONE else ZERO)


@inner
def add_alignment_cost(lanes: Floats, scene: Scene, weight: np.float32) -> None:
    """Add the distance of each lane from the path point as far along the path as the lane has travelled."""
    last = len(scene.path) - 1
    for k in range(LANES):
        i = min(int(lanes[TRAVELLED + k] / SPACING), last)
        dx, dy = lanes[X + k] - scene.path[i, PLACE_X], lanes[Y + k] - scene.path[i, PLACE_Y]
        lanes[COST + k] += weight * np.sqrt(dx * dx + dy * dy)


@inner
def add_progress_cost(lanes: Floats, scene: Scene, weight: np.float32) -> None:
    """Add what each lane has left of the way."""
    for k in range(LANES):
        if lanes[HIT + k] == ZERO:
            lanes[COST + k] += weight * cost_to_go_at(scene, lanes[X + k], lanes[Y + k])


@inner
def add_goal_cost(lanes: Floats, scene: Scene, weight: np.float32, angle_weight: np.float32) -> None:
    """Add the distance of each lane from the goal, and how far its heading is off the goal's (1 - cosine)."""
    goal_x, goal_y, goal_c, goal_s = scene.goal[0], scene.goal[1], scene.goal[2], scene.goal[3]
    for k in range(LANES):
        dx, dy = lanes[X + k] - goal_x, lanes[Y + k] - goal_y
        off = ONE - lanes[COSINE + k] * goal_c - lanes[SINE + k] * goal_s
        lanes[COST + k] += weight * np.sqrt(dx * dx + dy * dy) + angle_weight * off
