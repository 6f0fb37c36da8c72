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
from arena_sim2d.broad_phase import mark_isolated
from arena_sim2d.clearances import gap_to_obstacles, gap_to_people
from arena_sim2d.contact import release_contacts
from arena_sim2d.doors import move_doors
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
    """
    for k in range(len(commands)):
        world = world_of(worlds, k)
        robot = world.robots[world.k]
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


@borrowing
def set_doors(worlds: Worlds, slots: NDArray[np.int64]) -> None:
    """Open and close the doors of the worlds in these slots as they are at the beginning."""
    for k in slots:
        move_doors(world_of(worlds, k), 0.0)


@borrowing
def scan_slots(worlds: Worlds, device: Scanner, ranges: NDArray[np.float32], slots: NDArray[np.int64]) -> None:
    """Take the scans of the robots in these slots, at their present ticks."""
    for i in range(len(slots)):
        take_scan(worlds, device, slots[i], worlds.robots[slots[i]].tick, ranges[slots[i]])


@borrowing
def measure_gaps(worlds: Worlds, slots: NDArray[np.int64], gaps: Floats) -> None:
    """Fill ``gaps`` (N, 3) between the robots in these slots and walls, obstacles and people, m; negative
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


@inner
def world_of(worlds: Worlds, k: int) -> World:
    """Return world k."""
    return World(
        walls_of(worlds.stack, worlds.grid_of[k]),
        worlds.obstacles[k],
        worlds.sides[k],
        worlds.doors[k],
        worlds.openings[k],
        worlds.robots,
        k,
        worlds.people[k],
        worlds.touching[k],
        worlds.contacts[k],
        worlds.first_person,
        worlds.body,
        worlds.person,
    )
