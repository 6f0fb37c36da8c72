"""An agent of the crowd simulator pedsim, as files of arena-tools and of
arena-rosnav state it: a person, or several.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from arena_core import PedestrianSpec
from arena_tasks.scenario_files.companions import MOST_COMPANIONS, with_companions
from arena_tasks.scenario_files.json_fields import Field
from arena_tasks.scenario_files.problem import PersonDefaults

# what a person's own fields hold, and what is of no use here
READ_ELSEWHERE = {
    "name",
    "id",
    "pos",
    "yaml_file",
    "yaml_path",
    "model",
    "number_of_peds",
    "vmax",
    "waypoints",
    "waypoint_mode",
}
MODES = LOOP, AT_RANDOM = 0, 1  # waypoint_mode: in turn, or the next one drawn among the others
LARGEST_MODE = 1_000_000


def people_of(agent: Field, defaults: PersonDefaults) -> list[PedestrianSpec]:
    """Return the ``number_of_peds`` people of one agent, the first at ``pos``, the others close
    around it; raise InputFileError.
    """
    person = PedestrianSpec(
        id=0,
        position_xy=read_place(agent["pos"]),
        waypoints_xy=read_places(agent["waypoints"]) if agent.has("waypoints") else np.empty((0, 2)),
        desired_speed=agent["vmax"].number(above=0.0) if agent.has("vmax") else defaults.speed,
        radius=defaults.radius,
        behaviour=_agent_behaviour(agent),
    )
    return with_companions(
        person, agent["number_of_peds"].read_integer(1, MOST_COMPANIONS) if agent.has("number_of_peds") else 1
    )


def read_place(field: Field) -> NDArray[np.float64]:
    """Return [x, y] or [x, y, theta] as a position, shape (2,), m: a person's heading is where it goes."""
    return field.pose().array()[:2]


def read_places(field: Field) -> NDArray[np.float64]:
    """Return a list of them as positions, shape (N, 2), m."""
    return np.array([read_place(item) for item in field.items()]).reshape(-1, 2)


def _agent_behaviour(agent: Field) -> dict[str, float | str]:
    """Return the numbers and texts that only a pedestrian model can make something of; a round
    is a loop unless it is drawn.
    """
    found: dict[str, float | str] = {}
    for name, field in agent.entries():
        if (
            name not in READ_ELSEWHERE
            and isinstance(field.value, int | float | str)
            and not isinstance(field.value, bool)
        ):
            found[name] = field.value if isinstance(field.value, str) else field.number()
    if _waypoint_mode(agent) == AT_RANDOM:
        found["waypoint_mode"] = float(AT_RANDOM)
    return found


def _waypoint_mode(agent: Field) -> int:
    return agent["waypoint_mode"].read_integer(-LARGEST_MODE, LARGEST_MODE) if agent.has("waypoint_mode") else LOOP


def notes_on(agents: Iterable[Field]) -> list[str]:
    """Return what of some agents was not taken as written, in words."""
    unknown = [mode for agent in agents if (mode := _waypoint_mode(agent)) not in MODES]
    said = ", ".join(map(str, sorted(set(unknown))))
    return [f"people of waypoint_mode {said} walk their waypoints in a loop ({len(unknown)})"] if unknown else []
