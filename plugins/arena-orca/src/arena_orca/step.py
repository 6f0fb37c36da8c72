"""One control step: half-planes, preferred velocity, linear programme, command; one compiled call."""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import borrowing, compiled
from arena_kernels.costmap_window import CostmapWindow, Outline
from arena_kernels.half_planes import ALONG_X, ALONG_Y, POINT_X, POINT_Y, FloatArray, line_violation, put_person
from arena_kernels.linear_program import Wish, nearest_allowed, safest_velocity
from arena_orca.braking import PlanarPose, can_stop, least_gap, stopping_time
from arena_orca.columns import RADIUS, VX, VY, X, Y
from arena_orca.free_space import MOST_CELLS, MOST_WALLS, put_walls, radius_towards
from arena_orca.motion import centre_velocity, command_for, put_reach, top_speed
from arena_orca.parameters import Body, PersonRules, Settings
from arena_orca.preferred_velocity import preferred_velocity

MOST_REACH_LINES = 6
ALMOST = 0.999
WALKING = 0.2  # m/s: who is slower stands, more or less
SLOWER = (1.0, 0.6, 0.3)  # shares of a velocity that are tried while its braking path is not free


@compiled
def choose_command(
    window: CostmapWindow,
    standing: CostmapWindow,
    outline: Outline,
    path: FloatArray,
    state: FloatArray,
    people: FloatArray,
    settings: Settings,
    gear: float,
) -> tuple[bool, float, float, float]:
    """Return whether there is a valid command, and its (vx, vy, wz), for a robot in ``state`` (x, y, theta, vx, vy,
    wz).

    ``window`` holds all that the scans show, ``standing`` what does not move; ``path`` (M, 3); ``people`` rows are (x,
    y, vx, vy, radius), nearest first; all in ``map``. ``gear`` is 1, or -1 for an Ackermann robot that shall back up.
    """
    body, limits, persons, statics, drive = settings
    stand = (state[0], state[1], math.cos(state[2]), math.sin(state[2]))
    centre = (stand[0] + body.ahead * stand[2], stand[1] + body.ahead * stand[3], stand[2], stand[3])
    now = centre_velocity(body, limits, state[3], state[4], state[5])
    speed = top_speed(body, limits)
    lines = np.empty((MOST_REACH_LINES + MOST_WALLS + len(people), 4))

    reach_end = put_reach(lines, 0, body, limits, now, drive.reach_time, gear)
    walls_end = put_walls(lines, reach_end, standing, outline, body, statics, centre, speed, np.empty((MOST_CELLS, 3)))
    count = put_people(lines, walls_end, people, outline, body, persons, centre, now)
    wish = preferred_velocity(path, standing, outline, body, limits, drive, stand, gear)
    x, y = best_velocity(lines, reach_end, walls_end, count, speed, wish, np.empty_like(lines))
    return stoppable_command(window, outline, people, settings, stand, (state[3], state[4], state[5]), (x, y))


@borrowing
def put_people(
    lines: FloatArray,
    row: int,
    people: FloatArray,
    outline: Outline,
    body: Body,
    rules: PersonRules,
    centre: PlanarPose,
    now: tuple[float, float],
) -> int:
    """Write the half-planes of ``people`` seen from the effective centre; return the next row."""
    x, y, cosine, sine = centre
    how = (rules.horizon, rules.overlap_time, rules.reciprocity)
    for k in range(len(people)):
        dx, dy, vx, vy = people[k, X] - x, people[k, Y] - y, people[k, VX], people[k, VY]
        place = (cosine * dx + sine * dy, cosine * dy - sine * dx, cosine * vx + sine * vy, cosine * vy - sine * vx)
        put_person(
            lines, row + k, place, now, wanted_distance(outline, body, rules.margin, place, people[k, RADIUS]), how
        )
    return row + len(people)


@borrowing
def wanted_distance(
    outline: Outline, body: Body, margin: float, place: tuple[float, float, float, float], radius: float
) -> float:
    """Return the distance to keep from a person of ``radius`` at ``place``, m: as far as the robot reaches any way, and
    ``margin``.

    To someone who stands nearer already the robot only wants not to come nearer, until the footprint itself would
    touch: two who wait for each other to step back would wait for ever.
    """
    wanted, apart = radius + body.whole + margin, math.hypot(place[0], place[1])
    standing = max(0.0, 1.0 - math.hypot(place[2], place[3]) / WALKING)
    if apart > wanted or apart < 1e-9:
        return wanted
    least = max(radius + radius_towards(body, outline, place[0] / apart, place[1] / apart), ALMOST * apart)
    return wanted - standing * max(0.0, wanted - least)


@borrowing
def best_velocity(
    lines: FloatArray,
    reach_end: int,
    walls_end: int,
    count: int,
    speed: float,
    wish: tuple[float, float],
    scratch: FloatArray,
) -> tuple[float, float]:
    """Return the velocity nearest to ``wish`` that all lines allow; else give up people's half-planes evenly, and
    before them walls'.

    What the robot cannot drive is never chosen.
    """
    kept, x, y = nearest_allowed(lines, count, speed, Wish(wish, False))
    if kept < walls_end:
        x, y = safest_velocity(lines, reach_end, walls_end, kept, speed, (x, y), scratch)
        loosen_lines(lines, reach_end, walls_end, x, y)
        kept, x, y = nearest_allowed(lines, count, speed, Wish(wish, False))
    if walls_end <= kept < count:
        x, y = safest_velocity(lines, walls_end, count, kept, speed, (x, y), scratch)
    return x, y


@borrowing
def loosen_lines(lines: FloatArray, first: int, end: int, x: float, y: float) -> None:
    """Move lines first .. end - 1 back, all as far, until they allow (x, y)."""
    worst = 0.0
    for i in range(first, end):
        worst = max(worst, line_violation(lines[i], x, y))
    for i in range(first, end):
        lines[i, POINT_X] += lines[i, ALONG_Y] * (worst + 1e-9)
        lines[i, POINT_Y] -= lines[i, ALONG_X] * (worst + 1e-9)


@borrowing
def stoppable_command(
    window: CostmapWindow,
    outline: Outline,
    people: FloatArray,
    settings: Settings,
    stand: PlanarPose,
    twist: tuple[float, float, float],
    best: tuple[float, float],
) -> tuple[bool, float, float, float]:
    """Return the command for velocity ``best`` of the effective centre: slower, or only turning, where it could not be
    braked in time.

    A command may lead nearer to someone only if braking at once would do so as well.
    """
    body, limits, _, statics, drive = settings
    gap = statics.padding
    brake = command_for(body, limits, twist, (0.0, 0.0), drive.period)
    times = (drive.period, 2.0 * drive.period + stopping_time(limits, twist))
    gap_people = least_gap(people, outline, limits, stand, twist, brake, times, statics.padding)
    for attempt in range(len(SLOWER) + 1):
        turning = attempt == len(SLOWER)
        share = 0.0 if turning else SLOWER[attempt]
        wish = (share * best[0], best[1] if turning else share * best[1])
        command = command_for(body, limits, twist, wish, drive.period)
        if can_stop(window, outline, limits, stand, twist, command, drive.period, gap) and (
            least_gap(people, outline, limits, stand, twist, command, times, statics.padding) >= gap_people - 1e-9
        ):
            return True, command[0], command[1], command[2]
    return can_stop(window, outline, limits, stand, twist, brake, drive.period, gap), brake[0], brake[1], brake[2]
