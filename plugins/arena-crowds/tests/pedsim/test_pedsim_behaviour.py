import itertools
import json
from pathlib import Path

import numpy as np
import pytest

from arena_core import ConfigurationError
from arena_pedsim.states.behaviour import KEYS, check_behaviour

TOP = Path(__file__).parents[4]
SCENARIOS = [
    path
    for data in (TOP / "tests" / "data", TOP.parent / "shared" / "data")
    for path in sorted((data / "scenarios").rglob("*.json"))
]
NOT_BEHAVIOUR = {"name", "id", "pos", "yaml_file", "number_of_peds", "vmax", "waypoints"}


@pytest.mark.parametrize(
    ("behaviour", "message"),
    [
        (
            {"chating_probability": 0.1},
            r"^person 7: behaviour has no chating_probability; allowed: chatting_probability, clearing_goal",
        ),
        ({"chatting_probability": 1.5}, r"^person 7: chatting_probability is 1\.5; allowed: a number 0 \.\. 1$"),
        ({"talking_base_time": -1.0}, r"^person 7: talking_base_time is -1\.0; allowed: a number >= 0$"),
        ({"talking_base_time": "long"}, r"^person 7: talking_base_time is 'long'; allowed: a number >= 0$"),
        (
            {"start_up_mode": "late"},
            r"^person 7: start_up_mode is 'late'; allowed: one of default, wait_timer, trigger_zone, signal_wait, "
            r"signal_proceed$",
        ),
        ({"waypoint_mode": 2}, r"^person 7: waypoint_mode is 2; allowed: one of 0, 1$"),
        ({"queue_waypoint": 0.5}, r"^person 7: queue_waypoint is 0\.5; allowed: a whole number >= 0$"),
        ({"queue_heading": "east"}, r"^person 7: queue_heading is 'east'; allowed: an angle in rad$"),
        ({"type": "horse"}, r"^person 7: type is 'horse'; allowed: adult"),
    ],
)
def test_an_impossible_behaviour_is_one_line(stage, make_model, behaviour, message):
    scenario = stage.scenario(stage.hall(5, 5), [stage.person(7, (2, 2), (3, 3), **behaviour)])
    with pytest.raises(ConfigurationError, match=message):
        make_model().reset(np.zeros(1, int), [scenario], 1)


def test_a_queue_at_a_waypoint_that_is_not_there_is_named(stage, make_model):
    scenario = stage.scenario(stage.hall(5, 5), [stage.person(7, (2, 2), (3, 3), (2, 3), queue="a", queue_waypoint=2)])
    with pytest.raises(
        ConfigurationError, match=r"^person 7: queue_waypoint is 2; allowed: 0 \.\. 1, the places of its waypoints$"
    ):
        make_model().reset(np.zeros(1, int), [scenario], 1)


def test_all_keys_of_released_scenarios_are_known(stage):
    agents = [agent for file in SCENARIOS for agent in json.loads(file.read_text()).get("pedsim_agents", [])]
    assert agents
    for agent in agents:
        check_behaviour(
            stage.person(0, (0, 0), **{key: value for key, value in agent.items() if key not in NOT_BEHAVIOUR})
        )


def test_what_a_scenario_says_counts_unless_it_is_ignored(stage, make_model):
    def talks(preset, **behaviour):
        people = [stage.person(k, (5 + k, 5), (9, 5), (1, 5), speed=0.2, **behaviour) for k in range(2)]
        return any(
            (crowd.states > 2).any()
            for crowd in stage.walk(make_model(preset), stage.scenario(stage.hall(10, 10), people), 40.0)
        )

    zeros = {key: 0.0 for key in KEYS if key.endswith("_probability")}
    assert not talks("social_force")
    assert talks("social_force", chatting_probability=0.5)
    assert talks("social_force_lively", **zeros)


def test_waypoints_at_random_are_all_visited_and_never_twice_in_a_row(stage, make_model):
    corners = np.array([(2, 2), (8, 2), (8, 8), (2, 8)], float)
    scenario = stage.scenario(stage.hall(10, 10), [stage.person(0, (5, 5), *corners, speed=1.5, waypoint_mode=1)])
    places = np.array([crowd.positions[0, 0] for crowd in stage.walk(make_model(), scenario, 240.0)])
    gaps = np.hypot(*(places[:, None] - corners).transpose(2, 0, 1))
    visited = [int(k) for k in gaps.argmin(axis=1)[gaps.min(axis=1) < 0.45]]
    order = [here for here, before in zip(visited[1:], visited, strict=False) if here != before]
    steps = {(b - a) % 4 for a, b in itertools.pairwise(order)}
    assert len(order) > 20
    assert set(order) == {0, 1, 2, 3}
    assert steps == {1, 2, 3}
