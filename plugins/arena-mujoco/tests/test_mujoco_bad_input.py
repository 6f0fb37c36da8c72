"""What cannot be simulated in 3-D: a clear line before anything runs, or an error row; other worlds go on."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arena_core import ConfigurationError, ImpossibleScenario, Obstacle, OccupancyGrid, Pose, World
from arena_core.hosting import build_benchmark, compose, load_registry, to_plain
from arena_core.testing import robot, scenario

QUICK = [
    "planner=pure_pursuit",
    "robot=turtlebot3",
    "world=empty",
    "task.time_limit=2",
    "simulator=mujoco",
    "localizer=ground_truth",
]
FORWARDS = np.array([[0.5, 0.0, 0.0]])
DRIVES = pytest.mark.parametrize("drive", ["planar", "wheels"])


def checkered(side):
    """Return a map of cells that no two make a larger box of, free in the middle."""
    rows, columns = np.indices((side, side))
    data = np.where((rows + columns) % 2 == 0, 100, 0).astype(np.int8)
    middle = slice(side // 2 - 10, side // 2 + 10)
    data[middle, middle] = 0
    return OccupancyGrid(data, 0.05, Pose(-0.025 * side, -0.025 * side))


def test_world_with_too_many_walls_is_refused(simulate):
    drive = replace(scenario(start=Pose(0.0, 0.0, 0.0)), world=World("checkered", checkered(220)))
    with pytest.raises(
        ImpossibleScenario, match=r"sample/0: its walls are \d+ boxes; allowed with simulator=mujoco: 20000"
    ):
        simulate(robot()).reset([drive])


@pytest.mark.slow
def test_world_with_many_walls_runs(simulate):
    drive = replace(scenario(start=Pose(0.0, 0.0, 0.0)), world=World("checkered", checkered(60)))
    simulator = simulate(robot())
    simulator.reset([drive])
    assert np.isfinite(simulator.advance(FORWARDS, 10).poses).all()


@DRIVES
@pytest.mark.parametrize("speed", [np.nan, np.inf, 1e30])
def test_explosion_ends_one_world_and_leaves_the_others(simulate, drive, speed, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    simulator, alone = simulate(robot(), f"simulator.drive={drive}"), simulate(robot(), f"simulator.drive={drive}")
    simulator.reset([scenario(), scenario()])
    alone.reset([scenario()])
    simulator.advance(np.repeat(FORWARDS, 2, axis=0), 10)
    alone.advance(FORWARDS, 10)
    simulator._physical[0].data.qvel[:] = speed
    for _ in range(3):
        both, one = simulator.advance(np.repeat(FORWARDS, 2, axis=0), 10), alone.advance(FORWARDS, 10)
    assert list(both.failures) == [0]
    assert both.failures[0].startswith(
        "UnstablePhysics: positions or speeds are no longer finite; a smaller simulator.timestep may help"
    )
    assert np.isfinite(both.poses).all()
    assert np.isfinite(both.twists).all()
    assert both.poses[1].tobytes() == one.poses[0].tobytes()
    assert list(tmp_path.iterdir()) == []  # MuJoCo keeps no log of its own where the run is started


def test_world_that_exploded_can_begin_anew(simulate):
    simulator = simulate(robot())
    simulator.reset([scenario()])
    simulator._physical[0].data.qvel[:] = np.nan
    assert simulator.advance(FORWARDS, 10).failures
    assert not simulator.reset([scenario()]).failures
    assert not simulator.advance(FORWARDS, 10).failures


def test_robot_that_tips_over_in_a_bend_says_so(simulate):
    tall = [
        "simulator.body.height=2",
        "simulator.body.centre_height=1",
        "simulator.body.lidar_height=0.2",
        "simulator.tip_angle=0.5",
    ]
    simulator = simulate(robot(), "simulator.drive=wheels", *tall)
    simulator.reset([scenario()])
    snapshots = [simulator.advance(np.array([[1.0, 0.0, 2.0]]), 10) for _ in range(25)]
    assert snapshots[-1].failures == {0: "RobotTippedOver: it leans by more than simulator.tip_angle"}
    assert snapshots[-1].poses.tobytes() == snapshots[-2].poses.tobytes()


def test_episode_whose_physics_explodes_is_an_error_row(tmp_path):
    run = build_benchmark({**to_plain(compose(QUICK)), "choices": {}}, load_registry())
    compute = run.navigator.planner.compute_velocity

    def explode(observation):
        if observation.stamp > 0.5:
            run.simulator._physical[0].data.qvel[:] = np.nan
        return compute(observation)

    run.navigator.planner.compute_velocity = explode
    record = run.run(0, tmp_path)
    assert record.meta["outcome"] == "error"
    assert record.meta["error"].startswith("UnstablePhysics")
    assert 5 <= len(record["stamp"]) < 12  # what was driven until then is kept


def test_obstacle_that_crosses_itself_is_refused(simulate):
    bow = Obstacle(np.array([[1.0, 0.0], [2.0, 1.0], [2.0, 0.0], [1.0, 1.0]]))
    with pytest.raises(ImpossibleScenario, match="is no simple polygon"):
        simulate(robot()).reset([replace(scenario(), obstacles=(bow,))])


@pytest.mark.parametrize(
    ("override", "said"),
    [
        (
            "simulator.timestep=0.003",
            r"simulator.timestep is 0.003 s; allowed: simulator.inner_step \(0.01 s\) or a whole part of it",
        ),
        ("simulator.timestep=.nan", r"simulator.timestep is .*nan.*; allowed: a number"),
        ("simulator.timestep=0", r"simulator.timestep is 0"),
        ("simulator.wall_height=0.1", r"simulator.wall_height is 0.1; allowed: above the lidar"),
        ("simulator.drive=legs", r"simulator.drive is 'legs'; allowed: one of planar, wheels"),
        ("simulator.body.mass=.nan", r"simulator.body.mass is .*nan.*; allowed: a number"),
        ("simulator.body.mass=.inf", r"simulator.body.mass is .*inf.*; allowed: a number"),
        (
            "simulator.body.wheels={radius:0.05,width:0.02,mass:0.1,torque:1.0,places:[[0,0.1]]}",
            r"1 wheels and 2 casters; allowed",
        ),
        ("simulator.body.casters=[[0.1]]", r"allowed: pairs \[x, y\] \(m\)"),
        ("simulator.floor_friction=-1", r"simulator.floor_friction is -1"),
    ],
)
def test_impossible_number_is_one_line(simulate, override, said):
    with pytest.raises(ConfigurationError, match=said) as raised:
        simulate(robot(), override)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("robot.lidar=null", "robot.lidar is None; allowed: a mapping with beams"),
        ("robot.lidar.beams=0", "robot.lidar.beams is 0; allowed"),
        ("robot.lidar.range_max=0", "robot.lidar.range_max is 0"),
    ],
)
def test_robot_without_a_lidar_is_refused_before_anything_runs(override, said):
    with pytest.raises(ConfigurationError, match=said):
        build_benchmark({**to_plain(compose([*QUICK, override])), "choices": {}}, load_registry())


def test_robot_whose_file_names_no_lidar_has_it_on_top(simulate):
    cart = Path(__file__).parent / "models" / "cart.urdf"
    assert simulate(robot(), f"simulator.body.model={cart}")._body.lidar_height == pytest.approx(0.16)
