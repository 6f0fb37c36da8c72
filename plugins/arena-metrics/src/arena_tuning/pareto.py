"""Points that are worth something by several objectives, each better where it is higher: fronts, and an order.

Non-dominated sorting and crowding distances (Deb et al. 2002, NSGA-II).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

Point = Sequence[float]


def dominates(one: Point, other: Point) -> bool:
    """Return whether a point is as good as another one by each objective, and better by one of them."""
    return all(a >= b for a, b in zip(one, other, strict=True)) and any(a > b for a, b in zip(one, other, strict=True))


def front_of(points: Sequence[Point]) -> list[int]:
    """Return the places of the points that no other one dominates, in order."""
    return [place for place, point in enumerate(points) if not any(dominates(other, point) for other in points)]


def rank(points: Sequence[Point]) -> list[int]:
    """Return the places of points, the best first: front by front, within one those that stand apart first; those that
    are worth the same in order. Points that are worth nothing known (no objective at all) come last.
    """
    left, found = [place for place, point in enumerate(points) if len(point)], list[int]()
    while left:
        front = [left[place] for place in front_of([points[place] for place in left])]
        apart = _distances([points[place] for place in front])
        found += [front[k] for k in sorted(range(len(front)), key=lambda k: -apart[k])]
        left = [place for place in left if place not in front]
    return [*found, *(place for place, point in enumerate(points) if not len(point))]


def _distances(points: Sequence[Point]) -> list[float]:
    """Return of each point of a front how far its neighbours lie apart, summed over the objectives, as shares of their
    spans; infinite at the ends.
    """
    found = [0.0] * len(points)
    for objective in range(len(points[0])):
        order = sorted(range(len(points)), key=lambda place: points[place][objective])
        low, high = points[order[0]][objective], points[order[-1]][objective]
        if high <= low:
            continue
        found[order[0]] = found[order[-1]] = math.inf
        for before, place, after in zip(order, order[1:], order[2:], strict=False):
            found[place] += (points[after][objective] - points[before][objective]) / (high - low)
    return found
