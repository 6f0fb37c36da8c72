"""One scan taken in by the tracker: a single compiled call."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.scalars import Integer
from arena_navigation.columns import X, Y
from arena_navigation.local_map.marks import PlacedScan
from arena_navigation.tracking.alignment import Alignment, Points, beam_stride, estimate_slip, move_states
from arena_navigation.tracking.assignment import Assignment
from arena_navigation.tracking.belief import Belief, LifeSpan, begin_tracks, end_tracks, present_tracks, write_bodies
from arena_navigation.tracking.discs import BodyRules, Scratch, find_discs, first_discs
from arena_navigation.tracking.filter import (
    POSITION,
    VELOCITY,
    correct_radii,
    correct_tracks,
    place_by_radii,
    predict_tracks,
)
from arena_navigation.tracking.matches import match_discs
from arena_navigation.tracking.returns import KnownPlane, PastScans, place_returns
from arena_navigation.tracking.visibility import judge_visibility


class TrackerParameters(NamedTuple):
    """All figures of the tracker; ``standing_variance``, (m/s)^2, is that of the speed of a body that stands."""

    rules: BodyRules
    alignment: Alignment
    gate: float
    acceleration_density: float
    standing_variance: float
    life: LifeSpan


class Known(NamedTuple):
    """What a scan is held against: the map, and past scans, of which ``newest`` is
    the last one; -1 where there is none.
    """

    plane: KnownPlane
    past: PastScans
    newest: int


class TrackingScratch(NamedTuple):
    """Scratch space for N tracks: their ``bodies`` (N, 3), ``matches``, ``own`` and ``sight`` (N,), what is
    measured of each; and more.
    """

    scratch: Scratch
    points: Points
    moved: NDArray[np.float64]
    bodies: NDArray[np.float64]
    positions: NDArray[np.float64]
    noises: NDArray[np.float64]
    matches: NDArray[np.int64]
    own: NDArray[np.int64]
    sight: NDArray[np.uint8]
    taken: NDArray[np.uint8]
    assignment: Assignment

    @staticmethod
    def room(beams: int, tracks: int, discs: int) -> TrackingScratch:
        """Return room for so many beams, tracks and discs."""
        matches, own = np.zeros((2, tracks), np.int64)
        return TrackingScratch(
            Scratch.room(beams),
            Points.room(beams),
            np.zeros(3),
            np.zeros((tracks, 3)),
            np.zeros((tracks, 2)),
            np.zeros((tracks, 2, 2)),
            matches,
            own,
            np.zeros(tracks, np.uint8),
            np.zeros(discs, np.uint8),
            Assignment.room(tracks, discs),
        )

    def fits(self, beams: int, tracks: int, discs: int) -> bool:
        """Return whether this is the room for so many."""
        return (len(self.points.half), len(self.matches), len(self.taken)) == (beams, tracks, discs)


@borrowing
def process_scan(
    beams: PlacedScan, dt: float, known: Known, belief: Belief, figures: TrackerParameters, workings: TrackingScratch
) -> Integer:
    """Take in a scan, ``dt`` s after the last one; return how many tracks are told of.

    At first all that is remembered is moved by how far the pose estimate has slipped since the last scan that was kept.
    """
    rules, returns, past, tracks = figures.rules, workings.scratch.returns, known.past, present_tracks(belief)
    matches, bodies = workings.matches[: len(tracks.ids)], workings.bodies[: len(tracks.ids)]
    predict_tracks(tracks.states, tracks.covariances, dt, figures.acceleration_density)
    place_returns(beams, known.plane, rules.farthest, beam_stride(beams, figures.alignment), returns)
    write_bodies(tracks, rules.doubt.past, bodies)
    if known.newest >= 0:
        estimate_slip(beams, returns, past, known.newest, bodies, figures.alignment, workings.points, workings.moved)
        move_states(beams, workings.moved, tracks.states, tracks.covariances, past.sensors)
        write_bodies(tracks, rules.doubt.past, bodies)
    discs = first_discs(workings.scratch.discs, find_discs(beams, past, bodies, rules, workings.scratch))
    match_discs(
        (tracks.states, tracks.covariances, tracks.radii),
        (discs.positions, discs.covariances),
        figures.gate,
        workings.assignment,
        matches,
    )
    positions, noises, own, taken = workings.positions, workings.noises, workings.own[: len(matches)], workings.taken
    place_by_radii(matches, discs, tracks.radii, tracks.radius_variances, rules.shape.noise, positions, noises)
    taken[: len(discs.radii)] = 0
    for k in range(len(matches)):
        own[k] = k if matches[k] >= 0 else -1
        if matches[k] >= 0:
            taken[matches[k]] = 1
    correct_tracks(tracks.states, tracks.covariances, own, positions, noises, POSITION)
    # what stands where it stood does not move: what is seen of it may shift as the robot drives by
    for k in range(len(matches)):
        own[k] = k if matches[k] >= 0 and discs.standing[matches[k]] else -1
        positions[k], noises[k] = 0.0, 0.0
        noises[k, X, X], noises[k, Y, Y] = figures.standing_variance, figures.standing_variance
    correct_tracks(tracks.states, tracks.covariances, own, positions, noises, VELOCITY)
    correct_radii(tracks.radii, tracks.radius_variances, matches, discs.radii, discs.radius_variances)
    judge_visibility(beams, tracks.states, tracks.radii, matches, rules.farthest, rules.doubt.past, workings.sight)
    end_tracks(belief, beams.stamp, workings.sight, figures.life)
    return begin_tracks(belief, beams.stamp, discs, taken, figures.life)
