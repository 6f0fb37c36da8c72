"""What is tuned: a planner, or the stack that guides one, made of localiser, tracker and recoveries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from arena_core import ConfigurationError
from arena_core.commands import key_value
from arena_core.hosting import (
    Registry,
    SearchSpace,
    check_ranges,
    check_search_space,
    check_settings,
    search_space_of,
    value_at,
)

STACK, PLANNER = "stack", "planner"  # what can be tuned: the first word after `arena tune`, and what is without one
PARTS = ("localizer", "tracker", "recoveries")  # of a stack
DRIVER = "teb"  # the planner that drives a stack's robot: it looks at tracks and has no recoveries of its own
LOCALIZER = "localizer=amcl"  # of a stack, in the place of the problems' own


@dataclass(frozen=True, slots=True)
class Subject:
    """What is tuned: ``kind`` planner or stack; ``preset`` is the planner's that is tuned, or drives."""

    kind: str
    preset: str

    @property
    def name(self) -> str:
        """Return what folders and pages call it."""
        return STACK if self.kind == STACK else self.preset

    @property
    def place(self) -> str:
        """Return where of the configuration the keys stand that are searched, empty for its top."""
        return "" if self.kind == STACK else PLANNER

    def preset_name(self, robot: str) -> str:
        """Return what the preset that comes of it is called, unless the user says otherwise."""
        return f"tuned_{robot}" if self.kind == STACK else f"{self.preset}_tuned_{robot}"

    def words(self, robot: str, overrides: Sequence[str]) -> list[str]:
        """Return the words that compose it; those of the user count before a stack's own."""
        chosen = [f"planner={self.preset}", f"robot={robot}", *overrides]
        own = self.kind == STACK and not any(key_value(word)[0] == "localizer" for word in overrides)
        return [LOCALIZER, *chosen] if own else chosen

    def config(self, composed: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return what of a composed configuration the keys are of."""
        part: Mapping[str, Any] = composed[self.place] if self.place else composed
        return part

    def space(self, composed: Mapping[str, Any], registry: Registry) -> tuple[SearchSpace, list[str]]:
        """Return what is searched, and what of a stack is left out since it is not there or the planner has its own;
        raise ConfigurationError where the space does not fit.
        """
        if self.kind == PLANNER:
            space = search_space_of(self.preset, composed["planner"]["name"], registry)
            check_search_space(space, composed["planner"], registry)
            return space, []
        space = search_space_of(STACK, STACK, registry)
        left_out = [key for key in space.parameters if not _counts(key, composed)]
        space = replace(space, parameters={key: one for key, one in space.parameters.items() if key not in left_out})
        if not space.parameters:
            raise ConfigurationError("nothing of the stack can be searched; allowed: localizer=amcl or tracker=kalman")
        check_ranges(space, composed, "", lambda changed: _check_parts(changed, composed, registry))
        return space, left_out

    def fixed(self, words: Sequence[str], composed: Mapping[str, Any]) -> dict[str, Any]:
        """Return what the user's words set of it, which the preset keeps beside what is searched."""
        places = [f"{part}." for part in PARTS] if self.kind == STACK else ["planner."]
        keys = [key for key, _ in map(key_value, words) if key.startswith(tuple(places))]
        own = [key if self.kind == STACK else key.removeprefix("planner.") for key in keys]
        return {key: value_at(self.config(composed), key, self.place) for key in own}

    def check(self, composed: Mapping[str, Any], registry: Registry) -> None:
        """Raise ConfigurationError where its space does not fit, or names what is not there."""
        _, left_out = self.space(composed, registry)
        for key in left_out:
            value_at(composed, key, "")


def _counts(key: str, composed: Mapping[str, Any]) -> bool:
    """Return whether a key of a stack is there, and the planner has nothing of its own in its place."""
    part, _, rest = key.partition(".")
    own = composed["planner"].get(part) or {}
    try:
        value_at(composed, key, "")
    except ConfigurationError:
        return False
    return part != "recoveries" or rest not in own


def _check_parts(changed: Mapping[str, Any], before: Mapping[str, Any], registry: Registry) -> None:
    """Raise ConfigurationError for a value that a part of the stack does not take; only those that differ are looked
    at.
    """
    for part in PARTS:
        if changed[part] is before[part]:
            continue
        if part == "recoveries":
            check_settings(changed, registry)
        else:
            registry.check(part, changed[part])
