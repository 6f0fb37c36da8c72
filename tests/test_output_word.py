"""Where output goes is ``out=DIR`` for every command; older spellings still count."""

import json
import shutil
from pathlib import Path

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser

from arena_core import ConfigurationError, Runs, run
from arena_core.commands import split_out
from arena_core.config.output_word import run_folder_words
from arena_core.hosting import load_registry
from arena_crowds.validation.measure import read_request as read_walks
from arena_mujoco.pictures.command import read_request as read_picture

DRAWN = Path(__file__).parent / "data"
SMALL = ("planner=pure_pursuit", "robot=jackal", "world=empty", "world.width=6", "world.height=6", "episodes=1")
QUICK = (*SMALL, "task.pedestrians=0", "localizer=ground_truth", "task.time_limit=2", "executor=serial", "report=false")
SITE = ("world=ros_map", "world.path=site.yaml", "robot=jackal")
OUT = [["out={}"], ["--out", "{}"], ["--out={}"]]
TO = [["to={}"], ["--to", "{}"], ["--to={}"]]  # what commands that write one file once called it

# Command, the place that it is given, what lies there afterwards, the spellings that it takes.
WRITTEN = {
    "run": (["run", *QUICK], "a b", "a b/episodes.csv", [*OUT, ["hydra.run.dir='{}'"]]),
    "run -m": (["run", "-m", *QUICK, "seed=0,1"], "a", "a/1/episodes.csv", [*OUT, ["hydra.sweep.dir={}"]]),
    "run of experiments": (["run", "hydra.mode=MULTIRUN", *QUICK], "a", "a/0/episodes.csv", OUT),
    "evaluate": (["evaluate", "run"], "a", "a/episodes.csv", OUT),
    "report": (["report", "run", "--no-figures", "--replays", "0"], "a", "a/index.html", OUT),
    "compare-real": (["compare-real", "run", "run"], "a", "a/problems.csv", OUT),
    "query": (["query", "SELECT * FROM episodes", "run"], "a.csv", "a.csv", OUT),
    "submit": (["submit", "run"], "a.zip", "a.zip", OUT + TO),
    "profile": (["profile", *QUICK, "first=1"], "a.txt", "a.txt", OUT),
    "new": (["new", "planner", "mine"], "a", "a/mine/pyproject.toml", OUT),
    "world generate": (["world", "generate", "kind=empty"], "a", "a/map.yaml", OUT),
    "world convert": (["world", "convert", "site.yaml"], "a.sdf", "a.sdf", [*OUT, ["{}"]]),
    "scenario draw": (["scenario", "draw", "scenario.json", *SITE], "a.png", "a.png", OUT + TO),
    "scenario convert": (["scenario", "convert", "scenario.json"], "a.json", "a.json", [*OUT, ["{}"]]),
    "ros export": (["ros", "export", "run"], "a.mcap", "a.mcap", OUT + TO),
    "ros import": (["ros", "import", "run.bag"], "a", "a/episodes.csv", OUT),
    "ros scenario-from": (["ros", "scenario-from", "run.bag"], "a.json", "a.json", OUT),
    "replay": (["replay", "run"], "a.html", "a.html", OUT + TO),
    "export": (["export", "run", "to=mcap"], "a.mcap", "a.mcap", OUT),
}
# Commands that take long, or need more than this machine has: what they refuse says which words they took.
REFUSED = {
    "quickstart": (["quickstart", "nowhere"], "nowhere", OUT),
    "leaderboard": (["leaderboard", "no.zip"], "no.zip", OUT + TO),
    "break": (["break", "planner=nobody", "robot=jackal"], "nobody", OUT),
    "ladder": (["ladder", "planner=nobody", "robot=jackal"], "nobody", OUT),
    "train": (["train", "planner=nobody", "robot=jackal"], "nobody", OUT),
    "tune": (["tune", "planner=nobody", "robot=jackal"], "nobody", OUT),
    "compile": (["compile", "planner=nobody"], "nobody", OUT),
    "navrep": (["navrep", "all", "robot=nobody"], "nobody", OUT),
    "predict": (["predict", "train", "trainer.name=nobody"], "nobody", OUT),
    "crowd validate": (["crowd", "validate", "nothing"], "nothing", OUT),
    "ros drive": (["ros", "drive", "planner=nobody", "robot=jackal", "map=site.yaml"], "nobody", OUT),
    "ros controller": (["ros", "controller", "planner=nobody", "robot=jackal"], "nobody", OUT),
    "render": (["render", "nowhere", "at=1"], "nowhere", OUT + TO),
}
# Commands that write nothing, or into a folder of their own.
SILENT = {
    *("check", "choices", "completion", "cost", "explain", "iso18646", "list", "reference", "studio", "trainings"),
    "verify",
}


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("finished")
    run(QUICK, folder / "run")
    return folder / "run"


@pytest.fixture
def place(arena, finished):
    shutil.copytree(finished, "run")
    for name in ("map.pgm", "map.yaml", "site.yaml"):
        shutil.copy(DRAWN / "maps/hall" / ("map.pgm" if name.endswith("pgm") else "map.yaml"), name)
    shutil.copy(DRAWN / "scenarios/hall_obs03.json", "scenario.json")
    return arena


def spelled(table):
    """Return each command with the spelling of today and with its oldest one."""
    return [
        pytest.param(*case, words, id=f"{name} {' '.join(words)}")
        for name, (*case, spellings) in table.items()
        for words in (spellings[0], spellings[-1])
    ]


@pytest.mark.parametrize(("command", "target", "file", "words"), spelled(WRITTEN))
def test_output_goes_where_the_word_says_however_it_is_spelled(place, command, target, file, words):
    if "run.bag" in command:
        assert place("ros", "export", "run", "out=run.bag").status == 0
    answer = place(*command, *(word.format(target) for word in words))
    assert answer.status == 0
    assert Path(file).is_file()


@pytest.mark.parametrize(("command", "wrong", "words"), spelled(REFUSED))
def test_commands_that_are_dear_take_the_word_too(place, command, wrong, words):
    answer = place(*command, *(word.format("a.md" if "no.zip" in command else "a.png") for word in words))
    assert answer.status == 2
    assert wrong in answer.line
    assert "key out" not in answer.line


def test_every_command_has_a_case():
    tried = {command[0] for command, *_ in (*WRITTEN.values(), *REFUSED.values())}
    assert tried | SILENT == set(load_registry().names("command"))


@pytest.mark.parametrize("words", OUT)
def test_readers_that_run_no_command_take_the_word(words):
    spelling = [word.format("a.png") for word in words]
    assert read_picture(["run", *spelling]).target == Path("a.png")
    assert read_walks([word.format("a") for word in words]).out == Path("a")


def test_evaluating_elsewhere_leaves_the_tables_of_the_runs(place):
    before = Path("run/episodes.csv").read_bytes()
    assert place("evaluate", "run", "metrics=[barn]", "out=other").status == 0
    assert Path("run/episodes.csv").read_bytes() == before
    assert Path("other/episodes.csv").read_bytes() != before
    shutil.copytree("run", "more/run")
    assert place("evaluate", "run", "more", "out=all").status == 0
    assert sorted(map(str, Path("all").rglob("*.csv"))) == ["all/more/run/episodes.csv", "all/run/episodes.csv"]
    assert "several folders are called alike" in place("evaluate", "run", "more/run", "out=all").line


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["out=a", "out=b"], "out is given twice; allowed: each key once"),
        (["out="], "out is empty; allowed: out=DIR"),
        (["--out"], "out is empty; allowed: out=DIR"),
        (["out=a", "hydra.run.dir=b"], r"out and hydra\.run\.dir both say where the run goes; allowed: out=DIR alone"),
        (["out=a", "++hydra.sweep.dir=b"], r"out and hydra\.sweep\.dir both say where the run goes"),
    ],
)
def test_a_wrong_place_is_named_in_one_line(words, said):
    with pytest.raises(ConfigurationError, match=said):
        run_folder_words(words)


def test_words_beside_the_place_stay_as_they_are():
    assert split_out(["a", "b=c=d", "--fast", "out", "--out", "x y", "~task"]) == (
        ["a", "b=c=d", "--fast", "out", "~task"],
        "x y",
    )
    assert split_out(["planner.out=3"]) == (["planner.out=3"], None)


@pytest.mark.parametrize("name", ["it's", "a,b", "{x}", "a=b", "(1)", "$1", "ü", "100%", "[a]", "a:b", "back\\slash"])
def test_a_folder_may_have_any_name(name):
    words = run_folder_words([f"out={name}"])
    assert [one.value() for one in OverridesParser.create().parse_overrides(words)] == [name, name]


def test_a_run_goes_to_a_folder_with_an_odd_name(arena):
    assert arena("run", *QUICK, "out=it's {a}=b, c").status == 0
    assert Path("it's {a}=b, c", "episodes.csv").is_file()


def test_python_takes_the_word_too(tmp_path):
    assert run([*QUICK, f"out={tmp_path / 'here'}"])[0].folder == tmp_path / "here"
    assert len(Runs.below(tmp_path / "here")) == 1
    with pytest.raises(ConfigurationError, match=r"out is a and folder is b; allowed: one of the two"):
        run([*QUICK, "out=a"], "b")


def test_the_studio_refuses_a_place_of_the_browsers():
    from arena_studio.allowed_overrides import check_overrides

    with pytest.raises(ConfigurationError, match="the studio chooses the folder"):
        check_overrides(["out=there"], Path.cwd())


def test_the_provenance_of_a_run_does_not_depend_on_the_spelling(arena):
    for word in ("out=a", "hydra.run.dir=b"):
        assert arena("run", *QUICK, word).status == 0
    told = [json.loads(Path(name, "provenance.json").read_text()) for name in ("a", "b")]
    assert told[0]["config_hash"] == told[1]["config_hash"]
    assert told[0]["config"] == told[1]["config"]
