"""Which obstacles count for a pose, polygons in place of cells, and what an
exponent makes of a gap that is too small.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from arena_core import Pose, Predictions, Twist
from arena_core.testing import component, view
from arena_kernels.costmap_window import LETHAL
from arena_kernels.footprint import gap_to_convex, make_body, place_body
from arena_teb.association import FORCED_FROM, Reach, associate_points
from arena_teb.parameters import Obstacles, Polygons
from arena_teb.planner import nearest_tracks
from arena_teb.polygons import NO_HULLS, cluster_cells, hulls_of

SETTINGS = Polygons(cluster_max_distance=0.4, cluster_min_pts=2, cluster_max_pts=30, min_pt_separation=0.1)
AHEAD = np.array([(0.0, 0.0, 0.0, 0.3)])


def polygons(hulls):
    return [hulls.corners[a:b] for a, b in zip(hulls.starts[:-1], hulls.starts[1:], strict=True)]


def finite(points):
    return points[np.isfinite(points).all(axis=1)]


def test_every_cell_lies_in_or_near_a_convex_polygon(window):
    here = window((0.5, 1.2, 0.2, 0.6), (-1.0, -0.95, -2.0, 1.0), (1.5, 1.51, -1.51, -1.5))
    hulls = polygons(hulls_of(here, SETTINGS))
    rows, columns = np.nonzero(here.costs >= LETHAL)
    cell = make_body(np.empty((0, 2)), 0.001)
    for x, y in zip(here.origin_x + (columns + 0.5) * 0.05, here.origin_y + (rows + 0.5) * 0.05, strict=True):
        place_body(cell, x, y, 0.0)
        assert min(gap_to_convex(cell, hull)[0] for hull in hulls) <= SETTINGS.min_pt_separation
    for hull in hulls:
        sides = np.roll(hull, -1, axis=0) - hull
        following = np.roll(sides, -1, axis=0)
        assert len(hull) < 3 or (sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0] > 0.0).all()


def test_clusters_hold_at_most_so_many_cells_and_a_cell_alone_is_one(window):
    lethal = window((-2.0, 2.0, 0.0, 0.2), (1.0, 1.01, 2.0, 2.01)).costs >= LETHAL
    cells, labels = cluster_cells(lethal, 8.0, 2, 30)
    assert len(cells) == lethal.sum()
    assert len(np.unique(cells, axis=0)) == len(cells)
    sizes = np.bincount(labels)
    assert sizes.max() == 30
    assert 1 in sizes


def test_two_bodies_apart_are_two_polygons(window):
    here = window((0.5, 0.6, 0.5, 0.6), (0.5, 0.6, -0.6, -0.5))
    assert len(polygons(hulls_of(here, SETTINGS))) == 2
    assert len(polygons(hulls_of(window(), SETTINGS))) == 0


def test_pose_is_paired_with_the_nearest_points_of_polygons(window):
    here = window((-0.5, 0.5, 0.5, 0.6), (-0.5, 0.5, -0.8, -0.7))
    (points,) = associate_points(AHEAD, here, hulls_of(here, SETTINGS), Reach(1.0, 0.0))
    np.testing.assert_allclose(points, [(0.0, 0.525), (0.0, -0.725)], atol=0.06)


def test_pose_inside_a_polygon_is_pushed_to_its_nearest_side(window):
    here = window((-0.2, 0.2, -0.1, 0.7), (-0.3, 0.3, 0.2, 0.3))
    pose = np.array([(0.0, 0.0, 0.0, 0.3)])
    (points,) = associate_points(pose, here, hulls_of(here, Polygons(0.4, 2, 10**6, 0.0)), Reach(1.0, 0.0))
    (point,) = finite(points)
    assert point[1] > 0.0  # the nearest side lies below
    assert np.hypot(*point) < 0.01


def test_near_points_are_forced_to_count_beside_the_nearest_left_and_right(window):
    here = window((0.3, 0.31, 0.2, 0.21), (-0.31, -0.3, 0.2, 0.21), (0.0, 0.01, 0.8, 0.81), (0.0, 0.01, -0.71, -0.7))
    (few,) = associate_points(AHEAD, here, NO_HULLS, Reach(1.0, 0.0))
    (more,) = associate_points(AHEAD, here, NO_HULLS, Reach(1.0, 0.5))
    assert len(finite(few)) == 2
    assert len(more) == FORCED_FROM + 2
    np.testing.assert_allclose(more[:2, 1], (0.8, -0.7), atol=0.06)  # forced ones are no one's nearest
    assert set(np.sign(more[FORCED_FROM:, 0])) == {-1.0, 1.0}


def test_inner_cells_of_a_thick_wall_are_not_forced_to_count(window):
    thick = window((-1.0, 1.0, 0.2, 0.8))
    (points,) = associate_points(AHEAD, thick, NO_HULLS, Reach(1.0, 0.4))
    assert np.allclose(finite(points)[FORCED_FROM:, 1], finite(points)[FORCED_FROM:, 1].min(), atol=0.01)


def of(**changes):
    base = component("planner", "teb", (), "jackal", robot=component("robot", "jackal"))._obstacles
    return Obstacles(**{name: getattr(base, name) for name in Obstacles.__slots__} | changes)


def test_slow_tracks_stay_cells(people):
    tracks = people((1.0, 0.0, 0.05, 0.0), (2.0, 0.0, 0.0, -0.3))
    assert nearest_tracks(view(tracks=tracks), of(static_below=0.0)).tolist() == [0, 1]
    assert nearest_tracks(view(tracks=tracks), of(static_below=0.1)).tolist() == [1]


def test_who_stands_and_will_walk_moves(people):
    tracks = people((1.0, 0.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0))
    means = np.array((((1.0, 0.0), (1.0, 0.0)), ((2.0, 0.0), (2.0, 0.5))))
    ahead = Predictions.of(np.array((0.0, 1.0)), means, np.zeros((2, 2, 2, 2)))
    seen = replace(view(tracks=tracks), _predictions=lambda: ahead)
    assert nearest_tracks(seen, of(static_below=0.1)).tolist() == [1]


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["turtlebot3", "jackal", "robotino"])
def test_as_released_takes_people_for_cells(robot, build, observe, costmap, people):
    person = costmap((0.9, 1.3, 0.3, 0.8))
    commands = []
    for tracks in (people(), people((1.0, 0.0, 0.0, 1.0))):
        planner = build(robot, preset="teb_as_released")
        path = [(0.1 * k, 0.0) for k in range(26)]
        commands.append(
            [
                planner.compute_velocity(observe(person, Pose(0.0, 0.0), path, Twist(0.2), 0.1 * k, tracks))
                for k in range(3)
            ]
        )
    assert commands[0] == commands[1]


def test_greater_exponent_lets_the_robot_nearer(build, observe, costmap):
    gaps = []
    for exponent in (1.0, 4.0):
        planner = build(
            "jackal",
            f"planner.optimisation.obstacle_cost_exponent={exponent}",
            "planner.obstacles.min_obstacle_dist=0.4",
        )
        pose, twist, least = Pose(-1.5, 0.0), Twist(0.0), math.inf
        post = costmap((-0.05, 0.05, 0.05, 0.15))
        for step in range(60):
            twist = planner.compute_velocity(
                observe(post, pose, [(-1.5 + 0.1 * k, 0.0) for k in range(31)], twist, 0.1 * step)
            )
            pose = pose.compose(Pose(0.1 * twist.vx, 0.0, 0.1 * twist.wz))
            least = min(least, math.hypot(pose.x, pose.y - 0.1))
        gaps.append(least)
    assert gaps[1] < gaps[0] - 0.02


@pytest.mark.parametrize("robot", ["jackal", "robotino"])
def test_polygons_in_aio_as_released_are_gone_round(robot, build, observe, costmap):
    planner, pose, twist = build(robot, preset="teb_in_aio_as_released"), Pose(-2.0, 0.0), Twist(0.0)
    box = costmap((-0.2, 0.2, -0.3, 0.35))
    for step in range(200):
        twist = planner.compute_velocity(
            observe(box, pose, [(-2.0 + 0.1 * k, 0.0) for k in range(46)], twist, 0.1 * step)
        )
        assert twist.vx <= 1.4 + 1e-9
        pose = pose.compose(Pose(0.1 * twist.vx, 0.1 * twist.vy, 0.1 * twist.wz))
        assert math.hypot(max(abs(pose.x) - 0.2, 0.0), max(abs(pose.y - 0.025) - 0.325, 0.0)) > 0.1
        if pose.distance(Pose(2.5, 0.0)) < 0.4:
            break
    assert pose.distance(Pose(2.5, 0.0)) < 0.4
