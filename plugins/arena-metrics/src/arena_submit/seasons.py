"""Seasons of a standing benchmark: its crowds with a seed that nobody can know before a date.

The seed comes from the value of a public random beacon in a round that is named long before. Whoever takes part
publishes an entry before that: a digest of the planner's configuration on each robot and of the code.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import date
from hashlib import sha256
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError, InputFileError
from arena_core.commands import one_line
from arena_core.files import read_yaml
from arena_core.hosting import Registry, compose, digest_code, to_plain
from arena_core.parameters import read_settings
from arena_submit.packing import Pack
from arena_submit.standing import Season, Standing

VALUE = re.compile(r"[0-9a-f]{64}")
ENTRY = 16  # hexadecimal digits
LATE = "late"


@dataclass(frozen=True, slots=True)
class Published:
    """An entry of whoever takes part, and the day, YYYY-MM-DD, on which it was published."""

    entry: str
    published: str


@dataclass(frozen=True, slots=True)
class Entries:
    """A file of published entries; ``where`` says for a reader where they are published."""

    where: str
    entries: list[Published]


@dataclass(frozen=True, slots=True)
class Sealed:
    """The crowds of a season: the benchmark of which a planner drives them, and the day on which the seed came out."""

    season: str
    standing: Standing
    opens: date


def open_season(standing: Standing, name: str, value: str) -> Sealed:
    """Return the crowds of a season, by the value of its round; raise ConfigurationError for what is none."""
    season, found = find_season(standing, name), value.strip().lower()
    if not VALUE.fullmatch(found):
        raise ConfigurationError(
            f"value is {one_line(value, 80)}; allowed: the 64 hexadecimal digits of round {season.round} of "
            f"{standing.beacon}"
        )
    tables = {start: title for start, title in standing.tables.items() if _is_own(standing, start)}
    sealed = replace(standing, seed=season_seed(standing.experiment, name, found), also=[], tables=tables)
    return Sealed(name, sealed, date.fromisoformat(season.opens))


def find_season(standing: Standing, name: str) -> Season:
    """Return a season by its name; raise ConfigurationError for one of none."""
    if name not in standing.seasons:
        raise ConfigurationError(f"season is {one_line(name, 40)}; allowed: {', '.join(standing.seasons)}")
    return standing.seasons[name]


def season_seed(experiment: str, season: str, value: str) -> int:
    """Return the seed: the first 31 bits of SHA-256 over benchmark, season and the beacon's value."""
    return int.from_bytes(sha256(f"{experiment} {season} {value}".encode()).digest()[:4], "big") >> 1


def planner_entry(standing: Standing, words: Sequence[str], registry: Registry) -> str:
    """Return the entry of a planner as it is installed and configured here."""
    scenario = next(iter(standing.scenarios))
    sections, codes = {}, set()
    for robot in standing.robots:
        chosen = [f"experiment={standing.experiment}", f"robot={robot}", f"scenario={scenario}", *words]
        config = to_plain(compose(chosen))
        sections[robot] = _section(config)
        codes.add(digest_code(config, registry).digest)
    return _digest(sections, codes)


def pack_entry(pack: Pack, standing: Standing) -> str:
    """Return the entry of the planner that drove the crowds of a pack."""
    own = [run for run in pack.runs if str(run.config.get("choices", {}).get("experiment")) == standing.experiment]
    sections = {str(run.config["choices"].get("robot")): _section(run.config) for run in own}
    return _digest(sections, {str(run.provenance["code"].get("digest")) for run in own})


def read_entries(path: Path) -> Entries:
    """Read a file of published entries; raise InputFileError where it is none or a day is no day."""
    found = read_settings(_with_texts(read_yaml(path, "published entries")), Entries, str(path))
    for one in found.entries:
        try:
            date.fromisoformat(one.published)
        except ValueError:
            raise InputFileError(f"{path}: published is {one_line(one.published, 40)}; allowed: YYYY-MM-DD") from None
    return found


def _with_texts(node: Any) -> Any:
    """Return what was read with each day as a text: YAML makes a date of one that is not in quotes."""
    if isinstance(node, Mapping):
        return {key: _with_texts(value) for key, value in node.items()}
    if isinstance(node, list):
        return [_with_texts(value) for value in node]
    return node.isoformat() if isinstance(node, date) else node


def published_text(entry: str, entries: Entries | None, opens: date) -> str:
    """Return the day on which an entry was published, "late" where that was not before the season opened."""
    days = [date.fromisoformat(one.published) for one in entries.entries if one.entry == entry] if entries else []
    first = min(days, default=None)
    return LATE if first is None or first >= opens else first.isoformat()


def _is_own(standing: Standing, start: str) -> bool:
    return any(scenario.startswith(start) for scenario in standing.scenarios)


def _section(config: Mapping[str, Any]) -> dict[str, Any]:
    return {key: config.get(key) for key in ("planner", "predictor")}


def _digest(sections: Mapping[str, Any], codes: set[str]) -> str:
    text = json.dumps({"code": sorted(codes), "robots": sections}, sort_keys=True)
    return sha256(text.encode()).hexdigest()[:ENTRY]
