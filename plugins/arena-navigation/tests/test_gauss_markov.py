import math

import numpy as np
import pytest

from arena_core import Odometry, Pose, Sensors, Twist, random_generator
from arena_core.testing import robot, scan
from arena_navigation.gauss_markov import GaussMarkovLocalizer

STD, LENGTH, TURN = (0.01, 0.005, 0.008), (0.45, 1.1, 0.1), 0.2
ALL = np.arange(20000)


def begun(robots=20000):
    localizer = GaussMarkovLocalizer(STD, LENGTH, TURN)
    localizer.begin(np.arange(robots, dtype=np.uint64) + 7, np.arange(robots), robots)
    return localizer


def errors(estimates, poses):
    """Return what estimates miss along, across, m, and in heading, rad, of poses (N, 3)."""
    dx, dy = (estimates - poses)[:, :2].T
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    return np.stack((c * dx + s * dy, c * dy - s * dx, estimates[:, 2] - poses[:, 2]), axis=1)


def poses_at(x, heading=0.7):
    return np.tile((x * math.cos(heading), x * math.sin(heading), heading), (len(ALL), 1))


@pytest.mark.parametrize("driven", [0.0, 0.2, 30.0])
def test_errors_have_the_same_spread_wherever_the_robot_has_driven(driven):
    localizer = begun()
    localizer.estimates(poses_at(0.0), ALL)
    found = errors(localizer.estimates(poses_at(driven), ALL), poses_at(driven))
    assert found.std(axis=0) == pytest.approx(STD, rel=0.03)
    assert np.abs(found.mean(axis=0) / STD).max() < 0.03
    assert np.abs(np.corrcoef(found.T) - np.eye(3)).max() < 0.03


@pytest.mark.parametrize("way", [0.1, 0.45, 1.1])
def test_errors_are_forgotten_over_the_way_driven(way):
    localizer = begun()
    before = errors(localizer.estimates(poses_at(0.0), ALL), poses_at(0.0))
    after = errors(localizer.estimates(poses_at(way), ALL), poses_at(way))
    kept = [np.corrcoef(before[:, axis], after[:, axis])[0, 1] for axis in range(3)]
    assert kept == pytest.approx(np.exp(-way / np.array(LENGTH)), abs=0.03)


def test_who_stands_learns_nothing_new():
    localizer = begun()
    first = localizer.estimates(poses_at(1.0), ALL)
    assert (localizer.estimates(poses_at(1.0), ALL) == first).all()


def test_turning_on_the_spot_is_way_too():
    localizer = begun()
    before = errors(localizer.estimates(poses_at(0.0, 0.0), ALL), poses_at(0.0, 0.0))
    turned = poses_at(0.0, 0.0) + np.array((0.0, 0.0, math.pi / 2.0))
    after = errors(localizer.estimates(turned, ALL), turned)
    assert np.corrcoef(before[:, 2], after[:, 2])[0, 1] == pytest.approx(
        math.exp(-TURN * math.pi / 2.0 / LENGTH[2]), abs=0.03
    )


def test_robot_among_many_is_where_it_would_be_alone():
    many, alone = begun(5), GaussMarkovLocalizer(STD, LENGTH, TURN)
    alone.begin(np.array((10,), np.uint64), np.zeros(1, np.int64), 1)
    random = np.random.default_rng(0)
    for _ in range(20):
        poses = random.uniform(-1.0, 1.0, (5, 3))
        assert (many.estimates(poses, np.arange(5))[3] == alone.estimates(poses[3:4], np.zeros(1, np.int64))[0]).all()


def test_episode_depends_on_its_stream_alone():
    def drive(localizer, name):
        localizer.reset(None, Pose(0.0, 0.0), random_generator(0, name, "localizer"))
        poses = [Pose(0.1 * k, 0.0, 0.02 * k) for k in range(10)]
        seen = scan(Pose(0.0, 0.0), robot())
        return [
            localizer.update(Sensors(0.1 * k, seen, Odometry(0.1 * k, Pose(0, 0), Twist(0.0)), pose))
            for k, pose in enumerate(poses)
        ]

    localizer = GaussMarkovLocalizer(STD, LENGTH, TURN)
    first, other, again = (drive(localizer, name) for name in ("a", "b", "a"))
    assert [e.pose for e in first] == [e.pose for e in again] != [e.pose for e in other]
    assert all((a.covariance == b.covariance).all() for a, b in zip(first, again, strict=True))


def test_covariance_lies_along_the_heading():
    covariance = begun(1).covariance(np.array((0.0, 0.0, math.pi / 2.0)))
    assert np.sqrt(np.diag(covariance)) == pytest.approx((STD[1], STD[0], STD[2]))
