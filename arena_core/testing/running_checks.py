"""The contracts of metric packs and executors."""

from __future__ import annotations

import math
from contextlib import closing
from typing import Any, get_args

from arena_core.contracts.running import Better, Executor, Job, Lost, Metric, MetricPack
from arena_core.runs.jobs.rows import TEXT
from arena_core.testing import samples
from arena_core.testing.facts import Facts
from arena_core.values.robot import Robot

BETTER = get_args(Better)


def check_metrics(pack: MetricPack, body: Robot) -> Facts:
    """Evaluate small records: without and with a contact, and of a person who leaves."""
    metrics = pack.metrics()
    yield "names are unique", len({m.name for m in metrics}) == len(metrics)
    yield "every metric has a unit and a description", all(m.unit and m.description for m in metrics)
    yield f"better is {', '.join(BETTER)}", all(m.better in BETTER for m in metrics)
    for sample in (samples.record(), samples.record(contact=True), samples.record(contact=True, leaves=True)):
        values = [m.compute(sample) for m in metrics]
        yield "every value is a text in unit text, else a number", all(map(_fits_unit, metrics, values))
        again = [m.compute(sample) for m in metrics]
        yield "the same record gives the same values", [repr(v) for v in again] == [repr(v) for v in values]


def _fits_unit(metric: Metric, value: Any) -> bool:
    """Return whether a value is what the metric's unit says, and nothing infinite."""
    text = isinstance(value, str)
    return text == (metric.unit == TEXT) and (text or (isinstance(float(value), float) and not math.isinf(value)))


def check_executor(executor: Executor, body: Robot) -> Facts:
    """Run tiny jobs, in two rounds."""
    with closing(executor):
        for jobs in (range(3), range(3, 5)):
            rows = list(executor.map(echo_job, [Job({}, "", k) for k in jobs]))
            yield (
                "every job gives one row",
                sorted(row["episode"] for row in rows if not isinstance(row, Lost)) == list(jobs),
            )


def echo_job(job: Job) -> dict[str, Any]:
    """Return a job's number: the smallest work that there is."""
    return {"episode": job.episode}
