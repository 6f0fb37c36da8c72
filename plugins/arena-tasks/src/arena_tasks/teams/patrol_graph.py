"""The graph over a map that is patrolled: made from its free space, or read from a configuration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components, shortest_path

from arena_core import ConfigurationError, ImpossibleScenario, OccupancyGrid
from arena_core.parameters import Positive
from arena_core.tasks import PatrolGraph
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.random.route import find_route

Points = NDArray[np.float64]

APART = 0.5  # share of the spacing that places keep from one another
REACH = 1.8  # spacings up to which places that see each other are neighbours


@dataclass(frozen=True, slots=True)
class GraphOfFreeSpace:
    """A key and function for ``grid.derive``: places all over the largest free region, about ``spacing`` m apart and
    ``clearance`` m off walls, each in the widest spot of its square of the map. Neighbours see each other; what walls
    then still part is joined by the way round them.
    """

    spacing: Positive
    clearance: float

    def __call__(self, grid: OccupancyGrid) -> PatrolGraph:
        """Return the graph; of no places where there is no room."""
        places = self._places(grid)
        lengths = np.full((len(places), len(places)), np.inf)
        space = grid.derive(FreeSpace)
        for one, two in combinations(range(len(places)), 2):
            away = float(np.hypot(*(places[two] - places[one])))
            if away <= REACH * self.spacing and space.is_visible(places[one], places[two], self.clearance):
                lengths[one, two] = lengths[two, one] = away
        self._join(grid, places, lengths)
        return PatrolGraph(places, lengths)

    def _places(self, grid: OccupancyGrid) -> Points:
        space = grid.derive(FreeSpace)
        labels = space.regions(self.clearance)
        if not labels.any():
            return np.zeros((0, 2))
        region = labels == np.bincount(labels[labels > 0]).argmax()
        cells = np.argwhere(region)
        side = max(round(self.spacing / grid.resolution), 1)
        squares = cells // side
        off = np.abs(cells - squares * side - (side - 1) / 2).max(axis=1)  # of the widest spots the one in the middle
        width = np.minimum(space.clearance[tuple(cells.T)], self.spacing / 2)
        order = np.lexsort((off, -width))
        _, first = np.unique(squares[order], axis=0, return_index=True)
        candidates = grid.positions(cells[order[np.sort(first)]]).reshape(-1, 2)
        chosen: list[Points] = []
        for place in candidates:
            if all(np.hypot(*(place - other)) >= APART * self.spacing for other in chosen):
                chosen.append(place)
        return np.array(chosen).reshape(-1, 2)

    def _join(self, grid: OccupancyGrid, places: Points, lengths: Points) -> None:
        """Join the parts of the graph where they are nearest, until there is one."""
        while len(places):
            parts, labels = connected_components(np.isfinite(lengths), directed=False)
            if parts == 1:
                return
            away = np.hypot(*(places[:, None] - places).transpose(2, 0, 1))
            away[labels[:, None] == labels] = np.inf
            one, two = divmod(int(away.argmin()), len(places))
            way = find_route(grid, self.clearance, places[one], places[two])
            lengths[one, two] = lengths[two, one] = np.hypot(*np.diff(way, axis=0).T).sum()


def read_graph(told: Mapping[str, Any], key: str) -> PatrolGraph:
    """Return the graph of ``{places: [[x, y], ...], edges: [[0, 1], ...]}``, m in ``map``; raise ConfigurationError for
    any other, and for one whose places are not all connected.
    """
    if not isinstance(told, Mapping) or sorted(told) != ["edges", "places"]:
        raise ConfigurationError(f"{key} is {told!r}; allowed: null, or a mapping with places and edges")
    try:
        places, edges = np.array(told["places"], np.float64), np.array(told["edges"])
    except (TypeError, ValueError):
        places, edges = np.zeros(0), np.zeros(0)
    if places.ndim != 2 or places.shape[1] != 2 or len(places) < 2 or not np.isfinite(places).all():
        raise ConfigurationError(f"{key}.places is no list of two places or more; allowed: [[x, y], ...] in m")
    if edges.ndim != 2 or edges.shape[1] != 2 or edges.dtype.kind != "i":
        raise ConfigurationError(f"{key}.edges is no list of pairs; allowed: [[0, 1], ...], numbers of places")
    if (edges < 0).any() or (edges >= len(places)).any() or (edges[:, 0] == edges[:, 1]).any():
        raise ConfigurationError(f"{key}.edges join what is no place; allowed: two of 0 .. {len(places) - 1}")
    lengths = np.full((len(places), len(places)), np.inf)
    away = np.hypot(*(places[edges[:, 0]] - places[edges[:, 1]]).T)
    lengths[edges[:, 0], edges[:, 1]] = lengths[edges[:, 1], edges[:, 0]] = away
    if connected_components(np.isfinite(lengths), directed=False)[0] > 1:
        raise ConfigurationError(f"{key}.edges leave places apart; allowed: a way from each place to each other one")
    return PatrolGraph(places, lengths)


def check_places(name: str, places: Points, grid: OccupancyGrid, clearance: float) -> None:
    """Raise ImpossibleScenario where a robot has no room at a place."""
    lacking = np.flatnonzero(~grid.derive(FreeSpace).has_room(places, clearance))
    if len(lacking):
        x, y = places[lacking[0]]
        raise ImpossibleScenario(
            f"{name}: place {lacking[0]} of the graph has no room at ({x:.2f}, {y:.2f}); allowed: places "
            f"{clearance:.2f} m and more off walls"
        )


def ways_between(graph: PatrolGraph) -> tuple[Points, Points]:
    """Return the length of the shortest way along the graph between all places, (V, V) m, and the place ahead of the
    last one on it, (V, V).
    """
    lengths, ahead = shortest_path(np.where(np.isfinite(graph.lengths), graph.lengths, 0.0), return_predecessors=True)
    return lengths, ahead
