"""A ladder, running or finished: its document where it is written, and what its blocks came to until then."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from arena_core import InputFileError
from arena_core.commands import one_line
from arena_core.files import is_file
from arena_ladder.driving import LadderFolder
from arena_metrics.pooling.ladders import DOCUMENT, REQUEST, LadderDocument, read_ladder_document

ALLOWED = "what `arena ladder` wrote"


def read_ladder(folder: Path) -> dict[str, Any]:
    """Return the ``document`` of a ladder, or of a page over several, and the ``blocks`` of each cell where it drove.

    Raises InputFileError (one line) for what is no ladder.
    """
    told = read_ladder_document(folder / DOCUMENT) if is_file(folder / DOCUMENT) else LadderDocument([], [])
    words, cap, blocks = [], 0, {}
    if is_file(folder / REQUEST):
        ladder = LadderFolder.read(folder)
        words, cap = list(ladder.words), ladder.plan.cap
        try:
            blocks = {name: [asdict(block) for block in found] for name, found in ladder.blocks().items()}
        except (IndexError, KeyError, TypeError, ValueError) as error:
            raise InputFileError(
                f"{folder}: a block of it cannot be read ({one_line(str(error), 80)}); allowed: {ALLOWED}"
            ) from None
    return {"document": asdict(told), "words": words, "cap": cap, "blocks": blocks, "cells": told.cells or list(blocks)}
