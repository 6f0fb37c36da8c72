"""Furniture in three dimensions: both lidars see its legs, tops stop what is as high as they are."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import Pose
from arena_core.testing import component, furniture, robot, scenario
from arena_sim2d.simulator import Sim2d

AGREE = 0.002  # m
PIECES = (
    furniture("table", 1.8, 1.2, 0.4),
    furniture("chair", -1.6, 0.3, 1.1),
    furniture("shelf", 0.3, -2.2),
    furniture("chair", 1.2, -0.9),
)


def among(*pieces, start=None):
    drive = scenario(start=start or Pose(0.0, 0.0, 0.0))
    return replace(drive, world=replace(drive.world, furniture=pieces))


def fine(body):
    return replace(body, lidar=replace(body.lidar, beams=720, angle_increment=2.0 * np.pi / 720))


def apart(one, other):
    """Return how far two scans are from each other, away from edges, which a beam may pass or not."""
    one, other = (np.where(np.isinf(ranges), 8.0, ranges) for ranges in (one, other))
    edges = np.abs(np.diff(one, append=one[:1])) > 0.02
    edges |= np.roll(edges, 1)
    found = np.abs(one - other)
    return found[~edges].max(), (found > AGREE).mean()


def test_slice_and_rays_and_the_planar_simulator_see_the_same_legs(simulate):
    body = fine(robot())
    crowd = component("pedestrians", "social_force")
    plane: Sim2d = component("simulator", "sim2d", robot=body, pedestrians=crowd)
    sliced, by_rays = (simulate(body, f"simulator.lidar={lidar}") for lidar in ("slice", "rays"))
    places = [Pose(0.0, 0.0, 0.0), Pose(1.0, 2.4, 1.0), Pose(-2.5, 0.3, 2.0), Pose(0.2, 0.9, -1.0)]
    scans = [
        [one.reset([among(*PIECES, start=start)]).ranges[0] for start in places] for one in (sliced, by_rays, plane)
    ]
    for exact, cast, flat in zip(*scans, strict=True):
        assert flat.tobytes() == exact.tobytes()
        worst, share = apart(exact, cast)
        assert worst < AGREE
        assert share < 0.02
        assert (exact < 4.0).sum() > 10  # legs are seen


@pytest.mark.parametrize("drive", ["planar", "wheels"])
@pytest.mark.parametrize(("height", "stops"), [(0.25, False), (0.9, True)])
def test_table_stops_only_a_robot_that_is_higher_than_the_gap(simulate, drive, height, stops):
    simulator = simulate(
        robot(),
        f"simulator.drive={drive}",
        f"simulator.body.height={height}",
        "simulator.body.lidar_height=0.2",
        "simulator.body.centre_height=0.05",
    )
    simulator.reset([among(furniture("table", 2.0, 0.0))])
    snapshots = [simulator.advance(np.array([[0.8, 0.0, 0.0]]), 10) for _ in range(45)]
    found = [contact for snapshot in snapshots for contact in snapshot.contacts[0]]
    assert not any(snapshot.failures for snapshot in snapshots)
    if stops:
        assert {contact.kind for contact in found} == {"obstacle"}
        assert snapshots[-1].poses[0, 0] == pytest.approx(2.0 - 0.8 - 0.2, abs=0.02)
    else:
        assert not found
        assert snapshots[-1].poses[0, 0] > 3.0


def test_robot_touches_a_leg_no_deeper_than_5_mm(simulate):
    simulator = simulate(robot())
    simulator.reset([among(furniture("table", 2.0, 0.33))])  # a leg straight ahead
    snapshots = [simulator.advance(np.array([[0.8, 0.0, 0.0]]), 2) for _ in range(150)]
    assert next(contact.kind for snapshot in snapshots for contact in snapshot.contacts[0]) == "obstacle"
    gaps = [np.hypot(snapshot.poses[0, 0] - 1.27, snapshot.poses[0, 1]) - 0.2 - 0.025 for snapshot in snapshots]
    assert min(gaps) > -0.005


def test_episode_with_furniture_is_the_same_in_a_batch_and_alone(simulate):
    worlds = [among(*PIECES, start=Pose(0.0, 0.0, turn)) for turn in (0.0, 1.0, 2.0)]
    batch, alone = simulate(robot()), simulate(robot())
    batch.reset(worlds)
    alone.reset(worlds[1:2])
    for _ in range(30):
        many, one = batch.advance(np.tile((0.8, 0.0, 0.2), (3, 1)), 10), alone.advance(np.array([(0.8, 0.0, 0.2)]), 10)
    assert many.poses[1].tobytes() == one.poses[0].tobytes()
    assert many.ranges[1].tobytes() == one.ranges[0].tobytes()
