"""The cards of Francis et al.: all 25, in three levels that differ, each possible for every robot, people with room."""

from __future__ import annotations

import json
import math
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import ndimage

from arena_core import Robot, Scenario
from arena_core.cli.main import main
from arena_core.config.configuration import to_plain
from arena_core.hosting import compose, load_registry
from arena_scenarios.cards.pack import KEEP_OFF, VARIATIONS, cards
from arena_scenarios.situations import APART, DENSITIES

PACK = Path(str(files("arena_scenarios"))) / "packs" / "francis2023"
REGISTRY = load_registry()
CARDS = cards()
ROBOTS = ("turtlebot3", "jackal", "robotino")
MANNERS = {"following_human": "follow", "leading_human": "lead", "accompanying_peer": "accompany"}


@cache
def task_config() -> Any:
    return to_plain(compose(["scenario=francis2023/join_group_low"]))


@cache
def robot_called(name: str) -> Robot:
    node = to_plain(compose([f"robot={name}"], "component"))["robot"]
    return REGISTRY.build("robot", node)  # type: ignore[no-any-return]


@cache
def world_called(plan: str) -> Any:
    return REGISTRY.build("world", {**task_config()["world"], "path": str(PACK / "maps" / f"{plan}.yaml")})


@cache
def scenarios(card: str, level: str, robot: str = "jackal") -> tuple[Scenario, ...]:
    """Return the problems of a file; building them checks that the robot can reach every goal."""
    task = {**task_config()["task"], "path": str(PACK / "scenarios" / f"{card}_{level}.json")}
    world = world_called(CARDS[card]["plan"])
    built = REGISTRY.build("task", task, robot=robot_called(robot), world=world)
    return tuple(built.scenario(0, index) for index in range(VARIATIONS))


def test_figure_7_has_a_card_for_each_letter() -> None:
    assert [said["letter"] for said in CARDS.values()] == [chr(ord("a") + number) for number in range(25)]
    assert sorted(path.stem for path in (PACK / "scenarios").glob("*.json")) == sorted(
        f"{card}_{level}" for card in CARDS for level in DENSITIES
    )


@pytest.mark.parametrize("card", CARDS)
def test_every_file_carries_what_its_card_says(card: str) -> None:
    for level in DENSITIES:
        content = json.loads((PACK / "scenarios" / f"{card}_{level}.json").read_text())
        assert content["card"] == {key: CARDS[card][key] for key in ("letter", "tests", "good", "metrics")}
        assert content["title"] == f"{CARDS[card]['title']} ({level})"


@pytest.mark.parametrize("card", CARDS)
def test_higher_levels_have_more_people_or_faster_ones(card: str) -> None:
    amounts = [
        (len(first.pedestrians), round(first.pedestrians[0].desired_speed, 1) if card in MANNERS else 0.0)
        for first in (scenarios(card, level)[0] for level in DENSITIES)
    ]
    assert amounts[0] < amounts[1] < amounts[2]


@pytest.mark.parametrize("card", CARDS)
def test_every_robot_meets_the_same_five_problems(card: str) -> None:
    for level in DENSITIES:
        met = {
            robot: [(s.name, s.start, s.goal, s.content_hash) for s in scenarios(card, level, robot)]
            for robot in ROBOTS
        }
        assert met["turtlebot3"] == met["jackal"] == met["robotino"]
        drawn = [[(*p.position_xy, p.desired_speed) for p in s.pedestrians] for s in scenarios(card, level)]
        assert len({np.array(people).tobytes() for people in drawn}) == 5


@pytest.mark.parametrize("card", CARDS)
def test_people_have_room_and_give_way(card: str) -> None:
    for scenario in (scenario for level in DENSITIES for scenario in scenarios(card, level)):
        grid = scenario.world.grid
        away = ndimage.distance_transform_edt(~grid.occupied) * grid.resolution
        places = np.array([person.position_xy for person in scenario.pedestrians])
        gaps = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + np.diag(np.full(len(places), np.inf))
        assert gaps.min() > APART - 0.02
        assert np.hypot(*(places - (scenario.start.x, scenario.start.y)).T).min() > KEEP_OFF - 0.02
        for person in scenario.pedestrians:
            stops = np.vstack((person.position_xy, person.waypoints_xy))
            assert away[tuple(grid.cells(stops).T)].min() > person.radius, (scenario.name, person.id)
            assert person.behaviour["reaction"] == ("curious" if card == "robot_crowding" else "yield")


@pytest.mark.parametrize(("card", "manner"), MANNERS.items())
def test_tasks_with_a_person_say_whom_the_robot_keeps_with(card: str, manner: str) -> None:
    companies = [scenario.company for level in DENSITIES for scenario in scenarios(card, level)]
    assert {(company.manner, company.person) for company in companies if company} == {(manner, 0)}
    assert None not in companies
    assert all(scenario.company is None for scenario in scenarios("join_group", "low"))


def test_the_gestures_are_states_of_the_people() -> None:
    signs = {
        card: {p.behaviour.get("start_up_mode") for s in scenarios(card, "high") for p in s.pedestrians}
        for card in CARDS
        if card.startswith("intersection")
    }
    assert signs == {
        "intersection_no_gesture": {None},
        "intersection_wait": {"signal_wait"},
        "intersection_proceed": {"signal_proceed"},
    }


@pytest.mark.parametrize("card", CARDS)
def test_rooms_and_elevators_have_a_door_that_is_closed_at_first(card: str) -> None:
    drawn = [scenario.doors for level in DENSITIES for scenario in scenarios(card, level)]
    if card not in ("entering_room", "exiting_room", "entering_elevator", "exiting_elevator"):
        assert not any(drawn)
        return
    for (door,) in drawn:
        ((opens, closes),) = door.open.tolist()
        assert 4.0 <= opens <= 7.0
        assert (closes, door.period) == (
            (math.inf, None) if card.endswith("room") else (pytest.approx(opens + 10.0), 20.0)
        )


@pytest.mark.parametrize("card", ["entering_room", "entering_elevator"])
def test_a_closed_door_fills_its_doorway(card: str) -> None:
    (door,), grid = scenarios(card, "low")[0].doors, world_called(CARDS[card]["plan"]).world(0, 0).grid
    low, high = door.vertices_xy.min(axis=0), door.vertices_xy.max(axis=0)
    middle = 0.5 * (low + high)
    for x in (low[0] - 0.04, high[0] + 0.04):
        assert grid.occupied[tuple(grid.cells((x, middle[1])))]
    assert not grid.occupied[tuple(grid.cells(middle))]


def test_a_card_is_shown_with_what_it_tests(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenario", "show", "francis2023/join_group_low"]) == 0
    shown = capsys.readouterr().out
    assert "tests: taking a place in a group without cutting through it" in shown
    assert "decided by: social.group_intrusion" in shown
