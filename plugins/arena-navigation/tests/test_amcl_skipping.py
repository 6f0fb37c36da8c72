"""Beam skipping leaves out what is on no map, and nothing where the particles are what is wrong."""

import numpy as np
import pytest

from arena_core import OccupancyGrid, Pose
from arena_navigation.amcl.directions import PlacedParticles
from arena_navigation.amcl.laser import KEEP_ALL
from arena_navigation.amcl.sensor import Distances, EndpointLookup, LikelihoodField, match_endpoints
from arena_navigation.amcl.skipping import NearMap, Skipping, has_converged, skip_beams

CELLS = Distances(False, True)
MODEL = LikelihoodField(True, 0.95, 0.05, 0.2, 2.0, CELLS, 1.0, 10.0)
PARTICLES = np.random.default_rng(4).normal((3.0, 2.0, 0.0), (0.05, 0.05, 0.02), (60, 3)).T.copy()
WALL = [(2.95, y) for y in np.linspace(-0.6, 0.6, 9)]  # seen from (3, 2): the wall at x = 5.95
PERSON = [(1.0, 0.3), (1.0, 0.4), (1.05, 0.5)]


@pytest.fixture(scope="module")
def hall():
    data = np.zeros((40, 60), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    return OccupancyGrid(data, 0.1, Pose(7.0, -2.0, 0.6))


def kept(grid, ends, poses=PARTICLES, threshold=0.3, error_threshold=0.9, near=None):
    """Return the ends of the beams that are kept."""
    beams = np.array(ends, np.float32).T.copy()
    directions = np.stack((np.cos(poses[2]), np.sin(poses[2])))
    skipping = Skipping(grid.derive(NearMap(0.5, CELLS)) if near is None else near, threshold, error_threshold)
    scratch = np.empty((2, beams.shape[1]), np.int32)
    number = skip_beams(
        PlacedParticles(poses, directions, poses.shape[1]),
        EndpointLookup(beams, grid.derive(MODEL), scratch[0]),
        skipping,
        scratch[1],
    )
    return beams[:, :number].T


def test_beams_of_what_is_on_no_map_are_skipped_and_the_others_keep_their_order(hall):
    np.testing.assert_allclose(kept(hall, [*WALL[:4], *PERSON, *WALL[4:]]), WALL, rtol=1e-6)


def test_a_person_who_moves_does_not_change_the_scores(hall):
    def scored(person):
        ends = kept(hall, [*WALL, *person]).T.copy()
        directions, found = np.stack((np.cos(PARTICLES[2]), np.sin(PARTICLES[2]))), np.empty(60)
        match_endpoints(
            PlacedParticles(PARTICLES, directions, 60),
            EndpointLookup(ends, hall.derive(MODEL), np.empty(ends.shape[1], np.int32)),
            ends.shape[1],
            found,
        )
        return found

    np.testing.assert_array_equal(scored(PERSON), scored([(x + 0.6, y - 0.9) for x, y in PERSON]))


def test_all_beams_are_kept_where_nearly_all_would_be_skipped(hall):
    assert len(kept(hall, [*WALL[:1], *PERSON * 4])) == 13
    assert len(kept(hall, [*WALL[:2], *PERSON * 4])) == 2
    assert len(kept(hall, [*WALL[:2], *PERSON * 4], error_threshold=0.5)) == 14


def test_scattered_particles_skip_nothing(hall):
    scattered = PARTICLES.copy()
    scattered[0, 7] += 1.2
    assert has_converged(PARTICLES, 60)
    assert not has_converged(scattered, 60)
    assert len(kept(hall, [*WALL, *PERSON], scattered)) == 12


def test_a_beam_that_enough_particles_can_explain_is_kept(hall):
    spread = PARTICLES.copy()
    spread[0, :30] -= 0.25
    spread[0, 30:] += 0.05
    short = [(2.5, 0.0)]  # near the wall for the farther half alone
    assert len(kept(hall, [*WALL, *short], spread, threshold=0.4)) == 10
    assert len(kept(hall, [*WALL, *short], spread, threshold=0.6)) == 9


def test_without_skipping_every_beam_is_kept(hall):
    assert len(kept(hall, [*WALL, *PERSON], near=KEEP_ALL.near)) == 12
