"""The compiled loop over worlds and ticks."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from arena_kernels.footprint import place
from arena_sim2d.bodies import Chassis, Floats, People, Robots, Touch
from arena_sim2d.contact import release
from arena_sim2d.crossing import move_people, move_robot
from arena_sim2d.gaps import gap_to_people, gap_to_things
from arena_sim2d.odometry import Odometers, WheelNoise, measure_motion
from arena_sim2d.scanning import Scanner, Scans, scan
from arena_sim2d.scene import Scene


@njit(cache=True)
def run_ticks(
    scene: Scene,
    chassis: Chassis,
    wheels: WheelNoise,
    device: Scanner,
    robots: Robots,
    people: People,
    touch: Touch,
    odometers: Odometers,
    scans: Scans,
    commands: Floats,
    ticks: int,
    scan_within: int,
    dt: float,
) -> None:
    """Step N worlds by ``ticks`` ticks of ``dt`` s; of the scans due within ``scan_within`` ticks only the newest is taken."""
    hull = np.empty((max(len(chassis.vertices), 1), 2))
    for k in range(len(commands)):
        end = robots.ticks[k] + scan_within
        scan_tick = end - end % device.period
        for tick in range(robots.ticks[k] + 1, robots.ticks[k] + ticks + 1):
            place(chassis.vertices, robots.poses[k, 0], robots.poses[k, 1], robots.poses[k, 2], hull)
            move_people(scene, chassis, robots, people, touch, k, tick, dt, hull)
            move_robot(scene, chassis, robots, people, touch, k, tick, commands[k], dt, hull)
            place(chassis.vertices, robots.poses[k, 0], robots.poses[k, 1], robots.poses[k, 2], hull)
            if release(scene, chassis, people, touch, k, hull, robots.poses[k, 0], robots.poses[k, 1]):
                touch.ticks[k] += 1
            if tick % wheels.period == 0:
                measure_motion(chassis, wheels, robots, odometers, k, tick, dt)
            if tick == scan_tick:
                scan(scene, device, robots, people, scans, k, tick)
        robots.ticks[k] += ticks


@njit(cache=True)
def scan_slots(scene: Scene, device: Scanner, robots: Robots, people: People, scans: Scans, slots: NDArray[np.int64]) -> None:
    """Take the scans of the robots in these slots, at their present ticks."""
    for k in slots:
        scan(scene, device, robots, people, scans, k, robots.ticks[k])


@njit(cache=True)
def measure_clearances(scene: Scene, chassis: Chassis, robots: Robots, people: People, clearances: Floats, to_people: Floats) -> None:
    """Fill the clearances (N,) to anything and to people, m, 0 when touching."""
    hull = np.empty((max(len(chassis.vertices), 1), 2))
    for k in range(len(clearances)):
        x, y = robots.poses[k, 0], robots.poses[k, 1]
        place(chassis.vertices, x, y, robots.poses[k, 2], hull)
        person = gap_to_people(people.counts[k], people.positions[k], people.radii[k], hull, chassis.rounding, x, y, chassis.radius)
        thing = gap_to_things(scene, k, hull, chassis.rounding, x, y, chassis.radius, math.inf)[0]
        to_people[k] = max(person, 0.0)
        clearances[k] = max(min(thing, person), 0.0)
