import numpy as np
import pytest

from arena_core import ConfigurationError, Crowd, ImpossibleScenario
from arena_core.testing import check, robot
from arena_pedsim.state_ids import STANDING, WALKING


def test_the_contract_of_pedestrian_models_holds(make_model):
    for preset in ("social_force", "social_force_as_released"):
        assert check("pedestrians", make_model(preset), robot())


def test_free_speed_is_reached_and_never_exceeded(stage, make_model):
    scenario = stage.scenario(stage.hall(20, 4), [stage.person(0, (1, 2), (19, 2), (1, 2), speed=1.2)])
    speeds = np.array([np.hypot(*crowd.velocities[0, 0]) for crowd in stage.walk(make_model(), scenario, 10.0)])
    assert speeds.max() <= 1.2
    assert speeds[180:] == pytest.approx(1.2, rel=1e-6)
    assert speeds[9] == pytest.approx(1.2 * (1 - np.exp(-0.5 / 0.5)), rel=0.08)  # one relaxation time after the start


def test_velocity_is_what_the_body_moves_with(stage, make_model):
    before = None
    for crowd in stage.walk(make_model(), stage.crowded(stage.hall(6, 6), 12, 0), 20.0):
        if before is not None:
            moved = np.hypot(*((crowd.positions - before) / 0.05).T)
            # pushed out of a wall
            assert np.allclose((crowd.positions - before) / 0.05, crowd.velocities, atol=1e-6) or moved.max() > 1.3
        before = crowd.positions


def test_waypoints_are_walked_in_a_loop(stage, make_model):
    corners = [(8, 2), (8, 8), (2, 8), (2, 2)]
    scenario = stage.scenario(stage.hall(10, 10), [stage.person(0, (2, 2), *corners)])
    positions = np.array([crowd.positions[0, 0] for crowd in stage.walk(make_model(), scenario, 60.0)])
    gaps = np.hypot(*(positions[:, None] - corners).transpose(2, 0, 1))
    visited = [int(k) for k in gaps.argmin(axis=1)[gaps.min(axis=1) < 0.5]]
    order = [here for here, before in zip(visited[1:], visited, strict=False) if here != before]
    assert order[:8] == [0, 1, 2, 3, 0, 1, 2, 3]


def test_somebody_without_waypoints_stands(stage, make_model):
    scenario = stage.scenario(
        stage.hall(10, 10), [stage.person(0, (5, 5)), stage.person(1, (2, 5.8), (8, 5.8), (2, 5.8))]
    )
    for crowd in stage.walk(make_model(), scenario, 15.0):
        assert crowd.states[0].tolist() == [STANDING, WALKING]
        assert crowd.positions[0, 0].tolist() == [5.0, 5.0]


def test_somebody_with_one_waypoint_walks_there_and_stays(stage, make_model):
    scenario = stage.scenario(stage.hall(10, 10), [stage.person(0, (2, 2), (8, 8))])
    crowd = list(stage.walk(make_model(), scenario, 15.0))[-1]
    assert crowd.states[0, 0] == STANDING
    assert np.hypot(*(crowd.positions[0, 0] - 8.0)) < 0.5
    assert np.hypot(*crowd.velocities[0, 0]) < 1e-5


def test_somebody_pushed_away_from_the_only_waypoint_walks_back(stage, make_model):
    model = make_model()
    crowd = list(stage.walk(model, stage.scenario(stage.hall(10, 10), [stage.person(0, (5, 5), (5, 5))]), 1.0))[-1]
    assert crowd.states[0, 0] == STANDING
    moved = Crowd(crowd.counts, crowd.ids, crowd.positions + 2.0, crowd.velocities, crowd.radii, crowd.states)
    for tick in range(200):
        moved = model.step(moved, stage.robots(), np.full(1, tick), 0.05)
    assert np.hypot(*(moved.positions[0, 0] - 5.0)) < 0.55


@pytest.mark.parametrize("speed", [0.2, 1.3])
def test_who_is_stuck_goes_on_to_the_next_waypoint_however_slow(stage, make_model, speed):
    wall = (5.0, 0.0, 5.5, 6.0)
    scenario = stage.scenario(stage.hall(10, 6, [wall]), [stage.person(0, (3, 3), (8, 3), (1, 3), speed=speed)])
    positions = np.array(
        [
            crowd.positions[0, 0, 0]
            for crowd in stage.walk(make_model(wayfinding={"routing": "straight"}), scenario, 30.0)
        ]
    )
    assert positions.max() == pytest.approx(4.7, abs=0.02)
    assert positions[np.argmax(positions > 4.6) :].min() < 2.0


def test_slow_walkers_are_not_taken_for_stuck(stage, make_model):
    scenario = stage.scenario(stage.hall(10, 6), [stage.person(0, (1, 3), (9, 3), (1, 3), speed=0.2)])
    positions = np.array([crowd.positions[0, 0, 0] for crowd in stage.walk(make_model(), scenario, 36.0)])
    assert (np.diff(positions) > 0.0).all()


def test_a_world_among_64_equals_a_world_alone(stage, make_model):
    halls = [stage.hall(10, 10, [(4, 4, 6, 6)]), stage.hall(20, 20, stage.racks)]
    scenarios = [stage.crowded(halls[k % 2], 1 + k % 13, k) for k in range(64)]
    together = list(
        stage.walk(make_model(reaction="yield"), scenarios, 10.0, stage.robots((5.0, 3.0, 0.0), worlds=64))
    )[-1]
    for k in (0, 5, 12, 63):
        alone = list(stage.walk(make_model(reaction="yield"), scenarios[k], 10.0, stage.robots((5.0, 3.0, 0.0))))[-1]
        n = 1 + k % 13
        assert together.counts[k] == n
        assert alone.positions[0].tobytes() == together.positions[k, :n].tobytes()
        assert alone.velocities[0].tobytes() == together.velocities[k, :n].tobytes()
        assert np.isnan(together.positions[k, n:]).all()


def test_worlds_begun_anew_leave_the_others_alone(stage, make_model):
    hall = stage.hall(10, 10)
    first, second, third = (stage.crowded(hall, n, n) for n in (4, 6, 9))
    model = make_model()
    *_, crowd = stage.walk(model, [first, second], 2.0)
    after = model.reset(np.array([1]), [third], 2)
    assert after.counts.tolist() == [4, 9]
    assert after.positions[0, :4].tobytes() == crowd.positions[0, :4].tobytes()
    crowd = after
    for tick in range(40):
        crowd = model.step(crowd, stage.robots(worlds=2), np.full(2, tick), 0.05)
    whole, fresh = list(stage.walk(make_model(), first, 4.0))[-1], list(stage.walk(make_model(), third, 2.0))[-1]
    assert whole.positions[0].tobytes() == crowd.positions[0, :4].tobytes()
    assert fresh.positions[0].tobytes() == crowd.positions[1].tobytes()


def test_positions_come_from_the_crowd_that_is_given(stage, make_model):
    model = make_model()
    crowd = list(stage.walk(model, stage.scenario(stage.hall(10, 10), [stage.person(0, (2, 2), (8, 2), (2, 2))]), 1.0))[
        -1
    ]
    given = crowd.positions + np.array((0.0, 5.0))
    seen = given.copy()
    after = model.step(
        Crowd(crowd.counts, crowd.ids, given, crowd.velocities, crowd.radii, crowd.states),
        stage.robots(),
        np.zeros(1, int),
        0.05,
    )
    assert np.hypot(*(after.positions[0, 0] - given[0, 0])) <= 0.05 + 1e-12
    assert given.tobytes() == seen.tobytes()  # what is given is not written to


def test_a_world_without_people_steps(stage, make_model):
    *_, crowd = stage.walk(
        make_model(), [stage.scenario(stage.hall(5, 5), []), stage.scenario(stage.hall(5, 5), [])], 0.2
    )
    assert crowd.counts.tolist() == [0, 0]


def test_a_thousand_people_walk(stage, make_model):
    hall = stage.hall(60, 60, resolution=0.1)
    scenario = stage.crowded(hall, 1000, 1, speed=1.3)
    *_, crowd = stage.walk(make_model(), scenario, 5.0)
    speeds = np.hypot(*crowd.velocities[0].T)
    assert np.isfinite(crowd.positions).all()
    assert speeds.mean() > 0.8


def test_longer_steps_are_split(stage, make_model):
    people = [stage.person(k, (2 + k, 2 + 0.1 * k), (18 - k, 15), (2, 2)) for k in range(8)]
    scenario = stage.scenario(stage.hall(20, 20), people)
    *_, short = stage.walk(make_model(), scenario, 3.0, dt=0.05)
    *_, split = stage.walk(make_model(), scenario, 3.0, dt=0.1)
    assert short.positions.tobytes() == split.positions.tobytes()


def test_factors_of_the_scenario_file_count(stage, make_model):
    def gap(**behaviour: float) -> float:
        people = [stage.person(0, (2, 2), (12, 2), (2, 2), speed=0.3, **behaviour), stage.person(1, (6, 2.1))]
        return min(
            np.hypot(*(crowd.positions[0, 0] - crowd.positions[0, 1]))
            for crowd in stage.walk(make_model(), stage.scenario(stage.hall(14, 6), people), 25.0)
        )

    assert gap(force_factor_social=8.0) > gap() + 0.05
    assert gap(force_factor_social=0.0) == pytest.approx(0.6, abs=0.01)


def test_somebody_without_drive_stays(stage, make_model):
    scenario = stage.scenario(stage.hall(10, 10), [stage.person(0, (5, 5), (8, 5), (2, 5), force_factor_desired=0.0)])
    assert list(stage.walk(make_model(), scenario, 2.0))[-1].positions[0, 0].tolist() == [5.0, 5.0]


@pytest.mark.parametrize("value", [-1.0, "much", float("nan")])
def test_an_impossible_factor_is_named(stage, make_model, value):
    scenario = stage.scenario(stage.hall(5, 5), [stage.person(7, (2, 2), force_factor_social=value)])
    with pytest.raises(ConfigurationError, match=r"person 7: force_factor_social is .* a number >= 0"):
        make_model().reset(np.zeros(1, int), [scenario], 1)


def test_a_start_in_a_wall_or_off_the_map_is_named(stage, make_model):
    hall = stage.hall(5, 5, [(2, 2, 3, 3)])
    for at, where in (((2.5, 2.5), "inside a wall"), ((7.0, 1.0), "off the map")):
        with pytest.raises(ImpossibleScenario, match=f"stage: person 3 starts at .*{where}"):
            make_model().reset(np.zeros(1, int), [stage.scenario(hall, [stage.person(3, at)])], 1)


def test_impossible_parameters_are_named(make_model):
    with pytest.raises(ConfigurationError, match=r"social\.gamma"):
        make_model(social={"gamma": 0.0})
    with pytest.raises(ConfigurationError, match="reaction"):
        make_model(reaction="sometimes")
