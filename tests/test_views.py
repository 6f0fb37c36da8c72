"""What `arena_core.testing` gives planners to see."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from arena_core.testing import boxes_costmap, tracked, view

SIDE = st.floats(-3.5, 3.5)
BOX = st.tuples(SIDE, SIDE, SIDE, SIDE).map(
    lambda b: (min(b[0], b[1]), max(b[0], b[1]), min(b[2], b[3]), max(b[2], b[3]))
)


@given(st.lists(BOX, max_size=4), st.integers(1, 60))
def test_distance_of_a_boxes_costmap_is_that_to_the_nearest_lethal_cell(boxes, cells):
    window = boxes_costmap(*boxes, cells=cells, resolution=0.1)
    lethal = window.costs == 254
    if lethal.any():
        np.testing.assert_allclose(window.distance, 0.1 * distance_transform_edt(~lethal), atol=1e-6)
    else:
        assert np.isinf(window.distance).all()


def test_boxes_costmap_is_lethal_where_a_box_stands():
    window = boxes_costmap((1.0, 1.5, -0.2, 0.2))
    row, column = np.floor((np.array((0.0, 1.2)) - window.origin_xy[::-1]) / window.resolution).astype(int)
    assert window.costs[row, column] == 254
    assert window.costs[row, 0] == 0


def test_view_holds_what_it_was_given():
    tracks = tracked((1.0, 2.0, 0.3, 0.4))
    seen = view(path_xy=[(0.0, 0.0), (1.0, 1.0)], stamp=2.0, tracks=tracks)
    assert (seen.goal.x, seen.goal.y, seen.stamp) == (1.0, 1.0, 2.0)
    assert seen.tracks is tracks
    assert len(view(path_xy=[]).path.poses) == 0
