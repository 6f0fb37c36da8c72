"""A team's other robots: each has its own navigator, with the run's planner and robot or others."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from arena_core.base.errors import ConfigurationError, ImpossibleScenario
from arena_core.config.configuration import compose, to_plain
from arena_core.config.option_folders import option_files
from arena_core.config.plugins import load_plugins
from arena_core.config.privileged import PrivilegedPart, privileged_names
from arena_core.contracts.simulation import Simulator, TaskMode
from arena_core.loop.navigator import Navigator
from arena_core.values.episode import Member, Scenario
from arena_core.values.robot import Robot

Configuration = Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Builders:
    """What builds a robot, and the navigator of one, of a run's configuration."""

    robot: Callable[[Configuration], Robot]
    navigator: Callable[[Configuration, Robot], tuple[Navigator, Sequence[PrivilegedPart]]]


class Teammates:
    """Builds robots and navigators from the run's ``config`` when they are first asked for, and keeps them; ``first``
    is the navigator of the team's first robot, which the run chooses.
    """

    def __init__(self, config: Configuration, first: Navigator, build: Builders) -> None:
        self._config, self._first, self._build = config, first, build
        self._configs: dict[tuple[str, str], Configuration] = {("", ""): config}
        self._robots: dict[str, Robot] = {}
        self._tunings: set[tuple[str, str]] = set()
        self._built: dict[tuple[int, str, str], Navigator] = {}
        self._seeing: set[str] = set()

    def config(self, planner: str, robot: str = "") -> Configuration:
        """Return the run's configuration with a planner and a robot in place of its own, the planner tuned for the
        robot as ``planner=`` does; raise ConfigurationError where there is none of that name. Empty: the run's own.
        """
        if (planner, robot) not in self._configs:
            choices = self._config.get("choices", {})
            named = {kind: choices.get(kind, self._config[kind]["name"]) for kind in ("planner", "robot")}
            named |= {kind: name for kind, name in (("planner", planner), ("robot", robot)) if name}
            composed = compose([f"{kind}={name}" for kind, name in named.items()], hydra=True)
            self._tunings |= _planner_tunings(composed.hydra.runtime.choices)
            changed = {kind: to_plain(composed[kind]) for kind in (("planner", "robot") if robot else ("planner",))}
            self._configs[planner, robot] = {**self._config, **changed, "choices": {**choices, **named}}
        return self._configs[planner, robot]

    def robot(self, name: str) -> Robot:
        """Return the robot of a name; empty: the run's."""
        if not name:
            return self._first.robot
        if name not in self._robots:
            self._robots[name] = self._build.robot(self.config("", name)["robot"])
        return self._robots[name]

    def equip(self, scenario: Scenario) -> Scenario:
        """Return a scenario whose teammates have their bodies, and no planners of their own where the run's planner
        drives them all.
        """
        team = [replace(mate, body=self.robot(mate.robot)) if mate.robot else mate for mate in scenario.team]
        if self._first.planner.drives_team:
            team = [replace(mate, planner="") for mate in team]
        return replace(scenario, team=tuple(team))

    def navigators(self, scenario: Scenario) -> list[Navigator]:
        """Return the navigators of a scenario's team, but for the first robot's."""
        return [self._navigator(place, member) for place, member in enumerate(scenario.team)]

    def look_up(self, task: TaskMode, seed: int, simulator: Simulator) -> None:
        """Build what drives the teammates of the first scenario; raise ConfigurationError where there is no such
        planner or robot, the simulator does not know of such a team, or the run's reference of errands.
        """
        with suppress(ImpossibleScenario):
            scenario = self.equip(task.scenario(seed, 0))
            self.navigators(scenario)
            simulator.check_scenario(scenario)
            reference = (self._config.get("reference") or {}).get("name", "none")
            if scenario.errands is not None and reference != "none":
                raise ConfigurationError(
                    f"task {self._config['task']['name']} sends robots on until the time limit, and reference "
                    f"{reference} knows of one goal for each; allowed: reference=none"
                )

    @property
    def untuned(self) -> list[str]:
        """Return a line for each planner of a teammate that has no values for its robot, or says so itself."""
        manager = load_plugins()
        lacking = sorted(one for one in self._tunings if one[1] not in option_files(one[0], manager))
        groups = [(group.partition("@")[0].rpartition("/")[2], robot) for group, robot in lacking]
        names = [(group.removesuffix("_tuning"), robot) for group, robot in groups]
        own = (line for navigator in self._built.values() for line in navigator.planner.untuned)
        return list(dict.fromkeys([*(f"{name}: untuned for {robot}" for name, robot in names), *own]))

    @property
    def privileged(self) -> tuple[str, ...]:
        """Return what tables call the parts of teammates that see the truth, as far as these are built."""
        return tuple(sorted(self._seeing))

    def _navigator(self, place: int, member: Member) -> Navigator:
        key = (place, member.planner, member.robot)
        if key not in self._built:
            config = self.config(member.planner, member.robot)
            navigator, seeing = self._build.navigator(config, self.robot(member.robot))
            self._seeing |= {*privileged_names(seeing)}
            if abs(navigator.control_period - self._first.control_period) > 1e-9:
                what = f"planner {config['planner']['name']}" + (f" of {member.robot}" if member.robot else "")
                raise ConfigurationError(
                    f"{what} decides every {navigator.control_period:g} s, the first robot's every "
                    f"{self._first.control_period:g} s; allowed: planners with one control period in a team"
                )
            self._built[key] = navigator
        return self._built[key]


def _planner_tunings(choices: Mapping[str, Any]) -> set[tuple[str, str]]:
    """Return which tunings of planners were asked for: group and robot."""
    return {(group, str(robot)) for group, robot in choices.items() if re.match(r"planner/.*_tuning", group)}


def check_runs_teams(simulator: Simulator, config: Mapping[str, Any], robots: int) -> None:
    """Raise ConfigurationError where a run has teams and its simulator knows of one robot."""
    task = config["task"]["name"]
    if robots > 1 and not simulator.moves_teams:
        raise ConfigurationError(
            f"task {task} has {robots} robots, and simulator {config['simulator']['name']} moves one; allowed: "
            "simulator=sim2d"
        )


def check_team(scenario: Scenario, robots: int) -> None:
    """Raise ConfigurationError for a scenario with another number of robots than its task says, two of one name, or a
    person to keep with.
    """
    names = ["robot0", *(member.name for member in scenario.team)]
    if len(names) != robots:
        raise ConfigurationError(
            f"{scenario.name} has {len(names)} robots; allowed: {robots}, as all scenarios of a run"
        )
    if twice := next((name for name in names if names.count(name) > 1), ""):
        raise ConfigurationError(f"{scenario.name} has two robots named {twice}; allowed: names that differ")
    if scenario.company is not None:
        raise ConfigurationError(f"{scenario.name} has a person to keep with; allowed: with one robot only")
