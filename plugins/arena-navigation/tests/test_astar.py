import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import INSCRIBED, LETHAL, ConfigurationError, Footprint, NoPath, OccupancyGrid, Path, Pose
from arena_core.testing import component, robot, room
from arena_navigation.planning.astar import AstarPlanner
from arena_navigation.planning.inflation import InflatedCosts, Inflation

BODY = robot()
RADIUS = BODY.footprint.inscribed_radius


def planner(**changes: Any) -> AstarPlanner:
    parameters = {
        "inflation_radius": 0.8,
        "cost_scaling_factor": 3.0,
        "neutral_cost": 50.0,
        "cost_factor": 0.8,
        "allow_unknown": False,
        "tolerance": 0.25,
        "spacing": 0.1,
        "smoothing_rounds": 20,
        "padding": 0.0,
        "narrow_cost": 1000.0,
    }
    return AstarPlanner(BODY, **(parameters | changes))


def walled_room(theta: float = 0.0) -> OccupancyGrid:
    """The 10 m room with a wall across its middle that has a door at its upper end."""
    data = room().data.copy()
    data[:160, 99:101] = 100
    return OccupancyGrid(data, 0.05, Pose(-5.0, -5.0, theta))


def cluttered(seed: int) -> OccupancyGrid:
    data = room().data.copy()
    for row, column in np.random.default_rng(seed).integers(0, 190, (40, 2)):
        data[row : row + 10, column : column + 10] = 100
    return OccupancyGrid(data, 0.05, Pose(-5.0, -5.0, 0.3))


def costs_along(grid: OccupancyGrid, path: Path, inflation_radius: float = 0.8) -> list[int]:
    costs = grid.derive(InflatedCosts(Inflation(RADIUS, inflation_radius, 3.0), False))
    between = np.linspace(path.poses[:-1, :2], path.poses[1:, :2], 20).reshape(-1, 2)
    cells = grid.cells(between)
    return [int(c) for c in costs[cells[:, 0], cells[:, 1]]]


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_paths_join_start_and_goal_without_touching_anything(seed: int) -> None:
    grid = cluttered(seed)
    free = np.argwhere(grid.derive(InflatedCosts(Inflation(RADIUS, 0.8, 3.0), False)) < INSCRIBED)
    random = np.random.default_rng(seed)
    start, goal = (Pose(*grid.positions(free[random.integers(len(free))]), 0.0) for _ in range(2))
    start = replace(start, x=start.x + 0.01)
    try:
        path = planner().plan(grid, start, goal)
    except NoPath:
        return
    assert path.poses[0, :2] == pytest.approx((start.x, start.y))
    assert path.poses[-1, :2] == pytest.approx((goal.x, goal.y))
    assert max(costs_along(grid, path)) < INSCRIBED


def test_headings_point_along_the_path_and_are_not_those_of_the_grid() -> None:
    path = planner().plan(room(), Pose(-4.0, -4.0, 1.0), Pose(4.0, -1.3))
    steps = np.diff(path.poses[:, :2], axis=0)
    assert path.poses[:-1, 2] == pytest.approx(np.arctan2(steps[:, 1], steps[:, 0]))
    assert path.poses[-1, 2] == path.poses[-2, 2]
    assert path.poses[:, 2] == pytest.approx(math.atan2(2.7, 8.0), abs=0.02)
    assert path.length == pytest.approx(math.hypot(8.0, 2.7), rel=1e-3)


def test_poses_are_evenly_spaced() -> None:
    path = planner().plan(walled_room(), Pose(-3.0, -3.0), Pose(3.0, -3.0))
    gaps = np.hypot(*np.diff(path.poses[:, :2], axis=0).T)
    assert gaps.max() < 0.13
    assert np.median(gaps) == pytest.approx(0.1, abs=0.02)


def test_a_rotated_map_gives_the_rotated_path() -> None:
    upright = planner().plan(walled_room(), Pose(-3.0, -3.0), Pose(3.0, -3.0)).poses
    turned_grid = walled_room(0.5)
    turn = Pose(-5.0, -5.0, 0.5)
    ends = [turn.compose(Pose(x + 5.0, -3.0 + 5.0)) for x in (-3.0, 3.0)]
    turned = planner().plan(turned_grid, *ends).poses
    back = np.add([turn.relative(Pose(x, y, h)).array() for x, y, h in turned], (-5.0, -5.0, 0.0))
    assert back == pytest.approx(upright, abs=1e-6)


def test_the_door_is_passed_in_its_middle_rather_than_along_its_edge() -> None:
    path = planner().plan(walled_room(), Pose(-3.0, 2.0), Pose(3.0, 2.0))
    door = path.poses[np.abs(path.poses[:, 0]).argmin(), 1]
    assert 3.6 < door < 4.4  # the door reaches from 3.0 to 4.95


def test_a_start_too_near_a_wall_moves_out_first() -> None:
    start = Pose(-4.85, 0.0)  # the wall's surface is 0.1 m away, the robot's radius 0.2 m
    path = planner().plan(room(), start, Pose(4.0, 1.0))
    costs = costs_along(room(), path)
    assert costs[0] == INSCRIBED
    assert max(costs) == INSCRIBED
    assert (path.poses[0, 0], path.poses[0, 1]) == pytest.approx((-4.85, 0.0))
    assert (room().derive(InflatedCosts(Inflation(RADIUS, 0.8, 3.0), False)) == LETHAL).any()
    assert sum(np.array(costs) == INSCRIBED) * 0.1 / 20 < 0.35


@pytest.mark.parametrize(
    ("start", "goal", "message"),
    [
        (
            Pose(-4.99, 0.0),
            Pose(0.0, 0.0),
            r"the start \(-4.99, 0.00\) lies in an occupied or unknown cell; a free one is needed",
        ),
        (Pose(0.0, 0.0), Pose(-4.99, 0.0), r"the goal \(-4.99, 0.00\) is blocked, no way leads within 0.1 m of it"),
        (Pose(0.0, 0.0), Pose(7.0, 0.0), r"the goal \(7.00, 0.00\) lies outside the map of 200 x 200 cells"),
        (Pose(-9.0, 0.0), Pose(0.0, 0.0), r"the start \(-9.00, 0.00\) lies outside the map"),
    ],
)
def test_an_impossible_query_is_refused_with_its_reason(start: Pose, goal: Pose, message: str) -> None:
    with pytest.raises(NoPath, match=message) as refusal:
        planner(tolerance=0.1).plan(room(), start, goal)
    assert "\n" not in str(refusal.value)


def test_a_closed_door_is_no_path() -> None:
    data = walled_room().data.copy()
    data[160:180, 99] = 100
    grid = OccupancyGrid(data, 0.05, Pose(-5.0, -5.0))
    assert planner().plan(grid, Pose(-3.0, 0.0), Pose(3.0, 0.0)).length > 6.0
    data[180:192, 99] = 100  # what is left is narrower than the robot
    with pytest.raises(
        NoPath, match=r"no way leads from \(-3.00, 0.00\) to \(3.00, 0.00\) \(inscribed radius 0.200 m\)"
    ):
        planner().plan(OccupancyGrid(data, 0.05, Pose(-5.0, -5.0)), Pose(-3.0, 0.0), Pose(3.0, 0.0))


def test_a_blocked_goal_is_replaced_within_the_tolerance_only() -> None:
    goal = Pose(4.85, 0.0)
    end = planner(tolerance=0.25).plan(room(), Pose(0.0, 0.0), goal).poses[-1]
    assert 0.0 < math.hypot(end[0] - goal.x, end[1] - goal.y) <= 0.25
    with pytest.raises(NoPath):
        planner(tolerance=0.05).plan(room(), Pose(0.0, 0.0), goal)


def test_a_goal_cell_that_is_shut_in_gives_way_to_one_beside_it() -> None:
    data = room().data.copy()
    data[100:103, 100:103] = 100
    data[101, 101] = 0
    grid = OccupancyGrid(data, 0.05, Pose(-5.0, -5.0))
    goal = Pose(0.075, 0.075)
    path = planner(inflation_radius=0.0).plan(grid, Pose(-2.0, 0.0), goal)
    assert 0.0 < math.hypot(path.poses[-1, 0] - goal.x, path.poses[-1, 1] - goal.y) <= 0.25


def test_unknown_cells_are_crossed_only_if_allowed() -> None:
    data = room().data.copy()
    data[:, 95:105] = -1
    grid = OccupancyGrid(data, 0.05, Pose(-5.0, -5.0))
    with pytest.raises(NoPath):
        planner().plan(grid, Pose(-3.0, 0.0), Pose(3.0, 0.0))
    assert planner(allow_unknown=True).plan(grid, Pose(-3.0, 0.0), Pose(3.0, 0.0)).length == pytest.approx(
        6.0, abs=0.01
    )


def test_a_path_within_one_cell_has_two_poses() -> None:
    path = planner().plan(room(), Pose(0.01, 0.01), Pose(0.04, 0.03))
    assert path.poses[:, :2] == pytest.approx(np.array(((0.01, 0.01), (0.04, 0.03))))
    assert planner().plan(room(), Pose(0.01, 0.01), Pose(0.01, 0.01)).poses.shape == (2, 3)


def test_what_was_planned_before_does_not_matter() -> None:
    used, grid, goal = planner(), walled_room(), Pose(3.0, -3.0)
    for start in (Pose(-3.0, -3.0), Pose(-1.0, 4.0), Pose(-4.0, 0.0), Pose(4.0, 4.0)):
        again = used.plan(grid, start, goal).poses
        assert (again == planner().plan(grid, start, goal).poses).all()
    other = Pose(-3.0, 3.0)
    for next_grid in (room(), grid):
        used.plan(room(), goal, other)
        assert (used.plan(next_grid, goal, other).poses == planner().plan(next_grid, goal, other).poses).all()


def test_the_longer_robot_needs_its_inscribed_radius() -> None:
    body = replace(BODY, footprint=Footprint.polygon(((0.4, 0.1), (-0.4, 0.1), (-0.4, -0.1), (0.4, -0.1))))
    with pytest.raises(ConfigurationError, match=r"inscribed radius 0\.100"):
        AstarPlanner(body, 0.05, 3.0, 50.0, 0.8, 0.25, 0.1, 20, 0.0, 1000.0, allow_unknown=False)
    assert (
        AstarPlanner(body, 0.1, 3.0, 50.0, 0.8, 0.25, 0.1, 20, 0.0, 1000.0, allow_unknown=False)
        .plan(room(), Pose(0.0, 0.0), Pose(1.0, 0.0))
        .length
        > 0.9
    )


def test_the_preset_builds_the_planner() -> None:
    assert isinstance(component("global_planner", "astar", robot=BODY), AstarPlanner)


def test_a_path_costs_what_its_cells_weigh_and_a_detour_costs_more() -> None:
    start, goal = Pose(-3.0, 0.0), Pose(3.0, 0.0)
    plain = planner(inflation_radius=0.0)
    path = plain.plan(room(), start, goal)
    assert plain.cost(room(), path) == pytest.approx(50.0 * 6.0 / 0.05)
    corner = Path(np.array(((-3.0, 0.0, 0.0), (0.0, 2.0, 0.0), (3.0, 0.0, 0.0))))
    assert plain.cost(room(), corner) == pytest.approx(50.0 * 2.0 * math.hypot(3.0, 2.0) / 0.05)
    assert planner().cost(room(), corner) >= plain.cost(room(), corner)


def test_a_blocked_path_costs_infinitely_much_and_so_does_one_that_leaves_the_map() -> None:
    through = Path(np.array(((-3.0, -2.0, 0.0), (3.0, -2.0, 0.0))))
    assert planner().cost(room(), through) < math.inf
    assert planner().cost(walled_room(), through) == math.inf
    assert planner().cost(room(), Path(np.array(((0.0, 0.0, 0.0), (9.0, 0.0, 0.0))))) == math.inf


def test_a_path_that_begins_beside_an_obstacle_is_not_blocked_by_it() -> None:
    beside = Path(np.array(((4.9, 0.0, math.pi), (4.5, 0.0, math.pi), (0.0, 0.0, math.pi))))
    assert planner().cost(room(), beside) < math.inf
    assert planner().cost(room(), Path(beside.poses[::-1])) == math.inf


def gaps(narrow: int, wide: int) -> OccupancyGrid:
    """The room with a wall across it that has a gap of ``narrow`` cells straight ahead and one
    of ``wide`` cells far aside.
    """
    data = room().data.copy()
    data[:, 99:101] = 100
    data[100 - narrow // 2 : 100 - narrow // 2 + narrow, 99:101] = 0
    data[20 : 20 + wide, 99:101] = 0
    return OccupancyGrid(data, 0.05, Pose(-5.0, -5.0))


def test_padding_prefers_the_wider_gap_and_does_without_where_there_is_none() -> None:
    start, goal = Pose(-2.0, 0.0), Pose(2.0, 0.0)
    narrow = math.ceil(2.0 * RADIUS / 0.05) + 2

    def crossing(padding: float, wide: int) -> float:
        path = planner(padding=padding).plan(gaps(narrow, wide), start, goal)
        return float(np.interp(0.0, path.poses[:, 0], path.poses[:, 1]))

    assert abs(crossing(0.0, 30)) < 0.2
    assert crossing(0.1, 30) < -2.0
    assert abs(crossing(0.1, 0)) < 0.2


NARROW = 9  # cells of a gap that leaves the robot 2.5 cm on either side
PADDING = 0.05


def long_way_round(gap: int, end: int = 20) -> tuple[OccupancyGrid, Pose, Pose]:
    """Return two halls side by side, 25 m long, joined by a gap of so many cells at one end and of ``end``
    at the other, start and goal.
    """
    data = np.zeros((80, 500), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    data[39:41] = 100
    data[39:41, 20 : 20 + gap] = 0
    data[39:41, 499 - end : 499] = 0
    x = 0.05 * (20 + 0.5 * gap)
    return OccupancyGrid(data, 0.05, Pose(0.0, 0.0)), Pose(x, 1.0), Pose(x, 3.0)


def test_a_wide_way_is_taken_although_it_is_twenty_times_longer() -> None:
    padded = planner(padding=PADDING)
    grid, start, goal = long_way_round(NARROW)
    short, long = planner().plan(grid, start, goal), padded.plan(grid, start, goal)
    assert short.length < 2.1
    assert long.length > 20.0 * short.length
    assert (padded.is_narrow(grid, short), padded.is_narrow(grid, long)) == (True, False)
    assert padded.cost(grid, short) > padded.cost(grid, long)
    assert planner(padding=PADDING, narrow_cost=10.0).plan(grid, start, goal).length < 2.1  # what it costs decides


def test_a_narrow_gap_is_taken_where_there_is_no_other() -> None:
    grid, start, goal = long_way_round(NARROW, end=0)
    padded = planner(padding=PADDING)
    path = padded.plan(grid, start, goal)
    assert path.length < 2.1
    assert padded.is_narrow(grid, path)
    assert not planner().is_narrow(grid, path)  # without padding nothing is


# of an even number, half a cell is lost
@pytest.mark.parametrize(("gap", "narrow"), [(9, True), (10, True), (11, False), (12, False)])
def test_a_gap_is_narrow_if_it_leaves_less_than_the_padding_on_either_side(gap: int, narrow: bool) -> None:
    padded = planner(padding=PADDING)
    grid, start, goal = long_way_round(gap, end=0)
    assert padded.is_narrow(grid, padded.plan(grid, start, goal)) == narrow


def test_a_goal_beside_a_wall_is_reached_exactly_and_is_no_passage() -> None:
    start, goal = Pose(-4.72, 1.0), Pose(4.72, -2.0)  # 3 cm from the walls
    padded = planner(padding=0.1)
    path = padded.plan(room(), start, goal)
    assert path.poses[[0, -1], :2] == pytest.approx(np.array(((start.x, start.y), (goal.x, goal.y))))
    assert not padded.is_narrow(room(), path)
    corner = Pose(4.72, 4.72)
    path = padded.plan(room(), start, corner)
    assert tuple(path.poses[-1, :2]) == pytest.approx((corner.x, corner.y))
    assert not padded.is_narrow(room(), path)


def test_a_path_that_ends_within_a_gap_leads_through_none() -> None:
    padded = planner(padding=PADDING)
    grid, start, goal = long_way_round(NARROW, end=0)
    within = replace(goal, y=2.0)
    for ends in ((start, within), (within, start)):
        assert not padded.is_narrow(grid, padded.plan(grid, *ends))


def test_a_path_that_leaves_the_map_is_not_called_narrow() -> None:
    assert not planner(padding=PADDING).is_narrow(room(), Path(np.array(((0.0, 0.0, 0.0), (9.0, 0.0, 0.0)))))


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.integers(0, 10**6))
def test_padding_changes_a_path_that_keeps_off_walls_without_it_by_a_percent_at_most(seed: int) -> None:
    grid, plain, padded = cluttered(seed), planner(), planner(padding=PADDING)
    free = np.argwhere(grid.derive(InflatedCosts(Inflation(RADIUS, 0.8, 3.0), False)) < INSCRIBED)
    random = np.random.default_rng(seed)
    start, goal = (Pose(*grid.positions(free[random.integers(len(free))]), 0.0) for _ in range(2))
    try:
        path = plain.plan(grid, start, goal)
    except NoPath:
        return
    nearest = Inflation(RADIUS, 0.8, 3.0).costs_at(np.array(RADIUS + PADDING + 0.5 * 0.05))
    if max(costs_along(grid, path)) < nearest:
        other = padded.plan(grid, start, goal)
        assert plain.cost(grid, other) == pytest.approx(plain.cost(grid, path), rel=0.015)


@pytest.mark.parametrize("grid", [room(), walled_room(), gaps(30, 30)], ids=["room", "door", "two doors"])
def test_without_narrow_passages_paths_are_those_without_padding(grid: OccupancyGrid) -> None:
    for x in (-3.0, -1.0):
        start, goal = Pose(x, -3.0), Pose(3.0, -3.0)
        assert (planner(padding=PADDING).plan(grid, start, goal).poses == planner().plan(grid, start, goal).poses).all()
