"""The search: MAP-Elites by pyribs, which asks for a batch of problems and is told what came of each.

What it asks for follows from its seed and from what finished batches came to, so it does not matter how many workers
there are, nor whether it was interrupted.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from arena_break.course import Course, Draft
from arena_break.driving import Site, drive
from arena_break.judging import KINDS, PEOPLE, PLACES, UNCERTIFIED, Trial, Worth, certified_clearance, fails, worth_of
from arena_core import ConfigurationError, InputFileError
from arena_core.files import read_json, write_text_whole
from arena_tasks.scenario_files.problem import Problem

if TYPE_CHECKING:
    from ribs.schedulers import Scheduler

RESULT = "result.json"
ALLOWED = "what `arena break` wrote"
SIGMA = 0.2  # of the evolution strategy's first steps, of a gene's range (Fontaine et al. 2020: a fifth)
ISO, LINE = 0.05, 0.2  # of variations: alone, and along the line to another one (Vassiliades and Mouret 2018)
IN_VAIN = 20  # batches in a row without a problem that has room, after which there is none
Say = Callable[[str], None]
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """A hard problem: where it stands in the search, and what it is worth."""

    draft: Draft
    worth: Worth


@dataclass(slots=True, eq=False)
class Search:
    """What a search has come to: batches, problems that were tried, those in which the planner failed, of which the
    clairvoyant did not solve some; the hard ones, and the curve: how many there were after so many problems.
    """

    batches: int = 0
    tried: int = 0
    failures: int = 0
    uncertified: int = 0
    hard: list[Found] = field(default_factory=list)
    curve: list[tuple[int, int]] = field(default_factory=list)


def make_scheduler(genes: int, batch: int, seed: int) -> Scheduler:
    """Return a scheduler whose batches are ``batch`` vectors of ``genes`` numbers 0 .. 1: two thirds variations of what
    was found, a third by an evolution strategy (CMA-ME).
    """
    from ribs.archives import GridArchive
    from ribs.emitters import EvolutionStrategyEmitter, IsoLineEmitter
    from ribs.schedulers import Scheduler

    drawn = max(batch // 3, 2) if batch > 3 else 0
    archive = GridArchive(
        solution_dim=genes,
        dims=(len(KINDS), PEOPLE, PLACES),
        ranges=((-0.5, len(KINDS) - 0.5), (-0.5, PEOPLE - 0.5), (0.0, 1.0)),
        seed=seed,
    )
    bounds = [(0.0, 1.0)] * genes
    first = np.random.default_rng((seed, genes)).random((batch - drawn, genes))
    emitters: list[Any] = [
        IsoLineEmitter(
            archive,
            iso_sigma=ISO,
            line_sigma=LINE,
            initial_solutions=first,
            bounds=bounds,
            batch_size=batch - drawn,
            seed=seed + 1,
        )
    ]
    if drawn:
        middle = np.full(genes, 0.5)
        emitters.append(
            EvolutionStrategyEmitter(archive, x0=middle, sigma0=SIGMA, bounds=bounds, batch_size=drawn, seed=seed + 2)
        )
    return Scheduler(archive, emitters)


def run_search(course: Course, site: Site, folder: Path, limits: tuple[int, int], say: Say) -> Search:
    """Search until the next batch would exceed the budget; ``limits`` are budget, problems, and seed."""
    budget, seed = limits
    bounds = course.bounds
    found, vain = Search(), 0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # pyribs warns where a batch found nothing new
        scheduler = make_scheduler(bounds.genes, bounds.batch, seed)
        while found.tried + bounds.batch <= budget:
            asked = np.asarray(scheduler.ask(), np.float64)
            drafts = [course.draft(genes, f"b{found.batches:03d}_{i:02d}") for i, genes in enumerate(asked)]
            worths = _batch(course, site, folder / f"{found.batches:03d}", drafts)
            scheduler.tell([one.objective for one in worths], [one.measures for one in worths])
            driven = sum(draft is not None for draft in drafts)
            vain = 0 if driven else vain + 1
            if vain > IN_VAIN:
                raise ConfigurationError(
                    f"world is {course.world.name}, in which no problem has room for people; allowed: a larger world"
                )
            _add(found, drafts, worths)
            say(f"batch {found.batches}: {found.tried} of {budget} problems, {len(found.hard)} hard problems")
    return found


def _add(found: Search, drafts: Sequence[Draft | None], worths: Sequence[Worth]) -> None:
    found.batches += 1
    found.tried += sum(draft is not None for draft in drafts)
    pairs = [(draft, worth) for draft, worth in zip(drafts, worths, strict=True) if draft is not None]
    found.failures += sum(worth.objective > 0.0 or worth.objective == UNCERTIFIED for _, worth in pairs)
    found.uncertified += sum(worth.objective == UNCERTIFIED for _, worth in pairs)
    found.hard += [Found(draft, worth) for draft, worth in pairs if worth.hard]
    found.curve.append((found.tried, len(found.hard)))


def _batch(course: Course, site: Site, folder: Path, drafts: Sequence[Draft | None]) -> list[Worth]:
    """Return what the problems of a batch are worth; what was driven before is not driven again."""
    there = [draft for draft in drafts if draft is not None]
    if (folder / RESULT).exists():
        return _read(folder / RESULT, drafts)
    trials = _try(course, site, folder, [draft.problem for draft in there])
    near = course.bounds.near
    worths = [worth_of(one, trials[one.problem.name] if one else Trial(None), near) for one in drafts]
    write_text_whole(folder / RESULT, json.dumps([asdict(one) for one in worths], indent=1) + "\n")
    return _read(folder / RESULT, drafts)


def _try(course: Course, site: Site, folder: Path, problems: Sequence[Problem]) -> dict[str, Trial]:
    """Drive problems under the first seed of noise; those that fail by the clairvoyant, and those that it gets through
    under the other seeds, too.
    """
    keys, margin = course.bounds.keys, course.bounds.margin.people
    (driven,) = drive(site, folder, problems, keys[:1])
    if driven and all(one.error for one in driven.values()):
        error = next(iter(driven.values())).error
        raise ConfigurationError(f"the planner ends every episode of a batch with an error: {error}")
    failed = [one for one in problems if fails([driven], one.name)]
    (certified,) = drive(site, folder / "certificates", failed, keys[:1], clairvoyant=True)
    clear = {one.name: certified_clearance(certified.get(one.name), margin) for one in failed}
    solved = [one for one in failed if clear[one.name] is not None]
    others = drive(site, folder / "again", solved, keys[1:])
    shares = {one.name: (1 + sum(fails([again], one.name) for again in others)) / len(keys) for one in solved}
    return {one.name: Trial(driven.get(one.name), shares.get(one.name, 0.0), clear.get(one.name)) for one in problems}


def _read(path: Path, drafts: Sequence[Draft | None]) -> list[Worth]:
    told = read_json(path, ALLOWED)
    try:
        found = [_worth(one) for one in told]
    except (KeyError, TypeError, ValueError) as error:
        raise InputFileError(f"{path}: is damaged ({error}); allowed: {ALLOWED}") from None
    if len(found) != len(drafts):
        raise InputFileError(f"{path}: holds {len(found)} problems, not {len(drafts)}; allowed: {ALLOWED}")
    return found


def _worth(told: Mapping[str, Any]) -> Worth:
    return Worth(float(told["objective"]), int(told["kind"]), int(told["people"]), float(told["place"]))
