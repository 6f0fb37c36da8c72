"""Kinds of people: what a scenario calls them, and what their bodies are like."""

from __future__ import annotations

from dataclasses import fields, replace

from arena_core import ConfigurationError, PedestrianSpec
from arena_pedsim.parameters import PersonType, PersonTypes

TYPES = tuple(field.name for field in fields(PersonTypes))
OTHER_NAMES = {"vehicle": "forklift", "servicerobot": "service_robot"}  # of the released crowd simulator


def type_name(spec: PedestrianSpec) -> str:
    """Return a person's type, an adult's unless the behaviour says otherwise; raise ConfigurationError for an unknown
    one.

    A path as the editors of scenarios write it (``human/adult``) counts by its last part.
    """
    given = spec.behaviour.get("type", TYPES[0])
    name = str(given).rsplit("/", 1)[-1].strip().lower()
    name = OTHER_NAMES.get(name, name)
    if name not in TYPES:
        raise ConfigurationError(f"person {spec.id}: type is {given!r}; allowed: {', '.join((*TYPES, *OTHER_NAMES))}")
    return name


def with_body(spec: PedestrianSpec, kind: PersonType) -> PedestrianSpec:
    """Return a person with the body of a type."""
    return replace(spec, desired_speed=kind.speed * spec.desired_speed, radius=kind.radius or spec.radius)
