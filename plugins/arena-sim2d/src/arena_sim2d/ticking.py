"""The compiled loop over worlds and ticks."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.footprint import place
from arena_sim2d.bodies import Floats, Moving
from arena_sim2d.contact import release_contacts
from arena_sim2d.crossing import move_people, move_robot
from arena_sim2d.gaps import gap_to_people, gap_to_things
from arena_sim2d.odometry import Odometers, WheelNoise, measure_motion
from arena_sim2d.scanning import Scanner, Scans, scan


@borrowing
def run_ticks(
    world: Moving,
    wheels: WheelNoise,
    odometers: Odometers,
    device: Scanner,
    scans: Scans,
    commands: Floats,
    ticks: int,
    scan_within: int,
    dt: float,
) -> None:
    """Step N worlds by ``ticks`` ticks of ``dt`` s; of the scans due within ``scan_within`` ticks only the newest is taken."""
    for k in range(len(commands)):
        now = world.robots.ticks[k]
        scan_tick = now + scan_within - (now + scan_within) % device.period
        for tick in range(now + 1, now + ticks + 1):
            move_people(world, k, tick, dt)
            move_robot(world, k, tick, commands[k], dt)
            world.touch.ticks[k] += release_contacts(world, k)
            if tick % wheels.period == 0:
                measure_motion(world.chassis, wheels, world.robots, odometers, k, tick, dt)
            if tick == scan_tick:
                scan(world, device, scans, k, tick)
        world.robots.ticks[k] += ticks


@borrowing
def scan_slots(world: Moving, device: Scanner, scans: Scans, slots: NDArray[np.int64]) -> None:
    """Take the scans of the robots in these slots, at their present ticks."""
    for k in slots:
        scan(world, device, scans, k, world.robots.ticks[k])


@borrowing
def measure_clearances(world: Moving, clearances: Floats, to_people: Floats) -> None:
    """Fill the clearances (N,) to anything and to people, m, 0 when touching."""
    for k in range(len(clearances)):
        pose = world.robots.poses[k]
        place(world.body, pose[0], pose[1], pose[2])
        person = gap_to_people(world.people, k, world.body, math.inf)
        thing = gap_to_things(world.scene, k, world.body, math.inf)[0]
        to_people[k] = max(person, 0.0)
        clearances[k] = max(min(thing, person), 0.0)
