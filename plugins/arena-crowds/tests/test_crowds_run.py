import csv

import numpy as np
import pytest

from arena_core.cli.main import main
from arena_core.records import read_record
from arena_core.testing import component


def run(tmp_path, *overrides):
    common = [
        "episodes=2",
        "executor=serial",
        "report=false",
        "planner=dwa",
        "robot=turtlebot3",
        "task=random",
        "task.time_limit=6.0",
    ]
    assert main(["run", *common, *overrides, f"hydra.run.dir={tmp_path}"]) == 0
    with (tmp_path / "episodes.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_none_puts_nobody_there(stage):
    crowd = component("pedestrians", "none").reset(
        np.arange(3), [stage.crowded(stage.hall(9, 9), 4, k) for k in range(3)], 3
    )
    assert crowd.counts.tolist() == [0, 0, 0]
    assert crowd.positions.shape == (3, 0, 2)


@pytest.mark.slow
@pytest.mark.parametrize(("model", "there"), [("none", 0), ("orca", 4)])
def test_episodes_say_how_many_people_were_there(tmp_path, model, there):
    rows = run(tmp_path, "world=empty", f"pedestrians={model}", "task.pedestrians=4")
    assert [row["n_pedestrians"] for row in rows] == [str(there)] * 2
    assert {row["pedestrian_model"] for row in rows} == {model}


def test_a_run_among_recorded_people_counts_and_records_them(tmp_path):
    overrides = ["world=empty", "world.width=12.0", "world.height=12.0", "pedestrians=replay", "task.pedestrians=3"]
    for episode, row in enumerate(run(tmp_path, *overrides)):
        record = read_record(tmp_path / "records" / f"{episode:04d}.npz")
        seen = np.isfinite(record["pedestrian_positions"]).all(axis=2)
        assert int(row["n_pedestrians"]) == seen.any(axis=0).sum() > 0
        assert ((record["pedestrian_states"] != 0) == seen).all()
