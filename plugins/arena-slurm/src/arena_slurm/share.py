"""What one Slurm job does: its share of the episodes, by supervised workers; each answer is a file as soon as it is there."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arena_core import (
    Budgets,
    Finished,
    InputFileError,
    Job,
    Lost,
    Node,
    OtherCode,
    RunFolderError,
    RunStopped,
    described,
    read_json,
    write_text_whole,
)

Work = Callable[[Job], Any]
ERRORS = {kind.__name__: kind for kind in (OtherCode, RunFolderError)}
ANSWER = re.compile(r"\d{6}\.json")
FAULT = "fault.json"
ALLOWED = "what a job of this run wrote"


@dataclass(frozen=True, slots=True)
class Share:
    """The jobs of one Slurm job, what works on them, and the folder for its answers."""

    work: Work
    jobs: Sequence[Job]
    workers: int
    budgets: Budgets
    answers: str

    def __call__(self) -> None:
        """Do it; what ends it is written down for the one who waits."""
        folder = Path(self.answers)
        numbers = {_key(job): number for number, job in enumerate(self.jobs)}
        try:
            with closing(Node(self.workers, self.budgets)) as node:
                node.add(self.jobs)
                while node.unfinished:
                    for one in node.look(self.work):
                        write_text_whole(folder / f"{numbers[_key(one.job)]:06d}.json", _written(one.answer))
        except Exception as error:
            write_text_whole(folder / FAULT, json.dumps({"kind": type(error).__name__, "text": described(error)}))


def new_answers(share: Share, known: set[int]) -> Iterator[tuple[Job, Any]]:
    """Yield jobs with their answers as far as they are there and not yet known, and note them."""
    folder = Path(share.answers)
    names = sorted(path.name for path in folder.iterdir() if ANSWER.fullmatch(path.name)) if folder.is_dir() else []
    for name in names:
        number = int(name.partition(".")[0])
        if number not in known and number < len(share.jobs):
            known.add(number)
            yield share.jobs[number], _read(folder / name, share.jobs[number])


def fault_of(share: Share) -> Exception | None:
    """Return what ended a share early, None where nothing did or nobody could write it down."""
    path = Path(share.answers) / FAULT
    if not path.exists():
        return None
    told = read_json(path, ALLOWED)
    text = str(told.get("text", "")).partition(": ")[2]
    return ERRORS.get(str(told.get("kind")), RunStopped)(text)


def _key(job: Job) -> tuple[str, int, int | None]:
    return job.folder, job.episode, job.stage


def _written(answer: Any) -> str:
    if isinstance(answer, Finished):
        return json.dumps({"row": dict(answer.row), "succeeded": answer.succeeded})
    if isinstance(answer, Lost):
        return json.dumps({"lost": answer.reason})
    return json.dumps({"value": answer})


def _read(path: Path, job: Job) -> Any:
    try:
        told = json.loads(path.read_bytes())  # NaN is a figure of a row
        if "row" in told:
            return Finished(job, told["row"], bool(told["succeeded"]))
        return Lost(job, str(told["lost"])) if "lost" in told else told["value"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputFileError(f"{path}: cannot be read ({described(error)}); allowed: {ALLOWED}") from None
