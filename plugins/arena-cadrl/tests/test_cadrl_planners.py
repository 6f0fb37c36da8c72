"""The planners hold their contract with what they are given, and refuse policies that do not fit, in one line."""

import json
import shutil

import pytest

from arena_cadrl.policy import load_value_policy
from arena_core import ArenaError, EpisodeStart, Pose
from arena_core.testing import check, component, tracked, view

PLANNERS = ("cadrl", "sarl")
ROBOTS = ("turtlebot3", "jackal", "robotino")


@pytest.mark.slow
@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize("name", ROBOTS)
def test_planner_holds_its_contract_with_a_policy_of_its_own(written, robot, planner, name):
    made = component("planner", planner, [f"planner.policy={written(planner, name)}"], name, robot=robot(name))
    assert check("planner", made, robot(name))


def test_command_depends_on_people_and_on_nothing_before(written, robot):
    policy = load_value_policy(str(written()), "sarl", robot("jackal"), 0.1)
    near = view(tracks=tracked((0.9, 0.0, -0.5, 0.0)))
    first = policy.command(near)
    policy.command(view())
    assert policy.command(near) == first


def test_reward_holds_its_contract(robot):
    assert check("reward", component("reward", "cadrl", robot=robot("jackal")), robot("jackal"))


@pytest.fixture
def copy(written, tmp_path):
    """Return a copy of a policy that a test may spoil."""
    shutil.copytree(written().parent, tmp_path / "copy")
    return tmp_path / "copy" / "policy.onnx"


def refused(path, planner, body):
    with pytest.raises(ArenaError) as caught:
        load_value_policy(str(path), planner, body, 0.1)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def spoiled(path, **changes):
    card = path.with_suffix(".json")
    card.write_text(json.dumps({**json.loads(card.read_text()), **changes}))
    return path


def told(path):
    return json.loads(path.with_suffix(".json").read_text())


def test_policy_of_another_planner_is_refused(copy, robot):
    assert "planner is sarl; allowed: a policy for cadrl" in refused(copy, "cadrl", robot("jackal"))


def test_policy_for_another_kinematics_is_refused(copy, robot):
    assert "trained for jackal (differential); allowed: a policy for robotino" in refused(
        copy, "sarl", robot("robotino")
    )


def test_policy_of_another_action_range_is_refused(copy, robot):
    assert "vx_min" in refused(copy, "sarl", robot("turtlebot3"))


def test_damaged_network_is_refused(copy, robot):
    copy.write_bytes(copy.read_bytes()[:-5])
    assert "policy.onnx: sha256 is" in refused(copy, "sarl", robot("jackal"))


def test_network_that_reads_other_numbers_than_its_card_tells_is_refused(copy, robot):
    encoder = told(copy)["encoder"]
    spoiled(copy, encoder={**encoder, "looking": {**encoder["looking"], "people": 3}})
    assert "differs from this robot's in number of fields" in refused(copy, "sarl", robot("jackal"))


@pytest.mark.parametrize("section", ["looking", "choosing", "safety", "worth"])
def test_card_without_a_section_is_refused(copy, robot, section):
    encoder = told(copy)["encoder"]
    del encoder[section]
    assert section in refused(spoiled(copy, encoder=encoder), "sarl", robot("jackal"))


def test_robot_that_steers_like_a_car_is_refused(written, robot):
    car = robot("jackal_ackermann")
    with pytest.raises(ArenaError, match="allowed: a policy for jackal_ackermann"):
        load_value_policy(str(written()), "sarl", car, 0.1)


def test_another_control_period_is_refused(written, robot):
    made = component("planner", "sarl", [f"planner.policy={written()}"], "jackal", robot=robot("jackal"))
    with pytest.raises(ArenaError, match=r"planner.control_period is 0.05; allowed: 0.1"):
        made.reset(EpisodeStart(None, Pose(1.0, 0.0), 0.05, None))
