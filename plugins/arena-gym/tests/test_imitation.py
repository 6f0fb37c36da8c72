"""Lessons: who drives, what is seen and what the teacher says there."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from arena_core import ConfigurationError, Planner, Twist
from arena_core.hosting import load_registry
from arena_gym.vector_environment import NavigationVectorEnv

torch = pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")

ROBOTS = {"jackal": 1, "robotino": 1, "jackal_ackermann": 1, "turtlebot3": 2}


class Compass(Planner):
    """Says where the robot is, as a velocity; remembers its episodes and the tracks that it saw."""

    def __init__(self, limits):
        self._limits = limits
        self.periods, self.tracks = [], []

    def reset(self, episode):
        self.periods.append(episode.control_period)

    def compute_velocity(self, observation):
        self.tracks.append(len(observation.tracks.ids))
        return Twist(self._limits.vx_max * (0.5 + 0.01 * observation.pose.x), 0.0, 0.1 * self._limits.wz_max)


def classroom(robot, *overrides, worlds=4):
    from arena_gym.training.imitation import ImitationWorlds

    words = [f"environment.every={ROBOTS[robot]}", "environment.standing_to_end=1.0", "task.pedestrians=6", *overrides]
    env = NavigationVectorEnv(
        worlds, robot=robot, world="indoor", task="random", observation="rosnav_sectors", overrides=words
    )
    compasses = []

    def build(kind, node, **given):
        if kind != "planner":
            return load_registry().build(kind, node, **given)
        compasses.append(Compass(env.batch.parts.robot.limits))
        return compasses[-1]

    registry = SimpleNamespace(build=build, component=load_registry().component, manager=load_registry().manager)
    return ImitationWorlds(env.batch, "teb", robot, registry), env.batch, compasses


class Standing:
    """A policy that asks for the least of everything."""

    def __init__(self, batch):
        self._actions = len(batch.parts.scale.names)

    def act(self, observations):
        return np.full((len(observations), self._actions), -1.0, np.float32)


@pytest.mark.slow
@pytest.mark.parametrize("robot", ROBOTS)
def test_teacher_speaks_of_what_is_seen_and_drives_its_share_of_the_worlds(robot):
    tracked = ["guide=driving", "tracker@guide.tracker=kalman", "observation_encoder.foreseen=[1.0]"]
    room, batch, compasses = classroom(robot, *tracked)
    driven = []
    step = batch.step
    batch.step = lambda actions: driven.append(actions.copy()) or step(actions)
    lesson = room.collect_rollout(Standing(batch), 30, 0.5, 0)
    assert lesson.seen.shape[0] == lesson.shown.shape[0] == 30 * 4
    shown = lesson.shown.reshape(30, 4, -1)
    for t, actions in enumerate(driven):
        assert (actions[:2] == shown[t, :2]).all(), "the teacher drives the first half"
        assert (actions[2:] == -1.0).all(), "and the policy the rest"
    assert lesson.ends, "robots that stand end, and begin again"
    assert sum(len(compass.periods) for compass in compasses) == 4 + sum(lesson.ends.values())
    assert set(np.concatenate([compass.periods for compass in compasses])) == {
        batch.parts.robot.control_period * ROBOTS[robot]
    }
    assert max(max(compass.tracks) for compass in compasses) > 0, "it sees the tracks of the environment"


def test_what_the_teacher_says_is_of_the_same_moment_as_what_is_seen():
    room, batch, _ = classroom("turtlebot3")
    seen = []
    reset, step, restart = batch.reset, batch.step, batch.restart
    poses = np.zeros((4, 3))

    def noted(slots, answer):
        poses[slots] = batch.seen.poses
        return answer

    batch.reset = lambda seeds: noted(slice(None), reset(seeds))
    batch.restart = lambda slots: noted(slots, restart(slots))

    def stepping(actions):
        seen.append(poses.copy())
        return noted(slice(None), step(actions))

    batch.step = stepping
    lesson = room.collect_rollout(Standing(batch), 30, 0.25, 0)
    wanted = np.zeros((120, 3))
    limits = batch.parts.robot.limits
    wanted[:, 0], wanted[:, 2] = limits.vx_max * (0.5 + 0.01 * np.concatenate(seen)[:, 0]), 0.1 * limits.wz_max
    assert lesson.ends
    assert lesson.shown == pytest.approx(batch.parts.scale.actions(wanted), abs=1e-6)


@pytest.mark.slow
def test_lesson_is_the_same_twice():
    first, again = (classroom("jackal")[0] for _ in range(2))
    lessons = [room.collect_rollout(Standing(room.batch), 12, 0.5, 7) for room in (first, again)]
    assert (lessons[0].seen == lessons[1].seen).all()
    assert (lessons[0].shown == lessons[1].shown).all()


def test_switch_has_no_teacher():
    from arena_gym.training.imitation import ImitationWorlds

    batch = SimpleNamespace(parts=SimpleNamespace(switch=object()), worlds=1)
    with pytest.raises(ConfigurationError, match=r"teacher\.planner is teb; allowed: null for a switch"):
        ImitationWorlds(batch, "teb", "jackal", load_registry())


class Line(torch.nn.Linear):
    """A network whose actions are linear in what is seen."""

    action_means = torch.nn.Linear.forward


def test_where_a_teacher_goes_two_ways_the_policy_takes_the_usual_one():
    from arena_gym.training.imitation import fit_imitation
    from arena_gym.training.settings import ExpertSettings

    torch.manual_seed(0)
    line = Line(1, 1)
    settings = ExpertSettings(planner="teb", rounds=1, decisions=100, epochs=200, minibatch=50, learning_rate=0.01)
    seen, shown = np.ones((100, 1), np.float32), np.where(np.arange(100) < 70, -0.8, 0.8).astype(np.float32)[:, None]
    optimizer = torch.optim.Adam(line.parameters(), lr=settings.learning_rate)
    off = fit_imitation(line, optimizer, [(seen, shown)], settings, 1.0, np.random.default_rng(0))
    assert float(line.action_means(torch.ones(1, 1)).detach()) == pytest.approx(-0.8, abs=0.05)
    assert off == pytest.approx(0.3 * 1.6, abs=0.03)
