"""Claims as they are written down: YAML files of statements, each with the contrasts that decide it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from arena_core import ConfigurationError
from arena_core.files import option_files, read_yaml
from arena_core.hosting import load_registry
from arena_core.parameters import read_settings

ALLOWED = "a file of claims (docs/claims.md)"
RIVAL = "rival"  # in ``each``: every planner of ``than`` by itself
Expected = Literal["lower", "higher", "alike", "not_higher", "not_lower", "at_most", "at_least"]
BOUNDS = ("at_most", "at_least")


@dataclass(frozen=True, slots=True)
class Contrast:
    """A mean of ``metric`` ``of`` some cells, ``expected`` to be lower than, alike, ... that of others (``than``), or
    at most ``margin``.

    Episodes are paired by problem and by all factors that are not selected; cells that are selected together are
    averaged first. ``each`` names factors by whose values the contrast is taken apart, "rival" among them. With
    ``change``, a factor and two of its values, the metric is how much it grows from the first to the second.
    ``margin``: by how much at least a mean is to be lower or higher, how far apart at most means that are alike, or not
    higher; else the bound itself.
    """

    metric: str
    of: dict[str, Any]
    expected: Expected
    than: dict[str, Any] | None = None
    each: list[str] = field(default_factory=list)
    change: dict[str, list[Any]] | None = None
    margin: float = 0.0

    def __post_init__(self) -> None:
        if (self.than is None) != (self.expected in BOUNDS):
            raise ConfigurationError(
                f"expected is {self.expected}; allowed: {' or '.join(BOUNDS)} without than, the others with it"
            )
        if self.change is not None and (len(self.change) != 1 or any(len(ends) != 2 for ends in self.change.values())):
            raise ConfigurationError("change is wrong; allowed: one factor with two values, such as {people: [5, 10]}")


@dataclass(frozen=True, slots=True)
class Claim:
    """A statement, the contrasts that all have to hold, and what is known of it.

    ``found`` is the source's own figure, ``artefact`` what is suspected to have made it, ``ablation`` contrasts that
    show that cause.
    """

    says: str
    contrasts: list[Contrast]
    about: str = ""
    found: str = ""
    artefact: str = ""
    ablation: list[Contrast] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Claims:
    """The claims of one source, by number."""

    source: str
    claims: dict[str, Claim]


def read_claims(name: str) -> Claims:
    """Return claims by the name of an installed file (``conf/claims/NAME.yaml``) or a path;
    raise ConfigurationError.
    """
    known = option_files("claims", load_registry().manager)
    path = Path(name)
    if name not in known and not path.is_file():
        raise ConfigurationError(f"claims is {name}; allowed: {', '.join(known)} or a file")
    file = Path(str(known[name])) if name in known else path
    return _parse_claims(read_yaml(file, ALLOWED), str(file))


def _parse_claims(content: Any, file: str) -> Claims:
    if not isinstance(content, dict):
        raise ConfigurationError(f"{file}: holds no mapping; allowed: {ALLOWED}")
    try:
        return read_settings(
            {"source": content.get("source"), "claims": content.get("claims"), **_other_keys(content)}, Claims, ""
        )
    except ConfigurationError as error:
        raise ConfigurationError(f"{file}: {error}") from error


def _other_keys(content: Mapping[str, Any]) -> dict[str, Any]:
    return {str(key): value for key, value in content.items() if key not in ("source", "claims")}
