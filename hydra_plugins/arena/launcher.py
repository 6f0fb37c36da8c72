"""The launcher of `arena run -m`: every (job, episode) pair of the batch goes into one queue."""

import logging
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hydra.core.hydra_config import HydraConfig
from hydra.core.utils import JobReturn, JobRuntime, JobStatus, setup_globals
from hydra.plugins.launcher import Launcher
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig, OmegaConf, open_dict, read_write


class ArenaLauncher(Launcher):
    """Prepare each job's folder as Hydra does, then run the episodes of all of them together."""

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Keep what Hydra hands over before a launch."""
        from arena_core.cli.commands import RunTask

        self.hydra_context = hydra_context
        if not isinstance(task_function, RunTask):
            raise TypeError("hydra/launcher=arena launches `arena run -m` alone")
        self.task = task_function
        self.config = config
        self._checked: dict[tuple[str, ...], DictConfig] = {}
        self._compose = hydra_context.config_loader.load_sweep_config
        hydra_context.config_loader.load_sweep_config = self._check  # type: ignore[method-assign]  # what sweepers check a batch by
        logging.getLogger("optuna").setLevel(logging.WARNING)  # a sweeper that prints lines of its own

    def launch(self, job_overrides: Sequence[Sequence[str]], initial_job_idx: int) -> Sequence[JobReturn]:
        """Run the batch, or show it; each job's return value is its objective, else the exit status of the whole batch."""
        from arena_core.cli.commands import Shown, request

        setup_globals()
        if self.task.show:
            for i, overrides in enumerate(job_overrides):
                self.task.show.show(initial_job_idx + i, overrides, self._composed(list(overrides), initial_job_idx + i))
            raise Shown
        prepared = [self._prepare(list(overrides), initial_job_idx + i) for i, overrides in enumerate(job_overrides)]
        told = self.task.run([request(job.cfg, job.hydra_cfg) for job in prepared], Path(str(self.config.hydra.sweep.dir)).absolute())
        if self.task.error is not None:
            raise self.task.error
        for i, (job, value) in enumerate(zip(prepared, told, strict=True)):
            job.return_value = value
            if wanted := job.cfg and job.cfg.objective:
                print(f"trial {initial_job_idx + i}: {wanted} {value}")
        return prepared

    def _check(self, master_config: DictConfig, sweep_overrides: list[str]) -> DictConfig:
        """Compose a job for the sweeper, and keep it for its launch: nothing is composed twice."""
        config = self._checked[tuple(sweep_overrides)] = self._compose(master_config, sweep_overrides)
        return config

    def _composed(self, overrides: list[str], number: int) -> DictConfig:
        """Compose one job, unless the sweeper had it composed."""
        config = self._checked.pop(tuple(overrides), None)
        if config is None:
            config = self._compose(self.config, overrides)
        with open_dict(config):
            config.hydra.job.id = number
            config.hydra.job.num = number
        return config

    def _prepare(self, overrides: list[str], number: int) -> JobReturn:
        """Compose one job and make its folder as Hydra's ``run_job`` does, without the copies of the configuration that it takes."""
        from arena_core.base.folders import new_folders

        config = self._composed(overrides, number)
        shared: Any = HydraConfig.instance()
        before, shared.cfg = shared.cfg, config  # what ${hydra:...} in names of folders refers to
        try:
            folder = Path(str(config.hydra.sweep.dir), str(config.hydra.sweep.subdir))
            new_folders.expect(folder)
            with read_write(config.hydra.runtime), open_dict(config.hydra.runtime):
                config.hydra.runtime.output_dir = str(folder.absolute())
            folder.mkdir(parents=True, exist_ok=True)
            shared.cfg = hydra_alone(config)
            job = JobReturn(overrides, None, shared.cfg, str(Path.cwd()), JobRuntime.instance().get("name"), JobStatus.COMPLETED)
            self.hydra_context.callbacks.on_job_start(config=config, task_function=self.task)
            with read_write(config), open_dict(config):
                del config["hydra"]  # its node lives on in what hydra_alone made
            job.cfg = config
        finally:
            shared.cfg = before
        return job


def hydra_alone(config: DictConfig) -> Any:
    """Return Hydra's own node, read-only, as ``HydraConfig.set_config`` does, but not copied; interpolations read ``config``."""
    OmegaConf.set_readonly(config.hydra, True)
    alone: Any = DictConfig({"hydra": None}, flags={"no_deepcopy_set_nodes": True})
    alone.hydra = config.hydra
    alone.hydra._set_parent(config)
    return alone
