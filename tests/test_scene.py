import numpy as np
import pytest

from arena_core import Obstacle, OccupancyGrid, Pose
from arena_core.scenes import scene_of

PILLAR, BLOCK = Obstacle(np.array([[1.0, 2.0]]), 0.25), Obstacle(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))


HERE = Pose(0.0, 0.0)


def grid(origin=HERE):
    data = np.zeros((20, 30), np.int8)
    data[0], data[:, 4] = 100, 100
    return OccupancyGrid(data, 0.1, origin)


def test_walls_are_merged_boxes_that_fill_the_occupied_cells():
    scene = scene_of(grid(), (), 2.0)
    assert len(scene.boxes) == 2
    assert (scene.boxes[:, 3] * scene.boxes[:, 4]).sum() == pytest.approx(grid().occupied.sum() * 0.01)
    assert scene.boxes[:, 5:].tolist() == [[0.0, 2.0]] * 2
    assert scene.size == pytest.approx((3.0, 2.0))


def test_obstacles_stand_in_the_frame_of_the_map():
    origin = Pose(0.5, -1.0, 0.7)
    scene = scene_of(grid(origin), (PILLAR, BLOCK), 1.5)
    assert origin.compose(Pose(*scene.cylinders[0, :2])).array()[:2] == pytest.approx([1.0, 2.0])
    assert scene.cylinders[0, 2:].tolist() == [0.25, 0.0, 1.5]
    (prism,) = scene.prisms
    assert [origin.compose(Pose(x, y)).array()[:2] for x, y in prism.vertices_xy] == pytest.approx(BLOCK.vertices_xy)
    assert (prism.bottom, prism.top) == (0.0, 1.5)
