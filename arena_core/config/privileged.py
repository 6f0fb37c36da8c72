"""Which parts of a robot's brain see the truth, wherever they are nested: noted as they are built."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from arena_core.contracts.truth import BrainPart


@dataclass(frozen=True, slots=True, eq=False)
class PrivilegedPart:
    """A part that sees the truth: what kind of component it is, by which name it was chosen, and the part itself."""

    kind: str
    name: str
    part: BrainPart


_watching: ContextVar[tuple[list[PrivilegedPart], ...]] = ContextVar("_watching", default=())


@contextmanager
def watch_privileged() -> Iterator[list[PrivilegedPart]]:
    """Collect the privileged parts that are built meanwhile, by whomever."""
    found: list[PrivilegedPart] = []
    token = _watching.set((*_watching.get(), found))
    try:
        yield found
    finally:
        _watching.reset(token)


def note_part(kind: str, name: str, part: object) -> None:
    """Tell those who watch of a part that was built, if it is privileged."""
    if isinstance(part, BrainPart) and part.privileged:
        for found in _watching.get():
            found.append(PrivilegedPart(kind, name, part))


def privileged_names(parts: Iterable[PrivilegedPart]) -> tuple[str, ...]:
    """Return what tables call these parts, such as ``tracker ground_truth``, each once."""
    return tuple(sorted({f"{part.kind} {part.name}" for part in parts}))
