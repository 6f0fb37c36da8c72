"""The model's numbers, as the configuration gives them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from arena_core.parameters import Fraction, NonNegative, Positive


@dataclass(frozen=True, slots=True)
class ForceFactors:
    """Weights of the four accelerations; ``force_factor_*`` of a person's behaviour overrides them.

    Repulsions were measured on people of ``reference_speed`` (m/s): others feel them in proportion to their own
    greatest speed, or else slow people, whose drive is weak, could not pass anybody. None: everybody feels the same.
    """

    desired: NonNegative
    social: NonNegative
    obstacle: NonNegative
    robot: NonNegative
    reference_speed: Positive | None


@dataclass(frozen=True, slots=True)
class SocialInteraction:
    """The constants of Moussaid et al. 2009; ``range`` (m, between centres) is where the force is cut off."""

    lambda_importance: NonNegative
    gamma: Positive
    n: NonNegative
    n_prime: NonNegative
    epsilon: NonNegative
    rear_weight: Fraction
    range: Positive


@dataclass(frozen=True, slots=True)
class WallForce:
    """The repulsion of walls: exp(-gap / sigma), or 1 / gap up to ``limit``; none beyond ``range`` m."""

    form: Literal["exponential", "inverse"]
    sigma: Positive
    limit: Positive
    range: Positive


@dataclass(frozen=True, slots=True)
class Wayfinding:
    """How people follow their waypoints: distances in m, periods in s, ``stuck_speed`` as a
    fraction of a person's own maximum.
    """

    routing: Literal["around_walls", "straight"]
    cell: Positive
    waypoint_radius: Positive
    corner_radius: Positive
    look_period: Positive
    stuck_period: Positive
    meeting_period: Positive
    door_wait: Positive
    stuck_speed: Fraction


@dataclass(frozen=True, slots=True)
class GivingWay:
    """How people who see robots keep out of their way: ``margin`` and ``distance`` in m, ``time`` in s."""

    margin: NonNegative
    distance: NonNegative
    time: Positive


@dataclass(frozen=True, slots=True)
class Reaction:
    """What people do who see a robot and neither ignore it nor only give way.

    ``sight`` (m): how far they see it. ``pace``: share of their own speed that they then go with. ``distance`` (m,
    between centres): where they stop. ``force`` (m^2/s^2): an acceleration away from the robot, times 1 / gap.
    ``duration`` (s): how long it lasts, None without an end; ``pause`` (s): how long it does not begin again then.
    """

    sight: NonNegative
    pace: Fraction
    distance: NonNegative
    force: NonNegative
    duration: Positive | None
    pause: NonNegative


@dataclass(frozen=True, slots=True)
class Reactions:
    """The reactions beyond ignore and yield."""

    curious: Reaction
    scared: Reaction
    threatening: Reaction


@dataclass(frozen=True, slots=True)
class PersonType:
    """The body of a kind of people: ``radius`` in m (None: as the scenario says), ``speed`` as a share of the
    scenario's, ``mass`` in kg.

    ``sociable`` people take part in social states; ``colour`` is that in pictures (None: as people are drawn).
    """

    radius: Positive | None
    speed: Fraction
    mass: Positive
    sociable: bool
    colour: str | None


@dataclass(frozen=True, slots=True)
class PersonTypes:
    """All kinds of people."""

    adult: PersonType
    child: PersonType
    elder: PersonType
    forklift: PersonType
    service_robot: PersonType


@dataclass(frozen=True, slots=True)
class Spawning:
    """How people come: gap to the robot (m) where they may appear, and for how long (s) who has left is away."""

    robot_distance: NonNegative
    pause: NonNegative


@dataclass(frozen=True, slots=True)
class GroupWalking:
    """The forces of Moussaid et al. 2010 between people who walk together;

    ``vision`` rad to each side, ``distance`` m.
    """

    gaze: NonNegative
    coherence: NonNegative
    repulsion: NonNegative
    vision: NonNegative
    distance: NonNegative


CODES = {"exponential": 0, "inverse": 1, "straight": 0, "around_walls": 1}
