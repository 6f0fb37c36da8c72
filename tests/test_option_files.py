"""Configuration files of plugins are read as Hydra reads files."""

from omegaconf import OmegaConf

from hydra_plugins.arena.source import ArenaSource


def test_a_folder_is_read_as_hydra_reads_files(tmp_path):
    (tmp_path / "kind").mkdir()
    (tmp_path / "kind" / "one.yaml").write_text(
        "# @package _global_\na: 1e3\nb: 2020-01-01\nc: 'true'\nd: ${a}\n", "utf-8"
    )
    (tmp_path / "kind" / "empty.yaml").write_text("", "utf-8")
    source = ArenaSource("test", f"arena://{tmp_path}")
    result = source.load_config("kind/one")
    assert OmegaConf.to_container(result.config, resolve=False) == {
        "a": 1000.0,
        "b": "2020-01-01",
        "c": "true",
        "d": "${a}",
    }
    assert result.config == OmegaConf.load(tmp_path / "kind" / "one.yaml")
    assert result.header["package"] == "_global_"
    assert source.load_config("kind/empty").config == {}
    assert (source.is_group("kind"), source.is_config("kind"), source.is_config("kind/one")) == (True, False, True)
    assert source.list("kind", None) == ["empty", "one"]
