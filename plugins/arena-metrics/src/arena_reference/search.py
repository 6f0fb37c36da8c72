"""A way to the goal that the robot can drive: many states at once, step by step, led by the times that are left to go.

All states of a level have the same time. Each tries its proposals for one span; whoever is likely to arrive first goes
on, one of each small neighbourhood of place, heading and speed.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, compiled, inner
from arena_kernels.motion import OMNIDIRECTIONAL, Chassis, drive_arc, next_velocity, wrap_angle
from arena_reference.arrays import Floats
from arena_reference.body import Body, Nearby, Walkers, meets_nobody, stands_free
from arena_reference.proposals import MOST, propose
from arena_reference.terrain import Terrain
from arena_reference.times import TimesLeft, layer_number, show_until
from arena_reference.values import FINE, NEVER, STRIDE

BLOCKED = 1.5  # s that a state is put back whose coming place is taken
LOST = 1000.0  # s, likewise, where it is in a person's way already
NEAREST, FARTHEST = 4.0, 8.0  # cells from a state at which it is looked where the way goes on
AHEAD = 0.3  # s ahead, likewise, for how a state is rated
SECTORS = 16  # of headings that are told apart
SLOTS = 1 << 13  # of the table of neighbourhoods
SIDE, SMALLEST = 0.25, 0.03  # of the way of a span, and m: the side of a neighbourhood


class Problem(NamedTuple):
    """What the search knows of a problem: ground and people, the robot, the goal, and the times that are left to go.

    ``times`` are those left to go, ``step`` s apart from ``start`` s on. ``margin_walls`` and
    ``margin_people`` are kept from what stands and walks, m.
    """

    ground: Terrain
    walkers: Walkers
    body: Body
    chassis: Chassis
    share: float
    times: TimesLeft
    start: float
    step: float
    goal_x: float
    goal_y: float
    goal_radius: float
    margin_walls: float
    margin_people: float


class Grain(NamedTuple):
    """How fine a search is: ``width`` states a level, ``periods`` control periods of ``ticks`` ticks of ``tick`` s a
    level, looked at every ``look`` ticks first, and every ``close_look`` ticks before a state is kept. With an
    ``open_end`` the best way as far as ``levels`` is enough.
    """

    width: int
    periods: int
    ticks: int
    tick: float
    look: int
    close_look: int
    levels: int
    open_end: bool


@inner
def top_speed(chassis: Chassis) -> float:
    """Return the greatest speed in any direction, m/s."""
    return math.sqrt(max(chassis.vx_max, -chassis.vx_min) ** 2 + chassis.vy_max**2)


@borrowing
def look_ahead(step: float) -> float:
    """Return how far beyond a level's span times left to go are looked up, s, that are ``step`` s apart."""
    return max(FARTHEST / STRIDE * step, AHEAD)


@inner
def time_left(problem: Problem, x: float, y: float, t: float) -> float:
    """Return how long it takes from a place at a time, s, by the cells about it; inf if there is no way. ``t`` is in s,
    inf when everybody is gone.
    """
    ground = problem.ground
    layer = problem.times.layers[layer_number(problem.times, (t - problem.start) / problem.step)]
    dx, dy = (x - ground.x) / ground.cell, (y - ground.y) / ground.cell
    u = ground.cosine * dx + ground.sine * dy - 0.5
    v = ground.cosine * dy - ground.sine * dx - 0.5
    if not (0.0 <= u < layer.shape[1] - 1 and 0.0 <= v < layer.shape[0] - 1):
        return np.inf
    column, row = int(u), int(v)
    a, b = u - column, v - row
    corners = (layer[row, column], layer[row, column + 1], layer[row + 1, column], layer[row + 1, column + 1])
    weights = ((1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b)
    total, weight = 0.0, 0.0
    for i in range(4):
        if corners[i] != NEVER:
            total += weights[i] * corners[i]
            weight += weights[i]
    return total / weight / FINE * problem.step if weight > 1e-9 else np.inf


@inner
def way_on(problem: Problem, x: float, y: float, t: float) -> tuple[float, float]:
    """Return where the quickest way leads from a place: the direction in ``map``, and how far the place is that was
    looked at, m; a distance of 0 where no way leads on.
    """
    best, direction, reached = np.inf, 0.0, 0.0
    for far in (NEAREST, FARTHEST):
        radius = far * problem.ground.cell
        later = t + far / STRIDE * problem.step
        for k in range(24):
            angle = k * (2.0 * math.pi / 24.0)
            left = time_left(problem, x + radius * math.cos(angle), y + radius * math.sin(angle), later) + (later - t)
            if left < best - 1e-9:
                best, direction, reached = left, angle, radius
    return direction, reached


class Span(NamedTuple):
    """A span of a drive: from ``start`` s on ``ticks`` ticks of ``tick`` s, looked at every ``look`` ticks, beside the
    people who are ``near``, by number (N,).
    """

    near: Floats
    start: float
    ticks: int
    tick: float
    look: int


@inner
def drive(problem: Problem, state: Floats, command: Floats, span: Span, out: Floats) -> bool:
    """Drive a state (6,), pose in ``map`` and velocity in ``base_link``, for a span; write where it ends, and return
    whether it met nothing wherever it was looked at.
    """
    pose, velocity = (state[0], state[1], state[2]), (state[3], state[4], state[5])
    free = True
    for k in range(1, span.ticks + 1):
        velocity = next_velocity(problem.chassis, problem.share, velocity, command, span.tick)
        pose = drive_arc(pose, velocity, span.tick)
        if k % span.look == 0 or k == span.ticks:
            nearby = Nearby(problem.walkers, span.near, span.start + k * span.tick, problem.margin_people)
            free = stands_free(problem.ground, problem.body, pose, problem.margin_walls)
            free = free and meets_nobody(nearby, problem.body, pose)
            if not free:
                break
    out[0], out[1], out[2] = pose
    out[3], out[4], out[5] = velocity
    return free


@inner
def rate(problem: Problem, state: Floats, t: float) -> float:
    """Return how long a state at time ``t`` needs to the goal, s, by the place that it comes to; inf where nothing
    leads on even when everybody is gone.
    """
    here = time_left(problem, state[0], state[1], t)
    if here == np.inf:
        return LOST + time_left(problem, state[0], state[1], np.inf)
    c, s = math.cos(state[2]), math.sin(state[2])
    dx, dy = c * state[3] - s * state[4], s * state[3] + c * state[4]
    there = AHEAD + time_left(problem, state[0] + AHEAD * dx, state[1] + AHEAD * dy, t + AHEAD)
    if there == np.inf:
        return here + BLOCKED
    return min(there, here + BLOCKED)


@compiled
def people_near(problem: Problem, states: Floats, count: int, t: float, span: float) -> Floats:
    """Return the numbers of the people whom any of ``count`` states (B, 6) may meet within ``span`` s."""
    walkers, speed = problem.walkers, top_speed(problem.chassis)
    low_x, high_x = states[:count, 0].min(), states[:count, 0].max()
    low_y, high_y = states[:count, 1].min(), states[:count, 1].max()
    near, found = np.empty(len(walkers.radii)), 0
    first = int(min(max((t - walkers.start) / walkers.period, 0.0), len(walkers.positions) - 1.0))
    last = min(math.ceil((t + span - walkers.start) / walkers.period) + 1, len(walkers.positions))
    for p in range(len(walkers.radii)):
        reach = walkers.radii[p] + problem.body.radius + problem.margin_people + speed * span
        for k in range(min(first, last - 1), last):
            x, y = walkers.positions[k, p, 0], walkers.positions[k, p, 1]
            if low_x - reach < x < high_x + reach and low_y - reach < y < high_y + reach:
                near[found] = p
                found += 1
                break
    return near[:found]


@inner
def neighbourhood(problem: Problem, state: Floats, side: float) -> Any:
    """Return a number that states share that are alike: in place, heading and speed."""
    key = math.floor(state[0] / side) * 73856093 ^ math.floor(state[1] / side) * 19349663
    if problem.chassis.kinematics != OMNIDIRECTIONAL or len(problem.body.corners) > 0:
        key ^= math.floor(state[2] * SECTORS / (2.0 * math.pi)) * 83492791
    speeds = max(problem.chassis.vx_max, 1e-9)
    key ^= math.floor(2.0 * state[3] / speeds + 0.5) * 2654435761
    if problem.chassis.kinematics == OMNIDIRECTIONAL:
        key ^= math.floor(2.0 * state[4] / speeds + 0.5) * 40503
    return key


class Tree(NamedTuple):
    """What is kept of each level: ``states`` (L + 1, B, 6), from which state (L + 1, B), and by which command
    (L + 1, B, 3).
    """

    states: Floats
    parents: NDArray[np.int32]
    commands: Floats


class Tried(NamedTuple):
    """What is tried on one level: commands (M, 3), where they end (M, 6), how these rate (M,), and from which state
    (M,) of the level they come.
    """

    commands: Floats
    ends: Floats
    ratings: Floats
    origins: NDArray[np.int32]


class Step(NamedTuple):
    """The step from one level to the next: how many states it begins with, how many ends are tried, and the span as it
    is looked at first and before a state is kept.
    """

    level: int
    width: int
    made: int
    rough: Span
    close: Span


@compiled
def search(problem: Problem, grain: Grain, state: Floats, t: float) -> tuple[Floats, Floats, float]:
    """Return commands (L, 3), one for each span, the states (L + 1, 6) between them, and when the goal is reached, s.

    The time is inf where no way was found; there are no commands then but with an open end, which lead to the best
    state that was reached.
    """
    ticks, span = grain.periods * grain.ticks, grain.periods * grain.ticks * grain.tick
    levels, most = grain.levels + 1, grain.width * MOST
    tree = Tree(
        np.empty((levels, grain.width, 6)),
        np.empty((levels, grain.width), np.int32),
        np.empty((levels, grain.width, 3)),
    )
    tried = Tried(np.empty((most, 3)), np.empty((most, 6)), np.empty(most), np.empty(most, np.int32))
    tree.states[0, 0] = state
    count, reached = 1, 0
    for level in range(grain.levels):
        now = t + level * span
        show_until(problem.times, (now + span + look_ahead(problem.step) - problem.start) / problem.step)
        near = people_near(problem, tree.states[level], count, now, span)
        rough = Span(near, now, ticks // grain.look, grain.tick * grain.look, 1)
        close = Span(near, now, ticks, grain.tick, grain.close_look)
        made = try_proposals(problem, tree, tried, Step(level, count, 0, rough, close))
        count, best, arrival = keep_best(problem, grain, tree, tried, Step(level, count, made, rough, close))
        if best >= 0:
            return (*trace_back(tree, level + 1, best), arrival)
        if count == 0:
            break
        reached = level + 1
    if grain.open_end and reached > 0:
        return (*trace_back(tree, reached, 0), np.inf)
    return np.empty((0, 3)), np.empty((0, 6)), np.inf


@compiled
def try_proposals(problem: Problem, tree: Tree, tried: Tried, step: Step) -> int:
    """Drive the proposals of every state of a level and rate where they end; return how many lead on."""
    proposals, made, span = np.empty((MOST, 3)), 0, step.rough.ticks * step.rough.tick
    for b in range(step.width):
        here = tree.states[step.level, b]
        direction, away = way_on(problem, here[0], here[1], step.rough.start)
        target = wrap_angle(direction - here[2]), away
        for i in range(propose(problem.chassis, problem.share, target, span, proposals)):
            if not drive(problem, here, proposals[i], step.rough, tried.ends[made]):
                continue
            rating = rate(problem, tried.ends[made], step.rough.start + span)
            if rating < np.inf:
                tried.ratings[made], tried.origins[made], tried.commands[made] = rating, b, proposals[i]
                made += 1
    return made


@compiled
def keep_best(problem: Problem, grain: Grain, tree: Tree, tried: Tried, step: Step) -> tuple[int, int, float]:
    """Keep the best ends, one of each neighbourhood, that meet nothing when looked at closely; return how many, which
    of them has arrived first (-1: none) and when, s.
    """
    span = step.close.ticks * step.close.tick
    side = max(SMALLEST, SIDE * top_speed(problem.chassis) * problem.share * span)
    table, taken = np.empty(SLOTS, np.int64), np.zeros(SLOTS, np.bool_)
    count, best, soonest = 0, -1, np.inf
    for candidate in np.argsort(tried.ratings[: step.made]):
        slot, key = find_slot(table, taken, neighbourhood(problem, tried.ends[candidate], side))
        here, command = tree.states[step.level, tried.origins[candidate]], tried.commands[candidate]
        if taken[slot] or not drive(problem, here, command, step.close, tree.states[step.level + 1, count]):
            continue
        table[slot], taken[slot] = key, True
        tree.parents[step.level + 1, count] = tried.origins[candidate]
        tree.commands[step.level + 1, count] = command
        arrival = step.close.start + arrival_in_span(problem, grain, here, command)
        if arrival < soonest:
            best, soonest = count, arrival
        count += 1
        if count == grain.width:
            break
    return count, best, soonest


@inner
def find_slot(table: NDArray[np.int64], taken: NDArray[np.bool_], key: int) -> tuple[int, int]:
    """Return the slot of a table that holds a key, or the free one where it is to stand, and the key."""
    slot = (key * 0x9E3779B1 >> 7) & (SLOTS - 1)
    while taken[slot] and table[slot] != key:
        slot = (slot + 1) & (SLOTS - 1)
    return slot, key


@inner
def arrival_in_span(problem: Problem, grain: Grain, state: Floats, command: Floats) -> float:
    """Return when a state is at the goal within a span of one command, at the end of a control period, s from its
    beginning; inf if it is not.
    """
    speed = top_speed(problem.chassis)
    span = grain.periods * grain.ticks * grain.tick
    away = math.sqrt((state[0] - problem.goal_x) ** 2 + (state[1] - problem.goal_y) ** 2)
    if away > problem.goal_radius + speed * span:
        return np.inf
    pose, velocity = (state[0], state[1], state[2]), (state[3], state[4], state[5])
    for k in range(1, grain.periods * grain.ticks + 1):
        velocity = next_velocity(problem.chassis, problem.share, velocity, command, grain.tick)
        pose = drive_arc(pose, velocity, grain.tick)
        if k % grain.ticks == 0:
            away = math.sqrt((pose[0] - problem.goal_x) ** 2 + (pose[1] - problem.goal_y) ** 2)
            if away <= problem.goal_radius:
                return k * grain.tick
    return np.inf


@compiled
def trace_back(tree: Tree, level: int, last: int) -> tuple[Floats, Floats]:
    """Return the commands (level, 3) and states (level + 1, 6) that lead to state ``last`` of a level."""
    commands, passed = np.empty((level, 3)), np.empty((level + 1, 6))
    for k in range(level, 0, -1):
        commands[k - 1], passed[k] = tree.commands[k, last], tree.states[k, last]
        last = tree.parents[k, last]
    passed[0] = tree.states[0, last]
    return commands, passed
