"""People who come later, leave at the end of their round and come back; their kinds; who is stuck."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import ABSENT, ConfigurationError, Crowd


def test_who_has_a_spawn_time_comes_at_that_time_at_the_start(stage, make_model):
    people = [stage.person(0, (2, 2), (8, 2), (2, 2)), stage.person(1, (2, 5), (8, 5), (2, 5), spawn_time=3.0)]
    walk = list(stage.walk(make_model(), stage.scenario(stage.hall(10, 7), people), 10.0))
    there = [not np.isnan(crowd.positions[0, 1, 0]) for crowd in walk]
    assert there.index(True) * 0.05 == pytest.approx(3.0, abs=0.1)
    assert there == sorted(there)
    assert walk[there.index(True)].positions[0, 1].tolist() == [2.0, 5.0]
    assert [int(crowd.states[0, 1]) == ABSENT for crowd in walk] == [not here for here in there]
    assert max(crowd.positions[0, 1, 0] for crowd in walk[there.index(True) :]) > 6.0
    assert {crowd.counts[0] for crowd in walk} == {2}
    assert walk[-1].ids[0].tolist() == [0, 1]


def test_the_absent_leave_the_others_as_if_they_did_not_exist(stage, make_model):
    for crowded in (8, 60):  # below and above the number from which on neighbours are sought by cells
        scenario = stage.crowded(stage.hall(25, 25), crowded, 3)
        absent = replace(scenario.pedestrians[2], behaviour={"spawn_time": 1000.0})
        others = (*scenario.pedestrians[:2], *scenario.pedestrians[3:])
        among = replace(scenario, pedestrians=(*scenario.pedestrians[:2], absent, *scenario.pedestrians[3:]))
        *_, crowd = stage.walk(make_model(), among, 5.0)
        *_, alone = stage.walk(make_model(), replace(scenario, pedestrians=others), 5.0)
        assert np.isnan(crowd.positions[0, 2]).all()
        assert np.delete(crowd.positions[0], 2, axis=0).tobytes() == alone.positions[0].tobytes()
        assert np.delete(crowd.velocities[0], 2, axis=0).tobytes() == alone.velocities[0].tobytes()


def test_who_has_ended_the_round_is_away_for_a_while_and_begins_it_anew(stage, make_model):
    scenario = stage.scenario(stage.hall(10, 5), [stage.person(0, (1, 2), (5, 2), (9, 2), respawn=1)])
    walk = list(stage.walk(make_model(), scenario, 30.0))
    positions = np.array([crowd.positions[0, 0] for crowd in walk])
    absent = np.isnan(positions[:, 0])
    leaves, comes = (
        np.flatnonzero(np.diff(absent.astype(int)) == 1),
        np.flatnonzero(np.diff(absent.astype(int)) == -1) + 1,
    )
    assert len(leaves) == len(comes) == 3 or len(leaves) == len(comes) + 1 == 3
    assert np.hypot(*(positions[leaves] - (9.0, 2.0)).T).max() < 0.55
    assert positions[comes].tolist() == [[1.0, 2.0]] * len(comes)
    assert (comes - leaves[: len(comes)]) * 0.05 == pytest.approx(2.0, abs=0.15)
    assert (np.diff(positions[~absent, 0]) > -8.5).all()


def test_who_comes_back_at_random_comes_at_waypoints_drawn_by_scenario_and_number(stage, make_model):
    corners = [(2.0, 2.0), (10.0, 2.0), (10.0, 10.0), (2.0, 10.0)]
    scenario = stage.scenario(stage.hall(12, 12), [stage.person(0, (2, 2), *corners, speed=3.0, respawn="random")])

    def places(problem):
        found, before = [], True
        for crowd in stage.walk(make_model(), problem, 200.0, dt=0.1):
            here = not np.isnan(crowd.positions[0, 0, 0])
            if here and not before:
                found.append(tuple(crowd.positions[0, 0]))
            before = here
        return found

    drawn = places(scenario)
    assert len(set(drawn)) == 4
    assert {min(np.hypot(*(np.array(place) - corner)) for corner in corners) < 0.5 for place in drawn} == {True}
    assert places(scenario) == drawn
    assert places(replace(scenario, name="other")) != drawn


def test_nobody_appears_near_the_robot_and_who_waits_comes_when_it_has_gone(stage, make_model):
    scenario = stage.scenario(stage.hall(12, 5), [stage.person(0, (2, 2), (10, 2), (2, 2), spawn_time=1.0)])
    model = make_model()
    crowd = model.reset(np.zeros(1, int), [scenario], 1)
    there = []
    for tick in range(200):
        crowd = model.step(
            crowd, stage.robots((4.0 if tick < 100 else 8.0, 2.0, 0.0), radius=0.25), np.full(1, tick), 0.05
        )
        there.append(not np.isnan(crowd.positions[0, 0, 0]))
    assert not any(there[:100])
    assert there.index(True) < 120


def test_nobody_appears_in_somebody_else(stage, make_model):
    people = [stage.person(0, (3, 2.2)), stage.person(1, (3, 2), (8, 2), (3, 2), spawn_time=1.0)]
    *_, crowd = stage.walk(make_model(), stage.scenario(stage.hall(12, 5), people), 5.0)
    assert np.isnan(crowd.positions[0, 1]).all()


def test_who_was_not_let_in_tries_again(stage, make_model):
    """A simulator keeps people out of the robot's place: the crowd that it gives then still has them absent."""
    scenario = stage.scenario(stage.hall(12, 5), [stage.person(0, (2, 2), (10, 2), (2, 2), spawn_time=0.5)])
    model = make_model()
    crowd = model.reset(np.zeros(1, int), [scenario], 1)
    for tick in range(80):
        crowd = model.step(crowd, stage.robots(), np.full(1, tick), 0.05)
        if tick < 40:
            nowhere = np.full((1, 1, 2), np.nan)
            crowd = Crowd(crowd.counts, crowd.ids, nowhere, nowhere.copy(), crowd.radii, np.zeros((1, 1), np.int8))
    assert crowd.positions[0, 0, 0] > 2.3


def test_people_who_come_and_go_are_the_same_alone_and_among_many_worlds(stage, make_model):
    hall = stage.hall(10, 10)

    def scenario(k):
        people = [
            stage.person(
                j, (1.5 + j, 2.0), (8.0 - j, 8.0), (2.0, 5.0), respawn=("random", 1)[j % 2], spawn_time=0.7 * j
            )
            for j in range(1 + k % 4)
        ]
        return replace(stage.scenario(hall, people), name=f"stage/{k}")

    scenarios = [scenario(k) for k in range(12)]
    robots = stage.robots((6.0, 2.0, 0.0), worlds=12)
    together = list(stage.walk(make_model(), scenarios, 40.0, robots))
    for k in (0, 5, 11):
        alone = list(stage.walk(make_model(), scenarios[k], 40.0, stage.robots((6.0, 2.0, 0.0))))
        n = 1 + k % 4
        assert np.isnan(alone[-1].positions[0]).any() or any(np.isnan(crowd.positions[0]).any() for crowd in alone)
        for one, all_ in zip(alone[::50], together[::50], strict=True):
            assert one.positions[0].tobytes() == all_.positions[k, :n].tobytes()
            assert one.states[0].tolist() == all_.states[k, :n].tolist()


@pytest.mark.parametrize(
    ("behaviour", "message"),
    [
        ({"spawn_time": -1.0}, "person 3: spawn_time is -1.0; allowed: a number >= 0"),
        ({"spawn_time": "soon"}, "person 3: spawn_time is 'soon'"),
        ({"respawn": "often"}, "person 3: respawn is 'often'; allowed: 0, 1, start, random"),
        (
            {"type": "dog"},
            "person 3: type is 'dog'; allowed: adult, child, elder, forklift, service_robot, vehicle, servicerobot",
        ),
    ],
)
def test_impossible_behaviour_is_named(stage, make_model, behaviour, message):
    scenario = stage.scenario(stage.hall(5, 5), [stage.person(3, (2, 2), **behaviour)])
    with pytest.raises(ConfigurationError, match=message):
        make_model().reset(np.zeros(1, int), [scenario], 1)


@pytest.mark.parametrize(
    ("name", "radius", "speed"),
    [
        ("adult", 0.3, 1.0),
        ("human/adult", 0.3, 1.0),
        ("child", 0.2, 0.9),
        ("human/elder", 0.3, 0.83),
        ("vehicle", 0.8, 1.0),
    ],
)
def test_types_have_bodies_and_speeds_of_their_own(stage, make_model, name, radius, speed):
    scenario = stage.scenario(stage.hall(16, 5), [stage.person(0, (2, 2.5), (14, 2.5), (2, 2.5), type=name)])
    *_, crowd = stage.walk(make_model(), scenario, 6.0)
    assert crowd.radii[0, 0] == radius
    assert np.hypot(*crowd.velocities[0, 0]) == pytest.approx(speed, rel=1e-3)


def test_a_forklift_pushes_people_and_is_hardly_pushed(stage, make_model):
    def moved(kind):
        drives = stage.person(0, (2, 3), (10, 3), (2, 3), type=kind, force_factor_social=0.0)
        stands = stage.person(1, (5, 3.05), force_factor_social=0.0)
        model = make_model(
            types={"forklift": {"radius": 0.3, "speed": 1.0, "mass": 2500.0, "sociable": False, "colour": None}}
        )
        walk = list(stage.walk(model, stage.scenario(stage.hall(12, 6), [drives, stands]), 5.0))
        return walk[-1].positions[0, 0, 0] - 2.0, np.hypot(*(walk[-1].positions[0, 1] - (5, 3.05)))

    way, push = moved("adult")
    way_of_forklift, push_of_forklift = moved("forklift")
    assert push_of_forklift > push
    assert way_of_forklift >= way


@pytest.mark.parametrize("reaction", ["scared", "ignore"])
def test_slow_people_whose_speed_a_state_reduces_are_not_taken_for_stuck(stage, make_model, reaction):
    """With 4 % of their speed the scared make less way than a tenth of it: not too little for what they want."""
    tiny = {"scared": {"sight": 50.0, "pace": 0.04, "distance": 0.0, "force": 0.0, "duration": None, "pause": 0.0}}
    scenario = stage.scenario(stage.hall(20, 6), [stage.person(0, (1, 3), (9, 3), (1, 3), speed=0.3)])
    model = make_model(reaction=reaction, reactions=tiny)
    walk = list(stage.walk(model, scenario, 40.0, stage.robots((19.0, 5.0, 0.0))))
    positions = np.array([crowd.positions[0, 0, 0] for crowd in walk])
    speed = 0.3 * (0.04 if reaction == "scared" else 1.0)
    assert (np.diff(positions[:500]) > 0.0).all()
    assert np.diff(positions[100:500]).mean() / 0.05 == pytest.approx(speed, rel=0.02)
