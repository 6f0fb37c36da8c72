"""A tick around the physics: before it people step and the robot's motors get their set points,
after it is read where the robot is.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Robot
from arena_kernels.compiled import borrowing, inner
from arena_kernels.footprint import place_body
from arena_kernels.motion import (
    ACKERMANN,
    OMNIDIRECTIONAL,
    Chassis,
    Position,
    Velocity,
    drive_arc,
    in_map,
    next_velocity,
    wrap_angle,
)
from arena_mujoco.body import STEERED, Body
from arena_mujoco.body_attachment import driven_wheels
from arena_mujoco.model import AWAY, planar_inertia, rim_angle
from arena_mujoco.robot_file import RobotFile
from arena_sim2d.bodies import Floats, Row, World, Worlds
from arena_sim2d.clearances import gap_to_people, gap_to_team, gap_to_things, is_clear
from arena_sim2d.contact import note_overlaps, release_contacts
from arena_sim2d.doors import move_doors
from arena_sim2d.motion_step import move_people
from arena_sim2d.odometry import Wheels, measure_motion
from arena_sim2d.scanning import Scanner, add_scan_noise, take_scan
from arena_sim2d.ticking import world_of
from arena_sim2d.walking import legs_now

RUNS, UNSTABLE, TIPPED = 0, 1, 2  # how it is with a world
FASTEST = 100.0  # m/s and rad/s; what moves faster has exploded
SPARE = 0.01  # m; what is farther off than this beyond the way of a tick is not touched in it
Ints = NDArray[np.int64]


class Gears(NamedTuple):
    """How a base is driven: on wheels or not, and of each of A actuators where its wheel is, in ``base_link``.

    ``gears`` (A, 3) give each set point for a velocity (vx, vy, wz): rad/s of driven wheels, m/s of omniwheels' rims,
    nothing of steered ones. ``measures`` (3, A) give the velocity for the wheels' speeds. ``speeds`` (A,) and
    ``angles`` (A,) are where in qvel and qpos wheels and steered ones stand, -1 where they do not. ``limits`` (A,) N
    are the forces at which motors stall before tyres slip, else inf. ``least_up`` is the cosine of the greatest lean;
    ``mass`` kg and ``inertia`` kg m2 are those of the base.
    """

    wheeled: bool
    gears: Floats
    measures: Floats
    places: Floats
    steered: NDArray[np.bool_]
    speeds: Ints
    angles: Ints
    limits: Floats
    least_up: float
    mass: float
    inertia: float


class PhysicsArrays(NamedTuple):
    """The arrays of one world's physics, and what is remembered of its robot: ``velocity`` (3,) is the set point, in
    ``base_link``.

    ``integrated`` (3,) is the pose in ``odom`` by the wheels, ``since`` (3,) what they turned since the last odometry.
    ``state`` (1,) tells how it is with the world, ``near`` (1,) whether something may be touched in this tick.
    """

    qpos: Floats
    qvel: Floats
    ctrl: Floats
    force: Floats
    mocap: Floats
    velocity: Floats
    integrated: Floats
    since: Floats
    kept: Floats
    state: Ints
    near: Ints


def planar_gears(robot: Robot, body: Body) -> Gears:
    """Return the gears of a base that slides."""
    none = np.zeros(0, np.int64)
    return Gears(
        False,
        np.zeros((0, 3)),
        np.zeros((3, 0)),
        np.zeros((0, 2)),
        none > 0,
        none,
        none,
        np.zeros(0),
        -1.0,
        body.mass,
        planar_inertia(robot, body),
    )


def wheel_gears(robot: Robot, body: Body, floor_friction: float, tip_angle: float) -> Gears:
    """Return the gears of a base on wheels; joints follow the free one in the order of the wheels, a
    steered one's own before it turns.
    """
    places = np.array(body.wheels.places)
    total, radius = len(places), body.wheels.radius
    steered = (places[:, 0] > STEERED) & (robot.kinematics == "ackermann")
    gears, limits = np.zeros((total, 3)), np.full(total, np.inf)
    speeds, angles, joint = np.full(total, -1), np.full(total, -1), 0
    for k, (x, y) in enumerate(places.tolist()):
        if robot.kinematics == "omnidirectional":
            c, s = math.cos(rim_angle(x, y)), math.sin(rim_angle(x, y))
            gears[k] = c, s, x * s - y * c
            stall = body.wheels.torque / radius
            limits[k] = stall if stall < floor_friction * body.mass * 9.81 / total else np.inf
            continue
        if steered[k]:
            angles[k], joint = 7 + joint, joint + 1
        else:
            gears[k] = 1.0 / radius, 0.0, -y * body.track_factor / radius
        speeds[k], joint = 6 + joint, joint + 1
    driven = ~steered
    measures = np.zeros((3, total))
    measures[:, driven] = np.linalg.pinv(gears[driven])
    up = math.cos(tip_angle)
    return Gears(True, gears, measures, places, steered, speeds, angles, limits, up, body.mass, body.inertia[2])


def file_gears(robot: Robot, body: Body, floor_friction: float, tip_angle: float) -> Gears:
    """Return the gears of a file's body: driven wheels, then what steers; joints stand where the file has them."""
    own: RobotFile = body.own  # type: ignore[assignment]  # asked for only where there is one
    where = {wheel.joint: speed for wheel, speed in zip(own.wheels, own.speeds, strict=True)}
    wheels = driven_wheels(own, robot)
    places = np.array([wheel.place for wheel in (*wheels, *own.steering)])
    turned = [
        (wheel.turns / wheel.radius, 0.0, -wheel.turns * wheel.place[1] * body.track_factor / wheel.radius)
        for wheel in wheels
    ]
    gears = np.array([*turned, *((0.0, 0.0, 0.0) for _ in own.steering)])
    steered = np.array([False] * len(wheels) + [True] * len(own.steering))
    speeds = np.array([*(where[wheel.joint] for wheel in wheels), *(-1 for _ in own.steering)])
    angles = np.array([*(-1 for _ in wheels), *own.angles])
    measures = np.zeros((3, len(gears)))
    measures[:, ~steered] = np.linalg.pinv(gears[~steered])
    limits = np.full(len(gears), np.inf)
    return Gears(
        True, gears, measures, places, steered, speeds, angles, limits, math.cos(tip_angle), body.mass, body.inertia[2]
    )


class Base(NamedTuple):
    """The robot's base: its limits of motion, and how it is driven."""

    chassis: Chassis
    gears: Gears


class TickRules(NamedTuple):
    """How a tick of ``dt`` s is stepped through: in ``coarse`` steps, or as many as go no farther than ``way`` m each.

    With ``legs`` people's legs are placed as well.
    """

    legs: bool
    dt: float
    coarse: int
    way: float


class Sensing(NamedTuple):
    """What a robot measures with, and where a scan is written, at ``scan_tick``; ``dt`` s is the length of a tick."""

    wheels: Wheels
    device: Scanner
    ranges: NDArray[np.float32]
    scan_tick: int
    dt: float


@borrowing
def before_tick(worlds: Worlds, k: int, base: Base, motion: PhysicsArrays, command: Floats, rules: TickRules) -> int:
    """Move doors and people, set the motors, and return in how many steps the physics is to go through a tick.

    Of a team the first robot comes first, with which doors and people move. The steps are the coarse ones of the rules,
    and more where the robot may touch something.
    """
    world = world_of(worlds, k)
    robot = world.robots[world.k]
    if k == world.first:  # once for a team
        move_doors(world, (robot.tick + 1) * rules.dt)
        move_people(world, robot.tick + 1, rules.dt)
        _place_people(worlds, world, motion, rules)
        _place_doors(world, motion, rules)
    motion.near[0] = 0
    if robot.absent or motion.state[0] != RUNS:
        return 0
    for i in range(len(motion.qpos)):
        motion.kept[i] = motion.qpos[i]
    _set_motors(base, motion, robot, command, rules.dt)
    speed = max(
        _point_speed(robot.vx, robot.vy, robot.wz, world.body.radius),
        _point_speed(*_set_point(motion), world.body.radius),
    )
    closing = _approach_distance(world, robot, speed, rules.dt)
    if closing < 0.0:
        return rules.coarse
    motion.near[0] = 1
    return max(rules.coarse, math.ceil(closing / rules.way))


@inner
def _set_point(motion: PhysicsArrays) -> Velocity:
    return motion.velocity[0], motion.velocity[1], motion.velocity[2]


@inner
def _point_speed(vx: float, vy: float, wz: float, radius: float) -> float:
    """Return how fast the fastest point of a body may be, m/s."""
    return math.sqrt(vx * vx + vy * vy) + abs(wz) * radius


@inner
def _approach_distance(world: World, robot: Row, speed: float, dt: float) -> float:
    """Return how far the robot may go towards what it may touch in this tick, m; -1 where it touches nothing."""
    reach = speed * dt + SPARE
    place_body(world.body, robot.x, robot.y, robot.theta)
    theirs = _fastest_mate(world)
    if gap_to_team(world, world.body, reach + theirs * dt) < reach + theirs * dt:
        return (speed + theirs) * dt
    things = (
        not is_clear(world, robot.x, robot.y, world.body.radius + reach)
        and gap_to_things(world, world.body, reach)[0] < reach
    )
    people = gap_to_people(world, world.body, reach) < reach
    return speed * dt if things or people else -1.0


@inner
def _fastest_mate(world: World) -> float:
    """Return how fast the fastest point of the robot's teammates is, m/s."""
    fastest = 0.0
    for row in range(world.first, world.first + world.team):
        mate = world.robots[row]
        if row != world.k and not mate.absent:
            fastest = max(fastest, _point_speed(mate.vx, mate.vy, mate.wz, world.bodies[mate.kind].radius))
    return fastest


@borrowing
def show_people(worlds: Worlds, k: int, motion: PhysicsArrays, rules: TickRules) -> None:
    """Put the people and doors of world k where they are, as before its first tick."""
    world = world_of(worlds, k)
    _place_people(worlds, world, motion, rules)
    _place_doors(world, motion, rules)


@inner
def _place_people(worlds: Worlds, world: World, motion: PhysicsArrays, rules: TickRules) -> None:
    """Put people's bodies, and their legs, where they are; who is not in the world is far away."""
    each = 3 if rules.legs else 1
    for i in range(world.robots[world.k].people):
        person, row = world.people[i], each * i
        absent = math.isnan(person.x)
        for part in range(each):
            motion.mocap[row + part, 0], motion.mocap[row + part, 1] = (
                (AWAY, AWAY - i) if absent else (person.x, person.y)
            )
        if rules.legs and not absent and person.walks == 1:
            left_x, left_y, right_x, right_y, _ = legs_now(worlds.gait, person)
            motion.mocap[row + 1, 0], motion.mocap[row + 1, 1] = left_x, left_y
            motion.mocap[row + 2, 0], motion.mocap[row + 2, 1] = right_x, right_y


@inner
def _place_doors(world: World, motion: PhysicsArrays, rules: TickRules) -> None:
    """Stand closed doors up, and put open ones below the floor."""
    first = (3 if rules.legs else 1) * world.robots[world.k].people
    for d in range(world.robots[world.k].doors):
        motion.mocap[first + d, 2] = AWAY if world.doors[d].open == 1 else 0.0


@inner
def _set_motors(base: Base, motion: PhysicsArrays, robot: Row, command: Floats, dt: float) -> None:
    """Give the motors their set points for a tick: the command, within the robot's limits of speed and acceleration.

    A planar base goes on from its own velocity, so that one that was stopped speeds up again, by the force that brings
    it to the set point within the tick. Wheels go on from their set points.
    """
    before = _set_point(motion) if base.gears.wheeled else (robot.vx, robot.vy, robot.wz)
    wanted = next_velocity(base.chassis, robot.speed_share, before, command, dt)
    motion.velocity[0], motion.velocity[1], motion.velocity[2] = wanted
    if not base.gears.wheeled:
        vx, vy, wz = in_map(robot.theta + 0.5 * (robot.wz + wanted[2]) * dt, wanted)
        motion.ctrl[0] = base.gears.mass * (vx - motion.qvel[0]) / dt
        motion.ctrl[1] = base.gears.mass * (vy - motion.qvel[1]) / dt
        motion.ctrl[2] = base.gears.inertia * (wz - motion.qvel[2]) / dt
        return
    for a in range(len(motion.ctrl)):
        if base.gears.steered[a]:
            motion.ctrl[a] = _steering_angle(base.chassis, base.gears, a, motion.ctrl[a], command)
        else:
            motion.ctrl[a] = (
                base.gears.gears[a, 0] * wanted[0]
                + base.gears.gears[a, 1] * wanted[1]
                + base.gears.gears[a, 2] * wanted[2]
            )


@inner
def _steering_angle(chassis: Chassis, gears: Gears, a: int, angle: float, command: Floats) -> float:
    """Return the angle of a steered wheel on the commanded arc, rad; a car that is to stand
    keeps its wheels as they are.
    """
    if command[0] == 0.0:
        return angle
    curvature = min(max(command[2] / command[0], -chassis.curvature_max), chassis.curvature_max)
    return math.atan(curvature * gears.places[a, 0] / (1.0 - curvature * gears.places[a, 1]))


@borrowing
def after_tick(worlds: Worlds, k: int, base: Base, motion: PhysicsArrays, sensing: Sensing) -> None:
    """Read where the physics has brought the robot, note contacts, and measure what is due."""
    world = world_of(worlds, k)
    robot = world.robots[world.k]
    tick = robot.tick + 1
    if robot.absent:
        robot.tick = tick
        return
    before = (robot.vx, robot.vy, robot.wz)
    _take_in_physics(base.gears, motion, robot)
    if motion.near[0] == 1:
        place_body(world.body, robot.x, robot.y, robot.theta)
        led = _set_point(motion) if not base.gears.wheeled else before
        note_overlaps(world, tick, in_map(robot.theta, led))
    robot.contact_ticks += release_contacts(world)
    _measure(worlds, k, base, motion, sensing)


@borrowing
def read_mate(worlds: Worlds, k: int, base: Base, motion: PhysicsArrays) -> None:
    """Read where the physics has brought a robot of a team, the velocity being that which led there: contacts are noted
    once all of its team have been read.
    """
    robot = worlds.robots[k]
    if robot.absent:
        return
    led = _set_point(motion) if not base.gears.wheeled else (robot.vx, robot.vy, robot.wz)
    _take_in_physics(base.gears, motion, robot)
    if motion.state[0] == RUNS:
        robot.vx, robot.vy, robot.wz = led


@borrowing
def note_mate(worlds: Worlds, k: int, motion: PhysicsArrays) -> None:
    """Note what a robot of a team that was read touches, teammates among it."""
    world = world_of(worlds, k)
    robot = world.robots[world.k]
    if motion.near[0] == 1 and not robot.absent:
        place_body(world.body, robot.x, robot.y, robot.theta)
        note_overlaps(world, robot.tick + 1, in_map(robot.theta, (robot.vx, robot.vy, robot.wz)))


@borrowing
def after_mate(worlds: Worlds, k: int, base: Base, motion: PhysicsArrays, sensing: Sensing) -> None:
    """End a tick of a robot of a team as ``after_tick`` does, once the contacts of all were noted."""
    world = world_of(worlds, k)
    robot = world.robots[world.k]
    if robot.absent:
        robot.tick += 1
        return
    if motion.state[0] == RUNS:
        _read_motion(base.gears, motion, robot)
    robot.contact_ticks += release_contacts(world)
    _measure(worlds, k, base, motion, sensing)


@inner
def _take_in_physics(gears: Gears, motion: PhysicsArrays, robot: Row) -> None:
    """Read where a robot is after a tick; one whose physics cannot go on is put back to where it was, and stands."""
    if motion.state[0] == RUNS:
        motion.state[0] = _check_state(gears, motion)
    if motion.state[0] == RUNS:
        _read_motion(gears, motion, robot)
        return
    for i in range(len(motion.qpos)):
        motion.qpos[i] = motion.kept[i]
    motion.qvel[:] = 0.0
    robot.vx, robot.vy, robot.wz = 0.0, 0.0, 0.0


@inner
def _measure(worlds: Worlds, k: int, base: Base, motion: PhysicsArrays, sensing: Sensing) -> None:
    """Measure what is due at the end of a tick."""
    robot, wheels = worlds.robots[k], sensing.wheels
    tick, dt = robot.tick + 1, sensing.dt
    if base.gears.wheeled:
        _integrate_wheels(base.chassis, base.gears, motion, robot, dt)
        if tick % wheels.period == 0:
            _write_odometry(motion, robot, tick, dt)
    elif tick % wheels.period == 0:
        measure_motion(wheels, robot, tick, dt)
    if tick == sensing.scan_tick:
        take_scan(worlds, sensing.device, k, tick, sensing.ranges)
    robot.tick = tick


@inner
def _check_state(gears: Gears, motion: PhysicsArrays) -> int:
    """Tell how it is with a world after a tick."""
    for i in range(len(motion.qpos)):
        if not math.isfinite(motion.qpos[i]):
            return UNSTABLE
    for i in range(3 if not gears.wheeled else 6):
        if not abs(motion.qvel[i]) < FASTEST:
            return UNSTABLE
    if gears.wheeled and 1.0 - 2.0 * (motion.qpos[4] ** 2 + motion.qpos[5] ** 2) < gears.least_up:
        return TIPPED
    return RUNS


@inner
def _read_motion(gears: Gears, motion: PhysicsArrays, robot: Row) -> None:
    """Read pose and velocity of the robot in the plane."""
    q, v = motion.qpos, motion.qvel
    robot.x, robot.y = q[0], q[1]
    if gears.wheeled:
        robot.theta = math.atan2(2.0 * (q[3] * q[6] + q[4] * q[5]), 1.0 - 2.0 * (q[5] * q[5] + q[6] * q[6]))
        robot.wz = v[5]
    else:
        robot.theta = wrap_angle(q[2])
        robot.wz = v[2]
    c, s = math.cos(robot.theta), math.sin(robot.theta)
    robot.vx, robot.vy = c * v[0] + s * v[1], c * v[1] - s * v[0]


@inner
def _integrate_wheels(chassis: Chassis, gears: Gears, motion: PhysicsArrays, robot: Row, dt: float) -> None:
    """Integrate what the wheels have turned in a tick, as if none had slipped."""
    vx, vy, wz, steer = 0.0, 0.0, 0.0, 0.0
    for a in range(len(motion.ctrl)):
        if gears.steered[a]:
            steer += math.tan(motion.qpos[gears.angles[a]]) / (
                gears.places[a, 0] + gears.places[a, 1] * math.tan(motion.qpos[gears.angles[a]])
            )
            continue
        if chassis.kinematics == OMNIDIRECTIONAL:
            speed = motion.ctrl[a]
            if abs(motion.force[a]) >= gears.limits[a]:
                speed = gears.gears[a, 0] * robot.vx + gears.gears[a, 1] * robot.vy + gears.gears[a, 2] * robot.wz
        else:
            speed = motion.qvel[gears.speeds[a]]
        vx += gears.measures[0, a] * speed
        vy += gears.measures[1, a] * speed
        wz += gears.measures[2, a] * speed
    if chassis.kinematics == ACKERMANN:
        wz = vx * steer / max(gears.steered.sum(), 1)
    pose: Position = (motion.integrated[0], motion.integrated[1], motion.integrated[2])
    motion.integrated[0], motion.integrated[1], motion.integrated[2] = drive_arc(pose, (vx, vy, wz), dt)
    motion.since[0] += vx * dt
    motion.since[1] += vy * dt
    motion.since[2] += wz * dt


@inner
def _write_odometry(motion: PhysicsArrays, robot: Row, tick: int, dt: float) -> None:
    """Let odometry say what the wheels have turned; the twist is the mean over its period."""
    seconds = (tick - robot.odometry_tick) * dt
    robot.odometry_x, robot.odometry_y, robot.odometry_theta = (
        motion.integrated[0],
        motion.integrated[1],
        motion.integrated[2],
    )
    robot.odometry_vx, robot.odometry_vy, robot.odometry_wz = (
        motion.since[0] / seconds,
        motion.since[1] / seconds,
        motion.since[2] / seconds,
    )
    motion.since[:] = 0.0
    robot.odometry_tick = tick


@borrowing
def disturb_scan(worlds: Worlds, k: int, device: Scanner, tick: int, ranges: NDArray[np.float32]) -> None:
    """Add the noise of the lidar to a scan that was taken elsewhere."""
    robot = worlds.robots[k]
    add_scan_noise(device, robot, tick, ranges)
    robot.scan_tick = tick
