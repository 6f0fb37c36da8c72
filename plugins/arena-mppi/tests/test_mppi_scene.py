import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import Footprint, Pose
from arena_core.hosting import straight_predictions
from arena_mppi.critics import FAR
from arena_mppi.scene import body_of, predict_tracks, resample_path, scene_of, static_window
from arena_mppi.settings import CriticSettings, Goal, Motion, Moving, PathCritics, Progress, Static
from arena_mppi.weights import critics_of

MOVING = Moving(
    weight=20.0,
    contact_cost=300.0,
    margin=0.5,
    reaction_time=0.1,
    belief_time=2.0,
    growth=1.0,
    growth_max=0.3,
    speed_min=0.1,
)
PROGRESS = Progress(weight=8.0, end_share=0.5, comfort_gap=0.4, comfort_cost=2.0, blocked_cost=50.0)
TIMES = np.arange(1, 5) * 0.5


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.floats(0.05, 1.0), st.floats(0.05, 1.0), st.floats(-0.49, 0.49), st.floats(-0.49, 0.49))
def test_discs_cover_a_polygon_and_little_more(length, width, x, y):
    corners = np.array(
        [((x + sx / 2) * length, (y + sy / 2) * width) for sx, sy in ((1, -1), (1, 1), (-1, 1), (-1, -1))]
    )
    body = body_of(Footprint.polygon(corners.tolist()))
    points = np.random.default_rng(0).uniform(corners.min(axis=0), corners.max(axis=0), (200, 2))
    distances = np.hypot(*(points[:, None] - body.discs[:, :2]).transpose(2, 0, 1)) - body.discs[:, 2]
    assert (distances.min(axis=1) <= 1e-6).all()
    assert body.discs[0, 2] <= 0.5 * min(length, width) * 1.45


def test_a_circle_is_one_disc():
    assert body_of(Footprint.circle(0.2)).discs.tolist() == [pytest.approx([0.0, 0.0, 0.2])]


def test_people_are_expected_where_their_velocity_leads_and_larger_with_time(people):
    tracks = people((2.0, 1.0, -0.5, 0.0), (0.5, 0.5, 0.0, 0.2))
    places = predict_tracks(tracks, straight_predictions(tracks).seen_from(1.0, 1.0), TIMES, MOVING)
    assert places.shape == (4, 2, 3)
    np.testing.assert_allclose(places[:, 1, 0], 1.0 - 0.5 * TIMES, atol=1e-6)
    np.testing.assert_allclose(places[:, 0, 1], -0.5 + 0.2 * TIMES, atol=1e-6)
    np.testing.assert_allclose(places[:, 0, 2], 0.3 + np.minimum(0.1 * np.sqrt(1.0 + TIMES**2), 0.3), atol=1e-6)


def test_only_moving_people_are_taken_out_of_the_walls(observe, costmap, people):
    boxes = costmap((0.8, 1.2, -0.2, 0.2), (-1.2, -0.8, -0.2, 0.2))
    view = observe(
        boxes, Pose(0.0, 0.0), [(0.0, 0.0), (2.0, 0.0)], tracks=people((1.0, 0.0, 0.5, 0.0), (-1.0, 0.0, 0.05, 0.0))
    )
    window = static_window(view, 0.1)
    assert window.costs[60, 80] == 0
    assert window.costs[60, 40] == 254


def test_empty_window_is_open_everywhere(observe, costmap):
    view = observe(costmap(), Pose(0.5, 0.2), [(0.0, 0.0), (2.0, 0.0)])
    scene = scene_of(view, static_window(view, 0.1), body_of(Footprint.circle(0.2)), MOVING, PROGRESS, 0.05, 8, 3.0)
    assert (scene.gaps == FAR).all()
    assert scene.left.max() < 6.5
    assert scene.moving.shape == (8, 0, 3)


def test_path_is_spaced_evenly_from_the_robot_on():
    route = np.array([(0.1 * k, 0.0, 0.0) for k in range(30)])
    points = resample_path(route, 10, 1.0, 0.5, 0.6)
    np.testing.assert_allclose(points, [(0.05 * k, -0.5) for k in range(13)], atol=1e-6)
    assert resample_path(route[:1], 0, 0.0, 0.0, 0.6).shape == (1, 2)


def critics(speed, distance, patience=1.0):
    settings = CriticSettings(
        Static(
            weight=1.0,
            inflation_radius=0.5,
            critical_cost=1.0,
            near_collision_gap=0.1,
            reaction_time=0.0,
            collision_gap=0.03,
            eased=True,
        ),
        MOVING,
        Goal(weight=5.0, within=0.5, angle_weight=2.0, angle_within=0.4),
        PathCritics(
            align_weight=3.0,
            follow_weight=1.0,
            follow_ahead=0.3,
            angle_weight=4.0,
            angle_ahead=0.5,
            angle_tolerance=0.7,
        ),
        PROGRESS,
        Motion(constraint_weight=4.0, forward_weight=20.0, forward_until=0.3, twirling_weight=0.2),
        [],
    )
    return critics_of(settings, speed, distance, patience)


def test_goal_takes_over_from_the_path_when_it_is_near():
    far, near = critics(1.0, 2.0), critics(1.0, 0.35)
    assert (far.goal, far.goal_angle, far.align, far.follow, far.angle) == (0.0, 0.0, 3.0, 1.0, 4.0)
    assert (near.goal, near.goal_angle, near.align, near.follow, near.angle) == (5.0, 2.0, 0.0, 0.0, 0.0)
    assert (far.forward, critics(1.0, 0.2).forward) == (20.0, 0.0)


def test_impatience_wants_less_room_and_still_no_contact():
    calm, hurried = critics(1.0, 2.0), critics(1.0, 2.0, 0.1)
    assert (hurried.static, hurried.critical, hurried.moving) == pytest.approx(
        (0.1 * calm.static, 0.1 * calm.critical, 0.1 * calm.moving)
    )
    assert (hurried.contact, hurried.collision_gap) == (calm.contact, calm.collision_gap)


def test_ways_are_weighed_by_the_time_that_they_take():
    slow, fast = critics(0.2, 2.0), critics(2.0, 2.0)
    assert math.isclose(slow.progress, 10.0 * fast.progress, rel_tol=1e-5)
    assert math.isclose(slow.forward, 10.0 * fast.forward, rel_tol=1e-5)
