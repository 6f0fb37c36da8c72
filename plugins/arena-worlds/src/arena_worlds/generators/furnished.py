"""Another world with furniture in it: tables, chairs and shelves at places that the seed draws."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from arena_core import (
    ConfigurationError,
    Furniture,
    ImpossibleScenario,
    OccupancyGrid,
    Pose,
    World,
    WorldSource,
    random_generator,
)
from arena_core.parameters import NonNegative, NonNegativeInt, Samples
from arena_core.scenes import FurnitureKind, add_obstacles, furniture_outlines
from arena_worlds.generators.generated import Count
from arena_worlds.reachable import free_places

OVERHEAD = 2.0  # m; nothing that hangs higher takes anybody's place
QUARTERS = 4  # furniture stands along the walls of a hall: turned by quarters


class FurnishedWorlds(WorldSource):
    """The worlds of ``room``, with so many pieces of ``furniture`` in each; it is on no map.

    ``kinds`` are drawn in proportion to ``shares``. A piece stands on free ground, and where a disc of ``robot_radius``
    m could go, it still can, but for the places that the piece covers: it parts nothing from the rest. ``regenerate``
    as in generated worlds.
    """

    def __init__(
        self,
        room: WorldSource,
        kinds: Mapping[str, FurnitureKind],
        shares: Mapping[str, NonNegative],
        furniture: Count,
        robot_radius: NonNegative,
        tries: Samples,
        regenerate: NonNegativeInt | None,
    ) -> None:
        unknown = [name for name in shares if name not in kinds]
        if unknown or not sum(shares.values()) > 0.0:
            raise ConfigurationError(
                f"world.shares is {dict(shares)}; allowed: numbers >= 0, not all 0, of {', '.join(sorted(kinds))}"
            )
        pieces = tuple(
            (name, kinds[name].at(name, Pose(0.0, 0.0)), share) for name, share in sorted(shares.items()) if share > 0.0
        )
        self._room, self._pieces, self._given = (
            room,
            pieces,
            (kinds, shares, furniture, robot_radius, tries, regenerate),
        )
        self._count, self._radius, self._tries, self._regenerate = furniture, robot_radius, tries, regenerate

    def world(self, seed: int, index: int) -> World:
        """Return the world of this seed and scenario; raise ImpossibleScenario where a piece finds no place."""
        world = self._room.world(seed, index)
        number = index // self._regenerate if self._regenerate else 0
        drawn = world.grid.derive(
            _FurnitureDraw(self._pieces, self._count, self._radius, self._tries, seed, number, world.name)
        )
        return replace(world, furniture=world.furniture + drawn)

    def at(self, difficulty: float) -> WorldSource:
        """Return the same with rooms of another difficulty; raise ConfigurationError where they have none."""
        return FurnishedWorlds(self._room.at(difficulty), *self._given)


@dataclass(frozen=True, slots=True)
class _FurnitureDraw:
    """A key and function for ``grid.derive``: the pieces that stand in a world.

    ``pieces`` are (name, piece at the origin, share).
    """

    pieces: tuple[tuple[str, Furniture, float], ...]
    count: int
    radius: float
    tries: int
    seed: int
    number: int
    name: str

    def __call__(self, grid: OccupancyGrid) -> tuple[Furniture, ...]:
        random = random_generator(self.seed, f"world/{self.number}", "furniture")
        shares = np.array([share for _, _, share in self.pieces])
        chosen = random.choice(len(shares), self.count, p=shares / shares.sum()).tolist()
        standing: tuple[Furniture, ...] = ()
        free = (grid.data >= 0) & ~grid.occupied
        # large ones first: they need the most room
        for piece in sorted(chosen, key=lambda one: -_piece_reach(self.pieces[one][1])):
            placed, covered = self._place_piece(self.pieces[piece][1], grid, free, len(standing), random)
            standing, free = (*standing, placed), free & ~covered
        return standing

    def _place_piece(
        self, piece: Furniture, grid: OccupancyGrid, free: NDArray[np.bool_], number: int, random: np.random.Generator
    ) -> tuple[Furniture, NDArray[np.bool_]]:
        """Return a piece where it has a place, and the cells that it covers; raise
        ImpossibleScenario where there is none.
        """
        cells, parts = np.argwhere(free), self._free_parts(free, grid)
        bare = OccupancyGrid(np.zeros_like(grid.data), grid.resolution, grid.origin, grid.occupied_from)
        for _ in range(self.tries if len(cells) else 0):
            x, y = grid.positions(cells[random.integers(len(cells))]).tolist()
            placed = replace(piece, pose=Pose(x, y, grid.origin.theta + 0.5 * np.pi * int(random.integers(QUARTERS))))
            shapes = furniture_outlines((placed,), 0.0, OVERHEAD)
            covered = add_obstacles(bare, shapes).occupied
            inside = all(grid.contains(grid.cells(shape.vertices_xy)).all() for shape in shapes)
            if (
                inside
                and not (covered & ~free).any()
                and not _is_divided(parts, self._free_parts(free & ~covered, grid))
            ):
                return placed, covered
        raise ImpossibleScenario(
            f"world {self.name}: piece {number + 1} of world.furniture ({self.count}) found no place in "
            f"{self.tries} tries; "
            "allowed: fewer pieces, or smaller ones"
        )

    def _free_parts(self, free: NDArray[np.bool_], grid: OccupancyGrid) -> NDArray[np.int32]:
        """Return the connected places of a disc (H, W), 0 where it cannot be."""
        labels, _ = ndimage.label(free_places(free, grid.resolution, self.radius))
        return np.asarray(labels)


def _is_divided(before: NDArray[np.int32], after: NDArray[np.int32]) -> bool:
    """Return whether what was connected is no longer."""
    left = after > 0
    pairs = np.unique(np.stack((before[left], after[left])), axis=1)
    return bool(len(np.unique(pairs[0])) < pairs.shape[1])


def _piece_reach(piece: Furniture) -> float:
    """Return how far a piece reaches from its middle, m; its solids' farthest corners count."""
    boxes = np.hypot(piece.boxes[:, 0], piece.boxes[:, 1]) + 0.5 * np.hypot(piece.boxes[:, 3], piece.boxes[:, 4])
    discs = np.hypot(piece.cylinders[:, 0], piece.cylinders[:, 1]) + piece.cylinders[:, 2]
    return float(np.concatenate((boxes, discs)).max())
