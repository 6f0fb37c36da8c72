"""The card of a scenario file: what it tests, what good behaviour is, and which metrics decide."""

from __future__ import annotations

from dataclasses import dataclass

from arena_tasks.scenario_files.json_fields import Field


@dataclass(frozen=True, slots=True)
class Card:
    """A scenario card as Francis et al. (2023) propose them; ``letter`` is that of their figure 7, empty for others."""

    tests: str
    good: str
    metrics: tuple[str, ...]
    letter: str = ""


def read_card(field: Field) -> Card:
    """Read ``{"letter", "tests", "good", "metrics"}``; raise InputFileError with file and key."""
    field.check_keys("letter", "tests", "good", "metrics")
    return Card(
        field["tests"].text(),
        field["good"].text(),
        tuple(metric.text() for metric in field["metrics"].items()),
        field["letter"].text() if field.has("letter") else "",
    )


def card_lines(card: Card) -> list[str]:
    """Return what a card says, a line each."""
    return [f"tests: {card.tests}", f"good behaviour: {card.good}", f"decided by: {', '.join(card.metrics)}"]
