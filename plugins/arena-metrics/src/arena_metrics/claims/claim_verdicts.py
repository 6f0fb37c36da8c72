"""Verdicts: whether runs reproduce what a source claims."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from arena_metrics.claims.contrasts import Finding, contrast_findings
from arena_metrics.claims.model import Claim, Claims
from arena_metrics.pooling.cells import Cells
from arena_metrics.pooling.runs import Column
from arena_metrics.tables.pairs import p_text
from arena_metrics.tables.tables import Table

Verdict = Literal["reproduced", "not reproduced", "cannot be decided", "not tested"]
SHOWN = 4  # findings of a claim that its row tells of
COUNTED = {"holds": "held", "does not hold": "refuted", "cannot be decided": "open", "not tested": "not tested"}


@dataclass(frozen=True, slots=True)
class JudgedClaim:
    """A claim, what runs say of its contrasts and of its ablation, and the verdict."""

    number: str
    claim: Claim
    verdict: Verdict
    findings: Sequence[Finding]
    ablation: Sequence[Finding]

    @property
    def more(self) -> float:
        """Return how many more problems would probably decide it; infinite where none
        would, NaN where that is not known.
        """
        open_ones = [one.more for one in self.findings if one.state == "cannot be decided"]
        return max(open_ones, default=math.nan)


def judge_claims(cells: Cells, columns: Sequence[Column], claims: Claims) -> list[JudgedClaim]:
    """Return a verdict on each claim; the contrasts of a claim are one family after Holm."""
    by_name = {column.name: column for column in columns}
    return [_judge_claim(cells, by_name, number, claim) for number, claim in claims.claims.items()]


def _judge_claim(cells: Cells, columns: Mapping[str, Column], number: str, claim: Claim) -> JudgedClaim:
    found = contrast_findings(cells, columns, claim.contrasts)
    return JudgedClaim(number, claim, _claim_verdict(found), found, contrast_findings(cells, columns, claim.ablation))


def _claim_verdict(found: Sequence[Finding]) -> Verdict:
    """A claim fails with one of its contrasts, and holds only if all do; what no one drove is not tested."""
    states = [one.state for one in found]
    if "does not hold" in states:
        return "not reproduced"
    if not states or "not tested" in states:
        return "not tested"
    return "cannot be decided" if "cannot be decided" in states else "reproduced"


def claims_table(judged: Sequence[JudgedClaim], source: str) -> Table:
    """Return a row for each claim: verdict, the findings that decided it, what the source found,
    and the suspected artefact.
    """
    head = ["claim", "verdict", "what the episodes say", "the source's own figures", "suspected artefact"]
    rows = [
        [
            f"{one.number}. {one.claim.says}",
            _verdict_text(one),
            _evidence_text(one),
            one.claim.found,
            _ablation_text(one),
        ]
        for one in judged
    ]
    return Table(f"Claims of {source}", head, rows)


def _verdict_text(one: JudgedClaim) -> str:
    if one.verdict != "cannot be decided" or math.isnan(one.more):
        return one.verdict
    if math.isinf(one.more):
        return f"{one.verdict} (no difference is seen)"
    return f"{one.verdict} (about {_round_digits(one.more):,} more problems a cell would)"


def _round_digits(number: float) -> int:
    """Return a number with two digits that count, at least 1: it is an estimate."""
    step: int = 10 ** max(0, math.floor(math.log10(max(number, 1.0))) - 1)
    return max(math.ceil(number / step), 1) * step


def _evidence_text(one: JudgedClaim) -> str:
    """Return the findings that decide, those that speak against it first."""
    order = ("does not hold", "cannot be decided", "not tested", "holds")
    first = sorted(one.findings, key=lambda finding: order.index(finding.state))
    decisive = [f for f in first if f.state == "does not hold"] if one.verdict == "not reproduced" else first
    hidden = len(one.findings) > min(len(decisive), SHOWN)
    more = [f"of {len(one.findings)} contrasts {_count_states(one.findings)}"] if hidden else []
    return "; ".join([*(finding_text(finding) for finding in decisive[:SHOWN]), *more])


def _count_states(found: Sequence[Finding]) -> str:
    states = [one.state for one in found]
    return ", ".join(f"{states.count(state)} {COUNTED[state]}" for state in COUNTED if state in states)


def finding_text(finding: Finding) -> str:
    """Return one finding in words with its mean, interval and p."""
    found = finding.estimate
    if found is None:
        return f"{finding.what}: not tested"
    sign = "+" if finding.contrast.than is not None else ""
    mean = f"{found.mean:{sign}.3g}"
    interval = f" [{found.low:{sign}.3g}, {found.high:{sign}.3g}]" if found.has_interval else ""
    p = (
        f", p {'' if p_text(finding.p).startswith('<') else '= '}{p_text(finding.p)}"
        if math.isfinite(finding.p)
        else ""
    )
    seen = finding.state == "cannot be decided" and math.isfinite(finding.smallest)
    least = f" (so many problems show {finding.smallest:.2g} or more)" if seen else ""
    return f"{finding.what}: {mean}{interval}{p}, {finding.state}{least}"


def _ablation_text(one: JudgedClaim) -> str:
    tested = [finding_text(finding) for finding in one.ablation if finding.estimate is not None]
    return " — ".join(filter(None, [one.claim.artefact, "; ".join(tested)]))
