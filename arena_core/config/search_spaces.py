"""What is searched when a planner, or what guides it, is tuned: ranges of parameters, data that plugins ship in
``tune/``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.resources.abc import Traversable
from typing import Any, Literal

from arena_core.base.errors import ConfigurationError, InputFileError
from arena_core.base.files import reason_of
from arena_core.base.hints import did_you_mean, keys_below
from arena_core.config.binding import read_settings
from arena_core.config.option_file import check_option, option_text
from arena_core.config.option_folders import option_files
from arena_core.config.registry import Registry

GROUP = "tune"  # the configuration group whose options are search spaces, named as planners or their presets
Value = float | int | str | bool
ALLOWED = "sampler, and parameters: {KEY: {low, high, log, integer, unit, why} or {choices, unit, why}}"


@dataclass(frozen=True, slots=True)
class SearchRange:
    """What one parameter is chosen from: ``low`` to ``high``, by their logarithms where ``log``, or ``choices``."""

    why: str
    unit: str
    low: float | None = None
    high: float | None = None
    log: bool = False
    integer: bool = False
    choices: list[bool | float | str] | None = None

    def allows(self, value: Any) -> bool:
        """Return whether a value lies in the range."""
        if self.choices is not None:
            return any(value == one and isinstance(value, bool) == isinstance(one, bool) for one in self.choices)
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        return number and self.low is not None and self.high is not None and self.low <= value <= self.high

    def samples(self) -> list[Value]:
        """Return what is tried to see whether the range holds valid values: its ends and middle, or all choices."""
        if self.choices is not None:
            return list(self.choices)
        assert self.low is not None
        assert self.high is not None
        middle = math.sqrt(self.low * self.high) if self.log else 0.5 * (self.low + self.high)
        return [round(one) if self.integer else one for one in (self.low, middle, self.high)]

    def __str__(self) -> str:
        return ", ".join(map(str, self.choices)) if self.choices is not None else f"{self.low:g} .. {self.high:g}"


@dataclass(frozen=True, slots=True)
class SearchSpace:
    """The ranges of parameters by their keys, and which sampler suits them."""

    parameters: dict[str, SearchRange]
    sampler: Literal["tpe", "cmaes", "random"] = "tpe"


def search_space_of(preset: str, component: str, registry: Registry) -> SearchSpace:
    """Return the search space of a preset, else that of the planner that it is of; raise ConfigurationError where
    neither has one.
    """
    files = option_files(GROUP, registry.manager)
    name = preset if preset in files else component
    if name not in files:
        raise ConfigurationError(
            f"{preset} has no search space, {GROUP}/{name}.yaml in a conf folder; "
            f"allowed: {', '.join(files) or 'none installed'}"
        )
    return read_search_space(files[name])


def read_search_space(file: Traversable) -> SearchSpace:
    """Read a search space; raise InputFileError for what is none."""
    import yaml

    text = option_text(file)
    try:
        check_option(file, yaml.compose(text, yaml.SafeLoader))
        content = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise InputFileError(f"{file}: is no YAML ({reason_of(error)}); allowed: {ALLOWED}") from None
    try:
        space = read_settings(content or {}, SearchSpace, "")
    except ConfigurationError as error:
        raise InputFileError(f"{file}: {str(error).strip()}; allowed: {ALLOWED}") from None
    if not space.parameters:
        raise InputFileError(f"{file}: parameters is empty; allowed: a range at least")
    for key, one in space.parameters.items():
        if fault := _fault_of(one):
            raise InputFileError(f"{file}: parameters.{key} {fault}")
    return space


def _fault_of(one: SearchRange) -> str:
    """Return what is wrong with a range by itself, empty where nothing is."""
    if one.choices is not None:
        wrong = len(one.choices) < 2 or one.low is not None or one.high is not None
        return "has no two choices, or low and high beside them; allowed: choices: [A, B]" if wrong else ""
    if one.low is None or one.high is None:
        return "lacks low or high; allowed: both, or choices"
    if one.low >= one.high:
        return f"is {one.low:g} .. {one.high:g}, which holds no value; allowed: low below high"
    if one.log and one.low <= 0.0:
        return f"begins at {one.low:g} and is log; allowed: low > 0"
    if one.integer and (one.low != round(one.low) or one.high != round(one.high)):
        return f"is {one} and integer; allowed: whole numbers"
    return ""


def check_search_space(space: SearchSpace, planner: Mapping[str, Any], registry: Registry) -> None:
    """Raise ConfigurationError where a space does not fit a planner's composed configuration, as ``check_ranges``."""
    check_ranges(space, planner, "planner", lambda config: registry.check("planner", config))


def check_ranges(
    space: SearchSpace, config: Mapping[str, Any], place: str, check: Callable[[Mapping[str, Any]], None]
) -> None:
    """Raise ConfigurationError where a space does not fit what its keys are of, which stands at ``place`` of the
    composed configuration (empty: it is all of it).

    Each parameter has to be there, its value inside the range, and some value of the range one that ``check`` takes.
    """
    for key, one in space.parameters.items():
        value, name = value_at(config, key, place), f"{place}.{key}".lstrip(".")
        if not one.allows(value):
            raise ConfigurationError(f"{name} is {value}, outside of what is searched; allowed: {one}")
        refusals = [
            refusal for sample in one.samples() if (refusal := _refusal(check, with_values(config, {key: sample})))
        ]
        if len(refusals) == len(one.samples()):
            raise ConfigurationError(f"the range of {name}, {one}, holds no valid value: {refusals[0]}")


def _refusal(check: Callable[[Mapping[str, Any]], None], config: Mapping[str, Any]) -> str:
    try:
        check(config)
    except ConfigurationError as error:
        return str(error)
    return ""


def value_at(config: Mapping[str, Any], key: str, place: str = "planner") -> Any:
    """Return the value of a key with dots in what stands at a place; raise ConfigurationError where there is none."""
    inside: Any = config
    for part in key.split("."):
        if not isinstance(inside, Mapping) or part not in inside:
            hint = did_you_mean(key, [*config, *keys_below(config)]) or "; allowed: its own"
            raise ConfigurationError(f"{place or 'the configuration'} has no parameter {key}, which is searched{hint}")
        inside = inside[part]
    return inside


def with_values(config: Mapping[str, Any], values: Mapping[str, Value]) -> dict[str, Any]:
    """Return a configuration, such as a planner's, with other values for some keys with dots."""
    changed = dict(config)
    for key, value in values.items():
        place, *rest = key.split(".", 1)
        changed[place] = with_values(changed[place], {rest[0]: value}) if rest else value
    return changed


def values_of(space: SearchSpace, config: Mapping[str, Any]) -> dict[str, Value]:
    """Return the values that a configuration, such as a planner's, has of what is searched."""
    return {key: value_at(config, key) for key in space.parameters}
