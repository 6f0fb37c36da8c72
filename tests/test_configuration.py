import pytest
from hydra import initialize
from hydra.core.global_hydra import GlobalHydra

from arena_core import ConfigurationError
from arena_core.config.configuration import compose, to_plain
from arena_core.config.option_folders import conf_directory, option_files, search_path
from arena_core.config.plugins import load_plugins
from arena_core.config.registry import load_registry
from arena_core.hosting import DuplicateComponent

PLUGIN = """
    from arena_core import hookimpl

    @hookimpl
    def config_package():
        return "{name}.conf"
"""
TUNED = """
    defaults:
      - _self_
      - optional tuned_tuning@_here_: ${robot}
    name: tuned
    speed: 1.0
"""


@pytest.fixture
def tuned(third_party):
    third_party.package(
        "tuned",
        PLUGIN.format(name="tuned"),
        {"planner/tuned": TUNED, "planner/tuned_tuning/jackal": "speed: 2.0\n", "experiment/slow": SLOW},
    )


SLOW = """
    # @package _global_
    defaults:
      - override /planner: tuned
      - override /robot: jackal
    planner:
      speed: 0.1
"""


def component(*overrides):
    return to_plain(compose(overrides, config_name="component"))


def test_composing_inside_a_hydra_application_leaves_that_application_alone():
    with initialize(version_base="1.3", config_path=None):
        before = GlobalHydra.instance().hydra
        assert before is not None
        assert component("executor=serial")["executor"] == {"name": "serial"}
        assert GlobalHydra.instance().hydra is before


def test_composing_leaves_nothing_behind_outside_one_and_after_an_error():
    GlobalHydra.instance().clear()
    component("executor=serial")
    with pytest.raises(ConfigurationError):
        compose(["executor=seriall"])
    assert not GlobalHydra.instance().is_initialized()


@pytest.mark.parametrize(
    ("override", "message"),
    [
        (
            "executor=serail",
            r"unknown executor 'serail'; did you mean serial\? \(possible: processes, ray, serial, slurm\)",
        ),
        ("experiment=smoek", r"unknown experiment 'smoek'; did you mean smoke\? \(possible: .*smoke"),
        ("metrics=[sii]", r"unknown metrics 'sii'; did you mean si\?"),
        ("episode=3", r"the configuration has no key episode; did you mean episodes\? \(possible: episodes, "),
        ("timing.mod=ideal", r"timing has no key mod; did you mean mode\? \(possible: compute_factor, latency, mode\)"),
        ("episodes=[", r"episodes=\[ cannot be read: .*; allowed: KEY=VALUE"),
        ("episodes", r"episodes cannot be read: .*; allowed: KEY=VALUE"),
        ("planner=null", r"an override chooses no component; allowed: KIND=NAME"),
        ("planner=3", r"an override chooses no component; allowed: KIND=NAME"),
        ("seed=${nowhere}", r"Interpolation key 'nowhere' not found"),
    ],
)
def test_a_wrong_override_is_one_line_that_says_what_is_possible(override, message):
    with pytest.raises(ConfigurationError, match=f"^{message}") as caught:
        to_plain(compose([override]))
    assert "\n" not in str(caught.value)


def test_a_missing_value_is_one_line_that_names_the_key(third_party):
    third_party.package("gap", PLUGIN.format(name="gap"), {"planner/gap": "name: gap\nspeed: ???\n"})
    with pytest.raises(ConfigurationError, match="speed") as caught:
        component("planner=gap")
    assert "\n" not in str(caught.value)


def test_what_is_done_with_a_configuration_does_not_reach_the_next_one():
    first = compose(["planner=pure_pursuit"], "component")
    before = to_plain(first)
    first.planner.gain = 7.0
    assert to_plain(compose(["planner=pure_pursuit"], "component")) == before


def test_no_experiment_is_chosen_by_default():
    assert "experiment" not in to_plain(compose())


def test_an_experiment_overrides_components_and_their_numbers(tuned):
    config = to_plain(compose(["experiment=slow"]))
    assert (config["planner"], config["robot"]["name"]) == ({"name": "tuned", "speed": 0.1}, "jackal")


def test_the_command_line_overrides_the_experiment(tuned):
    assert to_plain(compose(["experiment=slow", "planner.speed=0.7"]))["planner"]["speed"] == 0.7


def test_a_planner_is_tuned_by_the_name_of_the_robot(tuned):
    assert component("planner=tuned", "robot=jackal")["planner"]["speed"] == 2.0


def test_a_planner_without_a_tuning_for_the_robot_keeps_its_own_numbers(tuned):
    assert component("planner=tuned", "robot=turtlebot3")["planner"]["speed"] == 1.0


def test_an_option_that_two_plugins_offer_is_an_error_that_names_both(tuned, third_party):
    third_party.package("thief", PLUGIN.format(name="thief"), {"planner/tuned": "name: tuned\n"})
    with pytest.raises(
        DuplicateComponent, match="option planner/tuned is offered twice: by plugin thief and by plugin tuned"
    ):
        search_path()


def test_an_option_that_two_plugins_offer_is_found_when_composing_too(tuned, third_party):
    third_party.package("thief", PLUGIN.format(name="thief"), {"planner/tuned": "name: tuned\n"})
    with pytest.raises(DuplicateComponent, match="offered twice"):
        component("planner=tuned")


def test_the_conf_folder_of_the_working_directory_is_searched(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "conf" / "executor").mkdir(parents=True)
    (tmp_path / "conf" / "executor" / "two.yaml").write_text("name: processes\nworkers: 2\n")
    assert component("executor=two")["executor"] == {"name": "processes", "workers": 2}


def test_an_option_of_the_working_directory_hides_no_plugins_option(tuned, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "conf" / "planner").mkdir(parents=True)
    (tmp_path / "conf" / "planner" / "tuned.yaml").write_text("name: tuned\n")
    with pytest.raises(DuplicateComponent, match="by plugin tuned and by your folder"):
        search_path()


def test_in_a_checkout_its_own_conf_is_searched_once(monkeypatch):
    monkeypatch.chdir(conf_directory().parent)
    assert "working-directory" not in dict(search_path())


def test_sources_come_in_order_of_the_plugins_names_and_former_names_behind_all(tuned):
    providers = [provider for provider, _ in search_path()]
    now = [provider for provider in providers if not provider.endswith("-renamed")]
    assert now == sorted(now)
    assert providers == [*now, "tasks-renamed", "worlds-renamed"]
    assert dict(search_path())["tuned"].startswith("arena:///")
    assert dict(search_path())["tuned"].endswith("tuned/conf")


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (b"name: dwa\nspeed: \xff\n", "is no text in UTF-8"),
        (b"defaults:\nname: dwa\n", "defaults is no list"),
        (b"defaults: base\nname: dwa\n", "defaults is no list"),
        (b"- 1\n", "is no mapping"),
        (b"a: &a [*a]\nname: dwa\n", "its aliases make more than"),
        (b"a: &a {b: *a}\nname: dwa\n", "its aliases make more than"),
        (b"x" * 300_000, "is larger than"),
    ],
)
def test_an_own_file_that_is_no_option_is_named_by_run_and_list(arena, tmp_path, monkeypatch, content, fault):
    folder = tmp_path / "work" / "conf" / "planner"
    folder.mkdir(parents=True)
    (folder / "mine.yaml").write_bytes(content)
    for words in (("run", "planner=mine"), ("list", "planner")):
        answer = arena(*words)
        assert (answer.status, f"{folder / 'mine.yaml'}: {fault}" in answer.line) == (2, True), answer.errors


def test_an_own_file_may_use_a_few_aliases(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "conf" / "executor").mkdir(parents=True)
    (tmp_path / "conf" / "executor" / "two.yaml").write_text(
        "name: &name processes\nworkers: 2\nbudgets: {a: &a [1], b: *a, c: *name}\n"
    )
    assert component("executor=two")["executor"]["budgets"] == {"a": [1], "b": [1], "c": "processes"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("robot.vx_max=1", "robot has no key vx_max; did you mean limits.vx_max? (possible: "),
        ("robot.range_max=1", "robot has no key range_max; did you mean lidar.range_max or steering_max? (possible: "),
        ("robot.vx_mx=1", "robot has no key vx_mx; did you mean limits.vx_max? (possible: "),
        ("robot.limit.vx_max=1", "robot has no key limit; did you mean limits? (possible: "),
        ("robot.vx_max.high=1", "robot has no key vx_max; did you mean limits.vx_max? (possible: "),
        ("planner.vx_max=1", "planner has no key vx_max; did you mean limits.vx_max? (possible: "),
        ("task.min_distance=1", "task has no key min_distance; did you mean trip.min_distance? (possible: "),
        (
            "min_distance=1",
            "the configuration has no key min_distance; did you mean task.trip.min_distance? (possible: ",
        ),
        (
            "vx_max=1",
            "the configuration has no key vx_max; did you mean planner.limits.vx_max "
            "or robot.limits.vx_max? (possible: ",
        ),
        ("robot.limits.vx_max.high=1", "robot.limits.vx_max has no key high (possible: none)"),
        ("simulator.colour=1", "simulator has no key colour (possible: "),
    ],
)
def test_a_key_that_lies_deeper_is_suggested(words, said):
    with pytest.raises(ConfigurationError) as error:
        compose(words.split())
    assert str(error.value).startswith(said)


def test_a_key_of_a_file_that_lies_deeper_is_suggested():
    registry, node = load_registry(), to_plain(compose(["robot=jackal"]))["robot"]
    with pytest.raises(
        ConfigurationError, match=r"robot has no parameter vx_max; did you mean limits\.vx_max\? \(allowed: "
    ):
        registry.build("robot", {**node, "vx_max": 1.0})
    with pytest.raises(
        ConfigurationError, match=r"robot\.limits has no parameter vx_mx; did you mean vx_max\? \(allowed: "
    ):
        registry.build("robot", {**node, "limits": {**node["limits"], "vx_mx": 1.0}})


def test_a_link_in_an_own_folder_that_leads_upwards_is_no_group(tmp_path, monkeypatch):
    (tmp_path / "conf" / "planner").mkdir(parents=True)
    (tmp_path / "conf" / "planner" / "mine.yaml").symlink_to("/")
    (tmp_path / "conf" / "planner" / "again").symlink_to(tmp_path)
    (tmp_path / "conf" / "planner" / "other").symlink_to(tmp_path / "conf" / "planner" / "again" / "conf")
    monkeypatch.chdir(tmp_path)
    files = option_files("planner", load_plugins())
    assert not [name for name in files if "mine" in name or "again" in name or "other" in name]
