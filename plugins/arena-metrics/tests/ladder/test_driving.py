"""A ladder on disk: real episodes of one cell, its blocks as they are read, and what is refused."""

import csv
import json
from pathlib import Path

import pytest

from arena_core import ConfigurationError, InputFileError, Runs
from arena_core.records import EPISODE_COLUMNS, FindingColumn, Findings, record_digest, record_path, write_findings
from arena_ladder.command import LadderCommand
from arena_ladder.driving import LadderFolder
from arena_ladder.plan import make_plan

PLAN = make_plan("hall", "slow", 24, 0.2)
WORDS = ("planner=pure_pursuit", "robot=jackal")
HEADER = [*EPISODE_COLUMNS, "success", "strict_success", "people_per_100m2"]


def write_block(folder, number, density, outcomes):
    """Write the table of a block: of each episode its outcome, error and success."""
    path = folder / "hall_slow" / f"{number:03d}_{density:g}"
    path.mkdir(parents=True)
    with (path / "episodes.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, HEADER, restval="")
        writer.writeheader()
        for episode, (outcome, error, success) in enumerate(outcomes):
            seed = PLAN.seed + number
            row = {"episode": episode, "seed": seed, "outcome": outcome, "error": error, "success": success}
            writer.writerow({**row, "strict_success": success, "people_per_100m2": density if success != "" else ""})
    return path


@pytest.fixture
def ladder(tmp_path):
    """A ladder whose planner once raised an error, and whose people once found no room."""
    found = LadderFolder(tmp_path / "mine", PLAN, WORDS)
    found.begin(resume=False)
    write_block(found.folder, 0, 0, [("goal_reached", "", 1.0)] * 8)
    error = ("error", "ValueError: no", "")
    full = ("error", "ImpossibleScenario: density/0002 in world hall: no room", "")
    write_block(found.folder, 1, 4, [("goal_reached", "", 1.0)] * 5 + [("time_out", "", 0.0), error, full])
    write_block(found.folder, 2, 12, [full] * 5 + [("time_out", "", 0.0)] * 3)
    return found


def test_an_error_of_the_planner_is_a_failure_and_a_problem_without_room_is_none(ladder):
    _, second, _ = ladder.blocks()["hall_slow"]
    assert (second.rung, second.no_room, second.episodes, second.successes, second.density) == (3, 1, 7, 5, 4.0)


def test_rungs_without_room_are_said_on_the_page(ladder, capsys):
    assert LadderCommand().run(["report", str(ladder.folder)]) == 0
    assert "hall, slow: rungs left out, no room: 12, 16, 24" in capsys.readouterr().out
    told = json.loads((ladder.folder / "ladder.json").read_text())["ladders"][0]["cells"]["hall_slow"]
    assert (told["episodes"], told["no_room"], told["rungs_without_room"]) == (18, 6, [12.0, 16.0, 24.0])
    assert "rungs left out" in (ladder.folder / "ladder.html").read_text()


def test_clairvoyants_curve_is_that_of_its_certificates(ladder):
    solvable = FindingColumn("solvable", "text", "neither", "")
    rows = {number: {"solvable": "yes" if number < 7 else "unknown"} for number in range(8)}
    write_findings(ladder.folder / "hall_slow" / "001_4", Findings("reference", "x", [solvable], rows))
    assert [drive.success for drive in ladder.limit()] == [True] * 7 + [False]


def test_a_folder_with_a_ladder_is_taken_for_no_other(ladder):
    with pytest.raises(ConfigurationError, match="resume=true continues it"):
        ladder.begin(resume=False)
    LadderFolder(ladder.folder, PLAN, [*WORDS, "executor.workers=2"]).begin(resume=True)
    with pytest.raises(ConfigurationError, match="only the same one"):
        LadderFolder(ladder.folder, make_plan("hall", "slow", 24, 0.3), WORDS).begin(resume=True)
    assert LadderFolder.read(ladder.folder).plan == PLAN


def test_a_larger_cap_goes_on_where_a_smaller_one_ended(ladder):
    more = make_plan("hall", "slow", 48, 0.2)
    LadderFolder(ladder.folder, more, WORDS).begin(resume=True)
    assert LadderFolder.read(ladder.folder).plan == more
    with pytest.raises(ConfigurationError, match="cap is 24; allowed: 48 or more"):
        ladder.begin(resume=True)


@pytest.mark.parametrize("text", ["{}", '{"plan": {}, "words": []}', '{"plan": 3, "words": 4}', "nothing"])
def test_a_broken_request_is_one_line(tmp_path, text):
    (tmp_path / "ladder_request.json").write_text(text)
    with pytest.raises(InputFileError, match=r"ladder_request\.json"):
        LadderFolder.read(tmp_path)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["planner=dwa"], "robot is missing"),
        (["planner=dwa", "robot=jackal", "seed=3"], "seed is given"),
        (["planner=dwa", "robot=jackal", "task.density=3"], "task.density is given"),
        (["planner=dwa", "robot=jackal", "worlds=cellar"], "allowed: hall, aisles, rooms"),
        (["planner=dwa", "robot=jackal", "precision=0"], "precision is 0"),
        (["report"], "DIR is missing"),
    ],
)
def test_what_is_wrong_with_a_request_is_said_before_anything_is_written(words, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigurationError, match=said):
        LadderCommand().run(words)
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_a_ladder_that_was_cut_short_goes_on_to_the_same_bits(tmp_path):
    words = (*WORDS, "executor=serial", "localizer=ground_truth", "tracker=ground_truth", "task.random.time_limit=20")
    whole, cut = (LadderFolder(tmp_path / name, PLAN, words) for name in ("whole", "cut"))
    for one in (whole, cut):
        one.begin(resume=False)
    whole.drive(lambda number, due: None)

    class Stopped(Exception):
        """Stands for a signal between two rounds."""

    def stop(number, due):
        if number == 1:
            raise Stopped

    with pytest.raises(Stopped):
        cut.drive(stop)
    lost = record_path(next(iter(Runs.below(cut.folder))).folder, 7)
    lost.unlink()
    (lost.parents[1] / "episodes.csv").unlink()
    LadderFolder(cut.folder, PLAN, words).drive(lambda number, due: None)
    assert digests(cut.folder) == digests(whole.folder)
    assert [block.episodes for block in whole.blocks()["hall_slow"]] == [8, 8, 8]


def digests(folder):
    """Return what identifies the records below a folder, by their place."""
    return {
        str(path.relative_to(folder)): record_digest(run.record(int(path.stem)))
        for run in Runs.below(folder)
        for path in sorted(Path(run.folder).glob("records/*.npz"))
    }
