"""The scenario format of today's arena-rosnav, as arena-simulation-setup keeps it under worlds/WORLD/scenarios."""

from __future__ import annotations

from collections.abc import Iterable

from arena_core import PedestrianSpec, Pose
from arena_tasks.scenario_files.arena_tools import STANDS
from arena_tasks.scenario_files.companions import number_people
from arena_tasks.scenario_files.flatland import placed_shape
from arena_tasks.scenario_files.flatland_model import Shapes, placed_model
from arena_tasks.scenario_files.json_fields import Field
from arena_tasks.scenario_files.pedsim_agent import notes_on, people_of
from arena_tasks.scenario_files.problem import MOST_REPEATS, Keys, PersonDefaults, Problem

MODEL_KEYS = "model", "model_path", "yaml_path"
PARTS = ("static", "dynamic", "interactive")
ITSELF = ("name", "id", "model", "yaml_file", "yaml_path", "vmax", "number_of_peds")
# what else of an agent is kept: pedsim's keys, which the task generator hands on, and our own of a person's behaviour
BEHAVIOUR = ("type", "start_up_mode", "wait_time", "waypoint_mode", "group", "reaction", "spawn_time", "respawn")
# human/adult is written as well
TYPES = ("adult", "child", "elder", "forklift", "vehicle", "service_robot", "servicerobot")
BEGIN, END = (
    ("trigger_zone_", "force_factor_", "queue"),
    ("_probability", "_base_time", "_talking_distance", "_servicing_radius"),
)


def is_arena_rosnav(root: Field) -> bool:
    """Return whether a file has this format: a list of robots beside obstacles, or of robots with a start,
    and no agents of arena-tools.
    """
    robots = root["robots"].value if root.has("robots") and not root.has("pedsim_agents") else None
    return isinstance(robots, list) and (
        root.has("obstacles") or (robots != [] and isinstance(robots[0], dict) and "start" in robots[0])
    )


def read_arena_rosnav(root: Field, defaults: PersonDefaults) -> tuple[Problem]:
    """Read the one problem of a file, that of its first robot; raise InputFileError.

    ``map`` names a world and is looked up elsewhere.
    """
    robots = root["robots"].items()
    if not robots:
        raise root["robots"].rejection("at least one robot with start and goal")
    static, dynamic, interactive = (_obstacles_of_kind(root, name) for name in PARTS)
    crowd = [(agent.key, person) for agent in dynamic for person in _agent_people(agent, defaults)]
    shapes = [_obstacle_shapes(obstacle) for obstacle in (*static, *interactive)]
    problem = Problem(
        name=root.file.stem,
        start=robots[0]["start"].pose(),
        goal=robots[0]["goal"].pose(),
        pedestrians=number_people(person for _, person in crowd),
        obstacles=tuple(obstacle for shape in shapes for obstacle in shape.obstacles),
        goal_radius=None,
        time_limit=None,
        keys=Keys(robots[0]["start"].key, robots[0]["goal"].key, tuple(key for key, _ in crowd)),
        repeats=max(root["resets"].read_integer(0, MOST_REPEATS), 1) if root.has("resets") else 1,
        notes=(
            *_reading_notes(robots, dynamic),
            *(note for shape in shapes for note in shape.notes),
            *((STANDS,) if interactive else ()),
        ),
    )
    return (problem,)


def _obstacles_of_kind(root: Field, name: str) -> list[Field]:
    """Return the obstacles of a kind, none where the file has none."""
    return root["obstacles"][name].items() if root.has("obstacles") and root["obstacles"].has(name) else []


def _agent_people(agent: Field, defaults: PersonDefaults) -> list[PedestrianSpec]:
    """Return the people of an agent, with what pedsim reads of it; one without a place begins at its first waypoint."""
    unknown = _unknown_keys(agent)
    known = {name: field.value for name, field in agent.entries() if name not in unknown}
    if "pos" not in known and agent.has("waypoints") and agent["waypoints"].items():
        known["pos"] = agent["waypoints"].items()[0].value
    if "type" in known or "forklift" in str(known.get("model", "")):
        known["type"] = _agent_type(agent) or "adult"
    return people_of(Field(agent.file, agent.key, known), defaults)


def _agent_type(agent: Field) -> str | None:
    """Return an agent's type; a forklift's is told by its model where it is not said.

    None where no one knows such a type.
    """
    said = str(agent["type"].value) if agent.has("type") else "forklift"
    return said if said.rsplit("/", 1)[-1] in TYPES else None


def _unknown_keys(agent: Field) -> list[str]:
    """Return the numbers and texts of an agent that no pedestrian model here knows."""
    return [
        str(name)
        for name, field in agent.entries()
        if isinstance(field.value, int | float | str) and not isinstance(field.value, bool) and not _is_known(str(name))
    ]


def _is_known(name: str) -> bool:
    return name in (*ITSELF, *BEHAVIOUR) or name.startswith(BEGIN) or name.endswith(END)


def _obstacle_shapes(obstacle: Field) -> Shapes:
    """Return a static obstacle: that of the model at ``pos``, [x, y, theta] or [x, y] with
    ``angle``, or with a shape of its own.
    """
    if obstacle.has("shape"):
        return Shapes((placed_shape(obstacle),), ())
    key = next((key for key in MODEL_KEYS if obstacle.has(key)), MODEL_KEYS[0])
    at = obstacle["pos"].pose()
    turn = obstacle["angle"].number() if obstacle.has("angle") else 0.0
    return placed_model(obstacle[key], Pose(at.x, at.y, at.theta + turn))


def _reading_notes(robots: list[Field], dynamic: Iterable[Field]) -> list[str]:
    agents = list(dynamic)
    unknown = sorted({name for agent in agents for name in _unknown_keys(agent)})
    types = sorted({str(agent["type"].value) for agent in agents if agent.has("type") and _agent_type(agent) is None})
    without = sum(not agent.has("pos") for agent in agents)
    return [
        *(
            [f"robots after the first are left out ({len(robots) - 1}), for here one robot drives"]
            if len(robots) > 1
            else []
        ),
        *([f"people's {', '.join(unknown)} is not read"] if unknown else []),
        *([f"people of type {', '.join(types)} are adults here"] if types else []),
        *notes_on(agents),
        *([f"people without pos begin at their first waypoint ({without})"] if without else []),
    ]
