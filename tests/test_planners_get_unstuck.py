"""Places where robots have been seen to stand for ever though there is a way: each planner gets
through in the time that it needs.
"""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from arena_core.records import read_record

LONGEST = 20.0  # s that a robot may stay within a circle
CIRCLE = 0.3  # m
LONGEST_LEAN = 5.0  # s that a robot may lean on what it does not see

RESOLUTION = 0.05  # m
WIDTH, HEIGHT = 8.0, 6.0  # m

Box = tuple[float, float, float, float]  # x_min, x_max, y_min, y_max, m

# posts on no map, gaps of 0.1 m; its ends are open
FENCE = [{"center": [4.0, 2.0 + 0.3 * k], "radius": 0.1} for k in range(10)]
DOOR: list[Box] = [(4.0, 4.2, 0.0, 2.8), (4.0, 4.2, 3.2, 6.0)]  # a gap of 0.40 m
# its end is just before the robot, a little aside: it must turn away from its path first
POST: list[Box] = [(0.0, 3.0, 3.0, 3.1)]
PERSON = {"position": [2.6, 3.0], "waypoints": [[2.6, 3.0]], "desired_speed": 0.3}

SCENES: dict[str, tuple[list[Box], dict[str, Any]]] = {
    "posts before the waypoint": ([], {"start": [3.5, 3.3, 0.0], "goal": [5.2, 3.3], "obstacles": FENCE}),
    "a narrow gap": (DOOR, {"start": [2.5, 3.6, 0.0], "goal": [6.0, 3.0]}),
    "a narrow gap behind a person who stands": (
        DOOR,
        {"start": [1.0, 3.0, 0.0], "goal": [6.0, 3.0], "pedestrians": [PERSON]},
    ),
    "a door post at the robot's shoulder": (POST, {"start": [3.07, 2.82, 1.27], "goal": [1.0, 4.5]}),
}

NICHE: list[Box] = [(3.0, 5.0, 3.4, 3.5), (3.0, 5.0, 2.5, 2.6), (5.0, 5.1, 2.5, 3.5)]
CORNER: list[Box] = [(3.0, 6.0, 3.0, 3.1), (5.9, 6.0, 3.0, 5.0)]

# walls, start and goal of a robot right behind which, where its scanner sees nothing, a person stands
UNSEEN: dict[str, tuple[list[Box], list[float], list[float]]] = {
    "before a wall": ([(3.35, 3.45, 2.0, 4.0)], [3.0, 3.0, 0.0], [6.0, 3.0]),
    "goal beside a wall": ([], [6.0, 0.5, -1.57], [7.4, 0.5]),
    "goal out of a niche": (NICHE, [4.6, 3.0, 0.0], [1.0, 3.0]),
    "goal behind a corner": (CORNER, [5.5, 3.45, 0.0], [5.5, 1.5]),
}


def draw_map(walls: list[Box]) -> None:
    """Write hall.yaml and its image: a room with walls about it and in it."""
    columns, rows = round(WIDTH / RESOLUTION), round(HEIGHT / RESOLUTION)
    cells = np.full((rows, columns), 254, np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = 0
    for x_min, x_max, y_min, y_max in walls:
        cells[
            round(y_min / RESOLUTION) : round(y_max / RESOLUTION), round(x_min / RESOLUTION) : round(x_max / RESOLUTION)
        ] = 0
    Path("hall.pgm").write_bytes(f"P5\n{columns} {rows}\n255\n".encode() + cells[::-1].tobytes())
    thresholds = {"negate": 0, "occupied_thresh": 0.65, "free_thresh": 0.196}
    site = {"image": "hall.pgm", "resolution": RESOLUTION, "origin": [0.0, 0.0, 0.0], **thresholds}
    Path("hall.yaml").write_text(json.dumps(site))


def longest_stand(stamps: np.ndarray, positions: np.ndarray) -> float:
    """Return the longest time that a robot stays within CIRCLE of where it was, s."""
    longest = 0.0
    for i in range(len(stamps)):
        left = np.flatnonzero(np.hypot(*(positions[i:] - positions[i]).T) > CIRCLE)
        longest = max(longest, float(stamps[i + left[0] if len(left) else -1] - stamps[i]))
    return longest


def run_scene(arena, planner: str, robot: str, walls: list[Box], task: dict[str, Any], time_limit: float) -> Any:
    """Drive one problem in a hall and return its record."""
    draw_map(walls)
    problem = {"name": "scene", "time_limit": time_limit, **task}
    Path("scene.json").write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": [problem]}))
    world = ("world=ros_map", "world.path=hall.yaml", "task=scenario", "task.path=scene.json", "episodes=1")
    quick = (f"robot={robot}", "localizer=ground_truth", "executor=serial", "report=false", "hydra.run.dir=run")
    answer = arena("run", f"planner={planner}", *quick, *world)
    assert answer.status == 0, answer.errors
    return read_record(Path("run/records/0000.npz"))


@pytest.mark.slow
@pytest.mark.parametrize("name", list(SCENES))
@pytest.mark.parametrize("planner", ["dwa", "mppi"])
def test_robot_gets_through(planner, name, arena):
    record = run_scene(arena, planner, "turtlebot3", *SCENES[name], 90.0)
    assert record.meta["outcome"] == "goal_reached"
    assert longest_stand(record["stamp"], record["pose"][:, :2]) < LONGEST
    assert not record["contact_caused"].any()


def longest_lean(record: Any) -> float:
    """Return the longest time that a robot touches something without a break, s."""
    longest, since = 0.0, None
    for stamp, touches in zip(record["stamp"], record["in_contact"], strict=True):
        since = (stamp if since is None else since) if touches else None
        longest = max(longest, 0.0 if since is None else float(stamp - since))
    return longest


# scene and how far behind the robot the person stands, m: 5 cm off its back; so far off that what frees it is refused
BEHIND = [*((name, 0.56) for name in UNSEEN), ("goal out of a niche", 0.62)]


@pytest.mark.parametrize(("name", "distance"), BEHIND)
@pytest.mark.parametrize("planner", ["teb", "navrep"])
def test_robot_does_not_lean_on_a_person_behind_it_whom_it_does_not_see(planner, name, distance, arena):
    walls, (x, y, heading), goal = UNSEEN[name]
    behind = [x - distance * math.cos(heading), y - distance * math.sin(heading)]
    person = {"position": behind, "waypoints": [behind], "desired_speed": 0.3}
    task = {"start": [x, y, heading], "goal": goal, "pedestrians": [person]}
    record = run_scene(arena, planner, "jackal", walls, task, 40.0)
    assert longest_lean(record) < LONGEST_LEAN
    reasons = [event["detail"] for event in record.meta["events"] if event["kind"] == "recovery"]
    assert "drive_on: its commands move nothing" in reasons
