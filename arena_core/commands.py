"""``arena run`` and ``arena evaluate``."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

from arena_core.configuration import PRIMARY, compose, conf_directory, one_line_errors, plain
from arena_core.errors import ArenaError, ConfigurationError
from arena_core.interfaces import Command
from arena_core.recording import find_runs
from arena_core.registry import load_registry
from arena_core.run import RunRequest, re_evaluate, run_all

MULTIRUN = ("-m", "--multirun")


class RunTask:
    """What Hydra calls for a single run; its launcher hands the jobs of a multirun to ``run`` together."""

    def __init__(self) -> None:
        self.status = 0
        self.error: ArenaError | None = None

    def __call__(self, config: Any) -> int:
        """Run the composed configuration in the folder that Hydra made for it."""
        from hydra.core.hydra_config import HydraConfig

        runtime = HydraConfig.get().runtime
        return self.run([RunRequest(config, Path(runtime.output_dir), runtime.choices)])

    def run(self, requests: Sequence[RunRequest]) -> int:
        """Run all requests and keep the worst exit status, or the error: Hydra would print lines of its own about it."""
        try:
            self.status = max(self.status, run_all(requests))
        except ArenaError as error:
            self.error = error
        return self.status


class RunCommand(Command):
    """Compose a configuration from Hydra overrides and run it."""

    help: ClassVar[str] = "run a benchmark: arena run [-m] [KEY=VALUE ...]"

    def run(self, arguments: Sequence[str]) -> int:
        """Hand the overrides to Hydra; raise ArenaError (one line) when the request is wrong."""
        import hydra

        os.environ["HYDRA_FULL_ERROR"] = "1"  # Hydra then raises instead of printing and exiting by itself
        task = RunTask()
        flags = [argument for argument in arguments if argument in MULTIRUN]  # Hydra wants them ahead of overrides
        before, sys.argv = sys.argv, ["arena run", *flags, *(argument for argument in arguments if argument not in MULTIRUN)]
        try:
            with one_line_errors():
                hydra.main(str(conf_directory()), PRIMARY, version_base="1.3")(task)()
        except OSError as error:
            raise ConfigurationError(f"cannot use the run's folder {error.filename}: {error.strerror}") from error
        finally:
            sys.argv = before
        if task.error is not None:
            raise task.error
        return task.status


class EvaluateCommand(Command):
    """Compute metrics anew from records."""

    help: ClassVar[str] = "recompute metrics from records: arena evaluate DIR... [metrics=[si,paper_legacy]]"

    def run(self, arguments: Sequence[str]) -> int:
        """Rewrite episodes.csv in every run's folder at or below the given ones."""
        parser = argparse.ArgumentParser("arena evaluate", description=self.__doc__)
        parser.add_argument("directories", nargs="+", metavar="DIR", help="a run's folder, or one above several; KEY=VALUE chooses packs")
        given = parser.parse_args(list(arguments)).directories
        overrides = [argument for argument in given if "=" in argument]
        metrics = plain(compose(overrides).metrics) if overrides else None
        registry = load_registry()
        folders = [folder for directory in given if "=" not in directory for folder in find_runs(Path(directory))]
        if not folders:
            raise ArenaError("no folder given; allowed: folders that `arena run` wrote, or folders above them")
        for folder in folders:
            print(f"{folder}: {re_evaluate(folder, registry, metrics)} episodes")
        return 0
