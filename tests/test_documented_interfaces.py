"""Hooks, interfaces and values say what an author needs, and their examples work."""

import inspect
import math
import pathlib
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from textwrap import dedent
from typing import Any, TypeVar

import numpy as np
import pluggy
import pytest
from numpy.typing import NDArray

import arena_core
from arena_core import hosting, parameters, testing
from arena_core.commands import Command, Listing
from arena_core.config.registry import HOOKS, INTERFACES, Registry
from arena_core.contracts import communication, hookspecs, learning, navigation, running, simulation
from arena_core.tasks import Message, PatrolGraph
from arena_core.testing import CHECKS, check, robot, scenario

SPECS = {name: hook for name, hook in vars(hookspecs).items() if hasattr(hook, "arena_spec")}
KINDS = {hook: kind for kind, hook in HOOKS.items()}
WITHOUT_EXAMPLE = (
    navigation.ReferenceLocalizer,  # a localiser with other methods; the suite's own are twenty lines
    navigation.LocalMap,  # marks and their distance field take more than ten lines
    running.Reporter,
    learning.Trainer,
)
CONTRACTS = [
    kind
    for module in (communication, learning, navigation, running, simulation)
    for _, kind in inspect.getmembers(module, inspect.isclass)
    if inspect.isabstract(kind) and kind.__module__ == module.__name__
]
VALUES = [
    getattr(arena_core, name)
    for name in ("Robot", "Twist", "Pose", "Observation", "Path", "Costmap", "World", "OccupancyGrid")
]
NAMES = {
    **{name: getattr(arena_core, name) for name in arena_core.__all__},
    **{name: getattr(hosting, name) for name in hosting.__all__},
    **{name: getattr(parameters, name) for name in parameters.__all__},
    **{"np": np, "math": math, "NDArray": NDArray, "Sequence": Sequence, "Callable": Callable, "Iterator": Iterator},
    **{"Mapping": Mapping, "Any": Any, "pathlib": pathlib},
    **{"T": TypeVar("T"), "FloatArray": NDArray[np.float64], "WorldState": object, "Lidar": arena_core.Lidar},
    **{"Command": Command, "Listing": Listing, "Reference": running.Reference, "Export": running.Export},
    **{"PatrolStrategy": simulation.PatrolStrategy, "PatrolGraph": PatrolGraph},
    **{"Communication": communication.Communication, "Message": Message},
}


def examples(documented):
    return [dedent(text) for text in re.findall(r"```python\n(.*?)```", inspect.getdoc(documented) or "", re.S)]


def executed(text):
    names = dict(NAMES)
    exec(text, names)
    return {name: value for name, value in names.items() if NAMES.get(name) is not value and name != "__builtins__"}


@pytest.mark.parametrize("hook", SPECS.values(), ids=SPECS)
def test_a_hook_says_when_it_is_called_what_its_factory_gets_and_what_it_returns(hook):
    text = " ".join(inspect.getdoc(hook).split())
    assert "Called " in text
    kind = KINDS.get(hook.__name__)
    assert "eturn" in text or kind == "policy"
    if kind not in (None, "policy"):  # policies are files, which no factory makes
        assert "The factory is called " in text
        interface = {name: each.__name__ for each, name in INTERFACES.items()}.get(kind, kind.capitalize())
        assert f"``{interface}``" in text
    assert re.search(r"raise|Error|Broken|exception", text)


@pytest.mark.parametrize("hook", SPECS.values(), ids=SPECS)
def test_the_example_of_a_hook_is_a_plugin(hook):
    (text,) = examples(hook)
    assert len(text.strip().splitlines()) == 4
    plugin = type("Plugin", (), {name: staticmethod(value) for name, value in executed(text).items()})
    manager = pluggy.PluginManager("arena")
    manager.add_hookspecs(hookspecs)
    manager.register(plugin, name="example")
    manager.check_pending()
    kind = KINDS.get(hook.__name__)
    if kind is None:
        assert getattr(manager.hook, hook.__name__).get_hookimpls()
    else:
        (name,) = Registry(manager).names(kind)
        assert name.startswith("my_")
        assert name in text.splitlines()[2]


def made(kind, factory):
    words = inspect.signature(factory).parameters
    context = {"robot": robot(), "world": executed(examples(arena_core.WorldSource)[0])["Walled"]()}
    return factory(**{name: context[name] for name in words})


@pytest.mark.parametrize("kind", CONTRACTS, ids=lambda kind: kind.__name__)
def test_the_example_of_an_interface_keeps_its_contract(kind):
    assert "Life cycle" in kind.__doc__ or kind in (Listing, Command)
    if kind in WITHOUT_EXAMPLE:
        return
    (text,) = examples(kind)
    (factory,) = executed(text).values()
    if kind is arena_core.Simulator:
        simulator = testing.component(
            "simulator", "sim2d", robot=robot(), pedestrians=testing.component("pedestrians", "none")
        )
        assert factory(simulator, scenario(), 1.0).pose.x > scenario().start.x
    elif INTERFACES.get(kind) in CHECKS:
        assert check(INTERFACES[kind], made(kind, factory), robot())
    else:
        assert issubclass(factory, kind)
        assert factory()


@pytest.mark.parametrize("kind", CONTRACTS, ids=lambda kind: kind.__name__)
def test_every_attribute_of_an_interface_is_listed(kind):
    own = {name for name in vars(kind).get("__annotations__", {}) if not name.startswith("_")}
    listed = set(re.findall(r"``(\w+)``", " ".join(re.findall(r"^- (.*?):", inspect.getdoc(kind), re.M))))
    assert own == listed & {*own, *listed}


@pytest.mark.parametrize("value", VALUES, ids=lambda value: value.__name__)
def test_every_attribute_of_a_value_is_listed_and_its_example_holds(value):
    fields = {name for name in inspect.signature(value).parameters if not name.startswith("_")}
    text = inspect.getdoc(value)
    lists = " ".join(re.findall(r"^- (.*?(?:\n  .*?)*)(?=\n- |\n\n)", text, re.M))
    assert fields | {"local_map", "tracks"} & {*dir(value)} <= set(re.findall(r"``(\w+)``", lists))
    (example,) = examples(value)
    for name, made_of in executed(example).items():
        assert not inspect.isfunction(made_of) or EXAMPLES[name](made_of)


EXAMPLES = {
    "brakes_within": lambda of: of(robot()) > 0.0,
    "nearest_return": lambda of: of(testing.observation(arena_core.Pose(0.0, 0.0), arena_core.Pose(1.0, 0.0))) > 0.0,
    "cost_at": lambda of: of(testing.free_costmap(arena_core.Pose(0.0, 0.0)), 0.0, 0.0) == 0,
}
