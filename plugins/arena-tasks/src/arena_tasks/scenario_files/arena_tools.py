"""The scenario format of arena-tools, as Arena-Bench's own scenarios are written."""

from __future__ import annotations

from arena_core import Pose
from arena_tasks.scenario_files.companions import number_people
from arena_tasks.scenario_files.flatland import placed_shape
from arena_tasks.scenario_files.flatland_model import Shapes, placed_model
from arena_tasks.scenario_files.json_fields import Field
from arena_tasks.scenario_files.pedsim_agent import notes_on, people_of
from arena_tasks.scenario_files.problem import MOST_REPEATS, Keys, PersonDefaults, Problem

STANDS = "interactive obstacles stand there: no one loads and unloads them"


def is_arena_tools(root: Field) -> bool:
    """Return whether a file has this format."""
    return root.has("pedsim_agents") or (root.has("format") and root["format"].value == "arena-tools")


def read_arena_tools(root: Field, defaults: PersonDefaults) -> tuple[Problem]:
    """Read the one problem of a file; raise InputFileError.

    Its ``map_path`` belongs to another machine and is ignored.
    """
    agents = root["pedsim_agents"].items()
    crowd = [(agent.key, person) for agent in agents for person in people_of(agent, defaults)]
    static, interactive = (
        root[key].items() if root.has(key) else [] for key in ("static_obstacles", "interactive_obstacles")
    )
    shapes = [_obstacle_shapes(obstacle) for obstacle in (*static, *interactive)]
    problem = Problem(
        name=root.file.stem,
        start=Pose(*root["robot_position"].position().tolist()),
        goal=Pose(*root["robot_goal"].position().tolist()),
        pedestrians=number_people(person for _, person in crowd),
        obstacles=tuple(obstacle for shape in shapes for obstacle in shape.obstacles),
        goal_radius=None,
        time_limit=None,
        keys=Keys("robot_position", "robot_goal", tuple(key for key, _ in crowd)),
        repeats=max(root["resets"].read_integer(0, MOST_REPEATS), 1) if root.has("resets") else 1,
        notes=(
            *notes_on(agents),
            *(note for shape in shapes for note in shape.notes),
            *((STANDS,) if interactive else ()),
        ),
    )
    return (problem,)


def _obstacle_shapes(obstacle: Field) -> Shapes:
    """Return a static obstacle: of a Flatland model at ``pos``, turned by ``angle``, or with its
    own shape as in the older format.
    """
    if obstacle.has("shape"):
        return Shapes((placed_shape(obstacle),), ())
    x, y = obstacle["pos"].position().tolist()
    model = obstacle["yaml_path"] if obstacle.has("yaml_path") else obstacle["model_path"]
    return placed_model(model, Pose(x, y, obstacle["angle"].number() if obstacle.has("angle") else 0.0))
