"""What must hold before a person goes on to another state, and with whom."""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import Any

import numpy as np

from arena_kernels.compiled import inner
from arena_kernels.random import uniform
from arena_pedsim.people import NO_ERRAND, ON_ERRAND
from arena_pedsim.states.behaviour import TRAITS, ZONES
from arena_pedsim.states.person_state import NOBODY, NOT_MET, ROBOT
from arena_pedsim.states.state_table import GOALS, NEEDS, NO_KEY
from arena_pedsim.states.world_view import WorldView, can_join, gap_between, is_in, robot_gap

DRAWS = 64  # random numbers a person may draw in one step: one a transition, and the last two
PICK, LENGTH = 62, 63

NOTHING, OVER, LISTENER, COMPANY = (NEEDS.index(name) for name in ("nothing", "over", "listener", "company"))
SERVICE, ALONE, SERVER, GUIDE = (NEEDS.index(name) for name in ("service", "alone", "server", "guide"))
REQUEST, PARTNER_IN, PARTNER_NOT_IN, TRIGGER = (
    NEEDS.index(name) for name in ("request", "partner_in", "partner_not_in", "trigger")
)
GROUPED, UNGROUPED, QUEUE, ARRIVED = (NEEDS.index(name) for name in ("grouped", "ungrouped", "queue", "arrived"))
TALKING_DISTANCE, SERVICING_RADIUS = (TRAITS.index(name) for name in ("max_talking_distance", "max_servicing_radius"))
FIRST_ZONE = TRAITS.index("trigger_zone_radius")  # the first column of the first zone: radius, x, y
QUEUE_GOAL, BESIDE = GOALS.index("queue"), GOALS.index("beside")


@inner
def next_transition(scene: WorldView, i: int, chances: bool) -> tuple[int, int]:
    """Return the first transition that holds for a person, and with whom; (-1, NOBODY) if none does."""
    state, mind = scene.table[scene.states[i]], scene.minds[i]
    for t in range(state.first, state.last):
        row = scene.transitions[t]
        if row.chance != NO_KEY and not (chances and chance_occurs(scene, i, row.draw, mind.traits[row.chance])):
            continue
        partner = partner_for(scene, i, row)
        if partner != NOT_MET:
            return t, partner
    return -1, NOBODY


@inner
def chance_occurs(scene: WorldView, i: int, draw: int, chance: float) -> bool:
    """Return whether something of this chance happens now."""
    return chance > 0.0 and random_of(scene, i, draw) < chance


@inner
def random_of(scene: WorldView, i: int, draw: int) -> float:
    """Return a number in [0, 1) of a person's own."""
    return uniform(scene.world.key, scene.tick, i * DRAWS + draw)


@inner
def partner_for(scene: WorldView, i: int, row: Any) -> int:
    """Return with whom a transition would be made (NOBODY if with no one), NOT_MET if it cannot be made now."""
    needs, mind = row.needs, scene.minds[i]
    if needs == NOTHING:
        return NOBODY
    if needs == OVER:
        return NOBODY if mind.clock >= mind.duration - 1e-9 else NOT_MET
    if needs == LISTENER:
        return _find_listener(scene, i, mind.traits[TALKING_DISTANCE])
    if needs == COMPANY:
        return NOBODY if _has_company(scene, i, mind.traits[TALKING_DISTANCE], row.of) else NOT_MET
    if needs in (PARTNER_IN, PARTNER_NOT_IN):
        return mind.partner if _partner_in(scene, i, row.of) == (needs == PARTNER_IN) else NOT_MET
    if needs == TRIGGER:
        return NOBODY if _robot_in_zone(scene, mind) else NOT_MET
    if needs in (GROUPED, UNGROUPED):
        return NOBODY if (mind.group != NOBODY and scene.members[mind.group] > 1) == (needs == GROUPED) else NOT_MET
    if needs == QUEUE:
        return NOBODY if mind.queue != NOBODY and _reaches_queue(scene, i) else NOT_MET
    if needs == ARRIVED:
        return NOBODY if _has_arrived(scene, i) else NOT_MET
    return _find_helper(scene, i, row)


@inner
def _robot_in_zone(scene: WorldView, mind: Any) -> bool:
    """Return whether a robot is in one of the zones that a person waits for it to enter; one
    that is not given has radius 0.
    """
    for zone in range(ZONES):
        column = FIRST_ZONE + 3 * zone
        for place in range(len(scene.robots.radii)):
            x, y = scene.robots.poses[place, 0], scene.robots.poses[place, 1]
            dx, dy = x - mind.traits[column + 1], y - mind.traits[column + 2]
            if sqrt(dx * dx + dy * dy) < mind.traits[column]:
                return True
    return False


@inner
def _find_helper(scene: WorldView, i: int, row: Any) -> int:
    """Return who serves or guides, or whom to serve."""
    needs, mind, numbers = row.needs, scene.minds[i], scene.numbers
    if needs == ALONE:
        return NOBODY if _is_alone(scene, i, row.of) else NOT_MET
    if needs == SERVICE:
        return NOBODY if _find_server(scene, i, np.inf) != NOT_MET else NOT_MET
    if needs == SERVER:
        return _find_server(scene, i, numbers.service_reach)
    if needs == GUIDE:
        return ROBOT if robot_gap(scene, i) < numbers.guide_reach else _find_server(scene, i, numbers.guide_reach)
    if needs == REQUEST and mind.serves == 1:
        return _nearest_in(scene, i, row.of, mind.traits[SERVICING_RADIUS])
    return NOT_MET


@inner
def _find_listener(scene: WorldView, i: int, reach: float) -> int:
    """Return a person at random among those who can join, NOT_MET if no one can."""
    number = 0
    for j in range(len(scene.states)):
        number += can_join(scene, i, j, reach)
    if number == 0:
        return NOT_MET
    left = int(random_of(scene, i, PICK) * number)
    for j in range(len(scene.states)):
        if can_join(scene, i, j, reach):
            if left == 0:
                return j
            left -= 1
    return NOT_MET


@inner
def _has_company(scene: WorldView, i: int, reach: float, of: int) -> bool:
    """Return whether enough people can join, and no one near is in these states already."""
    number = 0
    for j in range(len(scene.states)):
        if j != i and is_in(scene.states[j], of) and gap_between(scene, i, j) < reach:
            return False
        number += can_join(scene, i, j, reach)
    enough: bool = number >= scene.numbers.company
    return enough


@inner
def _partner_in(scene: WorldView, i: int, of: int) -> bool:
    """Return whether the partner is in one of these states; one who speaks to one person only must speak to this."""
    partner = scene.minds[i].partner
    if partner < 0 or not is_in(scene.states[partner], of):
        return False
    meant: bool = scene.minds[partner].partner in (i, NOBODY) or scene.minds[i].serves == 1
    return meant


@inner
def _reaches_queue(scene: WorldView, i: int) -> bool:
    """Return whether the queue that a person walks to has its head or its end within reach."""
    mind, person, numbers = scene.minds[i], scene.people[i], scene.numbers
    if person.waypoint != mind.queue_waypoint or person.errand != NO_ERRAND:
        return False
    behind = numbers.queue_spacing * length_of_queue(scene, mind.queue)
    dx, dy = person.goal_x - scene.positions[i, 0], person.goal_y - scene.positions[i, 1]
    ex, ey = dx - behind * cos(mind.queue_heading), dy - behind * sin(mind.queue_heading)
    near: bool = min(dx * dx + dy * dy, ex * ex + ey * ey) < numbers.queue_reach * numbers.queue_reach
    return near


@inner
def length_of_queue(scene: WorldView, queue: int) -> int:
    """Return how many stand in a queue."""
    number = 0
    for j in range(len(scene.states)):
        number += scene.minds[j].queue == queue and scene.table[scene.states[j]].goal == QUEUE_GOAL
    return number


@inner
def _has_arrived(scene: WorldView, i: int) -> bool:
    """Return whether a person is at the place to go to."""
    person = scene.people[i]
    dx, dy = person.errand_x - scene.positions[i, 0], person.errand_y - scene.positions[i, 1]
    there: bool = sqrt(dx * dx + dy * dy) < scene.numbers.arrival
    return person.errand == ON_ERRAND and there


@inner
def _is_alone(scene: WorldView, i: int, of: int) -> bool:
    """Return whether no one else in the world is in these states."""
    others = 0
    for j in range(len(scene.states)):
        others += j != i and is_in(scene.states[j], of)
    return others == 0


@inner
def _find_server(scene: WorldView, i: int, reach: float) -> int:
    """Return the first service robot within ``reach`` m."""
    for j in range(len(scene.states)):
        if j != i and scene.minds[j].serves == 1 and gap_between(scene, i, j) < reach:
            return j
    return NOT_MET


@inner
def _nearest_in(scene: WorldView, i: int, of: int, reach: float) -> int:
    """Return the nearest person in these states within ``reach`` m."""
    nearest, found = reach, NOT_MET
    for j in range(len(scene.states)):
        gap = gap_between(scene, i, j)
        if j != i and is_in(scene.states[j], of) and gap < nearest:
            nearest, found = gap, j
    return found
