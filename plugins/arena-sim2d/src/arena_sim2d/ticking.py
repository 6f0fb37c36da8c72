"""The compiled loops over worlds and ticks."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.footprint import place_body
from arena_kernels.walls import gap_to_walls, walls_of
from arena_sim2d.bodies import ROBOTS, Floats, World, Worlds, team_of
from arena_sim2d.broad_phase import mark_isolated, mark_isolated_team
from arena_sim2d.clearances import gap_to_obstacles, gap_to_people, gap_to_team
from arena_sim2d.contact import member_world, release_contacts
from arena_sim2d.doors import move_doors
from arena_sim2d.kinds import Kind
from arena_sim2d.motion_step import move_people, move_robot
from arena_sim2d.odometry import measure_motion
from arena_sim2d.scanning import take_scan


@borrowing
def run_ticks(
    worlds: Worlds,
    kinds: tuple[Kind, ...],
    ranges: NDArray[np.float32],
    commands: Floats,
    ticks: int,
    scan_within: int,
    dt: float,
) -> None:
    """Step N worlds by ``ticks`` ticks of ``dt`` s; of the scans due within ``scan_within``
    ticks only the newest is taken.

    In a tick people move first, then the robots of a team one after another.
    """
    team = team_of(worlds)
    if team > 1:
        run = Run(kinds, ranges, commands, ticks, scan_within, dt)
        for first in range(0, len(commands), team):
            _run_team(worlds, first, run)
        return
    for k in range(len(commands)):
        world = world_of(worlds, k)
        robot = world.robots[world.k]
        chassis, wheels, device = kinds[robot.kind]
        scan_tick = robot.tick + scan_within - (robot.tick + scan_within) % device.period
        free = mark_isolated(world, chassis, ticks, dt)
        for _ in range(ticks):
            tick = robot.tick + 1
            if robot.doors > 0:
                move_doors(world, tick * dt)
            move_people(world, tick, dt)
            if robot.absent:
                robot.tick = tick
                continue
            move_robot(world, chassis, tick, commands[k], dt, free)
            robot.contact_ticks += release_contacts(world)
            if tick % wheels.period == 0:
                measure_motion(wheels, robot, tick, dt)
            if tick == scan_tick:
                take_scan(worlds, device, k, tick, ranges[k])
            robot.tick = tick


class Run(NamedTuple):
    """The arguments of ``run_ticks``."""

    kinds: tuple[Kind, ...]
    ranges: NDArray[np.float32]
    commands: Floats
    ticks: int
    scan_within: int
    dt: float


@inner
def _run_team(worlds: Worlds, first: int, run: Run) -> None:
    """Step the world whose team stands from row ``first`` on."""
    world, begun = world_of(worlds, first), worlds.robots[first].tick
    end = begun + run.scan_within
    mark_isolated_team(world, run.kinds, run.ticks, run.dt)
    for tick in range(begun + 1, begun + run.ticks + 1):
        if worlds.robots[first].doors > 0:
            move_doors(world, tick * run.dt)
        move_people(world, tick, run.dt)
        for k in range(first, first + world.team):
            own, robot = member_world(world, k), worlds.robots[k]
            if not robot.absent:
                chassis, wheels, device = run.kinds[robot.kind]
                move_robot(own, chassis, tick, run.commands[k], run.dt, robot.alone == 1)
                robot.contact_ticks += release_contacts(own)
                if tick % wheels.period == 0:
                    measure_motion(wheels, robot, tick, run.dt)
                if tick == end - end % device.period:
                    take_scan(worlds, device, k, tick, run.ranges[k])
            robot.tick = tick


@borrowing
def set_doors(worlds: Worlds, slots: NDArray[np.int64]) -> None:
    """Open and close the doors of the worlds in these slots as they are at the beginning."""
    for k in slots:
        move_doors(world_of(worlds, k * team_of(worlds)), 0.0)


@borrowing
def scan_slots(worlds: Worlds, kinds: tuple[Kind, ...], ranges: NDArray[np.float32], slots: NDArray[np.int64]) -> None:
    """Take the scans of the robots in these slots, at their present ticks."""
    for i in range(len(slots)):
        robot = worlds.robots[slots[i]]
        take_scan(worlds, kinds[robot.kind].device, slots[i], robot.tick, ranges[slots[i]])


@borrowing
def measure_gaps(worlds: Worlds, slots: NDArray[np.int64], gaps: Floats) -> None:
    """Fill ``gaps`` (R, 4) between the robots in these rows and walls, obstacles, people and other robots, m; negative
    in overlaps, inf without any, or without a robot.
    """
    for k in slots:
        world, robot = world_of(worlds, k), worlds.robots[k]
        if robot.absent:
            gaps[k] = math.inf
            continue
        place_body(world.body, robot.x, robot.y, robot.theta)
        gaps[k, 0] = gap_to_walls(world.walls, world.body, math.inf)[0]
        gaps[k, 1] = gap_to_obstacles(world, world.body, math.inf, ROBOTS)[0]
        gaps[k, 2] = gap_to_people(world, world.body, math.inf)
        gaps[k, 3] = gap_to_team(world, world.body, math.inf)


@inner
def world_of(worlds: Worlds, k: int) -> World:
    """Return the world of the robot in row k."""
    team = team_of(worlds)
    n = k // team
    first = n * team
    return World(
        walls_of(worlds.stack, worlds.grid_of[n]),
        worlds.obstacles[n],
        worlds.sides[n],
        worlds.doors[n],
        worlds.openings[n],
        worlds.robots,
        k,
        worlds.people[n],
        worlds.touching[k],
        worlds.contacts[k],
        worlds.first_person,
        worlds.first_person + worlds.people.shape[1],
        team,
        first,
        worlds.touching[first : first + team],
        worlds.contacts[first : first + team],
        worlds.bodies[worlds.robots[k].kind],
        worlds.bodies,
        worlds.person,
        worlds.outline,
    )
