"""Folders as `arena tune` and `arena train` leave them, made without either."""

from __future__ import annotations

import csv
import json
import math
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from arena_core.hosting import SearchRange, SearchSpace
from arena_core.records import EPISODE_COLUMNS
from arena_ladder.driving import LadderFolder
from arena_ladder.plan import make_plan
from arena_tuning.budget import read_budget
from arena_tuning.folder import open_folder
from arena_tuning.problems import JudgingSet, Problem, ProblemSets, SearchSet
from arena_tuning.study import Plan, run_search

SPACE = SearchSpace(
    {
        "weight": SearchRange("it follows", "1/m", low=0.1, high=10.0, log=True),
        "samples": SearchRange("it sees more", "-", low=1, high=9, integer=True),
    }
)
PRESENT = {"samples": 3, "weight": 1.0}
SETTINGS = {
    **{"planner": "teb", "preset": "teb", "robot": "jackal", "words": [], "sampler": "random", "seed": 0},
    **{"objective": "strict_success", "present": PRESENT},
    "problems": {"name": "tiny", "entrants": 4, "blocks": [1, 2]},
}
CARD = {
    **{"curve": [[2, 0.0], [8, 1.5]], "values": {"samples": 4, "weight": 3.5}, "better": True},
    **{"verdict": "better than the present values, on test +0.5", "importance": {"weight": 0.8, "samples": 0.2}},
    **{"space": {"weight": {"why": "it follows", "unit": "1/m", "low": 0.1, "high": 10.0, "log": True}}},
    "test": {
        "figures": {
            "strict_success": {
                **{"present": 0.5, "tuned": 0.75, "difference": 0.25},
                **{"low": 0.05, "high": 0.4, "p": 0.01, "pairs": 64.0},
            }
        }
    },
}


class Scored:
    """Drives without a simulator: best at weight 4."""

    def drive(self, sets_of_values: Sequence[Any], problems: Sequence[Problem]) -> list[dict[Problem, Any]]:
        return [{one: (-(math.log(values["weight"] / 4.0) ** 2),) for one in problems} for values in sets_of_values]

    def errors(self, sets_of_values: Sequence[Any], problems: Sequence[Problem]) -> list[str]:
        return []


def write_tuning(folder: Path, budget: int = 20) -> None:
    """Write a tuning that runs, after races for a budget of episodes."""
    folder.mkdir(parents=True)
    open_folder(folder, SETTINGS, resume=False)
    race_on(folder, budget)


def race_on(folder: Path, budget: int) -> None:
    """Search up to a greater budget, as a tuning that goes on does."""
    sets = ProblemSets(1, [], [[]], 4, [1, 2], SearchSet(1), JudgingSet(2, 4), JudgingSet(3, 4))
    plan = Plan(SPACE, "random", 0, read_budget(str(budget)), sets)
    run_search(plan, PRESENT, Scored(), folder, lambda line: None)  # type: ignore[arg-type]
    line = json.dumps({"key": "ab", "values": {}, "problem": ["tune", 0, 0], "row": {}})
    (folder / "episodes.jsonl").write_text(f"{line}\n" * budget)


class TwiceScored(Scored):
    """Drives likewise for two objectives: best at weight 4 by the first, at weight 1 by the second."""

    def drive(self, sets_of_values: Sequence[Any], problems: Sequence[Problem]) -> list[dict[Problem, Any]]:
        return [{one: tuple(map(_miss(values), (4.0, 1.0))) for one in problems} for values in sets_of_values]


def _miss(values: Any) -> Callable[[float], float]:
    return lambda best: -(math.log(values["weight"] / best) ** 2)


def write_pareto(folder: Path, budget: int = 80) -> None:
    """Write a tuning for two objectives that has ended."""
    folder.mkdir(parents=True)
    open_folder(folder, {**SETTINGS, "objective": "[success, -collisions]"}, resume=False)
    sets = ProblemSets(1, [], [[]], 4, [1, 2], SearchSet(1), JudgingSet(2, 4), JudgingSet(3, 4))
    plan = Plan(SPACE, "random", 0, read_budget(str(budget)), sets, 2)
    search = run_search(plan, PRESENT, TwiceScored(), folder, lambda line: None)  # type: ignore[arg-type]
    (folder / "episodes.jsonl").touch()
    points = [{"values": one.values, "advantages": one.advantages(search.scores)} for one in search.whole[:3]]
    front = [{**one, "chosen": place == 1} for place, one in enumerate(points)]
    (folder / "card.json").write_text(json.dumps({**CARD, "pareto": front, "rule": "the best by the last"}))


def write_card(folder: Path) -> None:
    """End a tuning."""
    (folder / "card.json").write_text(json.dumps(CARD))


def write_training(folder: Path, validations: int = 3) -> None:
    """Write a training that runs: validations and what TensorBoard was told."""
    (folder / "tensorboard" / "ppo_0").mkdir(parents=True)
    config = {"planner": "rosnav", "robot": {"name": "turtlebot3"}, "seed": 4, "total_steps": 1_000_000}
    (folder / "config.json").write_text(json.dumps(config))
    (folder / "code.json").write_text("{}")
    write_validations(folder, validations)
    scalars = [(step, "rollout/ep_rew_mean", 0.5 * step / 1000.0) for step in range(1000, 6000, 1000)]
    scalars += [(step, "train/entropy_loss", -1.5) for step in range(1000, 6000, 2000)]
    scalars += [(5000, "train/entropy_loss", -1.25), (1000, "train/loss", 3.0)]
    (folder / "tensorboard" / "ppo_0" / "events.out.tfevents.1.vm").write_bytes(events(scalars))


def write_validations(folder: Path, count: int) -> None:
    rows = [
        {
            **{"steps": 2000 * number, "level": 0.0, "training": 0.5, "episodes": 100},
            **{"success": 0.2 * number, "collision": 0.1, "time_out": 0.3},
        }
        for number in range(1, count + 1)
    ]
    (folder / "curve.json").write_text(json.dumps(rows))


def events(scalars: Sequence[tuple[int, str, float]]) -> bytes:
    """Return an event file of TensorBoard; its checksums are zero."""
    return b"".join(record(message(*one)) for one in scalars)


def record(content: bytes) -> bytes:
    return struct.pack("<Q", len(content)) + bytes(4) + content + bytes(4)


def message(step: int, tag: str, value: float) -> bytes:
    inside = field(1, tag.encode()) + b"\x15" + struct.pack("<f", value)
    return b"\x09" + struct.pack("<d", 0.0) + b"\x10" + varint(step) + field(5, field(1, inside))


def field(number: int, content: bytes) -> bytes:
    return bytes([number << 3 | 2]) + varint(len(content)) + content


def varint(value: int) -> bytes:
    found = b""
    while value >= 0x80:
        found += bytes([value & 0x7F | 0x80])
        value >>= 7
    return found + bytes([value])


def write_ladder(folder: Path, planner: str, successes: Sequence[int] = (8, 6, 1)) -> None:
    """Write a ladder that runs: a block on each of the first rungs of one cell, with so many successes."""
    plan = make_plan("hall", "slow", 24, 0.2)
    ladder = LadderFolder(folder, plan, (f"planner={planner}", "robot=jackal"))
    ladder.begin(resume=False)
    for number, (rung, won) in enumerate(zip(plan.first, successes, strict=True)):
        density = plan.rungs[rung]
        place = folder / "hall_slow" / f"{number:03d}_{density:g}"
        place.mkdir(parents=True)
        with (place / "episodes.csv").open("w", newline="") as file:
            writer = csv.DictWriter(
                file, [*EPISODE_COLUMNS, "success", "strict_success", "people_per_100m2"], restval=""
            )
            writer.writeheader()
            for episode in range(plan.block):
                figures = {"success": float(episode < won), "strict_success": float(episode < won)}
                same = {"episode": episode, "seed": plan.seed + number, "outcome": "time_out"}
                writer.writerow({**same, **figures, "people_per_100m2": density})


def end_ladder(folder: Path, *ladders: dict[str, Any]) -> None:
    """Write the page of ladders, whose figures are made up: .9 among 4, .5 among 8 people per 100 m2."""
    pairs = ["dwa bears 2.00 times (1.50 – 3.00) as many people as teb."] if len(ladders) > 1 else []
    folder.mkdir(exist_ok=True)
    (folder / "ladder.json").write_text(json.dumps({"ladders": ladders, "pairs": pairs}))


def ladder_facts(planner: str, *, limit: bool = False) -> dict[str, Any]:
    """Return what ``ladder.json`` holds of a ladder."""
    rungs = [{"density": x, "episodes": 8, "successes": k} for x, k in ((0.0, 8), (4.0, 6), (12.0, 1))]
    curve = {
        **{"half": 8.0, "lapse": 0.01, "rungs": rungs, "curve": [[0.0, 0.99], [4.0, 0.9], [8.0, 0.5], [24.0, 0.1]]},
        **{"rho90": {"value": 4.0, "low": 2.0, "high": 6.0, "text": "4.0 (2.0 – 6.0)"}},
        **{"rho50": {"value": 8.0, "low": 6.0, "high": 11.0, "text": "8.0 (6.0 – 11.0)"}},
    }
    cell = {"success": curve, "strict_success": curve, **({"clairvoyant": curve} if limit else {})}
    return {"planner": planner, "robot": "jackal", "rungs": [0.0, 4.0, 24.0], "cells": {"hall_slow": cell}}
