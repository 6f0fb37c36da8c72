"""``arena break``: what is refused, and a whole small search of real episodes."""

import json
import os
from pathlib import Path

import pytest

from arena_break.command import BreakCommand
from arena_core import ArenaError, ConfigurationError, InputFileError, Runs
from arena_core.records import record_digest
from arena_tasks.scenario_files.pack import verified_pack

SMALL = (
    "planner=pure_pursuit",
    "robot=jackal",
    "world=empty",
    "localizer=ground_truth",
    "tracker=ground_truth",
    "executor=serial",
    "bounds=small.yaml",
    "count=2",
)
BOUNDS = "batch: 4\npeople: {most: 2, fastest: 1.2}\nkeys: [0, 1]\n"


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("small.yaml").write_text(BOUNDS)
    return tmp_path


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["robot=jackal"], "planner is missing"),
        (["planner=nobody", "robot=jackal"], "nobody"),
        (["planner=teb", "robot=jackal", "budget=3"], "budget is 3; allowed: 24 problems at least"),
        (["planner=teb", "robot=jackal", "count=0"], "count is 0"),
        (["planner=teb", "robot=jackal", "task=random"], "task is given"),
        (["planner=teb", "robot=jackal", "task.goal_radius=1"], r"task\.goal_radius is given"),
        (["planner=teb", "robot=jackal", "people=lifelike"], "people are chosen"),
        (["planner=teb", "robot=jackal", "pedestrians.reaction=yield"], "people are chosen"),
        (["planner=teb", "robot=jackal", "bounds=none.yaml"], r"none\.yaml"),
        (["planner=teb", "robot=jackal", "world=empty", "world.width=4", "world.height=4"], "no start and goal"),
        (["join", "out=pack"], "DIR is missing"),
        (["join", "nowhere", "out=pack"], "nowhere"),
        (["table"], "DIR is missing"),
        (["table", "nowhere"], "nowhere"),
    ],
)
def test_what_is_wrong_with_a_request_is_one_line_before_anything_is_written(words, said, place):
    with pytest.raises(ArenaError, match=said) as caught:
        BreakCommand().run(words)
    assert "\n" not in str(caught.value)
    assert [path.name for path in place.iterdir()] == ["small.yaml"]


@pytest.fixture(scope="module")
def searched(tmp_path_factory):
    """The folder of a search of two batches."""
    folder = tmp_path_factory.mktemp("searched")
    (folder / "small.yaml").write_text(BOUNDS)
    before = Path.cwd()
    os.chdir(folder)
    try:
        assert BreakCommand().run([*SMALL, "budget=8", "out=whole"]) == 0
    finally:
        os.chdir(before)
    return folder


@pytest.mark.slow
def test_a_search_leaves_a_pack_with_certificates_causes_and_pictures(searched):
    card = json.loads((searched / "whole/card.json").read_text())
    assert 1 <= len(card["problems"]) <= 2
    assert card["search"]["problems"] <= 8
    pack = verified_pack(searched / "whole/pack")
    assert pack.id == "hard_pure_pursuit_jackal"
    for one in card["problems"]:
        assert one["clearance"] >= 0.15
        assert one["time_certified"] > 0.0
        assert one["cause"]
        assert set(one["keys"]) == {"0", "1"}
        assert (searched / f"whole/pictures/{one['name']}.png").is_file()
    strict = [row["strict_success"] for run in Runs.below(searched / "whole/evidence") for row in rows_of(run)]
    assert sorted(strict) == [0.0] * (2 * len(card["problems"])) + [1.0] * len(card["problems"])


@pytest.mark.slow
def test_a_search_that_was_cut_short_and_had_other_workers_comes_to_the_same(searched, monkeypatch):
    monkeypatch.chdir(searched)
    words = [*SMALL, "budget=8", "out=cut"]
    others = [word for word in words if word != "executor=serial"]

    def stop(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("arena_break.searching._add", stop)  # within the first batch, once it was driven
        with pytest.raises(KeyboardInterrupt):
            BreakCommand().run([*others, "executor=processes", "executor.workers=2"])
    with pytest.raises(ConfigurationError, match="resume=true goes on with it"):
        BreakCommand().run(words)
    with pytest.raises(ConfigurationError, match="another count"):
        BreakCommand().run([*SMALL[:-1], "count=3", "budget=8", "out=cut", "resume=true"])
    assert BreakCommand().run([*words, "resume=true"]) == 0
    for name in ("card.json", "problems.csv", "pack/pack.yaml"):
        assert (searched / "cut" / name).read_bytes() == (searched / "whole" / name).read_bytes()
    assert digests(searched / "cut/evidence") == digests(searched / "whole/evidence")


@pytest.mark.slow
def test_a_planner_that_raises_in_every_episode_is_no_planner_to_search_against(place, monkeypatch):
    def fails(*_):
        raise ValueError("no such key")

    monkeypatch.setattr("arena_pure_pursuit.PurePursuit.compute_velocity", fails)
    with pytest.raises(
        ConfigurationError, match="ends every episode of a batch with an error: ValueError: no such key"
    ):
        BreakCommand().run([*SMALL, "budget=4", "out=raises"])


@pytest.mark.slow
def test_packs_are_joined_in_equal_shares_and_their_runs_compared(searched, monkeypatch, capsys):
    monkeypatch.chdir(searched)
    with pytest.raises(ConfigurationError, match="allowed: searches of different seeds"):
        BreakCommand().run(["join", "whole", "whole", "out=hard_small", "share=9"])
    assert BreakCommand().run(["join", "whole", "out=hard_small", "share=1"]) == 0
    assert verified_pack(searched / "hard_small").scenario_files() == ["scenarios/jackal_empty.json"]
    assert len((searched / "hard_small/certificates.csv").read_text().splitlines()) == 2
    capsys.readouterr()
    assert BreakCommand().run(["table", "whole/evidence/planner_0", "out=table.csv"]) == 0
    assert "pure_pursuit_jackal" in capsys.readouterr().out
    assert (searched / "table.csv").read_text().startswith("planner on robot,")


@pytest.mark.slow
def test_a_card_that_is_none_is_refused(searched):
    (searched / "other").mkdir()
    (searched / "other/card.json").write_text("{}")
    with pytest.raises(InputFileError, match=r"card\.json: is no card"):
        BreakCommand().run(["join", str(searched / "other"), "out=x"])


def rows_of(run):
    return run.episodes.to_dict("records")


def digests(folder):
    """Return what identifies the records below a folder, by their place."""
    return {
        str(path.relative_to(folder)): record_digest(run.record(int(path.stem)))
        for run in Runs.below(folder)
        for path in sorted(Path(run.folder).glob("records/*.npz"))
    }
