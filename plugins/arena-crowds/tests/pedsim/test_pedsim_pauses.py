"""People who pause stay at their waypoints for a drawn time, and go on."""

import numpy as np

STEP = 0.05  # s
WAITING = 1


def pausing(stage, number=1, time=4.0, **behaviour):
    ends = ((3.0, 3.0), (9.0, 3.0))
    return [
        stage.person(k, (4.0, 3.0 + 0.8 * k), *ends, speed=1.2, pause_probability=1.0, pause_time=time, **behaviour)
        for k in range(number)
    ]


def stays(crowds, person=0):
    """Return how long each stay was, s."""
    resting = np.array([crowd.states[0, person] for crowd in crowds]) == WAITING
    edges = np.flatnonzero(np.diff(np.r_[0, resting.astype(int), 0]))
    return np.diff(edges.reshape(-1, 2), axis=1)[:, 0] * STEP


def test_a_stay_lasts_half_to_one_and_a_half_of_its_mean(stage, make_model):
    crowds = list(stage.walk(make_model(), stage.scenario(stage.hall(12, 6), pausing(stage)), 120.0))
    found = stays(crowds)[:-1]
    assert len(found) >= 8
    assert 2.0 - STEP <= found.min() < found.max() <= 6.0 + 2 * STEP
    assert len(np.unique(found.round(2))) > 4


def test_who_pauses_nowhere_walks_as_before(stage, make_model):
    plain = [stage.person(0, (4.0, 3.0), (3.0, 3.0), (9.0, 3.0), speed=1.2)]
    never = [stage.person(0, (4.0, 3.0), (3.0, 3.0), (9.0, 3.0), speed=1.2, pause_probability=0.0, pause_time=4.0)]
    walks = [
        [c.positions for c in stage.walk(make_model(), stage.scenario(stage.hall(12, 6), people), 20.0)]
        for people in (plain, never)
    ]
    assert np.array_equal(*map(np.array, walks))


def test_a_share_of_the_waypoints_is_paused_at(stage, make_model):
    people = [stage.person(0, (4.0, 3.0), (3.0, 3.0), (6.0, 3.0), speed=1.5, pause_probability=0.4, pause_time=1.0)]
    crowds = list(stage.walk(make_model(), stage.scenario(stage.hall(12, 6), people), 240.0))
    waypoints = np.abs(np.diff(np.sign([crowd.positions[0, 0, 0] - 4.5 for crowd in crowds]))).sum() / 2
    assert 0.25 < len(stays(crowds)) / waypoints < 0.55


def test_a_group_stays_together_through_its_pauses(stage, make_model):
    crowds = list(
        stage.walk(make_model(), stage.scenario(stage.hall(12, 6), pausing(stage, 3, group="friends")), 120.0)
    )
    places = np.array([crowd.positions[0] for crowd in crowds])
    apart = np.array([np.hypot(*(place - place.mean(axis=0)).T).max() for place in places])
    assert np.percentile(apart, 95) < 2.0
    assert np.ptp(places[:, 0, 0]) > 4.0
    assert min(len(stays(crowds, person)) for person in range(3)) >= 4


def test_a_world_of_pausing_people_in_a_batch_equals_it_alone(stage, make_model):
    scenario = stage.scenario(stage.hall(12, 6), pausing(stage, 2))
    alone = [crowd.positions[0] for crowd in stage.walk(make_model(), scenario, 30.0)]
    model = make_model()
    others = [stage.scenario(stage.hall(12, 6), pausing(stage, 3, time=2.0)), scenario]
    crowd = model.reset(np.arange(2), others, 2)
    for tick, expected in enumerate(alone):
        crowd = model.step(crowd, stage.robots(worlds=2), np.full(2, tick, np.int64), STEP)
        assert np.array_equal(crowd.positions[1, :2], expected)
