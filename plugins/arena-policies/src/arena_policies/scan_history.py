"""Earlier scans, seen from where the robot is now."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, Lidar, Robot
from arena_kernels.compiled import borrowing, inner

Floats = NDArray[np.float64]
TURN = 2.0 * math.pi


class Beams(NamedTuple):
    """A lidar's beams: their directions (B,) as cosine and sine in the sensor's frame, its mount (x, y,
    cos, sin) in ``base_link``.
    """

    cos: Floats
    sin: Floats
    angle_min: float
    angle_increment: float
    mount: tuple[float, float, float, float]


def beams_of(lidar: Lidar) -> Beams:
    """Return a lidar's beams."""
    angles, mount = lidar.angles(), lidar.mount
    at = mount.x, mount.y, math.cos(mount.theta), math.sin(mount.theta)
    return Beams(np.cos(angles), np.sin(angles), lidar.angle_min, lidar.angle_increment, at)


def lookback_steps(times: Sequence[float], robot: Robot) -> tuple[int, ...]:
    """Return how many control steps ago ``times``, s, lie; raise ConfigurationError
    where one is no whole number of them.
    """
    return tuple(_whole_steps(seconds, robot.control_period) for seconds in times)


def _whole_steps(seconds: float, period: float) -> int:
    steps = round(seconds / period)
    if steps < 1 or abs(steps * period - seconds) > 1e-9:
        raise ConfigurationError(
            f"observation_encoder.lookback has {seconds:g}; allowed: multiples of the "
            f"robot's control period, {period:g} s"
        )
    return steps


@borrowing
def past_sector_ranges(
    ranges: NDArray[np.float32], then: Floats, now: Floats, beams: Beams, range_max: float, out: Floats
) -> None:
    """Fill ``out`` (N, L, S) with the least distance in each sector, at most ``range_max`` m, of what earlier scans
    hit.

    ``ranges`` (N, L, B) m were taken from poses ``then`` (N, L, 3) and are seen from the sensor at poses ``now`` (N,
    3). Sectors share the beams evenly; of finer scans only every so many beams count, four a sector or more. What no
    beam would point at now is left out, and so is a range that is not a number.
    """
    mx, my, mc, ms = beams.mount
    count, sectors = ranges.shape[2], out.shape[2]
    stride = max(count // (4 * sectors), 1)
    for k in range(len(now)):
        for j in range(out.shape[1]):
            out[k, j, :] = range_max
            turned = then[k, j, 2] - now[k, 2]
            c, s = math.cos(turned), math.sin(turned)
            here_c, here_s = math.cos(now[k, 2]), math.sin(now[k, 2])
            dx, dy = then[k, j, 0] - now[k, 0], then[k, j, 1] - now[k, 1]
            # of the sensor then, in base_link now, from the sensor now
            tx = here_c * dx + here_s * dy + c * mx - s * my - mx
            ty = here_c * dy - here_s * dx + s * mx + c * my - my
            ox, oy = mc * tx + ms * ty, mc * ty - ms * tx
            for b in range(0, count, stride):
                r = float(ranges[k, j, b])
                if r < range_max:
                    px, py = r * beams.cos[b], r * beams.sin[b]
                    x, y = ox + c * px - s * py, oy + s * px + c * py
                    beam = int(_wrap_turn(math.atan2(y, x) - beams.angle_min) / beams.angle_increment + 0.5)
                    if beam >= count and beam * beams.angle_increment + 0.5 * beams.angle_increment >= TURN:
                        beam = 0
                    if beam < count:
                        sector = ((beam + 1) * sectors - 1) // count
                        out[k, j, sector] = min(out[k, j, sector], math.hypot(x, y))


@inner
def _wrap_turn(angle: float) -> float:
    """Return ``angle % TURN``, which most angles are already or are but for one turn."""
    if 0.0 <= angle < TURN:
        return angle
    return angle + TURN if -TURN < angle < 0.0 else angle % TURN
