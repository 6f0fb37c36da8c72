"""The sweeper of `arena run -m`: every combination of the swept values is a job, and each is composed once."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hydra.core.plugins import Plugins
from hydra.core.utils import JobReturn
from hydra.plugins.sweeper import Sweeper
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig, OmegaConf


class ArenaSweeper(Sweeper):
    """Launch all jobs together, or in batches; ``params`` are swept besides what the command
    line sweeps, which comes first. ``first_options`` are words of the command line that stand there with their first
    value alone.
    """

    def __init__(
        self, params: Mapping[str, Any] | None, max_batch_size: int | None, first_options: Sequence[str] = ()
    ) -> None:
        self.params, self.first_options = params or {}, first_options
        self.max_batch_size = max_batch_size

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Make the launcher that is chosen."""
        self.config: Any = config
        self.hydra_context = hydra_context
        self.launcher: Any = Plugins.instance().instantiate_launcher(
            hydra_context=hydra_context, task_function=task_function, config=config
        )

    def sweep(self, arguments: list[str]) -> list[Sequence[JobReturn]]:
        """Launch the jobs that the words make; raise what is wrong with one of a batch before any of it runs."""
        from arena_core.config.binding import read_settings
        from arena_core.config.sweeps import expand_sweep
        from arena_core.values.parameters import PositiveInt

        most: Any = PositiveInt | None
        size = read_settings(self.max_batch_size, most, "hydra.sweeper.max_batch_size")
        params = [f"{key}={values}" for key, values in self.params.items()]
        jobs = expand_sweep([*params, *arguments, *self.first_options])
        folder = Path(str(self.config.hydra.sweep.dir))
        folder.mkdir(parents=True, exist_ok=True)
        OmegaConf.save(self.config, folder / "multirun.yaml")
        return [
            self._launch_batch(jobs[first : first + (size or len(jobs))], first)
            for first in range(0, len(jobs), size or len(jobs))
        ]

    def _launch_batch(self, batch: Sequence[Sequence[str]], first: int) -> Sequence[JobReturn]:
        from arena_core.runs.progress import print_progress

        if not getattr(self.launcher, "composes_first", False):
            for overrides in print_progress("composing job", batch):
                self.validate_batch_is_legal([overrides])
        answers: Sequence[JobReturn] = self.launcher.launch(batch, initial_job_idx=first)
        for answer in answers:
            _ = answer.return_value  # raises what a job raised
        return answers
