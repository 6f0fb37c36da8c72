"""One control step: sample, roll out, judge, and move the mean towards what was cheap."""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import borrowing, inner
from arena_kernels.costmap_window import outline_clearance
from arena_kernels.scalars import Integer
from arena_mppi.columns import PLACE_X, PLACE_Y, RADIUS
from arena_mppi.critics import (
    COLLIDED,
    FAR,
    SPACING,
    add_alignment_cost,
    add_goal_cost,
    add_moving_cost,
    add_progress_cost,
    add_static_cost,
    cover_radius,
)
from arena_mppi.parameters import Body, Chassis, Critics, Floats, Sampling, Scene, Workspace
from arena_mppi.rollout import (
    COSINE,
    COST,
    LANES,
    ONE,
    SINE,
    ZERO,
    X,
    Y,
    draw_noise,
    drive_lanes,
    start_lanes,
    step_towards,
)

PATH_STRIDE = 4  # steps between two looks at the path, as in Nav2
BELIEVED = np.float32(0.3)  # least belief in a predicted contact that the chosen sequence must not run into
WINDOW = np.array((-21.0, 14.0, 39.0, 54.0, 59.0, 54.0, 39.0, 14.0, -21.0), np.float32) / np.float32(231.0)
REACH = 4  # steps to either side that the smoothing looks at


@borrowing
def control_step(
    work: Workspace,
    scene: Scene,
    body: Body,
    chassis: Chassis,
    sampling: Sampling,
    critics: Critics,
    state: Floats,
    least: float,
    key: Integer,
    tick: Integer,
) -> int:
    """Improve ``work.mean`` (T, 3) from ``state`` (cosine, sine, vx, vy, wz) on and return for how many steps it is
    free of collision.

    Williams, Drews, Goldfain, Rehg, Theodorou, Information-Theoretic Model Predictive Control, IEEE T-RO 34(6), 2018,
    algorithm 2. Where the gap is now less than ``critics.collision_gap``, ``least`` is smaller: a robot that stands too
    near can drive away.
    """
    steps = 0
    for iteration in range(sampling.iterations):
        count = tick * sampling.iterations + iteration
        sample_rollouts(work, scene, body, chassis, sampling, critics, state, least, key, count)
        steps = update_sequence(work, scene, body, chassis, sampling, state, least)
    return steps


@borrowing
def sample_rollouts(
    work: Workspace,
    scene: Scene,
    body: Body,
    chassis: Chassis,
    sampling: Sampling,
    critics: Critics,
    state: Floats,
    least: float,
    key: Integer,
    tick: Integer,
) -> None:
    """Sample, drive and judge all control sequences: fill ``work.velocities`` and ``work.costs``."""
    for block in range(len(work.costs) // LANES):
        roll_out(work, scene, body, chassis, sampling, critics, state, least, key, tick, block)
    add_end_costs(work, scene, sampling, critics, state)


@borrowing
def update_sequence(
    work: Workspace, scene: Scene, body: Body, chassis: Chassis, sampling: Sampling, state: Floats, least: float
) -> int:
    """Move ``work.mean`` (T, 3) towards what was cheap and return for how many steps it is free of collision."""
    free = update_weights(work, sampling)
    average_rollouts(work, sampling)
    return choose_sequence(work, scene, body, chassis, sampling, state, least, free)


@inner
def roll_out(
    work: Workspace,
    scene: Scene,
    body: Body,
    chassis: Chassis,
    sampling: Sampling,
    critics: Critics,
    state: Floats,
    least: float,
    key: Integer,
    tick: Integer,
    block: int,
) -> None:
    """Sample, drive and judge one block of control sequences."""
    lanes, steps, dt = work.lanes, sampling.time_steps, sampling.dt
    start_lanes(lanes, work.fixed, block, state)
    fastest = max(max(chassis.vx_max, -chassis.vx_min), abs(state[2])) + max(chassis.vy_max, abs(state[3]))
    cover = cover_radius(body)
    share = np.float32(1.0 - critics.end_share) * critics.progress / np.float32(steps // PATH_STRIDE)
    for t in range(steps):
        if t == 0:
            draw_noise(lanes, work.normals, key, tick, block * steps, ZERO, ONE)
        elif t >= sampling.tied:
            draw_noise(lanes, work.normals, key, tick, block * steps + t, sampling.kept, sampling.renewed)
        drive_lanes(lanes, work.velocities[block, t], work.mean[max(t, sampling.tied - 1)], chassis, sampling, critics)
        add_static_cost(lanes, scene, body, critics, least, dt)
        add_moving_cost(lanes, scene, body, critics, t, fastest, cover, dt)
        if critics.goal + critics.goal_angle > ZERO:
            add_goal_cost(lanes, scene, critics.goal * dt, critics.goal_angle * dt)
        if t % PATH_STRIDE == PATH_STRIDE - 1:
            if critics.align > ZERO:
                add_alignment_cost(lanes, scene, critics.align * dt * np.float32(PATH_STRIDE))
            if share > ZERO:
                add_progress_cost(lanes, scene, share)
    if critics.progress > ZERO:
        add_progress_cost(lanes, scene, critics.end_share * critics.progress)
    begin = block * LANES
    for k in range(LANES):
        work.costs[begin + k] = lanes[COST + k]
        work.ends[0, begin + k], work.ends[1, begin + k] = lanes[X + k], lanes[Y + k]
        work.ends[2, begin + k], work.ends[3, begin + k] = lanes[COSINE + k], lanes[SINE + k]


@inner
def add_end_costs(work: Workspace, scene: Scene, sampling: Sampling, critics: Critics, state: Floats) -> None:
    """Add the distance of each end from a point ahead of the farthest path point that any end
    reaches, and its bearing from there.
    """
    if critics.follow <= ZERO and critics.angle <= ZERO:
        return
    reached = 0
    for k in range(sampling.batch_size):
        if work.costs[k] < COLLIDED:
            reached = max(reached, nearest_point(scene.path, reached, work.ends[0, k], work.ends[1, k]))
    last = len(scene.path) - 1
    follow, ahead = (
        min(reached + int(critics.follow_ahead / SPACING), last),
        min(reached + int(critics.angle_ahead / SPACING), last),
    )
    turning = (
        abs(bearing_to(state[0], state[1], scene.path[ahead, PLACE_X], scene.path[ahead, PLACE_Y]))
        > critics.angle_tolerance
    )
    for k in range(sampling.batch_size):
        x, y = work.ends[0, k], work.ends[1, k]
        dx, dy = scene.path[follow, PLACE_X] - x, scene.path[follow, PLACE_Y] - y
        work.costs[k] += critics.follow * np.sqrt(dx * dx + dy * dy)
        if turning:
            dx, dy = scene.path[ahead, PLACE_X] - x, scene.path[ahead, PLACE_Y] - y
            work.costs[k] += critics.angle * abs(bearing_to(work.ends[2, k], work.ends[3, k], dx, dy))


@inner
def bearing_to(cosine: np.float32, sine: np.float32, x: np.float32, y: np.float32) -> np.float32:
    """Return the angle from a heading to a direction, rad."""
    return np.float32(math.atan2(cosine * y - sine * x, cosine * x + sine * y))


@inner
def nearest_point(path: Floats, first: int, x: np.float32, y: np.float32) -> int:
    """Return the row of ``path`` (M, 2) from ``first`` on that is nearest to a position."""
    best, least = first, np.float32(np.inf)
    for i in range(first, len(path)):
        dx, dy = path[i, PLACE_X] - x, path[i, PLACE_Y] - y
        squared = dx * dx + dy * dy
        if squared < least:
            best, least = i, squared
    return best


@inner
def update_weights(work: Workspace, sampling: Sampling) -> int:
    """Fill the weights, the softmax of minus cost over temperature, and return how many
    roll-outs are free of collision.
    """
    least, free, total = np.inf, 0, 0.0
    for k in range(sampling.batch_size):
        least = min(least, float(work.costs[k]))
        free += work.costs[k] < COLLIDED
    for k in range(len(work.weights)):
        weight = math.exp((least - float(work.costs[k])) / sampling.temperature) if k < sampling.batch_size else 0.0
        work.weights[k] = weight
        total += float(work.weights[k])
    for k in range(len(work.weights)):
        work.weights[k] = np.float32(float(work.weights[k]) / total)
    return free


@inner
def average_rollouts(work: Workspace, sampling: Sampling) -> None:
    """Set the mean to the weighted average of the velocities reached, which no acceleration
    limit breaks: the limits are convex.
    """
    for t in range(sampling.time_steps):
        for axis in range(3):
            for k in range(LANES):
                work.lanes[k] = ZERO
            for block in range(len(work.costs) // LANES):
                begin = block * LANES
                for k in range(LANES):
                    work.lanes[k] += work.weights[begin + k] * work.velocities[block, t, axis * LANES + k]
            total = 0.0
            for k in range(LANES):
                total += float(work.lanes[k])
            work.mean[t, axis] = np.float32(total)


@inner
def choose_sequence(
    work: Workspace,
    scene: Scene,
    body: Body,
    chassis: Chassis,
    sampling: Sampling,
    state: Floats,
    least: float,
    free: int,
) -> int:
    """Keep in ``work.mean`` the smoothed mean, the mean or the cheapest roll-out: the first that stays free as long as
    the last does.

    The average of two ways round an obstacle may lead into it. Return all steps when any roll-out is free of walls,
    else those of the cheapest, which meets one with the least speed.
    """
    best = 0
    for k in range(sampling.batch_size):
        if work.costs[k] < work.costs[best]:
            best = k
    smooth_sequence(work, sampling)
    for t in range(sampling.time_steps):
        for axis in range(3):
            work.cheapest[t, axis] = work.velocities[best // LANES, t, axis * LANES + best % LANES]
    wanted = free_steps(work.cheapest, scene, body, chassis, sampling, state, least)
    if free == 0:
        copy_sequence(work.cheapest, work.mean)
        return min(wanted, sampling.time_steps - 1)
    if sampling.smoothing and free_steps(work.smoothed, scene, body, chassis, sampling, state, least) >= wanted:
        copy_sequence(work.smoothed, work.mean)
    elif free_steps(work.mean, scene, body, chassis, sampling, state, least) < wanted:
        copy_sequence(work.cheapest, work.mean)
    return sampling.time_steps


@inner
def copy_sequence(source: Floats, target: Floats) -> None:
    """Copy a sequence (T, 3): assigning slices would allocate."""
    for t in range(len(source)):
        for axis in range(3):
            target[t, axis] = source[t, axis]


@inner
def smooth_sequence(work: Workspace, sampling: Sampling) -> None:
    """Fit parabolas to nine velocities each (Savitzky, Golay 1964), those of the past and the
    last one repeated at the ends.
    """
    steps = sampling.time_steps
    for t in range(steps):
        for axis in range(3):
            total = ZERO
            for i in range(2 * REACH + 1):
                at = t + i - REACH
                total += WINDOW[i] * (work.history[REACH + at, axis] if at < 0 else work.mean[min(at, steps - 1), axis])
            work.smoothed[t, axis] = total


@inner
def free_steps(
    velocities: Floats, scene: Scene, body: Body, chassis: Chassis, sampling: Sampling, state: Floats, least: float
) -> int:
    """Return how many steps a robot that is sent ``velocities`` (T, 3) goes before it meets a wall or what
    probably is there by then.
    """
    x, y, c, s = ZERO, ZERO, state[0], state[1]
    vx, vy, wz = state[2], state[3], state[4]
    for t in range(sampling.time_steps):
        sent = velocities[max(t, sampling.tied - 1)]
        old_x, old_y, old_w = vx, vy, wz
        vx, vy = step_towards(vx, sent[0], chassis.vx_change), step_towards(vy, sent[1], chassis.vy_change)
        wz = step_towards(wz, sent[2], chassis.wz_change)
        middle = np.float32(0.25) * sampling.dt * (old_w + wz)
        along, aside = np.float32(0.5) * sampling.dt * (old_x + vx), np.float32(0.5) * sampling.dt * (old_y + vy)
        turn_c, turn_s = np.float32(math.cos(middle)), np.float32(math.sin(middle))
        c, s = c * turn_c - s * turn_s, s * turn_c + c * turn_s
        x, y = x + c * along - s * aside, y + s * along + c * aside
        c, s = c * turn_c - s * turn_s, s * turn_c + c * turn_s
        gap = outline_clearance(
            scene.window, body.outline, (scene.x + float(x), scene.y + float(y), float(c), float(s)), least
        )
        if (gap < least and gap > -float(FAR)) or (
            scene.belief[t] > BELIEVED and hits_moving(scene, body, t, x, y, c, s)
        ):
            return t
    return sampling.time_steps


@inner
def hits_moving(scene: Scene, body: Body, t: int, x: np.float32, y: np.float32, c: np.float32, s: np.float32) -> bool:
    """Return whether a robot at a pose touches where a moving obstacle is expected at step ``t``."""
    for n in range(scene.moving.shape[1]):
        for d in range(len(body.discs)):
            at_x, at_y, radius = (
                body.discs[d, PLACE_X],
                body.discs[d, PLACE_Y],
                body.discs[d, RADIUS] + scene.moving[t, n, RADIUS],
            )
            dx = x + c * at_x - s * at_y - scene.moving[t, n, PLACE_X]
            dy = y + s * at_x + c * at_y - scene.moving[t, n, PLACE_Y]
            if dx * dx + dy * dy < radius * radius:
                return True
    return False
