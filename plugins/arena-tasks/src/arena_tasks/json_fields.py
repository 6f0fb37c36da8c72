"""JSON, or YAML, whose every value knows its file and key, so that each slip is one line."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError, Pose

FARTHEST = 1e6  # m
LARGEST_FILE = 50_000_000  # bytes


@dataclass(frozen=True, slots=True)
class Field:
    """A value read from ``file`` at ``key`` ('' is the whole file); each method checks it and raises InputFileError."""

    file: Path
    key: str
    value: Any

    def refused(self, allowed: str) -> InputFileError:
        """Return the error that says what this value is and what is allowed."""
        shown = json.dumps(self.value, default=str)
        shown = shown if len(shown) <= 60 else shown[:57] + "..."
        return InputFileError(f"{self.file}: {self.key or 'content'} is {shown}; allowed: {allowed}")

    def has(self, name: str) -> bool:
        """Tell whether this mapping has a key."""
        return name in self._mapping()

    def __getitem__(self, name: str | int) -> Field:
        mapping = self._mapping()
        key = self._key_of(name)
        if name not in mapping:
            raise InputFileError(f"{self.file}: {key} is missing")
        return Field(self.file, key, mapping[name])

    def only(self, *names: str) -> None:
        """Refuse keys other than these."""
        for name in self._mapping():
            if name not in names:
                raise InputFileError(f"{self.file}: {self._key_of(name)} is unknown; allowed: {', '.join(names)}")

    def items(self) -> list[Field]:
        """Return the elements of a list."""
        if not isinstance(self.value, list):
            raise self.refused("a list")
        return [Field(self.file, f"{self.key}[{k}]", value) for k, value in enumerate(self.value)]

    def entries(self) -> list[tuple[Any, Field]]:
        """Return the keys and values of a mapping."""
        return [(name, self[name]) for name in self._mapping()]

    def number(self, low: float = -math.inf, above: float = -math.inf, high: float = math.inf) -> float:
        """Return a finite number, at least ``low``, more than ``above`` and at most ``high``."""
        allowed = f"a number > {above:g}" if above > -math.inf else f"a number >= {low:g}" if low > -math.inf else "a finite number"
        allowed += f" and <= {high:g}" if high < math.inf else ""
        if isinstance(self.value, bool) or not isinstance(self.value, int | float):
            raise self.refused(allowed)
        try:
            number = float(self.value)
        except OverflowError:
            raise self.refused(allowed) from None
        if not (math.isfinite(number) and above < number <= high and number >= low):
            raise self.refused(allowed)
        return number

    def coordinate(self) -> float:
        """Return a coordinate, m, that still has a cell of its own in float64 arithmetic."""
        number = self.number()
        if abs(number) > FARTHEST:
            raise self.refused(f"a coordinate within {FARTHEST:g} m of the origin")
        return number

    def integer(self, low: int, high: int) -> int:
        """Return a whole number, ``low`` .. ``high``."""
        if isinstance(self.value, bool) or not isinstance(self.value, int) or not low <= self.value <= high:
            raise self.refused(f"a whole number {low} .. {high}")
        return self.value

    def text(self) -> str:
        """Return text that is not empty."""
        if not isinstance(self.value, str) or not self.value:
            raise self.refused("a text that is not empty")
        return self.value

    def truth(self) -> bool:
        """Return true or false."""
        if not isinstance(self.value, bool):
            raise self.refused("true or false")
        return self.value

    def pose(self) -> Pose:
        """Return [x, y] or [x, y, theta] as a pose, m and rad."""
        match self.items():
            case [x, y]:
                return Pose(x.coordinate(), y.coordinate())
            case [x, y, theta]:
                return Pose(x.coordinate(), y.coordinate(), theta.number())
        raise self.refused("[x, y] or [x, y, theta] (m, m, rad)")

    def position(self) -> NDArray[np.float64]:
        """Return [x, y], shape (2,), m."""
        if not isinstance(self.value, list) or len(self.value) != 2:
            raise self.refused("[x, y] (m)")
        return np.array([item.coordinate() for item in self.items()])

    def positions(self) -> NDArray[np.float64]:
        """Return a list of [x, y], shape (N, 2), m."""
        return np.array([item.position() for item in self.items()]).reshape(-1, 2)

    def _key_of(self, name: str | int) -> str:
        """Return where a member of this mapping stands, on one line whatever its name."""
        plain = name if isinstance(name, str) and name.isprintable() else json.dumps(name, default=str)
        return f"{self.key}.{plain}" if self.key else plain

    def _mapping(self) -> Mapping[Any, Any]:
        if not isinstance(self.value, Mapping):
            raise self.refused("a mapping of keys to values")
        return self.value


def read_json(path: Path) -> Field:
    """Read a JSON file; raise InputFileError when it is missing or malformed, repeats a key or holds NaN."""
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise ValueError(f"it is larger than {LARGEST_FILE} bytes")
        return Field(path, "", json.loads(content.decode(), object_pairs_hook=_unique, parse_constant=_no_constant))
    except OSError as error:
        raise InputFileError(f"{path}: cannot be read ({error.strerror}); allowed: a JSON file of scenarios") from None
    except json.JSONDecodeError as error:
        raise InputFileError(f"{path}: is no JSON (line {error.lineno}, column {error.colno}: {error.msg})") from None
    # ValueError: text that is no UTF-8, and what the two functions below refuse; RecursionError: nested without end
    except (ValueError, RecursionError) as error:
        raise InputFileError(f"{path}: is no JSON ({error})") from None


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    mapping = dict(pairs)
    if len(mapping) < len(pairs):
        raise ValueError(f"a key is there twice among {', '.join(name if name.isprintable() else json.dumps(name) for name, _ in pairs)}")
    return mapping


def _no_constant(name: str) -> Any:
    raise ValueError(f"{name} is no number of JSON")
