"""The hooks that a plugin may implement; all but the last two are called once, when ``arena`` starts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import pluggy

from arena_core.values.episode import EpisodeRecord

hookspec = pluggy.HookspecMarker("arena")
hookimpl = pluggy.HookimplMarker("arena")

Factory = Callable[..., Any] | str


class Register(Protocol):
    """What a ``register_*`` hook receives; ``factory`` is a callable, or ``"module:name"`` to
    import it only when used.
    """

    def __call__(self, name: str, factory: Factory) -> None:
        """Offer ``factory`` under ``name``."""


@hookspec
def register_simulators(register: Register) -> None:
    """Offer simulators."""


@hookspec
def register_robots(register: Register) -> None:
    """Offer robots."""


@hookspec
def register_worlds(register: Register) -> None:
    """Offer sources of worlds."""


@hookspec
def register_pedestrian_models(register: Register) -> None:
    """Offer models of how people walk."""


@hookspec
def register_task_modes(register: Register) -> None:
    """Offer sources of scenarios."""


@hookspec
def register_localizers(register: Register) -> None:
    """Offer localisers."""


@hookspec
def register_global_planners(register: Register) -> None:
    """Offer global planners."""


@hookspec
def register_waypoint_generators(register: Register) -> None:
    """Offer waypoint generators."""


@hookspec
def register_local_maps(register: Register) -> None:
    """Offer local maps."""


@hookspec
def register_trackers(register: Register) -> None:
    """Offer moving-obstacle trackers."""


@hookspec
def register_planners(register: Register) -> None:
    """Offer local planners."""


@hookspec
def register_metrics(register: Register) -> None:
    """Offer metric packs."""


@hookspec
def register_rewards(register: Register) -> None:
    """Offer rewards for training."""


@hookspec
def register_observation_encoders(register: Register) -> None:
    """Offer observation encoders for learned planners."""


@hookspec
def register_trainers(register: Register) -> None:
    """Offer ways in which ``arena train`` trains a planner."""


@hookspec
def register_executors(register: Register) -> None:
    """Offer ways to run many episodes."""


@hookspec
def register_commands(register: Register) -> None:
    """Offer subcommands of ``arena``."""


@hookspec
def register_listings(register: Register) -> None:
    """Offer further things that ``arena list`` shows."""


@hookspec
def register_reporters(register: Register) -> None:
    """Offer what makes reports of runs."""


@hookspec
def config_package() -> str:  # type: ignore[empty-body]
    """Return the package that holds this plugin's configuration groups, such as ``my_planner.conf``."""


@hookspec
def episode_finished(record: EpisodeRecord) -> None:
    """Hear of a finished episode, in the process that ran it, after its record was written."""
