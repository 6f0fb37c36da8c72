"""Which weights of a training are exported: those whose validations, averaged over a few in a row, are best."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from arena_gym.training.settings import Validation


@dataclass(frozen=True, slots=True)
class Choice:
    """Weights that were chosen after ``steps``: the mean success of so many ``validations`` in a
    row, theirs the last of them.
    """

    steps: int
    validations: int
    success: float

    def as_row(self) -> dict[str, Any]:
        """Return plain numbers."""
        return asdict(self)

    @classmethod
    def of(cls, row: Mapping[str, Any]) -> Choice:
        """Return the choice that a checkpoint holds."""
        return cls(int(row["steps"]), int(row["validations"]), float(row["success"]))


def latest_choice(curve: Sequence[Mapping[str, float]], settings: Validation) -> Choice:
    """Return what speaks for the weights of the last validation of a curve."""
    window = [float(row["success"]) for row in curve[-settings.average :]]
    return Choice(int(curve[-1]["steps"]), len(window), sum(window) / len(window))


def is_better(new: Choice, best: Choice | None) -> bool:
    """Return whether new weights are taken: for a mean over more validations, as few are best by luck, then
    for one as great or greater.
    """
    return best is None or (new.validations, new.success) >= (best.validations, best.success)


def rule_text(settings: Validation) -> str:
    """Return the rule in words, for the policy's card."""
    return (
        f"the weights after the last of {settings.average} validations in a row (every {settings.every} steps, "
        f"{settings.episodes} "
        f"episodes each of seed {settings.seed}) whose mean success without a collision is greatest; "
        "of equal ones the last"
    )
