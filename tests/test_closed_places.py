"""Places where recoveries failed are kept off, and a guide prefers a wide way on the map to a
narrow one among what it sees.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError, NoPath, Pose
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.loop.closed_places import ClosedPlaces
from arena_core.loop.guide import ReplanRules
from arena_core.runs.jobs.benchmark import build_benchmark, passage_padding
from arena_core.testing import component, room, straight_path
from tests.brain import GOAL, NO_RECOVERIES, Straight, at, drive, reasons

HERE = np.array(((1.0, 0.0),))
EVERY_SECOND = ReplanRules(1.0, False, None, 0.0, 0.0)


def test_a_place_is_closed_for_its_time_and_then_open():
    places = ClosedPlaces()
    assert places.at(0.0) == []
    assert places.close(HERE, 0.4, 10.0, 60.0) == 60.0
    assert [len(places.at(stamp)) for stamp in (10.0, 69.9, 70.0, 100.0)] == [1, 1, 0, 0]
    (place,) = places.at(10.0)
    assert (place.vertices_xy.tolist(), place.radius) == (HERE.tolist(), 0.4)


def test_a_place_where_it_fails_again_stays_closed_twice_as_long_each_time():
    places = ClosedPlaces()
    near = HERE + np.array((0.1, 0.2))
    assert [places.close(near if k % 2 else HERE, 0.4, 200.0 * k, 60.0) for k in range(4)] == [
        60.0,
        120.0,
        240.0,
        480.0,
    ]
    assert [len(places.at(stamp)) for stamp in (1079.9, 1080.0)] == [1, 0]


def test_another_place_begins_with_the_usual_time():
    places = ClosedPlaces()
    places.close(HERE, 0.4, 0.0, 60.0)
    assert places.close(HERE + np.array((0.41, 0.0)), 0.4, 5.0, 60.0) == 60.0
    assert len(places.at(6.0)) == 2


@settings(derandomize=True, deadline=None, max_examples=100)
@given(st.lists(st.tuples(st.sampled_from([0.0, 2.0, 4.0]), st.floats(0.0, 50.0)), max_size=12))
def test_what_is_closed_is_what_was_closed_last_and_not_yet_over(closings):
    places, until, lasts, stamp = ClosedPlaces(), {}, {}, 0.0
    for x, wait in closings:
        stamp += wait
        lasts[x] = 2.0 * lasts[x] if x in lasts else 10.0
        until[x] = stamp + lasts[x]
        assert places.close(np.array(((x, 0.0),)), 0.4, stamp, 10.0) == lasts[x]
        assert {place.vertices_xy[0, 0] for place in places.at(stamp)} == {x for x, end in until.items() if end > stamp}


def test_after_all_recoveries_have_failed_the_place_ahead_is_closed_for_longer_and_longer():
    rules = replace(NO_RECOVERIES, behaviours=["clear", "detour"])
    navigator = drive(recoveries=rules)
    events = [
        event for k in range(320) for event in navigator.decide(at(0.0, 0.1 * k)).events if event.kind == "recovery"
    ]
    assert [event.detail for event in events][:6] == [
        "clear: no progress for 10.0 s",
        "detour: no progress for 13.0 s; (0.50, 0.00) is closed for 60 s",
        "clear: no progress for 16.0 s; (0.50, 0.00) is closed for 120 s",
        "detour: no progress for 19.0 s; (0.50, 0.00) is closed for 240 s",
        "clear: no progress for 22.0 s; (0.50, 0.00) is closed for 480 s",
        "detour: no progress for 25.0 s; (0.50, 0.00) is closed for 960 s",
    ]


def test_without_a_detour_among_its_recoveries_a_robot_closes_nothing():
    navigator = drive(recoveries=replace(NO_RECOVERIES, behaviours=["clear", "turn"]))
    details = [
        event.detail
        for k in range(400)
        for event in navigator.decide(at(0.0, 0.1 * k)).events
        if event.kind == "recovery"
    ]
    assert len(details) > 3
    assert not any("closed" in detail for detail in details)


def test_an_episode_begins_with_all_places_open():
    navigator = drive(rules=EVERY_SECOND, recoveries=replace(NO_RECOVERIES, behaviours=["detour"]))
    for k in range(110):
        navigator.decide(at(0.0, 0.1 * k))
    assert navigator.global_planner.grids[-1].occupied[tuple(room().cells((0.5, 0.0)))]
    navigator.reset(navigator.mission)
    for k in range(15):
        navigator.decide(at(0.0, 0.1 * k))
    assert not navigator.global_planner.grids[-1].occupied[tuple(room().cells((0.5, 0.0)))]


class Narrow(Straight):
    """Calls paths on the grids in ``narrow`` too narrow."""

    def __init__(self, *narrow):
        super().__init__()
        self.narrow, self.told = list(narrow), {}

    def plan(self, grid, start, goal):
        path = super().plan(grid, start, goal)
        self.told[id(path)] = grid
        return path

    def is_narrow(self, grid, path):
        assert self.told[id(path)] is grid
        return any(grid is one for one in self.narrow)


def guided(make, **changes):
    """Return a navigator that has decided twice, with a planner that is made from it, and that planner."""
    navigator = drive(rules=EVERY_SECOND, **changes)
    navigator.global_planner = make(navigator)
    for k in range(11):
        navigator.decide(at(0.0, 0.1 * k))
    return navigator


def test_where_people_stand_in_the_usual_way_the_path_leads_where_the_map_has_room():
    navigator = guided(lambda navigator: Narrow(navigator.local_map.grid))
    start, seen, alone = navigator.global_planner.grids
    assert start is navigator.mission.map
    assert seen is navigator.local_map.grid  # with what stands there now, only a narrow way is left
    assert alone is navigator.mission.map


def test_a_wide_way_among_what_is_seen_is_taken_at_once():
    navigator = guided(lambda navigator: Narrow())
    assert [grid is navigator.local_map.grid for grid in navigator.global_planner.grids] == [False, True]


def test_where_the_map_has_no_wide_way_either_the_narrow_one_of_what_is_seen_is_taken():
    def make(navigator):
        return Narrow(navigator.local_map.grid, navigator.mission.map)

    navigator = guided(make)
    planner = navigator.global_planner
    assert planner.grids[-1] is navigator.mission.map  # tried last, and not taken: the path is the one before
    assert navigator.path.poses.tolist() == planner.paths[-2].poses.tolist()


def test_in_an_unknown_world_the_narrow_way_is_all_there_is():
    navigator = guided(lambda navigator: Narrow(navigator.local_map.grid), map=None)
    assert all(grid is navigator.local_map.grid for grid in navigator.global_planner.grids)
    assert navigator.path is not None


def test_the_wide_way_on_the_map_keeps_off_closed_places():
    class Marked(Narrow):
        def is_narrow(self, grid, path):
            return bool(grid.occupied[tuple(grid.cells((2.0, 2.0)))])  # what the scans have shown

    recoveries = replace(NO_RECOVERIES, behaviours=["detour"], retry_time=1000.0)
    navigator = drive(rules=EVERY_SECOND, recoveries=recoveries)
    navigator.global_planner = Marked()
    data = room().data.copy()
    data[tuple(room().cells((2.0, 2.0)))] = 100
    navigator.local_map.grid = replace(room(), data=data)
    for k in range(112):
        navigator.decide(at(0.0, 0.1 * k))
    used = navigator.global_planner.grids[-1]
    assert used.occupied[tuple(used.cells((0.5, 0.0)))]
    assert not used.occupied[tuple(used.cells((2.0, 2.0)))]


def test_a_planner_that_tells_of_no_narrow_paths_is_asked_for_one_path():
    assert not Straight().is_narrow(room(), straight_path(Pose(0.0, 0.0), GOAL))
    navigator = guided(lambda navigator: Straight())
    assert len(navigator.global_planner.grids) == 2
    assert reasons(navigator.decide(at(0.0, 1.1))) == []


def test_no_way_at_all_is_still_no_way():
    navigator = drive(rules=EVERY_SECOND)
    navigator.global_planner = Narrow(navigator.local_map.grid)
    navigator.global_planner.no_way = True
    with pytest.raises(NoPath):
        navigator.decide(at(0.0))


def composed(preset, *words, robot="jackal"):
    quick = ["world=empty", "pedestrians=none", "localizer=ground_truth"]
    return to_plain(compose([f"planner={preset}", f"robot={robot}", *quick, *words]))


@pytest.mark.parametrize(
    ("preset", "margin"),
    [
        *((name, 0.03) for name in ("dwa", "teb", "mpc", "mppi")),
        ("orca", 0.1),
        *((name, 0.15) for name in ("gring", "cadrl", "sarl")),
        *((name, 0.25) for name in ("rosnav", "aio", "aio_random")),
        *((name, 0.3) for name in ("navrep", "navrep_v_only")),
        *((name, 0.0) for name in ("dwa_as_released", "teb_as_released", "mpc_as_released", "mppi_as_nav2")),
        *((name, 0.0) for name in ("rosnav_as_paper", "gring_as_released", "navrep_as_released", "aio_as_released")),
    ],
)
def test_each_planner_says_how_much_room_it_needs_in_a_passage(preset, margin):
    assert passage_padding(composed(preset)["planner"], component("robot", "jackal")) == pytest.approx(margin)


@pytest.mark.parametrize(("planner", "margin"), [("dwa", 0.045), ("teb", 0.03), ("mpc", 0.03), ("mppi", 0.03)])
def test_margin_of_a_car_counts_from_its_sides(planner, margin):
    robot = component("robot", "jackal_ackermann")
    sides = max(abs(y) for _, y in robot.footprint.vertices_xy)
    padding = passage_padding(composed(planner, robot="jackal_ackermann")["planner"], robot)
    assert robot.footprint.inscribed_radius + padding == pytest.approx(sides + margin)
    assert sides - robot.footprint.inscribed_radius > 0.08


@pytest.mark.parametrize("planner", ["dwa_as_released", "teb_as_released"])
def test_path_of_a_released_preset_keeps_off_by_the_inscribed_radius_alone_for_a_car_too(planner):
    robot = component("robot", "jackal_ackermann")
    assert passage_padding(composed(planner, robot="jackal_ackermann")["planner"], robot) == 0.0


@pytest.mark.parametrize("robot", ["turtlebot3", "jackal", "robotino"])
def test_a_planner_that_does_not_say_needs_room_to_turn(robot):
    body = component("robot", robot)
    margin = passage_padding(composed("pure_pursuit", robot=robot)["planner"], body)
    assert margin == pytest.approx(body.footprint.radius - body.footprint.inscribed_radius)
    assert (margin > 0.05) == (robot == "jackal")


@pytest.mark.parametrize(
    ("words", "padding"),
    [
        (("dwa",), 0.03),
        (("dwa", "planner.passage_margin=0.1"), 0.1),
        (("dwa", "global_planner.padding=0.07"), 0.07),
        (("dwa", "global_planner.padding=0"), 0.0),
        (("pure_pursuit", "+planner.passage_margin=0"), 0.0),
        (("pure_pursuit",), 0.102),
    ],
)
def test_paths_keep_off_what_the_planner_at_hand_needs_unless_padding_says_otherwise(words, padding):
    navigator = build_benchmark(composed(*words), load_registry()).navigator
    assert navigator.global_planner._padding == pytest.approx(padding, abs=1e-3)


@pytest.mark.parametrize(
    ("word", "told"),
    [
        ("planner.passage_margin=-0.1", "planner.passage_margin is -0.1"),
        ("planner.passage_margin=11", "planner.passage_margin is 11"),
        ("planner.passage_margin=wide", "planner.passage_margin is 'wide'"),
        ("planner.passage_margin=nan", "planner.passage_margin is nan"),
        ("planner.passage_margin=true", "planner.passage_margin is True"),
        ("global_planner.padding=-1", "global_planner.padding is -1"),
        ("global_planner.padding=wide", "global_planner.padding is 'wide'"),
        ("global_planner.narrow_cost=-1", "global_planner.narrow_cost is -1"),
        ("global_planner.narrow_cost=null", "global_planner.narrow_cost is None"),
    ],
)
def test_wrong_values_are_one_line_with_their_key(word, told):
    with pytest.raises(ConfigurationError) as error:
        build_benchmark(composed("dwa", word), load_registry())
    assert told in str(error.value)
    assert "\n" not in str(error.value)
