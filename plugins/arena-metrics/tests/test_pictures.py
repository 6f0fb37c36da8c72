"""Which problems a picture shows, over which stretch of the world, and what is said of its episodes."""

import csv
import json
import re

import numpy as np
import pytest

from arena_metrics.pages.panels import picture_layouts
from arena_metrics.pages.report import ReportCommand
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.drives import Problem, drives_of, number_episodes
from arena_metrics.pooling.outcomes import describe_outcome
from arena_metrics.pooling.runs import pool_episodes, read_runs
from arena_metrics.tables.repeats import distances_table, repeats_table

FEW = ("success", "collisions", "path_length")


def change(folder, episode, scenario=None, name=None, shift=None):
    """Rewrite a record with another scenario, and the table's row with another name; ``shift`` moves the path, m."""
    path = folder / "records" / f"{episode:04d}.npz"
    with np.load(path) as content:
        arrays = dict(content)
    meta = json.loads(str(arrays["meta"]))
    meta["scenario"] |= scenario or {}
    arrays["meta"] = np.array(json.dumps(meta))
    arrays["pose"] = arrays["pose"] + np.array([*(shift or (0.0, 0.0)), 0.0])
    np.savez(path, **arrays)
    if name:
        table = (folder / "episodes.csv").read_text()
        (folder / "episodes.csv").write_text(table.replace(f"random/{episode:04d}", name))


def read(*folders):
    cells = cells_of(pool_episodes(read_runs(folders))[0])
    return cells, {cell.hash: drives_of(cells, cell) for cell in cells.cells}


def repeated(run_folder, folder, planner="dwa", shift=0.0):
    """Write a run of two problems, driven twice each, with an obstacle of its own in each; paths
    end 4 m away, but for the shift.
    """
    run_folder(folder, planner=planner, episodes=4, only=FEW)
    for episode in range(4):
        disc = [{"vertices_xy": [[1.0 + episode // 2, 9.0]], "radius": 0.5}]
        scenario = {"start": [0, 0, 0], "goal": [4.0, episode // 2, 0], "obstacles": disc}
        change(
            folder, episode, scenario, f"{'near' if episode < 2 else 'far'}/{episode % 2:04d}", (0.0, shift * episode)
        )
    return folder


@pytest.fixture
def two_runs(run_folder, tmp_path):
    return [repeated(run_folder, tmp_path / "a"), repeated(run_folder, tmp_path / "b", "teb", 1.0)]


def test_problems_that_are_repeated_have_a_panel_each_with_their_own_obstacles(two_runs):
    cells, drives = read(*two_runs)
    ((condition, layout),) = picture_layouts(cells, drives).items()
    assert (condition, layout.left_out) == ("", 0)
    assert [panel.title for panel in layout.panels] == ["near", "far"]
    assert [
        json.loads(problem.obstacles)[0]["vertices_xy"] for panel in layout.panels for problem in panel.problems
    ] == [
        [[1.0, 9.0]],
        [[2.0, 9.0]],
    ]


def test_rivals_share_one_extent_that_holds_what_either_did(two_runs):
    cells, drives = read(*two_runs)
    (layout,) = picture_layouts(cells, drives).values()
    for panel in layout.panels:
        own = [drive for of in drives.values() for drive in of if drive.problem in panel.problems]
        assert {drive.episode.row["planner"] for drive in own} == {"dwa", "teb"}
        left, right, bottom, top = panel.window
        for drive in own:
            assert left < drive.low[0] < drive.high[0] < right
            assert bottom < drive.low[1] < drive.high[1] < top
        assert drive.high[1] == 9.5  # the obstacle far from the way is in the picture
    shapes = {round((w[3] - w[2]) / (w[1] - w[0]), 6) for w in (panel.window for panel in layout.panels)}
    assert len(shapes) == 1


def test_problems_driven_once_on_one_map_share_a_panel_with_all_starts_and_goals(run_folder, tmp_path):
    cells, drives = read(run_folder(tmp_path / "a", episodes=5, only=FEW))
    (layout,) = picture_layouts(cells, drives).values()
    assert [(panel.title, len(panel.problems)) for panel in layout.panels] == [("5 problems", 5)]


def test_problems_driven_once_among_other_obstacles_have_panels_of_their_own(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a", episodes=20, only=FEW)
    for episode in range(20):
        change(folder, episode, {"obstacles": [{"vertices_xy": [[0.1 * episode, 1.0]], "radius": 0.2}]})
    (layout,) = picture_layouts(*read(folder)).values()
    assert (len(layout.panels), layout.left_out) == (16, 4)
    assert all(len(panel.problems) == 1 for panel in layout.panels)


def test_repeats_scatter_and_planners_differ_by_what_they_drove(two_runs):
    """dwa's paths of a problem are 0.5 m longer the second time; teb's lie 1 m
    further to the left each time as well.
    """
    cells, drives = read(*two_runs)
    table = repeats_table(cells, drives)
    rows = {tuple(row[:2]): row[2:] for row in table.rows}
    assert rows["dwa", "near"] == ["2", "1 of 2", f"{0.5 / np.sqrt(2):.3f}", "0.500"]
    assert rows["teb", "far"] == ["2", "1 of 2", f"{np.hypot(0.5, 1.0) / np.sqrt(2):.3f}", f"{np.hypot(0.5, 1.0):.3f}"]
    (row,) = distances_table(cells, drives).rows
    assert row == ["dwa, teb", "4", "1.500", "3.000", "2", "1.000", "2.000"]  # episodes 0 and 2 succeeded


def test_single_episodes_and_single_planners_have_nothing_to_compare(run_folder, tmp_path):
    cells, drives = read(run_folder(tmp_path / "a", only=FEW))
    assert repeats_table(cells, drives) is None
    assert distances_table(cells, drives) is None


def numbers(*folders):
    cells, _ = read(*folders)
    return {cell.factors["planner"]: [label for _, label in number_episodes(cells, cell)] for cell in cells.cells}


def test_episodes_are_numbered_by_seed_where_any_planner_has_several(run_folder, tmp_path):
    run_folder(tmp_path / "a", episodes=2, only=FEW)
    assert numbers(tmp_path) == {"dwa": ["0", "1"]}
    run_folder(tmp_path / "b", episodes=2, seed=3, only=FEW)
    run_folder(tmp_path / "c", planner="teb", episodes=1, only=FEW)
    assert numbers(tmp_path) == {"dwa": ["0:0", "0:1", "3:0", "3:1"], "teb": ["0:0"]}


def test_numbers_below_a_picture_lead_to_rows_of_the_table(two_runs, tmp_path):
    assert ReportCommand().run([*map(str, two_runs), "--out", str(tmp_path / "report")]) == 0
    page = (tmp_path / "report" / "index.html").read_text()
    places = re.findall(r'<a href="#(e-[^"]+)"', page)
    assert len(places) == 8
    assert all(f'<tr id="{place}"' in page for place in places)
    assert {path.name for path in (tmp_path / "report" / "tables").iterdir()} >= {"repeats.csv", "path_distances.tex"}


def test_picture_without_any_record_is_left_out(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a", records=False, only=FEW)
    assert ReportCommand().run([str(folder)]) == 0
    assert not list((folder / "report" / "figures").glob("cell_*"))


def test_goal_reached_without_success_says_why():
    row = {"outcome": "goal_reached", "success": 0.0, "collisions": 3.0}
    assert describe_outcome(row) == "goal reached, but 3 collisions (at most 1)"
    assert describe_outcome(row | {"collisions": 0.0}) == "goal reached, but too far from it in truth, or too late"
    assert describe_outcome(row | {"success": 1.0, "collisions": 1.0}) == "goal reached"
    assert describe_outcome({"outcome": "goal_reached"}) == "goal reached"
    assert describe_outcome(row | {"outcome": "time_out"}) == "time out"


def test_reason_stands_in_the_table_of_episodes(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a", episodes=1, only=FEW)
    with (folder / "episodes.csv").open() as file:
        (row,) = csv.DictReader(file)
    row |= {"success": "0.0", "collisions": "2.0"}
    (folder / "episodes.csv").write_text("\n".join((",".join(row), ",".join(row.values()))) + "\n")
    ReportCommand().run([str(folder), "--no-figures"])
    assert "goal reached, but 2 collisions (at most 1)" in (folder / "report" / "index.html").read_text()


def test_place_of_a_problem_forgets_start_and_goal(record_of, straight_line):
    record = record_of(straight_line(), meta={"world": {"grid": "worlds/a.npz"}})
    assert Problem.of(record).place == Problem("worlds/a.npz", (), (), "[]")
