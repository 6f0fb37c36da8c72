"""``arena trainings``: what several training seeds are worth together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from pathlib import Path
from typing import ClassVar

from arena_core import ConfigurationError, InputFileError
from arena_core.commands import Command, read_words
from arena_core.statistics import over_seeds
from arena_policies.card import read_card

USAGE = "arena trainings DIR...   (each written by `arena train`)"
HEAD = (
    "| planner | robot | seeds | success of each | success | collision | time out | episodes each | weights after |",
    "| --- | --- | --- | --- | --- | --- | --- | --- | --- |",
)


@dataclass(frozen=True, slots=True)
class TestedTraining:
    """What a training's card says: its seed, the test's shares and episodes, and after how many
    steps the weights were taken.
    """

    planner: str
    robot: str
    seed: int
    success: float
    collision: float
    time_out: float
    episodes: int
    steps: int


class TrainingsCommand(Command):
    """Tell what trainings of several seeds are worth together."""

    help: ClassVar[str] = "table of trained policies over training seeds: arena trainings trainings/rosnav_*"

    def run(self, arguments: Sequence[str]) -> int:
        """Print a table in Markdown: a row for each planner and robot, one more where a planner has several robots."""
        if any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}")
            return 0
        folders = read_words(USAGE, arguments, names=None).names
        if not folders:
            raise ConfigurationError(f"no folder is named; allowed: {USAGE}")
        trainings = sorted(
            (_read_training(Path(folder)) for folder in folders), key=lambda t: (t.planner, t.robot, t.seed)
        )
        _check_seeds(trainings)
        print("\n".join([*HEAD, *_table_rows(trainings)]))
        print(
            "\nSuccess is without any collision. Means are interquartile over training seeds, "
            "with 95 % intervals (bootstrap of seeds)."
        )
        return 0


def _read_training(folder: Path) -> TestedTraining:
    path = folder / "policy.json"
    card = read_card(path)
    try:
        score, choice = card.training["score"], card.training["choice"]
        shares = (float(score["success"]), float(score["collision"]), float(score["time_out"]))
        return TestedTraining(
            card.planner, card.robot, int(card.training["seed"]), *shares, int(score["episodes"]), int(choice["steps"])
        )
    except (KeyError, TypeError, ValueError):
        raise InputFileError(
            f"{path}: training has no score of a test; allowed: a card that `arena train` wrote at its end"
        ) from None


def _check_seeds(trainings: Sequence[TestedTraining]) -> None:
    for one, other in pairwise(trainings):
        if (one.planner, one.robot, one.seed) == (other.planner, other.robot, other.seed):
            raise ConfigurationError(
                f"{one.planner} on {one.robot} is there twice with seed {one.seed}; allowed: each training once"
            )


def _table_rows(trainings: Sequence[TestedTraining]) -> Iterator[str]:
    for planner, found in groupby(trainings, key=lambda t: t.planner):
        groups = [list(group) for _, group in groupby(found, key=lambda t: t.robot)]
        for group in groups:
            yield _table_row(planner, group[0].robot, [group])
        if len(groups) > 1:
            yield _table_row(planner, "all", groups)


def _table_row(planner: str, robot: str, groups: Sequence[Sequence[TestedTraining]]) -> str:
    every = [one for group in groups for one in group]
    seeds = "; ".join(", ".join(str(one.seed) for one in group) for group in groups)
    each = "; ".join(", ".join(f"{one.success:.3f}" for one in group) for group in groups)
    shares = [
        _format_interval(*over_seeds([[getattr(one, name) for one in group] for group in groups]))
        for name in ("success", "collision")
    ]
    time_out = over_seeds([[one.time_out for one in group] for group in groups])[0]
    episodes = " .. ".join(str(n) for n in sorted({one.episodes for one in every}))
    steps = " .. ".join(
        f"{n / 1e6:.2f}" for n in sorted({min(one.steps for one in every), max(one.steps for one in every)})
    )
    cells = planner, robot, seeds, each, *shares, f"{time_out:.3f}", episodes, f"{steps} million steps"
    return f"| {' | '.join(cells)} |"


def _format_interval(mean: float, low: float, high: float) -> str:
    return f"{mean:.3f}" if math.isnan(low) else f"{mean:.3f} ({low:.3f} .. {high:.3f})"
