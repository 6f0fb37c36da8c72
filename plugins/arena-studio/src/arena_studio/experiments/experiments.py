"""Experiments of a project: composed, started, watched, stopped, resumed.

What is known of them lies in ``.arena_studio``.
"""

from __future__ import annotations

import json
import re
import secrets
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from threading import RLock
from typing import Any

from arena_core import ArenaError, InputFileError
from arena_core.files import read_json, reading_within, write_text_whole
from arena_core.parameters import read_settings
from arena_studio.allowed_overrides import check_overrides, check_text
from arena_studio.errors import Conflict, Missing
from arena_studio.experiments.composing import MOST_JOBS, Composition, shell_command
from arena_studio.experiments.processes import Process, log_tail, start_process
from arena_studio.experiments.progress import Progress
from arena_studio.project import Project

PLACE = ".arena_studio/runs"
NAME = re.compile(r"[0-9a-f]{8}")
STAMP = re.compile(r"\d{1,11}\.\d{1,9}")  # when a process began, s since 1970
MOST_EPISODES, LARGEST_PID = 10**9, 2**31 - 1
ALLOWED = "what the studio wrote"


@dataclass(frozen=True, slots=True)
class Experiment:
    """One experiment that was started: the ``words`` behind ``arena``, its folder, and the process that runs or ran it.

    ``status`` is the exit status, None while it runs or where no one has seen its end. ``created`` says when the
    process began, s since 1970, by which it is told from a later one of the same id; it is a text, for settings hold no
    numbers as large.
    """

    name: str
    words: list[str]
    folder: str
    jobs: int
    episodes: int
    began: str
    pid: int
    created: str
    status: int | None
    interrupted: bool

    @property
    def process(self) -> Process:
        """Return the process."""
        return Process(self.pid, float(self.created))


class Experiments:
    """All experiments that the studio has started in a project, also before it was itself restarted."""

    def __init__(self, project: Project) -> None:
        self._project = project
        self.root = project.root
        self._place = _own_folder(project)
        self._lock = RLock()
        self._known: dict[str, Experiment] = {}
        self._progress: dict[str, Progress] = {}
        for path in sorted(self._place.glob("*.json")):
            with suppress(ArenaError), reading_within(project.root):  # not the studio's own
                one = read_settings(read_json(path, ALLOWED), Experiment, path.name)
                project.path(one.folder)
                if one.name == path.stem and NAME.fullmatch(one.name) and _is_own(one, project.root):
                    self._known[one.name] = one

    def start(self, composition: Composition, folder: str) -> dict[str, Any]:
        """Start an experiment into ``folder`` of the project (empty: a new one, by the time of
        day); return how it stands.
        """
        folder = (
            folder.strip()
            or f"{'multirun' if composition.is_sweep else 'outputs'}/{datetime.now().strftime('%Y-%m-%d/%H-%M-%S-%f')}"
        )
        place = self.run_folder(folder)
        if place.exists() and (not place.is_dir() or any(place.iterdir())):
            raise Conflict(f"{folder} is there already; allowed: a new folder")
        name, words = secrets.token_hex(4), composition.command(folder)
        with self._lock:
            process = start_process(words, self._project.root, self._log_file(name))
            began = datetime.now(UTC).isoformat(timespec="seconds")
            facts = (
                name,
                words,
                folder,
                composition.jobs,
                composition.episodes,
                began,
                process.pid,
                repr(process.created),
                None,
                False,
            )
            self._save_experiment(Experiment(*facts))
        return self.experiment_state(name)

    def run_folder(self, folder: str) -> Path:
        """Return where a run's folder would lie; raise ArenaError for a name that it may not have."""
        check_text(folder, "folder", self._project.root)
        return self._project.path(folder)

    def stop(self, name: str) -> dict[str, Any]:
        """Send Ctrl-C to an experiment that runs: the first lets episodes under way end at their next step,
        a second one does not wait.
        """
        with self._lock:
            one = self._find_experiment(name)
            if not one.process.is_alive():
                raise Conflict(f"{one.folder} does not run any more")
            one.process.interrupt()
            self._save_experiment(replace(one, interrupted=True))
        return self.experiment_state(name)

    def resume(self, name: str) -> dict[str, Any]:
        """Go on with an experiment that was cut off; finished episodes are kept."""
        with self._lock:
            one = self._find_experiment(name)
            if one.process.is_alive():
                raise Conflict(f"{one.folder} runs already")
            words = [*(word for word in one.words if not word.startswith("resume=")), "resume=true"]
            process = start_process(words, self._project.root, self._log_file(name))
            self._progress.pop(name, None)
            self._save_experiment(
                replace(
                    one, words=words, pid=process.pid, created=repr(process.created), status=None, interrupted=False
                )
            )
        return self.experiment_state(name)

    def forget(self, name: str) -> None:
        """Take an experiment that has ended off the list; its folder stays."""
        with self._lock:
            one = self._find_experiment(name)
            if one.process.is_alive():
                raise Conflict(f"{one.folder} runs; allowed: experiments that have ended")
            for path in (self._place / f"{name}.json", self._log_file(name)):
                path.unlink(missing_ok=True)
            self._known.pop(name)
            self._progress.pop(name, None)

    def experiment_state(self, name: str) -> dict[str, Any]:
        """Return how one experiment stands."""
        with self._lock:
            return self._describe_state(self._find_experiment(name))

    def folder(self, name: str) -> Path:
        """Return the folder of an experiment, above those of its jobs."""
        return self._project.path(self._find_experiment(name).folder)

    def all(self) -> list[dict[str, Any]]:
        """Return how all stand, the youngest first."""
        with self._lock:
            known = sorted(self._known.values(), key=lambda one: one.began, reverse=True)
            return [self._describe_state(one) for one in known]

    def _describe_state(self, one: Experiment) -> dict[str, Any]:
        alive = one.process.is_alive()  # before it is asked how it ended: it may end in between
        one = self._note_exit(one)
        progress = self._progress.setdefault(one.name, Progress(self._job_folders(one), one.episodes))
        found = progress.refresh()
        state = "stopping" if alive and one.interrupted else "running" if alive else _ending_text(one, found)
        return {
            **{
                "name": one.name,
                "state": state,
                "folder": one.folder,
                "command": shell_command(one.words),
                "began": one.began,
                "jobs": one.jobs,
            },
            **{
                "status": one.status,
                "workers": one.process.workers() if alive else 0,
                "said": log_tail(self._log_file(one.name)),
            },
            **found,
            "left": progress.left() if alive else None,
            "folders": [self._project.relative(folder) for folder in self._job_folders(one)],
        }

    def _note_exit(self, one: Experiment) -> Experiment:
        """Note the exit status of a process that has ended."""
        status = one.process.status()
        if one.status is not None or status is None:
            return one
        ended = replace(one, status=status)
        self._save_experiment(ended)
        return ended

    def _job_folders(self, one: Experiment) -> Sequence[Path]:
        place = self._project.root / one.folder
        return [place / str(number) for number in range(one.jobs)] if one.jobs > 1 else [place]

    def _find_experiment(self, name: str) -> Experiment:
        if name not in self._known:
            raise Missing("there is no such experiment")
        return self._known[name]

    def _save_experiment(self, one: Experiment) -> None:
        self._known[one.name] = one
        write_text_whole(self._place / f"{one.name}.json", json.dumps(asdict(one), indent=1) + "\n")

    def _log_file(self, name: str) -> Path:
        return self._place / f"{name}.log"


def _own_folder(project: Project) -> Path:
    """Return where the studio keeps what it knows of experiments; raise InputFileError where a
    link leads it out of the project.
    """
    place = project.root / PLACE
    if not place.resolve().is_relative_to(project.root):
        raise InputFileError(f"{place}: leads out of the project folder; allowed: a folder in it, or none yet")
    return place


def _is_own(one: Experiment, root: Path) -> bool:
    """Return whether a note can be the studio's; raise ConfigurationError for words that a browser may not send."""
    check_text(one.folder, "folder", root)
    # the words that the studio adds
    studios = Composition((), one.jobs, one.episodes, {}).command(one.folder, resume=True)
    check_overrides([word for word in one.words if word not in studios], root)
    numbers = 0 < one.jobs <= MOST_JOBS and 0 < one.episodes <= MOST_EPISODES and 0 < one.pid <= LARGEST_PID
    return numbers and bool(STAMP.fullmatch(one.created)) and one.words[:1] == ["run"]


def _ending_text(one: Experiment, found: Mapping[str, Any]) -> str:
    """Return how an experiment ended: refused ones have begun nothing, cut off ones can be resumed."""
    if found["done"] >= one.episodes:
        return "finished"
    return "refused" if one.status == 2 and found["done"] == 0 else "cut off"
