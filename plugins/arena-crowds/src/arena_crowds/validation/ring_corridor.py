"""A closed corridor to measure the model in: density stays what it was at the start."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import PedestrianModel, PedestrianSpec, World
from arena_crowds.validation.floor_plan import Area, floor_world, make_scenario
from arena_crowds.validation.walks import simulate_walks

Floats = NDArray[np.float64]

LENGTH, HEIGHT, WIDTH = 16.0, 6.0, 1.8  # m, outer sides of the ring and width of the corridor: that of the experiment
# the middle of a straight, as long as in the experiment
MEASURED = Area(LENGTH / 2 - 2.0, LENGTH / 2 + 2.0, 0.0, WIDTH)
RATE = 10.0  # 1/s
SPEED_SPREAD = 0.2  # m/s, standard deviation of desired speeds (Weidmann 1993: 0.26 over all ages)


def ring_world() -> World:
    """Return a rectangular ring, its inner lower left corner at the origin."""
    straights = (Area(0, LENGTH, 0, WIDTH), Area(0, LENGTH, HEIGHT - WIDTH, HEIGHT))
    return floor_world("ring", (*straights, Area(0, WIDTH, 0, HEIGHT), Area(LENGTH - WIDTH, LENGTH, 0, HEIGHT)))


def spread_people(number: int, free_speed: float, radius: float, seed: int) -> tuple[PedestrianSpec, ...]:
    """Spread people along the corridor, each in a lane of its own; all walk round counter-clockwise."""
    random = np.random.default_rng(seed)
    specs = []
    for k in range(number):
        corners = _lane_corners(random.uniform(radius + 0.05, WIDTH - radius - 0.05))
        sides = np.roll(corners, -1, axis=0) - corners
        lengths = np.abs(sides).sum(axis=1)
        way = (k + 0.5 * random.random()) * lengths.sum() / number
        side = int(np.searchsorted(np.cumsum(lengths), way, side="right"))
        place = corners[side] + sides[side] / lengths[side] * (way - lengths[:side].sum())
        speed = max(random.normal(free_speed, SPEED_SPREAD), 0.3)
        specs.append(PedestrianSpec(k, place, np.roll(corners, -side - 1, axis=0), speed, radius))
    return tuple(specs)


def _lane_corners(inset: float) -> Floats:
    """Return the corners (4, 2) of a lane this far inside the outer wall."""
    return np.array(
        [(inset, inset), (LENGTH - inset, inset), (LENGTH - inset, HEIGHT - inset), (inset, HEIGHT - inset)]
    )


def walk_ring(model: PedestrianModel, specs: tuple[PedestrianSpec, ...], seconds: float, settling: float) -> Floats:
    """Return positions (T, P, 2) at RATE, after a time for the crowd to settle."""
    positions = simulate_walks(
        model, [make_scenario(ring_world(), specs, settling + seconds, "ring")], settling + seconds, RATE
    )
    return positions[round(settling * RATE) :, 0, : len(specs)]
