"""Two people stand in the doorway that the robot has to go through; they leave a gap.

Whoever dithers before them fails.
"""

from pathlib import Path

import numpy as np
import pytest

from arena_core.config.configuration import compose, to_plain
from arena_core.config.registry import load_registry
from arena_core.runs.jobs.benchmark import build_benchmark

SCENES = Path(__file__).parent / "scenes" / "two_people_in_a_doorway.json"
ROOM = (
    "world=empty",
    "world.width=7",
    "world.height=5",
    "localizer=ground_truth",
    "task=scenario",
    f"task.path={SCENES}",
)
# the scenes from the first on whose gap is wider than the robot by 0.15 m
FITS = {"turtlebot3": 4, "jackal": 4, "robotino": 2}


@pytest.mark.slow
@pytest.mark.parametrize("tracker", ["kalman", "none"])
@pytest.mark.parametrize("robot", FITS)
def test_teb_goes_through_the_gap_that_two_people_leave(robot, tracker, tmp_path):
    benchmark = build_benchmark(
        to_plain(compose(["planner=teb", f"robot={robot}", f"tracker={tracker}", *ROOM])), load_registry()
    )
    for episode in range(FITS[robot]):
        record = benchmark.run(episode, tmp_path)
        name = record.meta["columns"]["scenario"]
        assert record.meta["outcome"] == "goal_reached", name
        assert len(record["contact_stamp"]) == 0, name
        assert float(np.hypot(*np.diff(record["pose"][:, :2], axis=0).T).sum()) < 1.6 * 3.5, f"{name}: dithers"
        assert record["stamp"][-1] < 30.0, name
