import numpy as np
import pytest

from arena_pedsim.states.state_table import state_names

NAMES = state_names()
STEP = 0.05  # s


def group_walk(stage, make_model, speeds, seed, hall, seconds=30.0):
    """Return positions (T, 3, 2) and velocities of three who begin anyhow near (3, 6) and walk to (57, 6)."""
    starts = np.array((3.0, 6.0)) + np.random.default_rng(seed).uniform(-1.0, 1.0, (3, 2))
    people = [stage.person(k, starts[k], (57, 6), (3, 6), speed=speeds[k], group="friends") for k in range(3)]
    crowds = list(stage.walk(make_model(), stage.scenario(hall, people), seconds))
    assert {NAMES[k] for k in crowds[-1].states[0]} == {"group_walking"}
    return np.array([crowd.positions[0] for crowd in crowds]), np.array([crowd.velocities[0] for crowd in crowds])


@pytest.mark.parametrize("seed", range(4))
def test_three_on_open_ground_walk_side_by_side(stage, make_model, seed):
    positions, velocities = group_walk(stage, make_model, (1.3, 1.3, 1.3), seed, stage.hall(60, 12, resolution=0.1))
    settled = positions[-200:]
    across = np.sort(settled[..., 1], axis=1)
    assert np.diff(across, axis=1) == pytest.approx(0.8, abs=0.15)  # Moussaid et al. 2010: abreast, 0.8 m apart
    assert np.ptp(settled[..., 0], axis=1).max() < 0.3
    assert np.hypot(*velocities[-200:].mean(axis=(0, 1))) > 1.2


@pytest.mark.parametrize("seed", range(4))
def test_the_quick_wait_for_the_slow_and_the_middle_stays_behind(stage, make_model, seed):
    positions, velocities = group_walk(stage, make_model, (1.2, 1.35, 1.45), seed, stage.hall(60, 12, resolution=0.1))
    settled = positions[-200:]
    order = np.argsort(settled[..., 1], axis=1)
    along = np.take_along_axis(settled[..., 0], order, axis=1)
    assert np.ptp(along, axis=1).max() < 0.6
    assert (along[:, [0, 2]].mean(axis=1) - along[:, 1]).mean() > -0.02  # a V that opens forwards, never an arrow head
    assert np.hypot(*velocities[-200:].mean(axis=(0, 1))) == pytest.approx(1.2, abs=0.06)


def test_without_its_forces_a_group_falls_apart(stage, make_model):
    def spread(**groups):
        people = [stage.person(k, (3, 5 + k), (57, 6), (3, 6), speed=0.9 + 0.3 * k, group=1) for k in range(3)]
        *_, crowd = stage.walk(
            make_model(groups=groups), stage.scenario(stage.hall(60, 12, resolution=0.1), people), 25.0
        )
        return np.ptp(crowd.positions[0, :, 0])

    assert spread() < 1.5
    assert spread(gaze=0.0, coherence=0.0, repulsion=0.0) > 5.0


def test_a_group_passes_a_door_and_closes_ranks_behind_it(stage, make_model):
    walls = [(10.0, 0.0, 10.3, 5.3), (10.0, 6.7, 10.3, 12.0)]
    people = [stage.person(k, (3, 5 + k), (25, 6), (3, 6), speed=1.2, group="a") for k in range(3)]
    crowds = list(stage.walk(make_model(), stage.scenario(stage.hall(30, 12, walls), people), 17.0))
    places = np.array([crowd.positions[0] for crowd in crowds])
    assert (places[-1, :, 0] > 12.0).all()
    assert max(np.hypot(*(place - place.mean(axis=0)).T).max() for place in places) < 3.0
    assert np.ptp(places[-1], axis=0).max() < 2.5


def test_a_group_goes_round_its_waypoints_together(stage, make_model):
    corners = [(12, 3), (12, 12), (3, 12), (3, 3)]
    people = [stage.person(k, (3 + 0.7 * k, 3), *corners, speed=1.2, group="a") for k in range(3)]
    places = np.array(
        [crowd.positions[0] for crowd in stage.walk(make_model(), stage.scenario(stage.hall(15, 15), people), 90.0)]
    )
    near = np.hypot(*(places.mean(axis=1)[:, None] - corners).transpose(2, 0, 1))
    visited = [int(k) for k in near.argmin(axis=1)[near.min(axis=1) < 1.5]]
    order = [here for here, before in zip(visited[1:], visited, strict=False) if here != before]
    assert order[:6] in ([0, 1, 2, 3, 0, 1], [3, 0, 1, 2, 3, 0])
    assert np.hypot(*(places - places.mean(axis=1, keepdims=True)).transpose(2, 0, 1)).mean() < 1.2


def test_a_group_of_one_just_walks(stage, make_model):
    people = [stage.person(0, (2, 5), (8, 5), (2, 5), group="a"), stage.person(1, (2, 8), (8, 8), (2, 8), group="b")]
    for crowd in stage.walk(make_model(), stage.scenario(stage.hall(10, 10), people), 3.0):
        assert {NAMES[k] for k in crowd.states[0]} == {"walking"}


def queue(stage, make_model, seconds=150.0, **behaviour):
    """Return positions and who queues, (T, 8), of people who walk up to a till from
    all over the hall, and on from there.
    """
    random = np.random.default_rng(1)
    people = [
        stage.person(
            k,
            start,
            (15, 8),
            (15, 14),
            (3, 14),
            speed=random.uniform(0.8, 1.3),
            queue="till",
            queue_waypoint=0,
            queue_heading=0.0,
            **behaviour,
        )
        for k, start in enumerate((2 + 1.2 * (k % 5), 1.5 + 1.2 * (k // 5)) for k in range(8))
    ]
    crowds = list(stage.walk(make_model(), stage.scenario(stage.hall(18, 16), people), seconds))
    states = np.array([crowd.states[0] for crowd in crowds])
    return np.array([crowd.positions[0] for crowd in crowds]), states == NAMES.index("queueing")


def test_who_comes_first_is_served_first(stage, make_model):
    _, queueing = queue(stage, make_model)
    joined, left = np.argmax(queueing, axis=0), len(queueing) - np.argmax(queueing[::-1], axis=0)
    edges = np.diff(queueing.astype(int), axis=0)
    joined, left = (np.array([np.flatnonzero(edges[:, k] == sign)[0] for k in range(8)]) for sign in (1, -1))
    assert np.argsort(joined, kind="stable").tolist() == np.argsort(left, kind="stable").tolist()
    served = np.diff(np.sort(left)) * STEP
    assert served.min() >= 5.0 - 1e-6
    assert served.max() <= 15.0 + STEP
    assert (edges == -1).sum(axis=0).min() >= 1  # everybody was served


def test_people_in_a_queue_stand_one_behind_the_other_and_move_up(stage, make_model):
    places, queueing = queue(stage, make_model, 40.0, queue_base_time=8.0)
    for tick in (420, 799):
        line = places[tick, queueing[tick]]
        line = line[np.argsort(-line[:, 0])]
        assert len(line) >= 5
        assert line[:, 1] == pytest.approx(8.0, abs=0.35)
        assert line[0, 0] == pytest.approx(15.0, abs=0.35)
        assert np.diff(line[:, 0]) == pytest.approx(-0.9, abs=0.3)
