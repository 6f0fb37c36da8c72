"""The networks of a world model, each an ONNX file with a card beside it: vision
codes scans, memory remembers codes.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, InputFileError, ObservationField
from arena_core.commands import one_line
from arena_core.files import local_path, read_json, write_bytes_whole, write_text_whole
from arena_policies.card import content_sha256
from arena_policies.network import Network, network_content, open_network

FORMAT, VERSION = "arena-world-model", 1
CODE_MAX = 6.0  # numbers of a code lie within -CODE_MAX .. CODE_MAX
Numbers = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class PartCard:
    """What a network of a world model was trained on.

    ``part`` is vision or memory; ``scan`` the encoder by name, with its parameters, whose first field is the scan,
    ``layout`` its fields; ``reads`` and ``writes`` count numbers. ``vision`` is the hash of the vision whose codes a
    memory remembers, of itself for a vision; ``code`` and ``hidden`` count the numbers of a code and of a memory.
    """

    part: str
    robot: str
    scan: Mapping[str, Any]
    layout: Sequence[ObservationField]
    reads: int
    writes: int
    code: int
    hidden: int
    vision: str
    sha256: str
    training: Mapping[str, Any] = field(default_factory=dict)


class Part:
    """A network that runs, with its card."""

    def __init__(self, path: Path, card: PartCard, network: Network) -> None:
        self.path, self.card = path, card
        self._network = network

    def run(self, numbers: Numbers) -> Numbers:
        """Return what the network makes of rows (N, D); row k depends on row k alone, bit for bit."""
        alone = len(numbers) == 1  # a single row would be multiplied in another order than one of many
        rows = np.repeat(numbers, 2, axis=0) if alone else numbers
        answer = self._network.run(rows)
        return answer[:1] if alone else answer


def load_part(address: str, part: str) -> Part:
    """Load vision or memory; raise ConfigurationError or InputFileError where it is none."""
    path = local_path(address)
    if not path.exists():
        raise ConfigurationError(
            f"observation_encoder.{part} is {path}, which is not there; `arena navrep all robot=... "
            "resume=true` makes it"
        )
    content, card = network_content(path), read_part_card(path.with_suffix(".json"))
    if card.part != part:
        raise InputFileError(f"{path.with_suffix('.json')}: part is {card.part}; allowed: {part}")
    if content_sha256(content) != card.sha256:
        raise InputFileError(
            f"{path}: sha256 is {content_sha256(content)[:12]}…, its card says {card.sha256[:12]}…; allowed: "
            "the file the card was made for"
        )
    if card.writes != card.hidden + card.code or (
        part == "vision" and [card.reads] != [field.size for field in card.layout[:1]]
    ):
        raise InputFileError(
            f"{path.with_suffix('.json')}: reads {card.reads} and writes {card.writes} numbers; allowed: "
            "those of layout, code and hidden"
        )
    return Part(path, card, open_network(path, content, card.reads, card.writes))


def check_fit(memory: Part, vision: Part) -> None:
    """Raise InputFileError where a memory remembers other codes than a vision's."""
    if (memory.card.vision, memory.card.code) != (vision.card.sha256, vision.card.code):
        raise InputFileError(
            f"{memory.path}: remembers codes of {memory.card.code} by vision {memory.card.vision[:12]}…; allowed: "
            f"memory of {vision.path}: "
            f"{vision.card.code} of {vision.card.sha256[:12]}…"
        )


def write_part(path: Path, content: bytes, card: PartCard) -> None:
    """Write a card and its network, each whole or not at all; where there is a network, its card is there."""
    text = json.dumps({"format": FORMAT, "version": VERSION, **asdict(card)}, indent=1, allow_nan=False)
    write_text_whole(path.with_suffix(".json"), text + "\n")
    write_bytes_whole(path, content)


def read_part_card(path: Path) -> PartCard:
    """Read the card of a world model's network; raise InputFileError with file and key for anything that is not one."""
    made_by = "allowed: a card that `arena navrep` wrote"
    content = read_json(path, "a card of a world model that `arena navrep` wrote")
    if not isinstance(content, dict) or (content.get("format"), content.get("version")) != (FORMAT, VERSION):
        raise InputFileError(f"{path}: format and version are not {FORMAT} {VERSION}; {made_by}")
    try:
        return PartCard(
            part=str(content["part"]),
            robot=str(content["robot"]),
            scan=dict(content["scan"]),
            layout=tuple(ObservationField(**fields) for fields in content["layout"]),
            reads=int(content["reads"]),
            writes=int(content["writes"]),
            code=int(content["code"]),
            hidden=int(content["hidden"]),
            vision=str(content["vision"]),
            sha256=str(content["sha256"]),
            training=dict(content["training"]),
        )
    except KeyError as error:
        raise InputFileError(f"{path}: {error.args[0]} is missing; {made_by}") from None
    except (AttributeError, TypeError, ValueError, OverflowError) as error:
        raise InputFileError(f"{path}: is no card of a world model ({one_line(str(error))}); {made_by}") from None
