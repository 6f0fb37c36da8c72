"""Ways round what a scan sees on a robot's path: on a small grid about the robot, in compiled code."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid, Path, PathBatch
from arena_core.parameters import NonNegative, Positive
from arena_gym.modelled_tracks import ScanNumbers
from arena_kernels.compiled import borrowing, compiled, inner
from arena_kernels.distance import grid_distance

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
SMOOTHINGS = 12  # times that a way over cells is drawn straighter
ROUNDS = 40  # sweeps over the grid, after which costs that still fall are taken as they are
_TURN = 2.0 * math.pi


@dataclass(frozen=True, slots=True)
class DetourRules:
    """How a path is left and met again: on a grid of ``size`` m about the robot with cells of ``resolution`` m.

    Hits up to ``hits_within`` m count. A path is blocked where one lies within the robot's inscribed radius and
    ``margin`` m of it; a detour keeps ``room`` m more if it can, and pays ``crowding`` times its length where there is
    none.
    """

    size: Positive
    resolution: Positive
    hits_within: Positive
    margin: NonNegative
    room: Positive
    crowding: NonNegative


class PathLook(NamedTuple):
    """How far ahead paths are looked at (m, half the window), how near a hit blocks them, and up to where hits count,
    m.
    """

    half: float
    body: float
    hits_within: float


class LocalGround(NamedTuple):
    """A map's distance field (H, W), m, with its place: ``origin`` is x, y, cos, sin."""

    field: NDArray[np.float32]
    resolution: float
    origin: tuple[float, float, float, float]

    @classmethod
    def of(cls, grid: OccupancyGrid | None) -> LocalGround:
        """Return a map's walls; none where there is no map."""
        if grid is None:
            return cls(np.full((1, 1), np.inf, np.float32), 1.0, (0.0, 0.0, 1.0, 0.0))
        at = grid.origin
        place = float(at.x), float(at.y), math.cos(at.theta), math.sin(at.theta)
        return cls(grid.derive(grid_distance), float(grid.resolution), place)


class Detours:
    """Looks whether paths are blocked, and leads round what blocks them."""

    def __init__(self, rules: DetourRules, inscribed: float) -> None:
        self._look = PathLook(rules.size / 2.0, inscribed + rules.margin, rules.hits_within)
        self._rules, self._inscribed = rules, inscribed
        cells = math.ceil(rules.size / rules.resolution)
        self._clear, self._costs = np.empty((cells, cells)), np.empty((cells, cells))

    def blocked(self, paths: PathBatch, poses: Floats, scans: ScanNumbers) -> Flags:
        """Return whose path (N) is blocked ahead of ``poses`` (N, 3), where the robots believe to be."""
        found = np.zeros(len(poses), np.bool_)
        find_blocked((paths.poses, paths.offsets), poses, scans, self._look, found)
        return found

    def way_round(self, path: Path, pose: Floats, slot: int, scans: ScanNumbers, ground: LocalGround) -> Path | None:
        """Return the path of one robot at ``pose`` (3,), led round what blocks it; None where there is no room."""
        rules = self._rules
        numbers = rules.resolution, self._inscribed, self._inscribed + rules.room, rules.crowding, rules.hits_within
        write_clearances(self._clear, (pose, slot), scans, ground, numbers)
        cells = len(self._clear)
        way = np.empty((cells * 4, 2))
        count, meets = search_way((self._clear, self._costs), path.poses, pose, numbers, way)
        if count < 2:
            return None
        return Path(np.vstack((_with_headings(way[:count]), path.poses[meets + 1 :])))


def _with_headings(way: Floats) -> Floats:
    """Return positions (M, 2) as poses (M, 3) that head for the next one."""
    along = np.diff(way, axis=0)
    headings = np.arctan2(along[:, 1], along[:, 0])
    return np.column_stack((way, np.append(headings, headings[-1])))


@borrowing
def find_blocked(
    paths: tuple[Floats, NDArray[np.int64]], poses: Floats, scans: ScanNumbers, look: PathLook, found: Flags
) -> None:
    """Write whose path runs into a hit of the scan between the pose nearest to the robot and the rim of its window."""
    packed, offsets = paths
    for k in range(len(poses)):
        path = packed[offsets[k] : offsets[k + 1]]
        x, y = poses[k, 0], poses[k, 1]
        c, s = math.cos(poses[k, 2]), math.sin(poses[k, 2])
        sensor = (
            x + c * scans.mount[0] - s * scans.mount[1],
            y + s * scans.mount[0] + c * scans.mount[1],
            poses[k, 2] + scans.mount[2],
        )
        i = _nearest_pose(path, x, y)
        last_x, last_y = np.inf, np.inf
        while i < len(path) and abs(path[i, 0] - x) <= look.half and abs(path[i, 1] - y) <= look.half:
            if math.hypot(path[i, 0] - last_x, path[i, 1] - last_y) >= 0.5 * look.body or i == len(path) - 1:
                last_x, last_y = path[i, 0], path[i, 1]
                if _is_hit(scans, k, sensor, (last_x, last_y, x, y), look):
                    found[k] = True
                    break
            i += 1


@inner
def _nearest_pose(path: Floats, x: float, y: float) -> int:
    best, at = np.inf, 0
    for i in range(len(path)):
        squared = (path[i, 0] - x) ** 2 + (path[i, 1] - y) ** 2
        if squared < best:
            best, at = squared, i
    return at


@inner
def _is_hit(scans: ScanNumbers, k: int, sensor: Any, place: Any, look: PathLook) -> bool:
    """Return whether a beam of robot k ends within the body's reach of a place, and not on the robot itself."""
    dx, dy = place[0] - sensor[0], place[1] - sensor[1]
    away, count = math.hypot(dx, dy), scans.ranges.shape[1]
    if away - look.body > look.hits_within:
        return False
    middle = ((math.atan2(dy, dx) - sensor[2] - scans.angle_min) % _TURN) / scans.increment
    half = math.asin(look.body / away) / scans.increment if away > look.body else 0.5 * _TURN / scans.increment
    turn = round(_TURN / scans.increment)
    for beam in range(math.ceil(middle - half), math.floor(middle + half) + 1):
        at = beam
        if at < 0:
            at += turn
        elif at >= count:
            at -= turn
        if 0 <= at < count:
            r = float(scans.ranges[k, at])
            if r > look.hits_within or abs(r - away) >= look.body:
                continue
            off = (beam - middle) * scans.increment
            if r * r + away * away - 2.0 * r * away * math.cos(off) < look.body * look.body:
                return True
    return False


@borrowing
def write_clearances(
    clear: Floats,
    robot: tuple[Floats, int],
    scans: ScanNumbers,
    ground: LocalGround,
    numbers: tuple[float, float, float, float, float],
) -> None:
    """Write how far the middle of each cell (C, C) about a robot is from walls and hits, m, right up to the room that a
    detour keeps.
    """
    (pose, slot), (resolution, _, room, _, hits_within) = robot, numbers
    cells = len(clear)
    low_x, low_y = pose[0] - 0.5 * cells * resolution, pose[1] - 0.5 * cells * resolution
    ox, oy, oc, os = ground.origin
    for row in range(cells):
        for column in range(cells):
            dx, dy = low_x + (column + 0.5) * resolution - ox, low_y + (row + 0.5) * resolution - oy
            u = math.floor((oc * dx + os * dy) / ground.resolution)
            v = math.floor((oc * dy - os * dx) / ground.resolution)
            inside = 0 <= v < ground.field.shape[0] and 0 <= u < ground.field.shape[1]
            clear[row, column] = float(ground.field[v, u]) if inside else np.inf
    c, s = math.cos(pose[2]), math.sin(pose[2])
    sx, sy = pose[0] + c * scans.mount[0] - s * scans.mount[1], pose[1] + s * scans.mount[0] + c * scans.mount[1]
    reach, last = math.ceil(room / resolution), (-1, -1)
    for beam in range(scans.ranges.shape[1]):
        r = float(scans.ranges[slot, beam])
        if not r <= hits_within:
            continue
        bearing = pose[2] + scans.mount[2] + scans.angle_min + beam * scans.increment
        hx, hy = sx + r * math.cos(bearing), sy + r * math.sin(bearing)
        column, row = math.floor((hx - low_x) / resolution), math.floor((hy - low_y) / resolution)
        if (row, column) == last:  # beams side by side mostly end in one cell
            continue
        last = row, column
        for i in range(max(row - reach, 0), min(row + reach + 1, cells)):
            for j in range(max(column - reach, 0), min(column + reach + 1, cells)):
                x, y = low_x + (j + 0.5) * resolution, low_y + (i + 0.5) * resolution
                clear[i, j] = min(clear[i, j], math.hypot(x - hx, y - hy))


@compiled
def search_way(
    grids: tuple[Floats, Floats],
    path: Floats,
    pose: Floats,
    numbers: tuple[float, float, float, float, float],
    way: Floats,
) -> tuple[int, int]:
    """Write the cheapest way (M, 2) from a robot to where its path leaves the grid; return how long it is and at which
    pose of the path it ends, 0 and 0 where there is none.
    """
    (clear, costs), resolution, body = grids, numbers[0], numbers[1]
    cells = len(clear)
    low_x, low_y = pose[0] - 0.5 * cells * resolution, pose[1] - 0.5 * cells * resolution
    meets = _meeting(clear, path, pose, (low_x, low_y, resolution, body))
    if meets < 0:
        return 0, 0
    row = math.floor((path[meets, 1] - low_y) / resolution)
    column = math.floor((path[meets, 0] - low_x) / resolution)
    _spread_costs(clear, costs, (row, column), numbers)
    i = j = cells // 2
    count = 0
    way[0, 0], way[0, 1] = pose[0], pose[1]
    while (i, j) != (row, column):
        best, next_i, next_j = costs[i, j], i, j
        for di in range(-1, 2):
            for dj in range(-1, 2):
                a, b = i + di, j + dj
                if 0 <= a < cells and 0 <= b < cells and costs[a, b] < best:
                    best, next_i, next_j = costs[a, b], a, b
        if (next_i == i and next_j == j) or count + 2 >= len(way):
            return 0, 0
        i, j, count = next_i, next_j, count + 1
        way[count, 0], way[count, 1] = low_x + (j + 0.5) * resolution, low_y + (i + 0.5) * resolution
    way[count, 0], way[count, 1] = path[meets, 0], path[meets, 1]
    _straighten(clear, way[: count + 1], (low_x, low_y, resolution, body))
    return count + 1, meets


@inner
def _meeting(clear: Floats, path: Floats, pose: Floats, place: tuple[float, float, float, float]) -> int:
    """Return the farthest pose of the path, in one piece from the nearest one on, that lies in the grid and is free; -1
    if none is.
    """
    low_x, low_y, resolution, body = place
    cells, found = len(clear), -1
    for i in range(_nearest_pose(path, pose[0], pose[1]), len(path)):
        row, column = math.floor((path[i, 1] - low_y) / resolution), math.floor((path[i, 0] - low_x) / resolution)
        if not (0 <= row < cells and 0 <= column < cells):
            break
        if clear[row, column] > body:
            found = i
    return found


@inner
def _spread_costs(
    clear: Floats,
    costs: Floats,
    end: tuple[int, int],
    numbers: tuple[float, float, float, float, float],
) -> None:
    """Write what the way from each cell to the end costs (m, more where there is little room), inf where none leads.

    Gauss-Seidel sweeps in four orders, as in fast sweeping (Zhao, Mathematics of Computation 74, 2005), over eight
    neighbours. Cells within the body's reach of something are closed, but for those by the robot.
    """
    resolution, body, room, crowding, _ = numbers
    cells = len(clear)
    costs[:] = np.inf
    costs[end[0], end[1]] = 0.0
    for sweep in range(ROUNDS):
        changed = False
        for a in range(cells):
            i = a if sweep % 2 == 0 else cells - 1 - a
            for b in range(cells):
                j = b if sweep % 4 < 2 else cells - 1 - b
                near = max(abs(i - cells // 2), abs(j - cells // 2)) * resolution <= body
                if clear[i, j] <= body and not near:
                    continue
                price = resolution * (1.0 + crowding * max(room - clear[i, j], 0.0) / room)
                best = costs[i, j]
                for di in range(-1, 2):
                    for dj in range(-1, 2):
                        u, v = i + di, j + dj
                        if 0 <= u < cells and 0 <= v < cells and costs[u, v] < best:
                            best = min(best, costs[u, v] + price * (1.4142135623730951 if di and dj else 1.0))
                if best < costs[i, j]:
                    costs[i, j], changed = best, True
        if not changed:
            break


@inner
def _straighten(clear: Floats, way: Floats, place: tuple[float, float, float, float]) -> None:
    """Draw a way straighter where it stays free; its ends stay."""
    low_x, low_y, resolution, body = place
    cells = len(clear)
    for _ in range(SMOOTHINGS):
        for i in range(1, len(way) - 1):
            x = 0.25 * way[i - 1, 0] + 0.5 * way[i, 0] + 0.25 * way[i + 1, 0]
            y = 0.25 * way[i - 1, 1] + 0.5 * way[i, 1] + 0.25 * way[i + 1, 1]
            row, column = math.floor((y - low_y) / resolution), math.floor((x - low_x) / resolution)
            if 0 <= row < cells and 0 <= column < cells and clear[row, column] > body:
                way[i, 0], way[i, 1] = x, y
