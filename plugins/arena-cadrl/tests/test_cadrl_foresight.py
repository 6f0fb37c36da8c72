"""One step ahead: what each action leads to, what it is worth until then, and what the safety layer lets pass."""

import math

import numpy as np
import pytest

from arena_cadrl.parameters import OWN, PERSON, ROOM_POINTS
from arena_core import NoValidCommand, Pose, Twist
from arena_core.testing import boxes_costmap, tracked, view

ROBOTS = ("turtlebot3", "jackal", "robotino")
HORIZON = 0.8  # s that a Jackal's actions are followed
FULL = {"turtlebot3": 0.22, "jackal": 2.0, "robotino": 1.5}
FAR = tuple((0.1 * k, 0.0) for k in range(61))


def straight(sight):
    """Return the place of the fastest action that goes straight ahead."""
    off = np.abs(sight.commands[:, 1]) + np.abs(sight.commands[:, 2])
    return int(np.argmax(sight.commands[:, 0] - 100.0 * off))


@pytest.mark.parametrize("name", ROBOTS)
def test_first_action_stands_still_and_the_fastest_drives_at_full_speed(eyes, name):
    sight = eyes(name).observe(view())
    assert not sight.commands[0].any()
    assert math.isclose(np.hypot(*sight.commands[:, :2].T).max(), FULL[name])


@pytest.mark.parametrize("name", ROBOTS)
def test_full_speed_along_a_free_path_is_worth_what_the_discount_leaves_to_earn(eyes, name):
    sight = eyes(name).observe(view(twist=Twist(FULL[name]), path_xy=FAR))
    best = straight(sight)
    assert math.isclose(sight.gains[best] + sight.weights[best], 1.0, abs_tol=1e-6)
    assert sight.best_action(np.ones(len(sight.commands), np.float32)) == best
    assert sight.gains[0] < sight.gains[best]


def test_state_counts_from_the_robot_with_the_target_ahead(eyes):
    sight = eyes("jackal").observe(
        view(pose=Pose(0.0, 0.0, 0.0), twist=Twist(1.0), path_xy=FAR, tracks=tracked((1.5, 0.5, 0.0, -0.3)))
    )
    assert sight.now[1] == pytest.approx(1.0), "the target, 2 m on"
    assert sight.now[2:7] == pytest.approx([0.5, 0.0, 0.0, 1.0, 0.0])
    assert sight.now[7 : 8 + ROOM_POINTS] == pytest.approx(1.0)
    first = sight.now[OWN : OWN + PERSON]
    assert first[:2] == pytest.approx([1.5 / 4.0, 0.5 / 4.0])
    assert first[2:4] == pytest.approx([0.0, -0.2])
    assert first[4] == pytest.approx(0.3)
    assert first[6] == 1.0
    assert not sight.now[OWN + PERSON :].any()


def test_state_is_the_same_wherever_the_path_leads(eyes):
    ahead = eyes("jackal").observe(view(tracks=tracked((1.5, 0.5, 0.0, -0.3))))
    path = [(0.0, 0.1 * k) for k in range(26)]
    turned = eyes("jackal").observe(
        view(pose=Pose(0.0, 0.0, math.pi / 2.0), path_xy=path, tracks=tracked((-0.5, 1.5, 0.3, 0.0)))
    )
    assert turned.now == pytest.approx(ahead.now, abs=1e-4)


def test_people_are_seen_where_they_will_be(eyes):
    sight = eyes("jackal").observe(view(tracks=tracked((2.0, 1.0, 0.0, -0.4))))
    ahead = sight.ahead[0, OWN : OWN + 2]  # standing still
    assert ahead == pytest.approx([2.0 / 4.0, (1.0 - HORIZON * 0.4) / 4.0], abs=1e-6)


def beyond_braking(body):
    """Return how far ahead a person of 0.3 m stands, m, before whom a robot at full speed can just stop."""
    return body.limits.vx_max**2 / (2.0 * body.limits.ax_max) + body.footprint.radius + 0.3 + 0.1


def test_who_drives_into_a_person_pays_for_the_contact_and_has_no_future(eyes, robot):
    ahead = tracked((beyond_braking(robot("jackal")), 0.0, 0.0, 0.0))
    sight = eyes("jackal").observe(view(twist=Twist(2.0), path_xy=FAR, tracks=ahead))
    fastest = straight(sight)
    assert sight.weights[fastest] == 0.0
    assert sight.gains[fastest] < -0.3
    assert sight.weights[0] > 0.0


def test_passing_too_near_costs_comfort(eyes):
    gains = [
        eyes("jackal").observe(view(twist=Twist(2.0), path_xy=FAR, tracks=tracked((0.5, y, 0.0, 0.0)))).gains[0]
        for y in (0.55, 0.65, 1.5)
    ]
    assert gains[0] < gains[1] < gains[2]


@pytest.mark.parametrize("name", ROBOTS)
def test_safety_layer_forbids_what_cannot_be_braked_before_a_wall(eyes, robot, name):
    ahead = robot(name).footprint.radius + 0.02 + 0.3 * FULL[name]
    wall = boxes_costmap((ahead, ahead + 0.2, -3.0, 3.0))
    sight = eyes(name).observe(view(wall, twist=Twist(FULL[name])))
    assert not sight.allowed[straight(sight)]
    free = eyes(name).observe(view(twist=Twist(FULL[name])))
    assert free.allowed.all()


def test_robot_that_stands_too_near_a_wall_may_still_turn_and_back_off(eyes):
    sight = eyes("jackal").observe(view(boxes_costmap((0.24, 0.4, -3.0, 3.0))))
    assert sight.allowed[0]
    assert sight.allowed[sight.commands[:, 0] < 0.0].any()
    assert not sight.allowed[(sight.commands[:, 0] > 0.4) & (sight.commands[:, 2] == 0.0)].any()


def test_tracked_person_is_no_wall(eyes):
    person = boxes_costmap((0.8, 1.2, -0.2, 0.2))
    alone, both = (
        eyes("jackal").observe(view(person)),
        eyes("jackal").observe(view(person, tracks=tracked((1.0, 0.0, 0.0, 0.0)))),
    )
    assert alone.now[8] < both.now[8] == 1.0


def test_target_is_where_the_path_can_be_seen(eyes):
    corner = [*((0.1 * k, 0.0) for k in range(16)), *((1.5, 0.1 * k) for k in range(1, 16))]
    wall = boxes_costmap((0.3, 1.1, 0.35, 3.0))
    assert (
        eyes("jackal").observe(view(wall, path_xy=corner)).now[1] < eyes("jackal").observe(view(path_xy=corner)).now[1]
    )


def test_without_a_path_there_is_no_command(eyes):
    with pytest.raises(NoValidCommand, match="path is empty"):
        eyes("jackal").observe(view(path_xy=[]))


def test_nothing_is_chosen_where_nothing_is_allowed(eyes):
    sight = eyes("jackal").observe(view())
    sight.allowed[:] = False
    assert sight.best_action(np.zeros(len(sight.commands), np.float32)) is None


def test_foreseen_gap_below_the_margin_is_a_contact(eyes, robot):
    beside = tracked((beyond_braking(robot("jackal")), 0.53, 0.0, 0.0))
    passing = view(twist=Twist(2.0), path_xy=FAR, tracks=beside)
    bold, careful = (eyes("jackal", margin).observe(passing) for margin in (0.0, 0.1))
    fastest = straight(bold)
    assert bold.weights[fastest] > 0.0
    assert careful.weights[fastest] == 0.0
    assert careful.weights[0] > 0.0


def test_robot_in_contact_backs_off_rather_than_drives_through(eyes):
    sight = eyes("jackal").observe(view(path_xy=FAR, tracks=tracked((0.5, 0.0, 0.0, 0.0))))
    best = sight.best_action(np.ones(len(sight.commands), np.float32))
    assert sight.commands[best, 0] <= 0.0
    assert sight.gains[straight(sight)] < sight.gains[0]
