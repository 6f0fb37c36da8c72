"""The launcher of `arena run -m`: every (job, episode) pair of the batch goes into one queue."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hydra.core.utils import JobReturn, JobStatus, run_job, setup_globals
from hydra.plugins.launcher import Launcher
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig, open_dict


class ArenaLauncher(Launcher):
    """Prepare each job's folder as Hydra does, then run the episodes of all of them together."""

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Keep what Hydra hands over before a launch."""
        from arena_core.commands import RunTask

        self.hydra_context = hydra_context
        if not isinstance(task_function, RunTask):
            raise TypeError("hydra/launcher=arena launches `arena run -m` alone")
        self.task = task_function
        self.config = config

    def launch(self, job_overrides: Sequence[Sequence[str]], initial_job_idx: int) -> Sequence[JobReturn]:
        """Run the batch; each job's return value is the exit status of the whole batch."""
        from arena_core.run import RunRequest

        setup_globals()
        prepared = [self._prepare(list(overrides), initial_job_idx + i) for i, overrides in enumerate(job_overrides)]
        status = self.task.run([RunRequest(job.cfg, Path(job.return_value), _choices(job)) for job in prepared])
        for job in prepared:
            job.return_value = status
        return prepared

    def _prepare(self, overrides: list[str], number: int) -> JobReturn:
        """Compose one job and let Hydra make its folder; the job's return value is that folder."""
        config = self.hydra_context.config_loader.load_sweep_config(self.config, overrides)
        with open_dict(config):
            config.hydra.job.id = number
            config.hydra.job.num = number
        job = run_job(_folder, config, "hydra.sweep.dir", "hydra.sweep.subdir", self.hydra_context)
        if job.status == JobStatus.FAILED:
            raise job._return_value
        return job


def _choices(job: JobReturn) -> dict[str, str | None]:
    assert job.hydra_cfg is not None, "a job that ran has its configuration"
    return dict(job.hydra_cfg.hydra.runtime.choices)


def _folder(config: Any) -> str:
    from hydra.core.hydra_config import HydraConfig

    return str(HydraConfig.get().runtime.output_dir)
