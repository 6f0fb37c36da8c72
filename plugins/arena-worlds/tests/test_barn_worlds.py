"""BARN's worlds: cylinders become discs of cells, reference paths lie in the free, and a bad
file is said in one line.
"""

import gzip
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError, InputFileError, OccupancyGrid, Pose
from arena_kernels.distance import distance_field
from arena_worlds.formats.barn import BarnWorlds, read_reference_path, world_files
from arena_worlds.formats.sdf import read_sdf
from arena_worlds.formats.solids import Solids, grid_of

BARN = Path(__file__).parents[3].parent / "shared" / "data" / "barn"
DRAWN = Path(__file__).parents[3] / "tests" / "data" / "barn"
needs_barn = pytest.mark.skipif(
    not BARN.is_dir(), reason="the worlds of the BARN challenge are not at ../shared/data/barn"
)
MODEL = """<model name='{name}'><static>{static}</static><pose frame=''>{pose}</pose>
<link name='link'><collision name='collision'><geometry>{shape}</geometry></collision></link></model>"""
CYLINDER = "<cylinder><radius>0.075</radius><length>1</length></cylinder>"
GROUND = MODEL.format(name="ground", static=1, pose="0 0 0 0 0 0", shape="<plane><size>100 100</size></plane>")


def model(pose: str = "1 2 0 0 0 0", shape: str = CYLINDER, static: object = 1) -> str:
    return MODEL.format(name="unit_cylinder_0", static=static, pose=pose, shape=shape)


def sdf(*models: str) -> str:
    return f"<sdf version='1.6'><world name='default'>{GROUND}{''.join(models)}</world></sdf>"


def written(folder: Path, text: str, name: str = "world_3.world") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def source(worlds: Path | None, **keys: object) -> BarnWorlds:
    usual = {
        "path": None if worlds is None else str(worlds),
        "path_files": None,
        "resolution": 0.025,
        "margin": 1.0,
        "known": False,
    }
    return BarnWorlds(**{**usual, **keys})  # type: ignore[arg-type]


def disc_grid(discs: list[tuple[float, float, float]], resolution: float, margin: float) -> OccupancyGrid:
    return grid_of(Solids(Pose(0.0, 0.0), None, np.empty((0, 5)), np.array(discs)), resolution, margin)


def test_cylinders_are_read_where_the_poses_of_model_link_and_collision_put_them(tmp_path: Path) -> None:
    turned = (
        "<model name='post'><static>true</static><pose>1 2 0 0 0 1.5707963267948966</pose><link "
        "name='l'><pose>0.5 0 0 0 0 0</pose>"
        f"<collision name='c'><pose>0.25 0 0 0 0 0</pose><geometry>{CYLINDER}</geometry></collision></link></model>"
    )
    plain, moved = read_sdf(written(tmp_path, sdf(model("-0.5 0.25 0 0 0 0"), turned))).cylinders.tolist()
    assert plain == [-0.5, 0.25, 0.075]
    assert moved == pytest.approx([1.0, 2.75, 0.075])


def test_gzip_gives_the_same_world(tmp_path: Path) -> None:
    path = tmp_path / "world_3.world.gz"
    path.write_bytes(gzip.compress(sdf(model()).encode()))
    assert (
        read_sdf(path).cylinders.tolist()
        == read_sdf(written(tmp_path, sdf(model()))).cylinders.tolist()
        == [[1.0, 2.0, 0.075]]
    )


BOMB = '<!DOCTYPE sdf [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]>'
OUTSIDE = '<!DOCTYPE sdf [<!ENTITY a SYSTEM "file:///etc/hostname">]>'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (BOMB + sdf(model("&b; 2 0 0 0 0")), "document type"),
        (OUTSIDE + sdf(model("&a; 2 0 0 0 0")), "document type"),
        (sdf(model())[:-3], "is no XML"),
        ("", "is no XML"),
        ("<html/>", "0 elements sdf/world"),
        (sdf(), "no cylinder"),
        (sdf("<include><uri>model://shelf</uri></include>", model()), "include is 'model://shelf'"),
        (sdf(model(shape="<mesh><uri>shelf.dae</uri></mesh>")), "geometry is mesh"),
        (sdf(model(shape="<box><size>1 0 1</size></box>")), "size is '1 0 1'"),
        (sdf(model(shape="<box><size>1 1</size></box>")), "size is '1 1'"),
        (sdf(model()).replace("<pose frame=''>", "<pose relative_to='shelf'>"), "relative_to 'shelf'"),
        ("<a>" * 101 + "</a>" * 101, "nests deeper"),
        (sdf(model(shape="")), "geometry is missing"),
        (sdf(model(shape="<cylinder><radius>-1</radius></cylinder>")), "radius is '-1'"),
        (sdf(model(shape="<cylinder><radius>nan</radius></cylinder>")), "radius is 'nan'"),
        (sdf(model(shape="<cylinder/>")), "radius is ''"),
        (sdf(model("1 2 0")), "pose is '1 2 0'"),
        (sdf(model("1 x 0 0 0 0")), "pose is '1 x 0 0 0 0'"),
        (sdf(model("1 inf 0 0 0 0")), "pose is"),
        (sdf(model("1e300 2 0 0 0 0")), "pose is"),
        (sdf(model("1 2 0 1.57 0 0")), "upright"),
        (sdf(model(static=0)), "static is '0'"),
    ],
)
def test_bad_world_file_is_said_in_one_line_with_its_name(tmp_path: Path, text: str, said: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(InputFileError) as error:
        read_sdf(path)
    assert str(path) in str(error.value)
    assert said in str(error.value)
    assert "allowed: " in str(error.value)
    assert "\n" not in str(error.value)


def test_damaged_and_endless_gzip_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "world_0.world.gz"
    for content in (b"no gzip", gzip.compress(sdf(model()).encode())[:-9]):
        path.write_bytes(content)
        with pytest.raises(InputFileError, match="gzip"):
            read_sdf(path)
    path.write_bytes(gzip.compress(bytes(30_000_000)))
    with pytest.raises(InputFileError, match="larger than"):
        read_sdf(path)


def test_missing_path_names_what_is_allowed(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"world\.path is null"):
        source(None)
    for path in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(InputFileError, match="folder of them"):
            source(path)
    with pytest.raises(ConfigurationError, match=r"world\.path_files"):
        source(written(tmp_path, sdf(model())), path_files=str(tmp_path / "nowhere"))


def test_folder_is_sorted_by_number_and_used_again_and_again(tmp_path: Path) -> None:
    for number in (10, 9, 100):
        written(tmp_path, sdf(model(f"{number} 0 0 0 0 0")), f"world_{number}.world")
    (tmp_path / "notes.txt").write_text("no world")
    assert [path.name for path in world_files(tmp_path)] == ["world_9.world", "world_10.world", "world_100.world"]
    worlds = source(tmp_path)
    assert [worlds.world(0, k).name for k in range(4)] == [
        "barn/world_9",
        "barn/world_10",
        "barn/world_100",
        "barn/world_9",
    ]
    assert worlds.world(0, 0).grid is worlds.world(7, 3).grid
    assert not worlds.world(0, 0).known
    assert worlds.world(0, 0).reference_xy is None


@settings(derandomize=True, deadline=None)
@given(
    x=st.floats(-50, 50),
    y=st.floats(-50, 50),
    radius=st.floats(0.05, 0.5),
    resolution=st.sampled_from((0.01, 0.025, 0.05)),
)
def test_a_cell_is_occupied_where_its_centre_is_in_the_disc(
    x: float, y: float, radius: float, resolution: float
) -> None:
    grid = disc_grid([(x, y, radius)], resolution, 0.3)
    centres = grid.positions(np.moveaxis(np.indices(grid.data.shape), 0, -1))
    away = np.hypot(centres[..., 0] - x, centres[..., 1] - y) - radius
    assert grid.occupied[away < -1e-9].all()
    assert not grid.occupied[away > 1e-9].any()
    assert abs(grid.occupied.sum() * resolution**2 - math.pi * radius**2) < 4.0 * math.pi * radius * resolution
    assert not grid.occupied[[0, -1]].any()
    assert not grid.occupied[:, [0, -1]].any()


def test_cells_larger_than_a_radius_are_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"resolution is 0\.1; allowed: up to .* 0\.075"):
        disc_grid([(0.0, 0.0, 0.075)], 0.1, 1.0)
    with pytest.raises(ConfigurationError, match="cells"):
        disc_grid([(0.0, 0.0, 0.075), (5000.0, 5000.0, 0.075)], 0.01, 1.0)


@pytest.mark.parametrize(
    ("array", "said"),
    [(np.zeros((3, 3), int), "shape"), (np.zeros((0, 2), int), "shape"), (np.zeros((3, 2)), "type is float64")],
)
def test_bad_reference_path_is_said_in_one_line(tmp_path: Path, array: np.ndarray, said: str) -> None:
    np.save(tmp_path / "path_0.npy", array)
    with pytest.raises(InputFileError, match=said):
        read_reference_path(tmp_path / "path_0.npy")


def test_reference_path_that_is_missing_or_pickled_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="cannot be read"):
        read_reference_path(tmp_path / "path_0.npy")
    np.save(tmp_path / "path_0.npy", np.array([{}], object), allow_pickle=True)
    with pytest.raises(InputFileError, match="is no NumPy file"):
        read_reference_path(tmp_path / "path_0.npy")
    (tmp_path / "path_0.npy").write_bytes(b"")
    with pytest.raises(InputFileError, match="path_0"):
        read_reference_path(tmp_path / "path_0.npy")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("folder", "number"), [(DRAWN, 2), pytest.param(BARN, 25, marks=needs_barn)], ids=["drawn", "real"]
)
def test_every_world_is_closed_on_three_sides_and_its_reference_path_is_free(folder: Path, number: int) -> None:
    worlds = source(folder / "world_files", margin=5.0)
    files = world_files(folder / "world_files")
    assert len(files) == number
    for k, file in enumerate(files):
        world = worlds.world(0, k)
        assert world.name == f"barn/{file.name.split('.')[0]}"
        free = distance_field(world.grid.occupied, world.grid.resolution)
        assert world.reference_xy is not None
        way = np.vstack(((-2.0, 3.0), world.reference_xy, (-2.0, 13.0)))
        cells = world.grid.cells(way)
        assert world.grid.contains(cells).all()
        assert free[cells[:, 0], cells[:, 1]].min() > 0.165  # the Jackal's inscribed radius fits everywhere on it
        assert (np.hypot(*np.diff(world.reference_xy, axis=0).T) < 0.22).all()  # neighbouring cells
        assert (np.diff(world.reference_xy[:, 1]) >= -0.16).all()  # it leads upwards, row by row or aside
        assert world.reference_xy[[0, -1], 1] == pytest.approx((5.075, 9.425))
        walls = (
            [(-4.425, y) for y in (1.0, 3.0)]
            + [(-0.075, y) for y in (1.0, 3.0)]
            + [(x, 0.075) for x in (-4.0, -2.0, -1.0)]
        )
        assert world.grid.occupied[tuple(world.grid.cells(walls).T)].all()


@pytest.mark.parametrize(
    ("folder", "number"), [(DRAWN, 230), pytest.param(BARN, 209, marks=needs_barn)], ids=["drawn", "real"]
)
def test_world_0_has_its_cylinders_and_no_more(folder: Path, number: int) -> None:
    solids = read_sdf(folder / "world_files" / "world_0.world.gz")
    assert len(solids.cylinders) == number
    assert len(solids.boxes) == 0
    assert (solids.cylinders[:, 2] == 0.075).all()
    grid = grid_of(solids, 0.025, 5.0)
    assert grid.occupied.sum() == number * 32  # a disc of three cells' radius, between cells
