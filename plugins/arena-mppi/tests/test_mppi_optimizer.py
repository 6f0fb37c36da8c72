"""The compiled control step against the same step in plain Python, one roll-out after the other in double precision."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import NO_TRACKS, Footprint, Pose
from arena_kernels.costmap_window import distance_at, outline_clearance
from arena_kernels.random import uniform
from arena_mppi.critics import COLLIDED, COLLISION_COST, SPACING
from arena_mppi.optimizer import PATH_STRIDE, control_step
from arena_mppi.parameters import Chassis, Critics
from arena_mppi.rollout import LANES
from arena_mppi.sampling import fixed_lanes, make_workspace, sampling_of
from arena_mppi.scene import body_of, scene_of, static_window
from arena_mppi.settings import Moving, Noise, Optimisation, Progress

MOVING = Moving(
    weight=20.0,
    contact_cost=300.0,
    margin=0.5,
    reaction_time=0.1,
    belief_time=2.0,
    growth=1.0,
    growth_max=0.3,
    speed_min=0.1,
)
PROGRESS = Progress(weight=8.0, end_share=0.5, comfort_gap=0.4, comfort_cost=2.0, blocked_cost=20.0)
CRITICS = Critics(
    *map(
        np.float32,
        (
            4.0,
            0.5,
            30.0,
            0.1,
            0.05,
            0.03,
            20.0,
            300.0,
            0.5,
            0.1,
            5.0,
            2.0,
            3.0,
            5.0,
            0.3,
            2.0,
            0.2,
            0.1,
            8.0,
            0.5,
            4.0,
            5.0,
            0.2,
        ),
    )
)
NOISE = Noise(vx_std=0.4, vy_std=0.4, wz_std=0.3, correlation_time=0.3)
BODIES = [
    body_of(Footprint.circle(0.2)),
    body_of(Footprint.polygon([[0.21, -0.165], [0.21, 0.165], [-0.21, 0.165], [-0.21, -0.165]])),
]
STEPS, DT, KEY, TICK, LEAST = 16, 0.05, 12345, 7, 0.03


def chassis_of(curvature=0.0, vy_max=0.5):
    at_rest = 0.0 if curvature > 0.0 else math.inf
    return Chassis(*map(np.float32, (-0.5, 1.0, vy_max, 2.0, 0.1, 0.1, 0.2, at_rest, curvature)))


def optimisation(batch_size, temperature, gamma, smoothing):
    return Optimisation(batch_size, STEPS, DT, 1, temperature, gamma, smoothing, 0.1)


def problem(
    scene, body, chassis, twist=(0.5, 0.0, 0.2), batch_size=100, temperature=0.3, smoothing=False, seed=0, white=False
):
    """Return workspace, arguments of the control step and the mean that it begins with."""
    noise = replace(NOISE, correlation_time=0.0) if white else NOISE
    sampling = sampling_of(chassis, noise, optimisation(batch_size, temperature, 0.015, smoothing))._replace(tied=2)
    work = make_workspace(sampling, chassis, 0.1)
    generator = np.random.default_rng(seed)
    work.normals[:] = generator.standard_normal(len(work.normals), np.float32)
    work.mean[:] = generator.uniform(-0.3, 0.6, (STEPS, 3)) * (1.0, float(chassis.vy_max), 1.0)
    work.history[:] = twist
    state = np.array((math.cos(0.3), math.sin(0.3), *twist), np.float32)
    return work, (scene, body, chassis, sampling, CRITICS, state, LEAST, KEY, TICK), work.mean.astype(float)


def clip(value, low, high):
    return min(max(value, low), high)


def tightest(chassis, vx):
    return float(chassis.turn_at_rest) + float(chassis.curvature) * abs(vx)


def driven(work, mean, chassis, sampling, state, lane):
    """Return the poses (T, 4), velocities (T, 3) and control cost of one roll-out, in plain Python."""
    block, k = divmod(lane, LANES)
    follows, noisy, *own = (float(row[lane]) for row in work.fixed)
    std = [float(sampling.vx_std), float(sampling.vy_std), float(sampling.wz_std)]
    limits = [(chassis.vx_min, chassis.vx_max), (-chassis.vy_max, chassis.vy_max), (-chassis.wz_max, chassis.wz_max)]
    changes = [chassis.vx_change, chassis.vy_change, chassis.wz_change]
    noise, velocity, pose = [0.0] * 3, [float(v) for v in state[2:]], [0.0, 0.0, math.atan2(state[1], state[0])]
    poses, velocities, control = [], [], 0.0
    for t in range(STEPS):
        if t == 0 or t >= sampling.tied:
            kept, renewed = (0.0, 1.0) if t == 0 else (float(sampling.kept), float(sampling.renewed))
            places = [
                int(uniform(KEY, TICK, 3 * (block * STEPS + t) + axis) * (len(work.normals) - LANES))
                for axis in range(3)
            ]
            noise = [
                kept * e + renewed * float(work.normals[place + k]) for e, place in zip(noise, places, strict=True)
            ]
        target = mean[max(t, sampling.tied - 1)]
        before = list(velocity)
        for axis in range(3):
            wanted = follows * target[axis] + noisy * std[axis] * noise[axis] + own[axis]
            wanted = clip(wanted, *map(float, limits[axis]))
            velocity[axis] += clip(wanted - velocity[axis], -float(changes[axis]), float(changes[axis]))
            if std[axis] > 0.0:
                last = velocity[axis]
                if axis == 2:
                    last = clip(last, -tightest(chassis, velocity[0]), tightest(chassis, velocity[0]))
                control += 0.015 * target[axis] / std[axis] ** 2 * (last - target[axis])
        velocity[2] = clip(velocity[2], -tightest(chassis, velocity[0]), tightest(chassis, velocity[0]))
        along, aside, turn = (0.5 * DT * (old + new) for old, new in zip(before, velocity, strict=True))
        middle = pose[2] + 0.5 * turn
        pose[0] += along * math.cos(middle) - aside * math.sin(middle)
        pose[1] += along * math.sin(middle) + aside * math.cos(middle)
        pose[2] += turn
        poses.append((*pose, math.hypot(along, aside)))
        velocities.append(list(velocity))
    return np.array(poses), np.array(velocities), control


def judged(scene, body, chassis, poses, velocities):
    """Return what the critics along the way say of one roll-out."""
    cost, travelled, hit = 0.0, np.cumsum(poses[:, 3]), False
    for t, ((x, y, theta, _), (vx, vy, wz)) in enumerate(zip(poses, velocities, strict=True)):
        c, s = math.cos(theta), math.sin(theta)
        cost += DT * (4.0 * (max(0.0, vx - 1.0) + max(0.0, -0.5 - vx)) + 5.0 * max(0.0, -vx) + 0.2 * abs(wz))
        discs = [
            (x + c * float(px) - s * float(py), y + s * float(px) + c * float(py), float(r)) for px, py, r in body.discs
        ]
        if not hit:
            gap = min(distance_at(scene.window, scene.x + px, scene.y + py) - r for px, py, r in discs)
            felt = max(gap - 0.05 * math.hypot(vx, vy), 0.0)
            cost += DT * (4.0 * max(0.0, 1.0 - felt / 0.5) ** 2 + 30.0 * max(0.0, 1.0 - felt / 0.1))
            if (
                gap < LEAST
                and outline_clearance(scene.window, body.outline, (scene.x + x, scene.y + y, c, s), LEAST) < LEAST
            ):
                cost, hit = cost + float(COLLISION_COST) * (1.0 + math.hypot(vx, vy)), True
        for other_x, other_y, other_radius in scene.moving[t].astype(float):
            for px, py, r in discs:
                lack = max(
                    0.0,
                    1.0 - (math.hypot(px - other_x, py - other_y) - r - other_radius - 0.1 * math.hypot(vx, vy)) / 0.5,
                )
                cost += float(scene.belief[t]) * DT * (20.0 * lack**2 + (300.0 * lack if lack > 1.0 else 0.0))
        cost += DT * 5.0 * math.hypot(x - scene.goal[0], y - scene.goal[1])
        cost += DT * 2.0 * (1.0 - c * float(scene.goal[2]) - s * float(scene.goal[3]))
        if t % PATH_STRIDE == PATH_STRIDE - 1:
            point = scene.path[min(int(travelled[t] / float(SPACING)), len(scene.path) - 1)]
            cost += 3.0 * DT * PATH_STRIDE * math.hypot(x - point[0], y - point[1])
            cost += 0.0 if hit else 4.0 / (STEPS // PATH_STRIDE) * left_at(scene, x, y)
    return cost + (0.0 if hit else 4.0 * left_at(scene, *poses[-1, :2])), hit


def left_at(scene, x, y):
    rows, columns = scene.left.shape
    u, v = (x - float(scene.left_x)) / 0.1 - 0.5, (y - float(scene.left_y)) / 0.1 - 0.5
    column, row = clip(int(u), 0, columns - 2), clip(int(v), 0, rows - 2)
    right, up = u - column, v - row
    corners = scene.left[row : row + 2, column : column + 2].astype(float)
    return (corners[0] @ (1.0 - right, right)) * (1.0 - up) + (corners[1] @ (1.0 - right, right)) * up


def ended(scene, work, mean_theta, costs, poses):
    """Return what the critics of the ends add to each roll-out."""
    ends = poses[:, -1, :3]
    path, reached = scene.path.astype(float), 0
    for k in range(len(ends)):
        if costs[k] < COLLIDED:
            reached = max(reached, reached + int(np.argmin(np.hypot(*(path[reached:] - ends[k, :2]).T))))
    follow, ahead = (path[min(reached + int(np.float32(metres) / SPACING), len(path) - 1)] for metres in (0.3, 0.2))
    added = 5.0 * np.hypot(*(ends[:, :2] - follow).T)
    bearing = math.remainder(math.atan2(ahead[1], ahead[0]) - mean_theta, 2.0 * math.pi)
    if abs(bearing) > 0.1:
        off = np.arctan2(*(ahead - ends[:, :2]).T[::-1]) - ends[:, 2]
        added += 2.0 * np.abs((off + math.pi) % (2.0 * math.pi) - math.pi)
    return added


@pytest.mark.slow
@settings(derandomize=True, deadline=None, max_examples=12)
@given(
    boxes=st.lists(st.tuples(st.integers(0, 112), st.integers(0, 112)), max_size=12),
    rows=st.lists(st.tuples(*[st.floats(-1.5, 1.5)] * 2, *[st.floats(-1.0, 1.0)] * 2), max_size=3),
    body=st.sampled_from(BODIES),
    curvature=st.sampled_from([0.0, 1.5]),
    seed=st.integers(0, 100),
)
def test_roll_outs_and_costs_agree_with_plain_python(boxes, rows, body, curvature, seed, costmap_of, observe, people):
    lethal = np.zeros((121, 121), np.bool_)
    lethal[0, 0] = True
    for row, column in boxes:
        lethal[row : row + 8, column : column + 8] = True
    view = observe(
        costmap_of(lethal),
        Pose(0.01, 0.02, 0.3),
        [(0.05 * k, 0.01 * k) for k in range(50)],
        tracks=people(*rows) if rows else NO_TRACKS,
    )
    scene = scene_of(view, static_window(view, 0.1), body, MOVING, PROGRESS, DT, STEPS, 3.0)
    chassis = chassis_of(curvature, 0.0 if curvature > 0.0 else 0.5)
    work, arguments, mean = problem(scene, body, chassis, seed=seed)
    sampling, state = arguments[3], arguments[5]
    control_step(work, *arguments)
    lanes = range(sampling.batch_size)
    outcomes = [driven(work, mean, chassis, sampling, state, lane) for lane in lanes]
    np.testing.assert_allclose(
        [work.velocities[0, :, lane::LANES] for lane in lanes], [v for _, v, _ in outcomes], atol=2e-5
    )
    verdicts = [judged(scene, body, chassis, poses, velocities) for poses, velocities, _ in outcomes]
    costs = np.array([cost for cost, _ in verdicts]) + [control for _, _, control in outcomes]
    costs += ended(scene, work, 0.3, costs, np.array([poses for poses, _, _ in outcomes]))
    agreed = np.isclose(work.costs[: sampling.batch_size], costs, rtol=2e-3, atol=5e-3)
    assert agreed.mean() >= 0.97  # a roll-out may graze a wall, a radius or a path point by a rounding error


def open_scene(observe, costmap, body, rows=(), people=None):
    view = observe(
        costmap(),
        Pose(0.0, 0.0, 0.3),
        [(0.05 * k, 0.0) for k in range(50)],
        tracks=people(*rows) if rows else NO_TRACKS,
    )
    return scene_of(view, static_window(view, 0.1), body, MOVING, PROGRESS, DT, STEPS, 3.0)


def test_weights_sum_to_one_and_fall_with_cost(observe, costmap):
    work, arguments, _ = problem(
        open_scene(observe, costmap, BODIES[0]), BODIES[0], chassis_of(), batch_size=700, temperature=2.0
    )
    assert control_step(work, *arguments) == STEPS
    assert work.weights.sum() == pytest.approx(1.0, abs=1e-5)
    assert (work.weights[700:] == 0.0).all()
    order = np.argsort(work.costs[:700])
    assert (np.diff(work.weights[:700][order]) <= 0.0).all()
    np.testing.assert_allclose(
        work.weights[order[0]] / work.weights[order[9]], np.exp(np.ptp(work.costs[order[:10]]) / 2.0), rtol=1e-3
    )


def driven_lanes(work):
    """Return the velocities of all roll-outs, (T, 3, lanes)."""
    return work.velocities.reshape(-1, STEPS, 3, LANES).transpose(1, 2, 0, 3).reshape(STEPS, 3, -1)


def test_the_mean_is_the_weighted_average_of_what_was_driven(observe, costmap):
    work, arguments, _ = problem(
        open_scene(observe, costmap, BODIES[0]), BODIES[0], chassis_of(), batch_size=700, temperature=2.0
    )
    control_step(work, *arguments)
    np.testing.assert_allclose(work.mean, driven_lanes(work) @ work.weights, atol=1e-5)


def test_the_mean_becomes_cheaper_from_step_to_step(observe, costmap):
    work, arguments, _ = problem(open_scene(observe, costmap, BODIES[0]), BODIES[0], chassis_of(), batch_size=1000)
    costs = []
    for tick in range(6):
        control_step(work, *arguments[:-1], tick)
        costs.append(work.costs[0])  # lane 0 drives the mean as it was
    assert costs[-1] < costs[0] - 1.0
    assert costs[-1] < np.median(work.costs[:1000])


def test_smoothing_damps_what_jitters(observe, costmap):
    scene = open_scene(observe, costmap, BODIES[0])
    work, arguments, _ = problem(
        scene, BODIES[0], chassis_of(), smoothing=True, batch_size=300, temperature=10.0, white=True
    )
    control_step(work, *arguments)
    np.testing.assert_array_equal(work.mean, work.smoothed)
    average = driven_lanes(work) @ work.weights
    jitter = [np.abs(np.diff(sequence[:, 2], n=2)).mean() for sequence in (work.smoothed, average)]
    assert jitter[0] < 0.5 * jitter[1]


def test_average_of_two_ways_round_a_post_is_not_driven(observe, costmap):
    """Ways left and right of a post cost the same; their average would hit it."""
    view = observe(costmap((0.65, 0.75, -0.05, 0.05)), Pose(0.0, 0.0, 0.0), [(0.05 * k, 0.0) for k in range(50)])
    scene = scene_of(view, static_window(view, 0.1), BODIES[0], MOVING, PROGRESS, DT, STEPS, 3.0)
    chassis = chassis_of()
    sampling = sampling_of(chassis, NOISE, optimisation(2000, 1e3, 0.0, True))._replace(tied=2)
    work = make_workspace(sampling, chassis, 0.0)
    work.normals[:] = np.random.default_rng(1).standard_normal(len(work.normals), np.float32)
    work.mean[:] = work.history[:] = (1.0, 0.0, 0.0)
    state = np.array((1.0, 0.0, 1.0, 0.0, 0.0), np.float32)
    assert control_step(work, scene, BODIES[0], chassis, sampling, CRITICS, state, LEAST, KEY, TICK) == STEPS
    assert 0 < (work.costs[:2000] > COLLIDED).sum() < 2000
    np.testing.assert_array_equal(work.mean, work.cheapest)


def test_noise_has_the_spread_and_the_memory_it_is_told():
    chassis = Chassis(*map(np.float32, (-100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, math.inf, 0.0)))
    sampling = sampling_of(chassis, NOISE, optimisation(4096, 0.3, 0.0, False))
    assert float(sampling.kept) == pytest.approx(math.exp(-DT / 0.3))
    assert float(sampling.kept) ** 2 + float(sampling.renewed) ** 2 == pytest.approx(1.0)
    assert float(sampling.vx_std) == pytest.approx(40.0)


def test_lanes_that_are_fixed_cover_all_speeds():
    fixed = fixed_lanes(1000, 1024, chassis_of(), 0.2)
    assert (fixed[:2, :2] == ((1.0, 0.0), (0.0, 0.0))).all()
    assert (fixed[2:, :2] == 0.0).all()
    arcs = fixed[:, 2:200]
    assert (arcs[:2] == 0.0).all()
    assert arcs[2].min() < -0.45 < 0.95 < arcs[2].max()
    assert np.abs(np.histogram2d(arcs[2], arcs[4], bins=3)[0] / arcs.shape[1] - 1.0 / 9.0).max() < 0.04
    assert (fixed[0, 202:] == 1.0).all()
