"""One world as a MuJoCo model: what stands, the robot and the people, written as MJCF."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from arena_core import ArenaError, Gait, Robot, Scenario
from arena_core.scenes import Prism, Scene, scene_of
from arena_mujoco.body import STEERED, Body
from arena_mujoco.triangles import convex_parts

if TYPE_CHECKING:
    import mujoco

Drive = Literal["planar", "wheels"]
Element = ElementTree.Element
# contype and conaffinity: what moves touches what stands, nothing else touches
STANDS, MOVES, NOTHING = ("2", "1"), ("1", "2"), ("0", "0")
TOGETHER = ("9", "10")  # a robot of a team touches what stands, and its teammates
ON_FLOOR = {"contype": "4", "conaffinity": "4", "solref": "0.02 1"}  # of the floor and of what stands on it
UNSEEN, SEEN = "3", "0"  # groups of geoms: only the second is drawn and met by rays of the lidar
# the group of what depth cameras see and lidars do not: the floor beneath a sliding base, what of people is above their
# legs
FILMED = "4"
PUSH = 1.5  # a planar base is pushed by so many times the force that its acceleration takes, at the most
GRIP = 20.0  # 1/s; wheels' motors and omniwheels take up a speed within a twentieth of a second at the slowest
# a motor that has so many times the torque at which its tyre slips never stalls: it is not limited, which is quicker to
# solve
STRONG = 1.3
# A motor seen through its gear is heavy to turn. MuJoCo needs it to be heavier than the robot: its friction acts on
# what a wheel weighs,
# not on the servo that turns it. With light wheels a Jackal turns on the spot at a fifth of its rate.
ROTOR = 5.0
PERSON_HEIGHT, HIP_HEIGHT = 1.75, 0.85  # m
OVER_BEAMS = 0.05  # m; so much over a lidar its robot is still seen by others of its height
AWAY = -100.0  # m; where people stand who are not in the world, and how high doors are that are open


@dataclass(frozen=True, slots=True)
class Physics:
    """How models are made: step s, height of walls m, friction, how the robot is driven, and
    what is there for lidars and cameras.
    """

    timestep: float
    wall_height: float
    floor_friction: float
    wall_friction: float
    drive: Drive
    legs: bool
    camera: bool


def compile_model(text: str, name: str) -> mujoco.MjModel:
    """Return the compiled model; raise ArenaError with MuJoCo's reason."""
    import mujoco

    try:
        return mujoco.MjModel.from_xml_string(text)
    except ValueError as error:
        raise ArenaError(f"{name}: MuJoCo refuses the model ({' '.join(str(error).split())})") from None


class Machine(NamedTuple):
    """The robot, its body, and the physics that it is driven by."""

    robot: Robot
    body: Body
    physics: Physics


class Names(NamedTuple):
    """What a robot's parts are called, by a ``suffix``, and whether it is one of a team."""

    suffix: str
    in_team: bool


def robot_name(member: int) -> str:
    """Return what the body of a robot is called, by its number in the team."""
    return f"robot{_suffix(member)}"


def _suffix(member: int) -> str:
    return f"_{member}" if member else ""


def model_text(machine: Machine, scenario: Scenario, radii: NDArray[np.float64], gait: Gait | None) -> str:
    """Return the MJCF of one world: the body ``map`` with all that stands, the body ``robot``, those of its teammates
    (``robot_1`` and so on), and a mocap body for each person, then for each door.
    """
    root = ElementTree.Element("mujoco", model="arena")
    ElementTree.SubElement(root, "compiler", angle="radian")
    option = ElementTree.SubElement(
        root, "option", timestep=format_numbers(machine.physics.timestep), integrator="implicitfast"
    )
    if machine.physics.drive == "wheels":
        option.set("cone", "elliptic")  # tyres hold alike in all directions
    # with several contacts for two bodies (multiccd), MuJoCo 4.0 takes the wrong side of a sharp edge: they sink into
    # each other
    ElementTree.SubElement(option, "flag", autoreset="disable", multiccd="disable", sleep="enable")
    default = ElementTree.SubElement(root, "default")
    friction = format_numbers(machine.physics.wall_friction, 0.005, 0.0001)
    ElementTree.SubElement(default, "geom", friction=friction, solref="0.004 2", solimp="0.95 0.99 0.001", priority="0")
    assets = ElementTree.SubElement(root, "asset")
    world = ElementTree.SubElement(root, "worldbody")
    actuators = ElementTree.SubElement(root, "actuator")
    add_scene(
        world,
        assets,
        scene_of(scenario.world.grid, scenario.obstacles, machine.physics.wall_height, scenario.world.furniture),
    )
    if machine.physics.drive == "planar":
        for member in range(scenario.robots):
            names = Names(_suffix(member), scenario.robots > 1)
            _add_planar(world, assets, actuators, machine, names)
        if machine.physics.camera:
            _add_geom(world, NOTHING, "plane", "0 0 1", group=FILMED)
    else:
        _add_floor(world, machine.physics)
        for member in range(scenario.robots):
            names = Names(_suffix(member), scenario.robots > 1)
            _add_wheeled(world, assets, actuators, machine, names)
    for number, radius in enumerate(radii.tolist()):
        add_person(
            world,
            number,
            radius,
            None if gait is None or not machine.physics.legs else gait,
            filmed=machine.physics.camera,
        )
    for number, door in enumerate(scenario.doors):
        add_door(world, assets, number, Prism(door.vertices_xy, 0.0, machine.physics.wall_height), STANDS)
    return ElementTree.tostring(root, "unicode")


def add_scene(world: Element, assets: Element, scene: Scene, name: str = "map", **looks: str) -> None:
    """Add all that stands in a world, as geoms of one body at the map's origin that is called ``name``."""
    place = scene.origin
    body = ElementTree.SubElement(
        world,
        "frame",
        name=name,
        pos=format_numbers(place.x, place.y, 0.0),
        euler=format_numbers(0.0, 0.0, place.theta),
    )
    for x, y, yaw, length, width, bottom, top in scene.boxes.tolist():
        size = format_numbers(0.5 * length, 0.5 * width, 0.5 * (top - bottom))
        turn = {"euler": format_numbers(0.0, 0.0, yaw)} if yaw else {}
        _add_geom(body, STANDS, "box", size, pos=format_numbers(x, y, 0.5 * (bottom + top)), **turn, **looks)
    for x, y, radius, bottom, top in scene.cylinders.tolist():
        size = format_numbers(radius, 0.5 * (top - bottom))
        _add_geom(body, STANDS, "cylinder", size, pos=format_numbers(x, y, 0.5 * (bottom + top)), **looks)
    for number, prism in enumerate(scene.prisms):
        for part, corners in enumerate(convex_parts(prism.vertices_xy)):
            add_prism(body, assets, f"prism_{number}_{part}", STANDS, Prism(corners, prism.bottom, prism.top), **looks)


def add_door(world: Element, assets: Element, number: int, closed: Prism, touches: Sequence[str], **looks: str) -> None:
    """Add a door, upright where it is ``closed``; one that is open is put below the floor."""
    body = ElementTree.SubElement(world, "body", name=f"door_{number}", mocap="true")
    for part, corners in enumerate(convex_parts(closed.vertices_xy)):
        prism = Prism(corners, closed.bottom, closed.top)
        add_prism(body, assets, f"door_{number}_{part}", touches, prism, **looks)


def add_person(world: Element, number: int, radius: float, gait: Gait | None, *, filmed: bool) -> None:
    """Add a person: an upright cylinder that robots touch, and below the hips two legs that
    lidars see, where it walks.
    """
    body = ElementTree.SubElement(
        world, "body", name=f"person_{number}", mocap="true", pos=format_numbers(AWAY, AWAY - number, 0.0)
    )
    half = 0.5 * PERSON_HEIGHT
    group = SEEN if gait is None else UNSEEN
    _add_geom(body, STANDS, "cylinder", format_numbers(radius, half), pos=format_numbers(0.0, 0.0, half), group=group)
    if gait is None:
        return
    if filmed:
        tall = 0.5 * (PERSON_HEIGHT - HIP_HEIGHT)
        _add_geom(
            body,
            NOTHING,
            "cylinder",
            format_numbers(radius, tall),
            pos=format_numbers(0.0, 0.0, PERSON_HEIGHT - tall),
            group=FILMED,
        )
    for side in ("left", "right"):
        leg = ElementTree.SubElement(
            world, "body", name=f"person_{number}_{side}", mocap="true", pos=format_numbers(AWAY, AWAY - number, 0.0)
        )
        size = format_numbers(min(gait.leg_radius, 0.5 * radius), 0.5 * HIP_HEIGHT)
        _add_geom(leg, NOTHING, "cylinder", size, pos=format_numbers(0.0, 0.0, 0.5 * HIP_HEIGHT), group=SEEN)


def _add_planar(world: Element, assets: Element, actuators: Element, machine: Machine, names: Names) -> None:
    """Add a robot that slides along x and y of ``map`` and turns, each by a force that is limited."""
    robot, body = machine.robot, machine.body
    base = ElementTree.SubElement(world, "body", name=f"robot{names.suffix}", sleep="never")
    inertia, limits = planar_inertia(robot, body), robot.limits
    force = PUSH * body.mass * max(limits.ax_max, limits.ay_max, limits.vx_max * limits.wz_max)
    torque = PUSH * inertia * limits.alpha_max
    for way, kind, axis, most in (
        ("x", "slide", "1 0 0", force),
        ("y", "slide", "0 1 0", force),
        ("yaw", "hinge", "0 0 1", torque),
    ):
        name = way + names.suffix
        ElementTree.SubElement(base, "joint", name=name, type=kind, axis=axis)
        ElementTree.SubElement(
            actuators, "motor", name=name, joint=name, ctrllimited="true", ctrlrange=format_numbers(-most, most)
        )
    spread = format_numbers(inertia, inertia, inertia)
    ElementTree.SubElement(
        base,
        "inertial",
        pos=format_numbers(0.0, 0.0, body.centre_height),
        mass=format_numbers(body.mass),
        diaginertia=spread,
    )
    _add_hull(base, assets, machine, names)


def planar_inertia(robot: Robot, body: Body) -> float:
    """Return a planar base's moment of inertia about the vertical, that of a disc, kg m2."""
    return 0.5 * body.mass * robot.footprint.radius**2


def _add_hull(base: Element, assets: Element, machine: Machine, names: Names) -> None:
    """Add what of the robot touches others, its footprint, upright; of one of a team also what lidars of its teammates
    see, its footprint at the height of their beams.
    """
    body, hull = machine.body, {"name": f"hull{names.suffix}", "group": UNSEEN}
    _add_footprint(base, assets, machine, TOGETHER if names.in_team else MOVES, hull)
    if names.in_team:
        tall = replace(body, height=max(body.height, body.lidar_height + OVER_BEAMS))
        outline = {"name": f"outline{names.suffix}", "group": SEEN}
        _add_footprint(base, assets, machine._replace(body=tall), NOTHING, outline)


def _add_footprint(
    base: Element, assets: Element, machine: Machine, touches: Sequence[str], named: Mapping[str, str]
) -> None:
    """Add the footprint as an upright solid without mass, under a name and in a group."""
    footprint, bottom, top = machine.robot.footprint, machine.body.clearance, machine.body.height
    if footprint.is_circle:
        size = format_numbers(footprint.radius, 0.5 * (top - bottom))
        middle = format_numbers(0.0, 0.0, 0.5 * (bottom + top))
        _add_geom(base, touches, "cylinder", size, pos=middle, mass="0", **named)
    else:
        add_prism(base, assets, named["name"], touches, Prism(footprint.vertices_xy, bottom, top), mass="0", **named)


def _floor_grip(physics: Physics) -> str:
    return format_numbers(physics.floor_friction, 0.005, 0.0001)


def _add_floor(world: Element, physics: Physics) -> None:
    """Add the floor that wheels stand on."""
    grip = _floor_grip(physics)
    ElementTree.SubElement(world, "geom", ON_FLOOR, name="floor", type="plane", size="0 0 1", friction=grip, group=SEEN)


def _add_wheeled(world: Element, assets: Element, actuators: Element, machine: Machine, names: Names) -> None:
    """Add a robot that stands on its wheels on the floor, each turned by a motor at
    a velocity, with a limited torque.
    """
    base = ElementTree.SubElement(world, "body", name=f"robot{names.suffix}", sleep="never")
    ElementTree.SubElement(base, "freejoint", name=f"base{names.suffix}")
    centre, spread = (
        format_numbers(*machine.body.centre_xy, machine.body.centre_height),
        format_numbers(*machine.body.inertia),
    )
    if machine.body.own is None:
        ElementTree.SubElement(
            base, "inertial", pos=centre, mass=format_numbers(machine.body.chassis_mass), diaginertia=spread
        )
    _add_hull(base, assets, machine, names)
    if machine.body.own is not None:
        return  # its wheels and its mass come from a file
    if machine.robot.kinematics == "omnidirectional":
        _add_omniwheels(base, actuators, machine.body, machine.physics, names)
    else:
        _add_rolling_wheels(base, actuators, machine, names)
    for x, y in machine.body.casters:
        _add_slider(base, x, y, min(0.3 * machine.body.wheels.radius, 0.01))


def _add_slider(base: Element, x: float, y: float, radius: float) -> None:
    """Add a support that slides without friction: the larger of two frictions would count, so it has priority."""
    free = {"friction": "0 0 0", "condim": "1", "priority": "1"}
    ElementTree.SubElement(
        base,
        "geom",
        ON_FLOOR | free,
        type="sphere",
        size=format_numbers(radius),
        pos=format_numbers(x, y, radius),
        group=UNSEEN,
    )


def _add_omniwheels(base: Element, actuators: Element, body: Body, physics: Physics, names: Names) -> None:
    """Add omniwheels: what carries slides freely, as on rollers; along its rim each pulls with
    what motor and floor can hold.
    """
    wheels = body.wheels
    load = body.mass * 9.81 / len(wheels.places)
    most = min(wheels.torque / wheels.radius, physics.floor_friction * load)
    for number, (x, y) in enumerate(wheels.places):
        name = f"wheel_{number}{names.suffix}"
        ElementTree.SubElement(
            base,
            "site",
            name=name,
            pos=format_numbers(x, y, 0.0),
            euler=format_numbers(0.0, 0.0, rim_angle(x, y)),
        )
        gain = body.mass * GRIP
        reach = {"forcelimited": "true", "forcerange": format_numbers(-most, most), "gear": "1 0 0 0 0 0"}
        ElementTree.SubElement(actuators, "velocity", reach, name=name, site=name, kv=format_numbers(gain))
        _add_slider(base, x, y, wheels.radius)


def _add_rolling_wheels(base: Element, actuators: Element, machine: Machine, names: Names) -> None:
    """Add wheels with tyres, ellipsoids that touch the floor in a point; of a car, those ahead
    are steered and those behind driven.
    """
    wheels, grip = machine.body.wheels, _floor_grip(machine.physics)
    spin = 0.5 * wheels.mass * wheels.radius**2
    load = machine.body.mass * wheels.radius**2 / len(wheels.places)
    # before it stalls
    slips = wheels.torque > STRONG * machine.physics.floor_friction * machine.body.mass * 9.81 * wheels.radius / len(
        wheels.places
    )
    rotor = ROTOR * load if slips else load
    for number, (x, y) in enumerate(wheels.places):
        name = f"wheel_{number}{names.suffix}"
        steered = machine.robot.kinematics == "ackermann" and x > STEERED
        hub = ElementTree.SubElement(base, "body", name=name, pos=format_numbers(x, y, wheels.radius))
        if steered:
            steer = f"steer_{number}{names.suffix}"
            ElementTree.SubElement(hub, "joint", name=steer, type="hinge", axis="0 0 1", damping="0.2", armature="0.02")
            servo = {"kp": "60", "kv": "2", "forcelimited": "true", "forcerange": "-20 20"}
            ElementTree.SubElement(actuators, "position", servo, name=steer, joint=steer)
        turns = {"armature": format_numbers(rotor)} if not steered else {}
        ElementTree.SubElement(hub, "joint", turns, name=name, type="hinge", axis="0 1 0")
        rim = 0.5 * spin + wheels.mass * wheels.width**2 / 12.0
        ElementTree.SubElement(
            hub, "inertial", pos="0 0 0", mass=format_numbers(wheels.mass), diaginertia=format_numbers(rim, spin, rim)
        )
        size = format_numbers(wheels.radius, 0.5 * wheels.width, wheels.radius)
        ElementTree.SubElement(
            hub, "geom", ON_FLOOR, type="ellipsoid", size=size, friction=grip, condim="3", group=UNSEEN
        )
        if not steered:
            reach = (
                {} if slips else {"forcelimited": "true", "forcerange": format_numbers(-wheels.torque, wheels.torque)}
            )
            gain = (spin + load + rotor) * 10.0 * GRIP
            ElementTree.SubElement(actuators, "velocity", reach, name=name, joint=name, kv=format_numbers(gain))


def rim_angle(x: float, y: float) -> float:
    """Return the direction in which an omniwheel pulls: counter-clockwise about base_link, rad."""
    return math.atan2(y, x) + 0.5 * math.pi


def _add_geom(body: Element, touches: Sequence[str], kind: str, size: str, **attributes: str) -> None:
    contype, conaffinity = touches
    ElementTree.SubElement(
        body, "geom", {"type": kind, "size": size, "contype": contype, "conaffinity": conaffinity, **attributes}
    )


def add_prism(
    body: Element, assets: Element, mesh: str, touches: Sequence[str], prism: Prism, **attributes: str
) -> None:
    """Add a convex prism, as the mesh of its corners."""
    corners = np.vstack(
        [np.column_stack((prism.vertices_xy, np.full(len(prism.vertices_xy), z))) for z in (prism.bottom, prism.top)]
    )
    middle = corners.mean(axis=0)
    ElementTree.SubElement(
        assets, "mesh", name=mesh, vertex=format_numbers(*(corners - middle).ravel().tolist()), inertia="convex"
    )
    contype, conaffinity = touches
    # MuJoCo moves a mesh to its centre of mass; a geom's pose then is that of the mesh as it was given
    attributes = {"type": "mesh", "mesh": mesh, "contype": contype, "conaffinity": conaffinity, **attributes}
    ElementTree.SubElement(body, "geom", {"pos": format_numbers(*middle.tolist()), **attributes})


def format_numbers(*values: float) -> str:
    """Return numbers as the text of an attribute."""
    return " ".join(f"{value + 0.0:.12g}" for value in values)
