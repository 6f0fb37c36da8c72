"""What a planner sees when it drives is what it was trained on, bit for bit."""

import numpy as np
import pytest

from arena_core import ObservationBatch, Planner, ScanMemory, Twist, compose, load_registry, plain
from arena_core.benchmark import build_benchmark
from arena_core.execution import _mission
from arena_gym.environment import NavigationEnv
from arena_policies.members import Members, build_members

COMMON = ["world.width=12", "world.height=12", "task.pedestrians=4"]
BRAIN = ["localizer=ground_truth", "waypoints=spatial_horizon", "replan.on_request=false", "replan.blocked_for=null", "planner=dwa"]
SWITCH = """defaults:
  - /planner@members.dwa: dwa
  - /planner@members.teb: teb
  - /local_map@local_map: rolling
  - /tracker@tracker: kalman
  - _self_
every: 3
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


class Switching(Replay):
    """Lets members drive for three steps each, as it was told."""

    def __init__(self, encoder, choices, members):
        super().__init__(encoder, choices)
        self.members = members

    def reset(self, episode):
        self.members.reset(episode)

    def command(self, observation):
        return self.members.drive(self.commands[(len(self.seen) - 1) // 3], observation)


def drive(planner, scenario, robot, steps):
    """Let a benchmark's navigator drive a scenario by a planner for so many control steps."""
    benchmark = build_benchmark(plain(compose([f"robot={robot}", "world=indoor", *COMMON, *BRAIN])), load_registry())
    navigator, simulator = benchmark.navigator, benchmark.simulator
    navigator.planner = planner
    snapshot = simulator.reset([scenario])
    navigator.reset(_mission(scenario))
    for _ in range(steps):
        command = navigator.command(snapshot.sensors(0))
        snapshot = simulator.advance(command.array()[None], 5)


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


@pytest.mark.parametrize("robot", ["turtlebot3", "robotino"])
def test_members_of_a_switch_drive_as_they_would_in_a_benchmark(robot, tmp_path, monkeypatch):
    (tmp_path / "conf" / "switch").mkdir(parents=True)
    (tmp_path / "conf" / "switch" / "two.yaml").write_text(SWITCH)
    monkeypatch.chdir(tmp_path)
    overrides = [*COMMON, "switch=two", "environment.collisions_to_end=null"]
    env = NavigationEnv(robot=robot, observation="aio", overrides=overrides)
    choices = np.random.default_rng(0).integers(0, 2, 14).tolist()
    shown = [env.reset(seed=0)[0], *(env.step(choice)[0] for choice in choices)]
    parts, problem = env.batch.parts, env.batch.episodes[0].problem

    nodes = parts.config["switch"]["members"]
    members = Members(build_members(nodes, tuple(nodes), parts.robot, load_registry(), "members"))
    planner = Switching(parts.encoder, choices, members)
    drive(planner, problem.scenario, robot, 3 * len(choices))
    assert len(planner.seen) == 3 * len(choices)
    assert all((seen == before).all() for seen, before in zip(planner.seen[::3], shown, strict=False))
