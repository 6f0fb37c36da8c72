"""What is found out about runs once their episodes have ended: how far they are from what could have been done."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from arena_core.config.registry import Registry
from arena_core.contracts.running import Reference
from arena_core.runs.folders.schedule import OpenRun

NONE = {"name": "none"}  # of configurations that are older than references


class NoReference(Reference):
    """Finds out nothing."""

    def refer(self, folders: Sequence[Path], executor: Mapping[str, Any]) -> None:
        """Leave the runs as they are."""


class References:
    """The references that some runs chose, each built once; those that chose the same one share it."""

    def __init__(self, configs: Sequence[Mapping[str, Any]], registry: Registry) -> None:
        self._built: dict[str, Reference] = {}
        for config in configs:
            node = _node(config)
            if _key(node) not in self._built:
                self._built[_key(node)] = registry.build("reference", node)

    def refer(self, runs: Sequence[OpenRun]) -> None:
        """Have each find out about the runs that chose it."""
        for reference, members in self._chosen(runs):
            reference.refer([run.folder for run in members], members[0].config["executor"])

    def _chosen(self, runs: Sequence[OpenRun]) -> Iterator[tuple[Reference, list[OpenRun]]]:
        for key, reference in self._built.items():
            yield reference, [run for run in runs if _key(_node(run.config)) == key]


def _node(config: Mapping[str, Any]) -> Mapping[str, Any]:
    node: Mapping[str, Any] = config.get("reference", NONE)
    return node


def _key(node: Mapping[str, Any]) -> str:
    return json.dumps(node, sort_keys=True)
