"""Members of a switch: one that has a policy is up to date when it takes over, and each is named by what it does."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from onnx import TensorProto, helper, numpy_helper

from arena_core import Planner, Pose, Twist, testing
from arena_core.hosting import compose, load_registry, to_plain
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.card import PolicyCard, content_sha256, write_card
from arena_policies.members import Members, build_members, member_hash
from arena_policies.planner import PolicyPlanner

LOOKS_BACK = "observation_encoder.lookback=[0.2]"
RANGE = {"vx_min": 0.0, "vx_max": None, "vy_max": None, "wz_max": None, "steering_max": None}


@pytest.fixture
def learned(tmp_path):
    """Return a function that makes a planner whose policy sees an earlier scan and its last
    command; changes are of its card.
    """
    robot = testing.robot()
    encoder = testing.component("observation_encoder", "rosnav_sectors", [LOOKS_BACK], robot=robot)
    node = to_plain(compose(["observation_encoder=rosnav_sectors", LOOKS_BACK], "component"))["observation_encoder"]
    size = sum(field.size for field in encoder.layout())
    weights = numpy_helper.from_array(
        np.random.default_rng(0).normal(0.0, 0.05, (size, 2)).astype(np.float32), "weights"
    )
    graph = helper.make_graph(
        [helper.make_node("MatMul", ["observation", "weights"], ["action"])],
        "linear",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["worlds", size])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["worlds", 2])],
        [weights],
    )
    content = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9).SerializeToString()
    scale = ActionScale.of(robot, ActionRange(**RANGE))
    action = {name: ends for name, *ends in zip(scale.names, scale.low.tolist(), scale.high.tolist(), strict=True)}
    made_for = (
        "rosnav",
        robot.name,
        robot.kinematics,
        robot.control_period,
        node,
        encoder.layout(),
        action,
        RANGE,
        content_sha256(content),
    )

    def make(**changes):
        (tmp_path / "policy.onnx").write_bytes(content)
        write_card(tmp_path / "policy.json", dataclasses.replace(PolicyCard(*made_for), **changes))
        return PolicyPlanner("rosnav", robot, str(tmp_path / "policy.onnx"))

    return make


class Told(Planner):
    """Drives as it was told."""

    def __init__(self, commands):
        self.commands = commands

    def compute_velocity(self, observation):
        return self.commands.pop(0)


def test_member_with_a_policy_that_looked_on_answers_as_if_it_had_driven(learned):
    robot = testing.robot()
    views = [testing.observation(pose=Pose(0.2 * k, 0.1 * k, 0.3 * k), body=robot) for k in range(8)]
    alone = learned()
    alone.reset(testing.samples.episode_start(robot))
    driven = [alone.compute_velocity(view) for view in views]

    members = Members({"other": Told(driven[:5]), "learned": learned()})
    members.reset(testing.samples.episode_start(robot))
    assert [members.drive(int(k >= 5), view) for k, view in enumerate(views)] == driven

    blind = Members({"other": Told([]), "learned": learned()})
    blind.reset(testing.samples.episode_start(robot))
    assert blind.drive(1, views[5]) != driven[5], "what it had seen matters"
    other = Members({"other": Told([Twist(0.5)] * 5), "learned": learned()})
    other.reset(testing.samples.episode_start(robot))
    assert [other.drive(int(k >= 5), view) for k, view in enumerate(views[:6])][5] != driven[5], (
        "so do the commands of others"
    )


class Drawn(Planner):
    """Drives at random."""

    compiles = True

    def reset(self, episode):
        self.random, self.first = episode.random, episode.random.random()

    def compute_velocity(self, observation):
        return Twist(self.first, self.random.random())


def test_nothing_remains_of_a_rehearsal():
    robot, driven = testing.robot(), []
    seen = testing.observation(body=robot)
    for rehearsed in (False, True):
        members, start = Members({"one": Drawn(), "other": Drawn()}), testing.samples.episode_start(robot)
        members.reset(start)
        start.random.random()
        if rehearsed:
            members.warm_up(seen)
        driven.append([members.drive(k, seen) for k in (0, 1, 1, 0)])
    assert driven[0] == driven[1]
    assert len(set(map(str, driven[0]))) == 4


def test_member_is_named_by_its_numbers_however_they_are_written():
    planner = Told([])
    written = {"name": "told", "speed": 1, "weights": [1, {"gain": 2}], "careful": True, "control_period": 0.1}
    assert member_hash(written, planner) == member_hash(
        {**written, "speed": 1.0, "weights": [1.0, {"gain": 2.0}]}, planner
    )
    assert member_hash(written, planner) != member_hash({**written, "speed": 2}, planner)
    assert member_hash(written, planner) != member_hash({**written, "careful": 1}, planner)


def test_what_a_member_says_of_a_navigator_names_no_other_member():
    planner, written = Told([]), {"name": "told", "speed": 1}
    navigator = {"control_period": 0.1, "replan": {"period": 1.0}, "recoveries": {"behaviours": []}}
    assert member_hash({**written, **navigator}, planner) == member_hash(written, planner)


def test_members_are_built_without_what_they_say_of_a_navigator():
    robot, registry = testing.robot(), load_registry()
    node = to_plain(compose(["planner=pure_pursuit"]))["planner"]
    navigator = {"replan": {"period": 1.0}, "recoveries": {"behaviours": ["wait"]}}
    (built,) = build_members(
        {"pure_pursuit": {**node, **navigator}}, ["pure_pursuit"], robot, registry, "planner.members"
    ).values()
    alone = testing.planner("pure_pursuit", robot)
    assert built.compute_velocity(testing.observation(body=robot)) == alone.compute_velocity(
        testing.observation(body=robot)
    )


def test_member_with_a_policy_is_named_by_its_card_wherever_the_file_lies(learned):
    node, planner = {"name": "rosnav", "policy": "here.onnx"}, learned()
    named = member_hash(node, planner)
    assert member_hash({**node, "policy": None}, planner) == named
    slower = {**planner.card.action_range, "vx_max": 0.5}
    halved = {**planner.card.action, "vx": (0.0, 0.5)}
    assert member_hash(node, learned(action=halved, action_range=slower)) != named
    for changes in ({"parts": {"vision": "0" * 64}}, {"encoder": {**planner.card.encoder, "decay": 2.0}}):
        other = learned()
        other._policy.card = dataclasses.replace(other.card, **changes)
        assert member_hash(node, other) != named
