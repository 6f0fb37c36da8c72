from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from arena_kernels.distance import distance_field
from arena_ompl.curves import DUBINS, REEDS_SHEPP, STRAIGHT
from arena_ompl.ground import body_clearance, reachable_cells
from arena_ompl.motions import Motions, Rules
from arena_ompl.smoothing import smooth_path

SIDE = 0.05
DISC = np.array(((0.0, 0.0, 0.2),))
BODY = np.array(((-0.1, 0.0, 0.18), (0.1, 0.0, 0.18), (0.3, 0.0, 0.18)))
POINT = st.tuples(st.floats(0.4, 4.6), st.floats(0.4, 4.6), st.floats(-3.0, 3.0))


def boxes(seed: int, number: int = 8) -> np.ndarray:
    occupied = np.zeros((100, 100), np.bool_)
    for row, column in np.random.default_rng(seed).integers(0, 90, (number, 2)):
        occupied[row : row + 8, column : column + 8] = True
    return distance_field(occupied, SIDE)


def motions(field: np.ndarray, kind: int = STRAIGHT, discs: np.ndarray = DISC, weight: float = 4.0) -> Motions:
    prices = (1.0 + weight * np.exp(-3.0 * np.maximum(field - 0.2, 0.0))).astype(np.float32)
    return Motions(Rules(field, prices, discs, SIDE, 0.0, 0.0, 0.0, 0.0, kind, 0.5))


@settings(derandomize=True, deadline=None, max_examples=150)
@given(st.integers(0, 10**6), st.sampled_from(((STRAIGHT, DISC), (DUBINS, BODY), (REEDS_SHEPP, BODY))), POINT, POINT)
def test_leaps_along_a_motion_miss_nothing(seed, robot, start, end) -> None:
    kind, discs = robot
    field = boxes(seed)
    asked = motions(field, kind, discs)
    poses = asked.poses(np.array((start, end)), 0.002)
    least = min(body_clearance(field, discs, SIDE, pose) for pose in poses)
    if asked.can_move(start, end):
        assert least > -0.5 * SIDE  # a corner of a cell at most
        assert np.mean([body_clearance(field, discs, SIDE, pose) > 0.0 for pose in poses]) > 0.99
    else:
        assert least < 0.002


@settings(derandomize=True, deadline=None, max_examples=50)
@given(st.integers(0, 10**6), POINT, POINT)
@example(1, (1.0, 0.5, 0.0), (2.0, 1.0, 0.0))  # its middle is the corner of four cells
def test_the_price_of_a_line_is_the_same_both_ways_and_at_least_its_length(seed, start, end) -> None:
    asked = motions(boxes(seed))
    there, back = asked.cost(start, end), asked.cost(end, start)
    length = np.hypot(end[0] - start[0], end[1] - start[1])
    assert there == pytest.approx(back, rel=1e-3, abs=1e-6)
    assert length * (1.0 - 1e-6) <= there <= 5.0 * length + 1e-9


def test_poses_are_evenly_spaced_and_keep_the_path_s_own() -> None:
    path = np.array(((1.0, 1.0, 0.0), (2.0, 1.0, 0.0), (2.0, 1.7, 0.0)))
    poses = motions(boxes(0, 0)).poses(path, 0.1)
    assert np.hypot(*np.diff(poses[:, :2], axis=0).T) == pytest.approx(np.full(17, 0.1))
    assert poses[10, :2] == pytest.approx((2.0, 1.0))


def test_shortcuts_and_the_band_lower_the_price_and_stay_free() -> None:
    occupied = np.zeros((100, 100), np.bool_)
    occupied[:60, 48:52] = True
    asked = motions(distance_field(occupied, SIDE))
    detour = np.array(((1.0, 0.5, 0.0), (0.5, 4.0, 0.0), (2.5, 4.7, 0.0), (4.5, 4.0, 0.0), (4.0, 0.5, 0.0)))

    def price(path: np.ndarray) -> float:
        return sum(asked.cost(a, b) for a, b in pairwise(path))

    shortened = asked.shorten(asked.poses(detour, 0.1))
    smoothed = smooth_path(asked, detour, 0.1, 20)
    assert price(shortened) < 0.95 * price(detour)
    assert price(smoothed) < price(shortened)
    assert all(asked.can_move(a, b) for a, b in pairwise(smoothed))
    assert smoothed[[0, -1], :2] == pytest.approx(detour[[0, -1], :2])
    turns = np.diff(np.unwrap(np.arctan2(*np.diff(smoothed[:, :2], axis=0).T[::-1])))
    assert np.abs(turns).max() < 0.35  # no corner is left


def test_cells_behind_a_wall_are_out_of_reach_and_a_blocked_start_gets_out() -> None:
    occupied = np.zeros((40, 40), np.bool_)
    occupied[:, 20] = True
    field = distance_field(occupied, SIDE)
    free = reachable_cells(field, occupied, SIDE, 0.2, 0.0, 10, 5)
    assert free[:, :16].all()
    assert not free[:, 17:].any()
    near = reachable_cells(field, occupied, SIDE, 0.2, 0.4, 10, 18)
    assert near[:, :16].all()
    assert not near[:, 20:].any()
