"""A grid survives the world files of Gazebo and MuJoCo, and what cannot be read is said in one line."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from arena_core import FREE, OCCUPIED, OccupancyGrid, Pose
from arena_worlds.mjcf import read_mjcf
from arena_worlds.mjcf_writer import mjcf_text
from arena_worlds.rectangles import rectangles
from arena_worlds.sdf import read_sdf
from arena_worlds.sdf_writer import sdf_text
from arena_worlds.solids import Solids, grid_of, solids_of

masks = arrays.arrays(bool, st.tuples(st.integers(1, 12), st.integers(1, 12)))
origins = st.builds(Pose, st.floats(-50, 50), st.floats(-50, 50), st.floats(-math.pi, math.pi))
resolutions = st.sampled_from((0.05, 0.1, 0.046, 1.0))


def grid(mask: np.ndarray, resolution: float = 0.1, origin: Pose = Pose(0.0, 0.0)) -> OccupancyGrid:
    return OccupancyGrid(np.where(mask, OCCUPIED, FREE).astype(np.int8), resolution, origin)


def assert_same(found: OccupancyGrid, given: OccupancyGrid) -> None:
    assert found.resolution == given.resolution
    assert found.origin.array() == pytest.approx(given.origin.array(), abs=1e-9)
    assert np.array_equal(found.occupied, given.occupied)


@given(mask=masks)
def test_rectangles_hold_each_occupied_cell_once(mask: np.ndarray) -> None:
    count = np.zeros(mask.shape, int)
    for first_row, first_column, end_row, end_column in rectangles(mask):
        count[first_row:end_row, first_column:end_column] += 1
    assert np.array_equal(count, mask.astype(int))


def test_a_wall_is_one_rectangle_and_a_frame_is_four() -> None:
    wall = np.zeros((20, 30), bool)
    wall[3:17, 5:7] = True
    assert rectangles(wall).tolist() == [[3, 5, 17, 7]]
    frame = np.ones((20, 30), bool)
    frame[2:-2, 2:-2] = False
    assert len(rectangles(frame)) == 4
    assert rectangles(np.zeros((3, 4), bool)).shape == (0, 4)


@given(mask=masks, origin=origins, resolution=resolutions)
@settings(deadline=None)
def test_a_grid_survives_gazebo_and_mujoco(tmp_path_factory: pytest.TempPathFactory, mask, origin, resolution) -> None:
    folder = tmp_path_factory.getbasetemp()
    given_grid = grid(mask, resolution, origin)
    for name, text, read in (("w.sdf", sdf_text, read_sdf), ("w.xml", mjcf_text, read_mjcf)):
        path = folder / name
        path.write_text(text(solids_of(given_grid), "w", 2.0))
        assert_same(grid_of(read(path), resolution, 1.0), given_grid)


def test_mujoco_loads_the_model_and_its_rays_end_at_the_walls(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    mask = np.zeros((40, 60), bool)
    mask[10:30, 20] = True
    given_grid = grid(mask, 0.1, Pose(1.0, -2.0, 0.5))
    model = mujoco.MjModel.from_xml_string(mjcf_text(solids_of(given_grid), "w", 1.5))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert (model.ngeom, model.nq) == (2, 0)
    for row, column in ((12, 20), (12, 25), (35, 20)):
        x, y = given_grid.positions((row, column))
        hit = np.zeros(1, np.int32)
        away = mujoco.mj_ray(model, data, np.array((x, y, 5.0)), np.array((0.0, 0.0, -1.0)), None, 1, -1, hit, None)
        assert away == pytest.approx(3.5 if mask[row, column] else 5.0)
