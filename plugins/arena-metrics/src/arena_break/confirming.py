"""Whether a problem is hard under every seed of noise, and how few people make it so."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from arena_break.course import without_person
from arena_break.driving import Episode, Site, drive
from arena_break.judging import certified_clearance, fails
from arena_tasks.scenario_files.problem import Problem


@dataclass(frozen=True, slots=True, eq=False)
class Hard:
    """A problem that was confirmed: its planner's episode of each seed, the clairvoyant's, and what that keeps from
    people, m.
    """

    problem: Problem
    episodes: Sequence[Episode]
    certificate: Episode
    clear: float


def confirm(
    site: Site, folder: Path, problems: Sequence[Problem], keys: Sequence[int], margin: float
) -> dict[str, Hard]:
    """Return those of some problems in which the planner fails under every seed and the clairvoyant gets through."""
    driven = drive(site, folder, problems, keys)
    failed = [one for one in problems if fails(driven, one.name)]
    (certified,) = drive(site, folder / "certificates", failed, keys[:1], clairvoyant=True)
    found: dict[str, Hard] = {}
    for one in failed:
        clear = certified_clearance(certified.get(one.name), margin)
        if clear is not None:
            found[one.name] = Hard(one, [by_name[one.name] for by_name in driven], certified[one.name], clear)
    return found


def shrink(
    site: Site, folder: Path, problems: Sequence[Problem], keys: Sequence[int], margin: float
) -> dict[str, Problem]:
    """Return problems with as few people as they can have: in each, nobody can be left out any more.

    Round by round every person of each problem is left out in turn; of the smaller problems that are still hard under
    every seed the first is taken. What is returned has the names of the problems that it came from.
    """
    small = {one.name: one for one in problems}
    open_names, number = [one.name for one in problems], 0
    while open_names:
        smaller = {
            f"{name}-{index}": (name, without_person(small[name], index, f"{name}-{index}"))
            for name in open_names
            for index in range(len(small[name].pedestrians))
        }
        place = folder / f"{number:02d}"
        (first,) = drive(site, place, [one for _, one in smaller.values()], keys[:1])
        failing = [one for label, (_, one) in smaller.items() if fails([first], label)]
        hard = confirm(site, place / "confirmed", failing, keys, margin)
        taken: dict[str, Problem] = {}
        for label in hard:
            taken.setdefault(smaller[label][0], hard[label].problem)
        small |= {name: replace(one, name=name) for name, one in taken.items()}
        open_names, number = list(taken), number + 1
    return small
