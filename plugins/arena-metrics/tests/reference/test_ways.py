"""Ways that are searched are driven by the simulator as they were searched, and touch nothing."""

import math
from dataclasses import replace

import numpy as np
import pytest

from arena_core import OccupancyGrid, Pose
from arena_reference.bounds import Bound
from arena_reference.outlook import foresee, start_state
from arena_reference.ways import find_certified, join_walks, rehearse

PEOPLE = (((0.0, -2.0), (0.0, 2.0), 0.7), ((0.6, 2.0), (0.6, -2.0), 0.9), ((-0.6, 1.5), (-0.6, -1.5), 0.5))


@pytest.mark.parametrize("kinematics", ["differential", "omnidirectional", "ackermann"])
def test_a_way_is_driven_as_it_was_searched(stage, kinematics: str) -> None:
    set_up = stage(kinematics, PEOPLE)
    people = foresee(set_up.truth, set_up.finder.horizon(set_up.truth), 0.1)
    way = find_certified(set_up.truth, set_up.finder, people, 3)
    assert way is not None
    assert way.arrives
    fork, contacts = set_up.truth.fork(), 0
    for command, state in zip(way.commands, way.states[1:], strict=True):
        snapshot = fork.advance(command[None], 10)
        contacts += len(snapshot.contacts[0])
        assert snapshot.poses[0] == pytest.approx(state[:3], abs=1e-9)
        assert snapshot.twists[0] == pytest.approx(state[3:], abs=1e-9)
    assert contacts == 0
    assert math.dist(snapshot.poses[0, :2], (1.5, 0.0)) <= set_up.scenario.goal_radius


def test_no_certificate_is_sooner_than_the_bound(stage) -> None:
    for kinematics in ("differential", "omnidirectional"):
        set_up = stage(kinematics, PEOPLE)
        people = foresee(set_up.truth, 40.0, 0.1)
        bound = Bound(set_up.robot, set_up.scenario, set_up.finder.site.terrain(set_up.scenario, 0.025))
        way = find_certified(set_up.truth, set_up.finder, people, 3)
        assert way is not None
        assert bound.time() <= bound.time(people) <= way.arrival <= 1.5 * bound.time(people) + 1.0


def test_alone_a_way_is_nearly_as_short_as_the_bound(stage) -> None:
    set_up = stage()
    way = find_certified(set_up.truth, set_up.finder, foresee(set_up.truth, 20.0, 0.1), 1)
    bound = Bound(set_up.robot, set_up.scenario, set_up.finder.site.terrain(set_up.scenario, 0.025)).time()
    reach = set_up.scenario.goal_radius
    exact = (3.0 - reach) / 1.0 + 0.5 * 1.0 / 2.0  # at the greatest speed, from rest
    assert way is not None
    assert exact - 0.1 <= way.arrival <= exact + 0.3
    assert exact - 0.6 <= bound <= exact  # the goal is wider by the slack of arrivals


def test_who_reacts_is_walked_round_as_they_then_walk(stage) -> None:
    set_up = stage("differential", PEOPLE, reaction="yield")
    people = foresee(set_up.truth, 30.0, 0.1)
    way = find_certified(set_up.truth, set_up.finder, people, 6)
    assert way is not None
    assert rehearse(set_up.truth, way).touched == math.inf


def test_walled_in_there_is_no_way(stage) -> None:
    set_up = stage(start=Pose(-1.5, 0.0))
    cells = np.array(set_up.scenario.world.grid.data)
    wall = set_up.scenario.world.grid.cells((0.0, 0.0))[1]
    cells[:, wall] = 100
    grid = set_up.scenario.world.grid
    walled = replace(
        set_up.scenario, world=replace(set_up.scenario.world, grid=OccupancyGrid(cells, grid.resolution, grid.origin))
    )
    set_up.truth.scenario = walled
    bound = Bound(set_up.robot, walled, set_up.finder.site.terrain(walled, 0.025))
    people = foresee(set_up.truth, 5.0, 0.1)
    assert bound.time() == math.inf
    assert find_certified(set_up.truth, set_up.finder, people, 1) is None


def test_a_search_changes_nothing_in_the_world(stage) -> None:
    one, other = stage("differential", PEOPLE), stage("differential", PEOPLE)
    find_certified(one.truth, one.finder, foresee(one.truth, 20.0, 0.1), 3)
    for _ in range(30):
        a, b = (each.loop.drive(np.array(((0.5, 0.0, 0.2),))) for each in (one, other))
        assert np.array_equal(a.poses, b.poses)
        assert np.array_equal(a.crowd.positions, b.crowd.positions)


def test_walks_are_joined_without_a_leap(stage) -> None:
    people = foresee(stage("differential", PEOPLE).truth, 3.0, 0.1)
    walked = people.positions[:11] + np.linspace(0.0, 0.5, 11)[:, None, None]
    joined = join_walks(people, walked)
    assert np.array_equal(joined.positions[:11], walked)
    steps = np.abs(np.diff(joined.positions, axis=0)).max()
    assert steps <= np.abs(np.diff(walked, axis=0)).max() + np.abs(np.diff(people.positions, axis=0)).max()


def test_the_state_of_the_start_is_that_of_the_robot(stage) -> None:
    set_up = stage()
    set_up.loop.drive(np.array(((0.5, 0.0, 0.2),)))
    state = set_up.truth.state()
    assert start_state(set_up.truth).tolist() == [*state.pose.array(), *state.twist.array()]
