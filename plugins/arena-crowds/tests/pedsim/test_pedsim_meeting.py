import numpy as np
import pytest


def meeting(stage, make_model, width, speed, aside=0.0, **changes):
    """Let two people walk towards each other; return positions (T, 2, 2)."""
    middle = width / 2
    people = [
        stage.person(0, (3, middle + aside), (12, middle), (1, middle), speed=speed),
        stage.person(1, (9, middle - aside), (1, middle), (11, middle), speed=speed),
    ]
    walk = stage.walk(make_model(**changes), stage.scenario(stage.hall(13, width), people), 9.0 / speed)
    return np.array([crowd.positions[0] for crowd in walk])


@pytest.mark.parametrize("width", [8.0, 1.8, 1.4])
@pytest.mark.parametrize("speed", [0.3, 1.3])
def test_two_people_who_meet_head_on_pass_each_other_on_the_right(stage, make_model, width, speed):
    positions = meeting(stage, make_model, width, speed)
    passing = positions[np.argmax(positions[:, 0, 0] > positions[:, 1, 0])]
    assert positions[-1, 0, 0] > positions[-1, 1, 0] + 1.0
    assert passing[0, 1] < width / 2 < passing[1, 1]
    assert np.hypot(*(positions[:, 0] - positions[:, 1]).T).min() > 0.6 - 0.05


def test_who_meets_somebody_to_the_left_passes_on_the_right_and_the_other_way_round(stage, make_model):
    for aside in (-0.3, 0.3):
        positions = meeting(stage, make_model, 8.0, 1.0, aside)
        passing = positions[np.argmax(positions[:, 0, 0] > positions[:, 1, 0])]
        assert np.sign(passing[0, 1] - passing[1, 1]) == np.sign(aside)


def test_bodies_stay_apart_in_a_crush_at_a_door(stage, make_model):
    hall = stage.hall(16, 8, [(8.0, 0.0, 8.1, 3.5), (8.0, 4.5, 8.1, 8.0)])
    people = []
    for k in range(20):
        own, far = ((2, 1 + k % 5), (14, 4)) if k % 2 else ((14, 1 + k % 5), (2, 4))
        people.append(stage.person(k, (own[0] + 0.8 * (k // 10), own[1] + 0.8 * (k % 2)), far, own, speed=1.2))
    crossed, before = 0, None
    for tick, crowd in enumerate(stage.walk(make_model(), stage.scenario(hall, people), 120.0)):
        positions = crowd.positions[0]
        apart = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1)) + np.eye(20)
        assert tick < 20 or apart.min() > 0.6 - 0.06
        if before is not None:
            crossed += int(((positions[:, 0] > 8.05) != (before[:, 0] > 8.05)).sum())
        before = positions
    assert crossed >= 20


def test_slow_people_pass_a_narrow_door_in_both_directions(stage, make_model):
    hall = stage.hall(10, 6, [(5.0, 0.0, 5.1, 2.6), (5.0, 3.4, 5.1, 6.0)])
    people = [
        stage.person(k, (3 + 4 * (k % 2), 1 + k), (8 - 6 * (k % 2), 3), (2 + 6 * (k % 2), 3), speed=0.3)
        for k in range(4)
    ]
    sides = np.array(
        [crowd.positions[0, :, 0] > 5.05 for crowd in stage.walk(make_model(), stage.scenario(hall, people), 120.0)]
    )
    assert (np.abs(np.diff(sides.astype(int), axis=0)).sum(axis=0) >= 1).all()


def test_people_who_start_in_one_place_get_apart(stage, make_model):
    people = [stage.person(k, (5, 5), (9, 5), (1, 5)) for k in range(3)]
    *_, crowd = stage.walk(make_model(), stage.scenario(stage.hall(10, 10), people), 3.0)
    positions = crowd.positions[0]
    assert (np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1)) + np.eye(3)).min() > 0.59
