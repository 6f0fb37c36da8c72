"""Tracked people, rolled on by the forces of the crowd: what each wants is what the track tells."""

from __future__ import annotations

from math import atan2, cos, hypot, inf, sin
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.ground import Ground, clearance_and_gradient, wall_clearance
from arena_kernels.separation import body_overlap
from arena_pedsim.forces.forces import sight_weight, social_force, wall_force

Floats = NDArray[np.float64]
MARCH = 0.1  # m, the least step of a look along a heading


class Walkers(NamedTuple):
    """K people: ``places`` and ``velocities`` (K, 2), ``radii`` (K,), their ``wishes`` (K, 2), the velocities that they
    would walk with if nothing was in their way, how far what is known of them is to be ``trusted`` (K,), 0 .. 1: forces
    count for as much, and room for the ``forces`` between them (K, 2).
    """

    places: Floats
    velocities: Floats
    radii: Floats
    wishes: Floats
    trusted: Floats
    forces: Floats


class Manners(NamedTuple):
    """The forces' figures, what they weigh beside a drive of 1 / ``relaxation`` s, for people of 1 m/s, and how a way
    is chosen: every ``look`` s a wish turns by steps of ``turn`` rad to where the way is free for ``ahead`` s, up to
    ``turns`` of them to either side.
    """

    parameters: Any
    relaxation: float
    social: float
    walls: float
    look: float
    ahead: float
    turn: float
    turns: int


@borrowing
def roll_on(walkers: Walkers, ground: Ground, manners: Manners, dt: float, out: Floats) -> None:
    """Write to ``out`` (K, H, 2) where people are now and after every step of ``dt`` s.

    ``walkers`` are overwritten.
    """
    count, look = len(walkers.radii), max(int(manners.look / dt + 0.5), 1)
    for step in range(out.shape[1]):
        for k in range(count):
            out[k, step, 0], out[k, step, 1] = walkers.places[k, 0], walkers.places[k, 1]
            if step % look == 0:
                _choose_way(walkers, k, ground, manners)
        if step + 1 == out.shape[1]:
            break
        _sum_forces(walkers, manners)
        for k in range(count):
            _move_on(walkers, k, ground, manners, dt)
        _keep_apart(walkers)


@inner
def _choose_way(walkers: Walkers, k: int, ground: Ground, manners: Manners) -> None:
    """Turn a wish by as little as leads to where the way is free, or free longest: through a door, along a wall."""
    wx, wy = walkers.wishes[k, 0], walkers.wishes[k, 1]
    speed = hypot(wx, wy)
    if speed < 1e-3:
        return
    heading, wanted = atan2(wy, wx), speed * manners.ahead
    best, chosen = -inf, 0.0
    for i in range(2 * manners.turns + 1):
        off = manners.turn * ((i + 1) // 2) * (1.0 if i % 2 else -1.0)
        free = _free_way(walkers, k, heading + off, wanted, ground)
        worth = min(free, wanted) * cos(0.5 * off)
        if worth > best + 1e-9:
            best, chosen = worth, off
        if free >= wanted:
            break
    walkers.wishes[k, 0], walkers.wishes[k, 1] = speed * cos(heading + chosen), speed * sin(heading + chosen)


@inner
def _free_way(walkers: Walkers, k: int, heading: float, wanted: float, ground: Ground) -> float:
    """Return for how far, up to ``wanted`` m, a body finds no wall on a heading."""
    x, y, c, s, done = walkers.places[k, 0], walkers.places[k, 1], cos(heading), sin(heading), 0.0
    least = min(walkers.radii[k], wall_clearance(ground, x, y)) - 0.5 * ground.cell
    while done < wanted:
        free = wall_clearance(ground, x + done * c, y + done * s) - least
        if free <= 0.0:
            return done
        done += max(free, MARCH)
    return wanted


@inner
def _sum_forces(walkers: Walkers, manners: Manners) -> None:
    """Write what people do to each other."""
    count, parameters, forces = len(walkers.radii), manners.parameters, walkers.forces
    forces[:] = 0.0
    for i in range(count):
        for j in range(i + 1, count):
            dx, dy = walkers.places[j, 0] - walkers.places[i, 0], walkers.places[j, 1] - walkers.places[i, 1]
            if dx * dx + dy * dy > parameters.social_range * parameters.social_range:
                continue
            dvx = walkers.velocities[i, 0] - walkers.velocities[j, 0]
            dvy = walkers.velocities[i, 1] - walkers.velocities[j, 1]
            fx, fy, ex, ey = social_force(dx, dy, dvx, dvy, walkers.radii[i] + walkers.radii[j], parameters)
            if fx == 0.0 and fy == 0.0:
                continue
            for one, sign in ((i, 1.0), (j, -1.0)):
                wx, wy = walkers.wishes[one, 0], walkers.wishes[one, 1]
                speed = hypot(wx, wy)
                if speed < 1e-3:
                    continue
                weight = sight_weight(wx / speed, wy / speed, sign * ex, sign * ey, parameters.social_rear_weight)
                size = sign * manners.social * speed * weight * walkers.trusted[one]
                forces[one, 0] += size * fx
                forces[one, 1] += size * fy


@inner
def _move_on(walkers: Walkers, k: int, ground: Ground, manners: Manners, dt: float) -> None:
    """Move a person for a step, out of walls."""
    x, y = walkers.places[k, 0], walkers.places[k, 1]
    vx, vy = walkers.velocities[k, 0], walkers.velocities[k, 1]
    wx, wy = walkers.wishes[k, 0], walkers.wishes[k, 1]
    speed = max(hypot(wx, wy), 1e-9)
    gap, gx, gy = clearance_and_gradient(ground, x, y)
    push = walkers.trusted[k] * manners.walls * speed * wall_force(gap - walkers.radii[k], manners.parameters)
    vx += dt * (walkers.forces[k, 0] + push * gx + (wx - vx) / manners.relaxation)
    vy += dt * (walkers.forces[k, 1] + push * gy + (wy - vy) / manners.relaxation)
    fast = hypot(vx, vy)
    if fast > speed:
        vx, vy = vx * speed / fast, vy * speed / fast
    nx, ny = x + dt * vx, y + dt * vy
    room, gx, gy = clearance_and_gradient(ground, nx, ny)
    missing = walkers.radii[k] - room
    if missing > 0.0 and room < gap:
        nx, ny = nx + missing * gx, ny + missing * gy
        vx, vy = (nx - x) / dt, (ny - y) / dt
    walkers.places[k, 0], walkers.places[k, 1] = nx, ny
    walkers.velocities[k, 0], walkers.velocities[k, 1] = vx, vy


@inner
def _keep_apart(walkers: Walkers) -> None:
    """Move bodies apart that overlap, each by half as much as far as both are to be trusted."""
    for i in range(len(walkers.radii)):
        for j in range(i + 1, len(walkers.radii)):
            depth, ux, uy = body_overlap(walkers.places, walkers.radii, i, j)
            depth *= min(walkers.trusted[i], walkers.trusted[j])
            if depth > 0.0:
                walkers.places[i, 0] -= 0.5 * depth * ux
                walkers.places[i, 1] -= 0.5 * depth * uy
                walkers.places[j, 0] += 0.5 * depth * ux
                walkers.places[j, 1] += 0.5 * depth * uy


@borrowing
def infer_wishes(walkers: Walkers, accelerations: Floats, ground: Ground, manners: Manners, wishes: Floats) -> None:
    """Write to ``wishes`` (K, 2) with which velocities people would walk who are pushed as these are and change theirs
    by ``accelerations`` (K, 2).

    Headings and speeds that count in the forces are those of the walkers' own wishes.
    """
    _sum_forces(walkers, manners)
    for k in range(len(walkers.radii)):
        gap, gx, gy = clearance_and_gradient(ground, walkers.places[k, 0], walkers.places[k, 1])
        speed = hypot(walkers.wishes[k, 0], walkers.wishes[k, 1])
        push = walkers.trusted[k] * manners.walls * speed * wall_force(gap - walkers.radii[k], manners.parameters)
        fx, fy = walkers.forces[k, 0] + push * gx, walkers.forces[k, 1] + push * gy
        wishes[k, 0] = walkers.velocities[k, 0] + manners.relaxation * (walkers.trusted[k] * accelerations[k, 0] - fx)
        wishes[k, 1] = walkers.velocities[k, 1] + manners.relaxation * (walkers.trusted[k] * accelerations[k, 1] - fy)
