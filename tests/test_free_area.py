"""The free area of a grid is that of its largest connected region."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from arena_core import OccupancyGrid, Pose
from arena_core.values.world import free_area


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.integers(0, 2**31), st.floats(0.2, 0.9))
def test_free_area_is_that_of_the_largest_region(seed: int, share: float) -> None:
    free = np.random.default_rng(seed).random((23, 31)) < share
    grid = OccupancyGrid(np.where(free, 0, 100).astype(np.int8), 0.1, Pose(0.0, 0.0))
    labels, _ = ndimage.label(free)
    largest = np.bincount(labels[free], minlength=1).max()
    assert free_area(grid) == pytest.approx(0.01 * largest)


def test_what_is_unknown_is_not_free() -> None:
    assert free_area(OccupancyGrid(np.full((4, 5), -1, np.int8), 0.1, Pose(0.0, 0.0))) == 0.0
