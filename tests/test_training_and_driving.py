"""What a planner sees when it drives is what it was trained on, bit for bit."""

import json

import numpy as np
import pytest
from onnx import TensorProto, helper, numpy_helper

from arena_aio.planner import Aio
from arena_core import ObservationBatch, Planner, ScanMemory, Twist
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.loop.execution import mission_of, run_episode
from arena_core.loop.recording import Recorder
from arena_core.runs.jobs.benchmark import build_benchmark
from arena_gym.environment import NavigationEnv
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.card import PolicyCard, content_sha256, write_card
from arena_policies.policy import load_policy

COMMON = ["world.width=12", "world.height=12", "task.pedestrians=4"]
BRAIN = [
    "localizer=ground_truth",
    "waypoints=spatial_horizon",
    "replan.on_request=false",
    "replan.blocked_for=null",
    "planner=dwa",
    "planner.recoveries.behaviours=[]",
    "planner.passage_margin=0",
]
SWITCH = """defaults:
  - /planner@members.dwa: dwa
  - /planner@members.teb: teb
  - /local_map@local_map: rolling
  - /tracker@tracker: kalman
  - _self_
every: 3
held: 1
members: {}
"""


class Replay(Planner):
    """Encodes what it sees and drives as it was told."""

    def __init__(self, encoder, commands):
        self.encoder, self.commands = encoder, commands
        self.seen, self.last, self.memory = [], Twist(0.0), None

    def compute_velocity(self, observation):
        self.remember(observation.scan.ranges[None], observation.pose.array()[None])
        self.seen.append(self.encoder.encode(ObservationBatch.of(observation, self.last, self.memory))[0])
        self.last = self.command(observation)
        return self.last

    def remember(self, ranges, poses):
        if self.memory is None:
            self.memory = ScanMemory(self.encoder.lookback, 1, ranges.shape[1])
            self.memory.begin(np.zeros(1, np.int64), ranges, poses)
        else:
            self.memory.remember(ranges, poses)

    def command(self, observation):
        return Twist.of(self.commands[len(self.seen) - 1])


class Watched(Replay):
    """Encodes what a switch sees, and drives by it."""

    def __init__(self, encoder, switch):
        super().__init__(encoder, [])
        self.switch = switch

    def reset(self, episode):
        self.switch.reset(episode)

    def command(self, observation):
        return self.switch.compute_velocity(observation)


def write_switch(path, parts):
    """Write a policy that prefers the second member while the robot turns left, with its card."""
    size = sum(field.size for field in parts.encoder.layout())
    weights = np.zeros((size, 2), np.float32)
    weights[-1, 1] = 1.0  # the measured turn rate
    graph = helper.make_graph(
        [helper.make_node("MatMul", ["observation", "weights"], ["action"])],
        "turning",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["worlds", size])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["worlds", 2])],
        [numpy_helper.from_array(weights, "weights")],
    )
    content = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9).SerializeToString()
    whole = dict.fromkeys(parts.config["action"])
    scale = ActionScale.of(parts.robot, ActionRange(**whole))
    action = {name: ends for name, *ends in zip(scale.names, scale.low.tolist(), scale.high.tolist(), strict=True)}
    body, encoder = parts.robot, parts.config["observation_encoder"]
    made_for = (
        "aio",
        body.name,
        body.kinematics,
        body.control_period,
        encoder,
        parts.encoder.layout(),
        action,
        whole,
        content_sha256(content),
    )
    path.write_bytes(content)
    write_card(path.with_suffix(".json"), PolicyCard(*made_for, members=parts.switch.members, every=parts.switch.every))


def drive(planner, scenario, robot, steps, brain=BRAIN):
    """Let a benchmark's navigator drive a scenario by a planner for so many control steps; return it."""
    benchmark = build_benchmark(to_plain(compose([f"robot={robot}", "world=indoor", *COMMON, *brain])), load_registry())
    navigator, simulator = benchmark.navigator, benchmark.simulator
    navigator.planner = planner
    snapshot = simulator.reset([scenario])
    navigator.reset(mission_of(scenario))
    for _ in range(steps):
        command = navigator.command(snapshot.sensors(0))
        snapshot = simulator.advance(command.array()[None], round(navigator.control_period / simulator.inner_step))
    return navigator


@pytest.mark.parametrize("encoder", ["rosnav", "rosnav_sectors", "gring", "gring_as_released", "aio"])
@pytest.mark.parametrize("robot", ["turtlebot3", "robotino"])
def test_navigator_shows_a_planner_what_the_environment_showed(robot, encoder):
    env = NavigationEnv(robot=robot, observation=encoder, overrides=[*COMMON, "environment.collisions_to_end=null"])
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (40, *env.action_space.shape)).astype(np.float32)
    shown = [env.reset(seed=0)[0], *(env.step(action)[0] for action in actions)]
    parts, problem = env.batch.parts, env.batch.episodes[0].problem

    planner = Replay(parts.encoder, parts.scale.commands(actions))
    drive(planner, problem.scenario, robot, len(actions))
    assert len(planner.seen) == len(actions)
    assert all((seen == before).all() for seen, before in zip(planner.seen, shown, strict=False))


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["turtlebot3", "robotino"])
def test_robots_that_localise_and_plan_anew_in_training_see_what_they_would_in_a_benchmark(robot):
    overrides = [
        *COMMON,
        "environment.collisions_to_end=null",
        "guide=navigator",
        "guide.replan.period=0.7",
        "guide.replan.gain=0",
    ]
    env = NavigationEnv(robot=robot, observation="gring", overrides=overrides)
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (40, *env.action_space.shape)).astype(np.float32)
    shown = [env.reset(seed=0)[0], *(env.step(action)[0] for action in actions)]
    parts, batch = env.batch.parts, env.batch
    assert (batch.seen.poses != batch.loop.snapshot.poses).all()

    planner = Replay(parts.encoder, parts.scale.commands(actions))
    navigator = drive(
        planner,
        batch.episodes[0].problem.scenario,
        robot,
        len(actions),
        ["replan.period=0.7", "replan.gain=0", *BRAIN[-2:]],
    )
    # it has replanned on the way
    assert not np.array_equal(navigator._way.path.poses, batch.episodes[0].problem.path.poses)
    assert len(planner.seen) == len(actions)
    assert all((seen == before).all() for seen, before in zip(planner.seen, shown, strict=False))


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["turtlebot3", "jackal"])
def test_a_policy_drives_the_same_episode_in_training_and_in_a_run(robot):
    shared = [
        f"robot={robot}",
        "world=indoor",
        *COMMON,
        "task.pedestrians=8",
        "task.time_limit=30",
        "robot.lidar.noise_std=0.02",
    ]
    latency = ["timing.mode=latency", "timing.latency=0.1"]
    # training plans for a robot without a planner
    driving = ["planner=rosnav", "planner.passage_margin=0", "localizer=gauss_markov"]
    config = to_plain(compose([*shared, *latency, *driving]))
    run = build_benchmark(config, load_registry())
    card = run.navigator.planner.card
    encoder = [f"observation_encoder.{key}={json.dumps(value)}" for key, value in card.encoder.items() if key != "name"]
    action = [f"action.{key}={json.dumps(value)}" for key, value in card.action_range.items()]
    tracker = "kalman" if card.encoder.get("foreseen") else "none"
    overrides = [
        *shared,
        *encoder,
        *action,
        "guide=driving",
        f"tracker@guide.tracker={tracker}",
        "environment.collisions_to_end=null",
        f"environment.every={card.every}",
        "randomization.latency={low: 1, high: 1}",
    ]
    env = NavigationEnv(observation="rosnav_sectors", reward="progress", overrides=overrides)
    source = config["planner"]["policy"] or f"pkg://arena_rosnav/policies/{robot}.onnx"
    policy = load_policy(source, "rosnav", env.batch.parts.robot)

    seen, poses = env.reset(seed=0)[0], [env.batch.snapshot.poses[0]]
    scenario, ended = env.batch.episodes[0].problem.scenario, False
    while not ended:
        seen, _, terminated, truncated, report = env.step(policy.run(seen[None])[0])
        ended = terminated or truncated
        poses.append(env.batch.snapshot.poses[0])

    record = run_episode(
        scenario,
        run.simulator,
        run.navigator,
        run.timing,
        Recorder(scenario, run.robot, {}),
        stop_on_collision=False,
    )
    decided = record["pose"][[*range(0, len(record["pose"]) - 1, card.every), -1]]
    assert len(decided) > 50
    assert np.abs(decided - poses).max() <= 2.0**-23, "half the grain of records"
    assert (record["estimate"] != record["pose"]).any()
    assert len(record["contact_stamp"]) == report["collisions"]
    assert record.meta["outcome"] == report["outcome"]


@pytest.mark.slow
@pytest.mark.parametrize("robot", [pytest.param("turtlebot3", marks=pytest.mark.long), "robotino"])
def test_switch_drives_in_a_benchmark_as_it_did_in_training(robot, tmp_path, monkeypatch):
    (tmp_path / "conf" / "switch").mkdir(parents=True)
    (tmp_path / "conf" / "switch" / "two.yaml").write_text(SWITCH)
    monkeypatch.chdir(tmp_path)
    overrides = [*COMMON, "switch=two", "environment.collisions_to_end=null"]
    env = NavigationEnv(robot=robot, observation="aio", overrides=overrides)
    parts = env.batch.parts
    write_switch(tmp_path / "policy.onnx", parts)
    shown, choices = [env.reset(seed=0)[0]], []
    for _ in range(14):
        choices.append(int(shown[-1][-1] > 0.0))
        shown.append(env.step(choices[-1])[0])
    problem = env.batch.episodes[0].problem

    planner = Watched(
        parts.encoder, Aio(parts.robot, str(tmp_path / "policy.onnx"), 3, "policy", parts.config["switch"]["members"])
    )
    drive(planner, problem.scenario, robot, 3 * len(choices))
    assert len(planner.seen) == 3 * len(choices)
    assert all((seen == before).all() for seen, before in zip(planner.seen[::3], shown, strict=False))
    assert planner.switch.chosen == {"dwa": choices.count(0), "teb": choices.count(1)}
    assert min(planner.switch.chosen.values()) > 0
