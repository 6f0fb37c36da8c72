from dataclasses import replace

import numpy as np
import pytest

from arena_core.testing import robot

AGREE = 0.002  # m


@pytest.mark.parametrize("people", ["pedestrians.body=discs", "pedestrians.body=legs"])
def test_both_lidars_agree_within_2_mm(simulate, crowded, people):
    body = replace(robot(), lidar=replace(robot().lidar, beams=360, angle_increment=2.0 * np.pi / 360))
    one, other = simulate(body, people), simulate(body, people, "simulator.lidar=rays")
    worlds = [crowded(seed) for seed in range(4)]
    pairs = [(one.reset(worlds), other.reset(worlds))]
    for step in np.random.default_rng(1).uniform(-1.0, 1.0, (30, 3)) * (1.0, 0.0, 2.0):
        commands = np.tile(step, (4, 1))
        pairs.append((one.advance(commands, 10), other.advance(commands, 10)))
    for sliced, by_rays in pairs:
        assert by_rays.poses.tobytes() == sliced.poses.tobytes()
        # a beam along an edge may pass it or not
        edges = np.abs(np.diff(sliced.ranges, axis=1, append=sliced.ranges[:, :1])) > 0.1
        edges |= np.roll(edges, 1, axis=1)
        with np.errstate(invalid="ignore"):
            apart = np.abs(sliced.ranges - by_rays.ranges)
        apart[np.isinf(sliced.ranges) & np.isinf(by_rays.ranges)] = 0.0
        assert apart[~edges].max() < AGREE
        assert (apart > AGREE).mean() < 0.005


def test_lidar_does_not_see_the_robot_itself(simulate, crowded):
    simulator = simulate(robot(), "simulator.drive=wheels", "simulator.lidar=rays")
    empty = replace(crowded(0, people=0, obstacles=False))
    assert simulator.reset([empty]).ranges.min() > 4.0
