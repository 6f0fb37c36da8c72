"""The robots of a scenario file's team."""

from __future__ import annotations

from typing import Any

from arena_core import Pose
from arena_core.files import LIMITS
from arena_core.tasks import Member
from arena_tasks.scenario_files.json_fields import Field

FIRST = "robot0"  # the name of the first robot, which the run's planner drives


def read_robots(field: Field) -> tuple[Pose, Pose, tuple[Member, ...]]:
    """Read ``[{"start", "goal"}, {"start", "goal", "planner", "robot", "name"}, ...]``: start and goal of the first
    robot, and its teammates. The first robot is the run's and drives with the run's planner, the others may be others.
    """
    robots = field.items()
    if not 2 <= len(robots) <= LIMITS.robots:
        raise field.rejection(f"a list of 2 to {LIMITS.robots} robots; one has start and goal of its own")
    robots[0].check_keys("start", "goal")
    members: list[Member] = []
    for number, robot in enumerate(robots[1:], 1):
        robot.check_keys("start", "goal", "planner", "robot", "name")
        name = robot["name"].text() if robot.has("name") else f"robot{number}"
        if name in (FIRST, *(member.name for member in members)):
            raise robot.rejection(f"a name that no other robot has, {name} is one's")
        planner, kind = (robot[key].text() if robot.has(key) else "" for key in ("planner", "robot"))
        members.append(Member(name, robot["start"].pose(), robot["goal"].pose(), planner, kind))
    return robots[0]["start"].pose(), robots[0]["goal"].pose(), tuple(members)


def robot_entries(start: Pose, goal: Pose, team: tuple[Member, ...]) -> list[dict[str, Any]]:
    """Return what a file holds of a team, as JSON has it."""
    others = (
        {
            "name": member.name,
            **_way_entry(member.start, member.goal),
            **({"planner": member.planner} if member.planner else {}),
            **({"robot": member.robot} if member.robot else {}),
        }
        for member in team
    )
    return [_way_entry(start, goal), *others]


def _way_entry(start: Pose, goal: Pose) -> dict[str, Any]:
    return {"start": start.array().tolist(), "goal": goal.array().tolist()}
