"""Distances on the fine grid, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import Obstacle, OccupancyGrid, Pose, World
from arena_core.testing import furniture, scenario
from arena_reference.body import distance_at
from arena_reference.terrain import terrain_of


def bare(*obstacles: Obstacle, theta: float = 0.0):
    """Return a problem in a field of 4 m with one wall along its left edge, and these obstacles."""
    cells = np.zeros((80, 80), np.int8)
    cells[:, 0] = 100
    world = World("field", OccupancyGrid(cells, 0.05, Pose(1.0, 2.0, theta)))
    return replace(scenario(), world=world, obstacles=obstacles)


@pytest.mark.parametrize("cell", [0.025, 0.05, 0.1])
def test_a_wall_is_as_far_as_it_is(cell: float) -> None:
    ground = terrain_of(bare(), cell, 0.3)
    for away in (0.1, 0.4, 1.3):
        found = distance_at(ground, 1.05 + away, 4.0)
        assert found == pytest.approx(away, abs=ground.error + 0.3 * ground.cell)


def test_a_turned_map_has_its_walls_where_they_are() -> None:
    ground = terrain_of(bare(theta=np.pi / 2), 0.05, 0.3)
    assert distance_at(ground, 0.0, 2.05 + 0.7) == pytest.approx(0.7, abs=0.03)


def test_discs_and_polygons_count() -> None:
    square = Obstacle(np.array(((3.0, 3.0), (3.5, 3.0), (3.5, 3.5), (3.0, 3.5))))
    ground = terrain_of(bare(Obstacle(np.array(((2.0, 5.0),)), 0.25), square), 0.05, 0.3)
    assert distance_at(ground, 2.6, 5.0) == pytest.approx(0.35, abs=0.02)
    assert distance_at(ground, 3.9, 3.8) == pytest.approx(0.5, abs=0.02)
    assert distance_at(ground, 3.25, 3.25) == 0.0


def test_furniture_above_the_robot_does_not_count() -> None:
    table = furniture("table", 0.0, 0.0)
    problem = scenario()
    world = replace(problem.world, furniture=(table,))
    below = terrain_of(replace(problem, world=world), 0.05, 0.3)
    above = terrain_of(replace(problem, world=world), 0.05, 1.5)
    assert distance_at(below, 0.0, 0.0) > distance_at(above, 0.0, 0.0) == 0.0


def test_ground_about_the_map_is_free() -> None:
    ground = terrain_of(bare(), 0.05, 0.3)
    assert distance_at(ground, 0.6, 4.0) == pytest.approx(0.4, abs=0.03)
