from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from arena_core import ArenaError, Footprint, OccupancyGrid, Path, Pose
from arena_drawing.frames import FramePainter, FrameWindow, SceneState, StaticScene
from arena_drawing.painter import DOOR, FREE_CELL, OBSTACLE, PERSON, ROBOT, WALL


def painter(footprint=None, origin=None):
    data = np.zeros((60, 100), np.int8)  # 10 m by 6 m
    data[:, 80:] = 100
    grid = OccupancyGrid(data, 0.1, origin or Pose(-1.0, -1.0, 0.0))
    square = {"vertices_xy": np.array([[4.0, 3.0], [5.0, 3.0], [5.0, 4.0], [4.0, 4.0]]), "radius": 0.0}
    stage = StaticScene(grid, [square], np.array((0.0, 0.0, 0.0)), np.array((6.0, 0.0, 0.0)), Path(np.zeros((2, 3))))
    return FramePainter(stage, footprint or Footprint.polygon([[-0.4, -0.3], [0.4, -0.3], [0.4, 0.3], [-0.4, 0.3]]))


def scene(x, y, theta=0.0, people=()):
    positions = np.array(people).reshape(-1, 2)
    return SceneState(np.array((x, y, theta)), positions, np.full(len(positions), 0.3), np.empty((0, 2)), 1.0)


def colour_at(frame, x, y):
    """Return the colour of a place of ``painter``'s map, whose free cells and margin reach from
    -1.5 to 7.5 m and -1.5 to 5.5 m.
    """
    height, width = frame.shape[:2]
    return frame[int((5.5 - y) / 7.0 * height), int((x + 1.5) / 9.0 * width)] / 255.0


def near(colour, other):
    return np.abs(np.asarray(colour) - to_rgb(other)).max() < 0.2


def test_walls_obstacles_robot_and_people_are_where_they_are():
    frame = painter().frame(scene(1.0, 2.0, people=[(3.0, 1.0), (np.nan, np.nan)]))
    assert (frame.dtype, frame.shape) == (np.uint8, (373, 480, 3))
    assert near(colour_at(frame, 7.2, 2.0), WALL)
    assert near(colour_at(frame, 4.5, 3.5), OBSTACLE)
    assert near(colour_at(frame, 0.7, 2.1), ROBOT)
    assert near(colour_at(frame, 3.1, 1.1), PERSON)
    assert near(colour_at(frame, 2.0, 4.0), FREE_CELL)


def test_what_has_moved_leaves_nothing_behind():
    painting = painter()
    first = painting.frame(scene(1.0, 2.0, people=[(3.0, 1.0)]))
    assert not np.array_equal(painting.frame(scene(5.0, 1.0)), first)
    assert np.array_equal(painting.frame(scene(1.0, 2.0, people=[(3.0, 1.0)])), first)


def test_a_door_is_filled_while_it_is_closed():
    data = np.zeros((60, 90), np.int8)
    leaf = np.array([[3.0, 2.0], [4.0, 2.0], [4.0, 3.0], [3.0, 3.0]])
    ends = np.array((0.0, 0.0, 0.0)), np.array((6.0, 0.0, 0.0))
    stage = StaticScene(OccupancyGrid(data, 0.1, Pose(-1.0, -1.0, 0.0)), [], *ends, None, doors=[leaf])
    painting, robot = FramePainter(stage, Footprint.circle(0.4)), scene(0.0, 0.0)
    for opened in (False, True, False):
        frame = painting.frame(replace(robot, doors_open=[opened]))
        height, width = frame.shape[:2]
        inside = frame[int((5.5 - 2.5) / 7.0 * height), int((3.5 + 1.5) / 10.0 * width)] / 255.0
        assert near(inside, FREE_CELL if opened else DOOR)


def test_a_round_robot_and_a_turned_map_are_drawn():
    frame = painter(Footprint.circle(0.4)).frame(scene(1.0, 2.0))
    assert near(colour_at(frame, 1.0, 2.25), ROBOT)
    turned = painter(origin=Pose(0.0, 0.0, np.pi / 2)).frame(scene(-2.0, 2.0))
    assert turned.shape[0] > turned.shape[1]


def test_a_window_needs_a_display():
    with pytest.raises(ArenaError, match="there is no display; allowed here: rgb_array"):
        FrameWindow("arena", 10.0)
