#!/usr/bin/env python3
"""Drive a fixed sample of an experiment again and say which episodes are not those of docs/results/check.json.

usage: .venv/bin/python scripts/results_check.py [--first N] [--file FILE] [executor=NAME ...]
       .venv/bin/python scripts/results_check.py --write DIR [--experiment paper] [--file FILE]

``--write`` takes the digests of the sample from the finished runs below DIR. Exit status: 0 all are the same, 1 some
differ, 2 the request was wrong. On another processor or with other libraries records need not be the same bit for bit:
then outcomes are compared.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import tempfile
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from arena_core import ArenaError, InputFileError, Run, Runs, random_generator
from arena_core.files import read_json, write_text_whole
from arena_core.hosting import Job, compose, load_registry, to_plain
from arena_core.records import is_success, read_record, record_digest, record_path, repeat_episodes
from arena_submit.verification import AGREEING, current_environment, environment_differences

TOP = Path(__file__).resolve().parents[1]
KEPT = TOP / "docs" / "results" / "check.json"
SAMPLE = 40  # episodes


def main(words: Sequence[str] | None = None) -> int:
    """Check, or write what is checked; return the exit status."""
    parser = argparse.ArgumentParser("results_check", description=__doc__.partition("\n")[0])
    parser.add_argument("--first", type=int, metavar="N", help="check the first N of the sample alone")
    parser.add_argument("--file", type=Path, default=KEPT, help="what the digests are kept in")
    parser.add_argument("--write", type=Path, metavar="DIR", help="take them from these finished runs")
    parser.add_argument("--experiment", default="paper", help="with --write: the experiment")
    parser.add_argument("overrides", nargs="*", metavar="executor=NAME", help="where episodes run")
    given = parser.parse_args(words)
    try:
        if given.write is not None:
            return write_check(given.write, given.experiment, given.file)
        return check_sample(given.file, given.first, given.overrides)
    except ArenaError as error:
        print(f"results_check: {error}", file=sys.stderr)
        return error.exit_status


def sample_of(experiment: str, size: int = SAMPLE) -> list[dict[str, Any]]:
    """Return the overrides and the episode of a fixed sample: as many cells, drawn once and for
    all, with an episode of each.
    """
    config = compose([f"experiment={experiment}"], hydra=True)
    params = {str(key): str(values).split(",") for key, values in config.hydra.sweeper.params.items()}
    cells = [
        [f"{key}={value}" for key, value in zip(params, values, strict=True)] for values in product(*params.values())
    ]
    random = random_generator(0, experiment, "results-check")
    drawn = sorted(int(i) for i in random.choice(len(cells), size=min(size, len(cells)), replace=False))
    return [{"overrides": cells[i], "episode": int(random.integers(config.episodes))} for i in drawn]


def write_check(folder: Path, experiment: str, target: Path) -> int:
    """Keep the digests of the sample from finished runs."""
    runs = list(Runs.below(folder))
    kept = []
    for one in sample_of(experiment):
        run = _run_of(one["overrides"], experiment, runs)
        if run is None:
            raise InputFileError(
                f"{folder}: lacks {' '.join(one['overrides'])}; allowed: all of experiment={experiment}"
            )
        record = run.record(one["episode"])
        kept.append({**one, "digest": record_digest(record), "succeeded": is_success(record)})
    write_text_whole(
        target,
        json.dumps({"experiment": experiment, **current_environment(), "sample": kept}, indent=1, sort_keys=True)
        + "\n",
    )
    print(f"{target}: {len(kept)} episodes")
    return 0


def check_sample(path: Path, first: int | None, overrides: Sequence[str]) -> int:
    """Drive the sample and compare."""
    kept = read_json(path, "what results_check.py --write wrote")
    sample = kept["sample"][:first]
    elsewhere = list(environment_differences(kept))
    executor = to_plain(compose(list(overrides)))["executor"]
    differing, agreeing = [], 0
    with tempfile.TemporaryDirectory(prefix="arena-results-") as folder:
        asked = {str(Path(folder, str(number))): one for number, one in enumerate(sample)}
        for place, same, alike, told in _drive_sample(kept["experiment"], asked, executor):
            one = asked[place]
            agreeing += alike
            print(".", end="", flush=True)
            if not same:
                differing.append(f"{' '.join(one['overrides'])} episode {one['episode']}: {told}")
    print("\n" + "\n".join([*differing, *(f"here is {line}" for line in elsewhere)]).rstrip("\n"))
    print(f"{len(sample) - len(differing)} of {len(sample)} episodes are the same bit for bit, {agreeing} end alike")
    return int(agreeing < math.ceil(AGREEING * len(sample)) if elsewhere else bool(differing))


def _drive_sample(
    experiment: str, asked: dict[str, Any], executor: dict[str, Any]
) -> Iterator[tuple[str, bool, bool, str]]:
    """Drive episodes; yield the folder of each, whether it is the same, whether it ends alike, and how it went."""
    jobs = [Job(_sample_config(experiment, one["overrides"]), place, one["episode"]) for place, one in asked.items()]
    for answer in repeat_episodes(jobs, executor, load_registry()):
        one = asked[answer.job.folder]
        path = record_path(Path(answer.job.folder), answer.job.episode)
        if not path.exists():
            reason = getattr(answer, "reason", "") or str(answer.row.get("error"))  # type: ignore[union-attr]
            yield answer.job.folder, False, False, reason
            continue
        record = read_record(path)
        words = ["success" if one["succeeded"] else "failure", "success" if is_success(record) else "failure"]
        yield (
            answer.job.folder,
            record_digest(record) == one["digest"],
            words[0] == words[1],
            f"{words[0]} then, {words[1]} now",
        )


def _sample_config(experiment: str, overrides: Sequence[str]) -> dict[str, Any]:
    composed = compose([f"experiment={experiment}", *overrides], hydra=True)
    choices = {
        k: v for k, v in dict(composed.hydra.runtime.choices).items() if v is not None and not k.startswith("hydra/")
    }
    return {**{key: value for key, value in to_plain(_without_hydra(composed)).items()}, "choices": choices}


def _without_hydra(composed: Any) -> Any:
    from omegaconf import open_dict

    with open_dict(composed):
        del composed["hydra"]
    return composed


def _run_of(overrides: Sequence[str], experiment: str, runs: Sequence[Run]) -> Run | None:
    """Return the run of an experiment's cell, None where there is none."""
    wanted = _sample_config(experiment, overrides)
    parts = ("planner", "robot", "world", "task", "pedestrians", "localizer", "seed")
    return next((run for run in runs if all(run.config.get(part) == wanted[part] for part in parts)), None)


if __name__ == "__main__":
    sys.exit(main())
