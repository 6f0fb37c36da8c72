"""Cells: episodes of one composed configuration and one state of the code, named by what
differs between the cells shown.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from arena_metrics.pooling.runs import Episode

FACTORS = {  # columns that tell cells apart, in the order in which a reader wants them
    "preset": "planner",
    "robot": "robot",
    "world": "world",
    "n_pedestrians": "people",
    "reaction": "reaction",
    "pedestrian_model": "people model",
    "task": "task",
    "simulator": "simulator",
    "localizer": "localiser",
    "timing": "timing",
    "predictor": "predictor",
    "communication": "communication",
    "privileged": "sees the truth",
}
SCENARIO = "scenario"  # the option of a pack; the column of that name is a single problem
VARIANT = "variant"
NO_COMPETITOR = " (no competitor)"  # behind the name of a planner that sees the truth
SEEING = "planner "  # what the column ``privileged`` has ahead of such a planner
NOT_SHOWN = (
    "choices",
    "seed",
    "episodes",
    "executor",
    "resume",
    "report",
    "reference",
    "objective",
    "metrics",
    "recording",
    "experiment",
    "code",
)
NAMED_KEYS = 3  # differing keys that a variant's name spells out


@dataclass(frozen=True, slots=True, eq=False)
class Cell:
    """One cell: its hash, its code, its episodes in order, its configuration, and its value of every factor.

    The hash is that of the configuration, and names the code too where one configuration was run with several. A
    planner that sees the truth is a reference, which does not compete: it has no rank and takes part in no test.
    """

    hash: str
    code: str
    episodes: Sequence[Episode]
    config: Mapping[str, Any]
    factors: Mapping[str, str]

    @property
    def competes(self) -> bool:
        """Return whether the planner sees no more than a robot does."""
        return not self.factors["planner"].endswith(NO_COMPETITOR)

    def values(self, column: str) -> list[float]:
        """Return a metric of every episode, NaN where it is not defined or was not computed."""
        return [float(episode.row.get(column, float("nan"))) for episode in self.episodes]

    def texts(self, column: str) -> Counter[str]:
        """Return how many episodes have each text of a metric, in the order of the texts."""
        return Counter(sorted(text for episode in self.episodes if (text := str(episode.row.get(column) or ""))))


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """The cells that a report shows, sorted; ``varying`` are the factors that differ, ``common`` those that do not."""

    cells: Sequence[Cell]
    varying: Sequence[str]
    common: Mapping[str, str]

    @property
    def competing(self) -> Cells:
        """Return those that compete; all where none does."""
        return replace(self, cells=[cell for cell in self.cells if cell.competes] or self.cells)

    def name(self, cell: Cell) -> str:
        """Return what tells this cell from the others."""
        return (
            ", ".join(_factor_text(factor, cell.factors[factor]) for factor in self.varying if cell.factors[factor])
            or cell.factors["planner"]
        )

    def planner(self, cell: Cell) -> str:
        """Return the planner with its variant."""
        variant = cell.factors[VARIANT]
        return f"{cell.factors['planner']} ({variant})" if variant else cell.factors["planner"]

    def condition(self, cell: Cell, without: Sequence[str] = ()) -> str:
        """Return what differs beyond the planner."""
        factors = [f for f in self.varying if f not in ("planner", VARIANT, *without)]
        return ", ".join(_factor_text(factor, cell.factors[factor]) for factor in factors if cell.factors[factor])


def _factor_text(factor: str, value: str) -> str:
    return f"{value} people" if factor == "people" else value


def cells_of(episodes: Sequence[Episode]) -> Cells:
    """Group episodes by their composed configuration and their code, and name the groups."""
    groups: dict[tuple[str, str], list[Episode]] = {}
    for episode in episodes:
        groups.setdefault((episode.row["config_hash"], episode.row.get("code", "")), []).append(episode)
    codes = Counter(name for name, _ in groups)
    plain = [_make_cell(name, code, group, several=codes[name] > 1) for (name, code), group in groups.items()]
    cells = sorted(_with_variants(plain), key=lambda cell: [_natural_key(cell.factors[f]) for f in _sort_order()])
    varying = [f for f in [*FACTORS.values(), SCENARIO, VARIANT] if len({cell.factors[f] for cell in cells}) > 1]
    common = {f: value for f, value in cells[0].factors.items() if f != VARIANT and f not in varying and value}
    return Cells(cells, varying, common)


def cells_with_certificates(episodes: Sequence[Episode], certificates: Sequence[Episode]) -> tuple[Cells, list[Cell]]:
    """Return the cells of runs, and those of certificates under the same conditions, named alike; none where the
    clairvoyant drove there itself.
    """
    if not certificates:
        return cells_of(episodes), []
    driven = [cell.factors for cell in cells_of(episodes).cells]
    apart = [cell for cell in cells_of(certificates).cells if not any(_alike(cell.factors, own) for own in driven)]
    lent = [episode for cell in apart for episode in cell.episodes]
    found = cells_of([*episodes, *lent])
    others = {id(episode) for episode in lent}
    split = [[cell for cell in found.cells if (id(cell.episodes[0]) in others) is of] for of in (False, True)]
    return replace(found, cells=split[0]), split[1]


def _alike(factors: Mapping[str, str], others: Mapping[str, str]) -> bool:
    """Return whether two cells are alike but for their variants."""
    return {**factors, VARIANT: ""} == {**others, VARIANT: ""}


def _sort_order() -> list[str]:
    """Return conditions ahead of the planner, so that planners stand together under one condition."""
    return [SCENARIO, *(f for f in FACTORS.values() if f != "planner"), "planner", VARIANT]


def _natural_key(text: str) -> list[tuple[int, float, str]]:
    """Return a key that sorts the numbers in texts by value, ahead of words."""
    parts = [part for part in re.split(r"(\d+(?:\.\d+)?)", text) if part]
    return [(0, float(part), "") if part[0].isdigit() else (1, 0.0, part) for part in parts]


def _make_cell(name: str, code: str, group: Sequence[Episode], *, several: bool) -> Cell:
    """Make a cell; ``several`` says that its configuration was run with other code too."""
    episodes = sorted(group, key=lambda e: (e.row["seed"], e.row["episode"]))
    config = episodes[0].run.provenance.get("config", {})
    factors = {
        title: next((e.row[column] for e in episodes if e.row.get(column)), "") for column, title in FACTORS.items()
    }
    seen = factors[FACTORS["privileged"]]
    if without_planners(seen) != seen:
        factors["planner"] += NO_COMPETITOR
        factors[FACTORS["privileged"]] = without_planners(seen)
    scenario = str(config.get("choices", {}).get("scenario", ""))
    own = {
        FACTORS["n_pedestrians"]: _people_text(episodes, config),
        SCENARIO: scenario,
        VARIANT: f"code {code or 'unknown'}" if several else "",
    }
    return Cell(f"{name}-{code or 'unknown'}" if several else name, code, episodes, config, {**factors, **own})


def without_planners(seen: str) -> str:
    """Return what saw the truth, as the column ``privileged`` has it, but for planners."""
    return ", ".join(part for part in seen.split(", ") if not part.startswith(SEEING))


def _people_text(episodes: Sequence[Episode], config: Mapping[str, Any]) -> str:
    """Return the number of people, the range where it varies; what was asked for where no
    episode got so far as to have any.
    """
    counts = [e.row["n_pedestrians"] for e in episodes if e.row["n_pedestrians"] >= 0] or [
        config.get("task", {}).get("pedestrians")
    ]
    if not all(isinstance(count, int) for count in counts):
        return ""
    return str(counts[0]) if min(counts) == max(counts) else f"{min(counts)}–{max(counts)}"


def _with_variants(cells: Sequence[Cell]) -> Iterator[Cell]:
    """Name the configuration keys that differ between cells which are otherwise called alike."""
    alike: dict[tuple[str, ...], list[Cell]] = {}
    for cell in cells:
        alike.setdefault(tuple(value for factor, value in cell.factors.items() if factor != VARIANT), []).append(cell)
    for group in alike.values():
        differing = config_differences([cell.config for cell in group]) if len(group) > 1 else {}
        for i, cell in enumerate(group):
            variant = ", ".join(
                f"{_short_key(key, differing)}={values[i]}" for key, values in list(differing.items())[:NAMED_KEYS]
            )
            more = len(differing) > NAMED_KEYS or (
                not differing and len({other.episodes[0].row["config_hash"] for other in group}) > 1
            )
            named = f"{variant} {cell.hash[:4]}".strip() if more else variant
            yield replace(
                cell, factors={**cell.factors, VARIANT: ", ".join(filter(None, (named, cell.factors[VARIANT])))}
            )


def _short_key(key: str, others: Mapping[str, Any]) -> str:
    """Return the last part of a key where that is unique among the others."""
    last = key.rpartition(".")[2]
    return last if sum(other.rpartition(".")[2] == last for other in others) == 1 else key


def config_differences(configs: Sequence[Mapping[str, Any]]) -> dict[str, list[str]]:
    """Return every configuration key that is not the same in all, with its value in each ("–" where it is absent)."""
    flat = [dict(_flatten_keys({k: v for k, v in config.items() if k not in NOT_SHOWN})) for config in configs]
    keys = dict.fromkeys(key for config in flat for key in config)
    table = {key: [config.get(key, "–") for config in flat] for key in keys}
    return {key: values for key, values in table.items() if len(set(values)) > 1}


def _flatten_keys(node: Any, prefix: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from _flatten_keys(value, f"{prefix}{key}.")
    else:
        yield prefix.rstrip("."), node if isinstance(node, str) else json.dumps(node)
