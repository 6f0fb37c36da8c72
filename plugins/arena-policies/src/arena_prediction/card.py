"""The card beside a predictor's network: what its numbers mean, and how it came to be."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

from arena_core import InputFileError
from arena_core.commands import one_line
from arena_core.files import read_json, write_text_whole
from arena_policies.card import content_sha256
from arena_policies.network import Network, network_content, open_network
from arena_prediction.features import LAYOUT, SIZE
from arena_prediction.hypotheses import answer_size

FORMAT, VERSION = "arena-predictor", 1
ALLOWED = "a card that `arena predict train` wrote"
MOST_HYPOTHESES, MOST_TIMES, LONGEST = 32, 64, 60.0  # [-], [-] and s


@dataclass(frozen=True, slots=True)
class PredictorCard:
    """What has to match before a network predicts, and what its users want to know.

    ``layout`` names the numbers that it reads; it answers with ``hypotheses`` ways at ``times``, s ahead, whose
    deviations are multiplied by ``widths``, one a time, so that they are as wide as the errors of drives that it was
    not fitted to. ``sha256`` is of the ONNX file. ``training`` holds seed, configuration, curve, score and
    versions, and is read by people alone.
    """

    layout: str
    hypotheses: int
    times: tuple[float, ...]
    widths: tuple[float, ...]
    sha256: str
    license: str
    training: Mapping[str, Any] = field(default_factory=dict)


def write_card(path: Path, card: PredictorCard) -> None:
    """Write a card, whole or not at all."""
    content = {"format": FORMAT, "version": VERSION, **asdict(card)}
    write_text_whole(path, json.dumps(content, indent=1, allow_nan=False) + "\n")


def read_card(path: Path) -> PredictorCard:
    """Read a card; raise InputFileError with file and key for anything that is not one."""
    content = read_json(path, "a network with its card beside it (docs/predictors.md)")
    if not isinstance(content, dict) or (content.get("format"), content.get("version")) != (FORMAT, VERSION):
        told = content.get("format") if isinstance(content, dict) else None
        raise InputFileError(f"{path}: format is {told!r}; allowed: {FORMAT!r} version {VERSION}, {ALLOWED}")
    try:
        card = PredictorCard(
            layout=str(content["layout"]),
            hypotheses=_whole(content["hypotheses"]),
            times=tuple(map(float, content["times"])),
            widths=tuple(map(float, content["widths"])),
            sha256=str(content["sha256"]),
            license=str(content["license"]),
            training=dict(content["training"]),
        )
    except KeyError as error:
        raise InputFileError(f"{path}: {error.args[0]} is missing; allowed: {ALLOWED}") from None
    except (AttributeError, TypeError, ValueError, OverflowError) as error:
        raise InputFileError(f"{path}: is no predictor's card ({one_line(str(error))}); allowed: {ALLOWED}") from None
    if fault := _fault_of_card(card):
        raise InputFileError(f"{path}: {fault}")
    return card


def _whole(value: Any) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise ValueError(f"hypotheses is {value!r}, no whole number")
    return value


def _fault_of_card(card: PredictorCard) -> str:
    """Return what is wrong with a card, and what is allowed; empty where nothing is."""
    if card.layout != LAYOUT:
        return f"layout is {card.layout!r}; allowed: {LAYOUT!r}, the numbers that this version makes of tracks"
    if not 1 <= card.hypotheses <= MOST_HYPOTHESES:
        return f"hypotheses is {card.hypotheses}; allowed: 1 to {MOST_HYPOTHESES}"
    times = (0.0, *card.times)
    rising = all(earlier < later for earlier, later in pairwise(times))
    if not (1 <= len(card.times) <= MOST_TIMES and rising and card.times[-1] <= LONGEST):
        return f"times is {list(card.times)}; allowed: 1 to {MOST_TIMES} that rise from above 0 to {LONGEST:g} s"
    if len(card.widths) != len(card.times) or not all(0.0 < width < math.inf for width in card.widths):
        return f"widths is {list(card.widths)}; allowed: {len(card.times)} numbers above 0, one for each of times"
    return ""


def load_network(path: Path) -> tuple[PredictorCard, Network]:
    """Open a network with the card beside it; raise InputFileError where either is missing or they do not fit."""
    content = network_content(path)
    card = read_card(path.with_suffix(".json"))
    made = content_sha256(content)
    if made != card.sha256:
        raise InputFileError(
            f"{path}: sha256 is {made[:12]}…, its card says {card.sha256[:12]}…; allowed: "
            "the file the card was made for"
        )
    return card, open_network(path, content, SIZE, answer_size(card.hypotheses, len(card.times)))
