"""Outlines against walls and people, held against shapely."""

import math

import numpy as np
import pytest
from shapely.affinity import rotate, translate
from shapely.geometry import Point, Polygon

from arena_core import Footprint
from arena_reference.body import Nearby, Walkers, body_of, meets_nobody, stands_free
from arena_reference.terrain import Terrain

CORNERS = ((0.3, -0.2), (0.3, 0.2), (-0.1, 0.2), (-0.1, -0.2))
EVERYBODY = np.arange(1.0)


def test_people_are_met_where_outlines_touch() -> None:
    random, body = np.random.default_rng(1), body_of(Footprint.polygon(CORNERS))
    for _ in range(300):
        x, y, theta = random.uniform(-0.5, 0.5, 3) * (1, 1, 6)
        radius = random.uniform(0.1, 0.4)
        outline = translate(rotate(Polygon(CORNERS), theta, origin=(0, 0), use_radians=True), x, y)
        gap = outline.distance(Point(0.1, 0.2)) - radius
        walker = Walkers(np.full((2, 1, 2), (0.1, 0.2)), np.array((radius,)), 0.0, 1.0)
        if abs(gap - 0.05) > 1e-6:
            assert meets_nobody(Nearby(walker, EVERYBODY, 0.3, 0.05), body, (x, y, theta)) == (gap > 0.05)


def test_people_walk_between_two_instants() -> None:
    body = body_of(Footprint.circle(0.2))
    walker = Walkers(np.array((((0.0, 0.0),), ((2.0, 0.0),))), np.array((0.3,)), 5.0, 1.0)
    assert not meets_nobody(Nearby(walker, EVERYBODY, 5.5, 0.0), body, (1.0, 0.0, 0.0))
    assert meets_nobody(Nearby(walker, EVERYBODY, 5.0, 0.0), body, (1.0, 0.0, 0.0))


def test_who_is_absent_is_met_by_nobody() -> None:
    walker = Walkers(np.full((2, 1, 2), np.nan), np.array((0.3,)), 0.0, 1.0)
    assert meets_nobody(Nearby(walker, EVERYBODY, 0.0, 0.0), body_of(Footprint.circle(0.2)), (0.0, 0.0, 0.0))


@pytest.mark.parametrize(("theta", "free"), [(0.0, True), (math.pi / 2, False)])
def test_a_long_body_fits_one_way_only(theta: float, free: bool) -> None:
    rows = (np.arange(200) + 0.5) * 0.01
    distance = np.repeat(np.minimum(rows, 2.0 - rows)[:, None] - 0.75, 200, axis=1).clip(0).astype(np.float32)
    corridor = Terrain(distance, 0.01, 0.0, 0.0, 1.0, 0.0, 0.0)  # 0.5 m wide, along x
    body = body_of(Footprint.polygon(CORNERS))
    assert stands_free(corridor, body, (1.0, 1.0, theta), 0.01) == free
