"""``arena check``: the contract test of a component, as its author runs it."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any, ClassVar

from arena_core.errors import ConfigurationError, ContractViolation, UnknownComponent
from arena_core.interfaces import Command
from arena_core.listing import presets
from arena_core.registry import load_registry, unknown
from arena_core.robot import Kinematics, Robot
from arena_core.testing.checks import CHECKS, check
from arena_core.testing.samples import component, robot

BODIES: dict[str, tuple[Kinematics, ...]] = {
    "planner": ("differential", "omnidirectional", "ackermann"),
    "simulator": ("differential", "omnidirectional", "ackermann"),
    "reward": ("differential", "omnidirectional", "ackermann"),
    "observation_encoder": ("differential", "omnidirectional", "ackermann"),
}


class CheckCommand(Command):
    """Try the contract of a component, or of everything that is installed."""

    help: ClassVar[str] = "the contract test of a component: arena check KIND=NAME [KEY=VALUE ...] | all"

    def run(self, arguments: Sequence[str]) -> int:
        """Check every named preset; return 1 when one breaks its contract."""
        parser = argparse.ArgumentParser("arena check", description=self.__doc__)
        parser.add_argument("request", nargs="+", metavar="KIND=NAME", help="a component, then overrides; or: all")
        given = parser.parse_args(list(arguments)).request
        if given == ["all"]:
            return max(_check_or_say_why_not(kind, preset) for kind in CHECKS for preset in presets(load_registry(), kind))
        kind, _, preset = given[0].partition("=")
        if kind not in CHECKS:
            raise UnknownComponent(unknown("kind", kind, list(CHECKS)))
        if not preset:
            raise ConfigurationError(f"no name given; allowed: {kind}= one of {', '.join(presets(load_registry(), kind))}")
        return _check_preset(kind, preset, given[1:])


def _check_or_say_why_not(kind: str, preset: str) -> int:
    """Check one preset; one that cannot be built without values from its user (a file, say) is named and passed over."""
    try:
        return _check_preset(kind, preset, [])
    except ConfigurationError as error:
        print(f"-- {kind}={preset} needs values: {error}")
        return 0


def _check_preset(kind: str, preset: str, overrides: Sequence[str]) -> int:
    """Check one preset on every kind of robot that matters to it and print what held."""
    bodies = BODIES.get(kind, ("differential",))
    for kinematics in bodies:
        body = robot(kinematics)
        try:
            facts = check(kind, component(kind, preset, overrides, **_context(kind, body)), body)
        except ContractViolation as violation:
            print(f"BROKEN {kind}={preset} ({kinematics}): {violation}")
            return 1
        on = f" on a robot with {kinematics} drive" if len(bodies) > 1 else ""
        print(f"ok {kind}={preset}: {len(facts)} facts hold{on}")
    return 0


def _context(kind: str, body: Robot) -> dict[str, Any]:
    """Return what the constructor of a kind is given beside its YAML."""
    if kind == "task":
        return {"robot": body, "world": component("world", "empty")}
    if kind == "simulator":
        return {"robot": body, "pedestrians": component("pedestrians", "social_force")}
    return {"robot": body} if kind not in ("robot", "world", "pedestrians", "metrics", "executor") else {}
