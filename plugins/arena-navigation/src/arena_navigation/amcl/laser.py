"""The filter's three sensor models, one of which a localiser chooses; names as in ROS amcl."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np

from arena_core import LaserScan, OccupancyGrid
from arena_kernels.compiled import TypedDispatch
from arena_kernels.grids import GridStack, stack_grids
from arena_navigation.amcl.beams import ExpectedWalls, measured_ranges, predict_ranges, rays_of, scan_layout
from arena_navigation.amcl.filter import (
    EndpointModel,
    ParticleCloud,
    ScanInputs,
    Update,
    filter_scan,
    filter_update_by_ranges,
)
from arena_navigation.amcl.ranges import Mixture, View
from arena_navigation.amcl.sensor import Distances, LikelihoodField
from arena_navigation.amcl.skipping import NearMap, Skipping

LaserModelType = Literal["beam", "likelihood_field", "likelihood_field_prob"]
KEEP_ALL = Skipping(np.empty(0, np.uint8), 0.0, 1.0)

_room = lru_cache(maxsize=8)(lambda beams: np.empty(beams, np.float32))


@dataclass(frozen=True, slots=True)
class BeamSkipping:
    """When a beam fits: its end lies ``distance`` m or less from an obstacle. It is skipped where it does for no more
    than ``threshold``.

    All are used where ``error_threshold`` of them would be skipped.
    """

    distance: float
    threshold: float
    error_threshold: float


class ScanView(NamedTuple):
    """A scan, the shortest and the longest range that count (m), and the walls it should show."""

    scan: LaserScan
    limits: tuple[float, float]
    walls: ExpectedWalls


@dataclass(slots=True)
class LaserModel:
    """A sensor model with its parameters; ``skipping`` None uses every beam."""

    kind: LaserModelType
    mixture: Mixture
    max_dist: float
    distances: Distances
    beam_weight: float
    skipping: BeamSkipping | None
    _tables: tuple[OccupancyGrid, float, EndpointModel] | None = None
    _filter_scan: Callable[..., None] = field(default_factory=lambda: TypedDispatch(filter_scan))

    def update(
        self,
        cloud: ParticleCloud,
        grid: OccupancyGrid,
        update: Update,
        view: ScanView,
    ) -> None:
        """Run one update of the filter by a scan."""
        scan, limits, walls = view
        if self.kind == "beam":
            least = predict_ranges(scan, walls) - walls.short_by if walls.short_by else 0.0
            ranges, explained = measured_ranges(scan, *limits, least)
            filter_update_by_ranges(cloud, update, ranges, explained, self._make_view(grid, scan, limits[1]))
        else:
            ranges = np.ascontiguousarray(scan.ranges, np.float32)
            inputs = ScanInputs(ranges, limits, walls, scan_layout(scan))
            self._filter_scan(cloud, update, inputs, self._tables_of(grid, limits[1]))

    def _tables_of(self, grid: OccupancyGrid, max_range: float) -> EndpointModel:
        if self._tables is None or self._tables[0] is not grid or self._tables[1] != max_range:
            model = EndpointModel(grid.derive(self._likelihood_field(max_range)), self._skipping_rule(grid))
            self._tables = grid, max_range, model
        return self._tables[2]

    def _likelihood_field(self, max_range: float) -> LikelihoodField:
        mixture, product = self.mixture, self.kind == "likelihood_field_prob"
        return LikelihoodField(
            product,
            mixture.z_hit,
            mixture.z_rand,
            mixture.sigma_hit,
            self.max_dist,
            self.distances,
            self.beam_weight,
            max_range,
        )

    def _skipping_rule(self, grid: OccupancyGrid) -> Skipping:
        if self.skipping is None:
            return KEEP_ALL
        near = grid.derive(NearMap(self.skipping.distance, self.distances))
        return Skipping(near, self.skipping.threshold, self.skipping.error_threshold)

    def _make_view(self, grid: OccupancyGrid, scan: LaserScan, max_range: float) -> View:
        mount = float(scan.mount.x), float(scan.mount.y), float(scan.mount.theta)
        return View(grid.derive(own_frame), rays_of(scan, max_range), mount, self.mixture, _room(len(scan.ranges)))


def own_frame(grid: OccupancyGrid) -> GridStack:
    """Return a grid for the ray caster in its own frame, where the particles live; for ``grid.derive``."""
    stack, _ = stack_grids([grid])
    return stack._replace(origins=np.zeros((1, 3)), rotations=np.array(((1.0, 0.0),)))
