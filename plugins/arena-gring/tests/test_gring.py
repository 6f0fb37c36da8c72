"""GRING sees the eight waypoints ahead; as released, one of them eight times; its policies are what their cards say."""

from __future__ import annotations

import dataclasses
import json
from importlib import resources

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from arena_core import ConfigurationError, NoValidCommand, Path, Pose, testing
from arena_core.cli.main import main
from arena_core.parameters import read_settings
from arena_gym.building import compose_environment
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.card import PolicyCard, content_sha256, write_card

RANGE = {"vx_min": 0.0, "vx_max": None, "vy_max": None, "wz_max": None, "steering_max": None}
ENCODERS = ("gring", "gring_as_released")
ROBOTS = ("turtlebot3", "jackal", "robotino")


def steering_model(layout, actions):
    """Return an ONNX model that drives at 0.8 of its speed and turns towards the eighth waypoint's side."""
    size = sum(field.size for field in layout)
    first = sum(field.size for field in layout[: [field.name for field in layout].index("waypoints_xy")])
    weights = np.zeros((size, actions), np.float32)
    weights[first + 15, -1] = 0.5
    bias = np.zeros(actions, np.float32)
    bias[0] = 0.6
    graph = helper.make_graph(
        [helper.make_node("Gemm", ["observation", "weights", "bias"], ["action"])],
        "steering",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["worlds", size])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["worlds", actions])],
        [numpy_helper.from_array(weights, "weights"), numpy_helper.from_array(bias, "bias")],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    onnx.checker.check_model(model)
    return model.SerializeToString()


def policy(folder, preset, robot):
    """Write the steering policy for a robot; return the ONNX file."""
    encoder = testing.component("observation_encoder", preset, robot=robot)
    node = {"name": "gring", **{k: v for k, v in settings_of(preset).items() if k != "name"}}
    scale = ActionScale.of(robot, read_settings(RANGE, ActionRange, "action"))
    content = steering_model(encoder.layout(), len(scale.names))
    ends = {n: (low, high) for n, low, high in zip(scale.names, scale.low.tolist(), scale.high.tolist(), strict=True)}
    card = PolicyCard(
        preset, robot.name, robot.kinematics, 0.1, node, encoder.layout(), ends, RANGE, content_sha256(content)
    )
    path = folder / f"{preset}.onnx"
    path.write_bytes(content)
    write_card(path.with_suffix(".json"), card)
    return path


def settings_of(preset):
    from arena_core.hosting import compose, to_plain

    return to_plain(compose([f"observation_encoder={preset}"], "component"))["observation_encoder"]


def driving(folder, preset, robot, *overrides, robot_preset=None):
    path = policy(folder, preset, robot)
    return testing.planner(preset, robot, f"planner.policy={path}", *overrides, robot_preset=robot_preset)


def corner():
    """Return what a robot sees whose path goes 2 m ahead, then 3 m to the left; the waypoint lies ahead."""
    ahead, left = (
        testing.straight_path(Pose(0.0, 0.0), Pose(2.0, 0.0)),
        testing.straight_path(Pose(2.0, 0.0), Pose(2.0, 3.0)),
    )
    seen = testing.observation(pose=Pose(0.0, 0.0), goal=Pose(2.0, 3.0), waypoint=Pose(2.0, 0.0))
    path = dataclasses.replace(seen.path, poses=np.concatenate((ahead.poses, left.poses[1:])))
    return dataclasses.replace(seen, path=path)


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional"])
def test_gring_holds_the_contract_of_a_planner(tmp_path, kinematics):
    robot = testing.robot(kinematics)
    assert testing.check("planner", driving(tmp_path, "gring", robot), robot)


def test_gring_sees_where_the_path_turns_and_as_released_does_not(tmp_path):
    robot = testing.robot()
    assert driving(tmp_path, "gring", robot).compute_velocity(corner()).wz > 0.1
    assert driving(tmp_path, "gring_as_released", robot).compute_velocity(corner()).wz == pytest.approx(0.0, abs=1e-6)
    right = driving(tmp_path, "gring_as_released", robot, "planner.one_waypoint=false")
    assert right.compute_velocity(corner()).wz > 0.1, "the same policy, shown the right waypoints"


def test_jackal_as_released_turns_slowly(tmp_path):
    robot = testing.robot()
    seen = dataclasses.replace(corner(), waypoint=Pose(1.0, 0.5))
    others, jackal = (
        driving(tmp_path, "gring_as_released", robot, robot_preset=name).compute_velocity(seen)
        for name in ("turtlebot3", "jackal")
    )
    assert jackal.wz == pytest.approx(0.3 * others.wz)
    assert jackal.vx == others.vx > 0.5


def test_policy_of_the_other_recipe_is_refused(tmp_path):
    robot = testing.robot()
    path = policy(tmp_path, "gring_as_released", robot)
    with pytest.raises(ConfigurationError, match="planner is gring_as_released; allowed: a policy for gring"):
        testing.planner("gring", robot, f"planner.policy={path}")


def test_robot_without_a_policy_is_told_how_to_get_one():
    with pytest.raises(
        ConfigurationError, match=r"gring: no policy for sample .*arena train planner=gring robot=sample"
    ):
        testing.planner("gring", testing.robot())


def test_range_that_is_no_number_gets_no_command(tmp_path):
    seen = corner()
    ranges = seen.scan.ranges.copy()
    ranges[3] = np.nan
    seen = dataclasses.replace(seen, scan=dataclasses.replace(seen.scan, ranges=ranges))
    with pytest.raises(NoValidCommand):
        driving(tmp_path, "gring", testing.robot()).compute_velocity(seen)


def test_empty_path_gets_no_command(tmp_path):
    for preset in ENCODERS:
        planner = driving(tmp_path, preset, testing.robot(), "planner.one_waypoint=false")
        with pytest.raises(NoValidCommand, match="path is empty"):
            planner.compute_velocity(dataclasses.replace(corner(), path=Path(np.empty((0, 3)))))


SMALL = (
    "total_steps=512",
    "teacher.rounds=2",
    "teacher.decisions=8",
    "environment.worlds=1",
    "environment.problems_per_world=4",
    "training.optimization.environments=8",
    "training.optimization.steps=32",
    "training.optimization.minibatch=64",
    "training.validation.every=256",
    "training.validation.episodes=4",
    "training.test.episodes=4",
    "task.time_limit=3.0",
)


@pytest.mark.slow
@pytest.mark.parametrize("recipe", ["gring", pytest.param("gring_as_released", marks=pytest.mark.long)])
def test_recipe_trains_a_policy_that_drives(tmp_path, recipe):
    pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")
    assert main(["train", f"planner={recipe}", "robot=turtlebot3", f"out={tmp_path}", *SMALL]) == 0
    card = json.loads((tmp_path / "policy.json").read_text())
    assert card["planner"] == recipe
    robot = testing.component("robot", "turtlebot3")
    planner = testing.planner(recipe, robot, f"planner.policy={tmp_path / 'policy.onnx'}", robot_preset="turtlebot3")
    command = planner.compute_velocity(testing.observation(body=robot))
    low, high = card["action"]["vx"]
    assert robot.limits.vx_min <= low <= command.vx <= high <= robot.limits.vx_max


@pytest.mark.parametrize("robot", ROBOTS)
def test_policy_is_small_and_its_card_has_what_its_recipe_composes(robot):
    folder = resources.files("arena_gring") / "policies"
    assert len((folder / f"{robot}.onnx").read_bytes()) <= 2 * 10**6
    training = json.loads((folder / f"{robot}.json").read_text("utf-8"))["training"]
    composed = json.loads(json.dumps(compose_environment(["recipe=gring", f"robot={robot}"], primary="train")))
    assert training["steps"] >= composed["total_steps"]
    for key in (
        "action",
        "environment",
        "observation_encoder",
        "randomization",
        "reward",
        "task",
        "teacher",
        "total_steps",
        "training",
    ):
        assert training["config"][key] == composed[key], key


@pytest.mark.parametrize("robot", ROBOTS)
def test_planner_holds_its_contract(robot):
    body = testing.component("robot", robot)
    assert testing.check("planner", testing.component("planner", "gring", robot=body, robot_preset=robot), body)


@pytest.mark.parametrize("robot", ROBOTS)
def test_planner_as_released_holds_its_contract_on_the_whole_scan(tmp_path, robot):
    body = testing.component("robot", robot)
    planner = driving(tmp_path, "gring_as_released", body, robot_preset=robot)
    assert planner.card.layout[0].size == body.lidar.beams
    assert testing.check("planner", planner, body)
