"""`arena tune`: from a planner and a robot to a preset with its card; what is finished is kept."""

import json
import shutil
from pathlib import Path

import optuna
import pytest

from arena_core.hosting import lock_folder
from arena_tuning.journal import Journal

SPACE = "parameters: {speed: {low: 0.3, high: 1.5, unit: m/s, why: it need not be slow}}\n"
PROBLEMS = """
version: 1
words: [world=empty, world.width=8, world.height=8, task.time_limit=40, localizer=ground_truth]
cells: [[task.pedestrians=0]]
entrants: 4
blocks: [1, 2]
tune: {seed: 1}
validate: {seed: 2, problems: 2}
test: {seed: 3, problems: 7}
"""
WORDS = ("planner=pure_pursuit", "robot=jackal", "problems=tiny", "planner.speed=0.4", "executor=serial")

EPISODES = Path("tuning/episodes.jsonl")
PRESET = Path("conf/planner/pure_pursuit_tuned_jackal.yaml")


@pytest.fixture
def tune(arena):
    """Call ``arena tune`` for a planner that drives too slowly, with more words."""
    for name, text in (("tune/pure_pursuit", SPACE), ("problems/tiny", PROBLEMS)):
        file = Path("conf", f"{name}.yaml")
        file.parent.mkdir(parents=True)
        file.write_text(text)

    def call(*words):
        others = [word for word in WORDS if word.partition("=")[0] not in [one.partition("=")[0] for one in words]]
        return arena("tune", *others, "out=tuning", *words)

    return call


def driven(text):
    return sorted(json.loads(line)["key"] for line in text.splitlines())


def card():
    return json.loads(Path("tuning/card.json").read_text())


def test_what_is_better_becomes_a_preset_with_a_card_that_runs_can_choose_and_tell_of(tune, arena):
    answer = tune("budget=20")
    assert (answer.status, answer.errors) == (0, [])
    found = card()
    assert found["better"], found["verdict"]
    assert found["present"] == {"speed": 0.4} != found["values"]
    assert found["budget"] == {"asked": "20", "episodes": 20 + 2 * 5 + 14, "search": 20, "validate": 10, "test": 14}
    assert found["test"]["figures"]["strict_success"]["pairs"] == 7
    assert [episodes for episodes, _ in found["curve"]] == [2, 8, 14, 20]
    assert answer.out.splitlines()[-1] == f"written: {PRESET}, which planner=pure_pursuit_tuned_jackal chooses"
    assert f"speed: {found['values']['speed']}  # [m/s] it need not be slow (tuned)" in PRESET.read_text()
    assert Path("tuning/report/index.html").exists()

    words = ("planner=pure_pursuit_tuned_jackal", "robot=jackal", "world=empty", "world.width=8", "world.height=8")
    short = ("episodes=1", "task.pedestrians=0", "task.time_limit=1", "localizer=ground_truth", "executor=serial")
    assert arena("run", *words, *short, "report=false", "out=run").status == 0
    provenance = json.loads(Path("run/provenance.json").read_text())
    assert provenance["config"]["planner"]["speed"] == found["values"]["speed"]
    told = provenance["tuning"]
    assert (told["tuned"], told["budget"]) == ("by arena tune for jackal", found["budget"]["episodes"])

    study = optuna.load_study(study_name="tune", storage="sqlite:///tuning/study.db")  # which optuna-dashboard shows
    states = [trial.state.name for trial in study.trials]
    assert (states.count("COMPLETE"), states.count("PRUNED")) == (6, 6)


@pytest.fixture(scope="module")
def once(tmp_path_factory):
    """Where the finished tuning of the first test that asks for one is kept for the others."""
    return tmp_path_factory.mktemp("once") / "work"


@pytest.fixture
def finished(tune, once):
    """A tuning that has come to its end, and the call that made it."""
    if not once.exists():
        answer = tune("budget=14", "preset=first")
        assert answer.status == 0, answer.errors
        shutil.copytree(".", once)
    shutil.copytree(once, ".", dirs_exist_ok=True)
    return tune


@pytest.mark.parametrize(
    "kept", [pytest.param(0.0, marks=pytest.mark.slow), 0.45, pytest.param(1.0, marks=pytest.mark.slow)]
)
def test_a_tuning_that_was_killed_goes_on_and_comes_to_the_same_end(finished, kept):
    whole, text = card(), EPISODES.read_bytes()
    EPISODES.write_bytes(text[: int(kept * len(text))])
    for name in ("card.json", "study.db"):
        Path("tuning", name).unlink()
    answer = finished("budget=14", "preset=first", "resume=true")
    assert (answer.status, answer.errors) == (0, [])
    assert card() == whole
    assert driven(EPISODES.read_bytes()) == driven(text)  # each once


def test_a_tuning_is_not_begun_or_changed_over_another_one(finished):
    before = EPISODES.read_bytes()
    for words, said in (
        (["preset=first"], "tuning holds a tuning already; resume=true goes on with it"),
        (["preset=second", "resume=true", "seed=1"], "tuning holds a tuning with another seed"),
        (["preset=second", "resume=true", "objective=strict_success"], "tuning holds a tuning with another objective"),
    ):
        answer = finished("budget=14", *words)
        assert (answer.status, said in answer.line) == (2, True), answer.line
    assert EPISODES.read_bytes() == before


@pytest.mark.slow
def test_more_budget_goes_on_where_less_ended(finished):
    few = EPISODES.read_bytes().splitlines()
    assert finished("budget=20", "preset=first", "resume=true").status == 0
    assert EPISODES.read_bytes().splitlines()[: len(few)] == few
    assert card()["budget"]["search"] == 20


@pytest.mark.slow
def test_workers_make_the_same_study_as_one_process(finished):
    alone = card()
    shutil.rmtree("tuning")
    shutil.rmtree("conf/planner", ignore_errors=True)
    answer = finished("budget=14", "preset=first", "executor=processes", "executor.workers=2")
    assert (answer.status, answer.errors) == (0, [])
    assert card() == alone


def test_ctrl_c_keeps_what_is_finished_and_says_how_it_goes_on(tune, monkeypatch):
    add = Journal.add

    def add_then_interrupt(journal, *what):
        add(journal, *what)
        if len(journal) == 5:
            raise KeyboardInterrupt(2)

    monkeypatch.setattr(Journal, "add", add_then_interrupt)
    answer = tune("budget=14")
    assert answer.status == 130
    assert answer.errors[-1].endswith(
        "finished episodes are kept, resume=true (with the same words) goes on from there"
    )
    assert len(driven(EPISODES.read_bytes())) == 5
    assert not Path("tuning/drives").exists()


def test_two_tunings_do_not_share_a_folder(tune):
    with lock_folder(Path("tuning")):
        answer = tune("budget=14")
    assert answer.status == 2
    assert answer.line.startswith("arena: tuning: another run is under way there")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["budget=many"], "budget is many; allowed: a number of episodes, such as 2000, or a time"),
        (["budget=5"], "budget is 5; allowed: 8 episodes at least"),
        (["sampler=best"], "sampler is best; allowed: tpe, cmaes, random"),
        (["problems=v9"], "problems is v9; allowed: tiny, v1, v2"),
        (["objective=sucess"], "objective asks for sucess; allowed: success, "),
        (["objective=success +"], "objective is 'success +'"),
        (["preset=a/b"], "preset is a/b; allowed: letters"),
        (["planner.speeed=1"], "planner has no key speeed"),
        (["planner.speed=9"], "planner.speed is 9, outside of what is searched; allowed: 0.3 .. 1.5"),
        (["finalists=0"], "finalists is 0"),
        (["seed=-1"], "seed is -1"),
        (["robot=tank"], "unknown robot 'tank'"),
        (["resume=maybe"], "resume is 'maybe'"),
    ],
)
def test_a_wrong_request_is_refused_in_one_line_before_anything_is_written(tune, words, said):
    answer = tune(*words)
    assert answer.status == 2
    assert said in answer.line
    assert not Path("tuning").exists()


def test_a_preset_that_is_there_is_not_written_over(tune):
    PRESET.parent.mkdir()
    PRESET.write_text("name: pure_pursuit\n")
    answer = tune("budget=14")
    assert answer.status == 2
    assert "pure_pursuit_tuned_jackal.yaml is there already; allowed: preset=NAME" in answer.line
    assert not EPISODES.exists()


def test_a_planner_that_fails_in_every_episode_ends_the_tuning_in_one_line(tune):
    answer = tune("budget=14", "world.width=1.0", "world.height=1.0")  # no scenario fits
    assert answer.status == 2
    assert answer.line.startswith("arena: the planner as it is ends every episode with an error: ")


def test_an_objective_that_is_not_always_defined_is_refused_with_what_to_do(tune):
    answer = tune("budget=14", "objective=-time_to_goal", "task.time_limit=1")
    assert answer.status == 2
    assert "is not defined in an episode that ended with" in answer.line
    assert "known(METRIC, OTHERWISE)" in answer.line


def test_a_disk_that_takes_no_more_is_said_in_one_line(tune, monkeypatch):
    opened = Path.open

    def refuse(path, *arguments, **settings):
        if path.name == EPISODES.name:
            raise OSError(28, "No space left on device")
        return opened(path, *arguments, **settings)

    monkeypatch.setattr(Path, "open", refuse)
    answer = tune("budget=14")
    assert answer.status == 2
    assert answer.line.endswith("episodes.jsonl: No space left on device")
