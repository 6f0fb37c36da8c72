"""What an observation holds for the roll-outs: walls, what is left of the way, the path, and
where moving obstacles will be.
"""

from __future__ import annotations

import math

import numpy as np

from arena_core import NO_TRACKS, Footprint, Observation, Predictions, Tracks
from arena_kernels.costmap_window import CostmapWindow, Outline, footprint_outline, window_of, without_discs
from arena_mppi.cost_to_go import STEP, UNREACHED, fast_sweep, fill_slowness, last_inside, nearest_row
from arena_mppi.critics import FAR, SPACING
from arena_mppi.parameters import Body, Doubles, Floats, Scene
from arena_mppi.settings import Moving, Progress

TRACKS_MAX = 20  # the nearest ones; a crowd hides what is behind it
NOT_AROUND = 0.1  # m, what a tracked person's cells may lie beside its disc


def body_of(footprint: Footprint) -> Body:
    """Return a footprint's outline and a row of discs that covers it: about one for each two thirds of its width."""
    outline, vertices = footprint_outline(footprint), footprint.vertices_xy
    if footprint.is_circle:
        return Body(outline, np.array(((0.0, 0.0, footprint.radius),), np.float32))
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    longest = int(np.argmax(high - low))
    count = max(1, round(1.5 * (high - low)[longest] / (high - low)[1 - longest]))
    centres = np.tile(0.5 * (low + high), (count, 1))
    part = (high - low)[longest] / count
    centres[:, longest] = low[longest] + part * (np.arange(count) + 0.5)
    radius = 0.5 * math.hypot(part, (high - low)[1 - longest])
    return Body(outline, np.column_stack((centres, np.full(count, radius))).astype(np.float32))


def static_window(observation: Observation, speed_min: float) -> CostmapWindow:
    """Return the local map without the cells of tracked obstacles that move."""
    window, tracks = window_of(observation.local_map), observation.tracks
    moves = observation.predictions.top_speeds() >= speed_min
    return without_discs(window, tracks.positions[moves], tracks.radii[moves], NOT_AROUND)


def scene_of(
    observation: Observation,
    window: CostmapWindow,
    body: Body,
    moving: Moving,
    progress: Progress,
    dt: float,
    steps: int,
    reach: float,
) -> Scene:
    """Return the scene of an observation, for roll-outs of ``steps`` steps of ``dt`` s that come ``reach`` m far."""
    x, y = observation.pose.x, observation.pose.y
    gaps = np.minimum(window.distance - np.float32(0.5 * window.resolution), FAR)
    route = observation.path.poses
    left = compute_cost_to_go(window, gaps, route, x, y, body.outline, progress)
    corner_x, corner_y = np.float32(window.origin_x - x), np.float32(window.origin_y - y)
    goal = observation.goal
    facing = (goal.x - x, goal.y - y, math.cos(goal.theta), math.sin(goal.theta))
    times = np.arange(1, steps + 1, dtype=np.float64) * dt
    return Scene(
        gaps,
        corner_x,
        corner_y,
        np.float32(window.resolution),
        left,
        corner_x,
        corner_y,
        np.float32(STEP * window.resolution),
        predict_tracks(*tracked_of(observation, counts=moving.weight + moving.contact_cost > 0.0), times, moving),
        np.exp(-times / moving.belief_time).astype(np.float32),
        resample_path(route, nearest_row(route, x, y), x, y, reach),
        np.array(facing, np.float32),
        window,
        x,
        y,
    )


def compute_cost_to_go(
    window: CostmapWindow, gaps: Floats, route: Doubles, x: float, y: float, outline: Outline, progress: Progress
) -> Floats:
    """Return what is left of the way to where ``route`` (M, 3) leaves the window, in metres of open ground, (h, w)."""
    rows, columns = ((n + STEP - 1) // STEP for n in gaps.shape)
    slow, left = np.empty((rows, columns), np.float32), np.full((rows, columns), UNREACHED, np.float32)
    fill_slowness(
        gaps, outline.inscribed_radius, progress.comfort_gap, progress.comfort_cost, progress.blocked_cost, slow
    )
    side = STEP * window.resolution
    low_x, low_y = window.origin_x + side, window.origin_y + side
    high_x, high_y = window.origin_x + (columns - 1) * side, window.origin_y + (rows - 1) * side
    end = route[last_inside(route, nearest_row(route, x, y), low_x, low_y, high_x, high_y)]
    place_x, place_y = min(max(end[0], low_x), high_x - 1e-6), min(max(end[1], low_y), high_y - 1e-6)
    row, column = int((place_y - window.origin_y) / side), int((place_x - window.origin_x) / side)
    left[row, column] = 0.0
    fast_sweep(left, slow, side)
    return left


def resample_path(route: Doubles, first: int, x: float, y: float, reach: float) -> Floats:
    """Return points every SPACING along ``reach`` m of ``route`` (M, 3) from row ``first`` on,
    seen from (x, y): (N, 2).
    """
    rest = route[first:, :2] - (x, y)
    along = np.concatenate(((0.0,), np.cumsum(np.hypot(*np.diff(rest, axis=0).T))))
    places = np.arange(0.0, min(along[-1], reach) + 0.5 * SPACING, SPACING)
    return np.column_stack([np.interp(places, along, rest[:, axis]) for axis in (0, 1)]).astype(np.float32)


def tracked_of(observation: Observation, *, counts: bool) -> tuple[Tracks, Predictions]:
    """Return what moves and where it will be, seen from the robot; nothing where that does not count."""
    if counts:
        return observation.tracks, observation.predictions.seen_from(observation.pose.x, observation.pose.y)
    return NO_TRACKS, Predictions.straight(NO_TRACKS.positions, NO_TRACKS.velocities, NO_TRACKS.covariances)


def predict_tracks(tracks: Tracks, seen: Predictions, times: Doubles, moving: Moving) -> Floats:
    """Return where tracks are expected at ``times`` (T,), ``seen`` from the robot, and how large with
    their uncertainty, (T, N, 3).
    """
    nearest = np.argsort(np.hypot(*seen.means[:, 0].T) - tracks.radii, kind="stable")[:TRACKS_MAX]
    expected = seen.take(nearest)
    places = expected.at(times).transpose(1, 0, 2)
    radii = tracks.radii[nearest] + np.minimum(moving.growth * expected.deviations(times).T, moving.growth_max)
    return np.ascontiguousarray(np.concatenate((places, radii[..., None]), axis=2).astype(np.float32))
