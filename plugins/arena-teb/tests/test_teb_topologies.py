"""Resizing, clusters, signatures, the roadmap and feasibility."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_kernels.costmap_window import outline_of
from arena_kernels.foreseen import Foreseen
from arena_teb.association import Reach
from arena_teb.band import FirstDrive, band_along, prune_band
from arena_teb.clusters import cluster_points
from arena_teb.feasibility import free_poses
from arena_teb.polygons import NO_HULLS
from arena_teb.problem import Shape
from arena_teb.resize import Sampling, resize_band
from arena_teb.roadmap import Roadmap, draw_samples, find_new_lines
from arena_teb.signature import h_signature, same_class
from arena_teb.surroundings import Scene, Vicinity, find_surroundings

NOBODY = np.empty((0, 2))
NO_ONE = Foreseen.straight(NOBODY, NOBODY)
START, GOAL = np.array((-2.0, 0.0, 0.0)), np.array((2.0, 0.0, 0.0))
DISC = Shape(np.zeros((1, 2)), 0.15, 0.15, 0.15)
ROADMAP = Roadmap(0.15, 0.3, 0.5, 0.3)


def scene(window, positions=NOBODY, velocities=NOBODY, horizon=math.inf):
    return Scene(
        window,
        NO_HULLS,
        Foreseen.straight(np.array(positions, float), np.array(velocities, float)),
        np.full(len(positions), 0.3),
        horizon,
        NOBODY,
    )


def over(*positions, speed=0.5):
    return band_along(np.array(positions, float).reshape(-1, 2), START, GOAL, FirstDrive(speed, 1.0, reverses=False))


@settings(derandomize=True, deadline=None, max_examples=50)
@given(st.lists(st.floats(0.01, 3.0), min_size=2, max_size=20), st.floats(0.1, 0.5))
def test_resizing_keeps_the_ends_and_the_duration(times, dt_ref):
    band = np.zeros((len(times) + 1, 4))
    band[:, 0], band[:-1, 3] = 0.1 * np.arange(len(band)), times
    found = resize_band(band, Sampling(dt_ref, 0.3 * dt_ref, 3, 400, math.inf))
    assert (found[0, :3] == band[0, :3]).all()
    assert (found[-1, :3] == band[-1, :3]).all()
    np.testing.assert_allclose(found[:-1, 3].sum(), band[:-1, 3].sum())
    assert found[:-1, 3].max() <= 1.3 * dt_ref + 1e-9


def test_resizing_leaves_no_interval_longer_than_the_spacing():
    band = np.array([(0.0, 0.0, 0.0, 0.1), (1.0, 0.0, 0.0, 0.1), (2.0, 0.0, 0.0, 0.1)])
    assert np.diff(resize_band(band, Sampling(0.3, 0.1, 3, 80, 0.2))[:, 0]).max() <= 0.2


def test_each_obstacle_is_one_cluster_and_a_gap_too_narrow_is_none(window):
    apart = window((-0.5, -0.4, 0.5, 0.8), (-0.5, -0.4, -0.8, -0.5))
    narrow = window((-0.5, -0.4, 0.1, 0.8), (-0.5, -0.4, -0.8, -0.05))
    assert len(cluster_points(apart, 0.15, 0.0, 0.0, 40)) == 2
    assert len(cluster_points(narrow, 0.15, 0.0, 0.0, 40)) == 1
    assert len(cluster_points(window(), 0.15, 0.0, 0.0, 40)) == 0


def test_only_the_nearest_clusters_count(window):
    dots = [(x, x + 0.01, y, y + 0.01) for x in np.arange(-2.8, 2.8, 0.4) for y in np.arange(-2.8, 2.8, 0.4)]
    points = cluster_points(window(*dots), 0.1, 0.0, 0.0, 40)
    assert len(points) == 40
    assert np.hypot(*points.T).max() < 1.8


@settings(derandomize=True, deadline=None, max_examples=50)
@given(st.floats(-1.5, 1.5), st.floats(0.2, 1.0), st.floats(0.2, 1.0))
def test_ways_left_and_right_of_an_obstacle_differ_and_ways_on_one_side_do_not(x, left, far):
    obstacle = np.array([(x, 0.0)])
    angles = [h_signature(over((x, y)), obstacle, NO_ONE, math.inf) for y in (left, left + far, -left)]
    assert same_class(angles[0], angles[1])
    assert not same_class(angles[0], angles[2])


def test_passing_before_and_behind_a_crossing_person_differ():
    person, walks = np.array([(0.0, -1.0)]), np.array([(0.0, 0.5)])
    before, behind = over(speed=2.0), over(speed=0.5)
    angles = [h_signature(band, NOBODY, Foreseen.straight(person, walks), math.inf) for band in (before, behind)]
    assert not same_class(*angles)


def test_roadmap_finds_the_other_side(window):
    here = scene(window((-0.2, 0.2, -0.4, 0.4)))
    points = cluster_points(here.window, 0.15, -2.0, 0.0, 40)
    known = h_signature(over((0.0, 0.8)), points, NO_ONE, math.inf)[None]
    drawn = draw_samples(np.random.default_rng(0), 40, START, GOAL, 4.0)
    lines, angles = find_new_lines(START, GOAL, drawn, here, points, known, 3, ROADMAP)
    assert len(lines) == 1
    assert lines[0, 0, 1] < -0.4
    assert not same_class(angles[0], known[0])


def test_roadmap_passes_no_wall(window):
    here = scene(window((-0.2, 0.2, -3.1, 3.1)))
    points = cluster_points(here.window, 0.15, -2.0, 0.0, 40)
    known = h_signature(over(), points, NO_ONE, math.inf)[None] + 100.0
    drawn = draw_samples(np.random.default_rng(0), 40, START, GOAL, 4.0)
    assert len(find_new_lines(START, GOAL, drawn, here, points, known, 3, ROADMAP)[0]) == 0


def test_poses_are_paired_with_the_nearest_points_left_and_right_and_with_people_of_their_time(window):
    here = scene(window((-3.0, 3.0, 0.5, 0.6), (-3.0, 3.0, -0.7, -0.6)), [(1.0, 2.0)], [(0.0, -0.5)])
    band = over()
    around = find_surroundings(band, here, Vicinity(Reach(1.0, 0.0), 1.0, 0.1, 0.5), DISC)
    np.testing.assert_allclose(around.points[5, 0, 1], 0.5, atol=0.03)
    np.testing.assert_allclose(around.points[5, 1, 1], -0.6, atol=0.03)
    np.testing.assert_allclose(around.moving[-1, 0], (1.0, 2.0 - 0.5 * band[:-1, 3].sum()))


def test_speed_is_cut_between_walls(window):
    here = scene(window((-3.0, 3.0, 0.3, 0.4), (-3.0, 3.0, -0.4, -0.3)))
    assert find_surroundings(over(), here, Vicinity(Reach(1.0, 0.0), 0.5, 0.35, 0.5), DISC).caps.max() < 0.55


def test_band_into_a_wall_is_free_up_to_it_alone(window):
    outline = outline_of(None, 0.15, 0.15, 0.05)
    wall = window((0.0, 0.1, -3.0, 3.0))
    free = free_poses(over(), wall, outline, 0.0, 0.0)
    assert over()[free - 1, 0] < -0.1 < over()[free + 1, 0]
    assert free_poses(over(), window(), outline, 0.0, 0.0) == len(over())


def test_robot_in_contact_may_leave(window):
    outline = outline_of(None, 0.15, 0.15, 0.05)
    assert free_poses(over(), window((-2.3, -2.1, -0.1, 0.1)), outline, 0.0, 0.0) == len(over())


def test_band_is_carried_over_without_the_poses_passed():
    band = over()
    kept = prune_band(band, band[4, :3] + 0.01, GOAL, 3)
    assert len(kept) == len(band) - 4
    assert (kept[0, :3] == band[4, :3] + 0.01).all()
