"""Speed of one MPPI control step, 2000 roll-outs of 56 steps among walls and ten moving
obstacles, against the same step in numpy.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from timing import interleave

from arena_core import Costmap, Observation, Path, Pose, Tracks, Twist
from arena_core.testing import samples
from arena_kernels.distance import distance_field
from arena_mppi.optimizer import PATH_STRIDE
from arena_mppi.planner import MppiPlanner
from arena_mppi.scene import Scene, scene_of, static_window

CALLS = 4  # a timing
PEOPLE = 10
STATE = (0.2, 0.8, 0.0, 0.1)  # heading, vx, vy, wz
COLLISION_COST = 1e6


def make_observation(body: Any) -> Observation:
    """Return what a robot sees in a 6 m window with posts, ten people and a path straight through."""
    generator = np.random.default_rng(1)
    lethal = np.zeros((120, 120), np.bool_)
    for row, column in generator.integers(0, 117, (40, 2)):
        lethal[row : row + 3, column : column + 3] = True
    lethal[54:66, 54:66] = False
    costmap = Costmap(
        np.where(lethal, 254, 0).astype(np.uint8), distance_field(lethal, 0.05), 0.05, np.array((-3.0, -3.0))
    )
    positions, velocities = generator.uniform(-2.5, 2.5, (PEOPLE, 2)), generator.uniform(-1.0, 1.0, (PEOPLE, 2))
    covariances = np.tile(0.01 * np.eye(4), (PEOPLE, 1, 1))
    tracks = Tracks(np.arange(PEOPLE, dtype=np.int32), positions, velocities, np.full(PEOPLE, 0.3), covariances)
    path = Path(np.column_stack((np.linspace(0.0, 5.0, 51), np.zeros(51), np.zeros(51))))
    here, goal = Pose(0.0, 0.0, STATE[0]), Pose(5.0, 0.0)
    scan = samples.scan(here, body)
    twist = Twist(*STATE[1:])
    return Observation(
        0.0, here, np.zeros((3, 3)), twist, scan, goal, goal, path, None, lambda: costmap, lambda: tracks
    )


class NumpyStep:
    """The same control step, every operation on all roll-outs at once; polygons count as the discs that cover them."""

    def __init__(self, planner: MppiPlanner, observation: Observation) -> None:
        self.sampling, self.chassis = planner._sampling, planner._chassis  # noqa: SLF001 - the planner measured
        self.body = planner._body  # noqa: SLF001 - the planner measured
        self.critics = planner._weighted_critics(observation)  # noqa: SLF001 - the planner measured
        self.planner, self.observation = planner, observation
        self.generator = np.random.default_rng(0)
        self.mean = np.tile(np.array((0.8, 0.0, 0.1), np.float32), (self.sampling.time_steps, 1))

    def __call__(self) -> np.ndarray:
        """Return the new mean; the scene is the planner's own, its preparation counts for both."""
        scene = self.planner._build_scene(self.observation)  # noqa: SLF001 - the planner measured
        velocities, poses = self.sample_rollouts()
        costs = self.rollout_costs(scene, velocities, poses)
        weights = np.exp(-(costs - costs.min()) / float(self.sampling.temperature))
        return np.tensordot(weights / weights.sum(), velocities, axes=(0, 1))

    def sample_rollouts(self) -> tuple[np.ndarray, np.ndarray]:
        """Sample and drive: velocities and poses, (T, K, 3) each."""
        s, c = self.sampling, self.chassis
        shape = (s.time_steps, s.batch_size, 3)
        noise = self.generator.standard_normal(shape, np.float32) * np.array((s.vx_std, s.vy_std, s.wz_std), np.float32)
        low = np.array((c.vx_min, -c.vy_max, -c.wz_max))
        high = np.array((c.vx_max, c.vy_max, c.wz_max))
        change = np.array((c.vx_change, c.vy_change, c.wz_change))
        velocities, poses = np.empty(shape, np.float32), np.empty(shape, np.float32)
        velocity, pose = (
            np.tile(np.array(STATE[1:], np.float32), (shape[1], 1)),
            np.tile(np.float32((0.0, 0.0, STATE[0])), (shape[1], 1)),
        )
        for t in range(s.time_steps):
            if t:
                noise[t] = s.kept * noise[t - 1] + s.renewed * noise[t]
            before, wanted = velocity, np.clip(self.mean[t] + noise[t], low, high)
            velocity = before + np.clip(wanted - before, -change, change)
            moved = 0.5 * s.dt * (before + velocity)
            heading = pose[:, 2] + 0.5 * moved[:, 2]
            cosine, sine = np.cos(heading), np.sin(heading)
            along, aside = moved[:, 0], moved[:, 1]
            pose = pose + np.column_stack((cosine * along - sine * aside, sine * along + cosine * aside, moved[:, 2]))
            velocities[t], poses[t] = velocity, pose
        return velocities, poses

    def rollout_costs(self, scene: Scene, velocities: np.ndarray, poses: np.ndarray) -> np.ndarray:
        """Return the cost of each roll-out, (K,)."""
        k, dt = self.critics, float(self.sampling.dt)
        cosine, sine = np.cos(poses[..., 2]), np.sin(poses[..., 2])
        gap, costs = np.full(cosine.shape, np.inf, np.float32), np.zeros(cosine.shape[1], np.float32)
        for x, y, radius in self.body.discs:
            at_x, at_y = poses[..., 0] + cosine * x - sine * y, poses[..., 1] + sine * x + cosine * y
            gap = np.minimum(
                gap,
                interpolate_field(scene.gaps, at_x, at_y, scene.gaps_x, scene.gaps_y, scene.gaps_resolution) - radius,
            )
            for n in range(scene.moving.shape[1]):
                other = scene.moving[:, n, :, None]
                lack = np.maximum(
                    0.0, 1.0 - (np.hypot(at_x - other[:, 0], at_y - other[:, 1]) - radius - other[:, 2]) / k.margin
                )
                believed = scene.belief[:, None] * (k.moving * lack**2 + k.contact * np.where(lack > 1.0, lack, 0.0))
                costs += dt * believed.sum(axis=0)
        short, near = np.maximum(gap, 0.0) / k.inflation_radius, np.maximum(gap, 0.0) / k.near_collision_gap
        costs += dt * (k.static * np.maximum(0.0, 1.0 - short) ** 2 + k.critical * np.maximum(0.0, 1.0 - near)).sum(
            axis=0
        )
        costs += COLLISION_COST * (gap < k.collision_gap).any(axis=0)
        costs += dt * (k.forward * np.maximum(0.0, -velocities[..., 0]) + k.twirling * np.abs(velocities[..., 2])).sum(
            axis=0
        )
        control = self.sampling.gamma * self.mean[:, None] * (velocities - self.mean[:, None])
        costs += (control[..., 0] / self.sampling.vx_std**2 + control[..., 2] / self.sampling.wz_std**2).sum(axis=0)
        x, y = poses[PATH_STRIDE - 1 :: PATH_STRIDE, :, 0], poses[PATH_STRIDE - 1 :: PATH_STRIDE, :, 1]
        left = interpolate_field(scene.left, x, y, scene.left_x, scene.left_y, scene.left_resolution)
        costs += k.progress * ((1.0 - k.end_share) * left.mean(axis=0) + k.end_share * left[-1])
        travelled = np.cumsum(np.hypot(velocities[..., 0], velocities[..., 1]) * dt, axis=0)[
            PATH_STRIDE - 1 :: PATH_STRIDE
        ]
        points = scene.path[np.minimum((travelled / 0.05).astype(np.int64), len(scene.path) - 1)]
        costs += k.align * dt * PATH_STRIDE * np.hypot(x - points[..., 0], y - points[..., 1]).sum(axis=0)
        return costs + self.bearing_costs(scene, poses[-1])

    def bearing_costs(self, scene: Scene, ends: np.ndarray) -> np.ndarray:
        """Return what the bearing of a path point ahead costs each end, (K,)."""
        distances = np.hypot(ends[:, None, 0] - scene.path[:, 0], ends[:, None, 1] - scene.path[:, 1])
        ahead = scene.path[min(int(distances.argmin(axis=1).max()) + 10, len(scene.path) - 1)]
        if abs(math.atan2(ahead[1], ahead[0]) - STATE[0]) < self.critics.angle_tolerance:
            return np.zeros(len(ends), np.float32)
        off = np.arctan2(ahead[1] - ends[:, 1], ahead[0] - ends[:, 0]) - ends[:, 2]
        return self.critics.angle * np.abs((off + math.pi) % (2.0 * math.pi) - math.pi)


def interpolate_field(
    field: np.ndarray, x: np.ndarray, y: np.ndarray, left: float, low: float, side: float
) -> np.ndarray:
    """Return a field's values between the centres of the four cells around each place."""
    u = np.clip((x - left) / side - 0.5, 0.0, field.shape[1] - 1.001)
    v = np.clip((y - low) / side - 0.5, 0.0, field.shape[0] - 1.001)
    column, row = u.astype(np.int64), v.astype(np.int64)
    u, v = u - column, v - row
    below = field[row, column] * (1.0 - u) + field[row, column + 1] * u
    above = field[row + 1, column] * (1.0 - u) + field[row + 1, column + 1] * u
    return below * (1.0 - v) + above * v


def measure() -> list[dict[str, Any]]:
    """Return the median user CPU time of whole control steps, each with its peer, and of the
    preparation of the scene.
    """
    functions: dict[str, Callable[[], Any]] = {}
    for name in ("turtlebot3", "jackal"):
        body = samples.component("robot", name)
        planner, seen = samples.planner("mppi", body, robot_preset=name), make_observation(body)
        functions[name] = partial(planner.compute_velocity, seen)
        functions[f"numpy {name}"] = NumpyStep(planner, seen)
    window = static_window(seen, 0.1)
    reach = 5.0
    body, critics = planner._body, planner._critics  # noqa: SLF001 - the very parts of the planner that is measured
    scene = partial(scene_of, seen, window, body, critics.moving, critics.progress, 0.05, 56, reach)
    functions["scene"] = scene
    times = interleave({name: partial(_repeat_calls, function) for name, function in functions.items()}, repeats=7)
    ms = {name: float(np.median(seconds)) / CALLS * 1e3 for name, seconds in times.items()}
    rows = []
    for name in ("turtlebot3", "jackal"):
        what = f"MPPI control step, 2000 x 56, {PEOPLE} moving obstacles, {name}"
        ours, theirs = ms[name], ms[f"numpy {name}"]
        peer = {"peer": "vectorised numpy", "peer_ms": theirs, "ratio": ours / theirs, "goal": 0.2, "unit": "x peer"}
        rows += [{"what": what, "ours_ms": ours, **peer}, _single_row(what + ", at most", ours, 10.0)]
    return [*rows, _single_row("  of which walls, way left and predictions", ms["scene"], 1.0)]


def _single_row(what: str, ours: float, goal: float) -> dict[str, Any]:
    return {"what": what, "ours_ms": ours, "peer": None, "peer_ms": None, "ratio": None, "goal": goal, "unit": "ms"}


def _repeat_calls(function: Callable[[], Any]) -> None:
    for _ in range(CALLS):
        function()


if __name__ == "__main__":
    for row in measure():
        peer = f"{row['peer']} {row['peer_ms']:.1f} ms, ratio {row['ratio']:.3f}" if row["peer"] else ""
        print(f"{row['what']:70} {row['ours_ms']:.2f} ms  {peer:45} goal {row['goal']:.3f} {row['unit']}")
