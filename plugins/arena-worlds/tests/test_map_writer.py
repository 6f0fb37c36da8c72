"""A written map is read back as the same grid, and no other file is left behind."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from arena_core import ConfigurationError, OccupancyGrid, Pose
from arena_core.hosting import RunFolderError
from arena_worlds.formats.map_writer import write_map
from arena_worlds.formats.ros_map import load_map

EXACT = settings(derandomize=True, deadline=None, max_examples=60)
SHAPES = arrays.array_shapes(min_dims=2, max_dims=2, max_side=12)
METRES = st.floats(-1e6, 1e6)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("maps")


@EXACT
@given(
    data=st.one_of(
        arrays.arrays(np.int8, SHAPES, elements=st.sampled_from((-1, 0, 100))),
        arrays.arrays(np.int8, SHAPES, elements=st.integers(-1, 100)),
    ),
    resolution=st.floats(1e-6, 1e3),
    origin=st.tuples(METRES, METRES, METRES),
)
def test_written_map_is_read_back_exactly(
    folder: Path, data: np.ndarray, resolution: float, origin: tuple[float, float, float]
) -> None:
    write_map(folder / "map.yaml", OccupancyGrid(data, resolution, Pose(*origin)))
    again = load_map(folder / "map.yaml")
    assert (again.data == data).all()
    assert (again.resolution, again.origin) == (resolution, Pose(*origin))


def test_map_without_shades_is_written_as_map_saver_writes_it(tmp_path: Path) -> None:
    files = write_map(
        tmp_path / "site.yaml", OccupancyGrid(np.array([[0, 100], [-1, 0]], np.int8), 0.05, Pose(1.0, 2.0))
    )
    assert files == [tmp_path / "site.yaml", tmp_path / "site.pgm"]
    assert sorted(tmp_path.iterdir()) == sorted(files)
    assert files[1].read_bytes() == b"P5\n2 2\n255\n" + bytes((205, 254, 254, 0))
    assert "mode: trinary" in files[0].read_text()


def test_other_endings_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"map\.png: allowed: a file that ends in \.yaml"):
        write_map(tmp_path / "map.png", OccupancyGrid(np.zeros((2, 2), np.int8), 0.05, Pose(0.0, 0.0)))


def test_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RunFolderError, match=r"cannot write .*file"):
        write_map(tmp_path / "file" / "map.yaml", OccupancyGrid(np.zeros((2, 2), np.int8), 0.05, Pose(0.0, 0.0)))
