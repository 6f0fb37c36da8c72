"""Policies drive only what they were made for, and whatever is wrong with a file is one line."""

from __future__ import annotations

import dataclasses
import json
import re

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from arena_core import ArenaError, Footprint, InvalidCommand, NoValidCommand, ObservationBatch, Pose, Twist, testing
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.card import PolicyCard, content_sha256, read_card, write_card
from arena_policies.planner import PolicyPlanner
from arena_policies.policy import load_policy

RANGE = {"vx_min": 0.0, "vx_max": None, "vy_max": None, "wz_max": None, "steering_max": None}
ENCODER = {
    "name": "rosnav_sectors",
    "sectors": 12,
    "overlap": 0,
    "lookback": [0.2],
    "range_max": 8.0,
    "decay": 1.0,
    "distance_unit": 2.0,
}


def linear_model(inputs: int, outputs: int, seed: int = 0, scale: float = 0.05) -> bytes:
    """Return an ONNX model of one layer with fixed weights."""
    random = np.random.default_rng(seed)
    weights = numpy_helper.from_array(random.normal(0.0, scale, (inputs, outputs)).astype(np.float32), "weights")
    graph = helper.make_graph(
        [helper.make_node("MatMul", ["observation", "weights"], ["action"])],
        "linear",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["worlds", inputs])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["worlds", outputs])],
        [weights],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    onnx.checker.check_model(model)
    return model.SerializeToString()


def built_encoder(robot):
    chosen = [f"observation_encoder.{key}={ENCODER[key]}" for key in ("sectors", "overlap", "lookback")]
    return testing.component("observation_encoder", "rosnav_sectors", chosen, robot=robot)


def write_policy(folder, robot, model=None, **changes):
    """Write a policy and its card for a robot; return the ONNX file."""
    encoder = built_encoder(robot)
    scale = ActionScale.of(robot, ActionRange(**RANGE))
    layout = encoder.layout()
    content = linear_model(sum(f.size for f in layout), len(scale.names)) if model is None else model
    card = PolicyCard(
        "rosnav",
        robot.name,
        robot.kinematics,
        robot.control_period,
        ENCODER,
        layout,
        {n: (low, high) for n, low, high in zip(scale.names, scale.low.tolist(), scale.high.tolist(), strict=True)},
        RANGE,
        content_sha256(content),
    )
    path = folder / "policy.onnx"
    path.write_bytes(content)
    write_card(path.with_suffix(".json"), dataclasses.replace(card, **changes))
    return path


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional", "ackermann"])
def test_policy_answers_within_the_robots_limits(tmp_path, kinematics):
    robot = testing.robot(kinematics)
    policy = load_policy(str(write_policy(tmp_path, robot)), "rosnav", robot)
    command = policy.command(testing.observation(body=robot), Twist(0.0))
    assert 0.0 <= command.vx <= robot.limits.vx_max
    assert abs(command.wz) <= robot.limits.wz_max
    assert abs(command.vy) <= robot.limits.vy_max
    assert command != Twist(0.0)


def test_same_observation_gives_the_same_command_bit_for_bit(tmp_path):
    robot = testing.robot()
    path = str(write_policy(tmp_path, robot))
    commands = [
        load_policy(path, "rosnav", robot).command(testing.observation(body=robot), Twist(0.3)) for _ in range(2)
    ]
    assert commands[0] == commands[1]


def test_policy_looks_back_until_it_begins_anew(tmp_path):
    robot = testing.robot()
    policy = load_policy(str(write_policy(tmp_path, robot)), "rosnav", robot)
    view, other = testing.observation(body=robot), testing.observation(pose=Pose(1.0, 1.0, 2.0), body=robot)
    first = policy.command(view, Twist(0.0))
    policy.command(other, Twist(0.0))
    policy.command(other, Twist(0.0))
    assert policy.command(view, Twist(0.0)) != first
    policy.begin()
    assert policy.command(view, Twist(0.0)) == first


@pytest.mark.parametrize(
    ("encoder", "says"),
    [
        ({}, "name"),
        ({**ENCODER, "name": "unheard_of"}, "unheard_of.* rosnav_sectors"),
        ({**ENCODER, "sector": 12}, "no parameter sector; did you mean sectors"),
        ({key: value for key, value in ENCODER.items() if key != "decay"}, "lacks decay"),
    ],
)
def test_card_of_an_encoder_that_is_not_installed_is_refused_by_its_name(tmp_path, encoder, says):
    robot = testing.robot()
    path = write_policy(tmp_path, robot, encoder=encoder)
    with pytest.raises(ArenaError, match=rf"policy\.json: encoder: .*{says}"):
        load_policy(str(path), "rosnav", robot)


def test_card_is_read_as_it_was_written(tmp_path):
    card = read_card(write_policy(tmp_path, testing.robot(), training={"seed": 3, "steps": 10}).with_suffix(".json"))
    write_card(tmp_path / "again.json", card)
    assert read_card(tmp_path / "again.json") == card
    assert card.training["steps"] == 10


def refused(path, robot, planner="rosnav"):
    with pytest.raises(ArenaError) as caught:
        load_policy(str(path), planner, robot)
    assert "\n" not in str(caught.value)
    assert "allowed:" in str(caught.value)
    return str(caught.value)


def test_policy_of_another_robot_is_refused(tmp_path):
    path = write_policy(tmp_path, testing.robot())
    assert "kinematics" in refused(path, testing.robot("ackermann")) or "ackermann" in refused(
        path, testing.robot("ackermann")
    )
    quick = testing.robot()
    quick = dataclasses.replace(quick, limits=dataclasses.replace(quick.limits, vx_max=1.5))
    assert re.search("observation|actions", refused(path, quick))
    seeing = dataclasses.replace(testing.robot(), lidar=dataclasses.replace(testing.robot().lidar, range_max=4.0))
    assert "closeness" in refused(path, seeing)


def test_policy_of_another_planner_is_refused(tmp_path):
    assert "planner is rosnav" in refused(write_policy(tmp_path, testing.robot()), testing.robot(), "gring")


def test_changed_file_is_refused(tmp_path):
    path = write_policy(tmp_path, testing.robot())
    path.write_bytes(path.read_bytes() + b"\0")
    assert "sha256" in refused(path, testing.robot())


@pytest.mark.parametrize(
    "content", [b"", b"not a model", linear_model(20, 2)[:200]], ids=["empty", "foreign", "truncated"]
)
def test_file_that_is_no_model_is_refused(tmp_path, content):
    assert "ONNX" in refused(write_policy(tmp_path, testing.robot(), content), testing.robot())


def test_model_of_another_size_is_refused(tmp_path):
    assert "numbers" in refused(write_policy(tmp_path, testing.robot(), linear_model(7, 2)), testing.robot())


def test_policy_without_a_card_is_refused(tmp_path):
    path = write_policy(tmp_path, testing.robot())
    path.with_suffix(".json").unlink()
    assert "card" in refused(path, testing.robot())


@pytest.mark.parametrize("key", ["planner", "kinematics", "encoder", "layout", "action", "sha256"])
def test_card_that_lacks_a_key_is_refused(tmp_path, key):
    path = write_policy(tmp_path, testing.robot())
    card = json.loads(path.with_suffix(".json").read_text())
    del card[key]
    path.with_suffix(".json").write_text(json.dumps(card))
    assert key in refused(path, testing.robot())


@pytest.mark.parametrize("name", ["../vision", "", "a b", "vision/"])
def test_card_with_a_part_that_names_no_parameter_is_refused(tmp_path, name):
    path = write_policy(tmp_path, testing.robot(), parts={name: "0" * 64})
    assert "which names no parameter" in refused(path, testing.robot())


def test_card_with_a_part_that_its_encoder_does_not_run_is_refused(tmp_path):
    network = tmp_path / "policy.sectors.onnx"
    network.write_bytes(b"0")
    path = write_policy(tmp_path, testing.robot(), parts={"sectors": content_sha256(b"0")})
    assert "encoder" in refused(path, testing.robot())


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '{"format": "arena-policy", "version": 1, "layout": 3}'])
def test_card_that_is_none_is_refused(tmp_path, text):
    path = write_policy(tmp_path, testing.robot())
    path.with_suffix(".json").write_text(text)
    assert "policy.json" in refused(path, testing.robot())


def test_missing_policy_is_refused(tmp_path):
    assert "cannot be read" in refused(tmp_path / "none.onnx", testing.robot())


def test_observation_that_is_no_number_gets_no_command(tmp_path):
    robot = testing.robot()
    policy = load_policy(str(write_policy(tmp_path, robot)), "rosnav", robot)
    seen = testing.observation(body=robot)
    blind = dataclasses.replace(
        seen, scan=dataclasses.replace(seen.scan, ranges=np.full_like(seen.scan.ranges, np.nan))
    )
    with pytest.raises(NoValidCommand):
        policy.command(blind, Twist(0.0))


def test_robot_without_a_command_remembers_that_it_braked(tmp_path):
    robot = testing.robot()
    path = write_policy(tmp_path, robot)
    seen = testing.observation(body=robot)
    blind = dataclasses.replace(
        seen, scan=dataclasses.replace(seen.scan, ranges=np.full_like(seen.scan.ranges, np.nan))
    )
    planner, alone = PolicyPlanner("rosnav", robot, str(path)), load_policy(str(path), "rosnav", robot)
    planner.reset(testing.samples.episode_start(robot))
    alone.begin()
    first = planner.compute_velocity(seen)
    assert first == alone.command(seen, Twist(0.0)) != Twist(0.0)
    with pytest.raises(NoValidCommand):
        planner.compute_velocity(blind)
    alone.observe(blind, first)
    assert planner.compute_velocity(seen) == alone.command(seen, Twist(0.0))


def test_answer_holds_for_as_many_control_steps_as_the_card_says(tmp_path):
    robot = testing.robot()
    path = write_policy(tmp_path, robot, every=3)
    planner, alone = PolicyPlanner("rosnav", robot, str(path)), load_policy(str(path), "rosnav", robot)
    start = testing.samples.episode_start(robot)
    views = [testing.observation(pose=Pose(0.1 * k, 0.0, 0.3 * k), body=robot) for k in range(7)]
    planner.reset(start)
    driven = [planner.compute_velocity(view) for view in views]
    alone.begin()
    last = Twist(0.0)
    for k, view in enumerate(views):  # it sees every scan, and answers to every third
        if k % 3:
            alone.observe(view, last)
        else:
            last = alone.command(view, last)
        assert driven[k] == last
    assert len(set(driven)) == 3
    planner.reset(start)
    assert planner.compute_velocity(views[0]) == driven[0]
    planner.reset(start)
    assert planner.compute_velocity(views[6]) != driven[0], "a new episode begins with a new answer"


@pytest.mark.parametrize("every", [0, -1, 101, 1e9, 10**12, 1.5, "3", True, None])
def test_a_card_whose_answers_hold_for_no_time_or_for_ever_is_refused(tmp_path, every):
    path = write_policy(tmp_path, testing.robot())
    card = path.with_suffix(".json")
    card.write_text(json.dumps({**json.loads(card.read_text()), "every": every}))
    assert "not a whole number from 1 to 100" in refused(path, testing.robot())


def test_policy_that_answers_no_number_is_an_error_and_not_a_robot_that_stands(tmp_path):
    robot = testing.robot()
    size = sum(field.size for field in built_encoder(robot).layout())
    path = write_policy(tmp_path, robot, linear_model(size, 2, scale=np.inf))
    with pytest.raises(InvalidCommand):
        load_policy(str(path), "rosnav", robot).command(testing.observation(body=robot), Twist(0.0))


def test_policy_drives_a_larger_body_and_gaps_count_from_it(tmp_path):
    robot = testing.robot()
    larger = dataclasses.replace(robot, footprint=Footprint.circle(0.5))
    path = str(write_policy(tmp_path, robot))
    seen = testing.observation(body=robot)
    own, other = (load_policy(path, "rosnav", body).command(seen, Twist(0.0)) for body in (robot, larger))
    assert own != other
    close = [built_encoder(body).encode(ObservationBatch.of(seen, Twist(0.0))) for body in (robot, larger)]
    assert (close[1][:, :12] > close[0][:, :12]).all()


def test_policy_trained_in_another_body_says_so_and_one_that_tells_of_none_does_not(tmp_path):
    robot = testing.robot()
    told = {"footprint": {"radius": 0.2, "vertices_xy": None}, "lidar": {"mount": {"x": 0.1, "y": 0.0, "theta": 0.0}}}
    path = str(write_policy(tmp_path, robot, training={"config": {"robot": told}}))
    (note,) = PolicyPlanner("rosnav", robot, path).untuned
    assert note.startswith("rosnav: trained with a footprint of radius 0.200 m and the lidar at (0.1, 0), drives with")
    assert "\n" not in note
    same = {"radius": robot.footprint.radius, "vertices_xy": None}
    if not robot.footprint.is_circle:
        same = {"radius": None, "vertices_xy": robot.footprint.vertices_xy.tolist()}
    mount = {"x": robot.lidar.mount.x, "y": robot.lidar.mount.y, "theta": 0.0}
    path = str(
        write_policy(tmp_path, robot, training={"config": {"robot": {"footprint": same, "lidar": {"mount": mount}}}})
    )
    assert PolicyPlanner("rosnav", robot, path).untuned == ()


def test_policy_trained_with_other_accelerations_says_so_and_one_with_these_does_not(tmp_path):
    robot = testing.robot()
    own = {name: getattr(robot.limits, name) for name in ("ax_max", "ay_max", "alpha_max")}
    for told, notes in ((own, 0), ({**own, "ax_max": 10.0, "alpha_max": 20.0}, 1)):
        path = str(write_policy(tmp_path, robot, training={"config": {"robot": {"limits": told}}}))
        said = PolicyPlanner("rosnav", robot, path).untuned
        assert len(said) == notes
        assert all(line.startswith("rosnav: trained with accelerations of 10 m/s2, 20 rad/s2, ") for line in said)


@pytest.mark.parametrize("training", [{}, {"config": None}, {"config": {"robot": {"footprint": {"radius": "wide"}}}}])
def test_card_whose_training_tells_of_no_body_is_taken_without_a_word(tmp_path, training):
    robot = testing.robot()
    assert PolicyPlanner("rosnav", robot, str(write_policy(tmp_path, robot, training=training))).untuned == ()
