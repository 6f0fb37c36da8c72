"""What the compiled control step is told: tuples of plain numbers and arrays, in SI units,
single precision in the roll-outs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.costmap_window import CostmapWindow, Outline

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]


class Chassis(NamedTuple):
    """Speeds, what they can change in one step of the model, and the greatest turn:
    ``turn_at_rest`` + ``curvature`` abs(vx).
    """

    vx_min: np.float32
    vx_max: np.float32
    vy_max: np.float32
    wz_max: np.float32
    vx_change: np.float32
    vy_change: np.float32
    wz_change: np.float32
    turn_at_rest: np.float32
    curvature: np.float32


class Sampling(NamedTuple):
    """How controls are drawn: standard deviations, the part of a deviation that is kept from
    step to step, steps that are tied.
    """

    batch_size: int
    time_steps: int
    tied: int
    iterations: int
    dt: np.float32
    vx_std: np.float32
    vy_std: np.float32
    wz_std: np.float32
    kept: np.float32
    renewed: np.float32
    temperature: np.float32
    gamma: np.float32
    smoothing: bool


class Critics(NamedTuple):
    """Weights and reaches of the critics; see the dataclasses of the settings."""

    static: np.float32
    inflation_radius: np.float32
    critical: np.float32
    near_collision_gap: np.float32
    reaction_time: np.float32
    collision_gap: np.float32
    moving: np.float32
    contact: np.float32
    margin: np.float32
    moving_reaction_time: np.float32
    goal: np.float32
    goal_angle: np.float32
    align: np.float32
    follow: np.float32
    follow_ahead: np.float32
    angle: np.float32
    angle_ahead: np.float32
    angle_tolerance: np.float32
    progress: np.float32
    end_share: np.float32
    constraint: np.float32
    forward: np.float32
    twirling: np.float32


class Body(NamedTuple):
    """The footprint: its outline, and discs (D, 3) of x, y, radius that cover it, m."""

    outline: Outline
    discs: Floats


class Scene(NamedTuple):
    """What roll-outs are judged against, map-aligned about the robot's position (m).

    ``gaps`` (H, W) is the distance to the nearest lethal cell's edge, ``left`` (h, w) what is left of the way; each
    with its corner. ``moving`` (T, N, 3) is where each obstacle is expected and how large, with its weight ``belief``
    (T,); ``path`` (M, 2) is evenly spaced. ``goal`` is x, y, cosine and sine of its heading. ``window`` and ``x``,
    ``y`` are in ``map``, for the exact look.
    """

    gaps: Floats
    gaps_x: np.float32
    gaps_y: np.float32
    gaps_resolution: np.float32
    left: Floats
    left_x: np.float32
    left_y: np.float32
    left_resolution: np.float32
    moving: Floats
    belief: Floats
    path: Floats
    goal: Floats
    window: CostmapWindow
    x: float
    y: float


class Workspace(NamedTuple):
    """Memory of the control step: all that is written. L is the number of lanes, B of blocks, T of steps.

    ``normals`` (N,) are standard normal numbers of the episode; ``fixed`` (5, B L) has for each roll-out how much of
    the mean and of the noise it takes, and a constant velocity of its own. ``lanes`` is one block's state,
    ``velocities`` (B, T, 3 L) every roll-out's, ``costs`` and ``weights`` (B L,), ``ends`` (4, B L) last poses.
    ``mean`` (T, 3) is the sequence, ``smoothed`` and ``cheapest`` (T, 3) others, ``history`` (4, 3) the velocities
    before.
    """

    normals: Floats
    fixed: Floats
    lanes: Floats
    velocities: Floats
    costs: Floats
    weights: Floats
    ends: Floats
    mean: Floats
    smoothed: Floats
    cheapest: Floats
    history: Floats
