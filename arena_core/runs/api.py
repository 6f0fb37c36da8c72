"""The way in from Python: ``arena.run([...])`` runs what the command line would, and returns what came of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from arena_core.base.errors import ArenaError, ConfigurationError
from arena_core.config.configuration import PRIMARY, compose, one_line_errors
from arena_core.config.output_word import split_out
from arena_core.config.registry import load_registry
from arena_core.config.sweeps import expand_sweep
from arena_core.contracts.running import Reporter
from arena_core.loop.record_files import read_record
from arena_core.loop.record_places import find_runs, record_path
from arena_core.runs.folders.provenance import read_provenance
from arena_core.runs.running import RunRequest, run_all
from arena_core.values.episode import EpisodeRecord

if TYPE_CHECKING:
    from pandas import DataFrame


class Run:
    """One run on disk: a cell's episodes. ``folder`` is where it lies."""

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)

    @property
    def config(self) -> Mapping[str, Any]:
        """Return the composed configuration."""
        config: Mapping[str, Any] = self.provenance["config"]
        return config

    @cached_property
    def provenance(self) -> Mapping[str, Any]:
        """Return what a reader needs to repeat the run: versions, code, seed, commit, machine."""
        return read_provenance(self.folder)

    @property
    def episodes(self) -> DataFrame:
        """Return the table of episodes, as it is on disk now: a row each, a column a metric (NaN
        where it is not defined).
        """
        return _import_pandas().read_csv(self.folder / "episodes.csv", keep_default_na=False, na_values={})

    def record(self, episode: int) -> EpisodeRecord:
        """Return the record of an episode; raise InputFileError where there is none."""
        return read_record(record_path(self.folder, episode))

    def __repr__(self) -> str:
        config = self.config
        return f"<Run of {config['planner']['name']} on {config['robot']['name']}: {self.folder}>"


class Runs(Sequence[Run]):
    """Some runs, such as those of one call of ``run``; ``runs[0]`` is a ``Run``."""

    def __init__(self, runs: Sequence[Run]) -> None:
        self._runs = list(runs)

    @staticmethod
    def below(*folders: str | Path) -> Runs:
        """Return all runs at or below some folders; raise InputFileError where there is none."""
        return Runs([Run(folder) for above in folders for folder in find_runs(Path(above))])

    @overload
    def __getitem__(self, index: int) -> Run: ...
    @overload
    def __getitem__(self, index: slice) -> Runs: ...
    def __getitem__(self, index: int | slice) -> Run | Runs:
        """Return one run, or some of them."""
        return Runs(self._runs[index]) if isinstance(index, slice) else self._runs[index]

    def __len__(self) -> int:
        return len(self._runs)

    def __iter__(self) -> Iterator[Run]:
        return iter(self._runs)

    def __repr__(self) -> str:
        return "\n".join(map(repr, self._runs))

    @property
    def episodes(self) -> DataFrame:
        """Return the episodes of all runs in one table; ``preset``, ``robot``, ``world`` and
        others say which is whose.
        """
        return _import_pandas().concat([run.episodes for run in self._runs], ignore_index=True)

    def compare(self, baseline: str | None = None) -> DataFrame:
        """Compare planners with a baseline (by default the first) on the same scenarios: a row for each planner,
        condition and metric.

        ``difference`` has its 95 % interval ``low`` .. ``high``, ``p`` and ``p_holm``, after Holm among the comparisons
        of one metric.
        """
        return _import_pandas().DataFrame(list(_find_reporter().compare(self._run_folders(), baseline)))

    def report(self, out: str | Path, baseline: str | None = None) -> Path:
        """Write tables, pictures and a page to the folder ``out``; return the folder."""
        _find_reporter().report(self._run_folders(), Path(out), baseline)
        return Path(out)

    def _run_folders(self) -> list[Path]:
        return [run.folder for run in self._runs]


def run(overrides: Sequence[str] = (), folder: str | Path | None = None) -> Runs:
    """Run what ``arena run -m OVERRIDES`` would: every combination of the choices, ``planner=dwa,teb``.

    Runs go to ``folder``, or to ``out=DIR`` among the overrides, or where the configuration says (``outputs/``,
    ``multirun/``); a report is made when ``report`` is called. It may be called from a notebook, from inside a Hydra
    application, and from a script without a main guard. An episode that fails is a row with its error. Raises
    ArenaError in one line for what is wrong with the request, before anything runs.
    """
    overrides, out = split_out(overrides)
    if folder is not None and out is not None:
        raise ConfigurationError(f"out is {out} and folder is {folder}; allowed: one of the two")
    folder = folder if out is None else out
    with one_line_errors():
        jobs = expand_sweep(overrides)
    composed = [compose(words, PRIMARY, hydra=True) for words in jobs]
    hydra = composed[0].hydra
    target = Path(folder if folder is not None else hydra.sweep.dir if len(composed) > 1 else hydra.run.dir).resolve()
    folders = [target / str(number) for number in range(len(composed))] if len(composed) > 1 else [target]
    return _run_composed(composed, jobs, folders)


def run_jobs(jobs: Mapping[Path, Sequence[str]]) -> Runs:
    """Run what ``arena run OVERRIDES`` would, for each folder with its own overrides, through one executor."""
    with one_line_errors():
        composed = [compose(words, PRIMARY, hydra=True) for words in jobs.values()]
    return _run_composed(composed, list(jobs.values()), [folder.resolve() for folder in jobs])


def _run_composed(composed: Sequence[Any], jobs: Sequence[Sequence[str]], folders: Sequence[Path]) -> Runs:
    requests = [_make_request(*each) for each in zip(composed, jobs, folders, strict=True)]
    run_all(requests, load_registry())
    return Runs([Run(folder) for folder in folders])


def _make_request(composed: Any, overrides: Sequence[str], folder: Path) -> RunRequest:
    from omegaconf import OmegaConf, open_dict

    hydra = composed.hydra
    with open_dict(composed):
        del composed["hydra"]
    if folder.exists() and not folder.is_dir():
        raise ConfigurationError(f"folder is {folder}, a file; allowed: a folder, or a name that is free")
    folder.mkdir(parents=True, exist_ok=True)
    files = {
        ".hydra/config.yaml": OmegaConf.to_yaml(composed),
        ".hydra/overrides.yaml": OmegaConf.to_yaml(list(overrides)),
    }
    return RunRequest(composed, folder, dict(hydra.runtime.choices), files)


def _find_reporter() -> Reporter:
    registry = load_registry()
    names = registry.names("reporter")
    if not names:
        raise ArenaError("no plugin makes reports; allowed: arena-metrics, or another one that registers a reporter")
    reporter: Reporter = registry.component("reporter", names[0]).resolve()()
    return reporter


def _import_pandas() -> Any:
    try:
        import pandas
    except ImportError as error:
        raise ArenaError("tables need pandas, which is not installed; allowed: pip install pandas") from error
    return pandas
