"""People who walk together: where their group goes, and the forces that keep it in shape.

Moussaid, Perozo, Garnier, Helbing, Theraulaz, The walking behaviour of pedestrian social groups and its impact on crowd
dynamics, PLoS ONE 5(4), e10047, 2010.
"""

from __future__ import annotations

from math import acos, sqrt

from arena_kernels.compiled import inner
from arena_kernels.ground import wall_clearance
from arena_kernels.slide_along import is_visible
from arena_pedsim.people import NEVER, NEXT_WAYPOINT
from arena_pedsim.states.person_state import NOBODY
from arena_pedsim.states.state_goals import GROUP, WAYPOINT, drop_state_goal, send_person
from arena_pedsim.states.world_view import SIGHT_LINE, Ints, WorldView, gap_between

TOUCHING = 0.02  # m, bodies nearer than this push no harder
FILE = 2.0  # from the centre of a file, in the half width of a line abreast, to its ends, and some air


@inner
def count_members(scene: WorldView) -> None:
    """Count the members of each group who are on the move."""
    for i in range(len(scene.states)):
        scene.members[i] = 0
    for i in range(len(scene.states)):
        goal, group = scene.table[scene.states[i]].goal, scene.minds[i].group
        if group != NOBODY and goal in (WAYPOINT, GROUP):
            scene.members[group] += 1


@inner
def walk_in_groups(scene: WorldView) -> None:
    """Send each group where its first member goes, and write the forces between its members."""
    people, first, following = len(scene.states), scene.first, scene.following
    for i in range(people):
        first[i], following[i] = NOBODY, NOBODY
    for i in range(people - 1, -1, -1):
        scene.people[i].pushing = 0
        group = scene.minds[i].group
        if group != NOBODY and scene.table[scene.states[i]].goal == GROUP:
            following[i] = first[group]
            first[group] = i
    for group in range(scene.world.groups):
        if first[group] != NOBODY:
            _lead_group(scene, first[group], following)
            _keep_shape(scene, first[group], following)


@inner
def _lead_group(scene: WorldView, leader: int, following: Ints) -> None:
    """Let a group follow its leader's waypoints; the next comes when the first of
    them reaches one where no one stays.
    """
    drop_state_goal(scene, leader)
    head = scene.people[leader]
    head.party = leader
    member = following[leader]
    while member != NOBODY:
        person = scene.people[member]
        if person.waypoints == head.waypoints and person.waypoint != head.waypoint:
            person.waypoint, person.kept = head.waypoint, 0
        person.party, person.stay = leader, head.stay
        send_person(scene, member, head.goal_x, head.goal_y)
        dx, dy = head.goal_x - scene.positions[member, 0], head.goal_y - scene.positions[member, 1]
        ends = head.respawn != NEVER and head.waypoint == head.waypoints - 1  # who leaves must get there
        if (
            head.waypoints > 1
            and not ends
            and not head.stay > 0.0
            and dx * dx + dy * dy < scene.parameters.wayfinding_waypoint_radius**2
        ):
            head.wish = NEXT_WAYPOINT
        member = following[member]


@inner
def _keep_shape(scene: WorldView, leader: int, following: Ints) -> None:
    """Write the three forces on each member of a group."""
    number, x, y = 0, 0.0, 0.0
    member = leader
    while member != NOBODY:
        number, x, y = number + 1, x + scene.positions[member, 0], y + scene.positions[member, 1]
        member = following[member]
    member = leader
    while member != NOBODY:
        person = scene.people[member]
        gaze_x, gaze_y = _gaze_force(scene, member, x / number, y / number, number)
        near_x, near_y = _coherence_force(scene, member, x / number, y / number, number)
        off_x, off_y = _repulsion_force(scene, member, leader, following, number)
        person.push_x, person.push_y, person.pushing = gaze_x + near_x + off_x, gaze_y + near_y + off_y, 1
        member = following[member]


@inner
def _gaze_force(scene: WorldView, i: int, x: float, y: float, number: int) -> tuple[float, float]:
    """Return the braking of who must turn the head to see the group's centre: -beta_1 alpha V; none in a
    file where no one falls behind.
    """
    dx, dy = x - scene.positions[i, 0], y - scene.positions[i, 1]
    abreast = 0.5 * scene.parameters.groups_distance * (number - 1)
    if dx * dx + dy * dy < (FILE * abreast) ** 2 and wall_clearance(scene.ground, x, y) < abreast + scene.radii[i]:
        return 0.0, 0.0
    vx, vy = scene.velocities[i, 0], scene.velocities[i, 1]
    lengths = sqrt((dx * dx + dy * dy) * (vx * vx + vy * vy))
    if lengths == 0.0:
        return 0.0, 0.0
    turn = acos(min(max((dx * vx + dy * vy) / lengths, -1.0), 1.0)) - scene.parameters.groups_vision
    brake = scene.parameters.groups_gaze * max(turn, 0.0)
    return -brake * vx, -brake * vy


@inner
def _coherence_force(scene: WorldView, i: int, x: float, y: float, number: int) -> tuple[float, float]:
    """Return the pull towards a centre that is in sight and farther than (N - 1) / 2 m: beta_2 U."""
    dx, dy = x - scene.positions[i, 0], y - scene.positions[i, 1]
    distance = sqrt(dx * dx + dy * dy)
    if distance <= 0.5 * (number - 1) or not is_visible(
        scene.ground, (scene.positions[i, 0], scene.positions[i, 1], x, y), SIGHT_LINE
    ):
        return 0.0, 0.0
    pull = scene.people[i].share * scene.parameters.groups_coherence / distance
    return pull * dx, pull * dy


@inner
def _repulsion_force(scene: WorldView, i: int, leader: int, following: Ints, number: int) -> tuple[float, float]:
    """Return the push of members nearer than a body and some air: beta_3 W each.

    Where there is no room abreast only who comes earlier in the group pushes: of two who reach a gap for one together,
    one waits.
    """
    abreast = 0.5 * scene.parameters.groups_distance * (number - 1)
    in_file = wall_clearance(scene.ground, scene.positions[i, 0], scene.positions[i, 1]) < abreast + scene.radii[i]
    x, y = 0.0, 0.0
    member = leader
    while member != NOBODY and not (in_file and member == i):
        gap = max(gap_between(scene, i, member), TOUCHING)
        if member != i and gap < scene.parameters.groups_distance:
            push = scene.people[i].share * scene.parameters.groups_repulsion / gap
            x += push * (scene.positions[i, 0] - scene.positions[member, 0])
            y += push * (scene.positions[i, 1] - scene.positions[member, 1])
        member = following[member]
    return x, y
