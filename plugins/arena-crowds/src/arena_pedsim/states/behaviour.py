"""What a scenario may say of a person's behaviour, and what holds where it does not."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from math import isfinite
from typing import Any, Literal

from arena_core import ConfigurationError, PedestrianSpec
from arena_core.parameters import Fraction, NonNegative
from arena_pedsim.states.person_types import type_name


@dataclass(frozen=True, slots=True)
class Behaviour:
    """Chances a test, distances (m) and base times (s) of the social states where a person's own ``behaviour`` does not
    say.

    With ``scenario_chances: ignore`` they count for everybody, whatever the scenario says.
    """

    scenario_chances: Literal["count", "ignore"]
    running_probability: Fraction
    chatting_probability: Fraction
    tell_story_probability: Fraction
    group_talking_probability: Fraction
    talking_and_walking_probability: Fraction
    requesting_service_probability: Fraction
    requesting_guide_probability: Fraction
    requesting_follower_probability: Fraction
    max_talking_distance: NonNegative
    max_servicing_radius: NonNegative
    talking_base_time: NonNegative
    tell_story_base_time: NonNegative
    group_talking_base_time: NonNegative
    talking_and_walking_base_time: NonNegative
    requesting_service_base_time: NonNegative
    receiving_service_base_time: NonNegative
    requesting_guide_base_time: NonNegative
    requesting_follower_base_time: NonNegative
    clearing_goal_base_time: NonNegative
    queue_base_time: NonNegative


SHARED = tuple(field.name for field in fields(Behaviour) if field.name != "scenario_chances")
OWN = ("wait_time", "trigger_zone_radius")  # no one's but a person's; 0 when not given
# the middle of the zone in ``map``, m; where the person starts when not given
ZONE = ("trigger_zone_x", "trigger_zone_y")
ZONES = 8  # trigger zones of one person, at most
FURTHER = tuple(
    f"trigger_zone_{number}_{what}" for number in range(2, ZONES + 1) for what in ("radius", "x", "y")
)  # nowhere when not given
# the columns of a person's traits; each zone has radius, x and y beside each other
TRAITS = (*SHARED, *OWN, *ZONE, *FURTHER)
CHANCES = tuple(name for name in TRAITS if name.endswith("_probability"))
WAYS = {0: "in a loop", 1: "at random"}
START_UPS = ("default", "wait_timer", "trigger_zone", "signal_wait", "signal_proceed")

Check = tuple[Callable[[Any], bool], str]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def _one_of(*choices: object) -> Check:
    return lambda value: not isinstance(value, bool) and value in choices, "one of " + ", ".join(map(str, choices))


NOT_NEGATIVE: Check = (lambda value: _is_number(value) and value >= 0.0, "a number >= 0")
CHANCE: Check = (lambda value: _is_number(value) and 0.0 <= value <= 1.0, "a number 0 .. 1")
INDEX: Check = (lambda value: _is_number(value) and value >= 0 and value == int(value), "a whole number >= 0")
ELSEWHERE: Check = (lambda value: True, "")
NAME: Check = (lambda value: _is_number(value) or isinstance(value, str), "a number or a name")

KEYS: dict[str, Check] = {
    **{name: CHANCE if name in CHANCES else NOT_NEGATIVE for name in (*SHARED, *OWN)},
    **{name: (_is_number, "a coordinate in m") for name in (*ZONE, *FURTHER) if not name.endswith("_radius")},
    **{name: NOT_NEGATIVE for name in FURTHER if name.endswith("_radius")},
    **{f"force_factor_{name}": NOT_NEGATIVE for name in ("desired", "social", "obstacle", "robot")},
    **dict.fromkeys(("type", "reaction", "spawn_time", "respawn"), ELSEWHERE),
    "start_up_mode": _one_of(*START_UPS),
    "waypoint_mode": _one_of(*WAYS),
    "pause_probability": CHANCE,
    "pause_time": NOT_NEGATIVE,
    "group": NAME,
    "queue": NAME,
    "queue_waypoint": INDEX,
    "queue_heading": (_is_number, "an angle in rad"),
}


def check_behaviour(spec: PedestrianSpec) -> None:
    """Raise ConfigurationError for the first key that is not known, or whose value is not possible."""
    for key, value in spec.behaviour.items():
        if key not in KEYS:
            known = ", ".join(sorted(KEYS.keys() - set(FURTHER)))
            raise ConfigurationError(
                f"person {spec.id}: behaviour has no {key}; allowed: {known}, trigger_zone_2_x .. "
                f"trigger_zone_{ZONES}_x"
            )
        fits, allowed = KEYS[key]
        if not fits(value):
            raise ConfigurationError(f"person {spec.id}: {key} is {value!r}; allowed: {allowed}")
    place, places = spec.behaviour.get("queue_waypoint", 0), len(spec.waypoints_xy)
    if "queue" in spec.behaviour and not float(place) < places:
        raise ConfigurationError(
            f"person {spec.id}: queue_waypoint is {place}; allowed: 0 .. {places - 1}, the places of its waypoints"
        )


def traits_of(spec: PedestrianSpec, defaults: Behaviour, *, sociable: bool) -> tuple[float, ...]:
    """Return a person's TRAITS; without chances where the type is not ``sociable``."""
    own: Mapping[str, float | str] = spec.behaviour
    if defaults.scenario_chances == "ignore":
        own = {key: value for key, value in own.items() if key not in SHARED}
    own = {**dict(zip(ZONE, spec.position_xy.tolist(), strict=True)), **own}
    values = {name: float(own.get(name, getattr(defaults, name, 0.0))) for name in TRAITS}
    if not sociable:
        values.update(dict.fromkeys(CHANCES, 0.0))
    return tuple(values.values())


def is_service_robot(spec: PedestrianSpec) -> bool:
    """Return whether a person is a service robot."""
    return type_name(spec) == "service_robot"
