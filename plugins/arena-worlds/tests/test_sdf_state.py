"""Gazebo worlds as they are saved today: what stood where when they were saved, includes of
Fuel, the rounding of solvers.
"""

import math
from pathlib import Path

import numpy as np
import pytest

from arena_core import InputFileError
from arena_core.cli.main import main
from arena_worlds.formats.mjcf import read_mjcf
from arena_worlds.formats.ros_map import load_map
from arena_worlds.formats.sdf import read_sdf
from arena_worlds.formats.site_file import site_grid

STRANGERS = Path(__file__).parents[3].parent / "shared" / "data" / "strangers" / "worlds"
needs_strangers = pytest.mark.skipif(
    not STRANGERS.is_dir(), reason="worlds of others are not at ../shared/data/strangers"
)
BOX = "<collision name='c'><geometry><box><size>2 0.2 1</size></box></geometry></collision>"


def model(name: str = "m", pose: str = "1 2 0 0 0 0", within: str = "") -> str:
    links = f"<link name='a'><pose>0 1 0 0 0 0</pose>{BOX}</link><link name='b'><pose>0 -1 0 0 0 0</pose>{BOX}</link>"
    return f"<model name='{name}'><static>1</static><pose>{pose}</pose>{links}{within}</model>"


def state(*moved: str) -> str:
    return f"<state world_name='w'><sim_time>3 0</sim_time>{''.join(moved)}</state>"


def read(folder: Path, *parts: str) -> list[list[float]]:
    """Return x, y and yaw of the boxes of a world."""
    path = folder / "w.world"
    path.write_text(f"<sdf version='1.6'><world name='w'>{''.join(parts)}</world></sdf>")
    boxes: list[list[float]] = read_sdf(path).boxes[:, :3].tolist()
    return boxes


def refused(folder: Path, *parts: str) -> str:
    with pytest.raises(InputFileError) as error:
        read(folder, *parts)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_a_model_stands_where_the_saved_state_has_it(tmp_path: Path) -> None:
    moved = state(f"<model name='m'><pose frame=''>6 7 0 0 -0 {math.pi / 2}</pose><scale>1 1 1</scale></model>")
    assert read(tmp_path, model(), model("other"), moved) == pytest.approx(
        np.array([[5, 7, math.pi / 2], [7, 7, math.pi / 2], [1, 3, 0], [1, 1, 0]])
    )


def test_a_link_stands_where_the_saved_state_has_it_in_the_world(tmp_path: Path) -> None:
    moved = state("<model name='m'><pose>6 7 0 0 0 0</pose><link name='a'><pose>9 9 0 0 0 0.5</pose></link></model>")
    assert read(tmp_path, moved, model()) == [[9, 9, 0.5], [6, 6, 0]]
    only_link = state(
        "<model name='m'><link name='a'><pose>9 9 0 0 0 0.5</pose><velocity>0 0 0 0 0 0</velocity></link></model>"
    )
    assert read(tmp_path, model(), only_link) == [[9, 9, 0.5], [1, 1, 0]]


def test_a_model_in_a_model_stands_where_the_saved_state_has_it(tmp_path: Path) -> None:
    moved = state("<model name='m'><pose>6 7 0 0 0 0</pose><model name='in'><pose>20 0 0 0 0 0</pose></model></model>")
    assert read(tmp_path, model(within=model("in")), moved)[2:] == [[20, 1, 0], [20, -1, 0]]
    assert read(tmp_path, model(within=model("in")), state("<model name='in'><pose>20 0 0 0 0 0</pose></model>"))[
        2:
    ] == [
        [2, 5, 0],
        [2, 3, 0],
    ]


def test_the_first_state_counts_and_models_of_nowhere_do_not(tmp_path: Path) -> None:
    first, second = (state(f"<model name='{name}'><pose>6 7 0 0 0 0</pose></model>") for name in ("gone", "m"))
    assert read(tmp_path, model(), first, second) == [[1, 3, 0], [1, 1, 0]]


@pytest.mark.parametrize(
    ("moved", "said"),
    [
        ("<model name='m'><pose>6 7 0 0 0</pose></model>", "pose is '6 7 0 0 0'; allowed: six numbers"),
        ("<model name='m'><pose>6 7 0 1.5 0 0</pose></model>", "upright"),
        (
            "<model name='m'><scale>7.5 0.15 1</scale></model>",
            "state of model 'm': scale is '7.5 0.15 1'; allowed: 1 1 1",
        ),
        ("<insertions><model name='n'/></insertions>", "state/insertions is there; allowed"),
        ("<deletions><name>m</name></deletions>", "state/deletions is there; allowed"),
    ],
)
def test_a_state_that_is_not_read_is_said_in_one_line(tmp_path: Path, moved: str, said: str) -> None:
    assert said in refused(tmp_path, model(), state(moved))


@pytest.mark.parametrize(
    "uri",
    [
        "model://sun",
        "model://ground_plane/",
        "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground Plane",
        "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground%20Plane/2",
        "https://fuel.ignitionrobotics.org/1.0/openrobotics/models/sun/tip",
        "http://app.gazebosim.org/OpenRobotics/fuel/models/Sun",
    ],
)
def test_ground_and_sun_of_gazebo_and_fuel_are_harmless(tmp_path: Path, uri: str) -> None:
    assert len(read(tmp_path, f"<include>\n<uri>\n {uri} </uri></include>", model())) == 2


@pytest.mark.parametrize(
    "uri",
    [
        "model://sunflower",
        "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Warehouse",
        "https://fuel.gazebosim.org/1.0/somebody/models/Sun",
        "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun/../Ab",
        "",
    ],
)
def test_another_include_is_refused_in_a_world_and_in_a_model(tmp_path: Path, uri: str) -> None:
    include = f"<include><uri>{uri}</uri></include>"
    assert f"world 'w': include is '{uri}'; allowed" in refused(tmp_path, include, model())
    assert f"model 'm': include is '{uri}'; allowed" in refused(tmp_path, model(within=include))


def test_a_population_of_models_is_refused(tmp_path: Path) -> None:
    assert "population 'cans' is there; allowed" in refused(tmp_path, model(), "<population name='cans'/>")


@pytest.mark.parametrize("tilt", [-2e-6, 2.2e-5, -1e-4, 0.005])
def test_what_a_solver_leaves_of_a_tilt_is_upright(tmp_path: Path, tilt: float) -> None:
    assert read(tmp_path, model(pose=f"1 2 0 {tilt} {-tilt} 0")) == [[1, 3, 0], [1, 1, 0]]
    geom = f"<geom type='box' size='1 .1 1' euler='{tilt} {tilt} 0'/>"
    (tmp_path / "m.xml").write_text(f"<mujoco><compiler angle='radian'/><worldbody>{geom}</worldbody></mujoco>")
    assert read_mjcf(tmp_path / "m.xml").boxes.tolist() == [[0, 0, 0, 2, 0.2]]


def test_a_wall_that_leans_is_refused(tmp_path: Path) -> None:
    assert "upright" in refused(tmp_path, model(pose="1 2 0 0.02 0 0"))


@needs_strangers
@pytest.mark.parametrize(
    ("name", "origin"),
    [
        ("fuel_ground", (-6.1, -4.6)),
        ("fuel_ignition", (-6.1, -4.6)),
        ("micro_roll", (-6.1, -4.6)),
        ("state_moved", (-1.1, 0.9)),
    ],
)
def test_worlds_of_others_stand_where_gazebo_shows_them(name: str, origin: tuple[float, float]) -> None:
    found = site_grid(STRANGERS / f"{name}.world", 0.05, 1.0)
    assert found.origin.array()[:2] == pytest.approx(origin)
    assert found.data.tolist() == site_grid(STRANGERS / "fuel_ground.world", 0.05, 1.0).data.tolist()


@pytest.mark.parametrize("name", ["x.world.yaml", "map.world.yaml", "x.sdf.yaml"])
def test_a_converted_map_is_read_back_by_whatever_name(tmp_path: Path, name: str) -> None:
    read(tmp_path, model())
    assert main(["world", "convert", str(tmp_path / "w.world"), str(tmp_path / name)]) == 0
    assert load_map(tmp_path / name).data.tolist() == site_grid(tmp_path / "w.world", 0.05, 1.0).data.tolist()


def turned(pose: str, attributes: str) -> str:
    return f"<model name='m'><static>1</static><pose {attributes}>{pose}</pose><link name='a'>{BOX}</link></model>"


@pytest.mark.parametrize(
    ("pose", "attributes"),
    [
        ("1 2 0 0 0 1.5707963267948966", ""),
        ("1 2 0 0 0 90", "degrees='true'"),
        ("1 2 0 0 0 90", "degrees='1' rotation_format='euler_rpy'"),
        ("1 2 0 0 0 1.5707963267948966", "degrees='false'"),
        ("1 2 0 0 0 0.7071067811865476 0.7071067811865476", "rotation_format='quat_xyzw'"),
        ("1 2 0 0 0 -3 -3", "rotation_format='quat_xyzw' degrees='false'"),
    ],
)
def test_poses_in_degrees_and_by_quaternions_are_read(tmp_path: Path, pose: str, attributes: str) -> None:
    assert np.allclose(read(tmp_path, turned(pose, attributes)), [[1.0, 2.0, math.pi / 2]])


@pytest.mark.parametrize(
    ("pose", "attributes", "said"),
    [
        ("1 2 0 0 0 0 0", "rotation_format='quat_xyzw'", "allowed: seven numbers x y z qx qy qz qw"),
        ("1 2 0 0 0 1", "rotation_format='quat_xyzw'", "allowed: seven numbers"),
        ("1 2 0 0.5 0 0 0.8", "rotation_format='quat_xyzw'", "allowed: 0, upright"),
        ("1 2 0 5 0 0", "degrees='true'", "allowed: 0, upright"),
        ("1 2 0 0 0 0", "degrees='gradian'", "allowed: true or false or 1 or 0"),
        ("1 2 0 0 0 0", "relative_to='world'", "allowed: none"),
    ],
)
def test_poses_of_other_forms_are_refused(tmp_path: Path, pose: str, attributes: str, said: str) -> None:
    assert said in refused(tmp_path, turned(pose, attributes))
