"""The depth camera: what it sees is where it is, and planners see it only where it is asked for."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import ConfigurationError, DepthImage, ObservationBatch, Pose, Twist
from arena_core.hosting import build_benchmark, compose, load_registry, to_plain
from arena_core.testing import furniture, observation, robot, scenario
from arena_core.testing.samples import person

ON = ["simulator.depth_camera.enabled=true", "simulator.depth_camera.noise=0", "simulator.depth_camera.range_max=6"]
WALL = 4.95  # m


def at(x=0.0, y=0.0, theta=0.0, people=(), pieces=()):
    drive = scenario(start=Pose(x, y, theta), people=people)
    return replace(drive, world=replace(drive.world, furniture=pieces))


def image(simulate, drive, *overrides):
    snapshot = simulate(robot(), *ON, *overrides).reset([drive])
    return snapshot.sensors(0).depth


def test_robots_have_no_camera_unless_asked(simulate):
    snapshot = simulate(robot()).reset([at()])
    assert snapshot.depths is None
    assert snapshot.sensors(0).depth is None


@pytest.mark.parametrize("drive", ["planar", "wheels"])
def test_wall_is_as_far_in_every_pixel_and_the_floor_is_level(simulate, drive):
    taken = image(simulate, at(), f"simulator.drive={drive}")
    assert taken.depths.shape == (36, 64)
    assert taken.depths.dtype == np.float32
    points = taken.points()
    floor = np.isfinite(taken.depths) & (points[..., 2] < 0.01)
    wall = np.isfinite(taken.depths) & ~floor
    assert wall.sum() > 300
    assert points[wall][:, 0] == pytest.approx(np.full(wall.sum(), WALL), abs=0.02)
    assert floor.sum() > 200
    assert np.abs(points[floor][:, 2]).max() < 0.02
    assert not floor[:18].any()  # below the horizon alone


def test_image_is_that_of_the_slice_at_the_height_of_the_camera(simulate):
    snapshot = simulate(robot(), *ON, "simulator.depth_camera.rows=1", "simulator.depth_camera.x=0").reset(
        [at(1.0, 0.5, 0.4)]
    )
    points = snapshot.sensors(0).depth.points()[0]
    there = np.isfinite(points[:, 0])
    angles, ranges = np.arctan2(points[there, 1], points[there, 0]), np.hypot(points[there, 0], points[there, 1])
    lidar = robot().lidar
    seen = np.interp(angles, lidar.angles(), snapshot.ranges[0])
    assert np.median(np.abs(seen - ranges)) < 0.01


def test_camera_sees_the_top_of_a_table_that_the_lidar_does_not(simulate):
    drive = at(pieces=(furniture("table", 1.5, 0.0, 0.5 * np.pi),))
    taken = image(simulate, drive, "simulator.depth_camera.height=0.3")
    points = taken.points()
    edge = (np.abs(points[..., 0] - 1.1) < 0.01) & (points[..., 2] > 0.7) & (points[..., 2] < 0.75)
    assert edge.sum() > 5
    assert simulate(robot()).reset([drive]).ranges[0][robot().lidar.beams // 2] > 4.0


@pytest.mark.parametrize("legs", [True, False])
def test_camera_sees_people_from_head_to_foot(simulate, legs):
    overrides = ["pedestrians.body=legs"] if legs else []
    taken = image(simulate, at(people=[person(1, 2.0, 0.0)]), "simulator.depth_camera.pitch=-0.2", *overrides)
    points = taken.points()
    body = np.isfinite(taken.depths) & (np.hypot(points[..., 0] - 2.0, points[..., 1]) < 0.35)
    assert points[body][:, 2].max() > 1.5
    assert points[body][:, 2].min() < 0.4


def test_returns_out_of_range_are_infinite(simulate):
    near = image(
        simulate, at(WALL - 0.2 - 0.1), "simulator.depth_camera.range_min=0.3", "simulator.depth_camera.rows=1"
    )
    assert np.isinf(near.depths).all()
    far = image(simulate, at(), "simulator.depth_camera.range_max=3", "simulator.depth_camera.rows=1")
    assert np.isinf(far.depths).all()


def test_noise_grows_with_the_square_of_the_depth_and_is_the_same_for_the_same_seed(simulate):
    noisy = "simulator.depth_camera.noise=0.01"
    exact, one, other = image(simulate, at()), image(simulate, at(), noisy), image(simulate, at(), noisy)
    assert one.depths.tobytes() == other.depths.tobytes()
    there = np.isfinite(exact.depths)
    error = (one.depths[there] - exact.depths[there]) / exact.depths[there] ** 2
    assert error.std() == pytest.approx(0.01, rel=0.1)


def test_image_keeps_its_stamp_between_two(simulate):
    simulator = simulate(robot(), *ON, "simulator.depth_camera.period=0.3")
    simulator.reset([at()])
    stamps = [simulator.advance(np.array([[0.5, 0.0, 0.0]]), 10).sensors(0).depth.stamp for _ in range(6)]
    assert stamps == pytest.approx([0.0, 0.0, 0.3, 0.3, 0.3, 0.6])


def test_camera_moves_with_the_robot_and_worlds_of_a_batch_are_as_alone(simulate):
    worlds = [at(0.0, 0.0, turn) for turn in (0.0, 0.8)]
    batch, alone = simulate(robot(), *ON), simulate(robot(), *ON)
    batch.reset(worlds)
    alone.reset(worlds[1:])
    for _ in range(10):
        many, one = batch.advance(np.tile((0.8, 0.0, 0.3), (2, 1)), 10), alone.advance(np.array([(0.8, 0.0, 0.3)]), 10)
    assert many.depths[1].tobytes() == one.depths[0].tobytes()
    assert many.depths[0].tobytes() != many.depths[1].tobytes()


@pytest.mark.parametrize(
    ("override", "said"),
    [
        (
            "simulator.depth_camera.period=0.033",
            r"simulator.depth_camera.period is 0.033 s; allowed: a multiple of simulator.inner_step",
        ),
        ("simulator.depth_camera.range_min=9", r"simulator.depth_camera.range_min is 9; allowed: below range_max, 6"),
        ("simulator.depth_camera.columns=5000", r"simulator.depth_camera.columns is 5000; allowed"),
        ("simulator.depth_camera.field_of_view=.nan", r"simulator.depth_camera.field_of_view"),
    ],
)
def test_camera_that_cannot_be_is_refused(simulate, override, said):
    with pytest.raises(ConfigurationError, match=said):
        simulate(robot(), *ON, override)


def test_planner_of_a_run_sees_images_and_one_without_a_camera_none(tmp_path):
    quick = [
        "planner=pure_pursuit",
        "robot=turtlebot3",
        "world=empty",
        "task.time_limit=1",
        "simulator=mujoco",
        "localizer=ground_truth",
    ]
    for enabled in (True, False):
        config = to_plain(compose([*quick, f"simulator.depth_camera.enabled={str(enabled).lower()}"]))
        run = build_benchmark({**config, "choices": {}}, load_registry())
        planner, seen = run.navigator.planner, []
        compute = planner.compute_velocity
        planner.compute_velocity = lambda observation, compute=compute, seen=seen: (
            seen.append(observation.depth),
            compute(observation),
        )[1]
        record = run.run(0, tmp_path)
        assert record.meta["outcome"] == "time_out", record.meta["error"]
        assert len(seen) >= 10
        assert [image is not None for image in seen] == [enabled] * len(seen)


def test_encoders_are_given_images_as_a_batch():
    image = DepthImage(0.0, np.ones((2, 3), np.float32), 1.0, Pose(0.0, 0.0), 0.2, 0.0, 0.1, 3.0)
    seen = observation()
    assert ObservationBatch.of(replace(seen, depth=image), Twist(0.0)).depths.shape == (1, 2, 3)
    assert ObservationBatch.of(seen, Twist(0.0)).depths is None
