from dataclasses import replace

import numpy as np
import pytest

from arena_core import ConfigurationError, Footprint
from arena_core.testing import robot

FIELDS = (
    *("stamps", "poses", "twists", "clearances", "clearances_people", "in_contact", "contact_times", "ranges"),
    *("scan_stamps", "odometry_stamps", "odometry_poses", "odometry_twists"),
)


def assert_same(one, j, other, k):
    for name in FIELDS:
        assert getattr(one, name)[j].tobytes() == getattr(other, name)[k].tobytes(), name
    a, b = one.crowd.world(j), other.crowd.world(k)
    for name in ("ids", "positions", "velocities", "radii", "states"):
        assert getattr(a, name).tobytes() == getattr(b, name).tobytes(), name
    assert one.contacts[j] == other.contacts[k]


def noisy(alter):
    body = alter(robot(), "lidar", noise_std=0.02)
    return alter(body, "odometry", period=0.02, alpha1=0.1, alpha2=0.1, alpha3=0.1, alpha4=0.1)


def commands(seed, steps):
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (steps, 3)) * (1.2, 0.0, 2.0)


def test_slot_of_64_equals_a_batch_of_one_bit_for_bit(simulate, crowded, alter):
    body = noisy(alter)
    worlds = [crowded(seed, people=seed % 9, obstacles=seed % 2 == 0) for seed in range(64)]
    drives = np.stack([commands(seed, 30) for seed in range(64)], axis=1)
    many, few = simulate(body), {k: simulate(body) for k in (0, 17, 63)}
    many.reset(worlds)
    for k, alone in few.items():
        alone.reset([worlds[k]])
    touched = 0
    for step in drives:
        together = many.advance(step, 10)
        touched += sum(map(len, together.contacts))
        for k, alone in few.items():
            assert_same(alone.advance(step[k : k + 1], 10), 0, together, k)
    assert touched > 0


def test_world_that_begins_anew_equals_a_batch_of_one_and_disturbs_no_other(simulate, crowded, alter):
    body = noisy(alter)
    many, first, second = (simulate(body) for _ in range(3))
    many.reset([crowded(0), crowded(1), crowded(2)])
    first.reset([crowded(0)])
    drive = commands(3, 40)
    for step in drive[:20]:
        together = many.advance(np.tile(step, (3, 1)), 10)
        assert_same(first.advance(step[None], 10), 0, together, 0)
    newcomer = crowded(9, people=12, obstacles=False)
    begun = many.reset([newcomer], np.array([1]))
    assert_same(second.reset([newcomer]), 0, begun, 1)
    assert_same(together, 0, begun, 0)
    for step in drive[20:]:
        together = many.advance(np.tile(step, (3, 1)), 10)
        assert_same(first.advance(step[None], 10), 0, together, 0)
        assert_same(second.advance(step[None], 10), 0, together, 1)


def test_people_who_ignore_the_robot_walk_alike_until_they_touch_it(simulate, crowded):
    body, parked = simulate(robot()), simulate(robot())
    problem = crowded(4)
    body.reset([problem])
    parked.reset([problem])
    for step in commands(1, 100):
        one, other = body.advance(step[None], 10), parked.advance(np.zeros((1, 3)), 10)
        if one.contacts[0] or other.contacts[0]:
            break
        assert one.crowd.positions.tobytes() == other.crowd.positions.tobytes()
    assert one.stamps[0] > 0.5


def test_snapshots_are_not_changed_by_what_follows(simulate, crowded):
    simulator = simulate(robot())
    first = simulator.reset([crowded(1)])
    kept = [getattr(first, name).copy() for name in FIELDS] + [
        first.crowd.positions.copy(),
        first.crowd.velocities.copy(),
    ]
    simulator.advance(np.array([[1.0, 0.0, 0.5]]), 25)
    for before, now in zip(
        kept, [getattr(first, name) for name in FIELDS] + [first.crowd.positions, first.crowd.velocities], strict=True
    ):
        np.testing.assert_array_equal(before, now)


def test_single_world_cannot_begin_between_two_crowd_steps(simulate, crowded):
    simulator = simulate(robot())
    simulator.reset([crowded(0), crowded(1)])
    simulator.advance(np.zeros((2, 3)), 3)
    with pytest.raises(ConfigurationError, match="crowd_period"):
        simulator.reset([crowded(2)], np.array([0]))


def test_circle_and_polygon_robots_share_the_kernels(simulate, crowded):
    body = replace(robot(), footprint=Footprint.polygon([[0.2, -0.1], [0.2, 0.1], [-0.2, 0.1], [-0.2, -0.1]]))
    simulator = simulate(body)
    simulator.reset([crowded(0)])
    assert simulator.advance(np.array([[0.5, 0.0, 0.0]]), 20).poses[0].any()
