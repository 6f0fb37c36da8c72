"""Why a track was not seen: something stands before it, it is out of sight, or nothing is there any more."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import inner
from arena_navigation.columns import THETA, X, Y
from arena_navigation.local_map.marks import PlacedScan

SEEN, HIDDEN, GONE = 0, 1, 2
_TURN = 2.0 * math.pi


@inner
def judge_visibility(
    beams: PlacedScan,
    states: NDArray[np.float64],
    radii: NDArray[np.float64],
    matches: NDArray[np.int64],
    farthest: float,
    slack: float,
    sight: NDArray[np.uint8],
) -> None:
    """Write SEEN, HIDDEN or GONE for each track.

    GONE: at least half of the beams towards the middle half of its disc end ``slack`` m or more behind it, or end in
    it, but at a body that another track has taken for itself and that leaves it no room. Everything else without a
    match is hidden.
    """
    reach = min(farthest, beams.range_max)
    for k in range(len(states)):
        if matches[k] >= 0:
            sight[k] = SEEN
            continue
        dx, dy = states[k, X] - beams.sensor[X], states[k, Y] - beams.sensor[Y]
        away = math.hypot(dx, dy)
        behind = min(away + radii[k] + slack, beams.range_max)
        seen_through = radii[k] < away < reach and _open_share(beams, dx, dy, away, radii[k], behind) >= 0.5
        sight[k] = GONE if seen_through or _is_taken(states, radii, matches, k) else HIDDEN


@inner
def _is_taken(states: NDArray[np.float64], radii: NDArray[np.float64], matches: NDArray[np.int64], k: int) -> bool:
    """Return whether the middle of track k lies inside a body that was seen now and is another track's."""
    for other in range(len(states)):
        if matches[other] >= 0:
            x, y = states[k, X] - states[other, X], states[k, Y] - states[other, Y]
            if x * x + y * y < radii[other] ** 2:
                return True
    return False


@inner
def _open_share(beams: PlacedScan, dx: float, dy: float, away: float, radius: float, behind: float) -> float:
    """Return the share of the beams to the middle half of a disc that end behind it; none beyond the field of view."""
    count = len(beams.ranges)
    bearing = (math.atan2(dy, dx) - beams.sensor[THETA] - beams.angle_min) % _TURN
    half = math.asin(0.5 * radius / away) / beams.angle_increment
    centre = bearing / beams.angle_increment
    turn = _TURN / beams.angle_increment
    if centre - half > count - 1:  # the disc may lie astride the first beam
        centre -= turn
    total, open_beams = 0, 0
    for beam in range(math.ceil(centre - half), math.floor(centre + half) + 1):
        total += 1
        at = beam
        if at < 0:
            at += round(turn)
        if at >= count:
            at -= round(turn)
        if 0 <= at < count and beams.ranges[at] >= behind:
            open_beams += 1
    return open_beams / total if total else 0.0
