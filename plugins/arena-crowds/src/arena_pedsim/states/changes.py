"""Leaving one state and entering another."""

from __future__ import annotations

from math import isnan
from typing import Any

import numpy as np

from arena_kernels.compiled import inner
from arena_pedsim.people import NEXT_WAYPOINT
from arena_pedsim.state_ids import STANDING, WALKING
from arena_pedsim.states.person_state import NOBODY
from arena_pedsim.states.state_table import NO_KEY
from arena_pedsim.states.transitions import (
    COMPANY,
    LENGTH,
    LISTENER,
    QUEUE_GOAL,
    TALKING_DISTANCE,
    length_of_queue,
    random_of,
)
from arena_pedsim.states.world_view import WorldView, can_join


@inner
def change_state(scene: WorldView, i: int, row: Any, partner: int) -> None:
    """Make a transition: leave the old state, enter the new, and draw those in who are called."""
    enter_state(scene, i, row.to, partner)
    if row.calls == 0:
        return
    scene.people[i].party = i  # and the others' will be this one, too
    if row.needs == LISTENER:
        enter_state(scene, partner, row.calls, i)
    elif row.needs == COMPANY:
        for j in range(len(scene.states)):
            if can_join(scene, i, j, scene.minds[i].traits[TALKING_DISTANCE]):
                enter_state(scene, j, row.calls, i)


@inner
def enter_state(scene: WorldView, i: int, state: int, partner: int) -> None:
    """Put a person in a state; who would walk but has no waypoint stands."""
    person, mind = scene.people[i], scene.minds[i]
    state = STANDING if state == WALKING and person.waypoints == 0 else state
    was_queueing = scene.table[mind.state].goal == QUEUE_GOAL
    leave_state(scene, i)
    mind.centre_x, mind.centre_y = scene.positions[i, 0], scene.positions[i, 1]
    if scene.table[state].goal == QUEUE_GOAL:
        mind.place = length_of_queue(scene, mind.queue)
        mind.centre_x, mind.centre_y = person.goal_x, person.goal_y
    if was_queueing and person.waypoints > 0:
        person.wish = NEXT_WAYPOINT
    mind.partner = partner
    person.party = partner if partner >= 0 else i
    scene.states[i] = state
    mind.duration = _state_duration(scene, i, scene.table[state])
    apply_state(scene, i)


@inner
def leave_state(scene: WorldView, i: int) -> None:
    """Take a person out of the state that the mind remembers: in a queue, those behind move up."""
    mind = scene.minds[i]
    if scene.table[mind.state].goal == QUEUE_GOAL:
        for j in range(len(scene.states)):
            other = scene.minds[j]
            if other.queue == mind.queue and scene.table[other.state].goal == QUEUE_GOAL and other.place > mind.place:
                other.place -= 1
    mind.partner, scene.people[i].party = NOBODY, i
    mind.clock = 0.0
    mind.duration = np.inf


@inner
def apply_state(scene: WorldView, i: int) -> None:
    """Give a person the speed and the sensitivity to others of the present state."""
    person, mind, state = scene.people[i], scene.minds[i], scene.table[scene.states[i]]
    mind.state = scene.states[i]
    person.max_speed = person.walking_speed * max(state.speed, 1.0)
    person.factor_social = mind.own_social if isnan(state.social) else person.share * state.social
    person.anchor_x, person.anchor_y, person.stuck_clock = scene.positions[i, 0], scene.positions[i, 1], 0.0


@inner
def follow_changes(scene: WorldView) -> None:
    """Follow changes of state that were made elsewhere: on arrival at an only waypoint, on coming and going."""
    for i in range(len(scene.states)):
        if scene.minds[i].state != scene.states[i]:
            leave_state(scene, i)
            apply_state(scene, i)


@inner
def _state_duration(scene: WorldView, i: int, state: Any) -> float:
    """Return how long a person will stay in a state, s."""
    if state.base_time == NO_KEY:
        return np.inf
    base: float = scene.minds[i].traits[state.base_time]
    if state.exact == 1:
        return base
    spread: float = scene.numbers.spread * (2.0 * random_of(scene, i, LENGTH) - 1.0)
    return base + base * spread
