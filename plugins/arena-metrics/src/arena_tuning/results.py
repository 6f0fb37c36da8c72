"""What a tuning leaves: a card and a page in its folder, and where it is better a preset in the conf folder."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from arena_tuning.page import write_page
from arena_tuning.preset import write_card, write_preset
from arena_tuning.study import Plan, Search


def write_results(folder: Path, preset: Path, card: Mapping[str, Any], plan: Plan, search: Search) -> Iterator[str]:
    """Write everything, and yield a line for what was found and for each file."""
    yield card["verdict"]
    write_card(folder / "card.json", card)
    yield f"written: {write_page(folder / 'report', card, plan, search)}"
    if card["better"]:
        write_preset(preset, card, plan.space)
        yield f"written: {preset}, which planner={preset.stem} chooses"
