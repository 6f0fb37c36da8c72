"""``/api/run``: forms made of what is installed, composing, starting, stopping, resuming."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter
from pydantic import BaseModel, Field, StringConstraints

from arena_core import ConfigurationError
from arena_core.hosting import default_options, load_registry, option_names, settings_form
from arena_studio.allowed_overrides import check_configuration
from arena_studio.background.process import SOON, SideProcess
from arena_studio.background.requests import ComposeExperiment, OptionForm
from arena_studio.experiments.composing import Composition, shell_command
from arena_studio.experiments.experiments import Experiments

# groups that an experiment begins with
FIRST = ("planner", "robot", "world", "task", "people", "pedestrians", "scenario", "experiment")
NONE = ("scenario", "stack", "experiment")  # groups of which none may be chosen
Name = Annotated[str, StringConstraints(max_length=200)]
Text = Annotated[str, StringConstraints(max_length=4000)]


class RunRequest(BaseModel):
    """What a form holds: options by group, values by key, words as typed, and the folder (empty: a new one)."""

    choices: dict[Name, Annotated[list[Name], Field(max_length=100)]] = Field(default_factory=dict, max_length=100)
    values: dict[Name, Text] = Field(default_factory=dict, max_length=1000)
    more: Text = ""
    folder: Name = ""


def make_router(experiments: Experiments, side: SideProcess) -> APIRouter:
    """Return the routes of the page Run; ``side`` composes."""
    routes = APIRouter(prefix="/api/run")

    @routes.get("/groups")
    def groups() -> list[dict[str, Any]]:
        """Return the groups of the configuration, those that an experiment begins with first, with their options."""
        check_configuration(experiments.root)
        registry = load_registry()
        chosen = default_options(registry)
        names = [*(name for name in FIRST if name in chosen), *(name for name in chosen if name not in FIRST)]
        return [_group_form(name, chosen[name]) for name in names]

    @routes.get("/form")
    def form(group: Name, option: Name) -> Any:
        """Return the parameters of one option."""
        return side.ask(OptionForm(group=group, option=option), SOON)

    @routes.get("/settings")
    def settings() -> dict[str, Any]:
        """Return the run's own settings."""
        return asdict(settings_form(load_registry()))

    @routes.post("/compose")
    def compose(wanted: RunRequest) -> dict[str, Any]:
        """Compose and check; return the command line and the values that hold."""
        if wanted.folder:
            experiments.run_folder(wanted.folder)
        return _describe_run(_compose_request(wanted, side), wanted)

    @routes.post("/start")
    def start(wanted: RunRequest) -> dict[str, Any]:
        return experiments.start(_compose_request(wanted, side), wanted.folder)

    @routes.get("/experiments")
    def all_experiments() -> list[dict[str, Any]]:
        return experiments.all()

    @routes.post("/experiments/{name}/stop")
    def stop(name: Name) -> dict[str, Any]:
        return experiments.stop(name)

    @routes.post("/experiments/{name}/resume")
    def resume(name: Name) -> dict[str, Any]:
        return experiments.resume(name)

    @routes.post("/experiments/{name}/forget")
    def forget(name: Name) -> dict[str, Any]:
        experiments.forget(name)
        return {}

    return routes


def _group_form(name: str, chosen: str) -> dict[str, Any]:
    try:
        options = option_names(name, load_registry())
    except ConfigurationError:  # nothing installed offers any
        options = {}
    listed = [{"name": option, "about": about} for option, about in options.items()]
    return {"name": name, "chosen": chosen, "optional": name in NONE, "first": name in FIRST, "options": listed}


def _compose_request(wanted: RunRequest, side: SideProcess) -> Composition:
    """Compose what is wanted; unless it says otherwise, episodes can be watched as they run."""
    values = {**wanted.values, "recording.live": wanted.values.get("recording.live", "true")}
    found = side.ask(ComposeExperiment(choices=wanted.choices, values=values, more=wanted.more), SOON)
    return Composition(tuple(found["words"]), found["jobs"], found["episodes"], found["values"])


def _describe_run(composed: Composition, wanted: RunRequest) -> dict[str, Any]:
    words = composed.command(wanted.folder)[:-1] if not wanted.folder else composed.command(wanted.folder)
    return {
        "command": shell_command(words),
        "jobs": composed.jobs,
        "episodes": composed.episodes,
        "values": composed.values,
    }
