"""What is installed, by kind and name, and how it is built from its configuration."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import pluggy

from arena_core.base.errors import (
    ArenaError,
    BrokenPlugin,
    ConfigurationError,
    DuplicateComponent,
    UnknownComponent,
    describe_error,
)
from arena_core.base.hints import did_you_mean
from arena_core.base.suite import distribution_hint
from arena_core.config.binding import Nested, bind_arguments, build_component, parameter_types
from arena_core.config.plugins import broken_plugin, load_plugins, plugin_distributions
from arena_core.config.privileged import note_part
from arena_core.contracts import communication, learning, navigation, running, simulation
from arena_core.contracts.hookspecs import Factory
from arena_core.loop.navigator import NAVIGATOR_KEYS
from arena_core.values.robot import Robot

HOOKS = {
    "simulator": "register_simulators",
    "robot": "register_robots",
    "world": "register_worlds",
    "pedestrians": "register_pedestrian_models",
    "task": "register_task_modes",
    "patrol_strategy": "register_patrol_strategies",
    "communication": "register_communications",
    "localizer": "register_localizers",
    "global_planner": "register_global_planners",
    "waypoints": "register_waypoint_generators",
    "local_map": "register_local_maps",
    "tracker": "register_trackers",
    "predictor": "register_predictors",
    "planner": "register_planners",
    "metrics": "register_metrics",
    "reward": "register_rewards",
    "observation_encoder": "register_observation_encoders",
    "policy": "register_policies",
    "trainer": "register_trainers",
    "executor": "register_executors",
    "command": "register_commands",
    "listing": "register_listings",
    "reporter": "register_reporters",
    "export": "register_exports",
    "reference": "register_references",
}

INTERFACES: dict[type, str] = {
    simulation.Simulator: "simulator",
    Robot: "robot",
    simulation.WorldSource: "world",
    simulation.PedestrianModel: "pedestrians",
    simulation.TaskMode: "task",
    simulation.PatrolStrategy: "patrol_strategy",
    communication.Communication: "communication",
    navigation.Localizer: "localizer",
    navigation.GlobalPlanner: "global_planner",
    navigation.WaypointGenerator: "waypoints",
    navigation.LocalMap: "local_map",
    navigation.Tracker: "tracker",
    navigation.Predictor: "predictor",
    navigation.Planner: "planner",
    running.MetricPack: "metrics",
    running.Executor: "executor",
    running.Reference: "reference",
    learning.Reward: "reward",
    learning.ObservationEncoder: "observation_encoder",
    learning.Trainer: "trainer",
}


@dataclass(frozen=True, slots=True)
class Component:
    """One thing that a plugin offers."""

    kind: str
    name: str
    factory: Factory
    plugin: str

    def resolve(self) -> Callable[..., Any]:
        """Import the factory if it is lazy."""
        if callable(self.factory):
            return self.factory
        module, _, attribute = self.factory.partition(":")
        try:
            return getattr(importlib.import_module(module), attribute)  # type: ignore[no-any-return]
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # sys.exit() of a module, too
            raise BrokenPlugin(
                f"plugin {self.plugin}: {self.kind} {self.name} cannot be imported ({describe_error(error)})"
            ) from error

    def distribution(self) -> tuple[str, str]:
        """Return the name and version of the distribution that brought the plugin."""
        return plugin_distributions().get(self.plugin, (self.plugin, "-"))


class Registry:
    """All installed components; ask it for one by kind and name, or have it built from a configuration node."""

    def __init__(self, manager: pluggy.PluginManager) -> None:
        self.manager = manager
        self._components: dict[str, dict[str, Component]] = {kind: {} for kind in HOOKS}
        for kind, hook in HOOKS.items():
            for implementation in getattr(manager.hook, hook).get_hookimpls():
                self._collect_components(kind, implementation)

    def names(self, kind: str) -> list[str]:
        """Return the installed names of a kind, sorted."""
        return sorted(self._components[kind])

    def component(self, kind: str, name: str) -> Component:
        """Return one component; raise UnknownComponent with the installed names."""
        try:
            return self._components[kind][name]
        except KeyError:
            raise UnknownComponent(unknown_name(kind, name, self.names(kind))) from None

    def build(self, kind: str, node: Mapping[str, Any], **context: Any) -> Any:
        """Build the component that ``node["name"]`` names from the node's other keys and the context that it asks for.

        Raises ConfigurationError, naming the key and what is allowed, before anything runs.
        """
        if not isinstance(node, Mapping) or "name" not in node:
            raise ConfigurationError(
                f"{kind} has no key name; choose one with {kind}=..., installed: {', '.join(self.names(kind))}"
            )
        return self._build_component(kind, node, kind, context)

    def check(self, kind: str, node: Mapping[str, Any]) -> None:
        """Raise ConfigurationError for a key or value of ``node`` that its component
        does not take; nothing is built.
        """
        self._check_component(kind, node, kind, {})

    def _check_component(self, kind: str, node: Mapping[str, Any], key: str, context: Mapping[str, Any]) -> Any:
        component = self.component(kind, str(node.get("name")))
        factory = component.resolve()
        own = _component_keys(kind, node)
        elsewhere = dict.fromkeys(name for name in parameter_types(factory) if name not in own)
        bind_arguments(factory, own, key, elsewhere, self._nested_builder(self._check_component))
        return node

    def _build_component(self, kind: str, node: Mapping[str, Any], key: str, context: Mapping[str, Any]) -> Any:
        component = self.component(kind, str(node["name"]))
        try:
            built = build_component(
                component.resolve(),
                _component_keys(kind, node),
                key,
                context,
                self._nested_builder(self._build_component),
            )
            note_part(kind, component.name, built)
            return built
        except (ArenaError, MemoryError, KeyboardInterrupt):
            raise
        except BaseException as error:
            raise broken_plugin(component.plugin, error) from error

    def _nested_builder(self, make: Callable[[str, Mapping[str, Any], str, Mapping[str, Any]], Any]) -> Nested:
        """Return what builds or checks components inside another one's configuration."""

        def nested(annotation: Any, node: Any, key: str, context: Mapping[str, Any]) -> Any:
            """Return NotImplemented where ``annotation`` is no interface."""
            kind = INTERFACES.get(annotation) if isinstance(annotation, type) else None
            if kind is None or not isinstance(node, Mapping) or "name" not in node:
                return NotImplemented
            return make(kind, node, key, context)

        return nested

    def _collect_components(self, kind: str, implementation: pluggy.HookImpl) -> None:
        plugin = implementation.plugin_name
        known = self._components[kind]

        def register(name: str, factory: Factory) -> None:
            if name in known:
                raise DuplicateComponent(f"{kind} {name} is offered by two plugins: {known[name].plugin} and {plugin}")
            known[name] = Component(kind, name, factory, plugin)

        try:
            implementation.function(register=register)
        except (DuplicateComponent, KeyboardInterrupt):
            raise
        except BaseException as error:
            raise broken_plugin(plugin, error) from error


def _component_keys(kind: str, node: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a node that are its component's: what a planner's says of
    its navigator is not the planner's.
    """
    return {name: value for name, value in node.items() if kind != "planner" or name not in NAVIGATOR_KEYS}


def load_registry() -> Registry:
    """Return what all plugins offer; it is made once in a process."""
    return registry_of(load_plugins())


@lru_cache(maxsize=1)
def registry_of(manager: pluggy.PluginManager) -> Registry:
    """Return what the plugins of a manager offer."""
    return Registry(manager)


def unknown_name(kind: str, name: str, known: list[str]) -> str:
    """Return the line for a name that nothing installed has: who brings it, or the nearest one."""
    if brought := distribution_hint(kind, name):
        return f"{kind} {name} {brought}"
    return f"unknown {kind} {name!r}{did_you_mean(name, known)} (possible: {', '.join(known) or 'none installed'})"
