"""The dynamic window: which velocities the robot can have one control period from now, and which of them are tried."""

from __future__ import annotations

import math

import numpy as np

from arena_dwa.columns import HIGH, LOW, VX, VY, WZ
from arena_dwa.settings import FloatArray, Limits
from arena_kernels.compiled import borrowing, compiled

REST = 1e-9  # speeds below this are none
TOLERANCE = 1e-4  # speeds this close to a minimum count as fast enough, as in ROS


@borrowing
def reachable_range(speed: float, low: float, high: float, acceleration: float, period: float) -> tuple[float, float]:
    """Return the least and greatest speed on one axis after ``period`` s; a speed beyond the
    limits is led back to them.
    """
    now = min(max(speed, low), high)
    return max(low, now - acceleration * period), min(high, now + acceleration * period)


@compiled
def dynamic_window(twist: FloatArray, limits: Limits, period: float) -> FloatArray:
    """Return the window V_d of Fox, Burgard, Thrun (1997), eq. 14, cut to the limits: (3, 2) lows and highs of vx, vy,
    wz.

    A robot that is measured faster than ``trans_max`` counts as that fast, or noise would leave it no sample.
    """
    window = np.empty((3, 2))
    excess = max(1.0, math.hypot(twist[VX], twist[VY]) / limits.trans_max)
    window[VX, LOW], window[VX, HIGH] = reachable_range(
        twist[VX] / excess, limits.vx_min, limits.vx_max, limits.ax_max, period
    )
    window[VY, LOW], window[VY, HIGH] = reachable_range(
        twist[VY] / excess, -limits.vy_max, limits.vy_max, limits.ay_max, period
    )
    window[WZ, LOW], window[WZ, HIGH] = reachable_range(
        twist[WZ], -limits.wz_max, limits.wz_max, limits.alpha_max, period
    )
    return window


@compiled
def axis_samples(low: float, high: float, count: int) -> FloatArray:
    """Return ``count`` evenly spaced speeds from low to high, and 0 with them where it lies between (1 or
    0: the one nearest to rest).
    """
    if count < 2 or high - low < REST:
        samples = np.empty(1)
        samples[0] = min(max(0.0, low), high)
        return samples
    samples, n = np.empty(count + 1), 0
    for k in range(count):
        speed = low + (high - low) * k / (count - 1)
        if abs(speed) < REST:
            speed = 0.0
        if n > 0 and samples[n - 1] < 0.0 < speed:
            samples[n] = 0.0
            n += 1
        samples[n] = speed
        n += 1
    return samples[:n]


@compiled
def turn_samples(vx: float, window: FloatArray, limits: Limits, count: int) -> FloatArray:
    """Return the turning speeds to try with ``vx``: those of the window, for an Ackermann robot
    only what its steering allows.
    """
    low, high = window[WZ, LOW], window[WZ, HIGH]
    if limits.turn_radius > 0.0:
        steered = abs(vx) / limits.turn_radius
        low, high = min(max(low, -steered), steered), max(min(high, steered), -steered)
    return axis_samples(low, high, count)


@borrowing
def is_drivable(vx: float, vy: float, wz: float, limits: Limits) -> bool:
    """Return whether a sample is neither too slow nor, along its direction, too fast."""
    speed = math.hypot(vx, vy)
    slow = speed + TOLERANCE < limits.trans_min and abs(wz) + TOLERANCE < limits.theta_min
    return not slow and speed - TOLERANCE <= limits.trans_max
