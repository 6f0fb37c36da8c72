"""How long a recording's unit is and how fast its frames follow: its header, numbers or name tell, or the
user; it is never guessed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fnmatch import fnmatch
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
import yaml
from numpy.typing import NDArray

from arena_core import InputFileError
from arena_core.commands import one_line
from arena_core.files import LIMITS

Floats = NDArray[np.float64]
Unit = Literal["m", "cm", "mm"]

METRES: Mapping[str, float] = {"m": 1.0, "cm": 0.01, "mm": 0.001}
SAID_UNIT = re.compile(
    r"\bx\s*[/\[(]\s*(?:in\s+)?(mm|cm|m)\b|\bin\s+(mm|cm|m)\b|\bunits?\s*[:=]\s*(mm|cm|m)\b", re.IGNORECASE
)
SAID_RATE = re.compile(
    r"\b(?:frame\s*rate|fps)\s*[:=]?\s*([\d.]+)|([\d.]+)\s*(?:fps\b|frames\s+(?:a|per)\s+second)", re.IGNORECASE
)
SAME_RATE = 0.02  # relative difference of frame rates that are one, for velocities and headers are rounded
CLEAR = 0.5  # m/s, from which a velocity tells the frame rate
AGREE = 0.5  # least share of velocities that must agree on it


class Scale(NamedTuple):
    """``metres`` of a unit of length, and frames a second."""

    metres: float
    frame_rate: float


def scale_of(
    path: Path,
    layout: str,
    comments: Sequence[str],
    measured_rate: float | None,
    unit: Unit | None,
    frame_rate: float | None,
) -> Scale:
    """Return a recording's scale; ``measured_rate`` is what its own velocities say, ``unit`` and ``frame_rate`` what
    the user says.

    What the user says must not contradict what the file says. Raises InputFileError for that, and where no one says.
    """
    known = known_recording(path, layout)
    said_unit, said_rate = _stated_unit(path, comments), _stated_rate(path, comments)
    fixed = "m" if layout == "obsmat" else None  # ETH, README: positions and velocities are in metres
    own_unit, own_rate = said_unit or fixed, said_rate or measured_rate
    if unit and own_unit and unit != own_unit:
        raise InputFileError(
            f"{path}: unit is {unit}, but {'its header says' if said_unit else f'format {layout} is in'} {own_unit}"
        )
    if frame_rate and own_rate and abs(frame_rate / own_rate - 1.0) > SAME_RATE:
        source = "its header says" if said_rate else "its velocities say"
        raise InputFileError(
            f"{path}: frame_rate is {frame_rate:g}, but {source} {own_rate:g} (1/s); `speed` plays it faster or slower"
        )
    found_unit = unit or own_unit or known.get("unit")
    found_rate = frame_rate or own_rate or known.get("frame_rate")
    if found_unit is None:
        raise InputFileError(f"{path}: neither header nor name tells its unit of length; allowed: {_unit_choices()}")
    if found_rate is None:
        raise InputFileError(f"{path}: neither header nor name tells its frame rate; allowed: frame_rate=NUMBER (1/s)")
    return Scale(METRES[found_unit], float(found_rate))


@cache
def _known_recordings() -> list[dict[str, Any]]:
    return list(yaml.safe_load(files("arena_crowds").joinpath("known_recordings.yaml").read_text("utf-8")))


def known_recording(path: Path, layout: str) -> Mapping[str, Any]:
    """Return what is known of a published recording by the name of its file or folder; empty for others."""
    names = (path.name, path.absolute().parent.name)
    return next(
        (
            row
            for row in _known_recordings()
            if row["format"] == layout and any(fnmatch(name, row["name"]) for name in names)
        ),
        {},
    )


def _stated_unit(path: Path, comments: Sequence[str]) -> Unit | None:
    said = {next(filter(None, found.groups())).lower() for line in comments for found in SAID_UNIT.finditer(line)}
    if len(said) > 1:
        raise InputFileError(
            f"{path}: its header tells several units of length, {', '.join(sorted(said))}; allowed: one"
        )
    return next((unit for unit in get_args(Unit) if unit in said), None)


def _stated_rate(path: Path, comments: Sequence[str]) -> float | None:
    texts = [next(filter(None, found.groups())) for line in comments for found in SAID_RATE.finditer(line)]
    if not texts:
        return None
    try:
        rates = {float(text) for text in texts}
    except ValueError:
        rates = set()
    if len(rates) != 1 or not LIMITS.number_smallest <= min(rates) <= LIMITS.number_largest:
        raise InputFileError(
            f"{path}: its header tells the frame rates {one_line(', '.join(texts), 80)}; allowed: one, > 0 (1/s)"
        )
    return rates.pop()


def measured_rate(persons: Floats, frames: Floats, positions: Floats, velocities: Floats) -> float | None:
    """Return the frame rate at which people's positions (S, 2) m change by their recorded velocities (S, 2) m/s, 1/s.

    Samples are sorted by person and frame. None where velocities are too few, too slow or of no one mind. Recorded
    velocities are those from the sample before to the one after; a whole number is taken for one that is nearly so.
    """
    middle = np.flatnonzero((persons[2:] == persons[:-2]) & (np.hypot(*velocities[1:-1].T) > CLEAR)) + 1
    ways = np.hypot(*(positions[middle + 1] - positions[middle - 1]).T)
    middle, ways = middle[ways > 0.0], ways[ways > 0.0]
    if len(middle) == 0:
        return None
    rates = np.hypot(*velocities[middle].T) * (frames[middle + 1] - frames[middle - 1]) / ways
    rate = float(np.median(rates))
    if np.mean(np.abs(rates / rate - 1.0) < SAME_RATE) < AGREE:
        return None
    return float(round(rate)) if abs(round(rate) / rate - 1.0) < SAME_RATE else rate


def _unit_choices() -> str:
    return " or ".join(f"unit={unit}" for unit in METRES)
