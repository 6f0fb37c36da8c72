"""One step of what the people of N worlds do, as one compiled call."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.crowds import Crowds, Robots, bodies_of, robot_of
from arena_kernels.ground import Land, ground_below
from arena_pedsim.states.changes import change, take_note
from arena_pedsim.states.errands import set_errands
from arena_pedsim.states.group_walking import count_members, walk_in_groups
from arena_pedsim.states.minds import Social
from arena_pedsim.states.needs import QUEUE_GOAL, next_transition
from arena_pedsim.states.scene import Scene
from arena_pedsim.states.state_table import StateRules


@borrowing
def step_states(
    crowds: Crowds,
    people: NDArray[np.void],
    social: Social,
    robots: Robots,
    ticks: NDArray[np.int64],
    dt: float,
    land: Land,
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
        robot = robot_of(robots, world)
        scene = Scene(
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
            robot.x,
            robot.y,
            ground_below(land, world),
            table,
            transitions,
            numbers[0],
            parameters[0],
        )
        take_note(scene)
        if worlds[world].groups > 0:
            count_members(scene)
        _change_states(scene, dt, _is_check(worlds[world], dt, numbers[0].check_period))
        set_errands(scene)
        if worlds[world].groups > 0:
            walk_in_groups(scene)


@inner
def _is_check(world: Any, dt: float, period: float) -> bool:
    """Tell whether chances are tested now."""
    world.clock += dt
    if world.clock < period - 1e-9:
        return False
    world.clock -= period
    return True


@inner
def _change_states(scene: Scene, dt: float, chances: bool) -> None:
    """Let clocks run, and everybody go on to another state who must or happens to."""
    for i in range(len(scene.states)):
        mind = scene.minds[i]
        if scene.table[scene.states[i]].goal != QUEUE_GOAL or mind.place == 0:
            mind.clock += dt
        transition, partner = next_transition(scene, i, chances)
        if transition >= 0:
            change(scene, i, scene.transitions[transition], partner)
