import json
import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from arena_core import (
    ConfigurationError,
    Footprint,
    LaserScan,
    Lidar,
    OccupancyGrid,
    Odometry,
    OdometryModel,
    Pose,
    Robot,
    Sensors,
    Twist,
    VelocityLimits,
    random_generator,
)
from arena_core.config.configuration import compose, to_plain
from arena_core.config.registry import load_registry
from arena_kernels.grids import stack_grids
from arena_kernels.raycast import make_beams, scan_grids
from arena_navigation.amcl.localizer import AmclLocalizer

LIDAR = Lidar(180, -2.0, 0.022, 0.1, 8.0, 0.1, 0.01, Pose(0.1, 0.0, 0.05))
ROBOT = Robot(
    "cart",
    "differential",
    Footprint.circle(0.2),
    VelocityLimits(-0.5, 1.0, 0.0, 2.0, 1.0, 0.0, 2.0),
    LIDAR,
    OdometryModel(0.02, 0.1, 0.01, 0.01, 0.001),
    0.1,
)
EXACT = {"initial.cov_xx": 0.0, "initial.cov_yy": 0.0, "initial.cov_aa": 0.0}
ANYWHERE = Pose(-3.0, 5.0, 0.8)
LEFT, RIGHT = Pose(1.2, 1.7, -1.2), Pose(4.3, 2.9, -1.2)  # in the room


def room(origin=ANYWHERE):
    """Return a room of 6 x 4 m without any symmetry."""
    data = np.zeros((80, 120), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    data[1:30, 70:74] = data[60:72, 20:40] = data[35:42, 100:110] = 100
    return OccupancyGrid(data, 0.05, origin)


def corridor(origin):
    """Return a corridor of 20 x 2 m, closed far from the middle."""
    data = np.zeros((40, 400), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    return OccupancyGrid(data, 0.05, origin)


def localizer(preset="amcl", robot=ROBOT, changed=()):
    """Return a localiser with changed values, by their place in its YAML."""
    words = [f"localizer.{key}={json.dumps(value)}" for key, value in dict(changed).items()]
    node = to_plain(compose([f"localizer={preset}", *words], "component"))["localizer"]
    return load_registry().build("localizer", node, robot=robot)


def ranges(grid, pose, noise=None, lidar=LIDAR):
    stack, which = stack_grids([grid])
    found = np.empty((1, lidar.beams), np.float32)
    rays = make_beams(lidar.angle_min, lidar.angle_increment, lidar.beams, lidar.range_max)
    scan_grids(stack, which, pose.compose(lidar.mount).array()[None], rays, found)
    return found[0] if noise is None else found[0] + noise.normal(0.0, lidar.noise_std, lidar.beams).astype(np.float32)


def sensors(grid, stamp, pose, odometry, twist=None, noise=None, seen=None):
    """Return what is measured at ``stamp`` by a robot at ``pose``; ``seen`` (stamp, pose) is
    when and where its scan was taken.
    """
    taken, at = seen or (stamp, pose)
    scan = LaserScan(
        taken,
        LIDAR.angle_min,
        LIDAR.angle_increment,
        LIDAR.range_min,
        LIDAR.range_max,
        ranges(grid, at, noise),
        LIDAR.mount,
    )
    return Sensors(stamp, scan, Odometry(stamp, odometry, twist or Twist(0.0)))


def round_trip(grid, steps=120, drift=1.0, seed=0, start=LEFT, begin=0):
    """Return the true poses and the sensors of a drive on a circle of 0.67 m; odometry turns ``drift`` times as far."""
    noise, true, wheels = np.random.default_rng(seed), grid.origin.compose(start), Pose(40.0, -7.0, 2.0)
    poses, measured = [], []
    for k in range(begin, begin + steps):
        poses.append(true)
        measured.append(sensors(grid, 0.1 * k, true, wheels, Twist(0.4, 0.0, 0.6 * drift), noise))
        true, wheels = true.compose(Pose(0.04, 0.0, 0.06)), wheels.compose(Pose(0.04, 0.0, 0.06 * drift))
    return poses, measured


def run(chosen, grid, start, measured, seed=0):
    chosen.reset(grid, start, random_generator(seed, "room", "localizer"))
    return [chosen.update(each) for each in measured]


def errors(estimates, poses):
    return np.array([estimate.pose.distance(true) for estimate, true in zip(estimates, poses, strict=True)])


def assert_same_pose(found, expected, abs=1e-9):
    assert (found.x, found.y) == pytest.approx((expected.x, expected.y), abs=abs)
    assert math.remainder(found.theta - expected.theta, 2 * math.pi) == pytest.approx(0.0, abs=abs)


@pytest.mark.parametrize(("preset", "turn"), [("amcl", 0.05), ("amcl_as_ros", 0.3)])
def test_drifting_odometry_is_corrected(preset, turn):
    grid = room()
    poses, measured = round_trip(grid, drift=1.1)
    estimates = run(localizer(preset), grid, poses[0], measured)
    assert errors(estimates, poses)[20:].mean() < 0.1
    assert estimates[-1].pose.theta == pytest.approx(poses[-1].theta, abs=turn)
    wheels = poses[0].compose(measured[0].odometry.pose.relative(measured[-1].odometry.pose))
    assert wheels.distance(poses[-1]) > 0.3


MODELS = [
    {"laser.model_type": "beam"},
    {"laser.model_type": "likelihood_field"},
    {"laser.model_type": "likelihood_field_prob"},
    {"laser.model_type": "likelihood_field_prob", "beam_skip.enabled": True},
]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("preset", "drift"), [("amcl", 1.1), ("amcl_as_ros", 1.1), ("amcl_as_clearpath", 1.02)])
def test_every_sensor_model_corrects_odometry_and_does_so_again(preset, drift, model):
    grid = room()
    poses, measured = round_trip(grid, drift=drift)
    chosen = localizer(preset, changed=model)
    estimates = run(chosen, grid, poses[0], measured)
    assert errors(estimates, poses)[20:].mean() < 0.1
    again = run(chosen, grid, poses[0], measured)
    assert [estimate.pose for estimate in again] == [estimate.pose for estimate in estimates]


def test_beam_skipping_with_another_model_is_refused():
    with pytest.raises(
        ConfigurationError,
        match=r"beam_skip\.enabled is true with beam; allowed: laser\.model_type likelihood_field_prob",
    ):
        localizer(changed={"laser.model_type": "beam", "beam_skip.enabled": True})


def test_as_ros_corrects_the_pose_only_where_it_resamples():
    grid = room()
    poses, measured = round_trip(grid)
    estimates = run(localizer("amcl_as_ros"), grid, poses[0], measured)
    corrected = [not np.array_equal(a.covariance, b.covariance) for a, b in pairwise(estimates)]
    travelled = 0.04 * np.diff(np.flatnonzero(corrected))
    assert len(travelled) > 5
    assert travelled.min() >= 0.4 - 1e-9  # every second update, of which each takes 0.2 m


@pytest.mark.parametrize("wrong", [Pose(0.4, 0.3, 0.3), Pose(-0.3, -0.4, -0.3), Pose(0.0, 0.5, 0.3)])
def test_a_wrong_start_is_corrected(wrong):
    grid = room()
    poses, measured = round_trip(grid)
    estimates = run(localizer(), grid, poses[0].compose(wrong), measured)
    assert errors(estimates, poses)[-60:].max() < 0.1


def test_an_unknown_world_is_refused():
    with pytest.raises(ConfigurationError, match=r"localizer=ground_truth or world\.known=true"):
        localizer().reset(None, ANYWHERE, random_generator(0, "room", "localizer"))


def test_more_particles_at_least_than_at_most_are_refused():
    with pytest.raises(ConfigurationError, match=r"particles\.min is 600; allowed: at most max 500"):
        localizer(changed={"particles.min": 600, "particles.max": 500})


@pytest.mark.parametrize("key", ["particles.max", "particles.min", "laser.max_beams"])
def test_numbers_whose_arrays_take_a_machines_memory_are_refused(key):
    with pytest.raises(ConfigurationError, match=rf"localizer\.{key} is 2147483648; allowed: .*"):
        localizer(changed={key: 2**31})


def test_estimate_moves_with_odometry_between_filter_updates():
    grid = room()
    poses, measured = round_trip(grid, steps=40)
    estimates = run(localizer(changed={"update.min_d": 0.5, "update.min_a": 1.0}), grid, poses[0], measured)
    held = 0
    for (a, b), (first, second) in zip(pairwise(estimates), pairwise(measured), strict=True):
        if np.array_equal(a.covariance, b.covariance):  # no filter update in between
            held += 1
            assert_same_pose(b.pose, a.pose.compose(first.odometry.pose.relative(second.odometry.pose)))
    assert held > 30


def test_a_standing_robot_uses_one_scan():
    grid = room()
    true = grid.origin.compose(Pose(1.0, 1.0, 0.3))
    chosen = localizer()
    first, *others = run(chosen, grid, true, [sensors(grid, 0.1 * k, true, Pose(0.0, 0.0)) for k in range(10)])
    particles = chosen.particles
    assert all(other.pose == others[0].pose for other in others)
    assert_same_pose(others[-1].pose, first.pose)
    np.testing.assert_array_equal(chosen.particles, particles)


def spin(grid, stamps, lag, claimed_lag):
    """Return the sensors of a robot that spins at 1.5 rad/s, whose scans are ``lag`` s old and say that
    they are ``claimed_lag`` s old.
    """

    def at(stamp):
        return grid.origin.compose(Pose(1.6, 1.6, 1.5 * stamp))

    twist, wheels = Twist(0.0, 0.0, 1.5), Pose(0.0, 0.0)
    return [at(t) for t in stamps], [
        sensors(grid, t, at(t), wheels.compose(Pose(0.0, 0.0, 1.5 * t)), twist, seen=(t - claimed_lag, at(t - lag)))
        for t in stamps
    ]


def test_a_scan_is_matched_at_its_own_stamp():
    grid = room()
    stamps = (0.1 * np.arange(1, 60)).tolist()

    def mean_turn(claimed_lag):
        poses, measured = spin(grid, stamps, 0.08, claimed_lag)
        estimates = run(localizer(), grid, poses[0], measured)
        return np.mean(
            [
                math.remainder(e.pose.theta - p.theta, 2 * math.pi)
                for e, p in zip(estimates[10:], poses[10:], strict=True)
            ]
        )

    assert abs(mean_turn(0.08)) < 0.02
    assert mean_turn(0.0) == pytest.approx(-0.08 * 1.5, abs=0.03)


def test_odometry_older_than_the_step_is_carried_on_by_its_twist():
    grid = room()
    true = grid.origin.compose(Pose(1.0, 1.0, 0.3))
    chosen = localizer(changed={"update.min_d": 9.0, "update.min_a": 9.0})
    first = sensors(grid, 0.0, true, Pose(0.0, 0.0))
    late = sensors(grid, 0.0, true, Pose(0.0, 0.0), Twist(1.0, 0.0, 0.0))
    later = replace(late, stamp=0.12, odometry=replace(late.odometry, stamp=0.1, pose=Pose(0.1, 0.0)))
    before, after = run(chosen, grid, true, [first, later])
    assert_same_pose(after.pose, before.pose.compose(Pose(0.12, 0.0)))


def test_an_episode_depends_on_its_own_stream_alone():
    grid = room()
    poses, measured = round_trip(grid, steps=30)
    fresh, used = localizer(), localizer()
    run(used, room(Pose(0.0, 0.0)), Pose(1.0, 1.0), round_trip(room(Pose(0.0, 0.0)), 25)[1], seed=8)
    first, again, other = (
        run(chosen, grid, poses[0], measured, seed) for chosen, seed in ((fresh, 1), (used, 1), (used, 2))
    )
    assert [e.pose for e in first] == [e.pose for e in again]
    np.testing.assert_array_equal([e.covariance for e in first], [e.covariance for e in again])
    assert first[-1].pose != other[-1].pose


@pytest.mark.parametrize("origin", [Pose(0.0, 0.0, 0.0), Pose(120.0, -40.0, 2.5), Pose(0.0, 1.0, -1.6)])
def test_nothing_depends_on_where_the_map_frame_lies(origin):
    here, there = room(), room(origin)
    poses, measured = round_trip(here, steps=40)
    moved = [origin.compose(here.origin.relative(pose)) for pose in poses]
    chosen = localizer(changed=EXACT)
    estimates, others = run(chosen, here, poses[0], measured), run(chosen, there, moved[0], measured)
    for a, b in zip(estimates, others, strict=True):
        assert_same_pose(here.origin.relative(a.pose), origin.relative(b.pose), abs=0.005)


def test_the_start_is_as_uncertain_as_configured_along_the_map_axes():
    chosen = localizer(changed={"initial.cov_xx": 0.09, "initial.cov_yy": 0.01, "initial.cov_aa": 0.04})
    chosen.reset(room(), Pose(1.0, 6.0, 0.4), random_generator(0, "room", "localizer"))
    particles = chosen.particles
    assert particles.shape == (5000, 3)
    np.testing.assert_allclose(particles.mean(axis=0), (1.0, 6.0, 0.4), atol=0.02)
    np.testing.assert_allclose(np.cov(particles.T), np.diag((0.09, 0.01, 0.04)), atol=0.004)


def test_in_a_corridor_the_estimate_is_unsure_along_it_and_sure_across():
    grid = corridor(Pose(2.0, -1.0, math.pi / 2))  # the corridor runs along the y axis of the map
    true = grid.origin.compose(Pose(10.0, 1.0, 0.0))
    measured = [sensors(grid, 0.1 * k, true.compose(Pose(0.05 * k, 0.0)), Pose(0.05 * k, 0.0)) for k in range(30)]
    covariance = run(localizer(), grid, true, measured)[-1].covariance
    assert covariance[0, 0] < 0.05**2
    assert covariance[1, 1] > 0.15**2
    np.testing.assert_allclose(covariance, covariance.T)


def test_an_unsure_pose_keeps_more_particles():
    def kept(grid, poses, measured):
        chosen = localizer(changed={"particles.min": 50, "initial.cov_xx": 1.0, "initial.cov_yy": 1.0})
        run(chosen, grid, poses[0], measured)
        return len(chosen.particles)

    long = corridor(ANYWHERE)
    true = [long.origin.compose(Pose(9.0 + 0.05 * k, 1.0)) for k in range(20)]
    unsure = kept(long, true, [sensors(long, 0.1 * k, pose, Pose(0.05 * k, 0.0)) for k, pose in enumerate(true)])
    assert unsure > 2 * kept(room(), *round_trip(room(), steps=20))


@pytest.mark.slow
def test_a_kidnapped_robot_finds_itself_again_with_recovery_alone():
    grid = room()
    _, before = round_trip(grid, steps=60)
    poses, after = round_trip(grid, steps=300, start=RIGHT, begin=60)
    given = {"laser.short_beam_distance": None, "particles.min": 2000}
    start, recovery = grid.origin.compose(LEFT), {"recovery.alpha_slow": 0.001, "recovery.alpha_fast": 0.2}
    lost = run(localizer(changed=given), grid, start, before + after)[60:]
    found = run(localizer(changed={**given, **recovery}), grid, start, before + after)[60:]
    assert errors(lost, poses)[-50:].min() > 1.0
    assert errors(found, poses)[-50:].max() < 0.2


def test_people_in_front_of_the_map_do_not_mislead():
    grid = room()
    poses, measured = round_trip(grid)
    for k, each in enumerate(measured):
        shift = int(40 * math.sin(0.05 * k))
        each.scan.ranges[30 + shift + 40 : 90 + shift + 40] = np.minimum(
            each.scan.ranges[70 + shift : 130 + shift], 0.6
        )
    estimates = run(localizer(), grid, poses[0], measured)
    assert errors(estimates, poses).mean() < 0.06


def test_a_scan_without_hits_changes_nothing_but_what_odometry_says():
    grid = room()
    true = grid.origin.compose(Pose(1.0, 1.0, 0.0))
    measured = [sensors(grid, 0.1 * k, true, Pose(0.1 * k, 0.0)) for k in range(10)]
    for each in measured:
        each.scan.ranges[:] = np.inf
    last = run(localizer(changed=EXACT), grid, true, measured)[-1]
    assert_same_pose(last.pose, true.compose(Pose(0.9, 0.0)), abs=0.05)
    assert np.isfinite(last.covariance).all()


def test_an_omnidirectional_robot_may_drive_sideways():
    grid = room()
    robot = replace(ROBOT, kinematics="omnidirectional", limits=replace(ROBOT.limits, vy_max=1.0, ay_max=1.0))
    start = grid.origin.compose(Pose(1.0, 0.8, 0.0))
    poses = [start.compose(Pose(0.0, 0.02 * k)) for k in range(60)]
    measured = [sensors(grid, 0.1 * k, pose, Pose(0.0, 0.022 * k)) for k, pose in enumerate(poses)]
    assert errors(run(localizer(robot=robot), grid, start, measured), poses).mean() < 0.05


def test_every_parameter_has_a_home_in_each_preset():
    for preset in ("amcl", "amcl_as_ros", "amcl_as_clearpath"):
        assert isinstance(localizer(preset), AmclLocalizer)
