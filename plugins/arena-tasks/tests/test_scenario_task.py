"""Problems of a file come in its order, and what cannot be run is said with file and key."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from arena_core import (
    ConfigurationError,
    ImpossibleScenario,
    InputFileError,
    OccupancyGrid,
    Pose,
    Robot,
    World,
    WorldSource,
    testing,
)
from arena_core.testing import check
from arena_tasks.commands.converting import ConvertCommand
from arena_tasks.scenario_files.scenario_file import save_scenarios
from arena_tasks.scenario_files.scenario_task import ScenarioTask

ROOM = testing.room(10.0)  # its centre is the origin


class Fixed(WorldSource):
    def __init__(self, grid: OccupancyGrid) -> None:
        self._world = World("fixed", grid)

    def world(self, seed: int, index: int) -> World:
        return self._world


class Changing(WorldSource):
    """Give a room for even and solid rock for odd scenarios."""

    def world(self, seed: int, index: int) -> World:
        return World("changing", ROOM if index % 2 == 0 else OccupancyGrid(np.full((9, 9), 100), 1.0, Pose(-4.5, -4.5)))


def problem(name: str = "one", **changes: object) -> dict[str, Any]:
    return {"name": name, "start": [-3.0, 0.0], "goal": [3.0, 0.0], **changes}


def make(
    folder: Path, *problems: dict[str, Any], world: WorldSource | None = None, robot: Robot | None = None
) -> ScenarioTask:
    path = folder / "problem.json"
    path.write_text(json.dumps({"format": "arena-scenario", "version": 1, "scenarios": problems}))
    return ScenarioTask(robot or testing.robot(), world or Fixed(ROOM), str(path), 0.3, 0.3, 0.25, 120.0)


def divided(gap: float) -> OccupancyGrid:
    """Return the room with a wall at x = 0 and a gap in it, m."""
    data = ROOM.data.copy()
    data[:, 99:101] = 100
    half = round(gap / 2 / ROOM.resolution)
    data[100 - half : 100 + half, 99:101] = 0
    return OccupancyGrid(data, ROOM.resolution, ROOM.origin)


def test_it_holds_the_contract_of_a_task(tmp_path: Path) -> None:
    assert check("task", make(tmp_path, problem(), problem("two")), testing.robot())


def test_problems_come_in_the_order_of_the_file_again_and_again(tmp_path: Path) -> None:
    task = make(tmp_path, problem("b"), problem("a", goal=[3.0, 1.0]))
    found = [task.scenario(5, index) for index in range(5)]
    assert [s.name for s in found] == ["b/0000", "a/0000", "b/0001", "a/0001", "b/0002"]
    assert [s.goal.y for s in found] == [0.0, 1.0, 0.0, 1.0, 0.0]
    assert {s.seed for s in found} == {5}
    assert task.count() is None


def test_problem_comes_as_often_as_it_says_before_the_next_one(tmp_path: Path) -> None:
    task = make(tmp_path, problem("a", repeats=2), problem("b"))
    assert [task.scenario(0, index).name for index in range(6)] == [
        "a/0000",
        "a/0001",
        "b/0000",
        "a/0002",
        "a/0003",
        "b/0001",
    ]


def test_file_goes_before_the_task_and_the_task_fills_the_rest(tmp_path: Path) -> None:
    task = make(tmp_path, problem(goal_radius=1.0, time_limit=10.0, pedestrians=[{"position": [0, 2]}]), problem("two"))
    one, two = task.scenario(0, 0), task.scenario(0, 1)
    assert (one.goal_radius, one.time_limit, two.goal_radius, two.time_limit) == (1.0, 10.0, 0.25, 120.0)
    assert (one.pedestrians[0].desired_speed, one.pedestrians[0].radius) == (0.3, 0.3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"start": [-5.0, 0.0]}, r"scenarios\[0\]\.start \(-5\.00, 0\.00\) lies inside a wall or an obstacle"),
        ({"start": [-4.85, 0.0]}, r"start \(-4\.85, 0\.00\) lies inside a wall"),
        ({"goal": [4.99, 0.0]}, r"scenarios\[0\]\.goal \(4\.99, 0\.00\) lies inside a wall"),
        ({"start": [-50.0, 0.0]}, r"start .* lies outside the map"),
        ({"goal": [1e6, 0.0]}, r"goal .* lies outside the map"),
        ({"goal": [-3.1, 0.0]}, r"goal .* lies within the goal radius, 0\.25 m, of the start"),
        ({"obstacles": [{"center": [3.0, 0.3], "radius": 0.5}]}, r"goal .* lies inside a wall or an obstacle"),
        (
            {"obstacles": [{"vertices": [[-3.5, -0.5], [-2.5, -0.5], [-2.5, 0.5], [-3.5, 0.5]]}]},
            r"start .* inside a wall or an obstacle",
        ),
        (
            {"obstacles": [{"vertices": [[-1, -6], [1, -6], [1, 6], [-1, 6]]}]},
            r"goal \(3\.00, 0\.00\) cannot be reached from the start",
        ),
        (
            {"pedestrians": [{"position": [0, 2]}, {"position": [5, 5]}]},
            r"scenarios\[0\]\.pedestrians\[1\] .* its position lies outside the map",
        ),
        ({"pedestrians": [{"position": [4.98, 0]}]}, r"pedestrians\[0\] .* its position lies inside a wall"),
        (
            {"pedestrians": [{"position": [0, 0], "waypoints": [[0, 1], [0, 9]]}]},
            r"\[0\] \(0\.00, 9\.00\) its waypoint 1 lies outside the map",
        ),
        (
            {"pedestrians": [{"position": [-2.7, 0.0]}]},
            r"pedestrians\[0\] \(-2\.70, 0\.00\) stands on the robot's start",
        ),
    ],
)
def test_impossible_problem_is_refused_before_anything_runs(
    tmp_path: Path, changes: dict[str, Any], message: str
) -> None:
    with pytest.raises(ImpossibleScenario, match=rf"problem\.json: .*{message}") as caught:
        make(tmp_path, problem(**changes))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("gap", "radius", "possible"), [(0.0, 0.1, False), (0.6, 0.2, True), (0.6, 0.4, False)])
def test_goal_is_reachable_only_through_gaps_that_the_robot_fits(
    tmp_path: Path, gap: float, radius: float, possible: bool
) -> None:
    robot = replace(testing.robot(), footprint=testing.robot().footprint.circle(radius))
    world = Fixed(divided(gap))
    if possible:
        assert make(tmp_path, problem(), world=world, robot=robot).scenario(0, 0)
        return
    with pytest.raises(ImpossibleScenario, match="cannot be reached"):
        make(tmp_path, problem(), world=world, robot=robot)


def test_start_close_to_a_wall_is_possible(tmp_path: Path) -> None:
    # touching, but not in it: the wall's face is at -4.95
    assert make(tmp_path, problem(start=[-4.75, 0.0])).scenario(0, 0)


def test_unknown_cells_are_no_place_for_start_or_goal(tmp_path: Path) -> None:
    data = ROOM.data.copy()
    data[:, 150:] = -1
    with pytest.raises(ImpossibleScenario, match=r"goal .* lies on an unknown cell"):
        make(tmp_path, problem(), world=Fixed(OccupancyGrid(data, ROOM.resolution, ROOM.origin)))


def test_changing_worlds_are_checked_one_by_one(tmp_path: Path) -> None:
    task = make(tmp_path, problem(), world=Changing())
    assert task.scenario(0, 0).world.name == "changing"
    with pytest.raises(ImpossibleScenario, match="inside a wall"):
        task.scenario(0, 1)


def test_path_must_be_given() -> None:
    with pytest.raises(ConfigurationError, match=r"task\.path is null; allowed: .*task\.path=scenario\.json"):
        ScenarioTask(testing.robot(), Fixed(ROOM), None, 0.3, 0.3, 0.3, 180.0)


def test_furniture_of_a_problem_stands_beside_that_of_the_world(tmp_path: Path) -> None:
    class Furnished(WorldSource):
        def world(self, seed: int, index: int) -> World:
            return World("furnished", ROOM, furniture=(chair,))

    chair = testing.furniture("chair", 0.0, 3.0)
    task = make(
        tmp_path, problem(furniture=[{"kind": "table", "pose": [0.0, 0.0, 0.5]}]), problem("two"), world=Furnished()
    )
    with_table, without = task.scenario(0, 0), task.scenario(0, 1)
    assert [(piece.kind, piece.pose) for piece in with_table.world.furniture] == [
        ("chair", chair.pose),
        ("table", Pose(0.0, 0.0, 0.5)),
    ]
    assert without.world.furniture == (chair,)
    assert with_table.world.grid is ROOM
    save_scenarios(tmp_path / "again.json", [with_table])
    assert json.loads((tmp_path / "again.json").read_text())["scenarios"][0]["furniture"][1] == {
        "kind": "table",
        "pose": [0.0, 0.0, 0.5],
    }


@pytest.mark.parametrize(
    ("piece", "said"),
    [
        (
            {"kind": "sofa", "pose": [0, 0]},
            r"problem.json: scenarios\[0\].furniture\[0\].kind: furniture is 'sofa'; allowed: chair, shelf, table",
        ),
        ({"kind": "table"}, r"furniture\[0\].pose is missing"),
        ({"kind": "table", "pose": [0, float("nan")]}, "problem.json"),
        ({"kind": "table", "pose": [0, 0], "top": 1}, r"furniture\[0\].top is unknown; allowed: kind, pose"),
    ],
)
def test_bad_furniture_is_said_with_file_and_key(tmp_path: Path, piece: dict[str, Any], said: str) -> None:
    with pytest.raises(InputFileError, match=said):
        make(tmp_path, problem(furniture=[piece]))


def test_goal_on_a_table_is_impossible(tmp_path: Path) -> None:
    with pytest.raises(ImpossibleScenario, match="lies inside a wall or an obstacle"):
        make(tmp_path, problem(furniture=[{"kind": "table", "pose": [3.0, 0.0]}]))


def test_more_furniture_than_can_be_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="one has 1001 pieces of furniture; allowed: up to 1000"):
        make(tmp_path, problem(furniture=[{"kind": "chair", "pose": [0, 0]}] * 1001))


def test_formats_without_furniture_say_that_it_is_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "ours.json"
    furnished = problem(furniture=[{"kind": "chair", "pose": [0, 0]}])
    source.write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": [furnished]}))
    for form in ("arena-tools", "arena-rosnav"):
        assert ConvertCommand().run([str(source), str(tmp_path / "theirs.json"), f"format={form}"]) == 0
        assert "left out: furniture" in capsys.readouterr().out
