"""What a ladder drives: its cells, rungs, blocks, and when a cell is finished."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

from arena_core import ConfigurationError


@dataclass(frozen=True, slots=True)
class Plan:
    """The cells by name with their words for ``arena run``, and the rule by which episodes are given out."""

    cells: Mapping[str, tuple[str, ...]]
    rungs: tuple[float, ...]
    first: tuple[int, ...]
    block: int
    cap: int
    precision: float
    seed: int

    @property
    def names(self) -> list[str]:
        """Return the names of the cells, WORLD_CROWD."""
        return list(self.cells)


def make_plan(
    worlds: str | None = None, crowds: str | None = None, cap: int | None = None, precision: float | None = None
) -> Plan:
    """Return the plan of some worlds and crowds, names with commas between (None: all); raise ConfigurationError."""
    told = read_settings()
    chosen = [_choose(told[key], wanted, key) for key, wanted in (("worlds", worlds), ("crowds", crowds))]
    cells = {f"{w}_{c}": (*told["worlds"][w], *told["crowds"][c]) for w in chosen[0] for c in chosen[1]}
    rungs = tuple(map(float, told["rungs"]))
    first = tuple(rungs.index(float(rung)) for rung in told["first"])
    most = told["cap"] if cap is None else cap
    if most < told["block"] * len(first):
        raise ConfigurationError(f"cap is {most}; allowed: {told['block'] * len(first)} or more, the first blocks")
    return Plan(
        cells, rungs, first, told["block"], most, told["precision"] if precision is None else precision, told["seed"]
    )


def read_settings() -> dict[str, Any]:
    """Return what ``cells.yaml`` holds."""
    from omegaconf import OmegaConf

    text = (files("arena_ladder") / "cells.yaml").read_text(encoding="utf-8")
    told: Any = OmegaConf.to_container(OmegaConf.create(text))
    return dict(told)


def _choose(known: Mapping[str, Sequence[str]], wanted: str | None, key: str) -> list[str]:
    names = list(known) if wanted is None else list(dict.fromkeys(wanted.split(",")))
    for name in names:
        if name not in known:
            raise ConfigurationError(
                f"{key} is {wanted}; allowed: {', '.join(known)}, or some of them with commas between"
            )
    return names
