"""A grid survives the world files of Gazebo and MuJoCo, and what cannot be read is said in one line."""

import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from arena_core import FREE, OCCUPIED, InputFileError, OccupancyGrid, Pose, wrap_angle
from arena_core.scenes import cover_with_rectangles
from arena_worlds.formats.mjcf import read_mjcf
from arena_worlds.formats.mjcf_writer import mjcf_text
from arena_worlds.formats.sdf import read_sdf
from arena_worlds.formats.sdf_writer import sdf_text
from arena_worlds.formats.solids import Solids, grid_of, solids_of

masks = arrays.arrays(bool, st.tuples(st.integers(1, 12), st.integers(1, 12)))
origins = st.builds(Pose, st.floats(-50, 50), st.floats(-50, 50), st.floats(-math.pi, math.pi))
resolutions = st.sampled_from((0.05, 0.1, 0.046, 1.0))


BOXES = np.array([[1.0, 2.0, 0.3, 4.0, 0.2], [0.0, 0.0, 0.0, 1.0, 1.0]])
CYLINDERS = np.array([[3.0, 1.0, 0.25]])
FORMATS = [
    pytest.param(".sdf", sdf_text, read_sdf, id="gazebo"),
    pytest.param(".xml", mjcf_text, read_mjcf, id="mujoco"),
]
TOKENS = [
    "",
    "<",
    ">",
    "/>",
    "nan",
    "1e999",
    "-1",
    "0",
    "1 2",
    "box",
    "plane",
    "<include/>",
    "<joint/>",
    "<pose>1</pose>",
    "\0",
    "&a;",
    '"',
]


def grid(mask: np.ndarray, resolution: float = 0.1, origin: Pose | None = None) -> OccupancyGrid:
    return OccupancyGrid(np.where(mask, OCCUPIED, FREE).astype(np.int8), resolution, origin or Pose(0.0, 0.0))


def assert_same(found: OccupancyGrid, given: OccupancyGrid) -> None:
    assert found.resolution == given.resolution
    assert found.origin.distance(given.origin) < 1e-9
    assert abs(wrap_angle(found.origin.theta - given.origin.theta)) < 1e-9
    assert np.array_equal(found.occupied, given.occupied)


@given(mask=masks)
def test_rectangles_hold_each_occupied_cell_once(mask: np.ndarray) -> None:
    count = np.zeros(mask.shape, int)
    for first_row, first_column, end_row, end_column in cover_with_rectangles(mask):
        count[first_row:end_row, first_column:end_column] += 1
    assert np.array_equal(count, mask.astype(int))


def test_a_wall_is_one_rectangle_and_a_frame_is_four() -> None:
    wall = np.zeros((20, 30), bool)
    wall[3:17, 5:7] = True
    assert cover_with_rectangles(wall).tolist() == [[3, 5, 17, 7]]
    frame = np.ones((20, 30), bool)
    frame[2:-2, 2:-2] = False
    assert len(cover_with_rectangles(frame)) == 4
    assert cover_with_rectangles(np.zeros((3, 4), bool)).shape == (0, 4)


@given(mask=masks, origin=origins, resolution=resolutions)
@settings(deadline=None, max_examples=40)
def test_a_grid_survives_gazebo_and_mujoco(tmp_path_factory: pytest.TempPathFactory, mask, origin, resolution) -> None:
    folder = tmp_path_factory.getbasetemp()
    given_grid = grid(mask, resolution, origin)
    for name, text, read in (("w.sdf", sdf_text, read_sdf), ("w.xml", mjcf_text, read_mjcf)):
        path = folder / name
        path.write_text(text(solids_of(given_grid).raised(2.0), "w"))
        assert_same(grid_of(read(path), resolution, 1.0), given_grid)


def test_mujoco_loads_the_model_and_its_rays_end_at_the_walls(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    mask = np.zeros((40, 60), bool)
    mask[10:30, 20] = True
    given_grid = grid(mask, 0.1, Pose(1.0, -2.0, 0.5))
    model = mujoco.MjModel.from_xml_string(mjcf_text(solids_of(given_grid).raised(1.5), "w"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert (model.ngeom, model.nq) == (2, 0)
    for row, column in ((12, 20), (12, 25), (35, 20)):
        x, y = given_grid.positions((row, column))
        hit = np.zeros(1, np.int32)
        away = mujoco.mj_ray(model, data, np.array((x, y, 5.0)), np.array((0.0, 0.0, -1.0)), None, 1, -1, hit, None)
        assert away == pytest.approx(3.5 if mask[row, column] else 5.0)


@pytest.mark.parametrize(("ending", "text", "read"), FORMATS)
@pytest.mark.parametrize("size", [None, (6.0, 5.0)])
def test_turned_boxes_and_cylinders_survive(tmp_path: Path, ending, text, read, size) -> None:
    given_solids = Solids(Pose(0.0, 0.0) if size is None else Pose(-2.0, 1.0, 0.7), size, BOXES, CYLINDERS)
    (tmp_path / f"w{ending}").write_text(text(given_solids.raised(2.0), "w"))
    found = read(tmp_path / f"w{ending}")
    assert found.boxes == pytest.approx(BOXES)
    assert found.cylinders == pytest.approx(CYLINDERS)
    assert found.size == (size and pytest.approx(size))
    assert found.origin.array() == pytest.approx(given_solids.origin.array())


# the children that SDF 1.6 requires of an element, and those that it allows beside them among what is written here
SPECIFICATION: dict[str, tuple[set[str], set[str]]] = {
    "sdf": ({"world"}, set()),
    "world": (set(), {"light", "model"}),
    "light": ({"diffuse", "specular", "direction"}, {"cast_shadows", "pose"}),
    "model": ({"link"}, {"static", "pose"}),
    "link": (set(), {"pose", "collision", "visual"}),
    "collision": ({"geometry"}, {"pose"}),
    "visual": ({"geometry"}, {"pose", "material"}),
    "geometry": (set(), {"box", "cylinder", "plane"}),
    "box": ({"size"}, set()),
    "cylinder": ({"radius", "length"}, set()),
    "plane": ({"normal", "size"}, set()),
    "material": (set(), {"ambient", "diffuse"}),
}
ATTRIBUTES = {
    "sdf": {"version"},
    "light": {"name", "type"},
    **{tag: {"name"} for tag in ("world", "model", "link", "collision", "visual")},
}


def test_a_gazebo_world_has_the_elements_of_the_specification() -> None:
    root = ElementTree.fromstring(sdf_text(Solids(Pose(1.0, 2.0, 0.5), (9.0, 9.0), BOXES, CYLINDERS).raised(2.0), "w"))
    for element in root.iter():
        required, allowed = SPECIFICATION.get(element.tag, (set(), set()))
        tags = [child.tag for child in element]
        assert required <= set(tags) <= required | allowed
        assert set(element.attrib) == ATTRIBUTES.get(element.tag, set())
        names = [child.get("name") for child in element if "name" in child.attrib]
        assert len(names) == len(set(names))
        assert all(tags.count(tag) == 1 for tag in set(tags) - {"model", "collision", "visual"})


@given(
    x=st.floats(-20, 20), y=st.floats(-20, 20), yaw=st.floats(-4, 4), length=st.floats(0.1, 3), width=st.floats(0.1, 3)
)
@settings(deadline=None)
def test_a_cell_is_occupied_where_its_centre_is_in_the_turned_box(
    x: float, y: float, yaw: float, length: float, width: float
) -> None:
    found = grid_of(Solids(Pose(0.0, 0.0), None, np.array([(x, y, yaw, length, width)]), np.empty((0, 3))), 0.1, 0.3)
    delta = found.positions(np.moveaxis(np.indices(found.data.shape), 0, -1)) - (x, y)
    along = np.abs(math.cos(yaw) * delta[..., 0] + math.sin(yaw) * delta[..., 1]) - 0.5 * length
    across = np.abs(math.cos(yaw) * delta[..., 1] - math.sin(yaw) * delta[..., 0]) - 0.5 * width
    assert found.occupied[np.maximum(along, across) < -1e-6].all()
    assert not found.occupied[np.maximum(along, across) > 1e-6].any()
    assert not found.occupied[[0, -1]].any()
    assert not found.occupied[:, [0, -1]].any()


MJCF = "<mujoco>{head}<worldbody><body pos='1 2 0' {turn}>{joint}<geom {geom}/></body></worldbody></mujoco>"
BOX = "type='box' size='1 2 3' pos='1 0 3'"


def mjcf(geom: str = BOX, head: str = "", turn: str = "", joint: str = "") -> str:
    return MJCF.format(geom=geom, head=head, turn=turn, joint=joint)


@pytest.mark.parametrize(
    ("turn", "head"),
    [
        ("euler='0 0 90'", ""),
        ("euler='0 0 1.5707963267948966'", "<compiler angle='radian'/>"),
        ("quat='1 0 0 1'", "<compiler/>"),
    ],
)
def test_mujoco_places_geoms_by_degrees_radians_and_quaternions(tmp_path: Path, turn: str, head: str) -> None:
    (tmp_path / "w.xml").write_text(mjcf(head=head, turn=turn))
    assert read_mjcf(tmp_path / "w.xml").boxes == pytest.approx(np.array([[1.0, 3.0, math.pi / 2, 2.0, 4.0]]))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<sdf/>", "0 elements mujoco/worldbody"),
        (mjcf(head="<include file='robot.xml'/>"), "element include is there"),
        (mjcf(head="<default><geom type='box'/></default>"), "element default is there"),
        (mjcf(head="<compiler angle='turns'/>"), "angle is 'turns'; allowed: degree or radian"),
        (mjcf(head="<compiler eulerseq='ZYX'/>"), "eulerseq is 'ZYX'; allowed: xyz"),
        (mjcf(joint="<freejoint/>"), "its body has joints"),
        (mjcf("size='1'"), "type is 'sphere'; allowed: box"),
        (mjcf("type='box' size='1 2'"), "size is '1 2'; allowed: 3 numbers"),
        (mjcf("type='box' size='1 0 2'"), "size is '1 0 2'; allowed: numbers > 0"),
        (mjcf("type='box' fromto='0 0 0 1 0 0' size='1 1 1'"), "fromto is there"),
        (mjcf(f"{BOX} class='wall'"), "class is there"),
        (mjcf(turn="euler='45 0 0'"), "it is tilted"),
        (mjcf(turn="quat='1 1 0 0'"), "it is tilted"),
        (mjcf("type='plane' size='1 1 1'"), "holds no cylinder and no box"),
        (mjcf(f"{BOX} contype='0' conaffinity='0'"), "holds no cylinder and no box"),
    ],
)
def test_bad_mujoco_model_is_said_in_one_line(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "w.xml").write_text(text)
    with pytest.raises(InputFileError) as error:
        read_mjcf(tmp_path / "w.xml")
    assert str(tmp_path / "w.xml") in str(error.value)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("ending", "text", "read"), FORMATS)
@given(
    cuts=st.lists(st.tuples(st.integers(0, 4000), st.integers(0, 40), st.sampled_from(TOKENS)), min_size=1, max_size=3)
)
@settings(deadline=None, max_examples=150)
def test_a_spoilt_world_file_is_read_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, ending, text, read, cuts
) -> None:
    content = text(Solids(Pose(1.0, 2.0, 0.5), (9.0, 9.0), BOXES, CYLINDERS).raised(2.0), "w")
    for place, length, token in cuts:
        place %= len(content)
        content = content[:place] + token + content[place + length :]
    path = tmp_path_factory.getbasetemp() / f"spoilt{ending}"
    path.write_text(content)
    said = None
    try:
        assert np.isfinite(read(path).boxes).all()
    except InputFileError as error:
        said = str(error)
    assert said is None or (str(path) in said and "\n" not in said)
