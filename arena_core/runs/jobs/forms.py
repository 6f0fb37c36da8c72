"""Forms: the parameters of an option with unit, meaning and what is allowed, from its YAML and
its component's constructor.
"""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from arena_core.base.errors import ConfigurationError
from arena_core.config.binding import parameter_types, read_settings
from arena_core.config.configuration import PRIMARY
from arena_core.config.option_folders import option_files
from arena_core.config.presets import Parameter, Path, Preset, about_of, options_of, read_preset
from arena_core.config.registry import HOOKS, INTERFACES, Registry
from arena_core.loop.execution import Timing
from arena_core.loop.guide import ReplanRules
from arena_core.loop.recording import RecordingSettings
from arena_core.loop.recovery import RecoveryRules
from arena_core.runs.jobs.benchmark import NEEDED, RunSettings, check_complete, metric_packs
from arena_core.values.parameters import Bounds

RULES: Mapping[str, Any] = {"replan": ReplanRules, "recoveries": RecoveryRules}
SETTINGS: Mapping[str, Any] = {"timing": Timing, "recording": RecordingSettings}
KINDS = {float: "number", int: "whole", bool: "truth", str: "text"}
BASE = "base/"  # the subgroup of what presets derive from, which cannot run by itself
GLOBAL = "_global_"  # Hydra's name of the configuration's top


@dataclass(frozen=True, slots=True)
class Field:
    """One parameter: ``key`` is what an override calls it; ``kind`` is number, whole, truth, choice, text or other.

    ``allowed`` says in words which values are possible (empty: nothing is known), ``choices`` are those of a choice.
    ``optional`` fields may be null.
    """

    key: str
    value: str
    unit: str
    text: str
    kind: str
    allowed: str
    choices: tuple[str, ...]
    optional: bool


@dataclass(frozen=True, slots=True)
class Form:
    """An option of a configuration group: what it is, the component that it configures (empty:
    none), and its parameters in order.
    """

    about: str
    component: str
    fields: tuple[Field, ...]


def option_names(group: str, registry: Registry) -> dict[str, str]:
    """Return the options of a group with what each is, in order; raise ConfigurationError for a
    group that no one brings.
    """
    files = options_of(group, registry.manager)
    if not files:
        raise ConfigurationError(f"there is no group {group}; `arena list` shows what is installed")
    return {name: about_of(file) for name, file in files.items() if not name.startswith(BASE)}


def default_options(registry: Registry) -> dict[str, str]:
    """Return which option of each group ``arena run`` takes by itself; ``null`` is
    none, several stand between commas.
    """
    return dict(read_preset(PRIMARY, option_files("", registry.manager)).choices)


def form_of(group: str, option: str, registry: Registry) -> Form:
    """Return the form of one option, without its tuning for a robot; raise ConfigurationError
    where there is no such option.
    """
    files = option_files(group, registry.manager)
    if option not in files:
        raise ConfigurationError(f"{group} has no option {option}; allowed: {', '.join(option_names(group, registry))}")
    preset = read_preset(option, files)
    top = _own_annotations(group, preset, registry)
    place = {"": group, GLOBAL: ""}.get(preset.package, preset.package)
    return Form(preset.about, preset.component, _make_fields(preset, place, top, registry))


def settings_form(registry: Registry) -> Form:
    """Return the form of the run's own settings: episodes, seed, timing and what is recorded."""
    preset = read_preset(PRIMARY, option_files("", registry.manager))
    top = {**parameter_types(RunSettings), **SETTINGS}
    known = {path: parameter for path, parameter in preset.parameters.items() if path[0] in top}
    return Form(preset.about, "", _make_fields(dataclasses.replace(preset, parameters=known), "", top, registry))


def check_settings(config: Mapping[str, Any], registry: Registry) -> None:
    """Raise ConfigurationError for the first key or value of a composed configuration that nothing takes; nothing is
    built.

    Whether the values go together is known once ``build_benchmark`` has built them.
    """
    check_complete(config)
    read_settings({name: config[name] for name in RunSettings.__slots__}, RunSettings, "")
    for name, record in (*RULES.items(), *SETTINGS.items()):
        read_settings(config[name], record, name)
    for kind in (name for name in NEEDED if name in HOOKS):
        registry.check(kind, config[kind])
    for pack in metric_packs(config).values():
        registry.check("metrics", pack)


def _own_annotations(group: str, preset: Preset, registry: Registry) -> Mapping[str, Any]:
    """Return the annotations of an option's own keys, as far as they are known."""
    if group in RULES:
        return parameter_types(RULES[group])
    if group in HOOKS and preset.component in registry.names(group):
        return {
            **parameter_types(registry.component(group, preset.component).resolve()),
            **(RULES if group == "planner" else {}),
        }
    return {}


def _make_fields(preset: Preset, place: str, top: Mapping[str, Any], registry: Registry) -> tuple[Field, ...]:
    above = {path[:-1] for path in preset.parameters}
    leaves = [parameter for path, parameter in preset.parameters.items() if path not in above]
    return tuple(
        _make_field(leaf, place, _find_annotation(leaf.path, top, preset, registry))
        for leaf in leaves
        if leaf.path[-1] != "name"
    )


def _make_field(parameter: Parameter, place: str, annotation: Any) -> Field:
    kind, allowed, choices, optional = _describe_type(annotation, parameter.value)
    key = ".".join((place, *parameter.path) if place else parameter.path)
    return Field(key, parameter.value, parameter.unit, parameter.text, kind, allowed, choices, optional)


def _find_annotation(path: Path, top: Mapping[str, Any], preset: Preset, registry: Registry) -> Any:
    """Return what a key's value has to be, or None where no one says: it is looked up from the
    outermost mapping inwards.
    """
    found = top.get(path[0])
    for depth in range(1, len(path)):
        named = preset.parameters.get((*path[:depth], "name"))
        found = _inner_annotation(found, path[depth], named.value if named else "", registry)
    return found


def _inner_annotation(annotation: Any, name: str, component: str, registry: Registry) -> Any:
    """Return the annotation of a key inside what ``annotation`` describes: a record,
    a mapping, or a component by name.
    """
    for one in _possible_types(annotation):
        if isinstance(one, type) and dataclasses.is_dataclass(one):
            return parameter_types(one).get(name)
        if get_origin(one) in (dict, Mapping):
            return get_args(one)[1]
        kind = INTERFACES.get(one) if isinstance(one, type) else None
        if kind and component in registry.names(kind):
            return parameter_types(registry.component(kind, component).resolve()).get(name)
    return None


def _possible_types(annotation: Any) -> list[Any]:
    """Return the types that a value may have, without None and without bounds."""
    if get_origin(annotation) is Annotated:
        return _possible_types(get_args(annotation)[0])
    if get_origin(annotation) in (Union, types.UnionType):
        return [kind for one in get_args(annotation) if one is not type(None) for kind in _possible_types(one)]
    return [annotation]


def _describe_type(annotation: Any, value: str) -> tuple[str, str, tuple[str, ...], bool]:
    """Return kind, what is allowed, choices, and whether null is."""
    optional = get_origin(annotation) in (Union, types.UnionType) and type(None) in get_args(annotation)
    kinds = [one for one in get_args(annotation) if one is not type(None)] if optional else [annotation]
    if len(kinds) != 1:
        return "other", "", (), optional
    one = kinds[0]
    bounds = (
        next((b for b in get_args(one)[1:] if isinstance(b, Bounds)), None) if get_origin(one) is Annotated else None
    )
    bare = get_args(one)[0] if get_origin(one) is Annotated else one
    if get_origin(bare) is Literal:
        choices = tuple(_format_choice(choice) for choice in get_args(bare))
        return "choice", f"one of {', '.join(choices)}", choices, optional
    kind = KINDS.get(bare, "other") if isinstance(bare, type) else _guess_kind(value) if bare is None else "other"
    return kind, str(bounds) if bounds else "", (), optional


def _format_choice(choice: Any) -> str:
    return str(choice).lower() if isinstance(choice, bool) else str(choice)


def _guess_kind(value: str) -> str:
    """Return the kind of a value that no one describes, by how it is written."""
    if value in ("true", "false"):
        return "truth"
    with suppress(ValueError):
        float(value)
        return "number"
    return "other"
