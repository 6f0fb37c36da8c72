from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError, ImpossibleScenario
from arena_core.testing import component
from arena_kernels.distance import grid_distance


@settings(max_examples=40)
@given(
    offset=st.one_of(st.just(0.0), st.floats(-0.6, 0.6)),
    speeds=st.tuples(st.floats(0.3, 1.8), st.floats(0.3, 1.8)),
    angle=st.floats(0.0, 6.28),
    radius=st.floats(0.15, 0.4),
)
def test_two_who_meet_head_on_pass_without_touching(stage, orca, offset, speeds, angle, radius):
    c, s = np.cos(angle), np.sin(angle)
    ends = [np.array((10.0 + c * x - s * y, 10.0 + s * x + c * y)) for x, y in ((-4.0, 0.0), (4.0, offset))]
    people = [stage.person(k, ends[k], ends[1 - k], speed=speeds[k], radius=radius) for k in range(2)]
    walk = np.array(
        [
            crowd.positions[0]
            for crowd in stage.walk(orca, [stage.scenario(stage.hall(20, 20), people)], 9.5 / min(speeds))
        ]
    )
    assert np.hypot(*(walk[:, 0] - walk[:, 1]).T).min() >= 2.0 * radius - 1e-3
    assert all(np.hypot(*(walk[-1, k] - ends[1 - k])) < 0.6 for k in range(2))


def test_nobody_walks_through_walls_or_faster_than_may_be(stage, orca):
    hall = stage.hall(20, 20, stage.racks)
    scenario = stage.crowded(hall, 40, 3)
    speeds = np.array([spec.desired_speed for spec in scenario.pedestrians])
    room, before = hall.derive(grid_distance), None
    for crowd in stage.walk(orca, [scenario], 60.0):
        cells = hall.cells(crowd.positions[0])
        assert room[cells[:, 0], cells[:, 1]].min() > 0.3 - 0.03
        assert (np.hypot(*crowd.velocities[0].T) <= speeds + 1e-9).all()
        if before is not None:
            assert (np.hypot(*(crowd.positions[0] - before).T) <= 0.05 * speeds + 0.02).all()
        before = crowd.positions[0]


def test_people_reach_their_waypoints_round_walls(stage, orca):
    hall = stage.hall(12, 8, [(4.0, 0.0, 4.2, 6.5), (8.0, 1.5, 8.2, 8.0)])
    scenario = stage.scenario(hall, [stage.person(0, (1, 1), (11, 7))])
    positions = np.array([crowd.positions[0, 0] for crowd in stage.walk(orca, [scenario], 40.0)])
    assert np.hypot(*(positions[-1] - (11, 7))) < 0.6
    assert np.hypot(*np.diff(positions, axis=0).T).sum() < 21.0


def test_who_is_pushed_out_of_sight_of_the_way_finds_back(stage, orca):
    hall = stage.hall(12, 8, [(4.0, 0.0, 6.0, 5.0)])
    crowd = orca.reset(np.zeros(1, np.int64), [stage.scenario(hall, [stage.person(0, (2, 1), (8, 1))])], 1)
    for tick in range(500):
        if tick == 145:  # just round the second corner, on the way down
            assert crowd.positions[0, 0, 0] > 5.8
            crowd.positions[0, 0] = (3.5, 4.0)
        crowd = orca.step(crowd, stage.robots(), np.full(1, tick), 0.05)
    assert np.hypot(*(crowd.positions[0, 0] - (8, 1))) < 0.6


def test_who_is_pushed_away_from_the_only_waypoint_walks_back(stage, orca):
    crowd = orca.reset(np.zeros(1, np.int64), [stage.scenario(stage.hall(12, 8), [stage.person(0, (2, 1), (6, 1))])], 1)
    for tick in range(300):
        if tick == 120:
            assert crowd.states[0, 0] == 1
            crowd.positions[0, 0] = (9.0, 6.0)
        crowd = orca.step(crowd, stage.robots(), np.full(1, tick), 0.05)
    assert np.hypot(*(crowd.positions[0, 0] - (6, 1))) < 0.6


def test_bodies_hardly_overlap_in_a_crowd(stage, orca):
    scenario = stage.crowded(stage.hall(20, 20), 60, 5)
    gaps = []
    for crowd in stage.walk(orca, [scenario], 30.0):
        apart = np.hypot(*(crowd.positions[0][:, None] - crowd.positions[0][None]).transpose(2, 0, 1))
        gaps.append(apart[np.triu_indices(60, 1)].min() - 0.6)
    assert min(gaps) > -0.1
    assert np.mean(gaps) > -0.02


def test_a_world_of_a_batch_walks_as_it_does_alone(stage, orca):
    scenarios = [stage.crowded(stage.hall(20, 20, stage.racks), 12 + 25 * k, k, f"stage/{k}") for k in range(3)]
    together = list(stage.walk(orca, scenarios, 10.0))[-1]
    for k, scenario in enumerate(scenarios):
        alone = list(stage.walk(orca, [scenario], 10.0))[-1].world(0)
        assert np.array_equal(together.world(k).positions, alone.positions)
        assert np.array_equal(together.world(k).velocities, alone.velocities)


def test_a_world_that_begins_anew_leaves_the_others_alone(stage, orca):
    scenarios = [stage.crowded(stage.hall(20, 20), 10, k, f"stage/{k}") for k in range(2)]
    before = list(stage.walk(orca, scenarios, 5.0))[-1]
    crowd = orca.reset(np.array([1]), [stage.crowded(stage.hall(20, 20), 30, 7)], 2)
    assert crowd.counts.tolist() == [10, 30]
    assert np.array_equal(crowd.world(0).positions, before.world(0).positions)
    crowd = orca.step(crowd, stage.robots(worlds=2), np.zeros(2, np.int64), 0.05)
    alone = list(stage.walk(orca, scenarios[:1], 5.05))[-1]
    assert np.array_equal(crowd.world(0).positions, alone.world(0).positions)


def test_people_who_ignore_robots_walk_alike_wherever_the_robot_is(stage, orca):
    scenario = stage.crowded(stage.hall(10, 10), 8, 2)
    near = list(stage.walk(orca, [scenario], 8.0, stage.robots((5.0, 5.0, 0.0))))[-1]
    far = list(stage.walk(orca, [scenario], 8.0))[-1]
    assert np.array_equal(near.positions, far.positions)


@pytest.mark.parametrize("velocity", [(0.0, 0.0), (-0.5, 0.0)])
def test_people_who_yield_go_round_a_robot_in_their_way(stage, velocity):
    model = component("pedestrians", "orca", ["pedestrians.reaction=yield"])
    scenario = stage.scenario(stage.hall(14, 8), [stage.person(0, (2, 4), (12, 4), speed=1.2)])
    crowd = model.reset(np.zeros(1, np.int64), [scenario], 1)
    gaps = []
    for tick in range(300):
        robot = np.array((8.0 + velocity[0] * tick * 0.05, 4.0, 0.0))
        crowd = model.step(crowd, stage.robots(robot, velocity), np.full(1, tick), 0.05)
        gaps.append(np.hypot(*(crowd.positions[0, 0] - robot[:2])) - 0.5)
    assert min(gaps) > 0.1
    assert crowd.positions[0, 0, 0] > 11.4


def test_who_has_arrived_at_the_only_waypoint_stands_there(stage, orca):
    scenario = stage.scenario(stage.hall(10, 10), [stage.person(0, (2, 2), (6, 6)), stage.person(1, (8, 2))])
    crowd = list(stage.walk(orca, [scenario], 12.0))[-1]
    assert crowd.states[0].tolist() == [1, 1]
    assert np.hypot(*crowd.velocities[0].T).max() == 0.0
    assert np.hypot(*(crowd.positions[0] - [(6, 6), (8, 2)]).T).max() < 0.6


@pytest.mark.parametrize(("at", "where"), [((5.0, 5.0), "inside a wall"), ((50.0, 5.0), "off the map")])
def test_an_impossible_start_is_one_line(stage, orca, at, where):
    hall = stage.hall(10, 10, [(4.0, 4.0, 6.0, 6.0)])
    with pytest.raises(ImpossibleScenario, match=rf"person 7 starts at .*{where}"):
        orca.reset(np.zeros(1, np.int64), [stage.scenario(hall, [stage.person(7, at, (1, 1))])], 1)


def test_an_impossible_number_is_refused():
    with pytest.raises(ConfigurationError, match=r"pedestrians.neighbours is 0; allowed: >= 1"):
        component("pedestrians", "orca", ["pedestrians.neighbours=0"])


def test_who_pauses_stays_at_a_waypoint_for_a_drawn_time(stage, orca):
    person = replace(
        stage.person(0, (4.0, 3.0), (3.0, 3.0), (9.0, 3.0), speed=1.2),
        behaviour={"pause_probability": 1.0, "pause_time": 4.0},
    )
    states = np.array(
        [crowd.states[0, 0] for crowd in stage.walk(orca, [stage.scenario(stage.hall(12, 6), [person])], 120.0)]
    )
    edges = np.flatnonzero(np.diff(np.r_[0, (states == 1).astype(int), 0])).reshape(-1, 2)
    stays = 0.05 * np.diff(edges, axis=1)[:-1, 0]
    assert len(stays) >= 8
    assert 1.9 <= stays.min() < stays.max() <= 6.1
