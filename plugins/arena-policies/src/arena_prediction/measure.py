"""Predictors measured against the truth of simulated drives: all of them on the same tracks, as a planner would ask."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, ImpossibleScenario, Predictor
from arena_core.commands import print_notice
from arena_core.hosting import Benchmark, Registry, compose, load_registry, to_plain, watch_privileged
from arena_prediction.drives import Drive, WatchingPlanner, drive, watched_benchmark
from arena_prediction.scores import Scores, Summary, join_scores, score_predictions, summarise

Floats = NDArray[np.float64]
SAME = 0.5  # m between a track and the person that it follows, at most
ABREAST = 0.3  # s between two steps that are compared
STEP = 0.2  # s between two places that are compared


@dataclass(frozen=True, slots=True)
class Measured:
    """What is told of a predictor: its summary, and the median time of a call, ms."""

    summary: Summary
    milliseconds: float


def measure(words: Sequence[str], predictors: Sequence[str], horizon: float, miss: float) -> dict[str, Measured]:
    """Drive the episodes of ``arena run WORDS`` and return what each predictor is worth in them.

    Words that begin with ``predictor.`` are for those that have such a parameter. Raises ConfigurationError.
    """
    own = [word for word in words if word.startswith("predictor.")]
    benchmark, watching = watched_benchmark([word for word in words if word not in own])
    add_predictors(benchmark, watching, predictors, own)
    times = np.arange(STEP, horizon + 1e-9, STEP)
    parts: dict[str, list[Scores]] = {name: [] for name in predictors}
    for episode in range(benchmark.settings.episodes):
        try:
            driven = drive(benchmark, watching, episode)
        except ImpossibleScenario as error:
            print_notice(str(error))
            continue
        for name, scores in scores_of(driven, watching, times).items():
            parts[name].append(scores)
    if not any(len(scores.errors) for scores in parts[predictors[0]]):
        raise ConfigurationError(
            f"no track was seen for {horizon:g} s on end; allowed: more episodes or people, or a lower horizon"
        )
    calls = {name: 1e3 * float(np.median(watching.spent[name])) for name in predictors}
    return {name: Measured(summarise(join_scores(parts[name]), miss), calls[name]) for name in predictors}


def add_predictors(benchmark: Benchmark, watching: WatchingPlanner, names: Sequence[str], words: Sequence[str]) -> None:
    """Have a planner ask predictors; those that see the truth are shown it."""
    registry = load_registry()
    with watch_privileged() as seeing:
        watching.predictors = build_predictors(registry, benchmark, names, words)
    navigator = benchmark.navigator
    navigator.privileged = (*navigator.privileged, *(one.part for one in seeing))


def build_predictors(
    registry: Registry, benchmark: Benchmark, names: Sequence[str], words: Sequence[str]
) -> dict[str, Predictor]:
    """Build predictors by name, each with those ``words`` that are its own."""
    nodes = {name: to_plain(compose([f"predictor={name}"]))["predictor"] for name in names}
    for word in words:
        if not any(_has(node, word) for node in nodes.values()):
            raise ConfigurationError(f"{word}: no parameter of {', '.join(names)}; allowed: one that one of them has")
    for name, node in nodes.items():
        if own := [word for word in words if _has(node, word)]:
            nodes[name] = to_plain(compose([f"predictor={name}", *own]))["predictor"]
    return {name: registry.build("predictor", node, robot=benchmark.robot) for name, node in nodes.items()}


def _has(node: Mapping[str, object], word: str) -> bool:
    """Return whether a node has the parameter that a word ``predictor.KEY=VALUE`` sets."""
    inside: object = node
    for key in word.partition("=")[0].split(".")[1:]:
        if not isinstance(inside, Mapping) or key not in inside:
            return False
        inside = inside[key]
    return True


def scores_of(driven: Drive, watching: WatchingPlanner, times: Floats) -> dict[str, Scores]:
    """Return the scores of what was said in a drive; a track is the nearest person's."""
    found: dict[str, list[Scores]] = {name: [] for name in watching.predictors}
    every = max(round(ABREAST / float(np.diff(driven.stamps).min(initial=ABREAST))), 1)
    for row in range(0, len(driven.stamps), every):
        kept, truth = _followed(driven, row, times)
        for name, said in watching.said[row].items():
            found[name].append(score_predictions(said.take(kept), times, truth))
    return {name: join_scores(parts) for name, parts in found.items() if parts}


def _followed(driven: Drive, row: int, times: Floats) -> tuple[NDArray[np.int64], Floats]:
    """Return which tracks of a step are a person's who is there at all ``times``, and where that one then is."""
    seen, stamps = driven.tracks[row], driven.stamps
    rows = np.searchsorted(stamps, stamps[row] + times - 1e-3)
    nothing = np.empty(0, np.int64), np.empty((0, len(times), 2))
    if not len(seen.ids) or rows[-1] >= len(stamps) or stamps[rows[-1]] - stamps[row] - times[-1] > 0.05:
        return nothing
    away = np.hypot(*np.moveaxis(seen.positions[:, None] - driven.people[row], 2, 0))
    away = np.where(np.isfinite(away), away, np.inf)
    if not away.size:
        return nothing
    truth = driven.people[rows][:, away.argmin(axis=1)].swapaxes(0, 1)
    kept = np.flatnonzero((away.min(axis=1) <= SAME) & np.isfinite(truth).all(axis=(1, 2)))
    return kept, truth[kept]
