"""From the states that a search found to an even path: shortcuts first, then an elastic band
for paths of straight lines.
"""

from __future__ import annotations

from arena_ompl.curves import STRAIGHT
from arena_ompl.motions import Motions, Poses

_STATES = 100  # that shortcuts are looked for between: their number grows with its square
_COARSENESS = (4.0, 2.0, 1.0)  # spacings of the band, one after the other: a coarse one moves far in a few rounds


def smooth_path(motions: Motions, path: Poses, spacing: float, rounds: int) -> Poses:
    """Return poses (M, 3) about ``spacing`` m apart along a path no costlier than the one
    through some states (K, 3).
    """
    for _ in range(2):
        path = motions.shorten(_candidate_path(motions, path, spacing))
    if motions.rules.kind != STRAIGHT:
        return motions.poses(path, spacing)
    for coarseness in _COARSENESS:
        path = motions.relax(motions.poses(path, coarseness * spacing), rounds)
    return path


def _candidate_path(motions: Motions, path: Poses, spacing: float) -> Poses:
    """Return poses along a path, not many more than ``_STATES``."""
    even = motions.poses(path, spacing)
    return even if len(even) <= _STATES else motions.poses(path, spacing * len(even) / _STATES)
