"""Where people go who do not follow waypoints of their own: into a circle, beside or near
a person, after a group, into a queue.
"""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt

import numpy as np

from arena_kernels.compiled import inner
from arena_kernels.crowds import nearest_robot
from arena_pedsim.people import BACK_FROM_ERRAND, NEW_ROUTE, NO_ERRAND, NOTHING, ON_ERRAND
from arena_pedsim.routes.wayfinding import SLOWING
from arena_pedsim.states.person_state import NOBODY, ROBOT
from arena_pedsim.states.state_table import GOALS
from arena_pedsim.states.transitions import BESIDE, QUEUE_GOAL
from arena_pedsim.states.world_view import WorldView

NO_GOAL, WAYPOINT, CIRCLE = (GOALS.index(name) for name in ("none", "waypoint", "circle"))
NEAR, ROBOT_GOAL, GROUP = (GOALS.index(name) for name in ("near", "robot_goal", "group"))
STILL = 0.1  # share of the person's own speed; who is slower walks in no direction


@inner
def set_state_goals(scene: WorldView) -> None:
    """Write where everybody goes; members of groups are sent elsewhere."""
    _form_circles(scene)
    for i in range(len(scene.states)):
        state, partner = scene.table[scene.states[i]], scene.minds[i].partner
        if state.goal == WAYPOINT:
            drop_state_goal(scene, i)
        elif state.goal == CIRCLE:
            _join_circle(scene, i, i if partner == NOBODY else partner)
        elif state.goal == BESIDE:
            _walk_beside(scene, i, partner, state.keep)
        elif state.goal == NEAR and partner == ROBOT:
            nearest = nearest_robot(scene.robots, scene.positions[i, 0], scene.positions[i, 1])
            _keep_from(scene, i, scene.robots.poses[nearest, 0], scene.robots.poses[nearest, 1], state.keep)
        elif state.goal == NEAR:
            _keep_from(scene, i, scene.positions[partner, 0], scene.positions[partner, 1], state.keep)
        elif state.goal == ROBOT_GOAL:
            send_person(scene, i, scene.world.goal_x, scene.world.goal_y)
        elif state.goal == QUEUE_GOAL:
            _stand_in_line(scene, i)


@inner
def send_person(scene: WorldView, i: int, x: float, y: float) -> None:
    """Let a person go to (x, y), by a route if that is not in sight."""
    person, mind = scene.people[i], scene.minds[i]
    person.errand_x, person.errand_y = x, y
    if person.errand != ON_ERRAND:
        person.kept = 1 if person.errand == NO_ERRAND and person.wish == NOTHING and person.lost == 0 else 0
        mind.way_x, mind.way_y, mind.way_corner, mind.way_corners = (
            person.goal_x,
            person.goal_y,
            person.corner,
            person.corners,
        )
        person.errand, person.corner, person.corners, person.lost = ON_ERRAND, 0, 0, 0
        person.look_clock = np.inf
        person.wish = NOTHING


@inner
def drop_state_goal(scene: WorldView, i: int) -> None:
    """Let a person go on with its own waypoints, by the old way while it is in sight."""
    person, mind = scene.people[i], scene.minds[i]
    if person.errand == ON_ERRAND and person.kept == 1:
        person.errand = NO_ERRAND
        person.goal_x, person.goal_y, person.corner, person.corners = (
            mind.way_x,
            mind.way_y,
            mind.way_corner,
            mind.way_corners,
        )
        person.look_clock = np.inf
    elif person.errand == ON_ERRAND:
        person.errand = BACK_FROM_ERRAND if person.waypoints > 0 else NO_ERRAND
        if person.wish == NOTHING and person.waypoints > 0:
            person.wish = NEW_ROUTE


@inner
def _form_circles(scene: WorldView) -> None:
    """Link and count who stands in each circle, by its host: a story's teller, in the middle, does not."""
    for i in range(len(scene.states)):
        scene.minds[i].company = 0
        scene.first[i], scene.following[i] = NOBODY, NOBODY
    for i in range(len(scene.states)):
        if scene.table[scene.states[i]].goal == CIRCLE:
            partner = scene.minds[i].partner
            host = i if partner == NOBODY else partner
            scene.minds[host].company += 1
            scene.following[i] = scene.first[host]
            scene.first[host] = i
            centre = scene.minds[host]
            scene.angles[i] = atan2(scene.positions[i, 1] - centre.centre_y, scene.positions[i, 0] - centre.centre_x)


@inner
def _join_circle(scene: WorldView, i: int, host: int) -> None:
    """Send a person to the circle around where the host began to talk, half-way between the neighbours."""
    mind, numbers = scene.minds[host], scene.numbers
    radius = max(mind.company * numbers.circle_spacing / (2.0 * pi), numbers.circle_least)
    angle, left, right = scene.angles[i], 2.0 * pi, 2.0 * pi
    member = scene.first[host]
    while member != NOBODY:
        if member != i:
            turn = scene.angles[member] - angle
            turn += 2.0 * pi if turn < 0.0 else 0.0
            left, right = min(left, turn), min(right, 2.0 * pi - turn)
        member = scene.following[member]
    angle += 0.5 * (left - right)
    send_person(scene, i, mind.centre_x + radius * cos(angle), mind.centre_y + radius * sin(angle))


@inner
def _keep_from(scene: WorldView, i: int, x: float, y: float, distance: float) -> None:
    """Send a person to the nearest place at this distance from (x, y)."""
    dx, dy = scene.positions[i, 0] - x, scene.positions[i, 1] - y
    away = sqrt(dx * dx + dy * dy)
    ux, uy = (dx / away, dy / away) if away > 1e-6 else (cos(float(i)), sin(float(i)))
    send_person(scene, i, x + distance * ux, y + distance * uy)


@inner
def _walk_beside(scene: WorldView, i: int, partner: int, distance: float) -> None:
    """Send a person to the partner's side, the one where he or she is; near a partner who stands."""
    x, y = scene.positions[partner, 0], scene.positions[partner, 1]
    vx, vy = scene.velocities[partner, 0], scene.velocities[partner, 1]
    speed = sqrt(vx * vx + vy * vy)
    if speed < STILL * scene.people[partner].walking_speed:
        _keep_from(scene, i, x, y, distance)
        return
    aside = vx * (scene.positions[i, 1] - y) - vy * (scene.positions[i, 0] - x)  # > 0: on the left
    side = distance / speed if aside >= 0.0 else -distance / speed
    lead = SLOWING * scene.parameters.relaxation_time
    send_person(scene, i, x - side * vy + lead * vx, y + side * vx + lead * vy)


@inner
def _stand_in_line(scene: WorldView, i: int) -> None:
    """Send a person to its place in the queue."""
    mind = scene.minds[i]
    behind = scene.numbers.queue_spacing * mind.place
    send_person(
        scene, i, mind.centre_x - behind * cos(mind.queue_heading), mind.centre_y - behind * sin(mind.queue_heading)
    )
