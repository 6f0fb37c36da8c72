"""Ways on foot lead round walls, and there is none where a body does not fit."""

import numpy as np
import pytest

from arena_core import OccupancyGrid, Pose
from arena_kernels.shortest_path import ShortestPaths, path_length, place_on_patrol

RADIUS = 0.3


def hall(door: float) -> OccupancyGrid:
    """Return 10 x 6 m with a wall across it that has a door at its upper end."""
    data = np.zeros((120, 200), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    data[: 120 - 1 - round(door / 0.05), 99:101] = 100
    return OccupancyGrid(data, 0.05, Pose(0.0, 0.0))


def test_a_way_goes_through_the_door() -> None:
    way = ShortestPaths(hall(1.0)).path_between(np.array((1.0, 1.0)), np.array((9.0, 1.0)), RADIUS)
    assert way[0].tolist() == [1.0, 1.0]
    assert way[-1].tolist() == [9.0, 1.0]
    assert way[:, 1].max() > 4.9
    assert 11.5 < path_length(way) < 15.0


def test_a_way_back_goes_through_the_door_too() -> None:
    way = ShortestPaths(hall(1.0)).path_between(np.array((9.0, 1.0)), np.array((4.0, 1.0)), RADIUS)
    assert way[:, 1].max() > 4.9
    assert len(way) > 2


@pytest.mark.parametrize(
    ("start", "end"),
    [((1.0, 1.0), (4.0, 5.0)), ((2.0, 5.2), (4.0, 1.0)), ((4.0, 1.0), (1.0, 5.2)), ((9.0, 5.0), (6.0, 1.0))],
)
def test_a_straight_way_has_no_corner(start: tuple[float, float], end: tuple[float, float]) -> None:
    way = ShortestPaths(hall(1.0)).path_between(np.array(start), np.array(end), RADIUS)
    assert way.tolist() == [list(start), list(end)]


def test_there_is_no_way_through_a_door_that_is_too_narrow() -> None:
    assert len(ShortestPaths(hall(0.4)).path_between(np.array((1.0, 1.0)), np.array((9.0, 1.0)), RADIUS)) == 0
    assert ShortestPaths(hall(0.4)).patrol_paths(np.array(((1.0, 1.0), (9.0, 1.0))), RADIUS) == []


@pytest.mark.parametrize(
    ("share", "leg", "place"),
    [(0.0, 0, (4.0, 1.0)), (0.25, 0, (2.5, 1.0)), (0.5, 1, (1.0, 1.0)), (0.75, 1, (2.5, 1.0))],
)
def test_places_on_a_round_are_counted_from_the_last_waypoint(
    share: float, leg: int, place: tuple[float, float]
) -> None:
    legs = ShortestPaths(hall(1.0)).patrol_paths(np.array(((1.0, 1.0), (4.0, 1.0))), RADIUS)
    there, number = place_on_patrol(legs, share)
    assert number == leg
    assert there == pytest.approx(place)
