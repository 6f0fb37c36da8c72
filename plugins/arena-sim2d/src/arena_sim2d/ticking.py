"""The compiled loops over worlds and ticks."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.footprint import place_body
from arena_kernels.motion import Chassis
from arena_kernels.walls import gap_to_walls, walls_of
from arena_sim2d.bodies import ROBOTS, Floats, World, Worlds
from arena_sim2d.broad_phase import mark_isolated, mark_isolated_team
from arena_sim2d.clearances import gap_to_obstacles, gap_to_people, gap_to_team
from arena_sim2d.contact import member_world, release_contacts
from arena_sim2d.motion_step import move_people, move_robot
from arena_sim2d.odometry import Wheels, measure_motion
from arena_sim2d.scanning import Scanner, take_scan


@borrowing
def run_ticks(
    worlds: Worlds,
    chassis: Chassis,
    wheels: Wheels,
    device: Scanner,
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
    for first in range(0, len(commands), worlds.team):
        world = world_of(worlds, first)
        begun = worlds.robots[first].tick
        scan_tick = begun + scan_within - (begun + scan_within) % device.period
        if worlds.team == 1:
            worlds.robots[first].alone = mark_isolated(world, chassis, ticks, dt)
        else:
            mark_isolated_team(world, chassis, ticks, dt)
        for tick in range(begun + 1, begun + ticks + 1):
            move_people(world, tick, dt)
            for k in range(first, first + worlds.team):
                own, robot = member_world(world, k), worlds.robots[k]
                if robot.absent:
                    robot.tick = tick
                    continue
                move_robot(own, chassis, tick, commands[k], dt, robot.alone == 1)
                robot.contact_ticks += release_contacts(own)
                if tick % wheels.period == 0:
                    measure_motion(wheels, robot, tick, dt)
                if tick == scan_tick:
                    take_scan(worlds, device, k, tick, ranges[k])
                robot.tick = tick


@borrowing
def scan_slots(worlds: Worlds, device: Scanner, ranges: NDArray[np.float32], slots: NDArray[np.int64]) -> None:
    """Take the scans of the robots in these slots, at their present ticks."""
    for i in range(len(slots)):
        take_scan(worlds, device, slots[i], worlds.robots[slots[i]].tick, ranges[slots[i]])


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
    n = k // worlds.team
    first = n * worlds.team
    return World(
        walls_of(worlds.stack, worlds.grid_of[n]),
        worlds.obstacles[n],
        worlds.sides[n],
        worlds.robots,
        k,
        worlds.people[n],
        worlds.touching[k],
        worlds.contacts[k],
        worlds.first_person,
        worlds.first_robot,
        worlds.team,
        first,
        worlds.touching[first : first + worlds.team],
        worlds.contacts[first : first + worlds.team],
        worlds.body,
        worlds.person,
        worlds.mate,
    )
