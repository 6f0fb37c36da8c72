"""Clearance, regions and sight count unknown cells and the outside as blocked."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import OccupancyGrid, Pose
from arena_tasks.random.free_space import FreeSpace

EXACT = settings(derandomize=True, deadline=None, max_examples=50)


def grid(rows: list[str], resolution: float = 1.0) -> OccupancyGrid:
    """Draw a map, first row at the top: # wall, ? unknown, o half occupied, . free."""
    values = {"#": 100, "?": -1, "o": 50, ".": 0}
    return OccupancyGrid(np.array([[values[c] for c in row] for row in rows[::-1]]), resolution, Pose(0.0, 0.0))


def space(rows: list[str], resolution: float = 1.0) -> FreeSpace:
    return grid(rows, resolution).derive(FreeSpace)


@pytest.mark.parametrize("blocked", ["#", "?"])
def test_walls_and_unknown_cells_take_room(blocked: str) -> None:
    found = space([blocked + "....."] * 7)
    assert found.clearance[3].tolist() == [-0.5, 0.5, 1.5, 2.5, 1.5, 0.5]


def test_outside_of_the_grid_takes_room() -> None:
    assert space(["...", "...", "..."]).clearance.tolist() == [[0.5, 0.5, 0.5], [0.5, 1.5, 0.5], [0.5, 0.5, 0.5]]


def test_cells_below_the_threshold_of_occupancy_are_free() -> None:
    assert (space(["...", ".o.", "..."]).clearance > 0).all()


def test_positions_outside_have_no_room() -> None:
    found = space(["...", "...", "..."])
    assert found.has_room([[1.5, 1.5], [-0.1, 1.5], [1.5, 3.0], [1e9, -1e9]], 0.1).tolist() == [
        True,
        False,
        False,
        False,
    ]


def test_a_gap_joins_regions_only_for_bodies_that_pass() -> None:
    rows = [".......", ".......", "...#...", "...#...", ".......", "...#...", "...#...", ".......", "......."]
    found = space(rows[2:-2], 0.5)
    assert len(np.unique(found.regions(0.2))) == 2  # 0 and one region
    assert len(np.unique(found.regions(0.7))) == 3


def test_regions_are_computed_once_for_a_clearance() -> None:
    found = space(["....."] * 5)
    assert found.regions(0.5) is found.regions(0.5)
    assert found.regions(0.5) is not found.regions(1.5)


def test_walls_block_the_view() -> None:
    found = space([".....", "..#..", ".....", ".....", "....."])
    across, around = (np.array((0.5, 3.5)), np.array((4.5, 3.5))), (np.array((0.5, 1.5)), np.array((4.5, 1.5)))
    assert not found.is_visible(*across, 0.1)
    assert found.is_visible(*around, 0.1)
    assert not found.is_visible(*around, 1.5)


@EXACT
@given(st.integers(0, 2**32), st.floats(0.0, 3.0))
def test_view_is_mutual(seed: int, clearance: float) -> None:
    random = np.random.default_rng(seed)
    found = OccupancyGrid(np.where(random.random((12, 15)) < 0.15, 100, 0), 0.5, Pose(1.0, 2.0, 0.7)).derive(FreeSpace)
    one, other = found.grid.positions(random.integers(0, 12, (2, 2)))
    assert found.is_visible(one, other, clearance) == found.is_visible(other, one, clearance)
