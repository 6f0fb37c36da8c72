"""What a planner sees when it drives is what it was trained on, bit for bit."""

import numpy as np
import pytest

from arena_core import ObservationBatch, Planner, Twist, compose, load_registry, plain
from arena_core.benchmark import build_benchmark
from arena_core.execution import _mission
from arena_gym.environment import NavigationEnv

COMMON = ["world.width=12", "world.height=12", "task.pedestrians=4"]
BRAIN = ["localizer=ground_truth", "waypoints=spatial_horizon", "replan.on_request=false", "replan.blocked_for=null", "planner=dwa"]


class Replay(Planner):
    """Encodes what it sees and drives as it was told."""

    def __init__(self, encoder, commands):
        self.encoder, self.commands = encoder, commands
        self.seen, self.last = [], Twist(0.0)

    def compute_velocity(self, observation):
        self.seen.append(self.encoder.encode(ObservationBatch.of(observation, self.last))[0])
        self.last = Twist.of(self.commands[len(self.seen) - 1])
        return self.last


@pytest.mark.parametrize("encoder", ["rosnav", "rosnav_sectors", "gring"])
@pytest.mark.parametrize("robot", ["turtlebot3", "robotino"])
def test_navigator_shows_a_planner_what_the_environment_showed(robot, encoder):
    env = NavigationEnv(robot=robot, observation=encoder, overrides=[*COMMON, "environment.collisions_to_end=null"])
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (40, *env.action_space.shape)).astype(np.float32)
    shown = [env.reset(seed=0)[0], *(env.step(action)[0] for action in actions)]
    parts, problem = env.batch.parts, env.batch.episodes[0].problem

    registry = load_registry()
    benchmark = build_benchmark(plain(compose([f"robot={robot}", "world=indoor", *COMMON, *BRAIN])), registry)
    planner = Replay(parts.encoder, parts.scale.commands(actions))
    navigator, simulator = benchmark.navigator, benchmark.simulator
    navigator.planner = planner
    snapshot = simulator.reset([problem.scenario])
    navigator.reset(_mission(problem.scenario))
    for _ in actions:
        command = navigator.command(snapshot.sensors(0))
        snapshot = simulator.advance(command.array()[None], 5)
    assert all((seen == before).all() for seen, before in zip(planner.seen, shown, strict=False))
