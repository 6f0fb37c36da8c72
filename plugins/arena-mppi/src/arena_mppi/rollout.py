"""Roll-outs: a block of sampled control sequences is driven through the motion model side by side, one lane each.

All that a block knows lies in one flat array whose rows have a length that the compiler knows: so it sees that rows do
not overlap and keeps eight or sixteen lanes in a vector register.
"""

from __future__ import annotations

import numpy as np

from arena_kernels.compiled import inlined, inner
from arena_kernels.random import uniform
from arena_kernels.scalars import Integer
from arena_mppi.parameters import Chassis, Critics, Floats, Sampling

LANES = 256
X, Y, COSINE, SINE, VX, VY, WZ = 0, 1 * LANES, 2 * LANES, 3 * LANES, 4 * LANES, 5 * LANES, 6 * LANES
NOISE_X, NOISE_Y, NOISE_W = 7 * LANES, 8 * LANES, 9 * LANES
FOLLOWS, NOISY, FIXED_X, FIXED_Y, FIXED_W = 10 * LANES, 11 * LANES, 12 * LANES, 13 * LANES, 14 * LANES
COST, TRAVELLED, HIT, SPEED, GAP = 15 * LANES, 16 * LANES, 17 * LANES, 18 * LANES, 19 * LANES
COLUMN, ROW, RIGHT, UP = 20 * LANES, 21 * LANES, 22 * LANES, 23 * LANES  # where a point of the body lies in a field
ROWS = 24

ZERO, HALF, ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
SIXTH, TWELFTH, TWENTIETH = np.float32(1.0 / 6.0), np.float32(1.0 / 12.0), np.float32(1.0 / 20.0)


@inner
def start_lanes(lanes: Floats, fixed: Floats, block: int, state: Floats) -> None:
    """Put every lane of a block at the origin with ``state``: cosine and sine of the heading, vx, vy, wz."""
    for k in range(LANES):
        lanes[X + k], lanes[Y + k], lanes[COSINE + k], lanes[SINE + k] = ZERO, ZERO, state[0], state[1]
        lanes[VX + k], lanes[VY + k], lanes[WZ + k] = state[2], state[3], state[4]
        lanes[NOISE_X + k], lanes[NOISE_Y + k], lanes[NOISE_W + k] = ZERO, ZERO, ZERO
        lanes[COST + k], lanes[TRAVELLED + k], lanes[HIT + k] = ZERO, ZERO, ZERO
        lanes[FOLLOWS + k], lanes[NOISY + k] = fixed[0, block * LANES + k], fixed[1, block * LANES + k]
        lanes[FIXED_X + k], lanes[FIXED_Y + k] = fixed[2, block * LANES + k], fixed[3, block * LANES + k]
        lanes[FIXED_W + k] = fixed[4, block * LANES + k]


@inner
def draw_noise(
    lanes: Floats, normals: Floats, key: Integer, tick: Integer, index: int, kept: np.float32, renewed: np.float32
) -> None:
    """Let the noise of a block go on by one step: part of it is kept, part of it new from three
    random places of the table.
    """
    places = len(normals) - LANES
    at_x = int(uniform(key, tick, 3 * index) * places)
    at_y = int(uniform(key, tick, 3 * index + 1) * places)
    at_w = int(uniform(key, tick, 3 * index + 2) * places)
    for k in range(LANES):
        lanes[NOISE_X + k] = kept * lanes[NOISE_X + k] + renewed * normals[at_x + k]
    for k in range(LANES):
        lanes[NOISE_Y + k] = kept * lanes[NOISE_Y + k] + renewed * normals[at_y + k]
    for k in range(LANES):
        lanes[NOISE_W + k] = kept * lanes[NOISE_W + k] + renewed * normals[at_w + k]


@inner
def drive_lanes(
    lanes: Floats, out: Floats, mean: Floats, chassis: Chassis, sampling: Sampling, critics: Critics
) -> None:
    """Drive a block one step of the model on: sampled controls, held to speeds and accelerations, along arcs.

    The velocities reached go to ``out`` (3, LANES). The critics of the motion itself and the control cost of Williams
    et al. 2018 are added on the way.
    """
    dt, half = sampling.dt, HALF * sampling.dt
    quarter = HALF * half
    mean_x, mean_y, mean_w = mean[0], mean[1], mean[2]
    std_x, std_y, std_w = sampling.vx_std, sampling.vy_std, sampling.wz_std
    price_x, price_w = sampling.gamma * mean_x / (std_x * std_x), sampling.gamma * mean_w / (std_w * std_w)
    price_y = sampling.gamma * mean_y / (std_y * std_y) if std_y > ZERO else ZERO
    for k in range(LANES):
        follows, noisy = lanes[FOLLOWS + k], lanes[NOISY + k]
        wanted_x = follows * mean_x + noisy * std_x * lanes[NOISE_X + k] + lanes[FIXED_X + k]
        wanted_y = follows * mean_y + noisy * std_y * lanes[NOISE_Y + k] + lanes[FIXED_Y + k]
        wanted_w = follows * mean_w + noisy * std_w * lanes[NOISE_W + k] + lanes[FIXED_W + k]
        old_x, old_y, old_w = lanes[VX + k], lanes[VY + k], lanes[WZ + k]
        vx = step_towards(old_x, min(max(wanted_x, chassis.vx_min), chassis.vx_max), chassis.vx_change)
        vy = step_towards(old_y, min(max(wanted_y, -chassis.vy_max), chassis.vy_max), chassis.vy_change)
        wz = step_towards(old_w, min(max(wanted_w, -chassis.wz_max), chassis.wz_max), chassis.wz_change)
        tightest = chassis.turn_at_rest + chassis.curvature * abs(vx)
        wz = min(max(wz, -tightest), tightest)
        lanes[VX + k], lanes[VY + k], lanes[WZ + k] = vx, vy, wz
        along, aside = half * (old_x + vx), half * (old_y + vy)
        turn = quarter * (old_w + wz)
        squared = turn * turn
        s = turn * (ONE - SIXTH * squared * (ONE - TWENTIETH * squared))
        c = ONE - HALF * squared * (ONE - TWELFTH * squared)
        middle_c = lanes[COSINE + k] * c - lanes[SINE + k] * s
        middle_s = lanes[SINE + k] * c + lanes[COSINE + k] * s
        lanes[X + k] += middle_c * along - middle_s * aside
        lanes[Y + k] += middle_s * along + middle_c * aside
        lanes[COSINE + k] = middle_c * c - middle_s * s
        lanes[SINE + k] = middle_s * c + middle_c * s
        lanes[TRAVELLED + k] += np.sqrt(along * along + aside * aside)
        lanes[SPEED + k] = np.sqrt(vx * vx + vy * vy)
        beyond = max(ZERO, vx - chassis.vx_max) + max(ZERO, chassis.vx_min - vx)
        cost = critics.constraint * beyond + critics.forward * max(ZERO, -vx) + critics.twirling * abs(wz)
        control = price_x * (vx - mean_x) + price_y * (vy - mean_y) + price_w * (wz - mean_w)
        lanes[COST + k] += dt * cost + control
    for k in range(LANES):
        out[k] = lanes[VX + k]
    for k in range(LANES):
        out[LANES + k] = lanes[VY + k]
    for k in range(LANES):
        out[2 * LANES + k] = lanes[WZ + k]


@inlined
def step_towards(value: np.float32, wanted: np.float32, change: np.float32) -> np.float32:
    """Return ``wanted``, or what comes nearest to it with this change."""
    return value + min(max(wanted - value, -change), change)
