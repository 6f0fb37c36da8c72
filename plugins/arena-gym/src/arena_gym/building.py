"""From names and overrides to the parts of an environment."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from arena_core import ConfigurationError, ObservationEncoder, Reward, Robot, Simulator, WaypointGenerator
from arena_core.commands import key_value
from arena_core.hosting import Guide, Registry, build_guide, check_sections, compose, load_registry, to_plain
from arena_core.parameters import read_settings
from arena_gym.batched_guidance import GuidanceModel, read_model
from arena_gym.driver import Driver
from arena_gym.pool import PooledWorlds, ProblemPool
from arena_gym.privileged import allowed_privileged
from arena_gym.settings import EnvironmentSettings, Randomization, SwitchSettings
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.members import Members, build_members, describe_members

NEEDED = (
    "environment",
    "action",
    "randomization",
    "simulator",
    "robot",
    "world",
    "pedestrians",
    "task",
    "global_planner",
    "waypoints",
    "reward",
    "observation_encoder",
)
SPARED = ("guide", "switch")  # sections that there need not be
# as a whole, by another choice
REPLACED = ("world", "task", "pedestrians", "reward", "observation_encoder", "global_planner", "waypoints")


@dataclass(frozen=True, slots=True, eq=False)
class SwitchParts:
    """Planners that an action chooses among: what a card says of them, and how one world's are made.

    A policy decides at every ``every``-th control step; an action holds for ``held`` such decisions.
    """

    every: int
    held: int
    members: Mapping[str, Mapping[str, str]]
    make_driver: Callable[[], Driver]


@dataclass(frozen=True, slots=True, eq=False)
class Parts:
    """What an environment is made of; ``config`` is the composed configuration in plain containers.

    With ``switch`` an action chooses a planner, else it is a velocity. With ``make_guide`` each robot localises and
    plans by a guide of its own; without, it knows its pose and keeps the path that was planned at first. With a
    ``guidance_model`` that stands for such guides.
    """

    config: Mapping[str, Any]
    robot: Robot
    simulator: Simulator
    waypoints: WaypointGenerator
    pool: ProblemPool
    encoder: ObservationEncoder
    reward: Reward
    scale: ActionScale
    settings: EnvironmentSettings
    randomization: Randomization
    switch: SwitchParts | None
    make_guide: Callable[[], Guide] | None
    guidance_model: GuidanceModel | None = None

    @property
    def decision_period(self) -> float:
        """Return for how long an action holds in training, s."""
        steps = self.settings.every if self.switch is None else self.switch.every * self.switch.held
        return steps * self.robot.control_period


def compose_environment(
    overrides: Sequence[str] = (), primary: str = "environment", **choices: str | None
) -> dict[str, Any]:
    """Return the configuration ``primary`` with these components and overrides; raise
    ConfigurationError in one line.
    """
    chosen = [f"{kind}={name}" for kind, name in choices.items() if name is not None]
    return to_plain(compose([*chosen, *overrides], primary))


def compose_training(recipe: str | None, overrides: Sequence[str], primary: str = "train") -> dict[str, Any]:
    """Return the configuration of a training by a recipe (None: the default one) with overrides; raise
    ConfigurationError in one line.

    A component that the overrides choose in place of the recipe's (``world=ros_map``) is as it is by itself: what the
    recipe says of its own choice is not for another. ``primary`` is the file that all is composed from.
    """
    chosen = [f"recipe={recipe}"] if recipe is not None else []
    for word in overrides:
        if word.startswith("~") and not any(mark in word for mark in (".", *SPARED)):
            raise ConfigurationError(
                f"{word} takes away what a training needs; allowed: {', '.join(f'~{name}' for name in SPARED)}"
            )
    config = compose_environment([*chosen, *overrides], primary=primary)
    given = dict(map(key_value, overrides))
    if hydras := [key for key in given if key.startswith("hydra.")]:
        raise ConfigurationError(f"{hydras[0]} is for `arena run`; allowed: out=DIR takes another folder")
    for kind in (key for key in given if key in REPLACED and "{" not in given[key]):
        others = [
            word for word in overrides if key_value(word)[0] != kind and not key_value(word)[0].startswith(f"{kind}.")
        ]
        by_recipe = compose([*chosen, *others], primary, hydra=True).hydra.runtime.choices[kind]
        if by_recipe is None or config[kind] is None or by_recipe == given[kind]:
            continue
        own = [word for word in overrides if key_value(word)[0].partition(".")[0] in (kind, "robot", "people")]
        config[kind] = compose_environment(own)[kind]
    return config


def build_parts(config: Mapping[str, Any], registry: Registry | None = None) -> Parts:
    """Build every component; raise ConfigurationError for the first thing that is wrong."""
    registry = registry or load_registry()
    check_sections(config, NEEDED)
    settings = read_settings(config["environment"], EnvironmentSettings, "environment")
    with allowed_privileged(config):
        return _build_checked(config, registry, settings)


def _build_checked(config: Mapping[str, Any], registry: Registry, settings: EnvironmentSettings) -> Parts:
    robot = registry.build("robot", config["robot"])
    return Parts(
        config=config,
        robot=robot,
        simulator=_build_simulator(config, registry, robot),
        waypoints=registry.build("waypoints", config["waypoints"], robot=robot),
        pool=_build_pool(config, registry, robot, settings),
        encoder=registry.build("observation_encoder", config["observation_encoder"], robot=robot),
        reward=registry.build("reward", config["reward"], robot=robot),
        scale=ActionScale.of(robot, read_settings(config["action"], ActionRange, "action")),
        settings=settings,
        randomization=read_settings(config["randomization"], Randomization, "randomization"),
        switch=_build_switch(config, registry, robot),
        make_guide=_guide_factory(config, registry, robot),
        guidance_model=None if config.get("guide") is None else read_model(config["guide"]),
    )


def _guide_factory(config: Mapping[str, Any], registry: Registry, robot: Robot) -> Callable[[], Guide] | None:
    """Return what makes a guide as a benchmark has them, one of which is made at once so that
    errors are said now; None without.
    """
    if config.get("guide") is None:
        return None
    brain = {**{name: config[name] for name in ("global_planner", "waypoints")}, **config["guide"]}

    def make_guide() -> Guide:
        return build_guide(brain, registry, robot)

    make_guide()
    return make_guide


def _build_switch(config: Mapping[str, Any], registry: Registry, robot: Robot) -> SwitchParts | None:
    """Build the members once, so that whatever is wrong with one is said now; None where actions are velocities."""
    if config.get("switch") is None:
        return None
    settings = read_settings(config["switch"], SwitchSettings, "switch")
    members = build_members(settings.members, tuple(settings.members), robot, registry, "switch.members")

    def make_driver() -> Driver:
        with allowed_privileged(config) as seeing:
            own = Members(build_members(settings.members, tuple(settings.members), robot, registry, "switch.members"))
            local_map = registry.build("local_map", settings.local_map, robot=robot)
            tracker = registry.build("tracker", settings.tracker, robot=robot)
        driver = Driver(robot, own, local_map, tracker)
        driver.privileged = [one.part for one in seeing]
        return driver

    return SwitchParts(
        settings.every, settings.held, describe_members(settings.members, members, registry), make_driver
    )


def _build_pool(
    config: Mapping[str, Any], registry: Registry, robot: Robot, settings: EnvironmentSettings
) -> ProblemPool:
    worlds = PooledWorlds(registry.build("world", config["world"]), settings.worlds)
    task = registry.build("task", config["task"], robot=robot, world=worlds)
    planner = registry.build("global_planner", config["global_planner"], robot=robot)
    waypoints = registry.build("waypoints", config["waypoints"], robot=robot)
    size = settings.worlds * settings.problems_per_world
    return ProblemPool(
        task, planner, waypoints, _build_simulator(config, registry, robot), settings.seed, settings.worlds, size
    )


def _build_simulator(config: Mapping[str, Any], registry: Registry, robot: Robot) -> Simulator:
    pedestrians = registry.build("pedestrians", config["pedestrians"])
    simulator: Simulator = registry.build("simulator", config["simulator"], robot=robot, pedestrians=pedestrians)
    return simulator
