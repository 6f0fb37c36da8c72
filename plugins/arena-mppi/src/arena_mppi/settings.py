"""What a controller is configured with: the nested parts of its YAML, in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from arena_core.parameters import Bounds, Fraction, NonNegative, NonNegativeInt, Positive, PositiveInt
from arena_mppi.motion_model import MotionModel


@dataclass(frozen=True, slots=True)
class Optimisation:
    """How many sequences of how many steps (of ``model_dt`` s) are tried, and how their costs become weights."""

    batch_size: PositiveInt
    time_steps: PositiveInt
    model_dt: Positive
    iterations: PositiveInt
    temperature: Positive
    gamma: NonNegative
    smoothing: bool
    arcs: Fraction


@dataclass(frozen=True, slots=True)
class Driving:
    """What is done about collisions, measured velocities and standing (s)."""

    retry_attempt_limit: NonNegativeInt
    velocity_feedback: Fraction
    patience: Positive | None


@dataclass(frozen=True, slots=True)
class Model:
    """The motion model and its least turning radius (m); null is the robot's."""

    motion_model: MotionModel | None
    turning_radius: NonNegative | None


@dataclass(frozen=True, slots=True)
class Noise:
    """How far controls are sampled round the mean: parts of the greatest speeds, and how long a
    deviation lasts (s, 0: white).
    """

    vx_std: Positive
    vy_std: Positive
    wz_std: Positive
    correlation_time: NonNegative


@dataclass(frozen=True, slots=True)
class SpeedLimits:
    """Speeds (m/s, rad/s) and accelerations (m/s^2, rad/s^2); null is the robot's."""

    vx_min: Annotated[float, Bounds(high=0.0)] | None
    vx_max: Positive | None
    vy_max: NonNegative | None
    wz_max: Positive | None
    ax_max: Positive | None
    ay_max: NonNegative | None
    alpha_max: Positive | None


@dataclass(frozen=True, slots=True)
class Static:
    """The cost critic: weight, reach (m), what coming near costs more, time by which speed shortens gaps (s), least gap
    (m).

    ``eased``: in a passage they give way to the room that the path leaves.
    """

    weight: NonNegative
    inflation_radius: Positive
    critical_cost: NonNegative
    near_collision_gap: Positive
    reaction_time: NonNegative
    collision_gap: NonNegative
    eased: bool


@dataclass(frozen=True, slots=True)
class Moving:
    """The critic of moving obstacles: weight, cost of contact, wanted gap (m) and what speed adds to it
    (s), belief (s), growth, speed.
    """

    weight: NonNegative
    contact_cost: NonNegative
    margin: Positive
    reaction_time: NonNegative
    belief_time: Positive
    growth: NonNegative
    growth_max: NonNegative
    speed_min: NonNegative


@dataclass(frozen=True, slots=True)
class Goal:
    """The goal critics: weights of distance and heading, and how near the robot must be for each (m)."""

    weight: NonNegative
    within: NonNegative
    angle_weight: NonNegative
    angle_within: NonNegative


@dataclass(frozen=True, slots=True)
class PathCritics:
    """The path critics: weights, how far beyond the farthest path point reached the targets lie
    (m), tolerated bearing (rad).
    """

    align_weight: NonNegative
    follow_weight: NonNegative
    follow_ahead: NonNegative
    angle_weight: NonNegative
    angle_ahead: NonNegative
    angle_tolerance: NonNegative


@dataclass(frozen=True, slots=True)
class Progress:
    """The critic of the way that is left in the window: weight, part of it at the trajectory's
    end, and what near walls cost.
    """

    weight: NonNegative
    end_share: Fraction
    comfort_gap: Positive
    comfort_cost: NonNegative
    blocked_cost: Positive


@dataclass(frozen=True, slots=True)
class Motion:
    """The critics of the motion itself: weights of leaving the limits, of driving backwards and of turning."""

    constraint_weight: NonNegative
    forward_weight: NonNegative
    forward_until: NonNegative
    twirling_weight: NonNegative


@dataclass(frozen=True, slots=True)
class CriticSettings:
    """All critics: the compiled ones, and ``critics`` of the user's own, each with its name and its keys."""

    static: Static
    moving: Moving
    goal: Goal
    path: PathCritics
    progress: Progress
    motion: Motion
    critics: list[dict[str, Any]]
