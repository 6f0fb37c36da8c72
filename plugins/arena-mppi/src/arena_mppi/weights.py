"""The critics' weights at a distance from the goal, as the compiled control step takes them."""

from __future__ import annotations

import numpy as np

from arena_mppi.parameters import Critics
from arena_mppi.settings import CriticSettings


def critics_of(settings: CriticSettings, speed: float, distance: float, patience: float) -> Critics:
    """Return the weights ``distance`` m before the goal: near it the goal critics take over from those of the path, as
    in Nav2.

    Ways are weighed by the time that they take at full ``speed`` (m/s): what is far for a slow robot is near for a fast
    one. Of the wish for room to walls and people only the part ``patience`` counts.
    """
    static, moving, goal, motion = settings.static, settings.moving, settings.goal, settings.motion
    path, progress, near = settings.path, settings.progress, distance < settings.goal.within
    return Critics(
        static=np.float32(static.weight * patience),
        inflation_radius=np.float32(static.inflation_radius),
        critical=np.float32(static.critical_cost * patience),
        near_collision_gap=np.float32(static.near_collision_gap),
        reaction_time=np.float32(static.reaction_time),
        collision_gap=np.float32(static.collision_gap),
        moving=np.float32(moving.weight * patience),
        contact=np.float32(moving.contact_cost),
        margin=np.float32(moving.margin),
        moving_reaction_time=np.float32(moving.reaction_time),
        goal=np.float32(goal.weight if near else 0.0),
        goal_angle=np.float32(goal.angle_weight if distance < goal.angle_within else 0.0),
        align=np.float32(0.0 if near else path.align_weight),
        follow=np.float32(0.0 if near else path.follow_weight),
        follow_ahead=np.float32(path.follow_ahead),
        angle=np.float32(0.0 if near else path.angle_weight),
        angle_ahead=np.float32(path.angle_ahead),
        angle_tolerance=np.float32(path.angle_tolerance),
        progress=np.float32(progress.weight / speed),
        end_share=np.float32(progress.end_share),
        constraint=np.float32(motion.constraint_weight),
        forward=np.float32(motion.forward_weight / speed if distance > motion.forward_until else 0.0),
        twirling=np.float32(motion.twirling_weight),
    )
