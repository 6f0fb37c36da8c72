"""Composing for the page Run: Hydra keeps what it composes in globals, and forms load the modules of components."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from arena_core.hosting import form_of, load_registry
from arena_studio.allowed_overrides import check_configuration
from arena_studio.composing import compose_experiment


def composed(choices: Mapping[str, Sequence[str]], values: Mapping[str, str], more: str) -> dict[str, Any]:
    """Return a composition by its fields; raise ConfigurationError for the first value that is wrong."""
    return asdict(compose_experiment(choices, values, more))


def form(group: str, option: str) -> dict[str, Any]:
    """Return the parameters of one option."""
    check_configuration(Path.cwd())
    return asdict(form_of(group, option, load_registry()))
