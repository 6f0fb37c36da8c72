"""Robots and people together: what reactions, coming and leaving do to a whole run."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arena_core import Pose
from arena_core.records import read_record
from arena_core.testing import component, robot, scenario
from arena_core.testing.samples import person


def blind_drive(reaction: str) -> tuple[float, int]:
    """Let a robot drive straight on past a person; return how far it got in 15 s (m) and how
    often it touched a person.
    """
    crowd = component("pedestrians", "social_force", [f"pedestrians.reaction={reaction}"])
    simulator = component("simulator", "sim2d", robot=robot(), pedestrians=crowd)
    problem = scenario(start=Pose(-4.0, 0.0), people=[person(0, -0.5, 2.5, (-0.5, 4.0), (-0.5, 2.5), speed=0.8)])
    simulator.reset([problem])
    ticks = round(0.1 / simulator.inner_step)
    drive = [simulator.advance(np.array(((0.4, 0.0, 0.0),)), ticks) for _ in range(150)]
    return float(drive[-1].poses[0, 0] + 4.0), sum(len(snapshot.contacts[0]) for snapshot in drive)


def test_a_robot_that_drives_straight_on_is_stopped_by_the_threatening_alone():
    reached = {reaction: blind_drive(reaction) for reaction in ("ignore", "yield", "curious", "scared", "threatening")}
    for reaction in ("ignore", "yield", "curious", "scared"):
        assert reached[reaction] == pytest.approx((5.9, 0), abs=0.1)
    assert reached["threatening"][0] < 4.5
    assert reached["threatening"][1] > 0


def test_a_person_who_comes_and_goes_is_recorded_drawn_and_measured_while_there(arena):
    people = [
        {
            "position": [3, 6],
            "waypoints": [[3, 6], [5, 6]],
            "desired_speed": 1.0,
            "behaviour": {"spawn_time": 1.0, "respawn": 1},
        }
    ]
    problem = {"name": "coming", "start": [1, 2, 0], "goal": [7, 2], "pedestrians": people}
    Path("coming.json").write_text(json.dumps({"format": "arena-scenario", "version": 1, "scenarios": [problem]}))
    world = ("world=empty", "world.width=8", "world.height=8", "task=scenario", "task.path=coming.json", "episodes=1")
    quick = (
        "planner=pure_pursuit",
        "robot=turtlebot3",
        "localizer=ground_truth",
        "executor=serial",
        "hydra.run.dir=run",
    )
    answer = arena("run", *quick, *world)
    assert (answer.status, answer.errors) == (0, [])
    record = read_record(Path("run/records/0000.npz"))
    absent = np.isnan(record["pedestrian_positions"][:, 0, 0])
    assert absent[0]
    assert np.count_nonzero(np.diff(absent.astype(int)) == -1) >= 2
    assert ((record["pedestrian_states"][:, 0] == 0) == absent).all()
    assert (np.isinf(record["clearance_people"]) == absent).all()
    with Path("run/episodes.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert float(row["clearance_people_min"]) > 0.0
    assert Path("run/report/index.html").exists()


def test_who_starts_beside_the_robot_waits_until_it_has_gone():
    crowd = component("pedestrians", "social_force")
    simulator = component("simulator", "sim2d", robot=robot(), pedestrians=crowd)
    waits = replace(person(0, -1.5, 0.2), behaviour={"spawn_time": 0.5})
    simulator.reset([scenario(start=Pose(-1.5, 0.0), people=[waits])])
    ticks = round(0.1 / simulator.inner_step)
    drive = [simulator.advance(np.array(((0.5 if k > 30 else 0.0, 0.0, 0.0),)), ticks) for k in range(140)]
    there = [bool(np.isfinite(snapshot.crowd.positions).all()) for snapshot in drive]
    assert not any(there[:31])
    assert there[-1]
    assert min(snapshot.clearances_people[0] for snapshot in drive) > 2.5
