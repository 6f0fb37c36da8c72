import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_dwa.curves import dubins_lengths, fill_dubins_curve, pose_along_arc, shortest_dubins_path
from arena_dwa.settings import Body, BodyOnWindow
from arena_dwa.trajectory import compose_poses, planar_pose
from arena_kernels.costmap_window import outline_clearance, outline_of, window_of

CAR = Body(
    outline_of(np.array(((0.34, 0.165), (-0.08, 0.165), (-0.08, -0.165), (0.34, -0.165))), 0.38, 0.08, 0.05),
    0.02,
    0.25,
    0.2,
)
RADIUS, BENDS = 0.5, np.array((0.0, 1.0, -1.0, 2.0, -2.0))
GAP = (1.0, 1.2, 0.22, 3.1), (1.0, 1.2, -3.1, -0.22)  # 0.45 m wide, about the x axis: the car is 0.33 m wide


def driven(start, pieces):
    """Return the poses (N, 4) along a way, 1 cm apart, and its end."""
    stands, stand = [], start
    for length, curvature in pieces.tolist():
        parts = math.ceil(abs(length) / 0.01)
        stands += [compose_poses(stand, pose_along_arc(length * k / parts, curvature)) for k in range(1, parts + 1)]
        stand = stands[-1] if parts else stand
    return stands, stand


@settings(deadline=None)
@given(
    *(st.floats(-3.0, 3.0) for _ in range(3)),
    st.sampled_from((1.0, -1.0)),
    st.sampled_from((1.0, -1.0)),
    st.sampled_from((1.0, -1.0)),
)
def test_every_curve_ends_at_the_pose_that_is_asked_for_in_its_gear(x, y, theta, gear, first, last):
    pieces, start = np.zeros((3, 2)), planar_pose(0.3, -0.2, 0.7)
    length = fill_dubins_curve(start, np.array((x, y, theta, 0.0)), gear, RADIUS, first, last, pieces)
    if length == math.inf:  # circles that touch or overlap have no common tangent between them
        return
    assert (gear * pieces[:, 0] >= 0.0).all()
    assert driven(start, pieces)[1] == pytest.approx(planar_pose(x, y, theta), abs=1e-6)


def test_straight_ahead_the_curve_is_straight():
    assert dubins_lengths(3.0, 0.0, 0.0, 1.0, 1.0) == pytest.approx((0.0, 3.0, 0.0))


MOUTH = [(0.85, y, theta, 0.0) for y in np.linspace(-0.06, 0.06, 7) for theta in np.linspace(-0.4, 0.4, 17)]


def way(costmap, start, *walls, ends=MOUTH, gear=1.0, first=1.2):
    window = window_of(costmap(*walls))
    return window, shortest_dubins_path(
        BodyOnWindow(window, CAR), planar_pose(*start), np.array(ends), gear, RADIUS, first, BENDS
    )


@pytest.mark.parametrize("start", [(0.78, -0.23, 1.0), (0.7, 0.25, -1.0), (0.72, -0.35, 1.3)])
def test_a_car_that_stands_obliquely_before_a_gap_backs_up_and_enters_it_aligned(costmap, start):
    window, pieces = way(costmap, start, *GAP)
    assert pieces[0, 0] < 0.0
    assert (pieces[1:, 0] >= 0.0).all()
    stands, end = driven(planar_pose(*start), pieces)
    assert end[:2] == pytest.approx((0.85, 0.0), abs=0.07)
    assert end[2] > 0.9
    begun = outline_clearance(window, CAR.outline, planar_pose(*start), 1.0)
    assert min(outline_clearance(window, CAR.outline, stand, 1.0) for stand in stands) > min(0.4 * begun, 0.015)


def test_a_car_with_its_back_to_a_gap_enters_it_backwards_where_that_is_asked_for(costmap):
    _, pieces = way(
        costmap, (0.6, -0.2, 2.4), *GAP, ends=[(x, y, theta + math.pi, gap) for x, y, theta, gap in MOUTH], gear=-1.0
    )
    assert pieces[0, 0] >= 0.0
    assert (pieces[1:, 0] <= 0.0).all()
    end = driven(planar_pose(0.6, -0.2, 2.4), pieces)[1]
    assert end[:2] == pytest.approx((0.85, 0.0), abs=0.07)
    assert end[2] < -0.9


def test_the_shortest_way_is_taken(costmap):
    _, pieces = way(
        costmap,
        (0.0, 0.0, 0.0),
        (2.9, 3.0, 2.9, 3.0),
        ends=((1.1, 0.0, 0.0, 0.0), (1.2, 0.1, 0.5, 0.0), (1.0, 0.0, 0.0, 0.0)),
    )
    assert np.abs(pieces[:, 0]).sum() == pytest.approx(1.0)


@pytest.mark.parametrize("closed", [{"first": 0.0}, {"ends": np.empty((0, 4))}])
def test_there_is_no_way_without_room_to_back_up_or_a_place_to_go_to(costmap, closed):
    assert not way(costmap, (0.78, -0.23, 1.0), *GAP, **closed)[1].any()
