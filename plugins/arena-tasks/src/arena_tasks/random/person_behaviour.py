"""What the pedestrian model shall know of people beyond their rounds: who they are, how fast,
where they pause, who comes back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arena_core import PedestrianSpec
from arena_tasks.random_parameters import FARTHEST, PeopleParameters


def with_behaviour(
    people: Sequence[PedestrianSpec], rules: PeopleParameters, random: np.random.Generator
) -> tuple[PedestrianSpec, ...]:
    """Return the people with their manners; who walks in a group has its speed."""
    common: dict[str, float | str] = {"respawn": "random"} if rules.respawn else {}
    if rules.pause_probability > 0.0:
        common |= {"pause_probability": rules.pause_probability, "pause_time": rules.pause_time}
    types, paces = random.random(len(people)), _speed_shares(people, rules, random)
    return tuple(
        replace(
            person,
            desired_speed=person.desired_speed * pace,
            behaviour={**person.behaviour, **common, **_person_type(share, rules)},
        )
        for person, share, pace in zip(people, types, paces, strict=True)
    )


def _speed_shares(
    people: Sequence[PedestrianSpec], rules: PeopleParameters, random: np.random.Generator
) -> list[float]:
    """Return everybody's share of the mean speed."""
    drawn = 1.0 + rules.speed_spread * np.clip(random.standard_normal(len(people)), -FARTHEST, FARTHEST)
    heads = {
        person.behaviour["group"]: number
        for number, person in reversed(list(enumerate(people)))
        if "group" in person.behaviour
    }
    return [float(drawn[heads.get(person.behaviour.get("group", ""), number)]) for number, person in enumerate(people)]


def _person_type(share: float, rules: PeopleParameters) -> dict[str, str]:
    if share < rules.children:
        return {"type": "child"}
    return {"type": "elder"} if share < rules.children + rules.elders else {}
