import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import OccupancyGrid, Pose
from arena_navigation.local_map.marks import PlacedScan
from arena_navigation.tracking.clusters import Cut
from arena_navigation.tracking.discs import BodyRules, PoseNoise, Scratch, Shape, find_discs
from arena_navigation.tracking.legs import Legs
from arena_navigation.tracking.returns import KnownPlane, PastScans, ReturnTolerance, place_returns

SHAPE = Shape(0.3, 0.1, 0.1, 0.6, 0.01, 0.05)
RULES = BodyRules(
    8.0,
    0.2,
    ReturnTolerance(0.1, 0.1, 0.02, 0.05, 0.6),
    Cut(0.15, 2.0, 0.08, 3),
    SHAPE,
    PoseNoise(0.0, 0.0),
    Legs(0.35, 0.0),
)
NO_TRACKS = np.empty((0, 3))
PLANE = OccupancyGrid(np.zeros((200, 200), np.int8), 0.1, Pose(-10.0, -10.0))


def found(scan, pose=None, grid=PLANE, past=None, tracks=NO_TRACKS):
    beams = PlacedScan.of(scan, pose or Pose(0.0, 0.0))
    count = len(scan.ranges)
    scratch = Scratch.room(count)
    place_returns(beams, KnownPlane.of(grid), RULES.farthest, 1, scratch.returns)
    n = find_discs(beams, past or PastScans.none(2, count), tracks, RULES, scratch)
    return scratch.discs.first(n)


def in_order(discs):
    return discs.positions[np.lexsort(discs.positions.T)]


@settings(derandomize=True, deadline=None, max_examples=60)
@given(
    st.floats(0.7, 5.0),
    st.floats(-math.pi, math.pi),
    st.floats(0.15, 0.5),
    st.floats(-math.pi, math.pi),
    st.sampled_from((360, 720)),
)
def test_centre_and_radius_of_a_disc_are_found_from_its_arc(scan_of_discs, gap, bearing, radius, heading, beams):
    away = gap + radius
    centre = np.array((away * math.cos(bearing), away * math.sin(bearing)))
    discs = found(scan_of_discs(Pose(0.0, 0.0, heading), [(*centre, radius)], beams=beams), Pose(0.0, 0.0, heading))
    spacing = away * 2.0 * math.pi / beams
    assert discs.round.tolist() == [1]
    np.testing.assert_allclose(discs.positions[0], centre, atol=0.01 + spacing)
    assert discs.radii[0] == pytest.approx(radius, abs=0.01 + spacing)


def test_the_covariance_is_that_of_the_errors(scan_of_discs):
    errors, said = [], []
    for seed in range(300):
        turn = seed * 0.7
        discs = found(
            scan_of_discs(Pose(0.0, 0.0, turn), [(2.5, 0.0, 0.3)], noise=0.01, seed=seed), Pose(0.0, 0.0, turn)
        )
        errors.append(np.array((*(discs.positions[0] - (2.5, 0.0)), discs.radii[0] - 0.3)))
        said.append(np.diag(discs.covariances[0]))
    measured = np.square(errors)[:, :2].mean(axis=0)
    assert (measured < 2.0 * np.mean(said, axis=0)).all()
    assert (measured > 0.1 * np.mean(said, axis=0)).all()


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_discs_apart_are_found_one_by_one(scan_of_discs, seed):
    random = np.random.default_rng(seed)
    bearings = np.arange(6) * math.pi / 3.0 + random.uniform(-0.2, 0.2, 6)
    bodies = [
        (r * math.cos(a), r * math.sin(a), 0.3) for a, r in zip(bearings, random.uniform(1.5, 5.0, 6), strict=True)
    ]
    scan = scan_of_discs(Pose(0.0, 0.0), bodies, beams=720, noise=0.005, seed=seed)
    np.testing.assert_allclose(
        in_order(found(scan)), np.array(sorted(bodies, key=lambda b: (b[1], b[0])))[:, :2], atol=0.06
    )


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.floats(1.2, 3.5), st.floats(-math.pi, math.pi), st.floats(0.0, 0.4))
def test_touching_discs_are_two(scan_of_discs, away, bearing, deeper):
    aside = np.array((-math.sin(bearing), math.cos(bearing)))
    ahead = np.array((math.cos(bearing), math.sin(bearing)))
    bodies = [
        (*(away * ahead + 0.3 * aside), 0.3),
        (*((away + deeper) * ahead - math.sqrt(0.36 - deeper**2) * aside + 0.3 * aside), 0.3),
    ]
    discs = found(scan_of_discs(Pose(0.0, 0.0), bodies, beams=720, noise=0.005))
    assert len(discs.radii) == 2
    expected = np.array(sorted(bodies, key=lambda b: (b[1], b[0])))[:, :2]
    np.testing.assert_allclose(in_order(discs), expected, atol=0.15)


def test_a_half_hidden_disc_lies_where_it_is(scan_of_discs):
    bodies = [(1.5, 0.1, 0.1), (3.0, 0.0, 0.3)]
    discs = found(scan_of_discs(Pose(0.0, 0.0), bodies, beams=1440))
    off = np.hypot(*(discs.positions - (3.0, 0.0)).T).min()
    assert off < 0.1


def test_returns_beside_a_wall_of_the_map_do_not_count(scan_of_discs):
    data = np.zeros((200, 200), np.int8)
    data[:, 125:] = 100  # from x = 2.5 on
    scan = scan_of_discs(Pose(0.0, 0.0), [(2.7, 0.0, 0.3)])
    assert len(found(scan, grid=OccupancyGrid(data, 0.1, Pose(-10.0, -10.0))).radii) == 0


@pytest.mark.parametrize("grid", [None, OccupancyGrid(np.full((200, 200), -1, np.int8), 0.1, Pose(-10.0, -10.0))])
def test_where_nothing_is_known_only_what_was_seen_through_or_is_followed_counts(scan_of_discs, grid):
    scan = scan_of_discs(Pose(0.0, 0.0), [(2.0, 0.0, 0.3)], 1.0)
    past = PastScans.none(2, 360)
    assert len(found(scan, grid=grid, past=past).radii) == 0
    assert len(found(scan, grid=grid, past=past, tracks=np.array(((2.0, 0.0, 0.4),))).radii) == 1
    past.ranges[0] = 5.0
    assert len(found(scan, grid=grid, past=past).radii) == 1


def test_what_stood_there_before_stands(scan_of_discs):
    past = PastScans.none(2, 360)
    past.ranges[0] = scan_of_discs(Pose(0.0, 0.0), [(2.0, 0.0, 0.3)]).ranges
    assert found(scan_of_discs(Pose(0.0, 0.0), [(2.0, 0.0, 0.3)], 1.0), past=past).standing.tolist() == [1]
    assert found(scan_of_discs(Pose(0.0, 0.0), [(2.0, 0.0, 0.3)], 0.5), past=past).standing.tolist() == [0]
    for x, y in ((1.8, 0.0), (2.2, 0.0), (2.0, 0.25)):
        assert found(scan_of_discs(Pose(0.0, 0.0), [(x, y, 0.3)], 1.0), past=past).standing.tolist() == [0]


def test_a_long_thing_is_no_disc(scan_of_discs):
    scan = scan_of_discs(Pose(0.0, 0.0), [(2.0 + 3.0, 0.0, 3.0)])
    discs = found(scan)
    assert discs.round.tolist() == [0]
    assert discs.radii.tolist() == [SHAPE.radius_max]
