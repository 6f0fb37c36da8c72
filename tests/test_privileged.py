"""What sees the truth is shown it, named, and refused where it would not be fair; nothing else ever sees it."""

import math
from typing import ClassVar

import numpy as np
import pluggy
import pytest

from arena_core import ConfigurationError, Planner, Robot, hookimpl
from arena_core.config.plugins import load_plugins
from arena_core.config.registry import Registry
from arena_core.contracts import hookspecs
from arena_core.hosting import Truth, build_benchmark, compose, load_registry, mission_of, to_plain

WORDS = ["robot=turtlebot3", "world=warehouse", "task.pedestrians=5", "episodes=1", "planner=pure_pursuit"]
WORDS += ["task.time_limit=6", "pedestrians.reaction=ignore"]
AHEAD = (0.5, 1.0, 2.0)


def benchmark(*overrides, registry=None, **changed):
    config = to_plain(compose([*WORDS, *overrides]))
    return build_benchmark({**config, **changed}, registry or load_registry())


class Onlooker(Planner):
    """Drives as another planner does and keeps what it was shown of the truth, at each step."""

    privileged: ClassVar[bool] = True

    def __init__(self, robot: Robot, member: Planner) -> None:
        self.member, self.truth, self.seen = member, None, []

    def see(self, truth: Truth) -> None:
        self.truth, self.seen = truth, []

    def reset(self, episode):
        self.member.reset(episode)

    def compute_velocity(self, observation):
        self.seen.append((self.truth.state(), self.truth.people_ahead(AHEAD)))
        return self.member.compute_velocity(observation)


class Switch(Planner):
    """Sees no truth itself, and always lets its member drive."""

    def __init__(self, robot: Robot, members: dict[str, Planner]) -> None:
        (self.member,) = members.values()

    def reset(self, episode):
        self.member.reset(episode)

    def compute_velocity(self, observation):
        return self.member.compute_velocity(observation)


class Plugin:
    @hookimpl
    def register_planners(self, register):
        register("onlooker", Onlooker)
        register("switch", Switch)


@pytest.fixture(scope="module")
def registry():
    manager = pluggy.PluginManager("arena")
    manager.add_hookspecs(hookspecs)
    for name, plugin in load_plugins().list_name_plugin():
        manager.register(plugin, name)
    manager.register(Plugin(), "onlooker")
    return Registry(manager)


def nested(node):
    """Return the configuration of a switch whose member is an onlooker with this planner."""
    return {"name": "switch", "members": {"one": {"name": "onlooker", "member": node}}}


@pytest.fixture(scope="module")
def looked(registry, tmp_path_factory):
    """Return a run whose planner's nested part looks at the truth, its record and its navigator."""
    own = to_plain(compose(WORDS))["planner"]
    run = benchmark(registry=registry, planner=nested(own))
    return run, run.run(0, tmp_path_factory.mktemp("run")), run.navigator.planner.member


def test_a_nested_part_is_named_in_the_run_and_its_record(looked):
    run, record, _ = looked
    assert run.privileged == ("planner onlooker",)
    assert record.meta["columns"]["privileged"] == "planner onlooker"


def test_looking_ahead_changes_nothing_of_the_episode(looked, tmp_path):
    _, record, _ = looked
    plain = benchmark().run(0, tmp_path)
    assert "privileged" not in plain.meta["columns"]
    assert all(np.array_equal(record[name], plain[name], equal_nan=True) for name in plain.arrays)


def test_the_truth_is_that_of_the_moment(looked):
    _, record, onlooker = looked
    poses = np.array([state.pose.array() for state, _ in onlooker.seen])
    assert np.allclose(poses, record["pose"][: len(poses)], atol=1e-4)


def test_people_ahead_are_where_they_come_to_be(looked):
    _, record, onlooker = looked
    period, compared = 0.1, 0
    touched = record["contact_stamp"].min(initial=math.inf)
    for step, (_, ahead) in enumerate(onlooker.seen):
        assert ahead.positions.shape == (len(ahead.ids), len(AHEAD), 2)
        for k, time in enumerate(ahead.times):
            then = step + round(time / period)
            if then < len(record["pose"]) and record["stamp"][then] < touched:
                assert np.allclose(ahead.positions[:, k], record["pedestrian_positions"][then], atol=1e-3)
                compared += 1
    assert compared > 50


@pytest.mark.parametrize("times", [(1.0, 0.5), (-1.0,), (math.nan,), (1e9,)])
def test_impossible_times_ahead_are_refused_in_one_line(looked, times):
    _, _, onlooker = looked
    with pytest.raises(ConfigurationError, match="times ahead are"):
        onlooker.truth.people_ahead(times)


def test_a_fork_of_the_truth_is_that_world_and_its_episode_goes_on_alone(looked):
    run, _, onlooker = looked
    truth = onlooker.truth
    before = truth.state().pose
    future = truth.fork((0, 1))
    assert future.advance(np.tile((0.2, 0.0, 0.0), (2, 1)), 100).poses.shape == (2, 3)
    assert truth.state().pose == before
    assert truth.scenario.name == run.task.scenario(0, 0).name


def test_a_copied_navigator_sees_the_truth_that_it_is_given(looked):
    run, _, onlooker = looked
    navigator = run.navigator
    assert navigator.fork().planner.member.truth is onlooker.truth
    other = object()
    assert navigator.fork(other).planner.member.truth is other
    assert onlooker.truth is not other


def test_without_a_truth_to_see_a_privileged_part_is_refused(looked):
    run, _, _ = looked
    with pytest.raises(ConfigurationError, match="Onlooker sees the truth, which only a simulator knows"):
        run.navigator.reset(mission_of(run.task.scenario(0, 0)))


def test_a_part_that_sees_sensors_alone_is_handed_nothing():
    assert benchmark().navigator.privileged == ()
    navigator = benchmark("tracker=ground_truth").navigator
    assert navigator.privileged == (navigator.tracker,)
