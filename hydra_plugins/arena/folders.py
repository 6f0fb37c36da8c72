"""Hears from Hydra which folders it is about to make, so that a request which is refused leaves none behind."""

from pathlib import Path
from typing import Any

from hydra.core.hydra_config import HydraConfig
from hydra.experimental.callback import Callback
from omegaconf import DictConfig, OmegaConf


class NotedFolders(Callback):
    """Notes the folder of a run, or of a multirun with the file that Hydra writes there."""

    def on_run_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Note the folder of a single run."""
        from arena_core.base.folders import new_folders

        new_folders.expect(_resolve_folder(config, "hydra.run.dir"))

    def on_multirun_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Note the folder of a multirun; the launcher notes those of its jobs."""
        from arena_core.base.folders import new_folders

        folder = _resolve_folder(config, "hydra.sweep.dir")
        new_folders.expect(folder)
        new_folders.expect_file(folder / "multirun.yaml")


def _resolve_folder(config: DictConfig, key: str) -> Path:
    before = HydraConfig.instance().cfg
    HydraConfig.instance().set_config(config)  # as Hydra itself does when it makes the folder
    try:
        return Path(str(OmegaConf.select(config, key)))
    finally:
        HydraConfig.instance().cfg = before
