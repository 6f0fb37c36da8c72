"""The launcher of `arena run -m`: every (job, episode) pair of the batch goes into one queue."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

from hydra.core.hydra_config import HydraConfig
from hydra.core.utils import JobReturn, JobRuntime, JobStatus, setup_globals
from hydra.plugins.launcher import Launcher
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig, open_dict, read_write


class ArenaLauncher(Launcher):
    """Prepare each job's folder as Hydra does, then run the episodes of all of them together."""

    # all jobs of a batch, before one of them runs: no sweeper needs to check them
    composes_first: ClassVar[bool] = True

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Keep what Hydra hands over before a launch."""
        from arena_core.cli.commands import RunTask

        self.hydra_context = hydra_context
        if not isinstance(task_function, RunTask):
            raise TypeError("hydra/launcher=arena launches `arena run -m` alone")
        self.task = task_function
        self.config = config

    def launch(self, job_overrides: Sequence[Sequence[str]], initial_job_idx: int) -> Sequence[JobReturn]:
        """Run the batch, or show it; each job's return value is its objective, else the exit
        status of the whole batch.
        """
        from arena_core.cli.commands import Shown, make_request
        from arena_core.runs.progress import print_progress

        setup_globals()
        if self.task.show:
            for i, overrides in enumerate(job_overrides):
                self.task.show.show(
                    initial_job_idx + i, overrides, self._compose_job(list(overrides), initial_job_idx + i)
                )
            raise Shown
        counted = enumerate(print_progress("composing job", job_overrides), initial_job_idx)
        prepared = [self._prepare_job(list(overrides), number) for number, overrides in counted]
        values = self.task.run(
            [make_request(job.cfg, job.hydra_cfg) for job in prepared],
            Path(str(self.config.hydra.sweep.dir)).absolute(),
        )
        if self.task.error is not None:
            raise self.task.error
        for i, (job, value) in enumerate(zip(prepared, values, strict=True)):
            job.return_value = value
            if wanted := job.cfg and job.cfg.objective:
                print(f"trial {initial_job_idx + i}: {wanted} {value}")
        return prepared

    def _compose_job(self, overrides: list[str], number: int) -> DictConfig:
        config = self.hydra_context.config_loader.load_sweep_config(self.config, overrides)
        with open_dict(config):
            config.hydra.job.id = number
            config.hydra.job.num = number
        return config

    def _prepare_job(self, overrides: list[str], number: int) -> JobReturn:
        """Compose one job and make its folder as Hydra's ``run_job`` does, without the copies of the
        configuration that it takes.
        """
        from arena_core.base.folders import new_folders

        config = self._compose_job(overrides, number)
        shared: Any = HydraConfig.instance()
        before = shared.cfg
        shared.set_config(config)  # what ${hydra:...} in names of folders refers to
        try:
            folder = Path(str(config.hydra.sweep.dir), str(config.hydra.sweep.subdir))
            new_folders.expect(folder)
            with read_write(config.hydra.runtime), open_dict(config.hydra.runtime):
                config.hydra.runtime.output_dir = str(folder.absolute())
            folder.mkdir(parents=True, exist_ok=True)
            shared.set_config(config)
            job = JobReturn(
                overrides, None, shared.cfg, str(Path.cwd()), JobRuntime.instance().get("name"), JobStatus.COMPLETED
            )
            self.hydra_context.callbacks.on_job_start(config=config, task_function=self.task)
            with read_write(config), open_dict(config):
                del config["hydra"]  # what set_config has made of it lives on
            job.cfg = config
        finally:
            shared.cfg = before
        return job
