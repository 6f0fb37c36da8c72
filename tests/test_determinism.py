"""Same seed, versions and machine: same records, bit for bit, however they are run."""

from pathlib import Path

import pytest

BUSY = ("planner=dwa", "robot=jackal", "world=warehouse", "task.pedestrians=3", "task.time_limit=15", "report=false")


def records(folder):
    return {path.name: path.read_bytes() for path in sorted(Path(folder, "records").glob("*"))}


@pytest.fixture
def run(arena):
    def run(folder, *words):
        assert arena("run", *BUSY, f"hydra.run.dir={folder}", *words).status == 0
        return records(folder)

    return run


@pytest.mark.slow
def test_two_workers_give_the_records_that_one_gives(run):
    one = run("one", "executor=serial", "episodes=3")
    two = run("two", "executor=processes", "executor.workers=2", "episodes=3")
    assert len(one) == 3
    assert one == two


@pytest.mark.slow
def test_an_episode_does_not_depend_on_those_before_it(run):
    whole = run("whole", "executor=serial", "episodes=2")
    first = run("part", "executor=serial", "episodes=1")
    assert first.items() <= whole.items()
    Path("part/records/0000.npz").unlink()
    Path("part/records/0000.npz").write_bytes(whole["0000.npz"])
    continued = run("part", "executor=serial", "episodes=2", "resume=true")
    assert continued == whole


def test_another_seed_gives_other_records(run):
    assert run("zero", "executor=serial", "episodes=1") != run("one", "executor=serial", "episodes=1", "seed=1")
