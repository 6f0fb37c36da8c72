"""AIO drives by the member that its policy prefers, and refuses members that the policy was not trained
with; its own are as trained.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from importlib import resources
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from arena_aio.planner import Aio
from arena_core import ConfigurationError, Planner, Pose, Twist, testing
from arena_core.cli.main import main
from arena_core.hosting import NAVIGATOR_KEYS, build_benchmark, compose, load_registry, to_plain
from arena_core.records import record_digest
from arena_gym.building import compose_environment
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.card import PolicyCard, content_sha256, write_card
from arena_policies.members import Members, build_members, describe_members

ROBOTS = "turtlebot3", "jackal", "robotino"
ENCODER = to_plain(compose(["observation_encoder=aio"], "component"))["observation_encoder"]
MEMBERS = {
    name: to_plain(compose([f"planner={name}", "robot=jackal"], "component"))["planner"]
    for name in ("pure_pursuit", "dwa")
}


def choosing_model(size, members, weights):
    """Return an ONNX model that prefers the second member by ``weights``, field by field, over the others."""
    matrix = np.zeros((size, members), np.float32)
    for place, weight in weights.items():
        matrix[place, 1] = weight
    graph = helper.make_graph(
        [helper.make_node("MatMul", ["observation", "weights"], ["action"])],
        "choosing",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["worlds", size])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["worlds", members])],
        [numpy_helper.from_array(matrix, "weights")],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    onnx.checker.check_model(model)
    return model.SerializeToString()


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Work in a folder whose conf/ makes pure pursuit and DWA the members of planner
    ``mine`` and of ``switch=mine``.
    """
    defaults = "defaults:\n  - /planner@members.pure_pursuit: pure_pursuit\n  - /planner@members.dwa: dwa\n"
    for group, more in (
        ("planner", ""),
        ("switch", "  - /local_map@local_map: rolling\n  - /tracker@tracker: kalman\n"),
    ):
        held = "held: 1\n" if group == "switch" else ""
        (tmp_path / "conf" / group).mkdir(parents=True)
        (tmp_path / "conf" / group / "mine.yaml").write_text(
            defaults + more + f"  - _self_\nevery: 3\n{held}members: {{}}\n"
        )
    mine = tmp_path / "conf" / "planner" / "mine.yaml"
    mine.write_text(mine.read_text() + "name: aio\npolicy: policy.onnx\nchoice: policy\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write_policy(folder, robot, weights, **changes):
    """Write a policy that chooses between pure pursuit and DWA, with its card."""
    encoder = testing.component("observation_encoder", "aio", robot=robot)
    registry = load_registry()
    planners = build_members(MEMBERS, tuple(MEMBERS), robot, registry, "members")
    members = {**describe_members(MEMBERS, planners, registry), **changes}
    content = choosing_model(sum(field.size for field in encoder.layout()), len(members), weights)
    whole = dict.fromkeys(("vx_min", "vx_max", "vy_max", "wz_max", "steering_max"))
    scale = ActionScale.of(robot, ActionRange(**whole))
    action = {name: ends for name, *ends in zip(scale.names, scale.low.tolist(), scale.high.tolist(), strict=True)}
    made_for = (
        "aio",
        "jackal",
        robot.kinematics,
        0.1,
        ENCODER,
        encoder.layout(),
        action,
        whole,
        content_sha256(content),
    )
    (folder / "policy.onnx").write_bytes(content)
    write_card(folder / "policy.json", PolicyCard(*made_for, members=members, every=3))


def mine(robot, *overrides):
    return testing.planner("mine", robot, *overrides, robot_preset="jackal")


GOAL_AHEAD = 65  # the place of goal_cos in the observation


def test_aio_holds_the_contract_of_a_planner(here):
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {GOAL_AHEAD: 1.0})
    assert testing.check("planner", mine(robot), robot)


def test_member_that_the_policy_prefers_drives(here):
    robot = testing.component("robot", "jackal")
    seen = testing.observation(body=robot)
    for preferred, weight in (("pure_pursuit", -1.0), ("dwa", 1.0)):
        write_policy(here, robot, {GOAL_AHEAD: weight})
        switch = mine(robot)
        alone = testing.planner(preferred, robot, robot_preset="jackal")
        assert [switch.compute_velocity(seen) for _ in range(7)] == [alone.compute_velocity(seen) for _ in range(7)]
        assert switch.chosen == {"pure_pursuit": 0, "dwa": 0, preferred: 3}, "every third step decides"


def test_member_that_is_preferred_takes_over_only_where_it_saves_more_than_the_hysteresis(here):
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {GOAL_AHEAD: 1.0})  # DWA is preferred by the cosine of the goal's bearing
    seen = testing.observation(body=robot)
    ahead = replace(
        seen, goal=Pose(seen.pose.x + 3.0 * np.cos(seen.pose.theta), seen.pose.y + 3.0 * np.sin(seen.pose.theta), 0.0)
    )
    behind = replace(ahead, goal=Pose(2.0 * seen.pose.x - ahead.goal.x, 2.0 * seen.pose.y - ahead.goal.y, 0.0))
    for hysteresis, takes_over in ((0.0, True), (0.9, True), (1.1, False)):
        switch = mine(robot, f"+planner.hysteresis={hysteresis}")
        drivers = []
        for observation in (behind, behind, behind, ahead):
            switch.compute_velocity(observation)
            drivers.append(switch.driving())
        assert drivers == [*["pure_pursuit"] * 3, "dwa" if takes_over else "pure_pursuit"]


def test_what_the_member_that_drives_considered_is_told(here):
    robot = testing.component("robot", "jackal")
    seen = testing.observation(body=robot)
    write_policy(here, robot, {GOAL_AHEAD: 1.0})
    switch, alone = mine(robot), testing.planner("dwa", robot, robot_preset="jackal")
    assert switch.considered() is None, "no one has driven yet"
    assert switch.compute_velocity(seen) == alone.compute_velocity(seen)
    told, expected = switch.considered(), alone.considered()
    assert len(told) == len(expected) > 1
    assert [(one.cost, one.chosen) for one in told] == [(one.cost, one.chosen) for one in expected]
    write_policy(here, robot, {GOAL_AHEAD: -1.0})
    silent = mine(robot)
    silent.compute_velocity(seen)
    assert silent.considered() is None, "pure pursuit does not tell"


def test_record_names_the_member_that_drives_and_its_digest_does_not_depend_on_that(here, tmp_path):
    write_policy(here, testing.component("robot", "jackal"), {GOAL_AHEAD: 1.0})
    words = ["planner=mine", "robot=jackal", "world=empty", "pedestrians=none", "task.time_limit=2", "episodes=1"]
    benchmark = build_benchmark(to_plain(compose(words)), load_registry())
    record = benchmark.run(0, tmp_path)
    drivers = [event for event in record.meta["events"] if event["kind"] == "driver"]
    assert drivers == [{"stamp": 0.0, "kind": "driver", "detail": "dwa"}]
    others = [event for event in record.meta["events"] if event["kind"] != "driver"]
    assert record_digest(replace(record, meta={**record.meta, "events": others})) == record_digest(record)


def test_random_switch_chooses_every_member_alike_in_each_run(here):
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {GOAL_AHEAD: 1.0})
    counts = []
    for _ in range(2):
        switch = mine(robot, "planner.choice=random")
        for _ in range(180):
            switch.compute_velocity(testing.observation(body=robot))
        counts.append(dict(switch.chosen))
    assert counts[0] == counts[1]
    assert min(counts[0].values()) > 15


def test_switch_has_its_whole_state_before_its_first_reset(here):
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {})
    built = testing.component("planner", "mine", robot_preset="jackal", robot=robot)
    assert built.chosen == {"pure_pursuit": 0, "dwa": 0}


def refused(robot, *overrides):
    with pytest.raises(ConfigurationError) as caught:
        mine(robot, *overrides)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_member_that_is_not_there_is_said_with_what_to_install(here):
    robot = testing.component("robot", "jackal")
    absent = {"sha256": "0" * 64, "distribution": "arena-elsewhere", "version": "1.0"}
    write_policy(here, robot, {}, elsewhere=absent)
    assert "member elsewhere is not installed" in refused(robot)
    assert refused(robot).endswith("install arena-elsewhere")
    write_policy(here, robot, {}, teb={**absent, "distribution": "arena-teb"})
    assert refused(robot).endswith("install arena-teb (arena-aio[default])")


@pytest.mark.parametrize("group", ["planner", "switch"])
def test_template_of_the_readme_composes_without_a_member_that_is_not_installed(here, group):
    readme = (Path(__file__).parents[1] / "README.md").read_text()
    (template,) = re.findall(rf"```yaml\n(# conf/{group}/mine\.yaml\n.*?)```", readme, re.DOTALL)
    (here / "conf" / group / "mine.yaml").write_text(
        template.replace("members.mppi: mppi", "members.elsewhere: elsewhere")
    )
    config = to_plain(compose([f"{group}=mine", "robot=jackal"], "component" if group == "planner" else "environment"))
    assert list(config[group]["members"]) == ["dwa"]


def test_robot_that_the_policy_was_not_trained_on_is_refused(here):
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {})
    assert "planner.control_period is 0.2; allowed: 0.1" in refused(replace(robot, control_period=0.2))
    assert "policy.json: actions are" in refused(replace(robot, limits=replace(robot.limits, vx_max=1.0)))


def test_decisions_at_other_steps_than_in_training_are_refused(here):
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {})
    assert refused(robot, "planner.every=2") == "planner.every is 2; allowed: 3, as the policy was trained"


@pytest.mark.parametrize("period", ["abc", "0.2"])
def test_member_with_another_control_period_is_refused(here, period):
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {})
    said = refused(robot, f"+planner.members.dwa.control_period={period}")
    assert said.startswith(
        f"planner.members.dwa.control_period is {period if period == '0.2' else repr(period)}; allowed: 0.1"
    )


def test_member_of_another_configuration_is_told(here):
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {})
    assert mine(robot).untuned == ()
    changed = mine(robot, "planner.members.dwa.roll_out.sim_time=0.5")
    assert changed.untuned == ("aio: member dwa is not as it was when the policy was trained",)
    bias = MEMBERS["dwa"]["critics"]["path_distance_bias"]
    assert isinstance(bias, float)
    assert mine(robot, f"planner.members.dwa.critics.path_distance_bias={int(bias)}").untuned == ()  # the same number


def test_member_that_the_policy_does_not_know_is_refused(here):
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {})
    (here / "conf" / "planner" / "mine.yaml").write_text(
        (here / "conf" / "planner" / "mine.yaml")
        .read_text()
        .replace("  - _self_", "  - /planner@members.orca: orca\n  - _self_")
    )
    assert "planner.members has orca" in refused(robot)


def test_policy_for_velocities_is_no_switch(here):
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {})
    card = json.loads((here / "policy.json").read_text())
    (here / "policy.json").write_text(json.dumps({**card, "members": {}}))
    assert "members are none; allowed: two or more" in refused(robot)


class Counter(Planner):
    """Says how many steps it has driven since its reset."""

    def reset(self, episode):
        self.steps = 0

    def compute_velocity(self, observation):
        self.steps += 1
        return Twist(float(self.steps))


def test_member_that_takes_over_begins_anew():
    members = Members({"first": Counter(), "second": Counter()})
    robot = testing.robot()
    members.reset(testing.samples.episode_start(robot))
    seen = testing.observation(body=robot)
    assert [members.drive(k, seen).vx for k in (0, 0, 1, 1, 0)] == [1.0, 2.0, 1.0, 2.0, 1.0]


class Compiling(Counter):
    """Waits for a compiler when it is first asked."""

    compiles = True
    asked = 0

    def compute_velocity(self, observation):
        self.asked += 1
        return super().compute_velocity(observation)


def test_members_that_compile_do_so_before_the_first_decision(here):
    members = {"silent": Counter(), "compiling": Compiling()}
    robot = testing.component("robot", "jackal")
    write_policy(here, robot, {GOAL_AHEAD: -1.0})
    switch = mine(robot)
    switch._members = Members(dict(zip(switch.chosen, members.values(), strict=True)))
    switch.reset(testing.samples.episode_start(robot))
    seen = testing.observation(body=robot)
    assert [switch.compute_velocity(seen).vx for _ in range(4)] == [1.0, 2.0, 3.0, 4.0], (
        "it begins again, if the first one drives"
    )
    assert members["compiling"].asked == 1
    switch.reset(testing.samples.episode_start(robot))
    switch.compute_velocity(seen)
    assert members["compiling"].asked == 1


CHOICES = ("choices", "planner=mine", "robot=jackal", "episodes=2", "task.time_limit=3.0")


def test_choices_counts_every_decision_once(here, capsys):
    write_policy(here, testing.component("robot", "jackal"), {})
    assert main([*CHOICES]) == 0
    said = capsys.readouterr().out
    assert [float(share) for share in re.findall(r"decisions, ([\d.]+)", said)] == [1.0, 0.0], (
        "the first of two that are liked alike"
    )
    assert "2 episodes" in said
    assert main([*CHOICES, "planner.choice=random"]) == 0
    shares = [float(share) for share in re.findall(r"decisions, ([\d.]+)", capsys.readouterr().out)]
    assert sum(shares) == pytest.approx(1.0, abs=0.002)
    assert min(shares) > 0.0


def test_choices_leaves_out_an_episode_that_failed_and_says_so(here, capsys, monkeypatch):
    write_policy(here, testing.component("robot", "jackal"), {})
    begun = []

    def reset(switch, episode, reset=Aio.reset):
        begun.append(episode)
        reset(switch, episode)

    def compute_velocity(switch, observation, compute_velocity=Aio.compute_velocity):
        if len(begun) == 3:  # the second episode; the first began twice, for its rehearsal
            raise RuntimeError("out of order")
        return compute_velocity(switch, observation)

    monkeypatch.setattr(Aio, "reset", reset)
    monkeypatch.setattr(Aio, "compute_velocity", compute_velocity)
    assert main([*CHOICES]) == 1
    said = capsys.readouterr()
    assert "episode 1: RuntimeError: out of order" in said.err
    assert "1 episodes" in said.out
    assert "11 of 11 decisions" in said.out


def test_training_a_switch_with_a_limited_spread_is_refused(here, capsys):
    pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")
    words = ("planner=aio", "switch=mine", "robot=jackal", "out=spread", *SMALL, "training.network.log_std_final=-2")
    assert main(["train", *words]) == 2
    assert "training.network.log_std_final is -2; allowed: null for a switch" in capsys.readouterr().err
    assert main(["train", *words[:-1], "training.network.log_std_unit=si"]) == 2
    assert "training.network.log_std_unit is si; allowed: range for a switch" in capsys.readouterr().err


def test_training_with_one_member_is_refused(here, capsys):
    pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")
    (here / "conf" / "switch" / "mine.yaml").write_text(
        (here / "conf" / "switch" / "mine.yaml").read_text().replace("  - /planner@members.dwa: dwa\n", "")
    )
    assert main(["train", "planner=aio", "switch=mine", "robot=jackal", "out=one"]) == 2
    assert "switch.members has pure_pursuit; allowed: two or more" in capsys.readouterr().err


SMALL = (
    "total_steps=128",
    "environment.worlds=1",
    "environment.problems_per_world=4",
    "training.optimization.environments=2",
    "training.optimization.steps=32",
    "training.optimization.minibatch=32",
    "training.validation.every=64",
    "training.validation.episodes=2",
    "training.test.episodes=2",
    "task.time_limit=4.0",
)


@pytest.mark.slow
def test_switch_is_trained_and_drives_with_the_members_of_its_card(here, capsys):
    pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")
    assert main(["train", "planner=aio", "switch=mine", "robot=jackal", "out=trained", *SMALL]) == 0
    card = json.loads((here / "trained" / "policy.json").read_text())
    assert list(card["members"]) == ["pure_pursuit", "dwa"]
    assert (card["every"], card["action"]["vx"]) == (3, [-2.0, 2.0]), "members drive backwards too"
    words = ("planner=mine", "planner.policy=trained/policy.onnx", "robot=jackal", "episodes=2", "task.time_limit=6.0")
    assert main(["choices", *words]) == 0
    said = capsys.readouterr().out
    assert "decisions" in said
    assert "2 episodes" in said
    assert main(["choices", "planner=dwa"]) == 2
    assert "allowed: a switch" in capsys.readouterr().err


@pytest.mark.parametrize("robot", ROBOTS)
def test_policy_is_small_and_its_card_has_what_its_recipe_composes(robot):
    folder = resources.files("arena_aio") / "policies"
    assert len((folder / f"{robot}.onnx").read_bytes()) <= 2 * 10**6
    training = json.loads((folder / f"{robot}.json").read_text("utf-8"))["training"]
    composed = json.loads(json.dumps(compose_environment(["recipe=aio", f"robot={robot}"], primary="train")))
    assert training["steps"] >= composed["total_steps"]
    for key in ("observation_encoder", "randomization", "reward", "total_steps", "training"):
        assert training["config"][key] == composed[key], key
    trained = as_switch(training["config"]["switch"])
    for key, value in training.get("changed", {}).items():  # since then, as the card says
        change(trained, key.split("."), value)
    assert as_known_to(trained, as_switch(composed["switch"])) == trained


def change(node, keys, value):
    """Give another value to a parameter that is there and has another one."""
    for key in keys[:-1]:
        node = node[key]
    assert node[keys[-1]] != value
    node[keys[-1]] = value


def as_switch(node):
    """Return a switch's configuration without what its members say of a navigator, which a switch does not read."""
    members = {
        name: {k: v for k, v in member.items() if k not in NAVIGATOR_KEYS} for name, member in node["members"].items()
    }
    return {**node, "members": members}


def as_known_to(trained, composed):
    """Return what is composed today without the parameters that members have got since the training."""
    if not isinstance(trained, dict):
        return composed
    return {key: as_known_to(value, composed[key]) for key, value in trained.items()}
