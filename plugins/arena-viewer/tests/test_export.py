"""Records in the forms of other programs: what is written says what the record says."""

import json
import math

import numpy as np
import pytest

import arena_core as arena
from arena_core import ConfigurationError, EpisodeRecord, InputFileError, OccupancyGrid, Pose
from arena_core.records import read_grid, read_record, record_digest, record_path
from arena_export.command import ExportCommand
from arena_export.socnav import facings, trajectory_name, trajectory_of
from arena_export.walls import wall_segments


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Drive two short episodes among three people."""
    where = tmp_path_factory.mktemp("export") / "run"
    words = ["planner=pure_pursuit", "robot=jackal", "world=empty", "world.width=8", "world.height=8"]
    more = ["task.pedestrians=3", "episodes=2", "executor=serial", "localizer=ground_truth", "report=false"]
    arena.run([*words, *more], where)
    return where


@pytest.fixture
def record(folder):
    return read_record(record_path(folder, 0))


@pytest.fixture
def trajectory(folder, record):
    return trajectory_of(record, read_grid(folder / record.meta["world"]["grid"]))


def test_a_trajectory_has_a_row_for_each_of_the_record(record, trajectory):
    rows = trajectory["sequence"]
    assert [row["timestamp"] for row in rows] == pytest.approx(record["stamp"].tolist(), abs=1e-4)
    poses = [[row["robot"][key] for key in ("x", "y", "angle")] for row in rows]
    assert np.array(poses) == pytest.approx(record["pose"], abs=1e-4)


def test_speeds_are_those_along_the_axes_of_the_map(record):
    rows = len(record["stamp"])
    pose, twist = np.tile((0.0, 0.0, math.pi / 2), (rows, 1)), np.tile((1.0, 0.25, 0.5), (rows, 1))
    driven = EpisodeRecord({**record.arrays, "pose": pose, "twist": twist}, record.meta, {})
    robot = trajectory_of(driven, None)["sequence"][0]["robot"]  # it faces north: its left is west
    assert [robot[key] for key in ("speed_x", "speed_y", "speed_a")] == [-0.25, 1.0, 0.5]


def test_people_stand_where_they_stood_and_are_called_as_before(record, trajectory):
    row = trajectory["sequence"][5]
    assert [person["id"] for person in row["people"]] == record["pedestrian_ids"].tolist()
    places = [[person["x"], person["y"]] for person in row["people"]]
    assert np.array(places) == pytest.approx(record["pedestrian_positions"][5], abs=1e-3)


def test_goal_robot_and_grid_are_told_as_the_layout_has_them(trajectory, record):
    row = trajectory["sequence"][0]
    assert row["robot"]["shape"] == {"type": "rectangle", "width": 0.33, "length": 0.42}
    assert (row["robot"]["drive"], row["goal"]["type"], row["goal"]["human"]) == ("differential", "go-to", None)
    assert row["goal"]["pos_threshold"] == record.meta["scenario"]["goal_radius"]
    assert (row["goal"]["x"], row["goal"]["y"]) == pytest.approx(record.meta["scenario"]["goal"][:2], abs=1e-4)
    grid = trajectory["grid"]
    assert np.shape(grid["data"]) == (grid["height"], grid["width"])


def test_the_first_row_of_the_grid_is_the_top_of_the_map(record):
    cells = np.zeros((2, 3), np.int8)
    cells[0, 0], cells[1, 2] = 100, -1
    grid = trajectory_of(record, OccupancyGrid(cells, 0.5, Pose(1.0, 2.0, 0.0)))["grid"]
    assert grid["data"] == [[0, 0, -1], [1, 0, 0]]
    assert (grid["x_orig"], grid["y_orig"], grid["cell_size"]) == (1.0, 2.0, 0.5)


def test_each_straight_side_of_a_wall_is_one_segment():
    cells = np.zeros((4, 5), np.int8)
    cells[1:3, 1:4] = 100
    segments = wall_segments(OccupancyGrid(cells, 0.5, Pose(1.0, 2.0, 0.0)))
    sides = {(1.5, 2.5, 3.0, 2.5), (1.5, 3.5, 3.0, 3.5), (1.5, 2.5, 1.5, 3.5), (3.0, 2.5, 3.0, 3.5)}
    assert {tuple(segment) for segment in segments.tolist()} == sides
    assert len(segments) == 4


def test_walls_turn_with_the_map():
    segments = wall_segments(OccupancyGrid(np.full((1, 2), 100, np.int8), 1.0, Pose(0.0, 0.0, math.pi / 2)))
    ends = {tuple(np.round(segment, 9) + 0.0) for segment in segments.tolist()}
    assert (0.0, 0.0, 0.0, 2.0) in ends
    assert (-1.0, 0.0, -1.0, 2.0) in ends


def test_who_stands_faces_the_way_that_was_walked():
    north, still, east = (0.0, 1.0), (0.01, 0.0), (1.0, 0.0)
    walked = np.array([[still, still], [north, still], [still, still], [east, still]])
    assert facings(walked)[:, 0] == pytest.approx([math.pi / 2, math.pi / 2, math.pi / 2, 0.0])
    assert facings(walked)[:, 1].tolist() == [0.0] * 4


def made(record, **scenario):
    return EpisodeRecord(record.arrays, {**record.meta, "scenario": {**record.meta["scenario"], **scenario}}, {})


def test_who_is_not_there_is_left_out(record):
    places = record["pedestrian_positions"].copy()
    places[0, 1] = np.nan
    gone = EpisodeRecord({**record.arrays, "pedestrian_positions": places}, record.meta, {})
    ids = record["pedestrian_ids"].tolist()
    rows = trajectory_of(gone, None)["sequence"]
    assert [person["id"] for person in rows[0]["people"]] == [ids[0], ids[2]]
    assert [person["id"] for person in rows[1]["people"]] == ids


def test_a_robot_that_follows_or_leads_names_the_person(record):
    for manner, kind in (("follow", "follow"), ("lead", "guide-to"), ("accompany", "go-to")):
        goal = trajectory_of(made(record, company={"manner": manner, "person": 2}), None)["sequence"][0]["goal"]
        assert (goal["type"], goal["human"]) == (kind, 2)


def test_obstacles_and_furniture_are_objects_with_a_shape(record):
    square = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]]
    corner = [[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]]
    obstacles = [
        {"vertices_xy": [[3.0, 4.0]], "radius": 0.25},
        {"vertices_xy": square, "radius": 0.0},
        {"vertices_xy": corner, "radius": 0.0},
    ]
    table = {
        "kind": "table",
        "pose": [5.0, 6.0, 0.5],
        "boxes": [[0.0, 0.0, 0.0, 1.2, 0.8, 0.7, 0.75]],
        "cylinders": [[0.5, 0.3, 0.05, 0.0, 0.7]],
    }
    objects = trajectory_of(made(record, obstacles=obstacles, furniture=[table]), None)["sequence"][0]["objects"]
    assert [(thing["id"], thing["x"], thing["y"]) for thing in objects] == [
        (0, 3.0, 4.0),
        (1, 1.5, 1.5),
        (2, 1.0, 0.5),
        (3, 5.0, 6.0),
    ]
    shapes = [thing["shape"] for thing in objects]
    assert shapes[0] == {"type": "circle", "width": 0.5, "length": 0.5}
    assert shapes[1] == {"type": "rectangle", "width": 1.0, "length": 1.0}
    assert shapes[2]["points"] == [[-1.0, -0.5], [1.0, -0.5], [-1.0, 0.5]]
    assert shapes[3] == {"type": "rectangle", "width": 0.8, "length": 1.2}


def test_the_command_writes_a_file_an_episode_whose_name_ends_in_the_digest(folder, record, tmp_path):
    assert ExportCommand().run([str(folder), "--to", "socnav.json", f"out={tmp_path / 'rated'}"]) == 0
    names = sorted(path.name for path in (tmp_path / "rated").iterdir())
    assert len(names) == 2
    assert names[0] == f"{trajectory_name(record)}.json"
    assert names[0].endswith(f"-0000-{record_digest(record)}.json")
    assert json.loads((tmp_path / "rated" / names[0]).read_text())["metadata"]["episode"] == 0


def test_the_command_writes_the_named_episodes_alone(folder, tmp_path):
    ExportCommand().run([str(folder), "1", "to=socnav.json", f"out={tmp_path / 'one'}"])
    assert ["-0001-" in path.name for path in (tmp_path / "one").iterdir()] == [True]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["7", "to=socnav.json"], "EPISODE is 7; allowed: 0, 1"),
        (["x", "to=socnav.json"], "EPISODE"),
        ([], "to is missing"),
        (["to=socnav.json", "out=."], ". is there already; allowed: a name that is free"),
    ],
)
def test_what_cannot_be_exported_is_one_line(folder, words, said):
    with pytest.raises(ConfigurationError, match=said) as refused:
        ExportCommand().run([str(folder), *words])
    assert "\n" not in str(refused.value)


def test_a_folder_without_records_is_one_line(folder, tmp_path):
    empty = tmp_path / "run"
    empty.mkdir()
    (empty / "episodes.csv").write_text((folder / "episodes.csv").read_text())
    with pytest.raises(InputFileError, match="has no record"):
        ExportCommand().run([str(empty), "to=socnav.json"])


def test_help_names_the_forms(capsys):
    assert ExportCommand().run(["--help"]) == 0
    assert "socnav.json" in capsys.readouterr().out
