"""The controls that follow the path at a creep, and the weights by the distance from the goal, worked out by hand."""

import math

import numpy as np
import pytest

from arena_core.hosting import compose, to_plain
from arena_core.parameters import read_settings
from arena_kernels.costmap_window import window_of
from arena_mppi.parameters import Chassis, Scene
from arena_mppi.path_following import _velocity_towards, center_path, follow_path, gaps_at
from arena_mppi.settings import CriticSettings
from arena_mppi.weights import critics_of

SINGLE = np.float32


def chassis(vy_max=0.0, turn_at_rest=math.inf, curvature=0.0, change=9.0):
    return Chassis(*map(SINGLE, (-0.5, 0.5, vy_max, 2.0, change, change, change, turn_at_rest, curvature)))


@pytest.mark.parametrize(
    ("bearing", "speed", "command"),
    [
        (0.0, 0.2, (0.2, 0.0, 0.0)),
        (0.1, 0.2, (0.2 * 0.75, 0.0, 0.3)),
        (-0.3, 0.2, (0.2 * 0.25, 0.0, -0.9)),
        (0.5, 0.2, (0.0, 0.0, 1.5)),
        (-2.0, 0.2, (0.0, 0.0, -2.0)),
        (0.0, 0.9, (0.5, 0.0, 0.0)),
    ],
)
def test_a_robot_turns_first_and_drives_the_slower_the_farther_aside_a_point_lies(bearing, speed, command):
    assert _velocity_towards(bearing, speed, chassis()) == pytest.approx(command)


def test_a_holonomic_robot_goes_straight_to_a_point_without_turning():
    towards = _velocity_towards(0.6, 0.2, chassis(vy_max=0.1))
    assert towards == pytest.approx((0.2 * math.cos(0.6), 0.1 * math.sin(0.6), 0.0))
    towards = _velocity_towards(-0.6, 0.2, chassis(vy_max=0.5))
    assert towards == pytest.approx((0.2 * math.cos(0.6), -0.2 * math.sin(0.6), 0.0))


@pytest.mark.parametrize(("bearing", "turn"), [(0.1, 0.3), (1.0, 0.4), (-1.0, -0.4)])
def test_a_car_turns_no_tighter_than_it_can(bearing, turn):
    car = chassis(turn_at_rest=0.0, curvature=2.0)
    assert _velocity_towards(bearing, 0.2, car) == pytest.approx((0.2, 0.0, turn))


@pytest.fixture
def scene(costmap):
    """Return an open scene of 4 m: its gaps are 1 m, its path leads along x."""
    ones, corner = np.ones((40, 40), np.float32), (SINGLE(-2.0), SINGLE(-2.0), SINGLE(0.1))
    path = np.array([(0.05 * k, 0.0) for k in range(21)], np.float32)
    moving, belief = np.zeros((3, 0, 3), np.float32), np.ones(3, np.float32)
    return Scene(
        ones, *corner, ones, *corner, moving, belief, path, np.ones(4, np.float32), window_of(costmap()), 0.0, 0.0
    )


def led(scene, state, **given):
    """Return where the controls lead, (T, 3), and them."""
    out = follow_path(scene, 0.2, chassis(**given), np.array((*state, 0.0, 0.0, 0.0), np.float32), 0.2, 0.1, 60)
    headings = math.atan2(state[1], state[0]) + np.cumsum(out[:, 2] * 0.1)
    x = np.cumsum(0.1 * (out[:, 0] * np.cos(headings) - out[:, 1] * np.sin(headings)))
    y = np.cumsum(0.1 * (out[:, 0] * np.sin(headings) + out[:, 1] * np.cos(headings)))
    return np.column_stack((x, y, headings)), out


def test_a_straight_path_is_followed_at_the_speed_given_and_slower_before_its_end(scene):
    poses, out = led(scene, (1.0, 0.0))
    assert out[:40, 0].max() == pytest.approx(0.2)
    assert out[:40, 0].min() >= 0.149, "the point ahead is 0.075 m off at least"
    assert np.abs(out[:, 1:]).max() == 0.0
    left = 1.0 - poses[49:-1, 0]
    assert out[50:, 0] == pytest.approx(0.2 * left / 0.1, rel=1e-4), "in proportion within 0.1 m of the end"


@pytest.mark.parametrize("turned", [0.9, -0.9])
def test_a_robot_that_looks_aside_turns_to_the_path_and_follows_it(scene, turned):
    poses, out = led(scene, (math.cos(turned), math.sin(turned)))
    assert out[0] == pytest.approx((0.0, 0.0, -math.copysign(2.0, turned)))
    assert poses[-1, :2] == pytest.approx((0.9, 0.0), abs=0.12)
    assert abs(poses[-1, 2]) < 0.1


def test_a_holonomic_robot_keeps_its_heading(scene):
    poses, _ = led(scene, (0.0, 1.0), vy_max=0.5)
    assert poses[-1, :2] == pytest.approx((0.99, 0.0), abs=0.02)
    assert poses[:, 2] == pytest.approx(np.full(60, 0.5 * math.pi))


def test_controls_change_no_faster_than_the_robot_can(scene):
    _, out = led(scene, (1.0, 0.0), change=0.05)
    assert out[:5, 0] == pytest.approx((0.05, 0.1, 0.15, 0.2, 0.2))


def test_gaps_are_interpolated_and_at_the_edge_the_edges(scene):
    centres = -1.95 + 0.1 * np.arange(40)
    sloped = scene._replace(gaps=(2.0 + centres[None, :] + 0.5 * centres[:, None]).astype(np.float32))
    places = np.array([(0.0, 0.0), (0.33, -0.71), (-9.0, 0.4), (9.0, 9.0)])
    by_hand = [2.0, 2.33 - 0.355, 0.05 + 0.2, 3.95 + 0.975]
    assert gaps_at(sloped, places) == pytest.approx(by_hand, abs=2e-4)


@pytest.mark.parametrize(("slope", "aside"), [(1.0, 0.1), (-1.0, -0.1), (0.05, 0.0), (0.0, 0.0)])
def test_a_path_is_moved_aside_to_where_there_is_more_room(scene, slope, aside):
    """By 0.1 m at most, and only where a metre aside is worth more than 0.1 m of room."""
    centres = -1.95 + 0.1 * np.arange(40)
    gaps = np.repeat((0.3 + slope * centres)[:, None], 40, axis=1).astype(np.float32)
    found = center_path(scene._replace(gaps=gaps), 0.2)
    assert found[:, 1] == pytest.approx(np.full(21, aside), abs=1e-6)
    assert found[:, 0] == pytest.approx(scene.path[:, 0])


def test_more_room_than_is_looked_for_moves_no_path(scene):
    centres = -1.95 + 0.1 * np.arange(40)
    wide = np.repeat((0.6 + centres)[:, None], 40, axis=1).astype(np.float32)
    assert center_path(scene._replace(gaps=wide), 0.2)[:, 1] == pytest.approx(np.zeros(21), abs=1e-6)


@pytest.fixture(scope="module")
def settings():
    node = to_plain(compose(["planner=mppi", "robot=jackal"], "component")["planner"])
    names = CriticSettings.__dataclass_fields__
    return read_settings({name: node[name] for name in names}, CriticSettings, "mppi")


def test_critics_of_the_goal_take_over_from_those_of_the_path(settings):
    within = settings.goal.within
    far, near = (critics_of(settings, 0.5, within + off, 1.0) for off in (0.0, -0.01))
    assert (far.goal, near.goal) == (0.0, pytest.approx(settings.goal.weight))
    for name in ("align", "follow", "angle"):
        assert (getattr(far, name), getattr(near, name)) == (
            pytest.approx(getattr(settings.path, f"{name}_weight")),
            0.0,
        )
    turn = settings.goal.angle_within
    angles = [critics_of(settings, 0.5, turn + off, 1.0).goal_angle for off in (0.0, -0.01)]
    assert angles == [0.0, pytest.approx(settings.goal.angle_weight)]
    until = settings.motion.forward_until
    forward = [critics_of(settings, 0.5, until + off, 1.0).forward for off in (0.0, 0.01)]
    assert forward == [0.0, pytest.approx(settings.motion.forward_weight / 0.5)]


def test_of_the_wish_for_room_only_the_part_patience_counts(settings):
    whole, part = (critics_of(settings, 0.5, 9.0, patience) for patience in (1.0, 0.25))
    for name in ("static", "critical", "moving"):
        assert getattr(part, name) == pytest.approx(0.25 * getattr(whole, name))
    assert part.contact == whole.contact == pytest.approx(settings.moving.contact_cost)
    assert critics_of(settings, 0.25, 9.0, 1.0).progress == pytest.approx(4.0 * settings.progress.weight)
