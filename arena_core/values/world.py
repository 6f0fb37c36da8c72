"""What stands still (grids, obstacles, worlds) and who walks in it (pedestrians)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core.base.frozen import seal_array
from arena_core.values.geometry import FloatArray, Pose
from arena_core.values.parameters import Positive

OCCUPIED = 100
FREE = 0
UNKNOWN = -1

ABSENT = 0  # the state of a person who is not, not yet or no longer in the world

Derived = TypeVar("Derived")


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyGrid:
    """A map in nav_msgs layout: ``data[row, column]``, row 0 at the bottom, values -1 unknown, 0 free .. 100 occupied.

    Attributes:

    - ``data``: (H, W) int8, read-only.
    - ``resolution``: the side of a cell, m.
    - ``origin``: the pose in ``map`` of the lower left *corner* of cell (0, 0).
    - ``occupied_from``: the value from which on a cell counts as occupied.

    ```python
    grid = OccupancyGrid(np.zeros((20, 40), np.int8), 0.05, Pose(0.0, 0.0))
    assert grid.cells((1.98, 0.02)).tolist() == [0, 39]  # row, column
    ```
    """

    data: NDArray[np.int8]
    resolution: float
    origin: Pose
    occupied_from: int = 65
    _derived: dict[Any, Any] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "data", seal_array(np.asarray(self.data, dtype=np.int8)))

    def __reduce__(self) -> tuple[Any, ...]:
        return OccupancyGrid, (self.data, self.resolution, self.origin, self.occupied_from)

    def __deepcopy__(self, memo: dict[int, Any]) -> OccupancyGrid:
        """Return this one: a map never changes."""
        return self

    @property
    def occupied(self) -> NDArray[np.bool_]:
        """Return which cells are occupied, shape (H, W)."""
        return self.derive(_occupied_cells)

    def derive(self, function: Callable[[OccupancyGrid], Derived]) -> Derived:
        """Return ``function(self)``, computed once for this grid (distance field, inflated cost, ...)."""
        if function not in self._derived:
            self._derived[function] = function(self)
        return self._derived[function]  # type: ignore[no-any-return]

    def cells(self, positions_xy: ArrayLike) -> NDArray[np.int64]:
        """Return (row, column) of positions in ``map``, shape (..., 2); they may lie outside the grid."""
        delta = np.asarray(positions_xy, dtype=np.float64) - (self.origin.x, self.origin.y)
        c, s = np.cos(self.origin.theta), np.sin(self.origin.theta)
        x = c * delta[..., 0] + s * delta[..., 1]
        y = -s * delta[..., 0] + c * delta[..., 1]
        return np.floor(np.stack((y, x), axis=-1) / self.resolution).astype(np.int64)

    def positions(self, cells: ArrayLike) -> FloatArray:
        """Return the centres in ``map`` of cells (row, column), shape (..., 2)."""
        row_column = (np.asarray(cells, dtype=np.float64) + 0.5) * self.resolution
        y, x = row_column[..., 0], row_column[..., 1]
        c, s = np.cos(self.origin.theta), np.sin(self.origin.theta)
        return np.stack((self.origin.x + c * x - s * y, self.origin.y + s * x + c * y), axis=-1)

    def contains(self, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Tell which cells (..., 2) lie inside the grid."""
        inside = (cells >= 0) & (cells < np.array(self.data.shape))
        return np.asarray(inside.all(axis=-1))


def _occupied_cells(grid: OccupancyGrid) -> NDArray[np.bool_]:
    return seal_array(grid.data >= grid.occupied_from)


def free_area(grid: OccupancyGrid) -> float:
    """Return the area of a grid's largest connected free region, over the 4 neighbours, m2; meant for
    ``grid.derive(free_area)``.

    Each free cell takes the least number in its run of a row, then of a column, until nothing changes.
    """
    free = (grid.data >= 0) & (grid.data < grid.occupied_from)
    labels, before = np.arange(1, free.size + 1).reshape(free.shape), None
    while before is None or (labels != before).any():
        before = labels
        labels = _least_of_runs(_least_of_runs(labels, free).T, free.T).T
    return float(np.bincount(labels[free], minlength=1).max()) * grid.resolution**2


def _least_of_runs(labels: NDArray[np.int64], free: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the labels (H, W) with the least one of each run of equal ``free`` along a row in all its cells."""
    begins = np.ones(free.shape, np.bool_)
    begins[:, 1:] = free[:, 1:] != free[:, :-1]
    starts = np.flatnonzero(begins)
    least = np.minimum.reduceat(labels.ravel(), starts)
    return np.repeat(least, np.diff(starts, append=free.size)).reshape(free.shape)


@dataclass(frozen=True, slots=True, eq=False)
class Obstacle:
    """A static obstacle that is on no map: a disc at ``vertices_xy[0]``, or a simple polygon (radius 0).

    ``vertices_xy`` has shape (1, 2) or (V, 2), m, frame ``map``.
    """

    vertices_xy: FloatArray
    radius: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Furniture:
    """A piece of furniture, on no map: its ``kind``, its ``pose`` in ``map``, and the upright solids that it is made
    of, in its own frame.

    ``boxes`` (N, 7) are x, y (m), yaw (rad), length, width, bottom and top (m); ``cylinders`` (M, 5) are x, y, radius,
    bottom and top, m.
    """

    kind: str
    pose: Pose
    boxes: FloatArray
    cylinders: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class World:
    """A static environment, as a ``WorldSource`` gives it.

    Attributes:

    - ``name``: what tables call it.
    - ``grid``: its map.
    - ``known``: whether the robot is given that map.
    - ``reference_xy``: (M, 2), m, a way through that comes with the world, None where there is none; only metrics see
      it.
    - ``movers``: people who belong to the world and move by a timetable; tasks take them over where they say so.
    - ``furniture``: pieces that are on no map.

    ```python
    grid = OccupancyGrid(np.zeros((100, 100), np.int8), 0.05, Pose(0.0, 0.0))
    world = World("hall", grid, known=False)
    assert not world.grid.occupied.any()
    ```
    """

    name: str
    grid: OccupancyGrid
    known: bool = True
    reference_xy: FloatArray | None = None
    movers: tuple[PedestrianSpec, ...] = ()
    furniture: tuple[Furniture, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class PedestrianSpec:
    """How one person starts and where it goes: the input of a pedestrian model.

    ``waypoints_xy`` has shape (K, 2), m, walked in a loop; none means standing. ``desired_speed`` in m/s, ``radius`` in
    m. ``behaviour`` carries what a model may use beyond that (factors of forces, chances of social states). ``stamps``
    (K,), s, rising from 0, is when it is at each waypoint, again every ``stamps[-1]`` s; None where the model decides
    that.
    """

    id: int
    position_xy: FloatArray
    waypoints_xy: FloatArray
    desired_speed: float
    radius: float
    behaviour: dict[str, float | str] = field(default_factory=dict)
    stamps: FloatArray | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Pedestrians:
    """The people of one world at one instant: ids (P,), positions (P, 2) m, velocities (P, 2) m/s, radii (P,) m, states
    (P,).

    Who is ABSENT keeps place and id; position and velocity are then NaN.
    """

    ids: NDArray[np.int32]
    positions: FloatArray
    velocities: FloatArray
    radii: FloatArray
    states: NDArray[np.int8]


@dataclass(frozen=True, slots=True, eq=False)
class Crowd:
    """The people of N worlds in P slots each; slots from ``counts[k]`` on are empty (parked at NaN).

    A person who is not (yet, or any more) in the world keeps slot and id: position and velocity are NaN, the state is
    ABSENT. counts (N,) int32, ids (N, P) int32, positions (N, P, 2) m, velocities (N, P, 2) m/s, radii (N, P) m, states
    (N, P) int8.
    """

    counts: NDArray[np.int32]
    ids: NDArray[np.int32]
    positions: FloatArray
    velocities: FloatArray
    radii: FloatArray
    states: NDArray[np.int8]

    def world(self, slot: int) -> Pedestrians:
        """Return copies of the people of world ``slot``."""
        n = int(self.counts[slot])
        return Pedestrians(
            self.ids[slot, :n].copy(),
            self.positions[slot, :n].copy(),
            self.velocities[slot, :n].copy(),
            self.radii[slot, :n].copy(),
            self.states[slot, :n].copy(),
        )

    def take(self, slots: NDArray[np.int64]) -> Crowd:
        """Return copies of the people of these worlds (K,)."""
        return Crowd(*(getattr(self, name)[slots] for name in self.__slots__))


@dataclass(frozen=True, slots=True)
class Gait:
    """How people walk, as a lidar at the height of their shins sees them: two discs of ``leg_radius`` m, in step with
    the way covered.

    The legs' axes are ``stance_width`` m apart across the way where a person stands, ``step_width`` from
    ``step_width_from`` m/s on. A step is ``walk_ratio`` m long for each step a minute; along the way the legs are at
    most ``apart`` of it from each other. They take up another speed and direction in ``settling`` s.
    """

    leg_radius: Positive
    stance_width: Positive
    step_width: Positive
    step_width_from: Positive
    walk_ratio: Positive
    apart: Positive
    settling: Positive


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """A global path in ``map``, as ROS's ``nav_msgs/Path``.

    Attributes:

    - ``poses``: (M, 3) of x, y (m) and the heading along the path (rad), start first, goal last.

    ```python
    assert Path(np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]])).length == 3.0
    ```
    """

    poses: FloatArray

    @property
    def length(self) -> float:
        """Return the length of the polyline, m."""
        return float(np.hypot(*np.diff(self.poses[:, :2], axis=0).T).sum())


@dataclass(frozen=True, slots=True, eq=False)
class Costmap:
    """A cost grid after costmap_2d, whose rows lie along the x axis of ``map``.

    Attributes:

    - ``costs``: (H, W) uint8, row 0 at the bottom: LETHAL 254, INSCRIBED 253, FREE 0, between them inflation.
    - ``distance``: (H, W) float32, from each cell's centre to the nearest lethal cell's centre, m; inf without one.
    - ``resolution``: the side of a cell, m.
    - ``origin_xy``: (2,), the position in ``map`` of the lower left corner, m.

    ```python
    def cost_at(costmap: Costmap, x: float, y: float) -> int:
        column, row = ((np.array((x, y)) - costmap.origin_xy) // costmap.resolution).astype(int)
        return int(costmap.costs[row, column])
    ```
    """

    costs: NDArray[np.uint8]
    distance: NDArray[np.float32]
    resolution: float
    origin_xy: FloatArray


LETHAL = 254
INSCRIBED = 253
