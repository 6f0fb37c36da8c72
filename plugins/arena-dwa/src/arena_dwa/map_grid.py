"""Map grids: how far every cell of the window is from the path and from the last path point
inside, around obstacles.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_dwa.columns import X, Y
from arena_dwa.settings import Body, BodyOnWindow, FieldArray, FloatArray, MapGrids, Scales
from arena_kernels.compiled import borrowing, compiled, inlined
from arena_kernels.costmap_window import CostmapWindow
from arena_kernels.paths import nearest_index

UNSEEN = -1
WALL = -2


@borrowing
def bordered_index(window: CostmapWindow, x: float, y: float) -> int:
    """Return the index of a position in the window's flat grid with a border of one cell; -1 outside the window."""
    rows, columns = window.distance.shape
    column = math.floor((x - window.origin_x) / window.resolution)
    row = math.floor((y - window.origin_y) / window.resolution)
    if row < 0 or row >= rows or column < 0 or column >= columns:
        return -1
    return (row + 1) * (columns + 2) + column + 1  # type: ignore[no-any-return]


@borrowing
def clamped_index(window: CostmapWindow, x: float, y: float) -> int:
    """Return the index of the window's cell nearest to a position, in the flat grid with its border."""
    rows, columns = window.distance.shape
    half = 0.5 * window.resolution
    inside_x = min(max(x, window.origin_x + half), window.origin_x + columns * window.resolution - half)
    inside_y = min(max(y, window.origin_y + half), window.origin_y + rows * window.resolution - half)
    return bordered_index(window, inside_x, inside_y)


@compiled
def path_cells(path: FloatArray, window: CostmapWindow, x: float, y: float) -> tuple[NDArray[np.int64], bool]:
    """Return the cells that the path covers from abreast of (x, y) until it first leaves the
    window, and whether it ends inside.
    """
    first = nearest_index(path, x, y)
    cells, count = np.empty(window.distance.size, np.int64), 1
    cells[0] = clamped_index(window, path[first, X], path[first, Y])
    for i in range(first, len(path)):
        before = max(i - 1, first)
        step_x, step_y = path[i, X] - path[before, X], path[i, Y] - path[before, Y]
        parts = max(1, math.ceil(math.hypot(step_x, step_y) / window.resolution))
        for k in range(1, parts + 1):
            cell = bordered_index(window, path[before, X] + step_x * k / parts, path[before, Y] + step_y * k / parts)
            if cell < 0 or count == len(cells):
                return cells[:count], False
            if cell != cells[count - 1]:
                cells[count] = cell
                count += 1
    return cells[:count], True


@compiled
def blocked_cells(window: CostmapWindow, body: Body, x: float, y: float) -> NDArray[np.int32]:
    """Return the flat bordered grid: WALL where the robot's centre cannot be, UNSEEN elsewhere
    and under the robot itself.
    """
    rows, columns = window.distance.shape
    cells = np.full((rows + 2) * (columns + 2), WALL, np.int32)
    least = np.float32(body.outline.inscribed_radius)
    for row in range(rows):
        inside, distances = cells[(row + 1) * (columns + 2) + 1 :], window.distance[row]
        for column in range(columns):
            inside[column] = UNSEEN if distances[column] >= least else WALL
    reach = math.ceil(body.outline.inscribed_radius / window.resolution)
    centre = clamped_index(window, x, y)
    centre_row, centre_column = centre // (columns + 2), centre % (columns + 2)
    for row in range(max(1, centre_row - reach), min(rows, centre_row + reach) + 1):
        for column in range(max(1, centre_column - reach), min(columns, centre_column + reach) + 1):
            if (row - centre_row) ** 2 + (column - centre_column) ** 2 <= reach * reach:
                cells[row * (columns + 2) + column] = UNSEEN
    return cells


@borrowing
def propagate_wavefront(
    steps: NDArray[np.int32], stride: int, seeds: NDArray[np.int64], queue: NDArray[np.int32]
) -> int:
    """Number the UNSEEN cells of ``steps`` in place with their steps from the nearest seed and return the first number
    not used.

    Steps to four and to eight neighbours alternate, which makes the front an octagon: within 11 % of the Euclidean
    distance (Rosenfeld, Pfaltz: Distance functions on digital pictures, 1968), where the diamond of ROS's map grid is
    off by 41 %. ``queue`` is room for one cell more than there are.
    """
    begin, end, ring = 0, 0, 0
    for seed in seeds:
        if steps[seed] != 0:
            steps[seed] = 0
            queue[end] = seed
            end += 1
    while begin < end:
        ring_end, diagonal = end, ring % 2 == 1
        ring += 1
        for i in range(begin, ring_end):
            cell = queue[i]
            end = visit_cell(steps, cell + 1, ring, queue, end)
            end = visit_cell(steps, cell - 1, ring, queue, end)
            end = visit_cell(steps, cell + stride, ring, queue, end)
            end = visit_cell(steps, cell - stride, ring, queue, end)
            if diagonal:
                end = visit_cell(steps, cell + stride + 1, ring, queue, end)
                end = visit_cell(steps, cell + stride - 1, ring, queue, end)
                end = visit_cell(steps, cell - stride + 1, ring, queue, end)
                end = visit_cell(steps, cell - stride - 1, ring, queue, end)
        begin = ring_end
    return ring


@inlined
def visit_cell(steps: NDArray[np.int32], cell: int, ring: int, queue: NDArray[np.int32], end: int) -> int:
    """Number an UNSEEN cell, and queue it; return how many are queued."""
    place = np.uint64(cell)  # no cell is negative
    if steps[place] != UNSEEN:
        return end
    steps[place] = ring
    queue[np.uint64(end)] = cell
    return end + 1


@borrowing
def clear_walls(steps: NDArray[np.int32], stride: int) -> None:
    """Make every cell but the border's UNSEEN."""
    for row in range(1, len(steps) // stride - 1):
        for i in range(row * stride + 1, row * stride + stride - 1):
            steps[i] = UNSEEN


@compiled
def map_grid(
    blocked: NDArray[np.int32], stride: int, seeds: NDArray[np.int64], robot: int, queue: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Return every cell's steps from the nearest seed round walls; walls and what is cut off count as one step beyond
    the last.

    Where the robot itself is cut off, walls are ignored, so that it comes near and waits.
    """
    steps = blocked.copy()
    ring = propagate_wavefront(steps, stride, seeds, queue)
    if steps[robot] < 0:
        clear_walls(steps, stride)
        ring = propagate_wavefront(steps, stride, seeds, queue)
    for i in range(len(steps)):
        steps[i] = ring if steps[i] < 0 else steps[i]
    return steps


@compiled
def map_grids(
    ground: BodyOnWindow, path: FloatArray, place: tuple[float, float], forward_point_distance: float
) -> MapGrids:
    """Return the grids of a robot at (x, y).

    The front's goal lies ``forward_point_distance`` beyond the path's end, seen from the robot, as in ROS: else the
    robot would stop that far short of it.
    """
    x, y = place
    cells, ends_inside = path_cells(path, ground.window, x, y)
    blocked = blocked_cells(ground.window, ground.body, x, y)
    stride, robot = ground.window.distance.shape[1] + 2, clamped_index(ground.window, x, y)
    queue = np.empty(len(blocked) + 1, np.int32)
    goal = map_grid(blocked, stride, cells[-1:], robot, queue)
    goal_front = goal
    if ends_inside:
        bearing = math.atan2(path[-1, Y] - y, path[-1, X] - x)
        beyond_x = path[-1, X] + forward_point_distance * math.cos(bearing)
        beyond_y = path[-1, Y] + forward_point_distance * math.sin(bearing)
        goal_front = map_grid(
            blocked, stride, np.full(1, clamped_index(ground.window, beyond_x, beyond_y)), robot, queue
        )
    return MapGrids(map_grid(blocked, stride, cells, robot, queue), goal, goal_front)


@compiled
def cost_fields(
    grids: MapGrids, window: CostmapWindow, scales: Scales, aligning: bool
) -> tuple[FieldArray, FieldArray]:
    """Return what the robot's place and the place of its front cost, (H, W) each: path and goal, alignment and
    goal-front critics.

    As in ROS each pair of critics shares its bias. ``aligning`` is false near the goal, where the front is past the
    path's end.
    """
    rows, columns = window.distance.shape
    to_path = np.float32(0.5 * scales.path_distance_bias * window.resolution)
    to_goal = np.float32(0.5 * scales.goal_distance_bias * window.resolution)
    align = to_path if aligning else np.float32(0.0)
    place, front = np.empty((rows, columns), np.float32), np.empty((rows, columns), np.float32)
    for row in range(rows):
        start = (row + 1) * (columns + 2) + 1
        for column in range(columns):
            off_path = np.float32(grids.path[start + column])
            place[row, column] = to_path * off_path + to_goal * np.float32(grids.goal[start + column])
            front[row, column] = align * off_path + to_goal * np.float32(grids.goal_front[start + column])
    return place, front


@borrowing
def interpolate_field(field: FieldArray, window: CostmapWindow, x: float, y: float) -> float:
    """Return a field's value at a position, between the centres of the four cells around it;
    beyond the edge the edge's.
    """
    rows, columns = field.shape
    u, v = (x - window.origin_x) / window.resolution - 0.5, (y - window.origin_y) / window.resolution - 0.5
    column, row = min(max(int(u), 0), columns - 2), min(max(int(v), 0), rows - 2)
    u, v = min(max(u - column, 0.0), 1.0), min(max(v - row, 0.0), 1.0)
    below = field[row, column] * (1.0 - u) + field[row, column + 1] * u
    above = field[row + 1, column] * (1.0 - u) + field[row + 1, column + 1] * u
    return below * (1.0 - v) + above * v  # type: ignore[no-any-return]
