"""Rows of many episodes in little memory: a run may have a million."""

from __future__ import annotations

import sys
from array import array
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any


class Layout:
    """Which columns rows have, and where the value of each stands: rows of one run share it."""

    __slots__ = ("places",)

    def __init__(self, columns: tuple[tuple[str, bool], ...]) -> None:
        counts = [0, 0]
        self.places: dict[str, tuple[bool, int]] = {}
        for name, is_number in columns:
            self.places[sys.intern(name)] = is_number, counts[is_number]
            counts[is_number] += 1


class KeptRow(Mapping[str, Any]):
    """A row that cannot change: floats in eight bytes each, bit for bit, and texts that rows have in common once."""

    __slots__ = ("_layout", "_numbers", "_others")

    def __init__(self, row: Mapping[str, Any]) -> None:
        self._layout = _column_layout(tuple((name, type(value) is float) for name, value in row.items()))
        self._numbers = array("d", [value for value in row.values() if type(value) is float])
        self._others = tuple(_intern_value(value) for value in row.values() if type(value) is not float)

    def __getitem__(self, name: str) -> Any:
        is_number, place = self._layout.places[name]
        return self._numbers[place] if is_number else self._others[place]

    def __iter__(self) -> Iterator[str]:
        return iter(self._layout.places)

    def __len__(self) -> int:
        return len(self._layout.places)


@lru_cache(maxsize=1000)
def _column_layout(columns: tuple[tuple[str, bool], ...]) -> Layout:
    return Layout(columns)


def _intern_value(value: Any) -> Any:
    return sys.intern(value) if type(value) is str else value
