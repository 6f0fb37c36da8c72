"""A recorded world as a MuJoCo model that is only looked at: what stands; robot, people, doors as mocap bodies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, Footprint, Obstacle, OccupancyGrid, Robot
from arena_core.scenes import Prism, furniture_of, furniture_scene, scene_of
from arena_mujoco.body import Body
from arena_mujoco.body_attachment import static_model
from arena_mujoco.model import AWAY, NOTHING, add_door, add_prism, add_scene, compile_model, format_numbers
from arena_mujoco.pictures.appearance import Appearance, Colour
from arena_mujoco.pictures.scene_states import SceneState

if TYPE_CHECKING:
    import mujoco

Element = ElementTree.Element
OWN = "1"  # the group of the robot's geoms, which beams of its lidar do not meet
EACH = 3  # bodies of a person: what is above the hips, the left leg, the right leg


class SceneModel:
    """The model, and the state that shows a moment."""

    def __init__(self, record: EpisodeRecord, grid: OccupancyGrid, robot: Robot, body: Body, looks: Appearance) -> None:
        import mujoco

        text = _scene_xml(record, grid, robot, body, looks)
        own = body.own
        self.model: mujoco.MjModel = (
            compile_model(text, "a picture") if own is None else static_model(text, "a picture", own, int(OWN))
        )
        self.data: mujoco.MjData = mujoco.MjData(self.model)
        self._looks, self._people = looks, len(record["pedestrian_radii"])
        self._torsos = [self.model.geom(f"torso_{number}").id for number in range(self._people)]

    def set_state(self, still: SceneState) -> None:
        """Put everything where it is at a moment."""
        import mujoco

        x, y, theta = still.pose.tolist()
        place, turn = self.data.mocap_pos, self.data.mocap_quat
        place[0] = x, y, 0.0
        turn[0] = math.cos(0.5 * theta), 0.0, 0.0, math.sin(0.5 * theta)
        if self._people:
            people = slice(1, 1 + EACH * self._people)
            shape = (self._people, EACH)
            self._show_people(still, place[people].reshape(*shape, 3), turn[people].reshape(*shape, 4))
        first = 1 + EACH * self._people
        place[first : first + len(still.doors_open), 2] = np.where(still.doors_open, AWAY, 0.0)
        mates, half = slice(first + len(still.doors_open), None), 0.5 * still.mates[:, 2]
        place[mates, :2], place[mates, 2] = still.mates[:, :2], 0.0
        turn[mates] = np.column_stack((np.cos(half), np.zeros((len(half), 2)), np.sin(half)))
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)

    def _show_people(self, still: SceneState, place: NDArray[np.float64], turn: NDArray[np.float64]) -> None:
        looks, colours = self._looks, np.array(self._looks.people)
        absent = np.isnan(still.positions[:, 0]) | np.isnan(still.feet[:, 0, 0])
        positions, feet = (
            np.where(absent[:, None], AWAY, still.positions),
            np.where(absent[:, None, None], AWAY, still.feet),
        )
        facing = np.arctan2(still.face[:, 1], still.face[:, 0])
        place[:, 0, :2], place[:, 0, 2] = positions, 0.0
        turn[:, 0] = np.column_stack((np.cos(0.5 * facing), np.zeros((len(facing), 2)), np.sin(0.5 * facing)))
        for side in range(2):
            hips = np.column_stack((0.5 * (positions + feet[:, side]), np.full(len(feet), looks.hip)))
            down = np.column_stack((feet[:, side], np.zeros(len(feet)))) - hips
            place[:, 1 + side], turn[:, 1 + side] = hips, _downward_quaternions(down)
        self.model.geom_rgba[self._torsos] = colours[still.states % len(colours)]


def _downward_quaternions(down: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the quaternions (P, 4) that turn -z to these directions (P, 3)."""
    down = down / np.linalg.norm(down, axis=1, keepdims=True)
    quaternion = np.column_stack((1.0 - down[:, 2], down[:, 1], -down[:, 0], np.zeros(len(down))))
    return np.asarray(quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True))


def _scene_xml(record: EpisodeRecord, grid: OccupancyGrid, robot: Robot, body: Body, looks: Appearance) -> str:
    root = ElementTree.Element("mujoco", model="picture")
    ElementTree.SubElement(root, "compiler", angle="radian")
    visual = ElementTree.SubElement(root, "visual")
    ElementTree.SubElement(visual, "global", offwidth="3840", offheight="2160", fovy="45")
    ElementTree.SubElement(
        visual, "quality", offsamples="0", shadowsize="0", numslices="14", numstacks="8", numquads="1"
    )
    ElementTree.SubElement(visual, "map", znear="0.002", zfar="4")
    ElementTree.SubElement(visual, "headlight", ambient="0.4 0.4 0.4", diffuse="0.25 0.25 0.25", specular="0 0 0")
    assets, world = ElementTree.SubElement(root, "asset"), ElementTree.SubElement(root, "worldbody")
    ElementTree.SubElement(
        world,
        "light",
        directional="true",
        pos="0 0 10",
        dir="-0.4 0.25 -0.9",
        castshadow="false",
        diffuse="0.4 0.4 0.4",
    )
    _add_sky_and_floor(assets, world, looks)
    obstacles = [
        Obstacle(np.asarray(thing["vertices_xy"]), thing["radius"]) for thing in record.meta["scenario"]["obstacles"]
    ]
    add_scene(world, assets, scene_of(grid, obstacles, looks.wall_height), rgba=format_numbers(*looks.wall), group="0")
    furniture = furniture_scene(furniture_of(record.meta["scenario"]), grid.origin)
    add_scene(world, assets, furniture, "furniture", rgba=format_numbers(*looks.furniture), group="0")
    x, y, _ = record.meta["scenario"]["goal"]
    radius = record.meta["scenario"]["goal_radius"]
    _add_geom(
        world, "cylinder", looks.goal, size=format_numbers(radius, 0.01), pos=format_numbers(x, y, 0.01), group=OWN
    )
    _add_robot(world, assets, robot, body, looks)
    for number, size in enumerate(np.asarray(record["pedestrian_radii"], np.float64).tolist()):
        _add_person(world, number, size, looks)
    for number, door in enumerate(record.meta["scenario"].get("doors", ())):
        closed, paint = Prism(np.asarray(door["vertices_xy"]), 0.0, looks.wall_height), format_numbers(*looks.door)
        add_door(world, assets, number, closed, NOTHING, rgba=paint, group="0")
    for number, mate in enumerate(record.teammates()):
        base = ElementTree.SubElement(world, "body", name=f"mate_{number}", mocap="true")
        footprint, colour = _footprint_of(mate["robot"]), looks.mates[number % len(looks.mates)]
        _add_hull(base, assets, footprint, body, {"rgba": format_numbers(*colour), "group": "0"})
        _add_nose(base, assets, footprint, body.height, looks)
    return ElementTree.tostring(root, "unicode")


def _add_sky_and_floor(assets: Element, world: Element, looks: Appearance) -> None:
    ElementTree.SubElement(
        assets,
        "texture",
        type="skybox",
        builtin="gradient",
        rgb1="0.95 0.97 1",
        rgb2="0.75 0.82 0.9",
        width="64",
        height="384",
    )
    light, dark = (format_numbers(*colour) for colour in looks.floor)
    ElementTree.SubElement(
        assets, "texture", name="floor", type="2d", builtin="checker", rgb1=light, rgb2=dark, width="64", height="64"
    )
    ElementTree.SubElement(assets, "material", name="floor", texture="floor", texrepeat="1 1", texuniform="true")
    ElementTree.SubElement(
        world, "geom", type="plane", size="0 0 1", material="floor", contype="0", conaffinity="0", group=OWN
    )


def _add_robot(world: Element, assets: Element, robot: Robot, body: Body, looks: Appearance) -> None:
    """Add the robot: its footprint as a hull, its wheels, an arrow forwards, and a camera over its front."""
    base = ElementTree.SubElement(world, "body", name="robot", mocap="true")
    top, footprint = body.height, robot.footprint
    if body.own is None:  # else the file's own shapes are seen
        _add_hull(base, assets, footprint, body, {"rgba": format_numbers(*looks.robot), "group": OWN})
    _add_nose(base, assets, footprint, top, looks)
    reach, wheels = footprint.inscribed_radius, body.wheels
    for x, y in wheels.places if body.own is None else ():
        turn = math.atan2(y, x) if robot.kinematics == "omnidirectional" else 0.5 * math.pi
        _add_geom(
            base,
            "cylinder",
            looks.wheel,
            size=format_numbers(wheels.radius, 0.5 * wheels.width),
            pos=format_numbers(x, y, wheels.radius),
            zaxis=format_numbers(math.cos(turn), math.sin(turn), 0.0),
            group=OWN,
        )
    front = footprint.radius if footprint.is_circle else float(footprint.vertices_xy[:, 0].max())
    height = max(top + 0.1 * reach, body.lidar_height) + looks.onboard.above
    ElementTree.SubElement(
        base,
        "camera",
        name="onboard",
        pos=format_numbers(front, 0.0, height),
        xyaxes="0 -1 0 0 0 1",
        fovy=format_numbers(looks.onboard.fovy),
    )


def _footprint_of(robot: Mapping[str, Any]) -> Footprint:
    """Return the outline of a robot as a record tells of it."""
    said = robot["footprint"]
    vertices = np.asarray(said["vertices_xy"], np.float64).reshape(-1, 2)
    return Footprint.polygon(vertices) if len(vertices) else Footprint.circle(said["radius"])


def _add_hull(base: Element, assets: Element, footprint: Footprint, body: Body, paint: Mapping[str, str]) -> None:
    """Add the footprint of a robot, upright, in a colour and a group."""
    bottom, top = body.clearance, body.height
    if footprint.is_circle:
        size, middle = (
            format_numbers(footprint.radius, 0.5 * (top - bottom)),
            format_numbers(0, 0, 0.5 * (bottom + top)),
        )
        disc = {"type": "cylinder", "contype": "0", "conaffinity": "0", "size": size, "pos": middle}
        ElementTree.SubElement(base, "geom", {**disc, **paint})
    else:
        prism = Prism(footprint.vertices_xy, bottom, top)
        add_prism(base, assets, f"hull_{base.get('name')}", NOTHING, prism, **paint)


def _add_nose(base: Element, assets: Element, footprint: Footprint, top: float, looks: Appearance) -> None:
    """Add an arrow forwards on top of a robot."""
    reach = footprint.inscribed_radius
    nose = Prism(np.array(((0.9, 0.0), (-0.3, 0.5), (-0.3, -0.5))) * reach, top, top + 0.1 * reach)
    paint = {"rgba": format_numbers(*looks.nose), "group": OWN}
    add_prism(base, assets, f"nose_{base.get('name')}", NOTHING, nose, **paint)


def _add_person(world: Element, number: int, radius: float, looks: Appearance) -> None:
    """Add a person: torso and head on one body, and two legs that are turned at the hips."""
    half = min(radius, looks.torso)
    person = ElementTree.SubElement(
        world, "body", name=f"person_{number}", mocap="true", pos=format_numbers(AWAY, AWAY, 0.0)
    )
    middle, tall = 0.5 * (looks.hip + looks.shoulder), 0.5 * (looks.shoulder - looks.hip) + 0.08
    size = format_numbers(0.6 * half, half, tall)
    _add_geom(
        person,
        "ellipsoid",
        looks.people[0],
        name=f"torso_{number}",
        size=size,
        pos=format_numbers(0.0, 0.0, middle),
        group="0",
    )
    _add_geom(
        person,
        "sphere",
        looks.skin,
        size=format_numbers(looks.head_radius),
        pos=format_numbers(0.0, 0.0, looks.head),
        group="0",
    )
    thick = min(looks.leg, 0.4 * radius)
    for side in ("left", "right"):
        leg = ElementTree.SubElement(
            world, "body", name=f"person_{number}_{side}", mocap="true", pos=format_numbers(AWAY, AWAY, 0.0)
        )
        ends = format_numbers(0.0, 0.0, thick, 0.0, 0.0, thick - looks.hip)
        _add_geom(leg, "capsule", looks.legs, size=format_numbers(thick), fromto=ends, group="0")


def _add_geom(body: Element, kind: str, colour: Colour, **attributes: Any) -> None:
    ElementTree.SubElement(
        body, "geom", attributes, type=kind, rgba=format_numbers(*colour), contype="0", conaffinity="0"
    )
