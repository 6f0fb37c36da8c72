"""Lines of new topologies: ways through a probabilistic roadmap between start and goal (RAS 2017, section 5)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import borrowing, compiled
from arena_kernels.costmap_window import CostmapWindow, distance_at
from arena_kernels.foreseen import Foreseen, leg_at, place_on
from arena_teb.columns import TIME, VX, VY, X, Y
from arena_teb.problem import FloatArray
from arena_teb.signature import h_signature, same_class
from arena_teb.surroundings import Scene

KEY_TRACKS = 5  # moving discs, the nearest, that get a vertex to their left and right
TRIES = 120  # ways at most whose signature is looked at


class Roadmap(NamedTuple):
    """How ways are searched: the robot's inscribed radius and gap to keep beside moving discs m, its speed m/s, and the
    least cosine of the angle between an edge and the direction of the goal."""

    inscribed_radius: float
    gap: float
    speed: float
    least_cosine: float


def draw_samples(
    random: np.random.Generator, count: int, start: FloatArray, goal: FloatArray, width: float
) -> FloatArray:
    """Draw positions (count, 2) in the rectangle of ``width`` m about the line from start to goal."""
    along, across = random.random((2, count))
    direction = goal[:2] - start[:2]
    length = max(float(np.hypot(*direction)), 1e-6)
    normal = np.array((-direction[Y], direction[X])) / length
    drawn: FloatArray = start[:2] + along[:, None] * direction + ((across - 0.5) * width)[:, None] * normal
    return drawn


@compiled
def find_new_lines(
    start: FloatArray,
    goal: FloatArray,
    drawn: FloatArray,
    scene: Scene,
    points: FloatArray,
    known: FloatArray,
    wanted: int,
    roadmap: Roadmap,
) -> tuple[FloatArray, FloatArray]:
    """Return up to ``wanted`` lines (L, 2, 2) of two positions whose classes are neither ``known`` (B, C + K) nor
    alike, and signatures.

    Lines over one vertex of the roadmap come first (their two positions are the same), short ones before long ones.
    """
    vertices = sort_vertices(np.concatenate((drawn, key_points(start, goal, scene, roadmap))), start, goal)
    count = len(vertices)
    found, classes = np.empty((wanted, 2, 2)), np.empty((wanted + len(known), known.shape[1]))
    classes[: len(known)] = known
    many = 0
    from_start, to_goal = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
    for i in range(count):
        from_start[i] = is_edge_free(start, vertices[i], start, goal, scene.window, roadmap)
        to_goal[i] = is_edge_free(vertices[i], goal, start, goal, scene.window, roadmap)
    tries = 0
    for joined in range(2):
        for i in range(count):
            if not from_start[i]:
                continue
            for j in range(count) if joined else range(i, i + 1):
                if not to_goal[j] or (
                    joined
                    and (i == j or not is_edge_free(vertices[i], vertices[j], start, goal, scene.window, roadmap))
                ):
                    continue
                tries += 1
                if many == wanted or tries > TRIES:
                    return found[:many].copy(), classes[len(known) : len(known) + many].copy()
                way = make_timed_band(start, vertices[i], vertices[j], goal, roadmap.speed)
                angles = h_signature(way, points, scene.foreseen, scene.horizon)
                new = True
                for k in range(len(known) + many):
                    new = new and not same_class(angles, classes[k])
                if new:
                    classes[len(known) + many] = angles
                    found[many, 0], found[many, 1] = vertices[i], vertices[j]
                    many += 1
    return found[:many].copy(), classes[len(known) : len(known) + many].copy()


@compiled
def sort_vertices(vertices: FloatArray, start: FloatArray, goal: FloatArray) -> FloatArray:
    """Return vertices by the length of the way over them."""
    lengths = np.empty(len(vertices))
    for i in range(len(vertices)):
        x, y = vertices[i]
        lengths[i] = math.hypot(x - start[X], y - start[Y]) + math.hypot(goal[X] - x, goal[Y] - y)
    return vertices[np.argsort(lengths)]


@compiled
def key_points(start: FloatArray, goal: FloatArray, scene: Scene, roadmap: Roadmap) -> FloatArray:
    """Return positions left and right of where the nearest moving discs will be when the robot gets there."""
    count = len(scene.radii)
    away = np.empty(count)
    for j in range(count):
        away[j] = math.hypot(scene.foreseen.places[j, 0, X] - start[X], scene.foreseen.places[j, 0, Y] - start[Y])
    nearest = np.argsort(away)[:KEY_TRACKS]
    dx, dy = goal[X] - start[X], goal[Y] - start[Y]
    length = max(math.hypot(dx, dy), 1e-6)
    keys = np.empty((2 * len(nearest), 2))
    for i in range(len(nearest)):
        j = nearest[i]
        x, y = meeting_point(scene.foreseen, j, scene.horizon, start, roadmap.speed)
        gap = scene.radii[j] + roadmap.inscribed_radius + roadmap.gap
        keys[2 * i, X], keys[2 * i, Y] = x - gap * dy / length, y + gap * dx / length
        keys[2 * i + 1, X], keys[2 * i + 1, Y] = x + gap * dy / length, y - gap * dx / length
    return keys


@compiled
def meeting_point(
    foreseen: Foreseen, disc: int, horizon: float, start: FloatArray, speed: float
) -> tuple[float, float]:
    """Return where a moving disc is when the robot could have driven to it."""
    x, y = foreseen.places[disc, 0, X], foreseen.places[disc, 0, Y]
    own = math.hypot(foreseen.velocities[disc, 0, VX], foreseen.velocities[disc, 0, VY])
    for _ in range(3):
        time = min(horizon, math.hypot(x - start[X], y - start[Y]) / (speed + own))
        x, y = place_on(foreseen, disc, leg_at(foreseen, time), time)
    return x, y


@compiled
def make_timed_band(
    start: FloatArray, first: FloatArray, second: FloatArray, goal: FloatArray, speed: float
) -> FloatArray:
    """Return a way over two vertices as a band of four poses at full speed."""
    way = np.zeros((4, 4))
    way[0, :2], way[1, :2], way[2, :2], way[3, :2] = start[:2], first, second, goal[:2]
    for k in range(3):
        way[k, TIME] = math.hypot(way[k + 1, X] - way[k, X], way[k + 1, Y] - way[k, Y]) / speed
    return way


@borrowing
def is_edge_free(
    a: FloatArray, b: FloatArray, start: FloatArray, goal: FloatArray, window: CostmapWindow, roadmap: Roadmap
) -> bool:
    """Return whether an edge leads towards the goal and the robot's middle can pass along it."""
    dx, dy = b[X] - a[X], b[Y] - a[Y]
    length = math.hypot(dx, dy)
    gx, gy = goal[X] - start[X], goal[Y] - start[Y]
    if dx * gx + dy * gy < roadmap.least_cosine * length * math.hypot(gx, gy):
        return False
    least = min(roadmap.inscribed_radius, distance_at(window, a[X], a[Y]) - 1e-3)
    done = 0.0
    while done < length:
        free = distance_at(window, a[X] + done / length * dx, a[Y] + done / length * dy)
        if free < least:
            return False
        done += max(free - least, 0.5 * window.resolution)
    return distance_at(window, b[X], b[Y]) >= min(roadmap.inscribed_radius, distance_at(window, goal[X], goal[Y]))
