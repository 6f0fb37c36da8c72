"""How often a growing table is written."""

from time import monotonic

import pytest

from arena_core.contracts.running import Finished, Job
from arena_core.runs.folders.schedule import WRITE_EVERY, WRITE_SHARE, OpenRun
from arena_core.runs.jobs.code_digest import Code


@pytest.mark.parametrize(
    ("since", "took", "written"),
    [
        (0.0, 0.0, False),
        (WRITE_EVERY + 0.1, 0.0, True),
        (WRITE_EVERY + 0.1, 1000.0, False),
        (1000.0 / WRITE_SHARE + 0.1, 1000.0, True),
    ],
)
def test_a_table_that_takes_long_is_written_less_often(tmp_path, since, took, written):
    run = OpenRun({"episodes": 2}, tmp_path, {}, None, Code("", {}), written=monotonic() - since, write_took=took)
    job = Job({}, str(tmp_path), 1)
    run.take(Finished(job, {"episode": 1, "outcome": "goal_reached"}, True))
    assert run.left() == 1
    assert (tmp_path / "episodes.csv").exists() == written
