"""How difficult a map is to drive in: figures that are pure functions of its grid and a robot's radius.

Distance to obstacles, visibility, characteristic dimension and tortuosity are those of Perille, Truong, Xiao and Stone,
Benchmarking Metric Ground Navigation, SSRR 2020, taken over all places of the robot instead of the cells of one path.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from arena_core import FREE, OCCUPIED, ConfigurationError, OccupancyGrid, Pose
from arena_kernels.distance import distance_field
from arena_kernels.grids import stack_grids
from arena_kernels.raycast import make_beams, scan_grids
from arena_worlds.commands.grid_paths import DIAGONAL, STRAIGHT, UNREACHED, climb_clearance, join_levels, path_lengths
from arena_worlds.widths import BESIDE_WALLS, largest_part, widths_of

VIEWPOINTS, BEAMS, SIGHT = 500, 72, 10.0  # places that are looked from, in how many directions, m
STARTS, AWAY = 12, 2.0  # places that ways are measured from, m to where they end at least
MARKS = 200  # places that are joined by their roomiest ways


@dataclass(frozen=True, slots=True)
class Measures:
    """What makes a map difficult, over the places of a robot: all cells, one connected region, where its centre can be.

    From ``free`` on over the largest free region, as robots of any size see it.
    """

    room: float = field(metadata={"unit": "m2", "text": "area of the robot's places"})
    mean_clearance: float = field(metadata={"unit": "m", "text": "mean distance to the nearest obstacle"})
    narrowest_passage: float = field(
        metadata={"unit": "m", "text": "narrowest passage that all places together cannot avoid"}
    )
    passage: float = field(
        metadata={"unit": "m", "text": "narrowest place of the widest way, mean over pairs of places"}
    )
    tortuosity: float = field(
        metadata={"unit": "-", "text": "length of the way by the straight distance, mean over pairs of places"}
    )
    visibility: float = field(metadata={"unit": "m", "text": f"mean free sight, at most {SIGHT:g} m"})
    characteristic_dimension: float = field(metadata={"unit": "m", "text": "free sight along the tightest axis, mean"})

    free: float = field(metadata={"unit": "m2", "text": "area of the largest free region, whatever drives there"})
    width_p10: float = field(
        metadata={"unit": "m", "text": "width of its ways: 10 % of the ridge of the distance field are narrower"}
    )
    width: float = field(metadata={"unit": "m", "text": "width of its ways: median"})
    width_p90: float = field(metadata={"unit": "m", "text": "width of its ways: 10 % are wider"})
    beside_walls: float = field(
        metadata={"unit": "-", "text": f"share of it nearer than {BESIDE_WALLS:g} m to an obstacle"}
    )

    def rows(self) -> list[tuple[str, float, str, str]]:
        """Return name, value, unit and meaning of each figure."""
        return [(f.name, getattr(self, f.name), f.metadata["unit"], f.metadata["text"]) for f in fields(self)]


def measures_of(grid: OccupancyGrid, robot_radius: float) -> Measures:
    """Return how difficult a map is for a robot; what is unknown or outside counts as blocked.

    Raises ConfigurationError where the robot fits nowhere.
    """
    free = np.pad((grid.data >= 0) & (grid.data < grid.occupied_from), 1)
    clearance = distance_field(~free, grid.resolution) - np.float32(0.5 * grid.resolution)
    room = largest_part(clearance >= robot_radius)
    if not room.any():
        raise ConfigurationError(
            f"robot_radius is {robot_radius:g}: no free space for the robot; allowed: "
            f"up to {max(clearance.max(), 0.0):g} m in this map"
        )
    cells = np.flatnonzero(room)
    narrowest, passage = _passage_widths(clearance, room, cells)
    visibility, tightest = _sight_distances(free, room, grid.resolution)
    widths = widths_of(free, grid.resolution)
    return Measures(
        room=len(cells) * grid.resolution**2,
        mean_clearance=float(clearance[room].mean(dtype=np.float64)),
        narrowest_passage=narrowest,
        passage=passage,
        tortuosity=_path_tortuosity(room, cells, grid.resolution),
        visibility=visibility,
        characteristic_dimension=tightest,
        free=widths.free,
        width_p10=widths.low,
        width=widths.middle,
        width_p90=widths.high,
        beside_walls=widths.tight,
    )


def _spread_evenly(cells: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return up to ``count`` of the cells, evenly spread over them."""
    return cells[np.linspace(0, len(cells) - 1, min(count, len(cells))).astype(np.int64)]


def _passage_widths(
    clearance: NDArray[np.float32], room: NDArray[np.bool_], cells: NDArray[np.int64]
) -> tuple[float, float]:
    """Return the width of the narrowest place of the roomiest ways between the middles of places: the least, and the
    mean; m.

    In a map of one place, that place's width.
    """
    inside = np.where(room, clearance, np.float32(-1.0))
    tops = climb_clearance(inside, _spread_evenly(cells, MARKS))
    order = cells[np.argsort(-clearance.ravel()[cells], kind="stable")]
    least, mean = join_levels(inside, order, np.bincount(tops, minlength=room.size))
    if math.isnan(least):
        least = mean = float(inside.max())
    return 2.0 * least, 2.0 * mean


def _path_tortuosity(room: NDArray[np.bool_], cells: NDArray[np.int64], resolution: float) -> float:
    """Return way by straight distance, both in steps to 8 neighbours, to all cells some distance
    away; 1 where there are none.
    """
    rows, columns = np.nonzero(room)
    table, ratios = room.view(np.uint8), []
    for start in _spread_evenly(cells, STARTS).tolist():
        row, column = divmod(start, room.shape[1])
        dr, dc = np.abs(rows - row), np.abs(columns - column)
        straight = STRAIGHT * np.maximum(dr, dc) + (DIAGONAL - STRAIGHT) * np.minimum(dr, dc)
        lengths = path_lengths(table, row, column)[rows, columns]
        far = (straight * resolution >= AWAY * STRAIGHT) & (lengths < UNREACHED)
        ratios.append(lengths[far] / straight[far])
    joined = np.concatenate(ratios)
    return float(joined.mean()) if len(joined) else 1.0


def _sight_distances(free: NDArray[np.bool_], room: NDArray[np.bool_], resolution: float) -> tuple[float, float]:
    """Return how far one sees from the robot's places, mean over all directions, and mean of the tightest axis; m."""
    grid = OccupancyGrid(np.where(free, np.int8(FREE), np.int8(OCCUPIED)), resolution, Pose(0.0, 0.0))
    places = grid.positions(_spread_evenly(np.argwhere(room), VIEWPOINTS))
    ranges = np.empty((len(places), BEAMS), np.float32)
    sensors = np.column_stack((places, np.zeros(len(places))))
    stack, _ = stack_grids([grid])
    scan_grids(
        stack, np.zeros(len(places), np.int64), sensors, make_beams(-math.pi, 2 * math.pi / BEAMS, BEAMS, SIGHT), ranges
    )
    seen = np.minimum(ranges, SIGHT).astype(np.float64)
    axes = seen[:, : BEAMS // 2] + seen[:, BEAMS // 2 :]
    return float(seen.mean()), float(axes.min(axis=1).mean())
