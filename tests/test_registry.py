import sys

import pluggy
import pytest

from arena_core import ConfigurationError, Observation, Planner, Robot, Twist, hookimpl
from arena_core.config.registry import HOOKS, INTERFACES, Registry, load_registry
from arena_core.contracts import hookspecs
from arena_core.hosting import BrokenPlugin, DuplicateComponent, UnknownComponent
from arena_core.parameters import Positive
from arena_core.testing import robot


class Steady(Planner):
    def __init__(self, robot: Robot, speed: Positive) -> None:
        self.robot, self.speed = robot, speed

    def compute_velocity(self, observation: Observation) -> Twist:
        return Twist(self.speed)


class Switching(Planner):
    def __init__(self, robot: Robot, members: dict[str, Planner]) -> None:
        self.members = members

    def compute_velocity(self, observation: Observation) -> Twist:
        return self.members["one"].compute_velocity(observation)


class Plugin:
    """A plugin that offers these planners."""

    def __init__(self, **planners):
        self.planners = planners

    @hookimpl
    def register_planners(self, register):
        for name, factory in self.planners.items():
            register(name, factory)


def registry(**plugins):
    manager = pluggy.PluginManager("arena")
    manager.add_hookspecs(hookspecs)
    for name, plugin in plugins.items():
        manager.register(plugin, name=name)
    return Registry(manager)


def test_every_hook_has_a_kind_or_is_no_registration():
    hooks = {name for name in vars(hookspecs) if hasattr(getattr(hookspecs, name), "arena_spec")}
    assert hooks == {*HOOKS.values(), "config_package", "episode_finished"}


def test_every_interface_is_of_a_kind():
    assert set(INTERFACES.values()) <= set(HOOKS)


def test_names_are_sorted():
    assert registry(a=Plugin(zeta=Steady, alpha=Steady)).names("planner") == ["alpha", "zeta"]


def test_a_name_that_two_plugins_offer_is_an_error_that_names_both():
    with pytest.raises(
        DuplicateComponent, match=r"planner steady is offered by two plugins: (one and other|other and one)"
    ):
        registry(one=Plugin(steady=Steady), other=Plugin(steady=Steady))


def test_the_same_name_of_different_kinds_is_no_duplicate():
    class Both(Plugin):
        @hookimpl
        def register_robots(self, register):
            register("steady", "arena_core:make_robot")

    assert registry(a=Both(steady=Steady)).names("robot") == ["steady"]


def test_an_unknown_name_lists_what_is_installed_and_suggests_the_nearest():
    with pytest.raises(
        UnknownComponent, match=r"^unknown planner 'stedy'; did you mean steady\? \(possible: steady, swift\)$"
    ):
        registry(a=Plugin(steady=Steady, swift=Steady)).component("planner", "stedy")


def test_where_nothing_is_installed_the_error_says_so():
    with pytest.raises(UnknownComponent, match=r"unknown planner 'calm' \(possible: none installed\)"):
        registry().component("planner", "calm")


def test_a_lazy_factory_is_imported_only_when_it_is_used(third_party):
    third_party.write("later.py", "class Late:\n    pass\n")
    installed = registry(a=Plugin(late="later:Late"))
    assert installed.names("planner") == ["late"]
    assert "later" not in sys.modules
    assert type(installed.build("planner", {"name": "late"})).__name__ == "Late"


@pytest.mark.parametrize("factory", ["no_such_module_at_all:Planner", "arena_core:NoSuchPlanner"])
def test_a_lazy_factory_that_is_not_there_names_plugin_and_component(factory):
    with pytest.raises(BrokenPlugin, match="plugin mine: planner lost cannot be imported"):
        registry(mine=Plugin(lost=factory)).build("planner", {"name": "lost"})


def test_a_component_is_built_from_its_node_and_the_context():
    built = registry(a=Plugin(steady=Steady)).build("planner", {"name": "steady", "speed": 0.3}, robot=robot())
    assert (built.speed, built.robot.name) == (0.3, "sample")


def test_a_constructor_that_fails_names_its_plugin():
    def failing(robot: Robot) -> Planner:
        raise IndexError("no such gear")

    with pytest.raises(BrokenPlugin, match=r"plugin mine .*no such gear"):
        registry(mine=Plugin(lost=failing)).build("planner", {"name": "lost"}, robot=robot())


def test_a_node_without_a_name_says_how_to_choose_one():
    with pytest.raises(
        ConfigurationError, match=r"planner has no key name; choose one with planner=\.\.\., installed: steady"
    ):
        registry(a=Plugin(steady=Steady)).build("planner", {"speed": 0.3})


def test_components_inside_a_component_are_built_by_name():
    members = {"one": {"name": "steady", "speed": 0.1}, "other": {"name": "steady", "speed": 0.2}}
    built = registry(a=Plugin(steady=Steady, both=Switching)).build(
        "planner", {"name": "both", "members": members}, robot=robot()
    )
    assert [member.speed for member in built.members.values()] == [0.1, 0.2]


def test_an_error_inside_a_nested_component_names_the_whole_key():
    node = {"name": "both", "members": {"one": {"name": "steady", "speed": 0.0}}}
    with pytest.raises(ConfigurationError, match=r"^planner.members.one.speed is 0.0; allowed: > 0"):
        registry(a=Plugin(steady=Steady, both=Switching)).build("planner", node, robot=robot())


def test_the_distribution_of_an_installed_component_is_known():
    assert load_registry().component("executor", "serial").distribution()[0] == "arena-core"
