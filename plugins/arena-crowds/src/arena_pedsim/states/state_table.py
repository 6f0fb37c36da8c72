"""The table of social states (``states.yaml``), by name for people and as arrays for kernels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any, NamedTuple

import numpy as np
import yaml
from numpy.typing import NDArray

from arena_pedsim.states.behaviour import TRAITS

GOALS = ("none", "waypoint", "circle", "beside", "near", "robot_goal", "group", "queue")
NEEDS = (
    *(
        "nothing",
        "over",
        "listener",
        "company",
        "service",
        "alone",
        "server",
        "guide",
        "request",
        "partner_in",
        "partner_not_in",
    ),
    *("trigger", "grouped", "ungrouped", "queue", "arrived"),
)
NO_KEY = -1

STATE = np.dtype(
    [(name, np.float64) for name in ("speed", "social", "keep")]
    + [(name, np.int64) for name in ("pushed", "goal", "base_time", "exact", "free", "startled", "first", "last")],
    align=True,
    # ``social`` NaN: the person's own; ``base_time``: index of a trait or NO_KEY; transitions ``first`` to ``last`` - 1
    # lead away
)

TRANSITION = np.dtype([(name, np.int64) for name in ("to", "chance", "needs", "of", "calls", "draw")], align=True)
# ``of``: a bit for each state; ``calls``: a state or 0; ``draw``: number of the random draw, the row's place in the
# file


class StateRules(NamedTuple):
    """What kernels read: ``states`` (S,) by code, ``transitions`` (T,) sorted by the
    state they leave, ``numbers`` (1,).
    """

    states: NDArray[np.void]
    transitions: NDArray[np.void]
    numbers: NDArray[np.void]


@dataclass(frozen=True, slots=True, eq=False)
class StateTable:
    """The states' ``names`` by code, and the rules by which people go from one to another."""

    names: tuple[str, ...]
    rules: StateRules

    def code(self, name: str) -> int:
        """Return the code that records hold for a state."""
        return self.names.index(name)


@cache
def state_table() -> StateTable:
    """Return the table that the package ships."""
    return read_table(yaml.safe_load((files("arena_pedsim") / "states.yaml").read_text()))


def state_names() -> tuple[str, ...]:
    """Return the name of each state by its code: ``pedestrian_states`` of a record are places in this."""
    return state_table().names


def read_table(table: Mapping[str, Any]) -> StateTable:
    """Turn the file's content into arrays; raise ValueError for a code, a state, a need or a key that does not fit."""
    rows = {name: dict(zip(table["state_columns"], row, strict=True)) for name, row in table["states"].items()}
    names = tuple(sorted(rows, key=lambda name: int(rows[name]["code"])))
    if [rows[name]["code"] for name in names] != list(range(len(names))):
        raise ValueError(
            f"codes of states are {[rows[name]['code'] for name in names]}; allowed: 0, 1, 2 ... without a gap"
        )
    states = np.array([_state_row(rows[name]) for name in names], STATE)
    leaving = _by_origin(
        [dict(zip(table["transition_columns"], row, strict=True)) for row in table["transitions"]], names
    )
    states["last"] = np.cumsum([len(group) for group in leaving])
    states["first"] = states["last"] - [len(group) for group in leaving]
    transitions = np.array([row for group in leaving for row in group], TRANSITION)
    numbers = np.array([tuple(table["numbers"].values())], [(name, np.float64) for name in table["numbers"]])
    return StateTable(names, StateRules(states, transitions, numbers))


def _state_row(row: Mapping[str, Any]) -> tuple[Any, ...]:
    social = np.nan if row["social"] is None else row["social"]
    return (
        *(row["speed"], social, row["keep"]),
        *(
            row["pushed"],
            GOALS.index(row["goal"]),
            _trait_index(row["base_time"]),
            row["exact"],
            row["free"],
            row["startled"],
            0,
            0,
        ),
    )


def _by_origin(rows: Sequence[Mapping[str, Any]], names: tuple[str, ...]) -> list[list[tuple[int, ...]]]:
    """Return for each state the transitions that leave it, in the order of the file."""
    leaving: list[list[tuple[int, ...]]] = [[] for _ in names]
    for draw, row in enumerate(rows):
        of = sum(1 << names.index(name) for name in row["of"])
        calls = 0 if row["calls"] is None else names.index(row["calls"])
        entry = (names.index(row["to"]), _trait_index(row["chance"]), NEEDS.index(row["needs"]), of, calls, draw)
        for origin in [row["from"]] if isinstance(row["from"], str) else row["from"]:
            leaving[names.index(origin)].append(entry)
    return leaving


def _trait_index(key: str | None) -> int:
    return NO_KEY if key is None else TRAITS.index(key)
