"""One step of what the people of N worlds do, as one compiled call."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.crowds import Crowds, Robots, RobotStack, bodies_of
from arena_kernels.ground import GroundStack, world_ground
from arena_pedsim.states.changes import change_state, follow_changes
from arena_pedsim.states.group_walking import count_members, walk_in_groups
from arena_pedsim.states.person_state import SocialArrays
from arena_pedsim.states.state_goals import set_state_goals
from arena_pedsim.states.state_table import StateRules
from arena_pedsim.states.transitions import QUEUE_GOAL, next_transition
from arena_pedsim.states.world_view import WorldView


@borrowing
def step_states(
    crowds: Crowds,
    people: NDArray[np.void],
    social: SocialArrays,
    robots: RobotStack,
    ticks: NDArray[np.int64],
    dt: float,
    land: GroundStack,
    rules: StateRules,
    parameters: NDArray[np.void],
) -> None:
    """Let ``dt`` s pass for what people are doing, in place, and say where each of them goes."""
    minds, worlds, links, angles = social
    table, transitions, numbers = rules
    for world in range(len(crowds.counts)):
        n = crowds.counts[world]
        if worlds[world].lively == 0 or n == 0:
            continue
        positions, velocities, radii, states = bodies_of(crowds, world)
        scene = WorldView(
            positions,
            velocities,
            radii,
            states,
            people[world],
            minds[world],
            links[0, :n],
            links[1, :n],
            links[2, :n],
            angles[:n],
            worlds[world],
            ticks[world],
            Robots(robots.poses[world], robots.velocities[world], robots.radii[world]),
            world_ground(land, world),
            table,
            transitions,
            numbers[0],
            parameters[0],
        )
        follow_changes(scene)
        if worlds[world].groups > 0:
            count_members(scene)
        _change_states(scene, dt, _is_check(worlds[world], dt, numbers[0].check_period))
        set_state_goals(scene)
        if worlds[world].groups > 0:
            walk_in_groups(scene)


@inner
def _is_check(world: Any, dt: float, period: float) -> bool:
    """Return whether chances are tested now."""
    world.clock += dt
    if world.clock < period - 1e-9:
        return False
    world.clock -= period
    return True


@inner
def _change_states(scene: WorldView, dt: float, chances: bool) -> None:
    """Let clocks run, and everybody go on to another state who must or happens to."""
    for i in range(len(scene.states)):
        mind = scene.minds[i]
        if scene.table[scene.states[i]].goal != QUEUE_GOAL or mind.place == 0:
            mind.clock += dt
        transition, partner = next_transition(scene, i, chances)
        if transition >= 0:
            change_state(scene, i, scene.transitions[transition], partner)
