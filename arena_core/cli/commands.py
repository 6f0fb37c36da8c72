"""``arena run`` and ``arena evaluate``."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from contextlib import chdir
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any, ClassVar

from arena_core.base.errors import ArenaError, ConfigurationError, RunStopped
from arena_core.base.folders import KEPT, lock_folder, new_folders
from arena_core.base.limits import LIMITS
from arena_core.cli.candidates import complete_overrides
from arena_core.cli.words import key_value, read_words
from arena_core.config.configuration import PRIMARY, compose, one_line_errors, to_plain
from arena_core.config.option_folders import conf_directory
from arena_core.config.output_word import RUN_FOLDER, SWEEP_FOLDER, run_folder_words, split_out
from arena_core.config.registry import load_registry
from arena_core.config.sweeps import are_swept, defer_job_overrides
from arena_core.contracts.running import Command
from arena_core.loop.record_places import find_runs
from arena_core.runs.folders.resuming import re_evaluate
from arena_core.runs.objective import check_objective, objective_of
from arena_core.runs.running import RunRequest, run_all, write_reports

MULTIRUN = ("-m", "--multirun")
EVALUATE = "arena evaluate DIR... [metrics=[si,paper_legacy]] [out=DIR]"
FLAGS: Mapping[str, Sequence[str]] = {
    **dict.fromkeys(MULTIRUN, ()),
    "--cfg": ("job", "hydra", "all"),
    "--resolve": (),
    "--help": (),
}
CALLBACKS = {"folders", "best"}  # those of conf/config.yaml: what they hear of a run is where it begins
FOLDER_KEYS = (RUN_FOLDER, SWEEP_FOLDER, "hydra.sweep.subdir")


class Shown(Exception):
    """All jobs of a multirun have been shown: there is nothing to run."""


@dataclass(frozen=True, slots=True)
class Show:
    """What of the configurations of a multirun is printed in place of running it: ``job``, ``hydra`` or ``all``."""

    what: str
    resolve: bool

    def show(self, number: int, overrides: Sequence[str], config: Any) -> None:
        """Print the configuration of one job, a document of YAML."""
        from omegaconf import OmegaConf, flag_override

        parts = {"job": [key for key in config if key != "hydra"], "hydra": ["hydra"], "all": list(config)}
        with flag_override(config, ["struct", "readonly"], [False, False]):
            chosen = OmegaConf.masked_copy(config, parts[self.what])
        print(f"---\n# {number}: {' '.join(overrides)}\n{OmegaConf.to_yaml(chosen, resolve=self.resolve)}", end="")


class RunTask:
    """What Hydra calls for a single run; its launcher hands the jobs of a multirun
    to ``run`` together, or shows them.
    """

    def __init__(self, show: Show | None = None) -> None:
        self.show = show
        self.status = 0
        self.error: ArenaError | None = None

    def __call__(self, config: Any) -> Any:
        """Run the composed configuration in the folder that Hydra made for it; return what a sweeper is told of it."""
        from hydra.core.hydra_config import HydraConfig
        from hydra.types import RunMode

        hydra: Any = HydraConfig.instance().cfg
        one = make_request(config, hydra)
        with chdir(hydra.hydra.runtime.cwd):  # where hydra.job.chdir has left it, relative paths would mean others
            told = self.run([one])
        # this is the process of another launcher: no one will look at this object
        if hydra.hydra.mode == RunMode.MULTIRUN:
            if self.error is not None:
                raise self.error
            if self.status and config.objective is None:
                raise RunStopped(f"{one.folder}: some episode failed with an error; its episodes.csv says which")
        return told[0] if told else None

    def run(self, requests: Sequence[RunRequest], above: Path | None = None) -> list[Any]:
        """Run all requests, those of a multirun in folders below ``above``; return for each its objective, else the
        exit status.

        Keeps the worst exit status, or the error, and then returns nothing: Hydra would print lines of its own about
        it.
        """
        registry = load_registry()
        try:
            wanted = [to_plain(request.config)["objective"] for request in requests]
            for one, objective in zip(requests, wanted, strict=True):
                if objective is not None:
                    check_objective(to_plain(one.config), registry)
            runs = run_all(requests, registry)
            write_reports(runs, registry, above)
            self.status = max(self.status, *(int(run.failed) for run in runs))
            folders = [request.folder for request in requests]
            return [
                self.status if o is None else objective_of(folder, o) for folder, o in zip(folders, wanted, strict=True)
            ]
        except ArenaError as error:
            self.error = error
            return []


def make_request(config: Any, hydra: Any) -> RunRequest:
    """Return the request of one job, from its configuration and Hydra's own, which go to
    ``.hydra`` once the request is accepted.
    """
    from omegaconf import OmegaConf

    own = hydra.hydra
    contents = {"config": config, "hydra": hydra, "overrides": own.overrides.task}
    files = {f".hydra/{name}.yaml": OmegaConf.to_yaml(content) for name, content in contents.items()}
    return RunRequest(config, Path(own.runtime.output_dir), dict(own.runtime.choices), files)


class RunCommand(Command):
    """Compose a configuration from Hydra overrides and run it."""

    help: ClassVar[str] = "run a benchmark: arena run [-m] [KEY=VALUE ...]"
    kept: ClassVar[str] = KEPT

    def run(self, arguments: Sequence[str]) -> int:
        """Hand the overrides to Hydra; raise ArenaError (one line) when the request is wrong, and
        leave nothing of it behind.
        """
        if {"-h", "--help"} & set(arguments):
            print((files("arena_core") / "run_help.txt").read_text(encoding="utf-8"), end="")
            return 0
        new_folders.forget()
        try:
            return self._run(arguments)
        except ArenaError as error:
            if error.exit_status == ArenaError.exit_status:
                new_folders.remove()
            raise

    def _run(self, arguments: Sequence[str]) -> int:
        arguments = run_folder_words(arguments)
        _check_folders(arguments)
        os.environ["HYDRA_FULL_ERROR"] = "1"  # Hydra then raises instead of printing and exiting by itself
        flags = [argument for argument in arguments if argument in MULTIRUN]  # Hydra wants them ahead of overrides
        words = [argument for argument in arguments if argument not in MULTIRUN]
        show, words = _split_cfg(words) if flags else (None, words)
        task = RunTask(show)
        before = sys.argv
        try:
            with one_line_errors():
                _through_hydra(task, flags, words)
        except Shown:
            new_folders.remove()
        except OSError as error:
            if isinstance(error, BrokenPipeError):  # no one reads what --cfg prints
                raise
            raise ConfigurationError(f"cannot use the run's folder {error.filename}: {error.strerror}") from error
        finally:
            sys.argv = before
        if task.error is not None:
            raise task.error
        return task.status

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return options of groups, keys and what Hydra takes."""
        if words and (values := FLAGS.get(words[-1])):
            return values
        if word.startswith("-"):
            return list(FLAGS)
        return [*(["out="] if word and "out=".startswith(word) else []), *complete_overrides(words, word)]


def _through_hydra(task: RunTask, flags: Sequence[str], words: Sequence[str]) -> None:
    """Have Hydra compose and start the task; words that only the jobs of a multirun can take are told to it
    as such, if there are any.

    A single run that asks for nothing of Hydra but a folder is started here: ``hydra.main`` composes everything twice,
    to see first whether it is a multirun.
    """
    from hydra.errors import ConfigCompositionException

    try:
        plain = not flags and not any(_asks_for_hydra(word) for word in words)
        if not plain or are_swept(words) or not _run_once(task, words):
            _start_hydra(task, flags, words)
    except ConfigCompositionException:
        fitting = defer_job_overrides(words, multirun=bool(flags))
        if fitting == list(words):
            raise
        _start_hydra(task, flags, fitting)


def _start_hydra(task: RunTask, flags: Sequence[str], words: Sequence[str]) -> None:
    import hydra

    sys.argv = ["arena run", *flags, *words]
    hydra.main(str(conf_directory()), PRIMARY, version_base="1.3")(task)()


def _asks_for_hydra(word: str) -> bool:
    """Return whether a word is a flag, or one of Hydra's own other than where a run or a multirun goes."""
    folder = word.partition("=")[0] in (RUN_FOLDER, SWEEP_FOLDER)
    return word.startswith("-") or (word.lstrip("+~").startswith("hydra") and not folder)


def _run_once(task: RunTask, words: Sequence[str]) -> bool:
    """Compose a single run and start it as ``hydra.main`` does; return False, and start nothing, where what is composed
    asks for a multirun or for more of Hydra than its job.
    """
    import hydra
    from hydra.core.global_hydra import GlobalHydra
    from hydra.core.utils import run_job
    from hydra.experimental.callback import Callback
    from hydra.types import HydraContext, RunMode
    from hydra.utils import instantiate

    with hydra.initialize_config_dir(str(conf_directory()), job_name="commands", version_base="1.3"):
        config = hydra.compose(PRIMARY, overrides=list(words), return_hydra_config=True)
        own = config.hydra
        if own.mode is not None or own.verbose or set(own.callbacks) != CALLBACKS:
            return False
        own.mode = RunMode.RUN
        own.overrides.hydra.append("hydra.mode=RUN")  # as it stands where Hydra itself found that out
        for callback in own.callbacks.values():
            instantiate(callback).on_run_start(config=config, config_name=PRIMARY)
        context = HydraContext(GlobalHydra.instance().config_loader(), Callback())  # type: ignore[arg-type]
        _ = run_job(task, config, "hydra.run.dir", None, context).return_value  # raises what the task did
    return True


def _split_cfg(words: Sequence[str]) -> tuple[Show | None, list[str]]:
    """Take `--cfg`, which Hydra knows for single runs alone, out of the words of a multirun."""
    parser = argparse.ArgumentParser("arena run", add_help=False, allow_abbrev=False)
    parser.add_argument("--cfg", "-c", choices=FLAGS["--cfg"])
    parser.add_argument("--resolve", action="store_true")
    given, others = parser.parse_known_args(list(words))
    if given.cfg is None:
        return None, list(words)
    return Show(given.cfg, given.resolve), [*others, "hydra/launcher=arena"]


def _check_folders(words: Sequence[str]) -> None:
    """Raise ConfigurationError for a folder inside more folders than any is: Hydra would make them one
    inside the other, without end.
    """
    for word in words:
        name, value = key_value(word)
        if name in FOLDER_KEYS and len(Path(value).parts) > LIMITS.folder_parts:
            raise ConfigurationError(
                f"{name} has {len(Path(value).parts)} parts; allowed: up to "
                f"{LIMITS.folder_parts} folders inside each other"
            )


class EvaluateCommand(Command):
    """Compute metrics again from records; with out=DIR beside the runs' own tables, below DIR."""

    help: ClassVar[str] = f"recompute metrics from records: {EVALUATE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Rewrite episodes.csv in every run's folder at or below the given ones, or write it below another folder."""
        arguments, out = split_out(arguments)
        parser = argparse.ArgumentParser("arena evaluate", usage=EVALUATE, description=self.__doc__)
        parser.add_argument(
            "directories",
            nargs="+",
            metavar="DIR",
            help="a run's folder, or one above several; KEY=VALUE chooses packs",
        )
        given = parser.parse_args(list(arguments)).directories
        words = read_words(EVALUATE, given, names=None, overrides=["metrics"])
        metrics = to_plain(compose(words.overrides).metrics) if words.overrides else None
        registry = load_registry()
        targets = _table_folders(words.names, out)
        if not targets:
            raise ArenaError("no folder given; allowed: folders that `arena run` wrote, or folders above them")
        for folder, target in targets.items():
            with lock_folder(target):
                print(f"{target}: {re_evaluate(folder, registry, metrics, target)} episodes")
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the metric packs; folders are the shell's."""
        return complete_overrides(words, word) if word.startswith("metrics=") else ()


def _table_folders(names: Sequence[str], out: str | None) -> dict[Path, Path]:
    """Return where the table of each run goes, by the run's folder: there, or to its like below ``out``.

    Raises ConfigurationError for two runs whose tables would be one file.
    """
    runs = [(Path(name), folder) for name in names for folder in find_runs(Path(name))]
    if out is None:
        return {folder: folder for _, folder in runs}
    below = [
        folder.relative_to(name) if len(names) == 1 else name.name / folder.relative_to(name) for name, folder in runs
    ]
    if len(set(below)) < len(below):
        raise ConfigurationError(
            f"several folders are called alike; allowed with out={out}: folders of different names"
        )
    return {folder: Path(out) / place for (_, folder), place in zip(runs, below, strict=True)}
