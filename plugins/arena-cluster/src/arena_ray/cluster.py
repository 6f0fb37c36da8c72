"""Ray itself: a cluster of its own on this machine, or one that is joined; its machines, and
what tells that one is lost.
"""

from __future__ import annotations

import os
import signal
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from arena_core import ConfigurationError
from arena_core.commands import one_line

OWN = {  # what a Ray of its own is told, unless the environment says otherwise
    "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0",  # its servers then listen on the loopback interface alone
    "RAY_AUTH_MODE": "token",  # whoever is on this machine has to know it: ~/.ray/auth_token
    "RAY_USAGE_STATS_ENABLED": "0",
    "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0",
}
PREFIX = "RAY_"
REACHED_WITHIN = 10.0  # s
SIGNALS = (signal.SIGINT, signal.SIGTERM)


@dataclass(frozen=True, slots=True)
class RayNode:
    """A machine as Ray knows it."""

    id: str
    name: str
    cpus: int


class Cluster:
    """A connection to Ray; ``own`` where this object began it."""

    def __init__(self, address: str | None, cpus: int | None) -> None:
        self._before = {name: value for name, value in os.environ.items() if name.startswith(PREFIX)}
        if address is None:
            os.environ.update({name: value for name, value in OWN.items() if name not in os.environ})
        import ray  # it reads the environment

        self._ray: Any = ray
        self.own = not ray.is_initialized()  # in a notebook a person may have
        if self.own:
            own_ray = {"num_cpus": cpus or os.cpu_count() or 1, "include_dashboard": False}
            with _preserve_signals():
                self._connect_ray(**(own_ray if address is None else {"address": address}))

    def _connect_ray(self, **words: Any) -> None:
        try:
            _check_reachable(words.get("address", "auto"))
            self._ray.init(configure_logging=False, log_to_driver=False, **words)
        except (OSError, RuntimeError, ValueError) as error:  # ConnectionError is an OSError
            where, reason = words.get("address", "null"), one_line(str(error), 200)
            allowed = "null, auto, HOST:PORT of a head"
            raise ConfigurationError(
                f"executor.address is {where}, and Ray cannot be reached: {reason}; allowed: {allowed}"
            ) from None

    def alive_nodes(self) -> list[RayNode]:
        """Return the machines that are alive and have CPUs."""
        found = [node for node in self._ray.nodes() if node["Alive"] and node["Resources"].get("CPU", 0.0) >= 1.0]
        return [
            RayNode(node["NodeID"], node.get("NodeManagerHostname", ""), int(node["Resources"]["CPU"]))
            for node in found
        ]

    def actor(self, kind: type, place: RayNode, cpus: int, *arguments: Any) -> Any:
        """Return an actor of a class on one machine and no other."""
        from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

        there = NodeAffinitySchedulingStrategy(place.id, soft=False)
        made = self._ray.remote(kind).options(num_cpus=min(cpus, place.cpus), scheduling_strategy=there, max_restarts=0)
        return made.remote(*arguments)

    def ready_calls(self, calls: list[Any], patience: float) -> list[Any]:
        """Return those of some calls that are answered, as soon as one is, at most ``patience`` s later."""
        found: list[Any] = self._ray.wait(calls, num_returns=1, timeout=patience)[0] if calls else []
        return found

    def answer(self, call: Any) -> Any:
        """Return a call's answer; raise LostMachine where its machine or actor is gone, else what the actor raised."""
        from ray.exceptions import RayError, RayTaskError

        try:
            return self._ray.get(call)
        except RayTaskError as error:
            raise (error.cause if isinstance(error.cause, Exception) else error) from None
        except RayError as error:
            raise LostMachine(one_line(str(error), 200)) from None

    def end(self, actor: Any) -> None:
        """End an actor, if it is still there."""
        self._ray.kill(actor)

    def close(self) -> None:
        """Leave Ray, and end it where it was begun here."""
        if self.own:
            with _preserve_signals():
                self._ray.shutdown()
        for name in [name for name in os.environ if name.startswith(PREFIX)]:
            del os.environ[name]
        os.environ.update(self._before)


def _check_reachable(address: str) -> None:
    """Raise OSError or ValueError where no one listens at HOST:PORT: Ray would try for minutes."""
    host, _, port = address.rpartition(":")
    if host and "://" not in address:
        socket.create_connection((host.strip("[]"), int(port)), timeout=REACHED_WITHIN).close()


class LostMachine(Exception):
    """A machine, or the actor on it, is gone."""


@contextmanager
def _preserve_signals() -> Iterator[None]:
    """Give signals back to whom they were: Ray takes SIGTERM for itself."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    hook = sys.excepthook
    try:
        yield
    finally:
        sys.excepthook = hook
        for number, handler in before.items():
            if handler is not None and signal.getsignal(number) is not handler:
                signal.signal(number, handler)
