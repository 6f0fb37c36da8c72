"""What a tuning leaves: a card and a page in its folder, and where it is better a preset in the conf folder."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from arena_core.files import write_text_whole
from arena_tuning.costing import DROVE, TWINS
from arena_tuning.page import write_page
from arena_tuning.preset import write_card, write_preset
from arena_tuning.study import Plan, Search

TIMES = "times.json"


def write_results(folder: Path, preset: Path, card: Mapping[str, Any], plan: Plan, search: Search) -> Iterator[str]:
    """Write everything, and yield a line for what was found and for each file."""
    yield card["verdict"]
    write_card(folder / "card.json", card)
    yield f"written: {write_page(folder / 'report', card, plan, search)}"
    if card["better"]:
        write_preset(preset, card, plan.space)
        yield f"written: {preset}, which {preset.parent.name}={preset.stem} chooses"


def write_times(folder: Path, seconds: Mapping[str, float], whole: float) -> str:
    """Write how long episodes, their twins, and the whole of a tuning took, s; return what is to be said of it.

    It stands in a file of its own, for a card is the same wherever and however often a tuning was carried out.
    """
    found = {"episodes": seconds[DROVE], "twins": seconds[TWINS], "whole": whole}
    write_text_whole(folder / TIMES, json.dumps({name: round(one, 3) for name, one in found.items()}) + "\n")
    return (
        f"episodes took {found['episodes']:.1f} s of workers, their twins {found['twins']:.1f} s; in all {whole:.1f} s"
    )
