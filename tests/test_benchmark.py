import copy

import pytest

from arena_core import ConfigurationError
from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import load_registry
from arena_core.runs.jobs.benchmark import build_benchmark, build_metrics, config_hash

WORDS = ("planner=pure_pursuit", "world=empty", "localizer=ground_truth")


@pytest.fixture(scope="module")
def config():
    return to_plain(compose(WORDS))


def changed(config, key, value):
    copied = copy.deepcopy(config)
    *path, last = key.split(".")
    node = copied
    for name in path:
        node = node[name]
    node[last] = value
    return copied


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("seed", 7),
        ("episodes", 99),
        ("executor.name", "serial"),
        ("resume", True),
        ("report", False),
        ("recording.scans", True),
    ],
)
def test_a_cell_does_not_depend_on_how_it_is_run(config, key, value):
    assert config_hash(changed(config, key, value)) == config_hash(config)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("planner.gain", 2.5),
        ("robot.control_period", 0.2),
        ("task.pedestrians", 7),
        ("timing.latency", 0.1),
        ("stop_on_collision", True),
    ],
)
def test_a_cell_depends_on_everything_that_changes_an_episode(config, key, value):
    assert config_hash(changed(config, key, value)) != config_hash(config)


def test_the_order_of_keys_does_not_make_a_cell(config):
    assert config_hash(dict(reversed(config.items()))) == config_hash(config)


def test_the_control_period_is_the_robots_unless_the_planner_has_one(config):
    assert build_benchmark(config, load_registry()).navigator.control_period == config["robot"]["control_period"]
    assert (
        build_benchmark(changed(config, "planner.control_period", None), load_registry()).navigator.control_period
        == 0.1
    )
    assert (
        build_benchmark(changed(config, "planner.control_period", 0.2), load_registry()).navigator.control_period == 0.2
    )


@pytest.mark.parametrize("period", [-0.1, "fast", 0.004, 0.015])
def test_an_impossible_control_period_is_named(config, period):
    with pytest.raises(ConfigurationError, match=r"planner\.control_period is .*; allowed: "):
        build_benchmark(changed(config, "planner.control_period", period), load_registry())


@pytest.mark.parametrize("key", ["robot", "world", "localizer", "timing", "episodes"])
def test_what_is_missing_is_named(config, key):
    with pytest.raises(ConfigurationError, match=f"the configuration lacks {key}"):
        build_benchmark({k: v for k, v in config.items() if k != key}, load_registry())


@pytest.mark.parametrize("key", ["planner", "recoveries", "world"])
@pytest.mark.parametrize("value", [None, 3, "dwa", []])
def test_a_part_without_keys_is_named(config, key, value):
    with pytest.raises(ConfigurationError, match=f"{key} is .*; allowed: a mapping"):
        build_benchmark(changed(config, key, value), load_registry())


def test_metric_packs_come_with_the_bare_one_first():
    both = to_plain(compose([*WORDS, "metrics=[paper_legacy,si]"]))
    assert list(build_benchmark(both, load_registry()).metrics) == ["", "paper_legacy"]


def test_a_pack_that_is_not_in_its_place_is_named():
    config = {"metrics": {"name": "comfort", "near": 1.0, "si": {"name": "si"}}}
    with pytest.raises(ConfigurationError, match=r"metrics=comfort .*; allowed: .* # @package metrics\.comfort"):
        build_metrics(config, load_registry())


def test_a_run_without_metrics_is_possible():
    assert build_benchmark(to_plain(compose([*WORDS, "metrics=[]"])), load_registry()).metrics == {}


def test_a_composed_configuration_can_be_built_as_it_is(config):
    assert build_benchmark(compose(WORDS), load_registry()).config == config
