"""Drawing the pack ``iso18646``; every measure here is ours, because the standard's text is not public. Metres."""

from __future__ import annotations

from pathlib import Path

from arena_scenarios.cards.people import starting
from arena_scenarios.floor import Floor
from arena_scenarios.problems import Course, Person, Problem, write_problems

WIDTHS = (0.5, 0.6, 0.7, 0.8, 1.0, 1.2)  # of the narrow passages
START, GOAL, MIDDLE = (2.0, 3.0), (11.0, 3.0), 6.5
EXACT = 0.05  # goal radius where the place counts
TITLES = {
    "pose_accuracy": "Drive to a place: pose accuracy and repeatability",
    "path_deviation": "Drive straight on: deviation from the line",
    "obstacle_static": "A disc that is on no map stands in the way",
    "obstacle_moving": "A person who sees no robot crosses the way",
}


def course() -> Floor:
    """Draw a hall of 13 by 6 m; pillars along its walls tell a robot where it is."""
    floor = Floor(13.0, 6.0)
    floor.room(0.0, 0.0, 13.0, 6.0)
    floor.pilasters(0.0, 0.3, (0.8, 2.7, 4.1, 7.3, 8.8, 11.6))
    floor.pilasters(6.0, -0.3, (1.5, 3.6, 5.2, 9.4, 10.7))
    return floor


def passage(width: float) -> Floor:
    """Draw the hall with a wall across that has an opening of this width, 0.3 m deep."""
    floor = course()
    floor.block(MIDDLE - 0.15, 0.0, MIDDLE + 0.15, START[1] - 0.5 * width)
    floor.block(MIDDLE - 0.15, START[1] + 0.5 * width, MIDDLE + 0.15, 6.0)
    return floor


def write_courses(pack: Path) -> None:
    """Write maps and scenario files of the pack."""
    course().save(pack / "maps", "course")
    crossing = starting((MIDDLE, START[1]), 3.5)
    walks = Person((MIDDLE, 0.8), ((MIDDLE, 5.2),), 0.8, {"reaction": "ignore", **crossing})
    problems = {
        "pose_accuracy": Problem(START, GOAL, 0.0, (), Course(goal_radius=EXACT)),
        "path_deviation": Problem(START, GOAL, 0.0, ()),
        "obstacle_static": Problem(START, GOAL, 0.0, (), Course(discs=((MIDDLE, START[1], 0.25),))),
        "obstacle_moving": Problem(START, GOAL, 0.0, (walks,)),
    }
    for name, problem in problems.items():
        write_problems(pack / "scenarios" / f"{name}.json", {"title": TITLES[name]}, "../maps/course.yaml", [problem])
    for width in WIDTHS:
        name = f"passage_{round(100 * width):03d}"
        passage(width).save(pack / "maps", name)
        title = f"A passage {width:g} m wide"
        problem = Problem(START, GOAL, 0.0, ())
        write_problems(pack / "scenarios" / f"{name}.json", {"title": title}, f"../maps/{name}.yaml", [problem])
