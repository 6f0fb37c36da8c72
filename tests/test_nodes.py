"""A node drives its share in a folder of its own and hands over what is finished, with its files."""

from contextlib import closing
from pathlib import Path

import pytest

from arena_core import InputFileError
from arena_core.hosting import Budgets, Delivery, Finished, Job, Node, OtherCode, compose, store_delivery, to_plain
from arena_core.runs.jobs.working import check_job, run_job
from arena_core.testing.checks import echo_job

ROOM = [
    "planner=pure_pursuit",
    "robot=jackal",
    "world=empty",
    "world.width=6",
    "world.height=6",
    "task.pedestrians=0",
    "episodes=2",
]
BUDGETS = Budgets(600.0, 60.0, 600.0, 4.0)


def over(node, do):
    done = []
    while node.unfinished:
        done += node.look(do)
    return done


@pytest.mark.slow
def test_what_a_node_finishes_comes_home_with_its_files_and_each_map_once(tmp_path):
    jobs = [Job(to_plain(compose(ROOM)), str(tmp_path / "home"), k) for k in range(2)]
    with closing(Node(1, BUDGETS, tmp_path / "node")) as node:
        node.add(jobs[:1])
        first = over(node, run_job)
        node.add(jobs[1:])
        second = over(node, run_job)
    assert [sorted(one.files)[-1].partition("/")[0] for one in (*first, *second)] == ["worlds", "timing"]
    assert not (tmp_path / "home").exists()
    answers = [store_delivery(one) for one in (*first, *second)]
    assert [one.job for one in answers] == jobs
    assert all(isinstance(one, Finished) and one.row["outcome"] == "goal_reached" for one in answers)
    there = sorted(path.relative_to(tmp_path / "home").parent.as_posix() for path in (tmp_path / "home").rglob("*.npz"))
    assert there == ["records", "records", "timing", "timing", "worlds"]
    assert [path.parent.name for path in (tmp_path / "node").rglob("*.npz")] == ["worlds"], "a node keeps no records"


@pytest.mark.slow
def test_what_a_node_finishes_of_a_team_comes_home_for_each_of_its_robots(tmp_path):
    words = ["task=antipodal", "task.team=2", "task.radius=1.0", "planner=pure_pursuit", "localizer=ground_truth"]
    config = to_plain(compose([*words, "world=empty", "world.width=4", "world.height=4", "pedestrians=none"]))
    job = Job(config, str(tmp_path / "home"), 2, None, 2)
    with closing(Node(1, BUDGETS, tmp_path / "node")) as node:
        node.add([job])
        (delivery,) = over(node, run_job)
    answer = store_delivery(delivery)
    assert [one.job.episode for one in (answer, *answer.team)] == [2, 3]
    assert {one.job.folder for one in (answer, *answer.team)} == {job.folder}
    assert [path.name for path in sorted((tmp_path / "home" / "records").glob("*.npz"))] == ["0002.npz", "0003.npz"]


def test_jobs_are_taken_on_while_others_run():
    with closing(Node(1, BUDGETS)) as node:
        node.add([Job({}, "", 0)])
        node.look(echo_job)
        node.add([Job({}, "", 1)])
        assert sorted(one.answer["episode"] for one in over(node, echo_job)) in ([1], [0, 1])


def test_other_code_is_refused_before_anything_runs():
    config = to_plain(compose(ROOM))
    node = Node(1, BUDGETS)
    with pytest.raises(OtherCode, match=r"has other code, [0-9a-f]{8} in place of 00000000: .*arena-core 0\.1\.0 "):
        node.add([Job({**config, "code": "00000000"}, "", 0)])
    node.add([Job({**config, "code": check_job(Job(config, "", 0)).code.digest}, "", 0)])
    assert node.unfinished == 1
    node.close()


@pytest.mark.parametrize(
    "name", ["../evil.npz", "/etc/passwd", "records/0000.npz/../../x", "episodes.csv", "records/0000.npz\n"]
)
def test_a_file_that_no_job_has_is_not_written(name, tmp_path):
    with pytest.raises(InputFileError, match="a node sent "):
        store_delivery(Delivery(None, Job({}, str(tmp_path / "run"), 0), {name: b""}))
    assert not Path(tmp_path / "run").exists()
