"""Worlds that are forked: under every crowd, in both simulators, a branch goes on as the original does."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import (
    Branches,
    ConfigurationError,
    PedestrianModel,
    PedestrianSpec,
    Pose,
    Scenario,
    Simulator,
    Snapshot,
)
from arena_core.hosting import build_benchmark, compose, load_registry
from arena_core.loop.execution import mission_of
from arena_core.loop.navigator import Navigator
from arena_core.testing import component, robot, scenario

TICKS = 10  # of 10 ms: a control step
CROWDS = {
    "ignoring": ("social_force", ["pedestrians.reaction=ignore"]),
    "yielding": ("social_force", ["pedestrians.reaction=yield"]),
    "lively": ("social_force_lively", []),
    "on legs": ("social_force", ["pedestrians.body=legs"]),
    "orca": ("orca", []),
    "timetable": ("timetable", []),
    "none": ("none", []),
}
SIMULATORS = {
    "sim2d": ("sim2d", []),
    "mujoco": ("mujoco", []),
    "mujoco on wheels": ("mujoco", ["simulator.drive=wheels"]),
    "mujoco with a camera": ("mujoco", ["simulator.depth_camera.enabled=true"]),
}
COMMAND = np.array((0.4, 0.0, 0.3))


def problem(seed: int = 1, people: int = 6, **behaviour: float) -> Scenario:
    """Return a room in which people criss-cross the robot's way."""
    random = np.random.default_rng(seed)
    specs = []
    for i in range(people):
        angle = 2.0 * np.pi * i / people
        home = random.uniform(1.2, 3.0) * np.array((np.cos(angle), np.sin(angle)))
        specs.append(PedestrianSpec(i + 1, home, np.array((-home, home)), random.uniform(0.4, 1.2), 0.3, behaviour))
    return scenario(start=Pose(-3.0, -3.0, 0.7), people=specs, name=f"fork/{seed}", seed=seed)


def build(crowd: str, simulator: str = "sim2d") -> Simulator:
    preset, overrides = SIMULATORS[simulator]
    people = component("pedestrians", *CROWDS[crowd])
    built: Simulator = component("simulator", preset, overrides, robot=robot("differential"), pedestrians=people)
    return built


def drive(simulator: Simulator, steps: int, worlds: int = 1) -> Snapshot:
    """Return what is after so many control steps with the same command."""
    return [simulator.advance(np.tile(COMMAND, (worlds, 1)), TICKS) for _ in range(steps)][-1]


def same_people(one: Snapshot, k: int, other: Snapshot, m: int) -> bool:
    names = ("positions", "velocities", "states")
    return all(
        np.array_equal(getattr(one.crowd, name)[k], getattr(other.crowd, name)[m], equal_nan=name != "states")
        for name in names
    )


def same_world(one: Snapshot, k: int, other: Snapshot, m: int) -> bool:
    """Return whether two worlds are equal bit for bit: bodies, scans, odometry, images."""
    names = ["stamps", "poses", "twists", "clearances", "contact_times", "ranges", "odometry_poses", "odometry_twists"]
    names += [] if one.depths is None else ["depths", "depth_stamps"]
    return all(np.array_equal(getattr(one, n)[k], getattr(other, n)[m]) for n in names) and (
        one.contacts[k] == other.contacts[m] and same_people(one, k, other, m)
    )


@pytest.mark.parametrize(
    ("crowd", "simulator"),
    [
        *((crowd, simulator) for crowd in CROWDS for simulator in ("sim2d", "mujoco")),
        ("lively", "mujoco on wheels"),
        ("on legs", "mujoco with a camera"),
    ],
)
def test_a_fork_goes_on_as_its_original_bit_for_bit_whoever_is_driven_first(crowd, simulator):
    original = build(crowd, simulator)
    original.reset([problem(1), problem(2, people=4)])
    drive(original, 6, worlds=2)
    early = original.fork(Branches.of([1, 0, 1]))
    first = drive(early, 8, worlds=3)
    late = original.fork(Branches.of([0]))
    own = drive(original, 8, worlds=2)
    assert same_world(first, 0, own, 1)
    assert same_world(first, 2, own, 1)
    assert same_world(first, 1, own, 0)
    assert same_world(drive(late, 8), 0, own, 0)


def test_a_fork_knows_what_is_now_without_a_step():
    original = build("ignoring")
    original.reset([problem()])
    then = drive(original, 5)
    now = original.fork(Branches.of([0])).advance(np.zeros((1, 3)), 0)
    assert np.array_equal(now.poses, then.poses)
    assert np.array_equal(now.ranges, then.ranges)
    assert same_people(now, 0, then, 0)


def test_a_fork_of_a_fork_goes_on_as_the_first_original():
    original = build("lively")
    original.reset([problem()])
    again = original.fork(Branches.of([0, 0])).fork(Branches.of([1]))
    assert same_world(drive(again, 10), 0, drive(original, 10), 0)


def test_branches_with_other_commands_part():
    original = build("yielding")
    original.reset([problem()])
    fork = original.fork(Branches.of([0, 0]))
    commands = np.array([(0.5, 0.0, 0.0), (-0.5, 0.0, 0.0)])
    for _ in range(20):
        last = fork.advance(commands, TICKS)
    assert np.hypot(*(last.poses[0, :2] - last.poses[1, :2])) > 1.0


@pytest.mark.parametrize("crowd", ["lively", "orca"])
def test_streams_of_ones_own_are_other_futures_and_the_same_again(crowd):
    original = build(crowd)
    original.reset([problem(pause_probability=0.9, pause_time=1.0)])
    drive(original, 5)
    far = drive(original.fork(Branches.of([0, 0, 0], streams=[0, 7, 7])), 150, worlds=3)
    own = drive(original, 150)
    assert same_people(far, 0, own, 0)
    assert same_people(far, 1, far, 2)
    assert not same_people(far, 0, far, 1)


def test_odometry_and_scans_of_another_stream_have_other_noise():
    noisy = component("robot", "turtlebot3")
    original = component("simulator", "sim2d", robot=noisy, pedestrians=component("pedestrians", "none"))
    original.reset([problem(people=0)])
    pair = drive(original.fork(Branches.of([0, 0], streams=[0, 1])), 5, worlds=2)
    assert np.array_equal(pair.poses[0], pair.poses[1])
    assert not np.array_equal(pair.ranges[0], pair.ranges[1])
    assert not np.array_equal(pair.odometry_poses[0], pair.odometry_poses[1])


@pytest.mark.parametrize("simulator", SIMULATORS)
def test_people_walk_as_if_a_robot_that_is_left_out_had_never_been_there(simulator):
    standing = replace(problem(people=2), start=Pose(0.0, 0.0, 0.0))  # both would walk into it
    with_robot = build("ignoring", simulator)
    with_robot.reset([standing])
    without = with_robot.fork(Branches.of([0], robots=False))
    elsewhere = build("ignoring", simulator)
    elsewhere.reset([replace(standing, start=Pose(-3.5, -3.5, 0.0))])
    still = np.zeros((1, 3))
    for _ in range(40):
        free, far, met = (each.advance(still, TICKS) for each in (without, elsewhere, with_robot))
    assert same_people(free, 0, far, 0)
    assert not same_people(free, 0, met, 0)
    assert np.isnan(free.poses).all()
    assert free.clearances[0] == np.inf
    assert free.contacts == ((),)


def test_people_who_yield_do_not_see_a_robot_that_is_left_out():
    ends = []
    for crowd in ("yielding", "ignoring"):
        simulator = build(crowd)
        simulator.reset([replace(problem(people=2), start=Pose(0.0, 0.0, 0.0))])
        ends.append(drive(simulator.fork(Branches.of([0], robots=False)), 40))
    assert same_people(ends[0], 0, ends[1], 0)


@pytest.mark.parametrize("planner", ["teb", "rosnav", "aio"])
def test_a_forked_navigator_drives_a_forked_world_as_the_originals_do(planner):
    overrides = [f"planner={planner}", "robot=jackal", "world=empty", "task.pedestrians=4"]
    benchmark = build_benchmark(compose(overrides), load_registry())
    simulator, navigator, drawn = benchmark.simulator, benchmark.navigator, benchmark.task.scenario(0, 0)
    now = simulator.reset([drawn])
    navigator.reset(mission_of(drawn))
    navigator.rehearse(now.sensors(0))
    now = drive_on(simulator, navigator, now, 10)
    twins = simulator.fork(Branches.of([0])), navigator.fork()
    assert same_world(drive_on(*twins, now, 15), 0, drive_on(simulator, navigator, now, 15), 0)


def drive_on(simulator: Simulator, navigator: Navigator, now: Snapshot, steps: int) -> Snapshot:
    """Return what is after so many control steps that a navigator decides."""
    for _ in range(steps):
        now = simulator.advance(navigator.command(now.sensors(0)).array()[None], TICKS)
    return now


def test_what_cannot_be_forked_says_so():
    class Simple(type(component("pedestrians", "none"))):
        fork = PedestrianModel.fork

    simulator = component("simulator", "sim2d", robot=robot("differential"), pedestrians=Simple())
    simulator.reset([problem(people=0)])
    with pytest.raises(ConfigurationError, match="Simple cannot be forked"):
        simulator.fork(Branches.of([0]))
