"""The critics' weights at a distance from the goal, as the compiled control step takes them."""

from __future__ import annotations

import numpy as np

from arena_mppi.parameters import Critics
from arena_mppi.settings import Goal, Motion, Moving, PathCritics, Progress, Static


def critics_of(
    static: Static,
    moving: Moving,
    goal: Goal,
    path: PathCritics,
    progress: Progress,
    motion: Motion,
    speed: float,
    distance: float,
    patience: float,
) -> Critics:
    """Return the weights ``distance`` m before the goal: near it the goal critics take over from those of the path, as
    in Nav2.

    Ways are weighed by the time that they take at full ``speed`` (m/s): what is far for a slow robot is near for a fast
    one. Of the wish for room to walls and people only the part ``patience`` counts.
    """
    near = distance < goal.within
    numbers = (
        static.weight * patience,
        static.inflation_radius,
        static.critical_cost * patience,
        static.near_collision_gap,
        static.reaction_time,
        static.collision_gap,
        moving.weight * patience,
        moving.contact_cost,
        moving.margin,
        moving.reaction_time,
        goal.weight if near else 0.0,
        goal.angle_weight if distance < goal.angle_within else 0.0,
        0.0 if near else path.align_weight,
        0.0 if near else path.follow_weight,
        path.follow_ahead,
        0.0 if near else path.angle_weight,
        path.angle_ahead,
        path.angle_tolerance,
        progress.weight / speed,
        progress.end_share,
        motion.constraint_weight,
        motion.forward_weight / speed if distance > motion.forward_until else 0.0,
        motion.twirling_weight,
    )
    return Critics(*(np.float32(number) for number in numbers))
