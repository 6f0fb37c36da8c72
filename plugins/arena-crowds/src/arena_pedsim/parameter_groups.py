"""The model's numbers in the groups that its constructor takes, and as the kernels read them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import Gait
from arena_core.parameters import Positive, Step
from arena_pedsim.parameters import (
    CODES,
    ForceFactors,
    GivingWay,
    GroupWalking,
    PersonTypes,
    Reactions,
    SocialInteraction,
    Spawning,
    WallForce,
    Wayfinding,
)
from arena_pedsim.states.behaviour import Behaviour

ReactionName = Literal["ignore", "yield", "curious", "scared", "threatening"]


@dataclass(frozen=True, slots=True)
class Forces:
    """What pushes people: the time in which they take up a velocity, the longest step (both s), and the forces."""

    relaxation_time: Positive
    longest_step: Step
    factors: ForceFactors
    social: SocialInteraction
    walls: WallForce
    groups: GroupWalking


@dataclass(frozen=True, slots=True)
class Walking:
    """How people follow their waypoints, let robots pass, come and go."""

    wayfinding: Wayfinding
    giving_way: GivingWay
    spawning: Spawning


@dataclass(frozen=True, slots=True)
class Persons:
    """What people are and do: their reaction to robots, the numbers of reactions, kinds of people, social states."""

    reaction: ReactionName
    reactions: Reactions
    types: PersonTypes
    behaviour: Behaviour


@dataclass(frozen=True, slots=True)
class Appearance:
    """What lidars see of people: discs, or two legs that walk with this gait."""

    body: Literal["discs", "legs"]
    gait: Gait


def parameter_record(forces: Forces, ways: Walking, states: NDArray[np.void]) -> NDArray[np.void]:
    """Flatten the groups to one record (shape (1,)) with fields such as ``social_gamma``; words become their CODES.

    Of the table of ``states`` it holds what every step needs: ``state_speed``, the share of the desired speed (0: goes
    nowhere), ``state_pushed`` and ``state_startled``.
    """
    values: dict[str, Any] = {"relaxation_time": forces.relaxation_time, "longest_step": forces.longest_step}
    groups: dict[str, Any] = {"social": forces.social, "walls": forces.walls, "wayfinding": ways.wayfinding}
    groups |= {"giving_way": ways.giving_way, "spawning": ways.spawning, "groups": forces.groups}
    for name, group in groups.items():
        values.update({f"{name}_{field.name}": getattr(group, field.name) for field in fields(group)})
    dtype: list[Any] = [(key, np.int64 if isinstance(value, str) else np.float64) for key, value in values.items()]
    row = [CODES[value] if isinstance(value, str) else value for value in values.values()]
    speed = np.where(states["goal"] == 0, 0.0, states["speed"])
    per_state = {"state_speed": speed, "state_pushed": states["pushed"], "state_startled": states["startled"]}
    dtype += [(key, np.float64, (len(states),)) for key in per_state]
    return np.array([(*row, *per_state.values())], dtype=dtype)
