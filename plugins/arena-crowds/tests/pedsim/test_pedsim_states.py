from itertools import pairwise

import numpy as np
import pytest

from arena_core import Scenario
from arena_pedsim.states.social_state import START_UPS
from arena_pedsim.states.state_table import NEEDS, state_names, state_table

NAMES = state_names()
REACTIONS = {"approaching_robot", "shying_from_robot", "blocking_robot"}  # begin and end elsewhere
OPEN_ENDED = {"none", "waiting"} | REACTIONS
STEP = 0.05  # s


def states_of(stage, model, scenarios, seconds, robots=None):
    """Return the states (T, N, P) of a walk, -1 where there is no slot in use."""
    return np.array([crowd.states for crowd in stage.walk(model, scenarios, seconds, robots)])


def spells(states):
    """Return (state's name, seconds) of each stretch of one person's states (T,)
    that was seen from beginning to end.
    """
    edges = np.flatnonzero(np.diff(states)) + 1
    return [(NAMES[states[begin]], (end - begin) * STEP) for begin, end in pairwise(edges)]


def lengths(states, name):
    """Return the lengths (s) of all whole stretches of a state, of all people of all worlds."""
    people = states.reshape(len(states), -1).T
    return np.array([length for person in people for state, length in spells(person) if state == name])


def islands(stage, make_person, others, number=64, apart=8.0):
    """Return a scenario with so many small companies out of each other's reach, each of one made
    person and others who just walk.
    """
    rows = int(np.sqrt(number))
    hall = stage.hall(apart * rows + 8.0, apart * rows + 8.0, resolution=0.25)
    people = []
    for k in range(number):
        x, y = 4.0 + apart * np.array(divmod(k, rows))
        people.append(make_person(len(people), (x, y)))
        for angle in np.linspace(0.0, 2.0 * np.pi, others, endpoint=False):
            at = (x + 0.9 * np.cos(angle), y + 0.9 * np.sin(angle))
            people.append(stage.person(len(people), at, (x, y + 0.5), (x + 0.5, y), speed=0.2))
    return stage.scenario(hall, people)


def to_and_fro(stage, **behaviour):
    return lambda number, at: stage.person(
        number, at, (at[0] + 0.6, at[1]), (at[0] - 0.6, at[1]), speed=0.2, **behaviour
    )


def test_every_state_can_be_reached_and_left():
    table = state_table()
    for code, name in enumerate(table.names):
        row = table.rules.states[code]
        targets = {table.names[t["to"]] for t in table.rules.transitions[row["first"] : row["last"]]}
        assert targets or name in OPEN_ENDED, name
        assert name not in targets
    drawn_in = set(table.rules.transitions["calls"].tolist())
    reached = set(table.rules.transitions["to"].tolist()) | drawn_in
    starts = {table.code(name) for name in ("none", "waiting", "walking", *START_UPS.values())}
    assert reached | starts | {table.code(name) for name in REACTIONS} == set(range(len(table.names)))


def test_every_state_with_a_base_time_ends_when_that_is_over():
    table = state_table()
    for row in table.rules.states:
        leaving = table.rules.transitions[row["first"] : row["last"]]
        assert (row["base_time"] >= 0) == (NEEDS.index("over") in leaving["needs"])


BASE = 2.0
LASTING = {
    "talking": ({"chatting_probability": 1.0, "talking_base_time": BASE}, 1),
    "talking_and_walking": ({"talking_and_walking_probability": 1.0, "talking_and_walking_base_time": BASE}, 1),
    "tell_story": ({"tell_story_probability": 1.0, "tell_story_base_time": BASE}, 3),
    "group_talking": ({"group_talking_probability": 1.0, "group_talking_base_time": BASE}, 3),
}


@pytest.mark.parametrize("name", LASTING)
def test_talks_last_their_base_time_spread_evenly_by_half(stage, make_model, name):
    behaviour, others = LASTING[name]
    scenario = islands(stage, to_and_fro(stage, max_talking_distance=3.0, **behaviour), others)
    measured = lengths(states_of(stage, make_model(), scenario, 14.0), name)
    expect_uniform(measured, 150)


def expect_uniform(measured, number):
    """Check lengths against BASE x U(0.5, 1.5), rounded up to steps."""
    assert len(measured) >= number
    assert measured.min() >= 0.5 * BASE - 1e-9
    assert measured.max() <= 1.5 * BASE + STEP + 1e-9
    assert measured.min() < 0.55 * BASE + STEP
    assert measured.max() > 1.45 * BASE - STEP
    deviation = BASE / np.sqrt(12.0)
    assert measured.mean() == pytest.approx(BASE + STEP / 2, abs=4.0 * deviation / np.sqrt(len(measured)))
    assert measured.std() == pytest.approx(deviation, rel=0.2)


def alone(stage, worlds, *others, **behaviour):
    """Return that many worlds in which one person walks to and fro at (5, 5)."""
    hall = stage.hall(20.0, 20.0, resolution=0.25)
    one = stage.scenario(hall, [stage.person(0, (5, 5), (8, 5), (2, 5), speed=0.3, **behaviour), *others])
    return [renamed(one, k) for k in range(worlds)]


def renamed(scenario, number):
    return Scenario(f"stage {number}", number, *(getattr(scenario, name) for name in Scenario.__slots__[2:]))


@pytest.mark.parametrize("wish", ["guide", "follower"])
def test_who_waits_for_a_robot_in_vain_gives_up(stage, make_model, wish):
    behaviour = {f"requesting_{wish}_probability": 0.5, f"requesting_{wish}_base_time": BASE}
    measured = lengths(states_of(stage, make_model(), alone(stage, 60, **behaviour), 12.0), f"requesting_{wish}")
    expect_uniform(measured, 120)


def test_a_call_for_service_that_nobody_hears_is_given_up(stage, make_model):
    server = stage.person(1, (18, 18), type="service_robot")
    behaviour = {"requesting_service_probability": 0.5, "requesting_service_base_time": BASE}
    measured = lengths(
        states_of(stage, make_model(), alone(stage, 60, server, **behaviour), 12.0), "requesting_service"
    )
    expect_uniform(measured, 120)


def test_service_lasts_its_base_time(stage, make_model):
    server = stage.person(1, (5, 6.5), (6, 6.5), (5, 6.5), type="service_robot")
    behaviour = {"requesting_service_probability": 0.5, "receiving_service_base_time": BASE}
    states = states_of(stage, make_model(), alone(stage, 60, server, **behaviour), 15.0)
    expect_uniform(lengths(states[:, :, 0], "receiving_service"), 120)
    given, taken = (
        states[:, :, 1] == NAMES.index("providing_service"),
        states[:, :, 0] == NAMES.index("receiving_service"),
    )
    assert (given != taken).mean() < 0.02  # a step or two apart
    assert len(lengths(states[:, :, 1], "driving_to_interaction"))


def test_without_a_service_robot_nobody_calls(stage, make_model):
    states = states_of(stage, make_model(), alone(stage, 1, requesting_service_probability=1.0), 3.0)
    assert set(states.ravel().tolist()) == {NAMES.index("walking")}


def test_runs_begin_and_end_by_the_same_chance(stage, make_model):
    states = states_of(stage, make_model(), alone(stage, 200, running_probability=0.25), 40.0)
    for name in ("running", "walking"):
        measured = lengths(states, name)
        assert len(measured) > 500
        assert measured.mean() == pytest.approx(0.5 / 0.25, rel=0.1)  # geometric: one test in four, each 0.5 s
        assert np.allclose(measured / 0.5, np.round(measured / 0.5))


def test_who_runs_is_twice_as_fast(stage, make_model):
    scenario = stage.scenario(
        stage.hall(40, 4), [stage.person(0, (1, 2), (39, 2), (1, 2), speed=1.1, running_probability=0.2)]
    )
    rows = [
        (crowd.states[0, 0], np.hypot(*crowd.velocities[0, 0])) for crowd in stage.walk(make_model(), scenario, 30.0)
    ]
    states, speeds = np.array(rows).T
    assert speeds[states == NAMES.index("running")].max() == pytest.approx(2.2, rel=1e-3)
    assert speeds[states == NAMES.index("walking")].max() <= 1.1 + 1e-9


def test_who_waits_for_a_timer_starts_to_the_second(stage, make_model):
    scenario = alone(stage, 1, start_up_mode="wait_timer", wait_time=3.0)
    crowds = list(stage.walk(make_model(), scenario, 6.0))
    states = np.array([crowd.states[0, 0] for crowd in crowds])
    assert np.flatnonzero(states == NAMES.index("walking"))[0] == 59  # the 60th step of 0.05 s ends at 3 s
    assert all(crowd.positions[0, 0].tolist() == [5.0, 5.0] for crowd in crowds[:59])
    assert crowds[-1].positions[0, 0, 0] > 5.5


@pytest.mark.parametrize("mode", ["trigger_zone", "signal_wait", "signal_proceed"])
def test_who_waits_for_a_trigger_starts_when_the_robot_is_in_the_zone(stage, make_model, mode):
    model = make_model()
    (scenario,) = alone(stage, 1, start_up_mode=mode, trigger_zone_radius=2.0)
    crowd = model.reset(np.zeros(1, int), [scenario], 1)
    assert NAMES[crowd.states[0, 0]] == START_UPS[mode]
    for tick, x in enumerate(np.linspace(9.0, 6.0, 200)):
        crowd = model.step(crowd, stage.robots((x, 5.0, 0.0)), np.full(1, tick), STEP)
        assert (NAMES[crowd.states[0, 0]] == "walking") == (x < 7.0)


@pytest.mark.parametrize(("robot_y", "starts_below"), [(8.0, 3.0), (2.0, None), (5.0, 4.0), (9.5, 6.5)])
def test_any_of_several_trigger_zones_starts_who_waits(stage, make_model, robot_y, starts_below):
    model = make_model()
    zones = ((2.0, 8.0, 1.0), (3.0, 5.0, 1.0), (5.0, 9.5, 1.5))
    prefixes = ("trigger_zone", "trigger_zone_2", "trigger_zone_8")
    said = {
        f"{p}_{key}": value
        for p, zone in zip(prefixes, zones, strict=True)
        for key, value in zip(("x", "y", "radius"), zone, strict=True)
    }
    (scenario,) = alone(stage, 1, start_up_mode="trigger_zone", **said)
    crowd = model.reset(np.zeros(1, int), [scenario], 1)
    for tick, x in enumerate(np.linspace(7.0, 2.01, 200)):
        crowd = model.step(crowd, stage.robots((x, robot_y, 0.0)), np.full(1, tick), STEP)
        assert (NAMES[crowd.states[0, 0]] == "walking") == (starts_below is not None and x < starts_below)


def test_the_trigger_zone_may_lie_elsewhere(stage, make_model):
    model = make_model()
    zone = {"trigger_zone_x": 2.0, "trigger_zone_y": 8.0, "trigger_zone_radius": 1.0}
    (scenario,) = alone(stage, 1, start_up_mode="trigger_zone", **zone)
    crowd = model.reset(np.zeros(1, int), [scenario], 1)
    for tick, x in enumerate(np.linspace(7.0, 2.0, 200)):
        crowd = model.step(crowd, stage.robots((x, 8.0, 0.0)), np.full(1, tick), STEP)
        assert (NAMES[crowd.states[0, 0]] == "walking") == (x < 3.0)


def test_who_talks_stands_and_so_does_who_listens(stage, make_model):
    people = [
        stage.person(0, (5, 5), (9, 5), (1, 5), chatting_probability=1.0, talking_base_time=4.0),
        stage.person(1, (7, 6), (9, 6), (1, 6)),
    ]
    crowds = list(stage.walk(make_model(), stage.scenario(stage.hall(12, 12), people), 3.0))
    states = np.array([crowd.states[0] for crowd in crowds])
    first = np.argmax(states[:, 0] == NAMES.index("talking"))
    assert first == 9  # at the first test of the chances
    assert (states[first:, 1] == NAMES.index("listening")).all()
    assert np.hypot(*crowds[-1].velocities[0].T).max() < 0.01


def test_nobody_talks_through_a_wall_or_across_the_hall(stage, make_model):
    talker = stage.person(0, (5, 5), (9, 5), (1, 5), speed=0.1, chatting_probability=1.0)
    wall = (0.0, 6.0, 12.0, 6.5)
    behind, far = (
        stage.person(1, (5, 8), (9, 8), (1, 8), speed=0.1),
        stage.person(1, (5, 11), (9, 11), (1, 11), speed=0.1),
    )
    for walls, other in (([wall], behind), ([], far)):
        states = states_of(stage, make_model(), stage.scenario(stage.hall(12, 12, walls), [talker, other]), 5.0)
        assert set(states.ravel().tolist()) == {NAMES.index("walking")}


@pytest.mark.parametrize(("kind", "state"), [("tell_story", "tell_story"), ("group_talking", "group_talking")])
def test_listeners_stand_in_a_circle(stage, make_model, kind, state):
    host = stage.person(0, (8, 8), (14, 8), (2, 8), **{f"{kind}_probability": 1.0, f"{kind}_base_time": 30.0})
    others = [stage.person(k + 1, (8 + 3 * np.cos(k), 8 + 3 * np.sin(k)), (14, 8), (2, 8)) for k in range(6)]
    *_, crowd = stage.walk(make_model(), stage.scenario(stage.hall(16, 16), [host, *others]), 14.0)
    assert NAMES[crowd.states[0, 0]] == state
    assert {NAMES[k] for k in crowd.states[0, 1:]} == {"listening_in_circle"}
    standing = crowd.positions[0] if state == "group_talking" else crowd.positions[0, 1:]
    centre = standing.mean(axis=0)
    gaps = np.hypot(*(standing - centre).T)
    radius = len(standing) * 1.5 / (2.0 * np.pi)
    assert gaps == pytest.approx(radius, abs=0.2)
    angles = np.sort(np.arctan2(*(standing - centre).T))
    assert np.diff(angles) == pytest.approx(2.0 * np.pi / len(standing), rel=0.2)
    assert np.hypot(*crowd.velocities[0].T).max() < 0.1


def test_who_talks_and_walks_is_slow_and_has_the_listener_beside(stage, make_model):
    people = [
        stage.person(
            0, (2, 5), (28, 5), (2, 5), talking_and_walking_probability=1.0, talking_and_walking_base_time=20.0
        ),
        stage.person(1, (4, 7), (28, 7), (2, 7)),
    ]
    crowds = list(stage.walk(make_model(), stage.scenario(stage.hall(30, 10), people), 40.0))
    states = np.array([crowd.states[0] for crowd in crowds])
    talks, listens = (
        states[:, 0] == NAMES.index("talking_and_walking"),
        states[:, 1] == NAMES.index("listening_and_walking"),
    )
    assert talks.mean() > 0.8
    assert (talks != listens).mean() < 0.01  # who listens leaves when the talker stops, and not before
    settled = crowds[np.argmax(talks) + 180]  # 9 s later, before the shortest talk is over
    assert np.hypot(*settled.velocities[0, 0]) == pytest.approx(0.3, rel=0.05)
    gap = settled.positions[0, 1] - settled.positions[0, 0]
    assert abs(gap[0]) < 0.1
    assert abs(gap[1]) == pytest.approx(0.8, abs=0.1)


def test_people_ask_one_guide_at_a_time_and_follow_it_at_a_distance(stage, make_model):
    people = [
        stage.person(k, (6, 4 + 2 * k), (10, 4 + 2 * k), (3, 4 + 2 * k), speed=0.6, requesting_guide_probability=1.0)
        for k in range(3)
    ]
    model = make_model()
    crowd = model.reset(np.zeros(1, int), [stage.scenario(stage.hall(30, 12), people)], 1)
    gaps = []
    for tick in range(600):
        robot = np.array((5.0 + max(tick - 40, 0) * STEP * 0.5, 2.0))
        crowd = model.step(crowd, stage.robots((*robot, 0.0)), np.full(1, tick), STEP)
        names = [NAMES[k] for k in crowd.states[0]]
        assert names.count("following_guide") + names.count("requesting_guide") <= 1
        if "following_guide" in names:
            gaps.append(np.hypot(*(crowd.positions[0, names.index("following_guide")] - robot)))
    assert len(gaps) > 500
    assert 2.5 < np.mean(gaps[100:]) < 4.5


def test_who_leads_the_robot_goes_to_its_goal_and_gets_out_of_the_way(stage, make_model):
    people = [
        stage.person(
            0, (8, 8), (9, 8), (8, 9), speed=0.5, requesting_follower_probability=1.0, clearing_goal_base_time=2.0
        )
    ]
    scenario = stage.scenario(stage.hall(10, 10), people)  # the robot's goal is (1, 0)
    crowds = list(stage.walk(make_model(), scenario, 30.0, stage.robots((7.0, 8.0, 0.0))))
    names = [NAMES[crowd.states[0, 0]] for crowd in crowds]
    seen = list(dict.fromkeys(names))
    assert seen[:5] == ["walking", "requesting_follower", "guide_to_goal", "clearing_goal", "walking"][:4] + seen[4:5]
    arrival = crowds[names.index("clearing_goal")].positions[0, 0]
    assert np.hypot(*(arrival - (1.0, 0.0))) < 0.8


def test_what_people_do_is_the_same_for_every_robot_they_do_not_wait_for(stage, make_model):
    scenario = stage.crowded(stage.hall(12, 12, [(5, 5, 7, 7)]), 16, 5, speed=1.0)
    quiet, busy = make_model("social_force_lively"), make_model("social_force_lively")
    one, other = (model.reset(np.zeros(1, int), [scenario], 1) for model in (quiet, busy))
    random, seen = np.random.default_rng(0), set()
    for tick in range(1200):
        one = quiet.step(one, stage.robots(), np.full(1, tick), STEP)
        other = busy.step(
            other, stage.robots(random.uniform(0, 12, 3), random.normal(size=2), 0.3), np.full(1, tick), STEP
        )
        assert one.positions.tobytes() == other.positions.tobytes()
        assert one.states.tobytes() == other.states.tobytes()
        seen |= set(one.states.ravel().tolist())
    assert len(seen) > 5


@pytest.mark.slow
def test_a_lively_world_among_many_equals_it_alone(stage, make_model):
    halls = [stage.hall(10, 10, [(4, 4, 6, 6)]), stage.hall(20, 20, stage.racks)]
    scenarios = [renamed(stage.crowded(halls[k % 2], 1 + 3 * (k % 7), k, speed=1.0), k) for k in range(64)]
    model = make_model("social_force_lively")
    together = list(stage.walk(model, scenarios, 30.0))[-1]
    assert len(set(together.states.ravel().tolist())) > 6
    for k in (0, 6, 13, 63):
        single = list(stage.walk(make_model("social_force_lively"), scenarios[k], 30.0))[-1]
        n = together.counts[k]
        for name in ("positions", "velocities", "states"):
            assert getattr(single, name)[0].tobytes() == getattr(together, name)[k, :n].tobytes()


def test_worlds_draw_numbers_of_their_own(stage, make_model):
    hall = stage.hall(10, 10)
    scenarios = [renamed(stage.crowded(hall, 8, 1, speed=1.0), k) for k in range(2)]
    *_, crowd = stage.walk(make_model("social_force_lively"), scenarios, 20.0)
    assert crowd.positions[0].tobytes() != crowd.positions[1].tobytes()


def test_people_whose_states_cannot_change_walk_as_if_there_were_no_states(stage, make_model):
    crowd = stage.crowded(stage.hall(10, 10), 6, 2)
    hall = stage.hall(40, 10)  # the same hall, with a person out of reach in its far end
    people = crowd.pedestrians
    runner = stage.person(6, (35, 5), (36, 5), (34, 5), running_probability=0.5)
    quiet = list(stage.walk(make_model(), stage.scenario(hall, people), 20.0))[-1]
    lively = list(stage.walk(make_model(), stage.scenario(hall, [*people, runner]), 20.0))[-1]
    assert quiet.positions[0].tobytes() == lively.positions[0, :6].tobytes()
    assert quiet.velocities[0].tobytes() == lively.velocities[0, :6].tobytes()


def test_nobody_stays_in_a_state_longer_than_its_time(stage, make_model):
    scenario = stage.crowded(stage.hall(20, 20, stage.racks), 24, 3, speed=1.2)
    server = stage.person(24, (1.5, 10), (18.5, 10), (1.5, 10), type="service_robot")
    states = states_of(
        stage,
        make_model("social_force_lively"),
        stage.scenario(scenario.world.grid, [*scenario.pedestrians, server]),
        300.0,
    )
    limits = {
        "talking": 15,
        "listening": 15,
        "talking_and_walking": 13.5,
        "listening_and_walking": 13.5,
        "requesting_service": 45,
    }
    limits |= dict.fromkeys(
        ("tell_story", "group_talking", "listening_in_circle", "receiving_service", "providing_service"), 30
    )
    for name, limit in limits.items():
        measured = lengths(states, name)
        assert name in ("tell_story", "group_talking") or len(measured)
        assert (measured <= limit + 2 * STEP).all()
    on_the_move = np.isin(states, [NAMES.index("walking"), NAMES.index("running")])
    assert on_the_move[-int(120 / STEP) :].any(axis=0).all()


def town(stage):
    """Return worlds in which everything in the table happens."""
    chances = {
        f"{name}_probability": 0.1
        for name in ("running", "chatting", "tell_story", "group_talking", "talking_and_walking")
    }
    times = {
        f"{name}_base_time": 3.0
        for name in ("talking", "tell_story", "group_talking", "talking_and_walking", "clearing_goal")
    }
    hall = stage.hall(16.0, 16.0, resolution=0.1)
    talkers = [stage.person(k, (3 + k, 4), (13, 4 + k), (3, 12 - k), speed=1.2, **chances, **times) for k in range(8)]
    service = {
        "requesting_service_probability": 0.5,
        "requesting_service_base_time": 4.0,
        "receiving_service_base_time": 3.0,
    }
    served = [stage.person(k, (4 + 3 * k, 5), (12, 6), (4, 10), **service) for k in range(3)]
    server = stage.person(3, (8, 8), (9, 8), (8, 9), type="service_robot")
    guided = stage.person(0, (4, 4), (12, 4), (4, 4), requesting_guide_probability=0.3, requesting_guide_base_time=2.0)
    by_robot = stage.person(1, (12, 8), (9, 4), (12, 8), speed=1.2, type="service_robot", respawn=1)
    leader = {
        "requesting_follower_probability": 0.3,
        "requesting_follower_base_time": 2.0,
        "clearing_goal_base_time": 2.0,
    }
    led = stage.person(0, (4, 4), (9, 4), (4, 4), **leader)
    delayed = {"start_up_mode": "wait_timer", "wait_time": 1.0}
    runners = [stage.person(k, (4 + k, 4), (12, 8), (4, 8), speed=0.8, group="a", **delayed) for k in range(2)]
    early = [stage.person(k, (4, k), (12, k), (4, k), group=k, running_probability=0.9) for k in (9, 11, 13)]
    late = [stage.person(20 + k, (7, k), (12, k), (4, k), group=k, spawn_time=3.3) for k in (9, 11, 13)]
    line = [
        stage.person(k, (3 + k, 4), (8, 8), (8, 14), queue=1, running_probability=0.9, queue_base_time=2.0)
        for k in range(3)
    ]
    zones = [
        stage.person(k, (8, 8 + k), (12, 8 + k), (4, 8 + k), start_up_mode=mode, trigger_zone_radius=9.0)
        for k, mode in enumerate(("trigger_zone", "signal_wait", "signal_proceed"))
    ]
    one_way = [stage.person(k, (3 + k, 6), (12, 6 + 3 * k), group="a") for k in range(2)]
    curious = stage.person(50, (6, 14.5), (12, 14.5), (3, 14.5), reaction="curious")
    crowds = (
        talkers,
        [*served, server],
        [guided, by_robot],
        [led],
        [*runners, *early, *late, curious],
        line,
        zones,
        one_way,
    )
    return [renamed(stage.scenario(hall, crowd), k) for k, crowd in enumerate(crowds)]


def test_people_make_every_transition_of_the_table_and_no_other(stage, make_model):
    model, scenarios = make_model(), town(stage)
    worlds = len(scenarios)
    crowd, rows = model.reset(np.arange(worlds), scenarios, worlds), []
    for tick in range(round(240.0 / STEP)):
        robots = stage.robots((1.0 + 6.0 * (tick // 400 % 2), 1.0 + 4.0 * (tick // 400 % 2), 0.0), worlds=worlds)
        crowd = model.step(crowd, robots, np.full(worlds, tick), STEP)
        rows.append(crowd.states)
    states = np.array(rows).reshape(len(rows), -1).astype(int)
    made = {
        (NAMES[a], NAMES[b])
        for a, b in set(zip(states[:-1].ravel().tolist(), states[1:].ravel().tolist(), strict=True))
        if a != b
    }
    table = state_table()
    listed = {
        (name, NAMES[t["to"]])
        for name, row in zip(NAMES, table.rules.states, strict=True)
        for t in table.rules.transitions[row["first"] : row["last"]]
    }
    drawn_in = {
        (free, NAMES[t["calls"]]) for free in ("walking", "running") for t in table.rules.transitions if t["calls"] > 0
    }
    assert (listed | drawn_in) - made == set()
    elsewhere = {pair for pair in made if {"none", "waiting"} & set(pair) or REACTIONS & set(pair)}
    at_once = {(a, c) for a, b in listed for d, c in listed | drawn_in if b == d == "walking"}
    assert made - listed - drawn_in - at_once - elsewhere == set()
    assert {name for pair in made for name in pair} == set(NAMES) - {"shying_from_robot", "blocking_robot"}
