import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import INSCRIBED, LaserScan, OccupancyGrid, Pose
from arena_core.testing import component, robot, room, scan
from arena_navigation.local_map.rolling import RollingMap

BODY = robot()
GOAL = Pose(0.0, 0.0)


@cache
def preset() -> RollingMap:
    built: RollingMap = component("local_map", "rolling", robot=BODY)
    return built


def local_map(grid: OccupancyGrid | None) -> RollingMap:
    preset().reset(grid)
    return preset()


def hit(range_: float, beam: int = 180, stamp: float = 0.0) -> LaserScan:
    ranges = np.full(360, np.nan, np.float32)
    ranges[beam - 2 : beam + 3] = range_
    return LaserScan(stamp, -math.pi, math.pi / 180.0, 0.05, 30.0, ranges, Pose(0.0, 0.0))


def is_occupied(grid: OccupancyGrid, x: float, y: float) -> bool:
    row, column = grid.cells((x, y))
    return bool(grid.occupied[row, column])


def test_a_known_map_without_marks_is_returned_itself() -> None:
    grid = room()
    built = local_map(grid)
    assert built.planning_grid(GOAL, all_marks=False) is grid
    built.update(scan(Pose(4.0, 0.0), BODY), Pose(4.0, 0.0))  # the walls alone
    assert built.planning_grid(GOAL, all_marks=False) is grid


def test_marks_are_put_on_a_copy_of_the_known_map() -> None:
    grid = room()
    built = local_map(grid)
    built.update(hit(1.02), Pose(0.0, 0.0))
    planning = built.planning_grid(GOAL, all_marks=False)
    assert is_occupied(planning, 1.02, 0.0)
    assert not is_occupied(grid, 1.02, 0.0)
    assert (planning.occupied >= grid.occupied).all()
    assert planning.origin == grid.origin


def test_a_mark_beside_a_wall_is_taken_for_the_wall() -> None:
    grid = room()
    built = local_map(grid)
    built.update(hit(0.92), Pose(4.0, 0.0))  # the wall's cell begins at 4.95
    assert built.planning_grid(GOAL, all_marks=False) is grid
    built.update(hit(0.82), Pose(4.0, 0.0))
    assert is_occupied(built.planning_grid(GOAL, all_marks=False), 4.82, 0.0)


def test_all_marks_count_where_asked_for() -> None:
    grid = room()
    built = local_map(grid)
    built.update(hit(0.92), Pose(4.0, 0.0))
    assert is_occupied(built.planning_grid(GOAL, all_marks=True), 4.92, 0.0)


def two_gaps() -> OccupancyGrid:
    """Return a wall across a hall, with a gap of 0.5 m on the straight way and one of 1 m beside it."""
    data = np.zeros((120, 120), np.int8)
    data[:, 59] = 100
    data[55:65, 59] = data[85:105, 59] = 0
    return OccupancyGrid(data, 0.05, Pose(-3.0, -3.0))


def test_a_gap_that_the_local_map_marks_as_blocked_is_not_planned_through() -> None:
    """The two must agree: a robot that waits before a gap which its path insists on waits for ever."""
    built = local_map(two_gaps())
    planner = component("global_planner", "astar", robot=BODY)
    start, goal = Pose(-1.0, 0.0), Pose(1.5, 0.0)
    # a pose that is a little off, and noise, put them into the gap
    jambs = scan_of(start, [(-0.025, 0.225), (-0.025, -0.225)])
    window = built.update(jambs, start)
    row, column = ((np.array((0.0, -0.025)) - window.origin_xy[::-1]) / window.resolution).astype(int)
    assert window.costs[row, column] >= INSCRIBED
    through = {
        marks: planner.plan(built.planning_grid(goal, all_marks=marks), start, goal).poses for marks in (True, False)
    }
    assert np.interp(-0.025, *through[False][:, :2].T) == pytest.approx(0.0, abs=0.25)
    assert np.interp(-0.025, *through[True][:, :2].T) > 1.0


def scan_of(pose: Pose, points: list[tuple[float, float]]) -> LaserScan:
    """Return a scan that hits these points in ``map`` and nothing else."""
    ranges = np.full(720, np.nan, np.float32)
    for x, y in points:
        beam = round((math.atan2(y - pose.y, x - pose.x) + math.pi) / (math.pi / 360.0))
        ranges[beam] = math.hypot(x - pose.x, y - pose.y)
    return LaserScan(0.0, -math.pi, math.pi / 360.0, 0.05, 30.0, ranges, Pose(0.0, 0.0))


def test_clearing_forgets_the_marks_that_are_far_enough_away() -> None:
    built = local_map(room())
    built.update(hit(1.02), Pose(0.0, 0.0))
    built.clear(Pose(0.0, 0.0), 1.5)
    assert is_occupied(built.planning_grid(GOAL, all_marks=True), 1.02, 0.0)
    built.clear(Pose(0.0, 0.0), 0.5)
    assert not is_occupied(built.planning_grid(GOAL, all_marks=True), 1.02, 0.0)


@pytest.mark.parametrize(("resolution", "theta"), [(0.02, 0.3), (0.2, -1.0)])
def test_marks_fit_maps_of_other_resolutions_and_rotations(resolution: float, theta: float) -> None:
    grid = OccupancyGrid(np.zeros((400, 400), np.int8), resolution, Pose(-3.0, -3.0, theta))
    pose = Pose.of((*grid.positions((200, 200)), 0.0))
    built = local_map(grid)
    built.update(hit(1.02), pose)
    planning = built.planning_grid(GOAL, all_marks=False)
    assert is_occupied(planning, pose.x + 1.02, pose.y)
    marked = planning.positions(np.argwhere(planning.occupied)) - (pose.x, pose.y)
    assert np.abs(marked - (1.02, 0.0)).max() < 0.1 + resolution


def test_an_unknown_world_is_free_but_for_what_was_hit() -> None:
    built = local_map(None)
    built.update(hit(5.0), Pose(1.0, 2.0))
    planning = built.planning_grid(GOAL, all_marks=False)
    assert is_occupied(planning, 6.0, 2.0)
    assert set(np.unique(planning.data)) == {0, 100}
    assert planning.occupied.sum() <= 12


def test_what_was_seen_stays_when_the_window_has_moved_on() -> None:
    built = local_map(None)
    built.update(hit(2.0, stamp=0.0), Pose(0.0, 0.0))
    for k in range(1, 100):
        built.update(hit(np.nan, stamp=float(k)), Pose(0.0, -float(k)))
    assert is_occupied(built.planning_grid(GOAL, all_marks=False), 2.0, 0.0)


def test_people_who_walked_on_are_cleared_far_beyond_the_window() -> None:
    built = local_map(None)
    for k in range(30):
        built.update(hit(8.0, stamp=0.1 * k), Pose(0.0, 0.0))
    assert is_occupied(built.planning_grid(GOAL, all_marks=False), 8.0, 0.0)
    for k in range(30, 39):  # no longer than nine scans, however long they stood
        built.update(hit(9.0, stamp=0.1 * k), Pose(0.0, 0.0))
    planning = built.planning_grid(GOAL, all_marks=False)
    assert not is_occupied(planning, 8.0, 0.0)
    assert is_occupied(planning, 9.0, 0.0)


def test_a_person_who_steps_in_the_way_is_seen_at_once_where_nobody_stood_before() -> None:
    built = local_map(None)
    for k in range(30):
        built.update(hit(9.0, stamp=0.1 * k), Pose(0.0, 0.0))
    built.update(hit(5.0, stamp=3.0), Pose(0.0, 0.0))
    assert is_occupied(built.planning_grid(GOAL, all_marks=False), 5.0, 0.0)


@pytest.mark.parametrize(("share", "stays"), [(0.5, True), (0.1, False)])
def test_a_cell_that_is_hit_now_and_then_is_what_most_scans_say(share: float, stays: bool) -> None:
    built, random = local_map(None), np.random.default_rng(0)
    shown = []
    for k in range(300):
        built.update(hit(6.0 if random.random() < share else 7.0, stamp=0.1 * k), Pose(0.0, 0.0))
        shown.append(is_occupied(built.planning_grid(GOAL, all_marks=False), 6.0, 0.0))
    assert (np.mean(shown[20:]) > 0.95) if stays else (np.mean(shown[20:]) < 0.2)


def test_what_is_under_the_robot_is_no_obstacle() -> None:
    built = local_map(None)
    for k in range(10):
        built.update(hit(2.0, stamp=0.1 * k), Pose(0.0, 0.0))
    built.update(hit(np.nan, stamp=1.0), Pose(2.02, 0.0))
    assert not is_occupied(built.planning_grid(GOAL, all_marks=False), 2.0, 0.0)


@settings(derandomize=True, deadline=None, max_examples=20)
@given(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0), st.floats(-25.0, 25.0), st.floats(-25.0, 25.0))
def test_the_map_grows_to_hold_robot_and_goal_and_keeps_its_places(
    x: float, y: float, goal_x: float, goal_y: float
) -> None:
    built = local_map(None)
    built.update(hit(2.0), Pose(0.0, 0.0))
    built.update(hit(np.nan, stamp=0.1), Pose(x, y))
    planning = built.planning_grid(Pose(goal_x, goal_y), all_marks=False)
    beneath = math.hypot(x - 2.0, y) < 0.5
    assert is_occupied(planning, 2.01, 0.0) or beneath
    assert planning.contains(planning.cells(((x, y), (goal_x, goal_y)))).all()
    corner = np.array((planning.origin.x, planning.origin.y)) / planning.resolution
    assert corner == pytest.approx(np.round(corner), abs=1e-6)


def test_a_planner_finds_its_way_in_an_unknown_world() -> None:
    built = local_map(None)
    ranges = np.full(360, np.inf, np.float32)
    angles = -math.pi + math.pi / 180.0 * np.arange(360)
    ahead = np.abs(angles) < 0.6
    ranges[ahead] = 2.0 / np.cos(angles[ahead])  # a wall from (2, -1.4) to (2, 1.4)
    built.update(LaserScan(0.0, -math.pi, math.pi / 180.0, 0.05, 30.0, ranges, Pose(0.0, 0.0)), Pose(0.0, 0.0))
    goal = Pose(30.0, 0.0)
    path = component("global_planner", "astar", robot=BODY).plan(
        built.planning_grid(goal, all_marks=False), Pose(0.0, 0.0), goal
    )
    at_wall = np.interp(2.0, path.poses[:, 0], np.abs(path.poses[:, 1]))
    assert 1.3 + 0.2 < at_wall < 2.6
    assert path.length < 32.0
