"""JSON, or YAML, whose every value knows its file and key, so that each slip is one line."""

from __future__ import annotations

import json
import math
import re
import reprlib
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError, Pose, files
from arena_core.commands import one_line
from arena_core.files import LIMITS

FARTHEST = 1e6  # m
HALF_CHARACTER = re.compile("[\ud800-\udfff]")  # one of the two that stand for a rare character in UTF-16


@dataclass(frozen=True, slots=True)
class Field:
    """A value read from ``file`` at ``key`` ('' is the whole file); each method checks it and raises InputFileError."""

    file: Path
    key: str
    value: Any

    def rejection(self, allowed: str) -> InputFileError:
        """Return the error that says what this value is and what is allowed."""
        shown = one_line(_json_text(self.value), 60)
        return InputFileError(f"{self.file}: {self.key or 'content'} is {shown}; allowed: {allowed}")

    def has(self, name: str) -> bool:
        """Return whether this mapping has a key."""
        return name in self._read_mapping()

    def __getitem__(self, name: str | int) -> Field:
        mapping = self._read_mapping()
        key = self._key_of(name)
        if name not in mapping:
            raise InputFileError(f"{self.file}: {key} is missing")
        return Field(self.file, key, mapping[name])

    def check_keys(self, *names: str) -> None:
        """Refuse keys other than these."""
        for name in self._read_mapping():
            if name not in names:
                raise InputFileError(f"{self.file}: {self._key_of(name)} is unknown; allowed: {', '.join(names)}")

    def items(self) -> list[Field]:
        """Return the elements of a list."""
        if not isinstance(self.value, list):
            raise self.rejection("a list")
        if len(self.value) > LIMITS.elements:
            raise InputFileError(
                f"{self.file}: {self.key or 'content'} has {len(self.value)} elements; allowed: {LIMITS.elements}"
            )
        return [Field(self.file, f"{self.key}[{k}]", value) for k, value in enumerate(self.value)]

    def entries(self) -> list[tuple[Any, Field]]:
        """Return the keys and values of a mapping."""
        return [(name, self[name]) for name in self._read_mapping()]

    def number(self, low: float = -math.inf, above: float = -math.inf, high: float = math.inf) -> float:
        """Return a finite number, at least ``low``, more than ``above`` and at most ``high``."""
        allowed = (
            f"a number > {above:g}"
            if above > -math.inf
            else f"a number >= {low:g}"
            if low > -math.inf
            else "a finite number"
        )
        allowed += f" and <= {high:g}" if high < math.inf else ""
        if isinstance(self.value, bool) or not isinstance(self.value, int | float):
            raise self.rejection(allowed)
        try:
            number = float(self.value)
        except OverflowError:
            raise self.rejection(allowed) from None
        least = LIMITS.number_smallest if above == 0.0 else -math.inf
        if not (abs(number) <= LIMITS.number_largest and above < number <= high and number >= max(low, least)):
            beyond = math.isfinite(number) and high == math.inf and abs(number) > LIMITS.number_largest
            raise self.rejection(f"{allowed} up to {LIMITS.number_largest:g}" if beyond else allowed)
        return number

    def read_coordinate(self) -> float:
        """Return a coordinate, m, that still has a cell of its own in float64 arithmetic."""
        if isinstance(self.value, int | float) and FARTHEST < abs(self.value) <= sys.float_info.max:
            raise self.rejection(f"a coordinate within {FARTHEST:g} m of the origin")
        return self.number()

    def read_integer(self, low: int, high: int) -> int:
        """Return a whole number, ``low`` .. ``high``."""
        if isinstance(self.value, bool) or not isinstance(self.value, int) or not low <= self.value <= high:
            raise self.rejection(f"a whole number {low} .. {high}")
        return self.value

    def text(self) -> str:
        """Return text that is not empty and that a file can hold, which half a
        character cannot (``"\\ud800"`` in JSON).
        """
        if not isinstance(self.value, str) or not self.value:
            raise self.rejection("a text that is not empty")
        if HALF_CHARACTER.search(self.value):
            raise self.rejection("a text of whole characters")
        return self.value

    def read_bool(self) -> bool:
        """Return true or false."""
        if not isinstance(self.value, bool):
            raise self.rejection("true or false")
        return self.value

    def pose(self) -> Pose:
        """Return [x, y] or [x, y, theta] as a pose, m and rad."""
        match self.items():
            case [x, y]:
                return Pose(x.read_coordinate(), y.read_coordinate())
            case [x, y, theta]:
                return Pose(x.read_coordinate(), y.read_coordinate(), theta.number())
        raise self.rejection("[x, y] or [x, y, theta] (m, m, rad)")

    def position(self) -> NDArray[np.float64]:
        """Return [x, y], shape (2,), m."""
        if not isinstance(self.value, list) or len(self.value) != 2:
            raise self.rejection("[x, y] (m)")
        return np.array([item.read_coordinate() for item in self.items()])

    def positions(self) -> NDArray[np.float64]:
        """Return a list of [x, y], shape (N, 2), m."""
        return np.array([item.position() for item in self.items()]).reshape(-1, 2)

    def _key_of(self, name: str | int) -> str:
        """Return where a member of this mapping stands, on one line whatever its name."""
        plain = one_line(name if isinstance(name, str) and name.isprintable() else _json_text(name), 60)
        return f"{self.key}.{plain}" if self.key else plain

    def _read_mapping(self) -> Mapping[Any, Any]:
        if not isinstance(self.value, Mapping):
            raise self.rejection("a mapping of keys to values")
        return self.value


def _json_text(value: Any) -> str:
    """Return a value as JSON has it, or nearly so: files in YAML hold keys and values that JSON has not."""
    try:
        return json.dumps(value, default=str)
    except (TypeError, ValueError, RecursionError):
        return reprlib.repr(value)


def read_json(path: str | Path) -> Field:
    """Read a JSON file; raise InputFileError when it is missing or malformed, repeats a key or holds NaN."""
    return Field(Path(path), "", files.read_json(path, "a JSON file of scenarios"))
