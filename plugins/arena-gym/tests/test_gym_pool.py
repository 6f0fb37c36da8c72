from dataclasses import replace

import numpy as np
import pytest

from arena_core import ConfigurationError, ImpossibleScenario, NoPath, PedestrianSpec, TaskMode, World, WorldSource
from arena_core.hosting import Staging
from arena_core.tasks import Company
from arena_core.testing import component, robot, room, scenario
from arena_gym.building import build_parts, compose_environment
from arena_gym.environment import NavigationEnv
from arena_gym.episodes import draw_episode
from arena_gym.pool import CHECKED, TRIES, PooledWorlds, ProblemPool
from arena_gym.seeds import FIRST_TRAINING_SEED, check_evaluation_seed, training_seed
from arena_gym.settings import CountSpan, CrowdKind, Randomization, Span

PLAIN = Randomization(Span(0.0, 0.0), CountSpan(0, 0), Span(1.0, 1.0), None, Span(1.0, 1.0), {})
SMALL = [
    "world.width=8",
    "world.height=8",
    "task.pedestrians=3",
    "environment.worlds=3",
    "environment.problems_per_world=2",
]


class Numbered(WorldSource):
    """Gives a world of its own for each seed and index, and counts them."""

    def __init__(self):
        self.made = []

    def world(self, seed, index):
        self.made.append((seed, index))
        return World(f"{seed}/{index}", room())


class Walk(TaskMode):
    """The sample's scenario with three people; problem ``impossible`` is none."""

    def __init__(self, impossible=(), stage=None, levels=0):
        self.impossible, self.stage, self.levels = impossible, stage, levels

    def scenario(self, seed, index):
        if index in self.impossible:
            raise ImpossibleScenario("no room")
        people = [PedestrianSpec(k, np.array((k - 1.0, 2.0)), np.empty((0, 2)), 0.5, 0.3) for k in range(3)]
        drawn = scenario(people=people, name=f"walk/{index}", seed=seed)
        return (
            drawn
            if self.stage is None
            else type(drawn)(**{f: getattr(drawn, f) for f in drawn.__slots__} | {"stage": self.stage})
        )

    def staging(self):
        return Staging(self.levels, 0, 4, 0.8, 0.5) if self.levels else None

    def at_stage(self, stage):
        return Walk(self.impossible, stage, self.levels)


def pool_of(task, size=4, worlds=4):
    body = robot()
    return ProblemPool(
        task, component("global_planner", "astar", robot=body), waypoints(), simulator(), 0, worlds, size
    )


def waypoints():
    return component("waypoints", "spatial_horizon")


def simulator():
    return component("simulator", "sim2d", robot=robot(), pedestrians=component("pedestrians", "social_force"))


def test_worlds_are_made_once_and_differ():
    source = Numbered()
    worlds = PooledWorlds(source, 3)
    drawn = [worlds.world(training_seed(0), index) for index in range(12)]
    assert len(source.made) == 3
    assert all(drawn[k] is drawn[k % 3] for k in range(12))
    assert len({world.name for world in drawn}) == 3


def test_problems_have_training_seeds_alone():
    assert pool_of(Walk()).problem(0).scenario.seed >= FIRST_TRAINING_SEED
    assert check_evaluation_seed(0) == 0
    assert len({training_seed(seed, world) for seed in range(4) for world in range(300)}) == 1200
    for wrong in (-1, training_seed(0), training_seed(7, 3)):
        with pytest.raises(ConfigurationError, match="evaluation seed is"):
            check_evaluation_seed(wrong)


def test_task_that_gives_an_evaluation_seed_is_refused():
    class Stubborn(Walk):
        def scenario(self, seed, index):
            return super().scenario(3, index)

    with pytest.raises(AssertionError, match="which evaluation may use"):
        pool_of(Stubborn()).problem(0)


def test_impossible_problem_is_replaced_by_the_next_in_its_world():
    pool = pool_of(Walk(impossible=(1, 5)), 4)
    assert pool.problem(1).scenario.name == "walk/9"
    assert pool.problem(2).scenario.name == "walk/2"


def test_problem_of_a_world_that_has_none_is_replaced_by_that_of_the_next():
    """In whatever order they are drawn: a training that goes on draws in another one."""
    # world 1, and the second problem of world 2
    shut = [*range(1, 20000, 4), *(6 + 8 * attempt for attempt in range(TRIES))]
    expected = ["walk/0", "walk/2", "walk/2", "walk/3", "walk/4", "walk/7", "walk/7", "walk/7"]
    for order in (range(8), range(7, -1, -1), (5, 1, 6, 2, 0, 7, 4, 3)):
        pool = pool_of(Walk(impossible=shut), 8)
        found = {index: pool.problem(index).scenario.name for index in order}
        assert [found[index] for index in range(8)] == expected, order


def test_worlds_without_any_problem_are_told_of():
    pool = pool_of(Walk(impossible=range(10000)))
    with pytest.raises(
        ImpossibleScenario, match=f"problem 0 and those of {CHECKED - 1} more worlds cannot be trained on: no room"
    ):
        pool.check()
    with pytest.raises(ImpossibleScenario, match=f"problem 3 and those of {TRIES - 1} more worlds"):
        pool.problem(3)


def test_problem_without_a_way_is_replaced_too():
    class Shut:
        def plan(self, grid, start, goal):
            raise NoPath("shut in")

    pool = ProblemPool(Walk(), Shut(), waypoints(), simulator(), 0, 2, 2)
    with pytest.raises(ImpossibleScenario, match="shut in"):
        pool.problem(0)


def test_problem_that_no_simulator_can_begin_is_replaced_too():
    class OnTop(Walk):
        def scenario(self, seed, index):
            drawn = super().scenario(seed, index)
            on_robot = replace(drawn.pedestrians[0], position_xy=np.array((drawn.start.x, drawn.start.y)))
            return replace(drawn, pedestrians=(on_robot,)) if index == 0 else drawn

    assert pool_of(OnTop()).problem(0).scenario.name == "walk/4"


def test_problem_is_drawn_once():
    pool = pool_of(Walk())
    counts = []
    pool.fill(counts.append)
    assert counts == [1, 2, 3, 4]
    assert pool.problem(2) is pool.problem(2)
    assert pool.problem(0).left[0] == pytest.approx(pool.problem(0).path.length)


def test_levels_have_pools_of_their_own_that_are_kept():
    pool = pool_of(Walk(levels=3))
    assert [pool.at_stage(k).problem(0).scenario.stage for k in range(3)] == [0, 1, 2]
    assert pool.at_stage(1) is pool.at_stage(1)
    with pytest.raises(ConfigurationError, match=r"stage is 3; allowed: 0 \.\. 2"):
        pool.at_stage(3)
    with pytest.raises(ConfigurationError, match="this task has no levels"):
        pool_of(Walk()).at_stage(0)


def test_episode_is_a_function_of_seed_and_number():
    pool = pool_of(Walk())
    varied = Randomization(Span(0.0, 0.1), CountSpan(0, 3), Span(0.5, 1.0), CountSpan(0, 3), Span(0.5, 1.5), {})
    first, again, other = (draw_episode(pool, varied, seed, 5) for seed in (1, 1, 2))
    assert (first.noise, first.latency, first.noise_key) == (again.noise, again.latency, again.noise_key)
    assert first.noise_key != other.noise_key
    assert first.problem.scenario.name != other.problem.scenario.name, "so that the noise of sensors differs"


def test_what_is_varied_stays_within_its_span():
    pool = pool_of(Walk())
    varied = Randomization(Span(0.02, 0.1), CountSpan(1, 3), Span(0.5, 0.8), CountSpan(1, 2), Span(0.5, 1.5), {})
    episodes = [draw_episode(pool, varied, 0, number) for number in range(60)]
    scenarios = [episode.problem.scenario for episode in episodes]
    assert all(0.02 <= episode.noise <= 0.1 for episode in episodes)
    assert {episode.latency for episode in episodes} == {1, 2, 3}
    assert {len(s.pedestrians) for s in scenarios} == {1, 2}
    assert all(0.5 <= s.speed_share <= 0.8 for s in scenarios)
    speeds = [person.desired_speed for s in scenarios for person in s.pedestrians]
    assert 0.25 <= min(speeds) < 0.35 < 0.65 < max(speeds) <= 0.75
    plain = draw_episode(pool, PLAIN, 0, 0)
    assert (plain.noise, plain.latency, plain.problem.scenario.speed_share) == (0.0, 0, 1.0)
    assert [person.id for person in plain.problem.scenario.pedestrians] == [0, 1, 2]


def test_an_episode_has_one_kind_of_people():
    pool = pool_of(Walk())
    kinds = {"slow": CrowdKind(3.0, Span(0.5, 0.6), None), "quick": CrowdKind(1.0, Span(2.0, 3.0), "yield")}
    varied = replace(PLAIN, crowds=kinds)
    usual = pool.problem(0).scenario.pedestrians[0].desired_speed
    found = []
    for number in range(200):
        people = draw_episode(pool, varied, 0, number).problem.scenario.pedestrians
        factors = {round(person.desired_speed / usual, 9) for person in people}
        reactions = {person.behaviour.get("reaction") for person in people}
        assert len(factors) == len(reactions) == 1
        found.append((factors.pop(), reactions.pop()))
    assert {0.5 <= factor <= 0.6 for factor, reaction in found if reaction is None} == {True}
    assert {2.0 <= factor <= 3.0 for factor, reaction in found if reaction == "yield"} == {True}
    assert 0.65 < sum(reaction is None for _, reaction in found) / len(found) < 0.85


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("share: 0, speed: {low: 1, high: 1}, reaction: null", r"the shares are all 0; allowed: one"),
        ("share: 1, speed: {low: 0, high: 1}, reaction: null", r"speed\.low is 0\.0; allowed: > 0"),
        ("share: 1, speed: {low: 2, high: 1}, reaction: null", r"low is 2\.0, above high, 1\.0"),
        ("share: 1, speed: {low: 1, high: 1}, reaction: flee", r"reaction is 'flee'; allowed: .*yield"),
    ],
)
def test_kinds_of_people_that_cannot_be_are_refused(kind, message):
    with pytest.raises(ConfigurationError, match=message):
        NavigationEnv(overrides=[*SMALL, "task.pedestrians=1", f"+randomization.crowds.some={{{kind}}}"]).reset(seed=0)


def test_environment_draws_from_all_its_worlds():
    env = NavigationEnv(overrides=SMALL)
    names = {env.reset(seed=seed)[1]["scenario"].split("/")[1] for seed in range(40)}
    assert len(names) == 6


def test_configuration_can_be_composed_inside_hydra():
    from hydra import initialize
    from hydra.core.global_hydra import GlobalHydra

    with initialize(version_base="1.3"):
        inside = GlobalHydra.instance().hydra
        assert build_parts(compose_environment(SMALL, robot="turtlebot3")).robot.name == "turtlebot3"
        assert GlobalHydra.instance().hydra is inside


def test_command_acts_as_late_as_its_latency():
    quick, late = (
        NavigationEnv(overrides=[*SMALL, f"randomization.latency={{low: {k}, high: {k}}}"], reward="progress")
        for k in (0, 2)
    )
    travelled = []
    for env in (quick, late):
        env.reset(seed=1)
        for _ in range(3):
            env.step(np.array((1.0, 0.0), np.float32))
        travelled.append(env.batch.parts.simulator.advance(np.zeros((1, 3)), 0).stamps[0])
    assert travelled[0] == travelled[1] == pytest.approx(0.3)
    first = [env.batch._situation.twists[0, 0] for env in (quick, late)]
    assert first[0] > first[1] > 0.0


def test_a_goal_that_moves_with_a_person_is_not_trained_on():
    class Followed(Walk):
        def scenario(self, seed, index):
            return replace(super().scenario(seed, index), company=Company("follow", 0, 1.0, 2.0))

    with pytest.raises(ConfigurationError, match="its goal moves with a person; allowed in training: tasks whose goal"):
        pool_of(Followed()).problem(0)
