"""Some roll-outs of a batch as ways in ``map``, for who watches."""

from __future__ import annotations

import math

import numpy as np

from arena_core import Candidate, Pose
from arena_mppi.critics import COLLIDED
from arena_mppi.parameters import Doubles, Floats, Sampling, Workspace
from arena_mppi.rollout import LANES

SHOWN = 23  # roll-outs that are told, besides the driven sequence: evenly by the order of their costs


def rollout_candidates(work: Workspace, sampling: Sampling, pose: Pose, now: Floats, drives: bool) -> list[Candidate]:
    """Return roll-outs that began at ``pose`` with velocity ``now`` (3,), and the
    sequence where the robot ``drives`` it.
    """
    costs = work.costs[: sampling.batch_size].astype(np.float64)
    ranked = np.argsort(costs, kind="stable")
    some = ranked[np.unique(np.linspace(0, len(ranked) - 1, min(SHOWN, len(ranked))).round().astype(np.int64))]
    velocities = rollout_velocities(work, sampling)
    ways = rollout_poses(velocities[some].astype(np.float64), pose, now, float(sampling.dt))[..., :2]
    told = [
        Candidate(way, math.inf if costs[k] >= COLLIDED else float(costs[k])) for way, k in zip(ways, some, strict=True)
    ]
    if not drives:
        return told
    (driven,) = rollout_poses(work.mean[None].astype(np.float64), pose, now, float(sampling.dt))[..., :2]
    return [Candidate(driven, math.nan, True), *told]


def rollout_velocities(work: Workspace, sampling: Sampling) -> Floats:
    """Return the velocities reached in all roll-outs, (B L, T, 3)."""
    steps = sampling.time_steps
    return work.velocities.reshape(-1, steps, 3, LANES).transpose(0, 3, 1, 2).reshape(-1, steps, 3)


def rollout_poses(velocities: Doubles, pose: Pose, now: Floats, dt: float) -> Doubles:
    """Return where robots are (K, T + 1, 3) that reach ``velocities`` (K, T, 3) one step after the other,
    with even changes between.
    """
    before = np.concatenate(
        (np.broadcast_to(now.astype(np.float64), (len(velocities), 1, 3)), velocities[:, :-1]), axis=1
    )
    along, aside, turning = np.moveaxis(0.5 * dt * (before + velocities), 2, 0)
    turned = pose.theta + np.cumsum(turning, axis=1) - 0.5 * turning  # in the middle of each step
    c, s = np.cos(turned), np.sin(turned)
    steps = np.stack((c * along - s * aside, s * along + c * aside, turning), axis=2)
    start = np.broadcast_to(pose.array(), (len(velocities), 1, 3))
    return np.concatenate((start, start + np.cumsum(steps, axis=1)), axis=1)
