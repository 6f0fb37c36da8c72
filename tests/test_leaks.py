"""The truth never reaches the planner: not through the state, not through people's numbers, not through randomness."""

import math
from dataclasses import replace

import numpy as np
import pytest

from arena_core import Pose, Simulator, Twist
from arena_core.config.configuration import compose, to_plain
from arena_core.config.registry import load_registry
from arena_core.loop.record_arrays import CONTACT_KINDS
from arena_core.runs.jobs.benchmark import build_benchmark

NOWHERE = Pose(math.nan, math.nan, math.nan)
PERSON = CONTACT_KINDS.index("person")
TRUTH = ("poses", "twists", "clearances", "clearances_people", "contact_times")


class Poisoned(Simulator):
    """Returns NaN wherever the truth would be; the sensors are as they were."""

    def __init__(self, simulator):
        self.simulator, self.inner_step = simulator, simulator.inner_step

    def reset(self, scenarios, slots=None):
        return self.poison(self.simulator.reset(scenarios, slots))

    def advance(self, commands, ticks):
        return self.poison(self.simulator.advance(commands, ticks))

    def fork(self, branches):
        return Poisoned(self.simulator.fork(branches))

    def poison(self, snapshot):
        crowd = replace(
            snapshot.crowd,
            positions=snapshot.crowd.positions * math.nan,
            velocities=snapshot.crowd.velocities * math.nan,
        )
        return replace(snapshot, crowd=crowd, **{name: getattr(snapshot, name) * math.nan for name in TRUTH})


def benchmark(*overrides):
    words = ["robot=jackal", "world=warehouse", "task.pedestrians=5", "episodes=1", *overrides]
    return build_benchmark(to_plain(compose(words)), load_registry())


@pytest.mark.parametrize(
    "words",
    [
        ["planner=dwa"],
        ["planner=pure_pursuit"],
        ["planner=orca"],
        ["planner=orca", "tracker=ground_truth"],
    ],
    ids=" ".join,
)
def test_a_run_with_a_poisoned_truth_gives_the_same_commands_unless_something_may_see_it(words, tmp_path):
    clean = benchmark(*words, "task.time_limit=20")
    poisoned = replace(clean, simulator=Poisoned(clean.simulator))
    one, other = clean.run(0, tmp_path), poisoned.run(0, tmp_path)
    assert np.isnan(other["pose"]).all()
    assert np.isfinite(one["pose"]).all()
    steps = min(len(one["command"]), len(other["command"])) - 1
    assert steps > 30
    same = all((one[name][:steps] == other[name][:steps]).all() for name in ("command", "estimate"))
    assert same == (not clean.privileged)


def test_the_estimate_comes_from_the_sensors_and_not_from_the_truth(tmp_path):
    record = benchmark("planner=pure_pursuit", "task.time_limit=10").run(0, tmp_path)
    off = np.hypot(*(record["estimate"] - record["pose"])[1:, :2].T)
    assert (off > 1e-6).all()
    assert off.max() < 0.5


def walk_until_touched(record):
    """Return where people are at each step, as far as the robot has not yet been in their way."""
    touched = record["contact_stamp"][record["contact_kind"] == PERSON].min(initial=np.inf)
    return record["pedestrian_positions"][record["stamp"] < touched]


def test_people_who_ignore_the_robot_walk_alike_until_first_contact_whoever_drives(tmp_path):
    compared = 0
    dwa, pure_pursuit = (
        benchmark(f"planner={p}", "pedestrians.reaction=ignore", "task.time_limit=30") for p in ("dwa", "pure_pursuit")
    )
    for episode in range(3):
        one, other = (walk_until_touched(run.run(episode, tmp_path)) for run in (dwa, pure_pursuit))
        steps = min(len(one), len(other))
        assert (one[:steps] == other[:steps]).all()
        compared += steps
    assert compared > 100


def test_the_scenarios_are_the_same_whoever_drives_and_whatever_localises():
    one = benchmark("planner=dwa", "localizer=amcl").task.scenario(0, 3)
    other = benchmark("planner=pure_pursuit", "localizer=ground_truth").task.scenario(0, 3)
    assert (one.name, one.start, one.goal) == (other.name, other.start, other.goal)
    assert all((a.position_xy == b.position_xy).all() for a, b in zip(one.pedestrians, other.pedestrians, strict=True))


def test_the_planner_cannot_reach_the_reference_pose(tmp_path):
    seen = []
    run = benchmark("planner=pure_pursuit", "task.time_limit=1")
    compute = run.navigator.planner.compute_velocity
    run.navigator.planner.compute_velocity = lambda observation: seen.append(observation) or compute(observation)
    run.run(0, tmp_path)
    names = {name for observation in seen for name in dir(observation) if not name.startswith("__")}
    assert names == {
        *(
            "stamp",
            "pose",
            "covariance",
            "twist",
            "scan",
            "goal",
            "waypoint",
            "path",
            "map",
            "local_map",
            "tracks",
            "predictions",
            "heard",
            "depth",
        ),
        *("_local_map", "_tracks", "_predictions"),
    }
    assert all(isinstance(observation.twist, Twist) for observation in seen)
