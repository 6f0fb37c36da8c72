"""Robots in the place of recorded people: the same start, goal and time, among the others."""

import csv

import numpy as np
import pytest

from arena_core import ConfigurationError, ImpossibleScenario, OccupancyGrid, Pose, World, WorldSource
from arena_core.cli.main import main
from arena_core.testing import component, robot


class Floor(WorldSource):
    """A free floor of 10 by 10 m."""

    def __init__(self):
        self._world = World("floor", OccupancyGrid(np.zeros((100, 100), np.int8), 0.1, Pose(0.0, 0.0)))

    def world(self, seed, index):
        return self._world


@pytest.fixture
def three_walks(tmp_path):
    """Return a recording at 1 frame a second: 4 walks 8 m along x, 9 a moment later along y, 12 stands."""
    rows = [(k, 4, 1.0 + k, 2.0) for k in range(9)]
    rows += [(k, 9, 5.0, 1.0 + k - 2) for k in range(2, 10)]
    rows += [(k, 12, 8.0, 8.0) for k in range(12)]
    path = tmp_path / "walks.txt"
    lines = [" ".join(map(str, row)) for row in rows]
    path.write_text("# framerate: 1\n# frame id x/m y/m\n" + "\n".join(lines) + "\n")
    return path


def task(path, *words):
    words = ["pedestrians=replay", f"pedestrians.path={path}", *words]
    return component("task", "replace", words, robot=robot(), world=Floor())


def test_the_robot_starts_and_ends_as_the_person_did(three_walks):
    first = task(three_walks).scenario(0, 0)
    assert first.name == "replace/4/0000"
    assert (first.start, first.goal) == (Pose(1.0, 2.0, 0.0), Pose(9.0, 2.0))
    assert first.time_limit == 80.0
    assert (first.replaces.person, first.replaces.begin) == (4, 0.0)
    assert first.replaces.stamps.tolist() == [float(k) for k in range(9)]


def test_walks_come_in_the_order_of_time_and_again_and_again(three_walks):
    drawn = [task(three_walks).scenario(0, index) for index in range(4)]
    assert [each.name for each in drawn] == ["replace/4/0000", "replace/9/0000", "replace/4/0001", "replace/9/0001"]
    assert drawn[1].replaces.begin == 2.0
    assert drawn[1].start.theta == pytest.approx(np.pi / 2)


def test_whoever_stands_or_has_another_in_the_way_is_not_replaced(three_walks):
    text = three_walks.read_text() + "2 20 5.3 1.0\n3 20 5.3 1.0\n"
    three_walks.write_text(text)
    assert [task(three_walks).scenario(0, index).replaces.person for index in range(3)] == [4, 4, 4]


def test_the_person_is_left_out_and_the_recording_begins_with_the_walk(stage, three_walks):
    model = component("pedestrians", "replay", [f"pedestrians.path={three_walks}"])
    scenario = task(three_walks).scenario(0, 1)
    crowd = model.reset(np.zeros(1, np.int64), [scenario], 1)
    assert sorted(crowd.world(0).ids.tolist()) == [4, 12]
    crowd = model.step(crowd, stage.robots(), np.zeros(1, np.int64), 1.0)
    places = dict(zip(crowd.ids[0].tolist(), crowd.positions[0].tolist(), strict=True))
    assert places[4] == pytest.approx([4.0, 2.0])  # three seconds of the recording


def test_what_no_robot_can_take_over_is_one_line(three_walks):
    with pytest.raises(ConfigurationError, match="nobody walks 20 m in 3 s or more; allowed: a recording of longer"):
        task(three_walks, "task.walks.least_distance=20")
    with pytest.raises(ImpossibleScenario, match="no recorded walk begins and ends in free space of world floor"):
        task(three_walks, "pedestrians.offset_xy=[50,0]").scenario(0, 0)


def test_a_robot_faster_than_the_person_arrives_before_them(three_walks, tmp_path):
    words = ["pedestrians=replay", f"pedestrians.path={three_walks}", "task=replace", "world=empty", "world.width=10"]
    words += ["world.height=10", "planner=pure_pursuit", "robot=jackal", "localizer=ground_truth", "episodes=1"]
    words += ["metrics=[human]", "executor=serial", "report=false", f"hydra.run.dir={tmp_path / 'run'}"]
    assert main(["run", *words]) == 0
    with (tmp_path / "run" / "episodes.csv").open() as table:
        (row,) = csv.DictReader(table)
    assert row["outcome"] == "goal_reached"
    assert float(row["human.extra_time"]) < -2.0
    assert float(row["human.extra_path"]) == pytest.approx(-0.3, abs=0.2)  # it stops at the goal radius
