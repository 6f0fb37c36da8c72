"""The navigators of a team's other robots: each has its own, with the run's planner or another one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from arena_core.base.errors import ConfigurationError
from arena_core.config.configuration import compose, to_plain
from arena_core.config.privileged import PrivilegedPart, privileged_names
from arena_core.contracts.simulation import Simulator
from arena_core.loop.navigator import Navigator
from arena_core.values.episode import Scenario

Build = Callable[[Mapping[str, Any]], Navigator]


class Teammates:
    """Builds navigators by ``build`` from the run's ``config`` when they are first asked for, and keeps them."""

    def __init__(self, config: Mapping[str, Any], build: Build, control_period: float) -> None:
        self._config, self._build, self._period = config, build, control_period
        self._configs: dict[str, Mapping[str, Any]] = {"": config}
        self._built: dict[tuple[int, str], Navigator] = {}

    def config(self, planner: str) -> Mapping[str, Any]:
        """Return the run's configuration with a planner in place of its own, tuned for its robot as ``planner=`` does;
        raise ConfigurationError where there is none of that name. Empty: the run's own.
        """
        if planner not in self._configs:
            choices = self._config.get("choices", {})
            robot = choices.get("robot", self._config["robot"]["name"])
            node = to_plain(compose([f"planner={planner}", f"robot={robot}"]))["planner"]
            own = {"planner": node, "choices": {**choices, "planner": planner}}
            self._configs[planner] = {**self._config, **own}
        return self._configs[planner]

    def navigators(self, scenario: Scenario) -> list[Navigator]:
        """Return the navigators of a scenario's team, but for the first robot's."""
        return [self._navigator(place, member.planner) for place, member in enumerate(scenario.team)]

    def _navigator(self, place: int, planner: str) -> Navigator:
        if (place, planner) not in self._built:
            navigator = self._build(self.config(planner))
            if abs(navigator.control_period - self._period) > 1e-9:
                raise ConfigurationError(
                    f"planner {planner} decides every {navigator.control_period:g} s, the first robot's every "
                    f"{self._period:g} s; allowed: planners with one control period in a team"
                )
            self._built[place, planner] = navigator
        return self._built[place, planner]


def check_runs_teams(simulator: Simulator, config: Mapping[str, Any], robots: int) -> None:
    """Raise ConfigurationError where a run has teams and its simulator, or its reference, knows of one robot."""
    task = config["task"]["name"]
    if robots > 1 and not simulator.moves_teams:
        raise ConfigurationError(
            f"task {task} has {robots} robots, and simulator {config['simulator']['name']} moves one; allowed: "
            "simulator=sim2d"
        )
    reference = (config.get("reference") or {}).get("name")
    if robots > 1 and reference not in (None, "none"):
        raise ConfigurationError(
            f"task {task} has {robots} robots, and reference {reference} knows of one; allowed: reference=none"
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


def check_sees_nothing(seeing: Sequence[PrivilegedPart]) -> None:
    """Raise ConfigurationError for parts of a navigator that see the truth: they know of one robot."""
    if seeing:
        names = " and ".join(privileged_names(seeing))
        raise ConfigurationError(f"{names} cannot be in a team; allowed: parts that do not see the truth")
