"""One pack of the packs of several searches: up to so many problems against each planner, with a table of their
certificates and how each search went.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from arena_break.request import file_name
from arena_break.results import CARD, COLUMNS, PACK
from arena_core import ConfigurationError, InputFileError
from arena_core.files import csv_text, read_json, write_text_whole
from arena_tasks.commands.packing import ANYBODY, make_pack
from arena_tasks.scenario_files.problem import Problem
from arena_tasks.scenario_files.scenario_file import read_scenario_file, save_scenarios

CERTIFICATES, SEARCHES = "certificates.csv", "searches.yaml"
FACTS = ("preset", "robot", "world", "seed", "budget", "code")
HEAD = (*FACTS, *COLUMNS)
WENT = ("problems", "failures", "hard", "confirmed")


@dataclass(frozen=True, slots=True)
class Part:
    """What one search gives to the pack."""

    folder: Path
    card: Mapping[str, Any]
    rows: Sequence[Mapping[str, Any]]

    @property
    def against(self) -> str:
        """Return the planner and the robot."""
        return f"{self.card['preset']} on {self.card['robot']}"

    @property
    def place(self) -> str:
        """Return the name of the scenario file that holds its problems."""
        return f"{file_name(self.card['robot'])}_{file_name(self.card['world'])}.json"

    def problems(self) -> list[Problem]:
        """Return its problems as the search packed them."""
        names = {row["name"] for row in self.rows}
        files = sorted((self.folder / PACK / "scenarios").glob("*.json"))
        return [one for file in files for one in read_scenario_file(file, ANYBODY).problems if one.name in names]

    def map_file(self) -> str:
        """Return the name of its map's YAML file."""
        return next(path.name for path in sorted((self.folder / PACK / "maps").glob("*.yaml")))


def join_packs(folders: Sequence[Path], out: Path, share: int | None) -> list[str]:
    """Write a pack of up to ``share`` problems against each planner and robot (None: as many as there are of each);
    return what to print. Problems on a robot in a world come into one scenario file. Raises ConfigurationError or
    InputFileError.
    """
    parts = _shared([(folder, _read_card(folder)) for folder in folders], share)
    if out.exists():
        raise ConfigurationError(f"out is {out}, which is there already; allowed: a name that is free")
    for part in parts:
        _copy_maps(part, out)
    for place in dict.fromkeys(part.place for part in parts):
        _write_scenarios(out / "scenarios" / place, [part for part in parts if part.place == place])
    rows = [[*(part.card[key] for key in FACTS), *(row[key] for key in COLUMNS)] for part in parts for row in part.rows]
    write_text_whole(out / CERTIFICATES, csv_text([HEAD, *rows]))
    text = yaml.safe_dump([_told(part) for part in parts], sort_keys=False, width=140)
    write_text_whole(
        out / SEARCHES, f"# what each search was asked for, how it went, and how many of its problems are here\n{text}"
    )
    said = _said(parts)
    pack = make_pack(out, {"id": out.name, "title": f"{len(rows)} certified hard problems: {said}", "licence": "MIT"})
    return [f"{out}: {len(rows)} problems: {said}", f"written: {pack.folder}"]


def _shared(searches: Sequence[tuple[Path, Mapping[str, Any]]], share: int | None) -> list[Part]:
    """Return what each search gives: the first come first, and no problem's name twice."""
    counts: dict[str, int] = {}
    for folder, card in searches:
        if not card["problems"]:
            raise ConfigurationError(f"{folder} found no hard problem; allowed: searches that found some")
        counts[_against(card)] = counts.get(_against(card), 0) + len(card["problems"])
    left = dict.fromkeys(counts, min(counts.values()) if share is None else share)
    parts, seen = [], set[str]()
    for folder, card in searches:
        rows = card["problems"][: left[_against(card)]]
        left[_against(card)] -= len(rows)
        for row in rows:
            if row["name"] in seen:
                raise ConfigurationError(f"{folder} holds {row['name']} again; allowed: searches of different seeds")
            seen.add(row["name"])
        parts.append(Part(folder, card, rows))
    return [part for part in parts if part.rows]


def _said(parts: Sequence[Part]) -> str:
    counts: dict[str, int] = {}
    for part in parts:
        counts[part.against] = counts.get(part.against, 0) + len(part.rows)
    return ", ".join(f"{count} against {name}" for name, count in counts.items())


def _write_scenarios(target: Path, parts: Sequence[Part]) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    problems = [one for part in parts for one in part.problems()]
    save_scenarios(target, problems, f"{len(problems)} hard problems: {_said(parts)}", f"../maps/{parts[0].map_file()}")


def _copy_maps(part: Part, out: Path) -> None:
    for file in sorted((part.folder / PACK / "maps").iterdir()):
        target = out / "maps" / file.name
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists() and target.read_bytes() != file.read_bytes():
            raise ConfigurationError(f"{file} is another map of that name; allowed: searches in worlds of one seed")
        shutil.copyfile(file, target)


def _told(part: Part) -> dict[str, Any]:
    """Return what a search was asked for and how it went."""
    card = part.card
    words = [
        f"planner={card['preset']}",
        *(f"{key}={card[key]}" for key in ("robot", "world", "budget", "count", "seed")),
    ]
    search = card.get("search", {})
    return {
        "command": " ".join(["arena break", *words, *card.get("words", [])]),
        "code": card["code"],
        **{key: search[key] for key in WENT if key in search},
        "here": len(part.rows),
        "bounds": card.get("bounds", {}),
    }


def _against(card: Mapping[str, Any]) -> str:
    return f"{card['preset']} on {card['robot']}"


def _read_card(folder: Path) -> Mapping[str, Any]:
    told = read_json(folder / CARD, "a folder that `arena break` wrote")
    if not isinstance(told, dict) or any(key not in told for key in (*FACTS, "count", "problems")):
        raise InputFileError(f"{folder / CARD}: is no card; allowed: a folder that `arena break` wrote")
    return told
