"""The list of who brings what is current, and messages go by it."""

import runpy
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from arena_core.base.notices import print_notice
from arena_core.commands import complete_overrides
from arena_core.config.plugins import load_plugins
from arena_core.files import options_of
from arena_core.hosting import compose, load_registry, option_names, to_plain

TOP = Path(__file__).resolve().parents[1]


def test_the_list_is_what_the_packages_bring():
    contents = runpy.run_path(str(TOP / "scripts" / "name_components"))["contents"]
    assert (TOP / "arena_core" / "suite.json").read_text() == contents(), "run scripts/name_components"


@pytest.fixture
def without(monkeypatch):
    """Give what takes plugins away, by name, as though their distributions were not installed."""

    def missing(distribution):
        raise PackageNotFoundError(distribution)

    def take_away(*plugins):
        monkeypatch.setenv("ARENA_DISABLED_PLUGINS", ",".join(plugins))
        monkeypatch.setattr("arena_core.base.suite.version", missing)

    return take_away


DWA = "arena-dwa, which is not installed: pip install arena-dwa"
REPLICATION = "arena-replication, which is not installed: pip install arena-replication"


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("run", "planner=dwa"), f"arena: planner dwa comes with {DWA}"),
        (("run", "-m", "planner=pure_pursuit,dwa"), f"arena: planner dwa comes with {DWA}"),
        (("check", "planner=dwa"), f"arena: planner dwa comes with {DWA}"),
        (("run", "planner=dwa_as_released"), f"arena: planner dwa_as_released needs {DWA}"),
        (("check", "planner=dwa_as_released"), f"arena: planner dwa_as_released needs {DWA}"),
        (
            ("train", "planner=gring"),
            "arena: command train comes with arena-gym, which is not installed: pip install arena-gym",
        ),
    ],
)
def test_what_is_not_installed_is_named_with_its_distribution(words, line, arena, without):
    without("dwa", "gym", "scenarios")
    answer = arena(*words)
    assert (answer.status, answer.line) == (2, line)


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (("run", "planner=gring_as_released"), "planner gring_as_released"),
        (("run", "experiment=paper"), "experiment paper"),
        (("run", "metrics=[si,paper_legacy]"), "metrics paper_legacy"),
        (("check", "reward=rule_05"), "reward rule_05"),
        (("run", "world=indoor_as_paper"), "world indoor_as_paper"),
    ],
)
def test_what_only_repeats_the_paper_names_its_distribution(words, what, arena, without):
    without("replication")
    answer = arena(*words)
    assert (answer.status, answer.line) == (2, f"arena: {what} comes with {REPLICATION}")


def offered(group):
    return [
        *options_of(group, load_plugins()),
        *option_names(group, load_registry()),
        *complete_overrides((), f"{group}="),
    ]


def test_a_preset_of_a_planner_that_is_not_installed_is_not_offered(arena, without):
    assert "dwa_as_released" in offered("planner")
    without("dwa", "gym")
    assert not [name for name in [*offered("planner"), *offered("reward")] if "dwa_as" in name or "rule_0" in name]
    assert "dwa_as_released" not in arena("run", "planner=nothing").line
    assert "dwa_as_released" not in arena("list", "preset", "--names").out
    assert "teb_as_released" in offered("planner")


def test_a_policy_that_is_not_installed_is_named_with_its_distribution(arena, without):
    without("replication")
    line = arena("run", "planner=gring", "planner.recipe=gring_as_released", "robot=jackal", "executor=serial").line
    assert f"policy gring/gring_as_released comes with {REPLICATION}" in line


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("people=as_released", "people=slow"),
        ("world=indoor_as_released", "world=indoor_large"),
        ("world=outdoor_as_released", "world=outdoor_large"),
    ],
)
def test_a_former_name_is_the_same_and_its_user_is_told_the_new_one(old, new, without, capsys):
    without("replication")
    print_notice.cache_clear()
    assert to_plain(compose([old])) == to_plain(compose([new]))
    assert f"{old} is called {new} now" in capsys.readouterr().err
    group, _, name = old.partition("=")
    assert name not in offered(group)


def test_a_former_name_works_in_a_configuration_of_ones_own(tmp_path, monkeypatch, without):
    without("replication")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "conf/experiment").mkdir(parents=True)
    (tmp_path / "conf/experiment/ours.yaml").write_text(
        "# @package _global_\ndefaults:\n  - override /people: as_released\n  - override /world: outdoor_as_released\n"
    )
    assert to_plain(compose(["experiment=ours"])) == to_plain(compose(["people=slow", "world=outdoor_large"]))


@pytest.mark.parametrize("kind", ["indoor", "outdoor"])
def test_the_worlds_as_released_are_the_suites_large_ones(kind):
    released, large = (to_plain(compose([f"world={kind}_{name}"], "component")) for name in ("as_released", "large"))
    assert released == large


def test_planners_are_swept_where_the_default_one_is_not_installed(arena, monkeypatch):
    monkeypatch.setenv("ARENA_DISABLED_PLUGINS", "dwa")
    words = ("run", "-m", "planner=orca,pure_pursuit", "world=empty,warehouse", "episodes=1", "--cfg", "job")
    answer = arena(*words)
    assert (answer.status, answer.errors) == (0, [])
    jobs = [line for line in answer.out.splitlines() if line.startswith("# ")]
    assert [job.split()[2:4] for job in jobs] == [
        [f"planner={planner}", f"world={world}"]
        for planner in ("orca", "pure_pursuit")
        for world in ("empty", "warehouse")
    ]
    assert "planner dwa comes with arena-dwa" in arena("run", "-m", "planner=dwa,orca", "--cfg", "job").line


def test_what_is_switched_off_is_named_so(arena, monkeypatch):
    monkeypatch.setenv("ARENA_DISABLED_PLUGINS", "dwa")
    assert (
        arena("run", "planner=dwa").line
        == "arena: planner dwa comes with arena-dwa, which is switched off by ARENA_DISABLED_PLUGINS"
    )
