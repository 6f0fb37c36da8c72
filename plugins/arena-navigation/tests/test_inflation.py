import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import INSCRIBED, LETHAL, ConfigurationError, OccupancyGrid, Pose
from arena_navigation.planning.inflation import NO_INFORMATION, InflatedCosts, Inflation

RESOLUTION = 0.05


def grid_of(seed: int, share: float = 0.03, unknown: float = 0.0) -> OccupancyGrid:
    random = np.random.default_rng(seed)
    data = np.where(random.random((40, 50)) < share, 100, 0)
    data[random.random((40, 50)) < unknown] = -1
    return OccupancyGrid(data.astype(np.int8), RESOLUTION, Pose(0.0, 0.0))


def formula(distance: float, inscribed: float, radius: float, scaling: float) -> int:
    """The rule of costmap_2d, written out once more."""
    if distance == 0.0:
        return 254
    if distance > radius + 1e-9:
        return 0
    if distance <= inscribed + 1e-9:
        return 253
    return int(252 * math.exp(-scaling * (distance - inscribed)))


@settings(derandomize=True, deadline=None, max_examples=30)
@given(st.integers(0, 10**6), st.floats(0.06, 0.3), st.floats(0.3, 0.9), st.floats(0.0, 12.0))
def test_every_cell_costs_what_the_formula_says(seed: int, inscribed: float, radius: float, scaling: float) -> None:
    grid = grid_of(seed)
    costs = grid.derive(InflatedCosts(Inflation(inscribed, radius, scaling), False))
    occupied = np.argwhere(grid.occupied)
    for row, column in np.random.default_rng(seed).integers(0, 40, (25, 2)):
        distance = math.sqrt(((occupied - (row, column)) ** 2).sum(axis=1).min()) * RESOLUTION
        assert costs[row, column] == formula(distance, inscribed, radius, scaling)


def test_costs_beside_one_obstacle() -> None:
    data = np.zeros((1, 9), np.int8)
    data[0, 0] = 100
    costs = OccupancyGrid(data, 0.1, Pose(0.0, 0.0)).derive(InflatedCosts(Inflation(0.2, 0.6, 2.0), False))
    decayed = [int(252 * math.exp(-2.0 * d)) for d in (0.1, 0.2, 0.3, 0.4)]
    assert costs[0].tolist() == [254, 253, 253, *decayed, 0, 0]


def test_an_inflation_radius_of_zero_leaves_only_obstacles() -> None:
    grid = grid_of(1)
    costs = grid.derive(InflatedCosts(Inflation(0.3, 0.0, 3.0), False))
    assert (costs == np.where(grid.occupied, LETHAL, 0)).all()


def test_an_inflation_inside_the_robot_is_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"inflation_radius is 0.1; allowed: 0 or at least .* 0.200"):
        Inflation(0.2, 0.1, 3.0)


def test_a_grid_without_obstacles_costs_nothing() -> None:
    grid = OccupancyGrid(np.zeros((4, 5), np.int8), RESOLUTION, Pose(0.0, 0.0))
    assert (grid.derive(InflatedCosts(Inflation(0.2, 1.0, 3.0), False)) == 0).all()


def test_unknown_cells_are_no_information_unless_allowed() -> None:
    grid = grid_of(2, unknown=0.2)
    inflation = Inflation(0.1, 0.3, 3.0)
    unknown = grid.data == -1
    strict, lenient = grid.derive(InflatedCosts(inflation, False)), grid.derive(InflatedCosts(inflation, True))
    assert (strict[unknown] == NO_INFORMATION).all()
    assert (lenient[unknown] <= INSCRIBED).all()
    assert (strict[~unknown] == lenient[~unknown]).all()


def test_costs_are_computed_once_for_a_grid_and_equal_parameters() -> None:
    grid = grid_of(3)
    first = grid.derive(InflatedCosts(Inflation(0.1, 0.3, 3.0), False))
    assert grid.derive(InflatedCosts(Inflation(0.1, 0.3, 3.0), False)) is first
    assert grid.derive(InflatedCosts(Inflation(0.1, 0.3, 4.0), False)) is not first
    assert not first.flags.writeable
