"""Planners drive through passages that leave less than the gap that they would like, and swing
no tail into a wall beside them.
"""

import json
import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path as File

import numpy as np
import pytest

from arena_core import Costmap, EpisodeStart, NoValidCommand, Path, Pose, Twist, testing
from arena_core.records import read_record
from arena_kernels.costmap_window import CostmapWindow, footprint_outline, outline_clearance
from arena_kernels.distance import distance_field

RESOLUTION = 0.05  # m
PLANNERS = ("dwa", "teb", "mpc", "mppi")
WIDTHS = {"turtlebot3": 0.226, "jackal": 0.33, "robotino": 0.45, "jackal_ackermann": 0.33}  # m, of the footprints
ROOM = 0.1  # m that a gap is wider, rounded up to whole cells


def gap_of(robot: str) -> int:
    """Return how many cells the gap of a robot is wide."""
    return math.ceil((WIDTHS[robot] + ROOM) / RESOLUTION - 1e-9)


def lined(*positions: tuple[float, float]) -> Path:
    """Return a path along straight lines, its poses 5 cm apart."""
    lines = []
    for start, end in pairwise(positions):
        lines.append(np.linspace(start, end, round(math.dist(start, end) / 0.05), endpoint=False))
    points = np.concatenate((*lines, (positions[-1],)))
    steps = np.diff(points, axis=0)
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    return Path(np.column_stack((points, np.append(headings, headings[-1]))))


def drive(planner, body, costmap, path, pose, seconds):
    """Yield the poses of a robot that does what it is told within its accelerations; a refusal brakes it."""
    twist, limits, goal = Twist(0.0), body.limits, Pose(*path.poses[-1, :2])
    for k in range(round(10 * seconds)):
        ahead = path.poses[min(np.hypot(*(path.poses[:, :2] - (pose.x, pose.y)).T).argmin() + 20, len(path.poses) - 1)]
        seen = testing.observation(
            pose=pose, goal=goal, waypoint=Pose(*ahead[:2]), twist=twist, body=body, costmap=costmap, stamp=0.1 * k
        )
        try:
            told = planner.compute_velocity(replace(seen, path=path)).array()
        except NoValidCommand:
            told = np.zeros(3)
        most = 0.1 * np.array((limits.ax_max, limits.ay_max, limits.alpha_max))
        twist = Twist.of(np.clip(told, twist.array() - most, twist.array() + most))
        turn = Pose(0.0, 0.0, 0.05 * twist.wz)
        middle = turn.compose(Pose(0.1 * twist.vx, 0.1 * twist.vy))
        pose = pose.compose(Pose(middle.x, middle.y, 0.1 * twist.wz))
        yield pose


@pytest.mark.parametrize("robot", [pytest.param("turtlebot3", marks=pytest.mark.slow), "jackal"])
@pytest.mark.parametrize("preset", PLANNERS)
def test_planner_follows_its_path_through_a_gap(preset, robot):
    body = testing.component("robot", robot)
    cells = gap_of(robot)
    lethal = np.zeros((120, 120), np.bool_)
    lethal[:, 60:64] = True
    lethal[60 : 60 + cells, 60:64] = False
    distance, inscribed = distance_field(lethal, RESOLUTION), body.footprint.inscribed_radius
    costs = np.where(distance < 1.0, 252 * np.exp(-3.0 * (distance - inscribed)), 0.0)
    costs = np.where(lethal, 254, np.where(distance <= inscribed, 253, costs)).astype(np.uint8)
    middle = (60 + 0.5 * cells) * RESOLUTION
    path = lined((2.0, middle + 0.05), (2.7, middle), (5.5, middle))
    planner = testing.planner(preset, body, robot_preset=robot)
    planner.reset(EpisodeStart(None, Pose(5.5, middle), 0.1, np.random.default_rng(0)))
    window = CostmapWindow(costs, distance.astype(np.float32), RESOLUTION, 0.0, 0.0)
    outline = footprint_outline(body.footprint)
    for pose in drive(
        planner, body, Costmap(costs, distance, RESOLUTION, np.zeros(2)), path, Pose(2.0, middle + 0.05), 40.0
    ):
        assert (
            outline_clearance(window, outline, (pose.x, pose.y, math.cos(pose.theta), math.sin(pose.theta)), 1.0)
            > -1e-6
        )
        if pose.x > 4.0:
            return
    raise AssertionError(f"it stands at {pose}")


def draw_map(cells: np.ndarray) -> None:
    """Write hall.yaml and its image of cells, True where there is a wall; its border is walled too."""
    pixels = np.where(cells, 0, 254).astype(np.uint8)
    pixels[[0, -1]] = pixels[:, [0, -1]] = 0
    rows, columns = cells.shape
    File("hall.pgm").write_bytes(f"P5\n{columns} {rows}\n255\n".encode() + pixels[::-1].tobytes())
    thresholds = {"negate": 0, "occupied_thresh": 0.65, "free_thresh": 0.196}
    File("hall.yaml").write_text(
        json.dumps({"image": "hall.pgm", "resolution": RESOLUTION, "origin": [0.0, 0.0, 0.0], **thresholds})
    )


def run(arena, planner, robot, scenarios, *words):
    """Drive the scenarios in the hall, in its true pose, and return the records."""
    problems = [{"name": f"p{k}", "time_limit": 60.0, **scenario} for k, scenario in enumerate(scenarios)]
    File("scene.json").write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": problems}))
    world = (
        "world=ros_map",
        "world.path=hall.yaml",
        "task=scenario",
        "task.path=scene.json",
        f"episodes={len(problems)}",
    )
    quick = (f"robot={robot}", "localizer=ground_truth", "executor=serial", "report=false", "hydra.run.dir=run")
    answer = arena("run", f"planner={planner}", *quick, *world, *words)
    assert answer.status == 0, answer.errors
    return [read_record(path) for path in sorted(File("run/records").glob("*.npz"))]


@pytest.mark.slow
@pytest.mark.parametrize(
    "robot", [pytest.param(name, marks=[pytest.mark.long] * (name == "turtlebot3")) for name in WIDTHS]
)
@pytest.mark.parametrize("planner", PLANNERS)
def test_robot_gets_through_a_gap_that_is_ten_centimetres_wider_than_itself(planner, robot, arena):
    cells = np.zeros((80, 120), np.bool_)
    cells[:, 60:64] = True  # 0.2 m deep
    cells[40 : 40 + gap_of(robot), 60:64] = False
    draw_map(cells)
    middle = RESOLUTION * (40 + 0.5 * gap_of(robot))
    straight = {"start": [1.5, middle, 0.0], "goal": [4.7, middle]}
    oblique = {"start": [4.6, middle - 1.2, 2.0], "goal": [1.4, middle + 0.9]}
    records = run(arena, planner, robot, [straight, oblique])
    assert [record.meta["outcome"] for record in records] == ["goal_reached"] * 2
    assert not any(record["contact_caused"].any() for record in records)


@pytest.mark.slow
@pytest.mark.parametrize("planner", PLANNERS)
def test_car_gets_through_a_gap_to_which_it_comes_along_the_wall(planner, arena):
    cells = np.zeros((80, 120), np.bool_)
    cells[:, 60:64] = True
    cells[40 : 40 + gap_of("jackal_ackermann"), 60:64] = False
    draw_map(cells)
    middle = RESOLUTION * (40 + 0.5 * gap_of("jackal_ackermann"))
    aslant = {"start": [0.6, middle - 0.51, -1.24], "goal": [5.2, middle + 0.86]}
    away = {"start": [5.3, middle - 0.29, -1.65], "goal": [0.8, middle - 0.89]}
    records = run(arena, planner, "jackal_ackermann", [aslant, away])
    assert [record.meta["outcome"] for record in records] == ["goal_reached"] * 2


@pytest.mark.slow
@pytest.mark.parametrize("planner", ["teb", "mpc"])
def test_car_drives_through_a_passage_of_two_metres_in_a_quarter_of_a_minute(planner, arena):
    cells = np.zeros((80, 120), np.bool_)
    cells[:, 40:80] = True
    cells[40 : 40 + gap_of("jackal_ackermann"), 40:80] = False
    draw_map(cells)
    middle = RESOLUTION * (40 + 0.5 * gap_of("jackal_ackermann"))
    (record,) = run(arena, planner, "jackal_ackermann", [{"start": [0.8, middle + 0.03, 0.0], "goal": [5.2, middle]}])
    assert record.meta["outcome"] == "goal_reached"
    assert record["stamp"][-1] < 15.0
    assert not record["contact_caused"].any()


@pytest.mark.slow
@pytest.mark.parametrize("planner", [*PLANNERS, "orca"])
def test_robot_that_stands_beside_a_wall_leaves_without_touching_it(planner, arena):
    draw_map(np.zeros((120, 100), np.bool_))
    beside = 0.05 + 0.05 + 0.5 * WIDTHS["jackal"]  # 5 cm between its left side and the wall, along which it looks
    away, along, behind = ([beside, y, 0.5 * math.pi] for y in (4.0, 1.2, 4.0))
    scenarios = [
        {"start": away, "goal": [3.5, 4.0]},
        {"start": along, "goal": [beside, 4.5]},
        {"start": behind, "goal": [beside + 0.3, 1.2]},
    ]
    records = run(arena, planner, "jackal", scenarios)
    assert [record.meta["outcome"] for record in records] == ["goal_reached"] * 3
    assert [int(record["contact_caused"].sum()) for record in records] == [0] * 3
