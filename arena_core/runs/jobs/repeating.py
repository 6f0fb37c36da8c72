"""Run single episodes again, of whatever runs: to hold results against what is driven here and now."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from arena_core.base.ctrl_c import interrupts
from arena_core.config.registry import Registry
from arena_core.contracts.running import Finished, Job, Lost
from arena_core.runs.jobs.working import run_job


def repeat_episodes(jobs: Sequence[Job], executor: Mapping[str, Any], registry: Registry) -> Iterator[Finished | Lost]:
    """Run jobs by an executor's configuration and yield what came of each, in any order; records go to the folders of
    the jobs.

    A configuration that cannot be built is a row with its error. Raises RunFolderError where a record cannot be
    written.
    """
    for folder in {job.folder for job in jobs}:
        Path(folder).mkdir(parents=True, exist_ok=True)
    with interrupts.heard(), interrupts.held(), closing(registry.build("executor", executor)) as runner:
        for answer in runner.map(run_job, list(jobs)):
            interrupts.check()
            yield answer
