"""A robot that comes to a closed door waits or goes round, and is locked out by nothing that it remembers of it."""

import json

import pytest

import arena_core as arena
from arena_core.records import read_record

LEAF = [[4.0, 1.4], [4.1, 1.4], [4.1, 2.6], [4.0, 2.6]]


def drive(folder, planner, opens, top):
    """Return the record of a drive through the door in a wall that reaches up to ``top``, in a hall of 8 by 6 m."""
    wall = [[[4.0, 0.0], [4.1, 0.0], [4.1, 1.4], [4.0, 1.4]], [[4.0, 2.6], [4.1, 2.6], [4.1, top], [4.0, top]]]
    problem = {
        "name": "door",
        "start": [1.0, 2.0],
        "goal": [7.0, 2.0],
        "obstacles": [{"vertices": part} for part in wall],
        "doors": [{"vertices": LEAF, "open": [[opens]]}],
    }
    path = folder / "door.json"
    path.write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": [problem]}))
    words = [f"planner={planner}", "robot=jackal", "world=empty", "world.width=8", "world.height=6", "task=scenario"]
    words += [f"task.path={path}", "task.time_limit=60", "pedestrians=none", "localizer=ground_truth"]
    arena.run([*words, "episodes=1", "executor=serial", "report=false"], folder / "run")
    return read_record(folder / "run" / "records" / "0000.npz")


@pytest.mark.parametrize("planner", [pytest.param("dwa", marks=pytest.mark.slow), "teb"])
def test_a_robot_waits_before_the_only_door_and_drives_on_once_it_has_opened(tmp_path, planner):
    record = drive(tmp_path, planner, opens=15.0, top=6.0)
    arrived, through = float(record["stamp"][-1]), record["stamp"][record["pose"][:, 0] > 4.1][0]
    assert record.meta["outcome"] == "goal_reached"
    assert len(record["contact_stamp"]) == 0
    assert 15.0 < through < arrived < 40.0  # a closed place, which lasts 60 s, does not keep it out


def test_a_robot_goes_round_a_closed_door_where_there_is_another_way(tmp_path):
    record = drive(tmp_path, "dwa", opens=50.0, top=4.2)
    assert record.meta["outcome"] == "goal_reached"
    assert record["stamp"][-1] < 30.0
    assert record["pose"][:, 1].max() > 4.2
    assert len(record["contact_stamp"]) == 0
