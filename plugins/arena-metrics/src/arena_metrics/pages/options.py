"""What whoever asks for a report can choose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Figures = Literal["headline", "all", "none"]
PICTURES = 12  # cells whose trajectories are drawn unless --pictures says otherwise
REPLAYS = 6  # episodes that have a replay unless --replays says otherwise


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportOptions:
    """The baseline of pairs, a file of claims to judge, the most pictures of cells and replays, and the figures.

    ``figures`` says which metrics are drawn; with none, no record is read, no picture drawn and no replay written.
    ``pdf`` writes figures as PDF too. ``columns`` are the metrics of the headline, the usual ones where none is named.
    """

    baseline: str | None = None
    claims: str | None = None
    figures: Figures = "headline"
    pictures: int = PICTURES
    replays: int = REPLAYS
    pdf: bool = False
    columns: tuple[str, ...] = ()
