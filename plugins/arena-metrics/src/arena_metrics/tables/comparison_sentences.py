"""Sentences that say which planner succeeds more often than the baseline, or is sooner at the goal, or that
the episodes do not tell.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from arena_core.statistics import LEAST_PROBLEMS, WORTH, Comparison, after_holm
from arena_metrics.pooling.cells import Cells
from arena_metrics.pooling.runs import Column
from arena_metrics.tables.pairs import Pair, baseline_pairs, compare_pairs, condition_groups, metric_pairs, p_text

Names = tuple[str, str]  # a planner and the baseline


def comparison_sentences(
    cells: Cells, success: Column, time: Column | None, baseline: str | None, most: int
) -> list[str]:
    """Return a sentence for each planner against the baseline, over all conditions; p after Holm among all of them.

    Where successes do not tell them apart and the ``time`` to the goal does, a second sentence says so.
    """
    successes = _against_baseline(cells, success, baseline)
    times = _against_baseline(cells, time, baseline) if time else {}
    sentences = [success_sentence(*names, one, _holm_suffix(successes)) for names, one in successes.items()]
    sooner = [
        goal_time_sentence(*n, one, _holm_suffix(times))
        for n, one in times.items()
        if one.told_apart and not successes[n].told_apart
    ]
    return [*_first_sentences(sentences, most), *_first_sentences(sooner, most)]


def _first_sentences(sentences: Sequence[str], most: int) -> list[str]:
    return [
        *sentences[:most],
        *([f"{len(sentences) - most} more comparisons are below."] if len(sentences) > most else []),
    ]


def _holm_suffix(family: Mapping[Names, Comparison]) -> str:
    return " after Holm" if len(family) > 1 else ""


def _against_baseline(cells: Cells, column: Column, baseline: str | None) -> dict[Names, Comparison]:
    found: dict[Names, list[Pair]] = {}
    for group in condition_groups(cells):
        for cell, base in baseline_pairs(group, baseline):
            found.setdefault((cells.planner(cell), cells.planner(base)), []).extend(metric_pairs(cell, base, column))
    met = {names: both for names, both in found.items() if both}
    return dict(zip(met, after_holm([compare_pairs(both, column) for both in met.values()]), strict=True))


def success_sentence(ours: str, theirs: str, one: Comparison, after: str = "") -> str:
    """Return what a comparison of successes says, the better one first."""
    found = one.difference
    if not found.has_interval:
        met = f"{found.problems} problem{'s' * (found.problems != 1)}"
        return (
            f"{ours} and {theirs} met on {met} only: with fewer than {LEAST_PROBLEMS} nothing can be said about others."
        )
    first, second = (ours, theirs) if found.mean >= 0.0 else (theirs, ours)
    ends = (found.low, found.high) if found.mean >= 0.0 else (-found.high, -found.low)
    how = f"{100.0 * abs(found.mean):.0f} points ({_range_text(*ends)}), {_p_value_text(one.holm)}{after}"
    if one.told_apart:
        return f"{first} succeeds more often than {second} by {how}."
    return f"{first} and {second} cannot be told apart by their successes, {how}; {_needed_text(one)}."


def goal_time_sentence(ours: str, theirs: str, one: Comparison, after: str = "") -> str:
    """Return what a comparison of times to the goal says that tells two planners apart, the faster one first."""
    found = one.difference
    first, second = (ours, theirs) if found.mean < 0.0 else (theirs, ours)
    low, high = sorted((abs(found.low), abs(found.high)))
    return (
        f"Where both succeed, {first} is at the goal {abs(found.mean):.1f} s sooner than {second} "
        f"({low:.1f}–{high:.1f}), "
        f"{_p_value_text(one.holm)}{after}."
    )


def _range_text(low: float, high: float) -> str:
    """Return both ends in points, with a dash between them unless one is negative."""
    texts = [
        f"{100.0 * end:.0f}".replace("-", "−").replace("−0", "0") if abs(end) < 0.005 else f"{100.0 * end:.0f}"
        for end in (low, high)
    ]
    return (" to " if low < 0.0 else "–").join(text.replace("-", "−") for text in texts)


def _p_value_text(p: float) -> str:
    text = p_text(p)
    return f"p {text}" if text.startswith("<") else f"p = {text}"


def _needed_text(one: Comparison) -> str:
    points = f"a difference of {100.0 * WORTH:.0f} points"
    if one.more < 1.0:
        return f"{points} would probably have shown"
    digits = max(0, math.floor(math.log10(one.more)) - 1)  # two of them: it is an estimate
    more = math.ceil(one.more / 10**digits) * 10**digits
    least = f"{one.difference.problems} {one.unit} show differences of {100.0 * one.smallest:.0f} points or more"
    return f"{least}, about {more:,} more {one.unit} would show {points}"
