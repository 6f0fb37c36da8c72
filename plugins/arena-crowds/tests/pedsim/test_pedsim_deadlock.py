import numpy as np
import pytest

STEP = 0.05  # s
PASSAGE = [(4, 0, 6, 2.6), (4, 3.4, 6, 6)]  # 0.8 m wide, room for one


def stands(positions, within=0.15):
    """Return the longest time, s, that each person of positions (T, P, 2) stayed within so many m of where it was."""
    longest = np.zeros(positions.shape[1])
    since = np.zeros(positions.shape[1], int)
    for k in range(1, len(positions)):
        for i in range(positions.shape[1]):
            if np.hypot(*(positions[k, i] - positions[since[i], i])) > within:
                since[i] = k
            longest[i] = max(longest[i], STEP * (k - since[i]))
    return longest


@pytest.mark.parametrize("speed", [0.3, 1.3])
def test_two_who_meet_in_a_passage_for_one_get_through(stage, make_model, speed):
    people = [
        stage.person(0, (2, 3), (8, 3), (2, 3), speed=speed),
        stage.person(1, (8, 3), (2, 3), (8, 3), speed=speed),
    ]
    scenario = stage.scenario(stage.hall(10, 6, PASSAGE), people)
    positions = np.array([crowd.positions[0] for crowd in stage.walk(make_model(), scenario, 20.0 / speed)])
    assert stands(positions).max() < 5.0
    assert positions[:, 0, 0].max() > 7.0


def test_a_group_waits_in_file_before_a_passage(stage, make_model):
    people = [stage.person(k, (1.5, 2.2 + 0.8 * k), (8.5, 3), (1.5, 3), speed=1.3, group="friends") for k in range(3)]
    scenario = stage.scenario(stage.hall(10, 6, PASSAGE), people)
    positions = np.array([crowd.positions[0] for crowd in stage.walk(make_model(), scenario, 60.0)])
    assert (positions[..., 0].max(axis=0) > 6.3).all()
    assert stands(positions).max() < 3.0


def test_a_queue_before_somebody_slow_does_not_turn_round(stage, make_model):
    slow = stage.person(0, (3, 3), (28, 3), (3, 3), speed=0.05)
    people = [slow, *(stage.person(k, (3 - 0.65 * k, 3), (28, 3), (1, 3), speed=1.3) for k in (1, 2, 3))]
    walls = [(0, 0, 30, 2.6), (0, 3.4, 30, 6)]
    positions = np.array(
        [
            crowd.positions[0]
            for crowd in stage.walk(make_model(), stage.scenario(stage.hall(30, 6, walls), people), 3.9)
        ]
    )
    assert (np.maximum.accumulate(positions[..., 0], axis=0) - positions[..., 0]).max() < 0.2


LONG = [(0, 0, 16, 2.6), (0, 3.4, 16, 6)]  # a way of 16 m for one
DEAD_END = [(0, 0, 2, 6), (2, 0, 14, 2.6), (2, 3.4, 14, 6)]


def paces(positions, speed):
    return np.hypot(*np.moveaxis(np.diff(positions, axis=0), 2, 0)).mean(axis=0) / (STEP * speed)


@pytest.mark.parametrize("speed", [0.3, 1.3])
@pytest.mark.parametrize("reaction", ["ignore", "yield"])
def test_people_squeeze_past_each_other_in_a_way_for_one(stage, make_model, speed, reaction):
    ends = ((0.5, 3), (15.5, 3))
    people = [stage.person(k, (1.5 + 1.4 * k, 3), ends[k % 2], ends[1 - k % 2], speed=speed) for k in range(10)]
    walk = stage.walk(make_model(reaction=reaction), stage.scenario(stage.hall(16, 6, LONG), people), 60.0)
    positions = np.array([crowd.positions[0] for crowd in walk])
    assert paces(positions, speed).mean() > 0.85
    assert stands(positions).max() < 5.0


def test_who_comes_out_of_a_dead_end_gets_past_who_goes_in(stage, make_model):
    people = [
        stage.person(0, (2.5, 3), (15, 3), (2.5, 3), speed=0.3),
        stage.person(1, (13, 3), (2.5, 3), (15, 3), speed=0.3),
    ]
    walk = stage.walk(make_model(), stage.scenario(stage.hall(16, 6, DEAD_END), people), 60.0)
    positions = np.array([crowd.positions[0] for crowd in walk])
    assert positions[:, 0, 0].max() > 14.0
    assert positions[:, 1, 0].min() < 3.5
    assert stands(positions).max() < 5.0


def test_bodies_stay_apart_where_there_is_room_for_two(stage, make_model):
    people = [stage.person(k, (2 + 10 * (k % 2), 3), (14 - 12 * (k % 2), 3), speed=0.3) for k in range(2)]
    walls = [(0, 0, 16, 2.3), (0, 3.7, 16, 6)]  # 1.4 m wide
    positions = np.array(
        [c.positions[0] for c in stage.walk(make_model(), stage.scenario(stage.hall(16, 6, walls), people), 50.0)]
    )
    assert positions[-1, 0, 0] > positions[-1, 1, 0]
    assert np.hypot(*(positions[:, 0] - positions[:, 1]).T).min() > 0.55
