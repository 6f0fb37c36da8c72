"""The critics that look at a block of roll-outs while it is driven, one after the other."""

from __future__ import annotations

import numpy as np

from arena_kernels.compiled import inlined, inner
from arena_kernels.window import clearance
from arena_mppi.parameters import Body, Critics, Floats, Scene
from arena_mppi.rollout import COSINE, COST, HALF, HIT, LANES, ONE, SINE, SPEED, TRAVELLED, ZERO, X, Y

COLLISION_COST = np.float32(1e6)
COLLIDED = np.float32(0.5e6)  # what costs more has collided: other critics add thousands, and the control cost may be negative
FAR = np.float32(1e3)  # m, the gap outside the window, of which nothing is known
SPACING = np.float32(0.05)  # m between two points of the path


@inlined
def interpolated(field: Floats, u: np.float32, v: np.float32) -> np.float32:
    """Return a field's value at column ``u`` and row ``v`` counted between cell centres, which must be inside."""
    rows, columns = field.shape
    column, row = min(max(int(u), 0), columns - 2), min(max(int(v), 0), rows - 2)
    right, up = u - np.float32(column), v - np.float32(row)
    below = field[row, column] + right * (field[row, column + 1] - field[row, column])
    above = field[row + 1, column] + right * (field[row + 1, column + 1] - field[row + 1, column])
    return below + up * (above - below)  # type: ignore[no-any-return]


@inlined
def gap_at(scene: Scene, x: np.float32, y: np.float32) -> np.float32:
    """Return the distance from a position to the nearest lethal cell's edge, m; FAR outside the window."""
    rows, columns = scene.gaps.shape
    u, v = (x - scene.gaps_x) / scene.gaps_resolution - HALF, (y - scene.gaps_y) / scene.gaps_resolution - HALF
    if u < ZERO or v < ZERO or u >= np.float32(columns - 1) or v >= np.float32(rows - 1):
        return FAR
    return interpolated(scene.gaps, u, v)


@inlined
def left_at(scene: Scene, x: np.float32, y: np.float32) -> np.float32:
    """Return what is left of the way from a position; beyond the window's edge the way back to it comes on top."""
    rows, columns = scene.left.shape
    u, v = (x - scene.left_x) / scene.left_resolution - HALF, (y - scene.left_y) / scene.left_resolution - HALF
    inside_u, inside_v = min(max(u, ZERO), np.float32(columns - 1)), min(max(v, ZERO), np.float32(rows - 1))
    beyond = np.sqrt((u - inside_u) * (u - inside_u) + (v - inside_v) * (v - inside_v))
    return interpolated(scene.left, inside_u, inside_v) + beyond * scene.left_resolution  # type: ignore[no-any-return]


@inner
def judge_static(lanes: Floats, scene: Scene, body: Body, critics: Critics, least: float, share: np.float32) -> None:
    """Add what lanes near walls cost: repulsion by the square of the missing gap, and for the first contact COLLISION_COST and its speed's.

    To a fast lane walls are nearer, by its speed times ``critics.reaction_time``. The discs that cover the footprint tell the gap within
    centimetres; only where they come nearer than ``least`` to a wall is the outline looked at itself.
    """
    for k in range(LANES):
        if lanes[HIT + k] > ZERO:
            continue
        gap = FAR
        for d in range(len(body.discs)):
            at_x, at_y = body.discs[d, 0], body.discs[d, 1]
            x = lanes[X + k] + lanes[COSINE + k] * at_x - lanes[SINE + k] * at_y
            y = lanes[Y + k] + lanes[SINE + k] * at_x + lanes[COSINE + k] * at_y
            gap = min(gap, gap_at(scene, x, y) - body.discs[d, 2])
        felt = max(gap - critics.reaction_time * lanes[SPEED + k], ZERO)
        if felt >= critics.inflation_radius:
            continue
        lack = ONE - felt / critics.inflation_radius
        cost = critics.static * lack * lack
        if felt < critics.near_collision_gap:
            cost += critics.critical * (ONE - felt / critics.near_collision_gap)
        lanes[COST + k] += share * cost
        if gap < least and exact_gap(lanes, k, scene, body, least) < least:
            lanes[HIT + k] = ONE
            lanes[COST + k] += COLLISION_COST * (ONE + lanes[SPEED + k])


@inlined
def exact_gap(lanes: Floats, k: int, scene: Scene, body: Body, enough: float) -> float:
    """Return how far the outline of lane ``k`` is from the nearest wall, m; FAR where that is not known."""
    x, y = scene.x + float(lanes[X + k]), scene.y + float(lanes[Y + k])
    gap = clearance(scene.window, body.outline, x, y, float(lanes[COSINE + k]), float(lanes[SINE + k]), enough)
    return gap if gap > -100.0 else float(FAR)


@inner
def judge_moving(lanes: Floats, scene: Scene, body: Body, critics: Critics, t: int, fastest: np.float32, dt: np.float32) -> None:
    """Add what lanes cost that come near to where a moving obstacle is expected at step ``t``; none drives faster than ``fastest``.

    Past people a fast lane needs more room than a slow one, or passing fast would be the cheapest way of passing near.
    """
    weight, contact = critics.moving * scene.belief[t] * dt, critics.contact * scene.belief[t] * dt
    inverse = ONE / critics.margin
    reach = fastest * dt * np.float32(t + 1)
    widest = critics.margin + critics.moving_reaction_time * fastest
    for n in range(scene.moving.shape[1]):
        other_x, other_y, other_radius = scene.moving[t, n, 0], scene.moving[t, n, 1], scene.moving[t, n, 2]
        nearest = np.sqrt(other_x * other_x + other_y * other_y) - other_radius - body.outline.radius - widest
        if nearest > reach:
            continue
        for d in range(len(body.discs)):
            at_x, at_y, radius = body.discs[d, 0], body.discs[d, 1], body.discs[d, 2] + other_radius
            for k in range(LANES):
                dx = lanes[X + k] + lanes[COSINE + k] * at_x - lanes[SINE + k] * at_y - other_x
                dy = lanes[Y + k] + lanes[SINE + k] * at_x + lanes[COSINE + k] * at_y - other_y
                lack = max(ZERO, ONE - (np.sqrt(dx * dx + dy * dy) - radius - critics.moving_reaction_time * lanes[SPEED + k]) * inverse)
                lanes[COST + k] += weight * lack * lack + (contact * lack if lack > ONE else ZERO)


@inner
def judge_alignment(lanes: Floats, scene: Scene, weight: np.float32) -> None:
    """Add the distance of each lane from the path point as far along the path as the lane has travelled."""
    last = len(scene.path) - 1
    for k in range(LANES):
        i = min(int(lanes[TRAVELLED + k] / SPACING), last)
        dx, dy = lanes[X + k] - scene.path[i, 0], lanes[Y + k] - scene.path[i, 1]
        lanes[COST + k] += weight * np.sqrt(dx * dx + dy * dy)


@inner
def judge_progress(lanes: Floats, scene: Scene, weight: np.float32) -> None:
    """Add what each lane has left of the way."""
    for k in range(LANES):
        if lanes[HIT + k] == ZERO:
            lanes[COST + k] += weight * left_at(scene, lanes[X + k], lanes[Y + k])


@inner
def judge_goal(lanes: Floats, scene: Scene, weight: np.float32, angle_weight: np.float32) -> None:
    """Add the distance of each lane from the goal, and how far its heading is off the goal's (1 - cosine)."""
    goal_x, goal_y, goal_c, goal_s = scene.goal[0], scene.goal[1], scene.goal[2], scene.goal[3]
    for k in range(LANES):
        dx, dy = lanes[X + k] - goal_x, lanes[Y + k] - goal_y
        off = ONE - lanes[COSINE + k] * goal_c - lanes[SINE + k] * goal_s
        lanes[COST + k] += weight * np.sqrt(dx * dx + dy * dy) + angle_weight * off
