"""What speaks for and against each cell of a map that scans make: log odds after OctoMap (Hornung et al. 2013).

Posts and corners are grazed: their outermost cells are hit by one scan and seen through by the next. If the last scan
decided, gaps would open and close, and paths with them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core.parameters import Positive
from arena_kernels.compiled import compiled
from arena_navigation.columns import X, Y
from arena_navigation.local_map.marks import NEVER, MarkedCells, MarkingRange, PlacedScan, mark_hits, seen_through


@dataclass(frozen=True, slots=True)
class LogOddsUpdate:
    """Log odds that a scan adds for a ``hit`` and takes off for a ``miss``, held within -``least`` .. ``most``."""

    hit: Positive
    miss: Positive
    most: Positive
    least: Positive


def update_log_odds(
    odds: NDArray[np.float32], cells: MarkedCells, beams: PlacedScan, reach: MarkingRange, evidence: LogOddsUpdate
) -> None:
    """Take one scan into ``odds`` (H, W), NEVER where nothing was ever hit; a cell that it hits is not seen through."""
    mark_hits(cells, beams, reach)
    _update_log_odds(
        odds,
        cells,
        beams,
        reach,
        (evidence.hit, evidence.miss, evidence.most, evidence.least),
    )


@compiled
def _update_log_odds(
    odds: NDArray[np.float32],
    cells: MarkedCells,
    beams: PlacedScan,
    reach: MarkingRange,
    evidence: tuple[float, float, float, float],
) -> None:
    hit, miss, most, least = evidence
    far = max(reach.marking, reach.clearing) + cells.resolution
    first_row = max(math.floor((beams.sensor[Y] - far) / cells.resolution) - cells.row0, 0)
    last_row = min(math.floor((beams.sensor[Y] + far) / cells.resolution) - cells.row0, odds.shape[0] - 1)
    first_column = max(math.floor((beams.sensor[X] - far) / cells.resolution) - cells.column0, 0)
    last_column = min(math.floor((beams.sensor[X] + far) / cells.resolution) - cells.column0, odds.shape[1] - 1)
    now = np.float32(beams.stamp)
    for row in range(first_row, last_row + 1):
        y = (cells.row0 + row + 0.5) * cells.resolution
        for column in range(first_column, last_column + 1):
            if cells.hit_at[row, column] == NEVER:
                continue
            x = (cells.column0 + column + 0.5) * cells.resolution
            if math.hypot(x - beams.robot[X], y - beams.robot[Y]) < reach.body:
                odds[row, column], cells.hit_at[row, column] = NEVER, NEVER
            elif cells.hit_at[row, column] == now:
                odds[row, column] = (
                    min(max(odds[row, column], -least) + hit, most) if odds[row, column] > NEVER else hit
                )
            elif seen_through(x - beams.sensor[X], y - beams.sensor[Y], 0.5 * cells.resolution, beams, reach.clearing):
                odds[row, column] = max(odds[row, column] - miss, -least)
