"""The filter's parameters as its YAML groups them: ROS amcl's names, their first word being the group's name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from arena_core import ConfigurationError
from arena_core.parameters import Bounds, Fraction, NonNegative, Positive, PositiveInt
from arena_navigation.amcl.laser import LaserModelType
from arena_navigation.amcl.motion import OdometryModelType

RangeLimit = Annotated[float, Bounds(low=-1.0)]
BeamCount = Annotated[int, Bounds(low=1, high=10_000)]  # as of a lidar
ParticleCount = Annotated[int, Bounds(low=1, high=1_000_000)]  # two hundred times the usual; its arrays take 200 MB


@dataclass(frozen=True, slots=True)
class ParticleParameters:
    """How many particles there are, and what they may miss of the distribution."""

    min: ParticleCount
    max: ParticleCount
    kld_err: Positive
    kld_z: NonNegative

    def __post_init__(self) -> None:
        if self.min > self.max:
            raise ConfigurationError(f"localizer.particles.min is {self.min}; allowed: at most max {self.max}")


@dataclass(frozen=True, slots=True)
class UpdateParameters:
    """How far the robot moves before another scan is used."""

    min_d: NonNegative
    min_a: NonNegative


@dataclass(frozen=True, slots=True)
class ResampleParameters:
    """When particles are drawn again, and how."""

    interval: PositiveInt
    independently: bool
    estimate_after: bool


@dataclass(frozen=True, slots=True)
class RecoveryParameters:
    """When particles are scattered because scans fit badly."""

    alpha_slow: Fraction
    alpha_fast: Fraction


@dataclass(frozen=True, slots=True)
class InitialParameters:
    """How well the start is known."""

    cov_xx: NonNegative
    cov_yy: NonNegative
    cov_aa: NonNegative


@dataclass(frozen=True, slots=True)
class LaserParameters:
    """The sensor model, and which beams it takes."""

    model_type: LaserModelType
    min_range: RangeLimit
    max_range: RangeLimit
    max_beams: BeamCount
    z_hit: Fraction
    z_short: Fraction
    z_max: Fraction
    z_rand: Fraction
    sigma_hit: Positive
    lambda_short: Positive
    likelihood_max_dist: Positive
    to_surface: bool
    hollow: bool
    beam_weight: Fraction
    short_beam_distance: Positive | None


@dataclass(frozen=True, slots=True)
class BeamSkipParameters:
    """Whether beams that fit for few of the particles are left out, and what that means."""

    enabled: bool
    distance: Positive
    threshold: Fraction
    error_threshold: Fraction


@dataclass(frozen=True, slots=True)
class OdomParameters:
    """The motion model and its noise."""

    model_type: OdometryModelType | None
    alpha1: NonNegative
    alpha2: NonNegative
    alpha3: NonNegative
    alpha4: NonNegative
    alpha5: NonNegative
