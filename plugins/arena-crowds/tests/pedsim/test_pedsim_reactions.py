"""What people do who see the robot: curious, scared, threatening."""

import numpy as np
import pytest

from arena_core import ConfigurationError
from arena_pedsim.state_ids import APPROACHING_ROBOT, BLOCKING_ROBOT, SHYING_FROM_ROBOT, WALKING

HERE = (6.0, 4.0)  # where the robot stands
KINDS = ["curious", "scared", "threatening"]


def away(walk, at=HERE):
    """Return how far the first person is from a place, step by step."""
    return np.hypot(*(np.array([crowd.positions[0, 0] for crowd in walk]) - at).T)


def states_of(walk):
    return [int(crowd.states[0, 0]) for crowd in walk]


def passing_by(stage, **more):
    """Return a hall where a person passes 2.5 m beside the robot."""
    return stage.scenario(stage.hall(16, 9), [stage.person(0, (1, 6.5), (15, 6.5), (1, 6.5), **more)])


def test_the_curious_go_slowly_to_the_robot_stay_lose_interest_and_reach_their_goal(stage, make_model):
    robots = stage.robots((*HERE, 0.0), radius=0.25)
    walk = list(stage.walk(make_model(reaction="curious"), passing_by(stage), 60.0, robots))
    distance, states = away(walk), states_of(walk)
    speeds = np.array([np.hypot(*crowd.velocities[0, 0]) for crowd in walk])
    begun, ended = states.index(APPROACHING_ROBOT), len(states) - states[::-1].index(APPROACHING_ROBOT)
    assert (ended - begun) * 0.05 == pytest.approx(40.0, abs=0.5)
    assert distance[ended - 600 : ended].max() <= 1.5 + 1e-3
    assert distance[begun:ended].min() > 1.2
    assert speeds[begun + 60 : ended].max() < 0.501
    assert away(walk, (15.0, 6.5))[ended:].min() < 0.5
    assert set(states[ended:]) == {WALKING}  # not again for a minute


def test_the_curious_come_back_when_the_pause_is_over(stage, make_model):
    short = {"curious": {"sight": 10.0, "pace": 0.5, "distance": 1.5, "force": 0.0, "duration": 5.0, "pause": 3.0}}
    walk = list(
        stage.walk(make_model(reaction="curious", reactions=short), passing_by(stage), 30.0, stage.robots((*HERE, 0.0)))
    )
    changes = [state for state, before in zip(states_of(walk)[1:], states_of(walk), strict=False) if state != before]
    assert changes[:4] == [APPROACHING_ROBOT, WALKING, APPROACHING_ROBOT, WALKING]


@pytest.mark.parametrize("reaction", KINDS)
def test_nobody_reacts_to_a_robot_behind_a_wall_or_out_of_sight(stage, make_model, reaction):
    hidden = stage.scenario(
        stage.hall(16, 9, [(0.0, 5.2, 16.0, 5.5)]), [stage.person(0, (1, 6.5), (15, 6.5), (1, 6.5))]
    )
    assert set(states_of(stage.walk(make_model(reaction=reaction), hidden, 20.0, stage.robots((*HERE, 0.0))))) == {
        WALKING
    }
    far = stage.robots((15.0, 1.0, 0.0))
    wide = stage.scenario(stage.hall(30, 9), [stage.person(0, (29, 6.5), (26.5, 6.5), (29, 6.5))])
    assert set(states_of(stage.walk(make_model(reaction=reaction), wide, 20.0, far))) == {WALKING}


def test_who_loses_sight_of_the_robot_goes_on_and_reacts_again_in_sight(stage, make_model):
    model = make_model(reaction="curious")
    crowd = model.reset(np.zeros(1, int), [passing_by(stage)], 1)
    seen = []
    for tick in range(400):
        robots = stage.robots((*HERE, 0.0) if tick < 100 or tick >= 200 else (-100.0, -100.0, 0.0))
        crowd = model.step(crowd, robots, np.full(1, tick), 0.05)
        seen.append(int(crowd.states[0, 0]))
    assert (seen[90], seen[190], seen[390]) == (APPROACHING_ROBOT, WALKING, APPROACHING_ROBOT)


def test_the_scared_keep_farther_away_than_others_and_slow_down(stage, make_model):
    scenario = stage.scenario(stage.hall(16, 12), [stage.person(0, (1, 5.0), (15, 5.0), (1, 5.0))])
    least, slowest = {}, {}
    for reaction in ("ignore", "yield", "scared"):
        walk = list(stage.walk(make_model(reaction=reaction), scenario, 40.0, stage.robots((*HERE, 0.0), radius=0.25)))
        least[reaction] = away(walk).min()
        near = away(walk) < 2.5
        slowest[reaction] = max(
            (np.hypot(*crowd.velocities[0, 0]) for crowd, close in zip(walk, near, strict=True) if close), default=0.0
        )
    assert least["scared"] > least["yield"] + 0.3
    assert least["scared"] > least["ignore"] + 0.3
    assert slowest["scared"] <= 0.4 + 0.1 < slowest["yield"]
    assert away(walk, (15.0, 5.0)).min() < 0.5  # and gets there nevertheless


def test_the_scared_who_stand_are_driven_off_and_come_back(stage, make_model):
    model = make_model(reaction="scared")
    crowd = model.reset(np.zeros(1, int), [stage.scenario(stage.hall(16, 9), [stage.person(0, (6.0, 4.5))])], 1)
    states = []
    for tick in range(800):
        robots = stage.robots((5.0, 4.0, 0.0) if tick < 300 else (-100.0, -100.0, 0.0), radius=0.25)
        crowd = model.step(crowd, robots, np.full(1, tick), 0.05)
        states.append(int(crowd.states[0, 0]))
        if tick == 299:
            driven = np.hypot(*(crowd.positions[0, 0] - (5.0, 4.0)))
    assert driven > 1.8
    assert SHYING_FROM_ROBOT in states
    assert np.hypot(*(crowd.positions[0, 0] - (6.0, 4.5))) < 0.5


@pytest.mark.parametrize("start", [(2.0, 4.0), (6.0, 6.5), (9.0, 2.0)])
@pytest.mark.parametrize("theta", [0.0, 2.0, -1.6])
def test_the_threatening_stand_in_front_of_the_robot(stage, make_model, start, theta):
    scenario = stage.scenario(stage.hall(16, 9), [stage.person(0, start)])
    robots = stage.robots((*HERE, theta), radius=0.25)
    walk = list(stage.walk(make_model(reaction="threatening"), scenario, 12.0, robots))
    ahead = np.array((np.cos(theta), np.sin(theta)))
    place = walk[-1].positions[0, 0] - HERE
    assert 0.7 < place @ ahead < 1.45  # from where its body and the robot's have room to where it stops
    assert abs(place @ (-ahead[1], ahead[0])) < 0.1
    assert away(walk).min() > 0.55  # and never walked into it
    assert walk[-1].states[0, 0] == BLOCKING_ROBOT


def test_the_threatening_step_aside_with_a_robot_that_turns_and_never_back(stage, make_model):
    model = make_model(reaction="threatening")
    crowd = model.reset(np.zeros(1, int), [stage.scenario(stage.hall(16, 9), [stage.person(0, (7.4, 4.0))])], 1)
    for tick in range(400):
        nearer = 0.5 * min(max(tick - 100, 0) / 100, 1.0)  # m
        turned = 0.6 * min(max(tick - 250, 0) / 100, 1.0)  # rad
        robots = stage.robots((6.0 + nearer, 4.0, turned), radius=0.25)
        crowd = model.step(crowd, robots, np.full(1, tick), 0.05)
        if tick == 249:
            assert crowd.positions[0, 0] == pytest.approx((7.4, 4.0), abs=0.05)
    place = crowd.positions[0, 0] - (6.5, 4.0)
    assert np.arctan2(place[1], place[0]) == pytest.approx(0.6, abs=0.1)


def test_a_scenario_may_mix_reactions(stage, make_model):
    people = [stage.person(k, (3.0 + 2.0 * k, 7.0), reaction=kind) for k, kind in enumerate(["ignore", *KINDS])]
    scenario = stage.scenario(stage.hall(16, 9), people)
    *_, crowd = stage.walk(make_model(reaction="yield"), scenario, 3.0, stage.robots((6.0, 6.0, 0.0)))
    assert crowd.states[0].tolist() == [1, APPROACHING_ROBOT, SHYING_FROM_ROBOT, BLOCKING_ROBOT]


@pytest.mark.parametrize("reaction", ["ignore", "yield", *KINDS])
def test_nobody_enters_a_wall_another_or_a_robot_and_nobody_exceeds_the_own_speed(stage, make_model, reaction):
    hall = stage.hall(14, 14, [(6, 6, 8, 8), (0, 10, 4, 10.2)])
    scenarios = [stage.crowded(hall, 12, seed) for seed in range(6)]
    speeds = np.array([[spec.desired_speed for spec in scenario.pedestrians] for scenario in scenarios])
    room, robots = hall, stage.robots((3.0, 3.0, 0.7), radius=0.25, worlds=6)
    for number, crowd in enumerate(stage.walk(make_model(reaction=reaction), scenarios, 40.0, robots)):
        assert (np.hypot(*np.moveaxis(crowd.velocities, 2, 0)) <= speeds * (1.0 + 1e-9)).all()
        cells = room.cells(crowd.positions)
        assert not room.occupied[cells[..., 0], cells[..., 1]].any()
        between = np.hypot(*np.moveaxis(crowd.positions[:, :, None] - crowd.positions[:, None], 3, 0)) + np.eye(12)
        assert between.min() > 0.5  # bodies of 0.3 m that are pressed together overlap by a step's way at most
        if number > 100 and reaction != "ignore":
            assert np.hypot(*np.moveaxis(crowd.positions - (3.0, 3.0), 2, 0)).min() > 0.55


@pytest.mark.parametrize("reaction", KINDS)
def test_reacting_people_of_a_world_among_many_are_those_of_a_world_alone(stage, make_model, reaction):
    hall = stage.hall(12, 12, [(5, 5, 7, 7)])
    scenarios = [stage.crowded(hall, 1 + k % 7, k) for k in range(16)]
    robots = stage.robots((4.0, 3.0, 0.3), (0.2, 0.1), worlds=16)
    together = list(stage.walk(make_model(reaction=reaction), scenarios, 8.0, robots))[-1]
    for k in (0, 6, 15):
        alone = list(
            stage.walk(make_model(reaction=reaction), scenarios[k], 8.0, stage.robots((4.0, 3.0, 0.3), (0.2, 0.1)))
        )[-1]
        n = 1 + k % 7
        assert alone.positions[0].tobytes() == together.positions[k, :n].tobytes()
        assert alone.states[0].tolist() == together.states[k, :n].tolist()


def test_an_unknown_reaction_is_named(stage, make_model):
    scenario = stage.scenario(stage.hall(5, 5), [stage.person(7, (2, 2), reaction="amused")])
    with pytest.raises(
        ConfigurationError, match="person 7: reaction is 'amused'; allowed: ignore, yield, curious, scared, threatening"
    ):
        make_model().reset(np.zeros(1, int), [scenario], 1)
