"""Paths that a client sends, as the navigator follows them."""

import numpy as np
import pytest

from arena_core import Pose
from arena_ros.live.given_path import SPACING, length_ahead, resample_path


def test_a_path_of_far_poses_has_near_ones_that_look_along_it():
    path = resample_path(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]))
    np.testing.assert_allclose(path.poses[[0, -1]], [[0.0, 0.0, 0.0], [2.0, 1.0, np.pi / 2]])
    assert np.hypot(*np.diff(path.poses[:, :2], axis=0).T).max() <= SPACING + 1e-9
    assert path.length == pytest.approx(3.0, abs=0.05)  # a corner may be cut


def test_poses_in_one_place_count_once_and_alone_are_no_path():
    path = resample_path(np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 1.0], [1.0, 1.0]]))
    np.testing.assert_allclose(path.poses[:, 2], np.pi / 4)
    assert resample_path(np.array([[1.0, 2.0], [1.0, 2.0]])) is None
    assert resample_path(np.array([[1.0, 2.0]])) is None


@pytest.mark.parametrize(("place", "distance"), [((1.0, 0.0), 2.0), ((1.0, 0.5), 2.5), ((4.0, 0.0), 1.0)])
def test_what_is_ahead_is_the_way_to_the_path_and_along_it(place, distance):
    path = resample_path(np.array([[0.0, 0.0], [3.0, 0.0]]))
    assert length_ahead(path, Pose(*place)) == pytest.approx(distance)
