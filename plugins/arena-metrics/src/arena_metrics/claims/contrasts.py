"""From a contrast to pairs of episodes, and from these to what they say."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Literal

import numpy as np

from arena_core.statistics import ALPHA, Comparison, Estimate, after_holm, compare, estimate
from arena_metrics.claims.model import RIVAL, Contrast
from arena_metrics.pooling.cells import FACTORS, Cell, Cells
from arena_metrics.pooling.problems import problem_key
from arena_metrics.pooling.runs import Column, Episode
from arena_metrics.pooling.summary import success_column

State = Literal["holds", "does not hold", "cannot be decided", "not tested"]
POWERED = 2.8  # standard errors that a difference has to be off for 80 % power at 5 % (Cohen 1988, section 2.4)
TITLES = tuple(FACTORS.values())


@dataclass(frozen=True, slots=True)
class ProblemMean:
    """A metric of one problem under one condition, averaged over what was selected together; ``label`` and
    ``world`` for statistics.
    """

    mean: float
    label: Hashable
    world: str


@dataclass(frozen=True, slots=True)
class Finding:
    """What runs say of one contrast: ``what`` was compared, the mean (difference) with its interval, and whether it
    holds.

    ``more`` is how many more problems would probably decide what cannot be decided yet; infinite where none would.
    ``smallest`` is the least difference that as many problems as there are would probably show.
    """

    contrast: Contrast
    what: str
    estimate: Estimate | None
    p: float
    state: State
    more: float
    smallest: float = math.nan


def contrast_findings(cells: Cells, columns: Mapping[str, Column], contrasts: Sequence[Contrast]) -> list[Finding]:
    """Return what the cells say of each contrast, taken apart by ``each``; p after Holm among all that are given."""
    parts = [part for contrast in contrasts for part in _split_contrast(cells, contrast)]
    compared = [_compare_pairs(cells, columns, part) for part in parts]
    known = [i for i, one in enumerate(compared) if isinstance(one, Comparison)]
    after = dict(zip(known, after_holm([one for one in compared if isinstance(one, Comparison)]), strict=True))
    return [_make_finding(part, after.get(i, one)) for i, (part, one) in enumerate(zip(parts, compared, strict=True))]


def _split_contrast(cells: Cells, contrast: Contrast) -> Iterator[Contrast]:
    """Yield the contrast for every value, among the cells that it selects, of the factors in ``each``."""
    factors = [factor for factor in contrast.each if factor != RIVAL]
    chosen = _selected_cells(cells, contrast.of)
    values = [_factor_values(chosen, factor) for factor in factors]
    rivals: list[Any] = _other_planners(cells, contrast) if RIVAL in contrast.each else [None]
    for rival, combination in product(rivals, product(*values)):
        own = {**contrast.of, **dict(zip(factors, combination, strict=True))}
        than = contrast.than if contrast.than is None or rival is None else {**contrast.than, "planner": rival}
        yield replace(contrast, of=own, than=than, each=[])


def _other_planners(cells: Cells, contrast: Contrast) -> list[str]:
    """Return the planners of ``than``, which "others" stands for all of, but those of ``of``."""
    assert contrast.than is not None
    wanted = contrast.than.get("planner", "others")
    ours = {cell.factors["planner"] for cell in _selected_cells(cells, contrast.of)}
    named = _factor_values(cells.cells, "planner") if wanted == "others" else [str(one) for one in _as_list(wanted)]
    return [planner for planner in named if planner not in ours]


def _factor_values(cells: Sequence[Cell], factor: str) -> list[str]:
    return list(dict.fromkeys(cell.factors[factor] for cell in cells if cell.factors[factor]))


def _as_list(wanted: Any) -> list[Any]:
    return list(wanted) if isinstance(wanted, (list, tuple)) else [wanted]


def _selected_cells(cells: Cells, selection: Mapping[str, Any]) -> list[Cell]:
    """Return the cells of a selection; a planner is meant by its preset, or by its name where
    no one drove such a preset.
    """
    return [
        cell
        for cell in cells.cells
        if all(_matches_factor(cells, cell, factor, wanted) for factor, wanted in selection.items())
    ]


def _matches_factor(cells: Cells, cell: Cell, factor: str, wanted: Any) -> bool:
    values = [str(value) for value in _as_list(wanted)]
    if factor != "planner":
        return cell.factors[factor] in values
    presets = {other.factors["planner"] for other in cells.cells}
    named = [value for value in values if value not in presets]
    return cell.factors["planner"] in values or str(cell.episodes[0].row["planner"]) in named


def _compare_pairs(cells: Cells, columns: Mapping[str, Column], contrast: Contrast) -> Comparison | Estimate | None:
    """Compare the pairs of a contrast, or estimate what a bound is for; None where
    episodes or the metric are missing.
    """
    column = columns.get(contrast.metric)
    if column is None:
        return None
    ours = _side_values(cells, column, contrast, contrast.of)
    if contrast.than is None:
        values = list(ours.values())
        found = [value.mean for value in values]
        labels, worlds = [v.label for v in values], [v.world for v in values]
        return estimate(found, column.kind(found), labels, worlds).within(*column.bounds) if found else None
    theirs = _side_values(cells, column, contrast, {**_shared_selection(contrast.of, contrast.than), **contrast.than})
    both = [key for key in ours if key in theirs]
    if not both:
        return None
    a, b = [ours[key].mean + _margin_shift(contrast) for key in both], [theirs[key].mean for key in both]
    kind = "figure" if contrast.margin or contrast.change else column.kind([*a, *b])
    labels, worlds = [ours[key].label for key in both], [ours[key].world for key in both]
    one = compare(a, b, kind, labels, worlds)
    shift, (least, most) = _margin_shift(contrast), column.difference_bounds
    times = 1.0 if contrast.change is None else 2.0  # a change is a difference itself
    return replace(one, difference=one.difference.within(times * least + shift, times * most + shift))


def _shared_selection(of: Mapping[str, Any], than: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is selected on both sides: factors that ``than`` says nothing of."""
    return {factor: wanted for factor, wanted in of.items() if factor not in than}


def _margin_shift(contrast: Contrast) -> float:
    """Return what is added to our side, so that the difference is beyond 0 where it is beyond the margin."""
    return {
        "lower": contrast.margin,
        "higher": -contrast.margin,
        "not_higher": -contrast.margin,
        "not_lower": contrast.margin,
    }.get(contrast.expected, 0.0)


def _side_values(
    cells: Cells, column: Column, contrast: Contrast, selection: Mapping[str, Any]
) -> dict[Hashable, ProblemMean]:
    """Return the metric by problem and condition; of a change, the second value's less the first's."""
    free = {*contrast.of, *(contrast.than or {}), *(contrast.change or {})}
    if contrast.change is None:
        return _by_problem(cells, column, selection, free)
    ((factor, (first, second)),) = contrast.change.items()
    before, after = (_by_problem(cells, column, {**selection, factor: value}, free) for value in (first, second))
    return {key: replace(after[key], mean=after[key].mean - before[key].mean) for key in after if key in before}


def _by_problem(
    cells: Cells, column: Column, selection: Mapping[str, Any], free: set[str]
) -> dict[Hashable, ProblemMean]:
    """Return means by problem and by the factors that are not ``free`` to differ; path metrics over successes alone."""
    found: dict[Hashable, list[tuple[float, Episode]]] = {}
    fixed = [title for title in TITLES if title not in free]
    for cell in _selected_cells(cells, selection):
        success = success_column(cell, column.pack)
        for episode in cell.episodes:
            value = float(episode.row.get(column.name, math.nan))
            arrived = float(episode.row.get(success, math.nan)) == 1.0
            if math.isfinite(value) and episode.row["scenario"] and (arrived or not column.path_metric):
                walls = episode.row.get("scenario_hash", "") if free <= {"planner"} else ""
                key = (*(cell.factors[f] for f in fixed), episode.row["seed"], episode.row["scenario"], walls)
                found.setdefault(key, []).append((value, episode))
    return {
        key: ProblemMean(
            float(np.mean([value for value, _ in values])),
            problem_key(values[0][1].row),
            str(values[0][1].row["world"]),
        )
        for key, values in found.items()
    }


def _make_finding(contrast: Contrast, found: Comparison | Estimate | None) -> Finding:
    what = _describe_contrast(contrast)
    if found is None:
        return Finding(contrast, what, None, math.nan, "not tested", math.nan)
    if isinstance(found, Estimate):
        return Finding(
            contrast, what, found, math.nan, _bound_state(contrast, found), _problems_needed(found, contrast.margin)
        )
    shift = _margin_shift(contrast)
    shown = replace(
        found.difference,
        mean=found.difference.mean - shift,
        low=found.difference.low - shift,
        high=found.difference.high - shift,
    )
    return Finding(
        contrast,
        what,
        shown,
        found.holm,
        _contrast_state(contrast, found, shown),
        _problems_needed(found.difference, 0.0),
        found.smallest,
    )


def _bound_state(contrast: Contrast, found: Estimate) -> State:
    if not found.has_interval:
        return "cannot be decided"
    if contrast.expected == "at_most":
        return _choose_state(holds=found.high <= contrast.margin, fails=found.low > contrast.margin)
    return _choose_state(holds=found.low >= contrast.margin, fails=found.high < contrast.margin)


def _contrast_state(contrast: Contrast, found: Comparison, shown: Estimate) -> State:
    """Return whether the contrast holds: by the test after Holm; what is alike, by the interval (Schuirmann 1987)."""
    if not shown.has_interval:
        return "cannot be decided"
    if contrast.expected == "alike":
        m = contrast.margin
        return _choose_state(holds=-m < shown.low and shown.high < m, fails=shown.low > m or shown.high < -m)
    sure = found.holm <= ALPHA
    below = sure and found.difference.mean < 0.0
    above = sure and found.difference.mean > 0.0
    return (
        _choose_state(holds=below, fails=above)
        if contrast.expected in ("lower", "not_higher")
        else _choose_state(holds=above, fails=below)
    )


def _choose_state(*, holds: bool, fails: bool) -> State:
    return "holds" if holds else "does not hold" if fails else "cannot be decided"


def _problems_needed(found: Estimate, bound: float) -> float:
    """Return how many more problems would show that the mean is off ``bound``, if it
    is as far off as it seems; rough.
    """
    if not found.has_interval:
        return math.nan
    off, error = abs(found.mean - bound), (found.high - found.low) / (2.0 * 1.96)
    return math.inf if off < 1e-9 else max(0.0, (POWERED * error / off) ** 2 - 1.0) * found.problems


def _describe_contrast(contrast: Contrast) -> str:
    """Return in words what is compared."""
    ours, theirs = _describe_selection(contrast.of), _describe_selection(contrast.than or {})
    grows = "".join(f", grown from {a} to {b} {factor}" for factor, (a, b) in (contrast.change or {}).items())
    verb: Callable[[], str] = {
        "lower": lambda: f"lower than {theirs}" + (f" by {contrast.margin:g}" if contrast.margin else ""),
        "higher": lambda: f"higher than {theirs}" + (f" by {contrast.margin:g}" if contrast.margin else ""),
        "alike": lambda: f"within {contrast.margin:g} of {theirs}",
        "not_higher": lambda: f"not higher than {theirs}" + (f" by {contrast.margin:g}" if contrast.margin else ""),
        "not_lower": lambda: f"not lower than {theirs}" + (f" by {contrast.margin:g}" if contrast.margin else ""),
        "at_most": lambda: f"at most {contrast.margin:g}",
        "at_least": lambda: f"at least {contrast.margin:g}",
    }[contrast.expected]
    return f"{contrast.metric.replace('_', ' ')}{grows} of {ours}: {verb()}"


def _describe_selection(selection: Mapping[str, Any]) -> str:
    parts = []
    for factor, wanted in selection.items():
        values = " and ".join(str(value) for value in _as_list(wanted))
        parts.append(f"{values} people" if factor == "people" else values)
    return ", ".join(parts) or "all"
