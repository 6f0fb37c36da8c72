import numpy as np
import pytest

from arena_core.testing import robot

FIELDS = (
    *("stamps", "poses", "twists", "clearances", "clearances_people", "in_contact", "contact_times", "ranges"),
    *("scan_stamps", "odometry_stamps", "odometry_poses", "odometry_twists"),
)


def assert_same(one, j, other, k):
    for name in FIELDS:
        assert getattr(one, name)[j].tobytes() == getattr(other, name)[k].tobytes(), name
    assert one.crowd.world(j).positions.tobytes() == other.crowd.world(k).positions.tobytes()
    assert one.contacts[j] == other.contacts[k]


def commands(seed, steps):
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (steps, 3)) * (1.2, 0.0, 2.0)


@pytest.mark.parametrize("options", [[], ["simulator.lidar=rays", "pedestrians.body=legs"], ["simulator.drive=wheels"]])
def test_slot_of_many_equals_a_batch_of_one_bit_for_bit(simulate, crowded, options):
    worlds = [crowded(seed, people=seed % 7, obstacles=seed % 2 == 0) for seed in range(8)]
    drives = np.stack([commands(seed, 20) for seed in range(8)], axis=1)
    many, few = simulate(robot(), *options), {k: simulate(robot(), *options) for k in (0, 5)}
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


@pytest.mark.parametrize("drive", ["planar", "wheels"])
def test_world_that_begins_anew_equals_a_batch_of_one_and_disturbs_no_other(simulate, crowded, drive):
    many, first, second = (simulate(robot(), f"simulator.drive={drive}") for _ in range(3))
    many.reset([crowded(0), crowded(1)])
    first.reset([crowded(0)])
    drive = commands(3, 20)
    for step in drive[:10]:
        together = many.advance(np.tile(step, (2, 1)), 10)
        assert_same(first.advance(step[None], 10), 0, together, 0)
    newcomer = crowded(9, people=9, obstacles=False)
    begun = many.reset([newcomer], np.array([1]))
    assert_same(second.reset([newcomer]), 0, begun, 1)
    for step in drive[10:]:
        together = many.advance(np.tile(step, (2, 1)), 10)
        assert_same(first.advance(step[None], 10), 0, together, 0)
        assert_same(second.advance(step[None], 10), 0, together, 1)


def test_the_same_world_begins_the_same_however_often_it_was_driven(simulate, crowded):
    simulator = simulate(robot(), "simulator.drive=wheels")
    drives = []
    for _ in range(2):
        simulator.reset([crowded(2)])
        drives.append([simulator.advance(step[None], 10).poses.tobytes() for step in commands(4, 15)])
    assert drives[0] == drives[1]
