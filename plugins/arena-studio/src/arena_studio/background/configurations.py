"""Composing for the page Run: Hydra keeps what it composes in globals, and forms load the modules of components."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from arena_core.hosting import form_of, load_registry
from arena_studio.allowed_overrides import check_configuration
from arena_studio.background.requests import ComposeExperiment, OptionForm
from arena_studio.experiments.composing import compose_experiment


def compose_configuration(request: ComposeExperiment) -> dict[str, Any]:
    """Return a composition by its fields; raise ConfigurationError for the first value that is wrong."""
    return asdict(compose_experiment(request.choices, request.values, request.more))


def option_form(request: OptionForm) -> dict[str, Any]:
    """Return the parameters of one option."""
    check_configuration(Path.cwd())
    return asdict(form_of(request.group, request.option, load_registry()))
