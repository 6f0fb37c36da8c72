"""Sentences that say which planner succeeds more often than the baseline, or that the episodes do not tell."""

from __future__ import annotations

import math

from arena_metrics.cells import Cells
from arena_metrics.comparisons import WORTH, Comparison, after_holm
from arena_metrics.intervals import LEAST_PROBLEMS
from arena_metrics.pairs import Pair, against, comparison, conditions, p_text, pairs
from arena_metrics.runs import Column


def verdicts(cells: Cells, success: Column, baseline: str | None, most: int) -> list[str]:
    """Return a sentence for each planner against the baseline, over all conditions; p after Holm among all of them."""
    found: dict[tuple[str, str], list[Pair]] = {}
    for group in conditions(cells):
        for cell, base in against(group, baseline):
            found.setdefault((cells.planner(cell), cells.planner(base)), []).extend(pairs(cell, base, success))
    met = {names: both for names, both in found.items() if both}
    compared = after_holm([comparison(both, success) for both in met.values()])
    after = " after Holm" if len(compared) > 1 else ""
    sentences = [verdict(*names, one, after) for names, one in zip(met, compared, strict=True)]
    return sentences[:most] + ([f"{len(sentences) - most} more comparisons are below."] if len(sentences) > most else [])


def verdict(ours: str, theirs: str, one: Comparison, after: str = "") -> str:
    """Return what a comparison of successes says, the better one first."""
    found = one.difference
    if not found.has_interval:
        met = f"{found.problems} problem{'s' * (found.problems != 1)}"
        return f"{ours} and {theirs} met on {met} only: with fewer than {LEAST_PROBLEMS} nothing can be said about others."
    first, second = (ours, theirs) if found.mean >= 0.0 else (theirs, ours)
    ends = (found.low, found.high) if found.mean >= 0.0 else (-found.high, -found.low)
    how = f"{100.0 * abs(found.mean):.0f} points ({_range(*ends)}), {_equal(one.holm)}{after}"
    if one.told_apart:
        return f"{first} succeeds more often than {second} by {how}."
    return f"{first} and {second} cannot be told apart by their successes, {how}; {_needed(one)}."


def _range(low: float, high: float) -> str:
    """Return both ends in points, with a dash between them unless one is negative."""
    texts = [f"{100.0 * end:.0f}".replace("-", "−").replace("−0", "0") if abs(end) < 0.005 else f"{100.0 * end:.0f}" for end in (low, high)]
    return (" to " if low < 0.0 else "–").join(text.replace("-", "−") for text in texts)


def _equal(p: float) -> str:
    text = p_text(p)
    return f"p {text}" if text.startswith("<") else f"p = {text}"


def _needed(one: Comparison) -> str:
    points = f"a difference of {100.0 * WORTH:.0f} points"
    if one.more < 1.0:
        return f"{points} would probably have shown"
    digits = max(0, math.floor(math.log10(one.more)) - 1)  # two of them: it is an estimate
    more = math.ceil(one.more / 10**digits) * 10**digits
    return f"about {more:,} more {one.unit} would show {points}"
