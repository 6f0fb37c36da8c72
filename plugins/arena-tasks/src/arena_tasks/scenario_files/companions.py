"""Several people that a file states as one."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arena_core import PedestrianSpec

MOST_COMPANIONS = 10_000
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


def with_companions(person: PedestrianSpec, count: int) -> list[PedestrianSpec]:
    """Return a person and ``count`` - 1 others like it close around, who do not touch."""
    return [
        replace(
            person,
            position_xy=person.position_xy + _spiral_position(k, person.radius),
            behaviour=dict(person.behaviour),
        )
        for k in range(count)
    ]


def number_people(people: Iterable[PedestrianSpec]) -> tuple[PedestrianSpec, ...]:
    """Return the people with ids in their order, from 0."""
    return tuple(replace(person, id=number) for number, person in enumerate(people))


def _spiral_position(number: int, radius: float) -> NDArray[np.float64]:
    """Return where the ``number``-th stands around the first: on a sunflower's spiral, in which discs do not touch."""
    angle = number * GOLDEN_ANGLE
    return 2.2 * radius * math.sqrt(number) * np.array((math.cos(angle), math.sin(angle)))
