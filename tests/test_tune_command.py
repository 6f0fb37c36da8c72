"""`arena tune`: from a planner and a robot to a preset with its card; what is finished is kept."""

import json
import shutil
from pathlib import Path

import optuna
import pytest

from arena_core.hosting import SearchSpace, load_registry, lock_folder
from arena_tuning.command import read_request
from arena_tuning.journal import Journal
from arena_tuning.preset import write_preset
from arena_tuning.problems import Problem

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
    assert found["twins"] == 0  # of people that are not there
    assert set(json.loads(Path("tuning/times.json").read_text())) == {"episodes", "twins", "whole"}
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


def test_several_objectives_come_to_a_pareto_set_of_which_a_rule_chooses_one(tune):
    answer = tune("budget=14", "objective=[strict_success, -known(time_to_goal, 40)]", "finalists=2", "sampler=nsga")
    assert (answer.status, answer.errors) == (0, [])
    found = card()
    assert found["objectives"] == ["strict_success", "-known(time_to_goal, 40)"]
    points = [one["advantages"] for one in found["pareto"]]
    assert points
    assert all(len(one) == 2 for one in points)
    assert [one["values"] for one in found["pareto"] if one["chosen"]] == [found["values"]]
    assert "not worse than the best one by the first objective" in found["rule"]
    assert list(found["test"]["objectives"]) == found["objectives"]
    assert found["better"]  # faster than a planner that drives too slowly, and as successful
    assert Path("tuning/report/pareto.png").read_bytes()[:4] == b"\x89PNG"
    assert "Pareto set" in Path("tuning/report/index.html").read_text()
    study = optuna.load_study(study_name="tune", storage="sqlite:///tuning/study.db")
    assert [len(trial.values) for trial in study.best_trials] == [2] * len(study.best_trials)


def test_a_stack_is_tuned_with_a_planner_that_stays_and_a_run_chooses_it_by_one_word(tune, arena):
    answer = tune("stack", "budget=8", "finalists=1", "preset=mine", "tracker.gate=9.0", "task.time_limit=8")
    assert (answer.status, answer.errors) == (0, [])
    found = card()
    assert found["parts"] == {"localizer": "amcl", "tracker": "kalman", "recoveries": "default"}
    assert (found["planner"], found["preset"], found["fixed"]) == ("pure_pursuit", "stack", {"tracker.gate": 9.0})
    assert {key.partition(".")[0] for key in found["space"]} == {"localizer", "tracker", "recoveries"}
    write_preset(Path("conf/stack/mine.yaml"), {**found, "values": {"tracker.life.confirm_hits": 2}}, SearchSpace({}))
    short = ("world=empty", "task.pedestrians=0", "task.time_limit=1", "executor=serial", "report=false", "episodes=1")
    assert arena("run", "stack=mine", "planner=pure_pursuit", "robot=jackal", *short, "out=run").status == 0
    provenance = json.loads(Path("run/provenance.json").read_text())
    assert provenance["config"]["tracker"]["life"]["confirm_hits"] == 2
    assert provenance["config"]["tracker"]["gate"] == 9.0
    told = provenance["tuning"]["stack"]
    assert (told["preset"], told["tuned"]) == ("mine", "by arena tune for jackal, with pure_pursuit")
    assert told["budget"] == found["budget"]["episodes"]


def test_what_a_planner_has_of_its_own_is_left_out_of_its_stack(tune):
    registry = load_registry()
    request = read_request(["stack", "planner=dwa", "robot=jackal", "problems=tiny"], registry)
    assert request.facts["left_out"] == ["recoveries.progress_time", "recoveries.retry_time"]
    assert request.folder == Path("tunings/stack_jackal_0")
    assert request.preset == Path("conf/stack/tuned_jackal.yaml")
    assert request.cells.choices[0]["localizer"] == "amcl"  # the problems have the truth
    assert request.cells.config({"tracker.gate": 5.0}, Problem("tune", 0, 0))["tracker"]["gate"] == 5.0


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
    "kept", [pytest.param(0.0, marks=pytest.mark.long), 0.45, pytest.param(1.0, marks=pytest.mark.slow)]
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


def trials():
    """Return what Optuna was told of each set of values, and what every episode was, without wall times."""
    study = optuna.load_study(study_name="tune", storage="sqlite:///tuning/study.db")
    told = [(one.number, one.state.name, one.params, one.values, one.intermediate_values) for one in study.trials]
    episodes = [json.loads(line) for line in EPISODES.read_bytes().splitlines()]
    rows = {one["key"]: {k: v for k, v in one["row"].items() if not k.startswith("planning_")} for one in episodes}
    return told, dict(sorted(rows.items()))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::FutureWarning", "ignore::DeprecationWarning")  # Ray's
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize(
    "executor",
    [
        ("executor=processes", "executor.workers=2"),
        pytest.param(("executor=ray", "executor.workers=2"), marks=pytest.mark.long),
        pytest.param(
            ("executor=slurm", "executor.cluster=local", "executor.workers=1", "executor.jobs=2"),
            marks=pytest.mark.long,
        ),
    ],
    ids=lambda words: words[0],
)
def test_workers_make_the_same_study_as_one_process(finished, executor):
    alone = card(), trials()
    shutil.rmtree("tuning")
    shutil.rmtree("conf/planner", ignore_errors=True)
    answer = finished("budget=14", "preset=first", *executor)
    assert (answer.status, answer.errors) == (0, [])
    assert (card(), trials()) == alone


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
        (["sampler=best"], "sampler is best; allowed: tpe, cmaes, random, nsga"),
        (["sampler=cmaes", "objective=[success, collisions]"], "sampler is cmaes, of one objective"),
        (["objective=[success]"], "objective is '[success]'; allowed: [A, B], two to 4 different expressions"),
        (["stock"], "arguments are stock; allowed: arena tune planner=NAME | stack"),
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


@pytest.mark.parametrize(
    ("space", "word", "said"),
    [
        ("parameters: {}", "planner.speed=0.4", "parameters is empty; allowed: a range at least"),
        (
            "parameters: {speed: {choices: [fast, slow], unit: m/s, why: it takes numbers}}",
            "planner.speed=fast",
            "the range of planner.speed, fast, slow, holds no valid value: planner.speed is 'fast'",
        ),
    ],
)
def test_a_space_that_holds_nothing_to_search_is_refused_in_one_line(tune, space, word, said):
    Path("conf/tune/pure_pursuit.yaml").write_text(space)
    answer = tune("budget=14", word)
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


def test_a_study_that_cannot_be_written_is_said_in_one_line_and_episodes_are_kept(tune):
    Path("tuning").mkdir()
    Path("tuning/study.db").symlink_to("/dev/full")
    answer = tune("budget=8")
    assert answer.status == 2
    assert answer.line.startswith("arena: cannot write tuning/study.db: ")
    assert len(driven(EPISODES.read_bytes())) == 8


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
