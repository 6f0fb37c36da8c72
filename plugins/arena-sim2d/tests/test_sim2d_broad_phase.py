"""Bodies that surely meet nothing are moved without looking: to the last bit where they are moved with it."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import Pose
from arena_core.testing import robot, scenario

BOUNDLESS = 1e9  # m/s: a robot that may be so fast is never sure to meet nothing, nor are people


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional"])
def test_what_is_foreseen_changes_nothing(simulate, crowded, kinematics):
    body = robot(kinematics)
    boundless = replace(body, limits=replace(body.limits, vx_max=BOUNDLESS))
    foreseeing, looking = simulate(body), simulate(boundless)
    scenarios = [crowded(seed, people=3 + seed, obstacles=seed % 2 == 0) for seed in range(6)]
    foreseeing.reset(scenarios)
    looking.reset(scenarios)
    random, met = np.random.default_rng(1), 0
    for _ in range(80):
        commands = random.uniform(-1.0, 1.0, (6, 3)) * (0.5 * body.limits.vx_max, 0.0, body.limits.wz_max)
        seen, foreseen = (simulator.advance(commands, 10) for simulator in (looking, foreseeing))
        met += sum(map(len, seen.contacts))
        assert foreseen.contacts == seen.contacts
        for name in ("poses", "twists", "ranges", "clearances", "odometry_poses", "in_contact"):
            np.testing.assert_array_equal(getattr(foreseen, name), getattr(seen, name), name)
        np.testing.assert_array_equal(foreseen.crowd.positions, seen.crowd.positions)
        np.testing.assert_array_equal(foreseen.crowd.velocities, seen.crowd.velocities)
    assert met > 0


def test_robot_that_is_faster_sideways_than_forwards_meets_the_wall(simulate):
    body = robot("omnidirectional")
    body = replace(body, limits=replace(body.limits, vx_max=0.5, vy_max=6.0, ay_max=1000.0))
    simulator = simulate(body)
    simulator.reset([replace(scenario(start=Pose(0.0, 4.5)), obstacles=())])  # the wall is 0.25 m from its side
    snapshot = simulator.advance(np.array([[0.0, 6.0, 0.0]]), 10)
    assert [contact.kind for contact in snapshot.contacts[0]] == ["wall"]
    assert snapshot.clearances[0] == pytest.approx(0.0, abs=1e-3)
