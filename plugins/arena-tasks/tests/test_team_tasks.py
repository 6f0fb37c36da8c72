"""Tasks of teams: where robots start and what they are bound for, and when there is no room."""

import json
import math
from itertools import combinations, pairwise

import pytest

from arena_core import ConfigurationError, ImpossibleScenario, InputFileError
from arena_core.testing import component, robot


def world(*overrides, name="empty"):
    return component("world", name, list(overrides))


def task(name, *overrides, of=None):
    return component("task", name, list(overrides), robot=robot(), world=of or world())


def ways(scenario):
    return [(scenario.start, scenario.goal), *((mate.start, mate.goal) for mate in scenario.team)]


def test_robots_stand_on_the_circle_and_are_bound_for_the_place_opposite():
    scenario = task("antipodal", "task.team=6", "task.radius=3", "task.jitter=0").scenario(3, 1)
    middle = 10.0  # m, of the empty room
    assert scenario.robots == 6
    for start, goal in ways(scenario):
        assert math.hypot(start.x - middle, start.y - middle) == pytest.approx(3.0)
        assert (start.x + goal.x, start.y + goal.y) == pytest.approx((2.0 * middle, 2.0 * middle))
        heading = math.atan2(goal.y - start.y, goal.x - start.x)
        assert math.cos(start.theta - heading) == pytest.approx(1.0)
    gaps = sorted(a.distance(b) for (a, _), (b, _) in combinations(ways(scenario), 2))
    assert gaps[0] == pytest.approx(2.0 * 3.0 * math.sin(math.pi / 6))


def test_each_circle_is_turned_and_no_robot_leaves_its_share_of_it():
    source = task("antipodal", "task.team=5", "task.jitter=1")
    one, same, other = source.scenario(0, 0), source.scenario(0, 0), source.scenario(0, 1)
    assert ways(one) == ways(same) != ways(other)
    angles = sorted(math.atan2(start.y - 10.0, start.x - 10.0) for start, _ in ways(one))
    assert min(b - a for a, b in pairwise(angles)) > 0.0


def test_groups_change_places():
    scenario = task("swap", "task.team=6", of=world("world.height=4")).scenario(0, 0)
    starts, goals = [[place[side] for place in ways(scenario)] for side in (0, 1)]
    assert {(p.x, p.y) for p in starts} == {(p.x, p.y) for p in goals}
    assert all((start.x < 10.0) != (goal.x < 10.0) for start, goal in ways(scenario))
    assert sum(start.x < 10.0 for start in starts) == 3


def test_groups_meet_at_the_door():
    rooms = world("world.door=0.9", name="door")
    grid = rooms.world(0, 0).grid
    column = grid.occupied[:, grid.cells((6.0, 4.0))[1]]
    assert (~column).sum() * grid.resolution == pytest.approx(0.9)
    scenario = task("swap", "task.team=4", of=rooms).scenario(0, 0)
    assert all((start.x < 6.0) != (goal.x < 6.0) for start, goal in ways(scenario))


@pytest.mark.parametrize(
    ("name", "overrides", "of", "said"),
    [
        ("antipodal", ["task.team=60", "task.radius=1"], (), "60 robots have starts .* allowed: 0.40 m and more"),
        ("antipodal", ["task.radius=12"], (), "has no room at .* as in world=empty"),
        ("swap", ["task.team=80"], ("world.width=6", "world.height=3"), "80 robots find no room at the ends of empty"),
    ],
)
def test_more_robots_than_room_is_one_line(name, overrides, of, said):
    with pytest.raises(ImpossibleScenario, match=said) as refused:
        task(name, *overrides, of=world(*of)).scenario(0, 0)
    assert "\n" not in str(refused.value)


def test_a_team_has_two_robots_or_more():
    with pytest.raises(ConfigurationError, match=r"task\.team is 1; allowed"):
        task("antipodal", "task.team=1")


def test_a_file_of_teams_names_one_number_of_robots(tmp_path):
    ends = [{"start": [4.0, 4.0 + k], "goal": [12.0, 4.0 + k]} for k in range(3)]
    problems = [{"name": str(n), "robots": ends[:n]} for n in (2, 3)]
    path = tmp_path / "teams.json"
    path.write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": problems[:1]}))
    source = task("scenario", f"task.path={path}")
    assert source.robots() == source.scenario(0, 0).robots == 2
    path.write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": problems}))
    with pytest.raises(InputFileError, match="its scenarios have 2 and 3 robots; allowed: one number in a file"):
        task("scenario", f"task.path={path}")


def test_a_teammate_in_a_wall_is_refused_with_its_place_in_the_file(tmp_path):
    robots = [{"start": [4.0, 4.0], "goal": [12.0, 4.0]}, {"start": [-0.02, 5.0], "goal": [12.0, 5.0]}]
    path = tmp_path / "wall.json"
    content = {"format": "arena-scenario", "version": 2, "scenarios": [{"name": "wall", "robots": robots}]}
    path.write_text(json.dumps(content))
    with pytest.raises(ImpossibleScenario, match=r"scenarios\[0\]\.robots\[1\]\.start .* lies inside a wall"):
        task("scenario", f"task.path={path}")
