import math
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from typing import Any, get_args

import numpy as np
import pytest

from arena_core import ConfigurationError, Footprint, NoPath, OccupancyGrid, Path, Pose, Robot
from arena_core.testing import component, robot, room
from arena_kernels.distance import grid_distance
from arena_ompl.algorithms import NOT_FOR_CARS, NOT_FOR_DUBINS, Algorithm
from arena_ompl.planner import OmplPlanner

BODY = robot()
RADIUS = BODY.footprint.inscribed_radius
LONG = Footprint.polygon(((0.341, 0.165), (-0.079, 0.165), (-0.079, -0.165), (0.341, -0.165)))
CAR = replace(robot("ackermann"), footprint=LONG)
TURN = 0.3 / math.tan(0.6)
ALGORITHMS = get_args(Algorithm)


def planner(body: Robot = BODY, **changes: Any) -> OmplPlanner:
    if changes.get("algorithm") == "aorrtc":
        changes = {"evaluations": 3000} | changes  # each takes it longer the more there have been
    built = component(
        "global_planner", "ompl", [f"global_planner.{key}={value}" for key, value in changes.items()], robot=body
    )
    assert isinstance(built, OmplPlanner)
    return built


def walled_room(theta: float = 0.0) -> OccupancyGrid:
    """The 10 m room with a wall across its middle that has a door of 2 m at its upper end."""
    data = room().data.copy()
    data[:160, 99:101] = 100
    return OccupancyGrid(data, 0.05, Pose(-5.0, -5.0, theta))


def least_distance(grid: OccupancyGrid, path: Path) -> float:
    between = np.linspace(path.poses[:-1, :2], path.poses[1:, :2], 8).reshape(-1, 2)
    cells = grid.cells(between)
    return float(grid.derive(grid_distance)[cells[:, 0], cells[:, 1]].min())


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_every_algorithm_finds_the_door_and_touches_nothing(algorithm: str) -> None:
    grid, start, goal = walled_room(), Pose(-3.0, -3.0, 0.5), Pose(3.0, -3.0)
    path = planner(algorithm=algorithm).plan(grid, start, goal)
    assert path.poses[0, :2] == pytest.approx((start.x, start.y))
    assert path.poses[-1, :2] == pytest.approx((goal.x, goal.y))
    assert least_distance(grid, path) > RADIUS - 0.03
    assert path.length < 1.15 * 2.0 * math.hypot(3.0, 6.3)
    assert np.hypot(*np.diff(path.poses[:, :2], axis=0).T).max() < 0.13


def test_headings_point_along_the_path() -> None:
    path = planner().plan(walled_room(), Pose(-3.0, -3.0, 2.0), Pose(3.0, -3.0))
    steps = np.diff(path.poses[:, :2], axis=0)
    assert path.poses[:-1, 2] == pytest.approx(np.arctan2(steps[:, 1], steps[:, 0]))
    assert path.poses[-1, 2] == path.poses[-2, 2]


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_what_was_planned_before_does_not_matter(algorithm: str) -> None:
    used, grid, goal = planner(algorithm=algorithm), walled_room(), Pose(3.0, -3.0)
    alone = planner(algorithm=algorithm).plan(grid, Pose(-3.0, 1.0), goal).poses
    for start in (Pose(-3.0, 3.0), Pose(-1.0, 4.0)):
        planner(algorithm="rrt").plan(grid, start, Pose(4.0, 4.0))
        used.plan(grid, start, goal)
    assert (used.plan(grid, Pose(-3.0, 1.0), goal).poses == alone).all()


SCRIPT = """
import sys
sys.path.insert(0, sys.argv[1])
from test_ompl_planner import ALGORITHMS, Pose, planner, walled_room
for algorithm in sys.argv[2].split(","):
    poses = planner(algorithm=algorithm).plan(walled_room(), Pose(-3.0, 1.0), Pose(3.0, -3.0)).poses
    print(algorithm, poses.tobytes().hex())
"""


@pytest.mark.slow
def test_another_process_finds_the_same_path_in_any_order_and_says_nothing() -> None:
    words = [sys.executable, "-c", SCRIPT, __file__.rpartition("/")[0], ",".join(ALGORITHMS)]
    run = subprocess.run(words, capture_output=True, text=True, check=True)
    assert run.stderr == ""
    here = []
    for algorithm in reversed(ALGORITHMS):
        poses = planner(algorithm=algorithm).plan(walled_room(), Pose(-3.0, 1.0), Pose(3.0, -3.0)).poses
        here.append(f"{algorithm} {poses.tobytes().hex()}")
    assert sorted(run.stdout.splitlines()) == sorted(here)


def test_seed_and_goal_choose_the_samples_and_the_start_does_not() -> None:
    grid, goal = walled_room(), Pose(3.0, -3.0)
    one, other = (
        planner(algorithm="rrt", seed=seed, smoothing_rounds=0).plan(grid, Pose(-3.0, 3.0), goal).poses
        for seed in (0, 1)
    )
    assert one.shape != other.shape or (one != other).any()


def test_a_rotated_map_gives_the_rotated_path() -> None:
    turn = Pose(-5.0, -5.0, 0.5)
    ends = [turn.compose(Pose(x + 5.0, -3.0 + 5.0)) for x in (-3.0, 3.0)]
    path = planner().plan(walled_room(0.5), *ends)
    back = np.array([np.add(turn.relative(Pose(*pose)).array(), (-5.0, -5.0, 0.0)) for pose in path.poses])
    upright = walled_room()
    assert back[[0, -1], :2] == pytest.approx(np.array(((-3.0, -3.0), (3.0, -3.0))))
    assert least_distance(upright, Path(back)) > RADIUS - 0.03
    steps = np.diff(back[:, :2], axis=0)
    assert np.cos(back[:-1, 2] - np.arctan2(steps[:, 1], steps[:, 0])).min() > 0.999


def test_the_door_is_passed_in_its_middle_rather_than_along_its_edge() -> None:
    path = planner().plan(walled_room(), Pose(-3.0, 2.0), Pose(3.0, 2.0))
    assert 3.5 < path.poses[np.abs(path.poses[:, 0]).argmin(), 1] < 4.5  # the door reaches from 3.0 to 4.95
    shortest = planner(**{"nearness.weight": 0.0}).plan(walled_room(), Pose(-3.0, 2.0), Pose(3.0, 2.0))
    assert shortest.length < path.length
    assert shortest.poses[np.abs(shortest.poses[:, 0]).argmin(), 1] < 3.4


@pytest.mark.parametrize("algorithm", ["rrtstar", "rrtconnect", "fmt"])
def test_a_start_too_near_a_wall_moves_out_first(algorithm: str) -> None:
    start = Pose(-4.85, 0.0)  # the wall's surface is 0.1 m away, the robot's radius 0.2 m
    path = planner(algorithm=algorithm).plan(room(), start, Pose(4.0, 1.0))
    distances = room().derive(grid_distance)[tuple(room().cells(path.poses[:, :2]).T)]
    assert distances[0] <= RADIUS
    assert (distances[5:] > RADIUS).all()
    assert path.poses[0, :2] == pytest.approx((-4.85, 0.0))


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


def test_a_closed_door_is_no_path_and_takes_no_search() -> None:
    data = walled_room().data.copy()
    data[160:192, 99] = 100  # what is left is narrower than the robot
    with pytest.raises(
        NoPath, match=r"no way leads from \(-3.00, 0.00\) to \(3.00, 0.00\) \(inscribed radius 0.200 m\)"
    ):
        planner(evaluations=10**9).plan(OccupancyGrid(data, 0.05, Pose(-5.0, -5.0)), Pose(-3.0, 0.0), Pose(3.0, 0.0))


def test_a_search_that_ends_too_soon_says_so() -> None:
    with pytest.raises(
        NoPath, match=r"no way found from \(-3.00, -3.00\) to \(3.00, -3.00\) by rrt within 20 evaluations"
    ):
        planner(algorithm="rrt", evaluations=20).plan(walled_room(), Pose(-3.0, -3.0), Pose(3.0, -3.0))


def test_a_blocked_goal_is_replaced_within_the_tolerance_only() -> None:
    goal = Pose(4.85, 0.0)
    end = planner(tolerance=0.25).plan(room(), Pose(0.0, 0.0), goal).poses[-1]
    assert 0.0 < math.hypot(end[0] - goal.x, end[1] - goal.y) <= 0.25
    with pytest.raises(NoPath):
        planner(tolerance=0.05).plan(room(), Pose(0.0, 0.0), goal)


def test_unknown_cells_are_crossed_only_if_allowed() -> None:
    data = room().data.copy()
    data[:, 95:105] = -1
    grid = OccupancyGrid(data, 0.05, Pose(-5.0, -5.0))
    with pytest.raises(NoPath):
        planner().plan(grid, Pose(-3.0, 0.0), Pose(3.0, 0.0))
    assert planner(allow_unknown="true").plan(grid, Pose(-3.0, 0.0), Pose(3.0, 0.0)).length == pytest.approx(
        6.0, abs=0.01
    )
    data[150:, 95:105] = 0
    path = planner().plan(OccupancyGrid(data, 0.05, Pose(-5.0, -5.0)), Pose(-3.0, 0.0), Pose(3.0, 0.0))
    assert (data[tuple(grid.cells(path.poses[:, :2]).T)] == 0).all()


def test_a_map_without_any_obstacle_is_crossed_straight() -> None:
    grid = OccupancyGrid(np.zeros((60, 80), np.int8), 0.1, Pose(0.0, 0.0))
    path = planner().plan(grid, Pose(0.05, 0.05), Pose(7.9, 5.9))
    assert path.length == pytest.approx(math.hypot(7.85, 5.85), rel=1e-6)


@pytest.mark.parametrize("body", [BODY, CAR], ids=["disc", "car"])
def test_a_path_to_where_the_robot_stands_is_a_path(body: Robot) -> None:
    for goal in (Pose(0.04, 0.03), Pose(0.01, 0.01)):
        poses = planner(body).plan(room(), Pose(0.01, 0.01), goal).poses
        assert len(poses) >= 2
        assert np.isfinite(poses).all()


@pytest.mark.parametrize("curves", ["dubins", "reeds_shepp"])
@pytest.mark.parametrize("algorithm", ["rrtstar", "rrtconnect", "prmstar", "kpiece1"])
def test_a_car_is_given_what_it_can_steer_and_its_body_stays_free(algorithm: str, curves: str) -> None:
    grid = walled_room()
    path = planner(CAR, algorithm=algorithm, **{"car.curves": curves}).plan(
        grid, Pose(-3.0, -3.0, math.pi), Pose(3.0, -3.0)
    )
    steps, turns = np.diff(path.poses[:, :2], axis=0), np.diff(np.unwrap(path.poses[:, 2]))
    lengths = np.hypot(*steps.T)
    assert path.poses[0] == pytest.approx((-3.0, -3.0, math.pi)) or path.poses[0] == pytest.approx(
        (-3.0, -3.0, -math.pi)
    )
    assert path.poses[-1, :2] == pytest.approx((3.0, -3.0))
    assert (np.abs(turns) <= lengths / TURN + 1e-6).all()
    ahead = np.cos(np.arctan2(steps[:, 1], steps[:, 0]) - path.poses[:-1, 2] - 0.5 * turns)
    assert np.abs(ahead)[lengths > 1e-6].min() > 0.999
    if curves == "dubins":
        assert ahead[lengths > 1e-6].min() > 0.0
    for x, y, theta in path.poses:
        corners = [Pose(x, y, theta).compose(Pose(*vertex)) for vertex in LONG.vertices_xy]
        for a, b in pairwise((*corners, corners[0])):
            side = np.linspace((a.x, a.y), (b.x, b.y), 12)
            assert not grid.occupied[tuple(grid.cells(side).T)].any()


def test_a_robot_is_refused_what_it_cannot_drive() -> None:
    forwards = replace(CAR, limits=replace(CAR.limits, vx_min=0.0))
    with pytest.raises(
        ConfigurationError, match=r"car\.curves is reeds_shepp; allowed: dubins, for sample cannot drive backwards"
    ):
        planner(forwards, **{"car.curves": "reeds_shepp"})
    for curves, refused in (("dubins", NOT_FOR_DUBINS), ("reeds_shepp", NOT_FOR_CARS)):
        for algorithm in refused:
            with pytest.raises(
                ConfigurationError,
                match=f"algorithm is {algorithm}; allowed for an Ackermann robot on {curves} curves: b",
            ):
                planner(CAR, algorithm=algorithm, **{"car.curves": curves})


def test_a_hundred_plans_leave_the_log_level_as_it_was_and_write_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    from ompl import util

    before = util.getLogLevel()
    used = planner(algorithm="rrtconnect")
    for _ in range(100):
        used.plan(walled_room(), Pose(-3.0, -3.0), Pose(3.0, -3.0))
    assert util.getLogLevel() == before
    assert capfd.readouterr() == ("", "")
