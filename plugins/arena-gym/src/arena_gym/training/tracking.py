"""Weights & Biases beside TensorBoard."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError
from arena_core.commands import one_line


def check_wandb(project: str | None) -> None:
    """Raise ConfigurationError (one line) where there is a project but no package that could be told of it."""
    if project is not None and find_spec("wandb") is None:
        raise ConfigurationError(
            f"wandb is {project}, and the package wandb is not installed; allowed: null, or pip install wandb"
        )


@contextmanager
def shown_to_wandb(project: str | None, folder: Path, config: Mapping[str, Any]) -> Iterator[None]:
    """Show a project of Weights & Biases all that TensorBoard is shown of the training in ``folder``; None: no one."""
    if project is None:
        yield
        return
    import wandb

    told = {"project": project, "name": folder.name, "dir": str(folder), "config": dict(config)}
    try:
        run = wandb.init(sync_tensorboard=True, **told)
    except wandb.Error as error:  # no key, no network
        raise ConfigurationError(
            f"wandb is {project}, which cannot be reached ({one_line(str(error))}); allowed: null, or "
            "WANDB_MODE=offline and `wandb sync` later"
        ) from error
    try:
        yield
    finally:
        run.finish()
