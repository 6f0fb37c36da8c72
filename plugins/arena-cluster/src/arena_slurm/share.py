"""What one Slurm job does: its share of the episodes, by supervised workers; each answer is a
file as soon as it is there.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from arena_core import InputFileError
from arena_core.commands import describe_error
from arena_core.files import read_json, write_text_whole
from arena_core.hosting import Budgets, Finished, Job, Lost, Node, OtherCode, RunFolderError, RunStopped

Work = Callable[[Job], Any]
Start = tuple[int, int] | None
ERRORS = {kind.__name__: kind for kind in (OtherCode, RunFolderError)}
ANSWER = re.compile(r"\d{6}\.json")
FAULT = "fault.json"
ALLOWED = "what a job of this run wrote"


@dataclass(frozen=True, slots=True)
class Share:
    """The jobs of one Slurm job, what works on them, the folder for its answers, and the starts
    (``starts_of``) of their runs.
    """

    work: Work
    jobs: Sequence[Job]
    workers: int
    budgets: Budgets
    answers: str
    starts: Mapping[str, Start]

    def __call__(self) -> None:
        """Do it; what ends it is written down for the one who waits, unless no one does: then
        this ends without a word.
        """
        folder = Path(self.answers)
        numbers = {_job_key(job): number for number, job in enumerate(self.jobs)}
        try:
            with closing(Node(self.workers, self.budgets)) as node:
                node.add(self.jobs)
                while node.unfinished and self._is_awaited():
                    for one in node.look(self.work):
                        if self._is_awaited():
                            text = json.dumps({**_answer_identity(self, one.job), **_encode_answer(one.answer)})
                            write_text_whole(folder / f"{numbers[_job_key(one.job)]:06d}.json", text)
        except Exception as error:
            if self._is_awaited():
                write_text_whole(
                    folder / FAULT, json.dumps({"kind": type(error).__name__, "text": describe_error(error)})
                )

    def _is_awaited(self) -> bool:
        """Return whether no later start has taken the runs' folders over: whoever
        sent this share may have been killed.
        """
        return Path(self.answers).is_dir() and starts_of(self.starts) == self.starts


def starts_of(folders: Iterable[str]) -> dict[str, Start]:
    """Return by run's folder what its last start has left there: each writes its provenance, as a new file."""
    return {folder: _start_of(Path(folder) / "provenance.json") for folder in folders}


def _start_of(path: Path) -> Start:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns


def new_answers(share: Share, known: set[int]) -> Iterator[tuple[Job, Any]]:
    """Yield jobs with their answers as far as they are there and not yet known, and note them."""
    folder = Path(share.answers)
    names = sorted(path.name for path in folder.iterdir() if ANSWER.fullmatch(path.name)) if folder.is_dir() else []
    for name in names:
        number = int(name.partition(".")[0])
        if number not in known and number < len(share.jobs):
            known.add(number)
            yield share.jobs[number], _read_answer(folder / name, share, share.jobs[number])


def fault_of(share: Share) -> Exception | None:
    """Return what ended a share early, None where nothing did or no one could write it down."""
    path = Path(share.answers) / FAULT
    if not path.exists():
        return None
    told = read_json(path, ALLOWED)
    text = str(told.get("text", "")).partition(": ")[2]
    return ERRORS.get(str(told.get("kind")), RunStopped)(text)


def _job_key(job: Job) -> tuple[str, int, int | None]:
    return job.folder, job.episode, job.stage


def _answer_identity(share: Share, job: Job) -> dict[str, Any]:
    """Return what binds an answer to its start, run and job."""
    return {"answers": share.answers, "job": list(_job_key(job)), "code": job.config.get("code")}


def _encode_answer(answer: Any) -> dict[str, Any]:
    if isinstance(answer, Finished):
        team = [[one.job.episode, dict(one.row), one.succeeded] for one in answer.team]
        return {"row": dict(answer.row), "succeeded": answer.succeeded, **({"team": team} if team else {})}
    if isinstance(answer, Lost):
        return {"lost": answer.reason}
    return {"value": answer}


def _read_answer(path: Path, share: Share, job: Job) -> Any:
    try:
        told = json.loads(path.read_bytes())  # NaN is a figure of a row
        if any(told[key] != value for key, value in _answer_identity(share, job).items()):
            raise ValueError("it answers another job")
        if "row" in told:
            others = [(replace(job, episode=int(k)), row, bool(done)) for k, row, done in told.get("team", ())]
            return Finished(job, told["row"], bool(told["succeeded"]), tuple(Finished(*one) for one in others))
        return Lost(job, str(told["lost"])) if "lost" in told else told["value"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputFileError(f"{path}: cannot be read ({describe_error(error)}); allowed: {ALLOWED}") from None
