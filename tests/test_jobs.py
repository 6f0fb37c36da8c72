"""The jobs of a multirun are composed from files that are read once: what comes out is what Hydra composes alone."""

from collections.abc import Iterator
from typing import Any

import pytest
from hydra import initialize_config_dir
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra.core.global_hydra import GlobalHydra
from hydra.errors import HydraException
from hydra.types import RunMode
from omegaconf import OmegaConf

from arena_core.config.configuration import conf_directory, yaml_text
from arena_core.config.jobs import Jobs, Unmergeable, merge
from hydra_plugins.arena.source import ArenaSource

SETS = (
    ["planner=dwa", "robot=jackal"],
    ["planner=teb", "robot=robotino", "people=lifelike", "task.pedestrians=3"],
    ["planner=aio", "world=indoor_as_paper", "executor=serial"],
    ["experiment=classic"],
    ["experiment=barn", "planner=orca", "hydra.sweep.dir=/tmp/x"],
    ["planner=mpc_as_released", "metrics=[si,paper_legacy]", "+new.key=3"],
    ["~timing", "seed=4"],
)


@pytest.fixture
def loaders() -> Iterator[tuple[ConfigLoaderImpl, ConfigLoaderImpl]]:
    """Hydra's loader as it is, and one that composes jobs."""
    with initialize_config_dir(str(conf_directory()), version_base="1.3"):
        plain = GlobalHydra.instance().config_loader()
    with initialize_config_dir(str(conf_directory()), version_base="1.3"):
        quick = GlobalHydra.instance().config_loader()
        Jobs(quick)
        yield plain, quick


def composed(loader: Any, overrides: list[str]) -> Any:
    return loader.load_configuration("config", overrides, RunMode.RUN)


def test_jobs_are_what_hydra_composes_the_first_time_and_later(loaders):
    plain, quick = loaders
    for overrides in (*SETS, *SETS):
        expected, found = composed(plain, overrides), composed(quick, overrides)
        assert OmegaConf.to_yaml(found) == OmegaConf.to_yaml(expected)
        assert [key for key in found if key != "hydra"] == [key for key in expected if key != "hydra"]
        assert OmegaConf.is_struct(found)
        assert OmegaConf.get_type(found, "hydra") is OmegaConf.get_type(expected, "hydra")


def test_what_one_job_changes_no_other_sees(loaders):
    _, quick = loaders
    first = composed(quick, ["planner=dwa"])
    before = OmegaConf.to_yaml(first)
    with_changes = composed(quick, ["planner=dwa", "planner.roll_out.sim_time=9", "hydra.sweep.subdir=other"])
    with_changes.robot.name = "other"
    assert OmegaConf.to_yaml(composed(quick, ["planner=dwa"])) == before


@pytest.mark.parametrize("overrides", [["planner=none_such"], ["planner.none_such=3"], ["hydra.sweep.dirr=3"], ["seed=[1"]])
def test_what_hydra_refuses_is_refused_alike(loaders, overrides):
    said = []
    for loader in loaders:
        with pytest.raises(HydraException) as error:
            composed(loader, overrides)
        said.append((type(error.value), str(error.value).splitlines()[0]))
    assert said[0] == said[1]


def test_mappings_are_merged_key_by_key_and_all_else_is_replaced():
    whole = {"a": {"b": 1, "c": [1, 2]}, "d": 3, "e": None}
    merge(whole, {"a": {"c": [3], "f": 4}, "d": "???", "e": {"g": 5}, "h": "???"})
    assert whole == {"a": {"b": 1, "c": [3], "f": 4}, "d": 3, "e": {"g": 5}, "h": "???"}
    with pytest.raises(Unmergeable):
        merge({"a": "${b}"}, {"a": {"c": 1}})


def test_a_folder_is_read_as_hydra_reads_files(tmp_path):
    (tmp_path / "kind").mkdir()
    (tmp_path / "kind" / "one.yaml").write_text("# @package _global_\na: 1e3\nb: 2020-01-01\nc: 'true'\nd: ${a}\n", "utf-8")
    (tmp_path / "kind" / "empty.yaml").write_text("", "utf-8")
    source = ArenaSource("test", f"arena://{tmp_path}")
    result = source.load_config("kind/one")
    assert OmegaConf.to_container(result.config, resolve=False) == {"a": 1000.0, "b": "2020-01-01", "c": "true", "d": "${a}"}
    assert result.config == OmegaConf.load(tmp_path / "kind" / "one.yaml")
    assert result.header["package"] == "_global_"
    assert source.load_config("kind/empty").config == {}
    assert (source.is_group("kind"), source.is_config("kind"), source.is_config("kind/one")) == (True, False, True)
    assert source.list("kind", None) == ["empty", "one"]


def test_yaml_is_written_as_omegaconf_writes_it():
    config = OmegaConf.create({"a": {"b": [1, 2.5, None, "3", "yes", "1e3"], "c": "${a.b}", "d": "ü: x"}, "e": {}, "f": []})
    assert OmegaConf.create(yaml_text(config)) == config
    assert yaml_text(config) == OmegaConf.to_yaml(config)
