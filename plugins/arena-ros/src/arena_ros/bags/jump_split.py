"""Where the robot was set elsewhere: no robot drives such a step, so that the episode ends there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from arena_ros.bags.series import Series
from arena_ros.bags.transform_tree import Floats
from arena_ros.bags.transformed_episode import TransformedEpisode

STEP = 1.0  # m that a localiser may correct at once
FASTEST = 3.0  # m/s, faster than any of these robots, where its limits are not more than half of that
SETTLING = 2 * 10**9  # ns after a goal or a reset within which the robot is set to its start
SHORTEST = 10**9  # ns, less than which is no drive


@dataclass(frozen=True, slots=True)
class JumpLimits:
    """How fast a robot drives, m/s, and when its drive to a goal is over: within ``goal_radius`` m or ``time_limit``
    s.
    """

    v_max: float
    goal_radius: float
    time_limit: float


def split_at_jumps(
    placed: TransformedEpisode, limits: JumpLimits, note: Callable[[str], None], *, is_later: bool
) -> Iterator[TransformedEpisode]:
    """Yield the parts of an episode between the places where the robot was set elsewhere.

    ``is_later`` tells that there was an episode before. A part goes on towards the goal of the one before, unless that
    had ended: what comes after belongs to none then.
    """
    motion = _without_spikes(placed.motion, limits.v_max, note)
    stamps, values = motion.stamps, motion.values
    lengths, allowed = _step_lengths(motion, limits.v_max)
    cuts = np.flatnonzero(lengths > allowed) + 1
    bounds = list(zip([0, *cuts.tolist()], [*cuts.tolist(), len(stamps)], strict=True))
    while len(bounds) > 1 and stamps[bounds[0][1]] - placed.begin <= SETTLING:
        bounds.pop(0)  # it was set to where it starts
        note("the robot was set to its start after its goal or a reset: the episode begins there")
    for k, (first, last) in enumerate(bounds):
        if (k or (placed.goal is None and is_later)) and stamps[last - 1] - stamps[first] < SHORTEST:
            continue
        begin = placed.begin if bounds[0][0] == 0 and k == 0 else int(stamps[first])
        jump = f"the robot jumped by {lengths[last - 1]:.1f} m" if last < len(stamps) else placed.why_ended
        if last < len(stamps):
            note("the robot jumped farther than it can drive: an episode ends there")
        yield replace(placed, motion=motion, begin=begin, end=int(stamps[last - 1]), why_ended=jump)
        if placed.goal is not None:
            near = np.hypot(*(values[first:last, :2] - (placed.goal.x, placed.goal.y)).T).min() <= limits.goal_radius
            if near or (stamps[last - 1] - begin) * 1e-9 >= limits.time_limit:
                return


def _step_lengths(motion: Series, v_max: float) -> tuple[Floats, Floats]:
    lapse = np.diff(motion.stamps) * 1e-9
    return np.hypot(*np.diff(motion.values[:, :2], axis=0).T), STEP + max(FASTEST, 2.0 * v_max) * lapse


def _without_spikes(motion: Series, v_max: float, note: Callable[[str], None]) -> Series:
    """Return poses without single ones that lie off both the one before and the one after."""
    lengths, allowed = _step_lengths(motion, v_max)
    far = lengths > allowed
    spikes = np.zeros(len(motion), bool)
    if len(motion) > 2:
        values, stamps = motion.values, motion.stamps
        across = (
            np.hypot(*(values[2:, :2] - values[:-2, :2]).T)
            <= STEP + max(FASTEST, 2.0 * v_max) * (stamps[2:] - stamps[:-2]) * 1e-9
        )
        spikes[1:-1] = far[:-1] & far[1:] & across
    if not spikes.any():
        return motion
    for _ in range(int(spikes.sum())):
        note("a pose that the robot cannot have had between two others; left out")
    return motion.where(~spikes)
