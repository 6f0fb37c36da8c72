"""One pack of the packs of several searches: equal shares, with a table of their certificates."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from arena_break.results import CARD, COLUMNS, PACK
from arena_core import ConfigurationError, InputFileError
from arena_core.files import csv_text, read_json, write_text_whole
from arena_tasks.commands.packing import ANYBODY, make_pack
from arena_tasks.scenario_files.scenario_file import read_scenario_file, save_scenarios

CERTIFICATES = "certificates.csv"
HEAD = ("preset", "robot", "world", "seed", "budget", "code", *COLUMNS)


def join_packs(folders: Sequence[Path], out: Path, share: int | None) -> list[str]:
    """Write a pack of equal shares of the problems of some searches (None: as many as the smallest has); return what to
    print. Raises ConfigurationError or InputFileError.
    """
    cards = [_read_card(folder) for folder in folders]
    names = [f"{card['preset']} on {card['robot']} in {card['world']}" for card in cards]
    for name in names:
        if names.count(name) > 1:
            raise ConfigurationError(f"two searches are against {name}; allowed: one of each")
    counts = [len(card["problems"]) for card in cards]
    least = min(counts) if share is None else share
    for folder, count in zip(folders, counts, strict=True):
        if count < max(least, 1):
            raise ConfigurationError(f"share is {least}, and {folder} has {count}; allowed: up to that, 1 or more")
    if out.exists():
        raise ConfigurationError(f"out is {out}, which is there already; allowed: a name that is free")
    for folder in folders:
        _copy(folder / PACK, out, least)
    rows = [
        [*(card[key] for key in HEAD[:6]), *(one[key] for key in COLUMNS)]
        for card in cards
        for one in card["problems"][:least]
    ]
    write_text_whole(out / CERTIFICATES, csv_text([HEAD, *rows]))
    title = f"{least} certified hard problems each against {'; '.join(names)}"
    pack = make_pack(out, {"id": out.name, "title": title, "licence": "MIT"})
    return [
        f"{out}: {least * len(folders)} problems, {least} each against {', '.join(names)}",
        f"written: {pack.folder}",
    ]


def _copy(pack: Path, out: Path, share: int) -> None:
    """Copy the first problems of a pack's scenario files, and its maps."""
    for file in sorted((pack / "scenarios").glob("*.json")):
        content = read_scenario_file(file, ANYBODY)
        target = out / "scenarios" / file.name
        target.parent.mkdir(parents=True, exist_ok=True)
        title = content.title.partition(" ")[2]
        save_scenarios(target, content.problems[:share], f"{share} {title}", content.map)
    for file in sorted((pack / "maps").iterdir()):
        target = out / "maps" / file.name
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists() and target.read_bytes() != file.read_bytes():
            raise ConfigurationError(f"{file} is another map of that name; allowed: searches in worlds of one seed")
        shutil.copyfile(file, target)


def _read_card(folder: Path) -> Mapping[str, Any]:
    told = read_json(folder / CARD, "a folder that `arena break` wrote")
    if not isinstance(told, dict) or any(key not in told for key in (*HEAD[:6], "problems")):
        raise InputFileError(f"{folder / CARD}: is no card; allowed: a folder that `arena break` wrote")
    return told
