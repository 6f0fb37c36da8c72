"""``arena check``: the contract test of a component, as its author runs it."""

from __future__ import annotations

import argparse
import re
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from arena_core.base.errors import (
    ArenaError,
    ConfigurationError,
    ContractViolation,
    ImpossibleScenario,
    UnknownComponent,
)
from arena_core.cli.candidates import complete_overrides
from arena_core.cli.listing import preset_files
from arena_core.cli.words import key_value
from arena_core.config.configuration import compose, to_plain
from arena_core.config.option_folders import option_files
from arena_core.config.presets import read_preset
from arena_core.config.registry import load_registry, unknown_name
from arena_core.config.search_spaces import GROUP, check_search_space, read_search_space
from arena_core.contracts.running import Command
from arena_core.testing.checks import CHECKS, check
from arena_core.testing.samples import component, robot
from arena_core.values.robot import Kinematics, Robot

BODIES: dict[str, tuple[Kinematics, ...]] = {
    "planner": ("differential", "omnidirectional", "ackermann"),
    "simulator": ("differential", "omnidirectional", "ackermann"),
    "reward": ("differential", "omnidirectional", "ackermann"),
    "observation_encoder": ("differential", "omnidirectional", "ackermann"),
}

Body = tuple[str | None, Robot]  # with the preset that a planner is tuned for


class CheckCommand(Command):
    """Try the contract of a component, or of everything that is installed."""

    help: ClassVar[str] = "the contract test of a component: arena check KIND=NAME [KEY=VALUE ...] | all"

    def run(self, arguments: Sequence[str]) -> int:
        """Check every named preset; return 1 when one breaks its contract."""
        parser = argparse.ArgumentParser("arena check", description=self.__doc__)
        parser.add_argument("request", nargs="+", metavar="KIND=NAME", help="a component, then overrides; or: all")
        given = parser.parse_args(list(arguments)).request
        if given == ["all"]:
            return max(_check_or_say_why_not(kind, preset) for kind in CHECKS for preset in _component_presets(kind))
        kind, preset = key_value(given[0])
        if kind not in CHECKS:
            return _command_that_checks(kind).check(preset, given[1:])
        if not preset:
            raise ConfigurationError(
                f"no name given; allowed: {kind}= one of {', '.join(preset_files(load_registry(), kind))}"
            )
        strangers = [word for word in given[1:] if not re.match(rf"[+~]*({kind}[.@]|robot[.=])", word)]
        if strangers:
            raise ConfigurationError(
                f"{strangers[0]} says nothing of {kind}={preset}; allowed: {kind}.KEY=VALUE, robot=NAME"
            )
        return _check_preset(kind, preset, given[1:])

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return kinds and their presets, then the keys of the one that is checked."""
        found = complete_overrides(words, word, primary="component")
        return found if words else [*(one for one in found if one.partition("=")[0] in CHECKS), "all"]


def _command_that_checks(kind: str) -> Command:
    """Return the command that checks options of a kind that no component is of; raise UnknownComponent where none
    does.
    """
    registry = load_registry()
    commands = [registry.component("command", name).resolve() for name in registry.names("command")]
    by_kind = {command.checks: command for command in commands if command.checks}  # type: ignore[attr-defined]
    if kind not in by_kind:
        raise UnknownComponent(unknown_name("kind", kind, [*CHECKS, *by_kind]))
    command: Command = by_kind[kind]()
    return command


def _component_presets(kind: str) -> list[str]:
    """Return the presets of a kind that choose a component, as communication=none does not."""
    registry = load_registry()
    files = option_files(kind, registry.manager)
    return [preset for preset in preset_files(registry, kind) if read_preset(preset, files).component]


def _check_or_say_why_not(kind: str, preset: str) -> int:
    """Check one preset; one that cannot be built without values from its user (a
    file, say) is named and passed over.
    """
    try:
        return _check_preset(kind, preset, [])
    except (ConfigurationError, ImpossibleScenario) as error:
        print(f"-- {kind}={preset} needs values: {error}")
        return 0


def _check_preset(kind: str, preset: str, overrides: Sequence[str]) -> int:
    """Check one preset on every kind of robot that matters to it and print what held, and what a
    planner refuses to drive.
    """
    bodies, refused = _sample_robots(kind, preset, overrides)
    for drive, reason in refused.items():
        print(f"-- {kind}={preset} drives no robot with {drive} drive: {reason}")
    for tuned_for, body in bodies:
        try:
            facts = check(kind, component(kind, preset, overrides, tuned_for, **_build_context(kind, body)), body)
        except ContractViolation as violation:
            print(f"BROKEN {kind}={preset} ({body.name}, {body.kinematics}): {violation}")
            return 1
        on = (
            f" on {'a robot' if body.name == 'sample' else body.name} with {body.kinematics} drive"
            if kind in BODIES
            else ""
        )
        print(f"ok {kind}={preset}: {len(facts)} facts hold{on}")
    return _check_tuned_ranges(preset, overrides) if kind == "planner" else 0


def _check_tuned_ranges(preset: str, overrides: Sequence[str]) -> int:
    """Check a planner's own search space, where it has one, with its values for each robot; print what held."""
    registry = load_registry()
    files = option_files(GROUP, registry.manager)
    if preset not in files:
        return 0
    robots = [word for word in overrides if word.startswith("robot=")]
    for body in robots or [f"robot={name}" for name in preset_files(registry, "robot")]:
        try:
            space = read_search_space(files[preset])
            words = [word for word in overrides if word not in robots]
            composed = to_plain(compose([f"planner={preset}", body, *words], config_name="component"))
            check_search_space(space, composed["planner"], registry)
        except ArenaError as error:
            print(f"BROKEN {GROUP}={preset} ({body}): {error}")
            return 1
    print(f"ok {GROUP}={preset}: its ranges are valid and hold the planner's values")
    return 0


def _sample_robots(
    kind: str, preset: str, overrides: Sequence[str]
) -> tuple[list[Body], Mapping[str, ConfigurationError]]:
    """Return a sample of each drive that matters to a kind, and why a planner refuses others.

    For a planner that takes none of them, because it knows robots by name, those of them that are installed. Raises
    ConfigurationError, the first robot's, where a planner drives none.
    """
    samples: list[Body] = [(None, robot(kinematics)) for kinematics in BODIES.get(kind, ("differential",))]
    if kind != "planner":
        return samples, {}
    refused: dict[str, ConfigurationError] = {
        body.kinematics: why for tuned_for, body in samples if (why := _rejection(preset, overrides, (tuned_for, body)))
    }
    if len(refused) < len(samples):
        return [(tuned_for, body) for tuned_for, body in samples if body.kinematics not in refused], refused
    given = [word.removeprefix("robot=") for word in overrides if word.startswith("robot=")]
    named: list[Body] = [(None, component("robot", name)) for name in given]  # the overrides tune for it
    named = named or [(name, component("robot", name)) for name in preset_files(load_registry(), "robot")]
    refusals = [_rejection(preset, overrides, body) for body in named or samples]
    accepted = [body for body, refusal in zip(named, refusals, strict=False) if refusal is None]
    if not accepted and refusals[0] is not None:
        raise refusals[0]
    return accepted, {}


def _rejection(preset: str, overrides: Sequence[str], body: Body) -> ConfigurationError | None:
    try:
        component("planner", preset, overrides, body[0], robot=body[1])
    except ConfigurationError as error:
        return error
    return None


def _build_context(kind: str, body: Robot) -> dict[str, Any]:
    """Return what the constructor of a kind is given beside its YAML."""
    if kind == "task":
        return {"robot": body, "world": component("world", "empty")}
    if kind == "simulator":
        return {"robot": body, "pedestrians": component("pedestrians", "social_force")}
    return {"robot": body} if kind not in ("robot", "world", "pedestrians", "metrics", "executor") else {}
