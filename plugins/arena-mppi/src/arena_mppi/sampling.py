"""How control sequences are drawn, and the memory for them."""

from __future__ import annotations

import math

import numpy as np

from arena_mppi.parameters import Chassis, Doubles, Floats, Sampling, Workspace
from arena_mppi.rollout import LANES, ROWS
from arena_mppi.settings import Noise, Optimisation

TABLE = 1 << 18  # normal numbers of an episode; each row of noise begins at a random place of the table
HISTORY = 4  # velocities before now that the smoothing looks at
STILL = 2  # roll-outs that are always there: the mean as it is, and braking


def sampling_of(chassis: Chassis, noise: Noise, optimisation: Optimisation) -> Sampling:
    """Return how sequences are drawn; deviations follow an Ornstein-Uhlenbeck process of ``noise.correlation_time``."""
    dt = optimisation.model_dt
    kept = math.exp(-dt / noise.correlation_time) if noise.correlation_time > 0.0 else 0.0
    return Sampling(
        batch_size=optimisation.batch_size,
        time_steps=optimisation.time_steps,
        tied=1,
        iterations=optimisation.iterations,
        dt=np.float32(dt),
        vx_std=np.float32(noise.vx_std * chassis.vx_max),
        vy_std=np.float32(noise.vy_std * chassis.vy_max),
        wz_std=np.float32(noise.wz_std * chassis.wz_max),
        kept=np.float32(kept),
        renewed=np.float32(math.sqrt(1.0 - kept * kept)),
        temperature=np.float32(optimisation.temperature),
        gamma=np.float32(optimisation.gamma),
        smoothing=optimisation.smoothing,
    )


def make_workspace(sampling: Sampling, chassis: Chassis, arcs: float) -> Workspace:
    """Return the memory of a control step; a part ``arcs`` of the batch tries constant velocities."""
    blocks, steps = -(-sampling.batch_size // LANES), sampling.time_steps
    lanes = blocks * LANES
    return Workspace(
        np.zeros(TABLE, np.float32),
        fixed_lanes(sampling.batch_size, lanes, chassis, arcs),
        np.zeros(ROWS * LANES, np.float32),
        np.zeros((blocks, steps, 3 * LANES), np.float32),
        np.zeros(lanes, np.float32),
        np.zeros(lanes, np.float32),
        np.zeros((4, lanes), np.float32),
        np.zeros((steps, 3), np.float32),
        np.zeros((steps, 3), np.float32),
        np.zeros((steps, 3), np.float32),
        np.zeros((HISTORY, 3), np.float32),
    )


def fixed_lanes(batch_size: int, lanes: int, chassis: Chassis, arcs: float) -> Floats:
    """Return for each lane how much of mean and noise it takes and a velocity of its own (vx, vy, wz), (5, lanes).

    Lane 0 is the mean, lane 1 brakes, then come the arcs; half of the others deviate less, to refine.
    """
    fixed = np.zeros((5, lanes), np.float32)
    fixed[0], fixed[1] = 1.0, np.where(np.arange(lanes) % 2 == 0, 1.0, 0.4)
    count = min(STILL + round(arcs * batch_size), lanes)
    fixed[0, 1:count], fixed[1, :count] = 0.0, 0.0
    spread = low_discrepancy(max(0, count - STILL))
    fixed[2, STILL:count] = chassis.vx_min + spread[:, 0] * (chassis.vx_max - chassis.vx_min)
    fixed[3, STILL:count] = (2.0 * spread[:, 1] - 1.0) * chassis.vy_max
    fixed[4, STILL:count] = (2.0 * spread[:, 2] - 1.0) * chassis.wz_max
    return fixed


def low_discrepancy(count: int) -> Doubles:
    """Return ``count`` evenly scattered points of the unit cube, (count, 3): a Kronecker sequence with the
    powers of its golden ratio.
    """
    ratio = 1.2207440846057596  # the root of x^4 = x + 1
    return np.modf((np.arange(count)[:, None] + 1.0) * ratio ** -np.arange(1.0, 4.0))[0]
