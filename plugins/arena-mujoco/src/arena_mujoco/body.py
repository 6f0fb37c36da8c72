"""A robot's body: what its YAML says of it for three dimensions, completed from footprint and kinematics."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, Robot
from arena_core.parameters import Bounds, NonNegative, Positive
from arena_mujoco.robot_file import NO_JOINTS, Joints, RobotFile, read_robot_file

DENSITY = 100.0  # kg/m2 of footprint
FEWEST = {"differential": 2, "omnidirectional": 3, "ackermann": 3}  # wheels
STEERED = 0.01  # m; a car's wheels so far ahead of its rear axle are steered

Points = list[list[float]]


@dataclass(frozen=True, slots=True)
class Wheels:
    """Wheels of one kind: ``radius``, ``width`` m, ``mass`` kg and ``torque`` N m of each, and ``places``
    (W, 2) in ``base_link``, m.
    """

    radius: Positive
    width: Positive
    mass: Positive
    torque: Positive
    places: Points


@dataclass(frozen=True, slots=True)
class BodyFigures:
    """What a robot's YAML says of its body; None is completed from footprint and kinematics, see mujoco.yaml.

    All of it is of the robot ``of``, and none of it of any other; None: of any.
    """

    of: str | None
    mass: Positive | None
    height: Positive | None
    clearance: NonNegative | None
    centre_height: Positive | None
    lidar_height: Positive | None
    track_factor: Annotated[float, Bounds(low=0.1, high=10.0)]
    wheels: Wheels | None
    casters: Points | None
    model: str | None
    joints: Joints


UNKNOWN = BodyFigures(None, None, None, None, None, None, 1.0, None, None, None, NO_JOINTS)


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A robot's body: masses kg, heights above the floor m, ``inertia`` (3,) kg m2 about its centre of mass."""

    mass: float
    height: float
    clearance: float
    centre_height: float
    lidar_height: float
    track_factor: float
    wheels: Wheels
    casters: Points
    inertia: tuple[float, float, float]
    centre_xy: tuple[float, float]
    own: RobotFile | None = None

    @property
    def chassis_mass(self) -> float:
        """Return the mass without the wheels, kg."""
        return self.mass - self.wheels.mass * len(self.wheels.places)


def body_of(robot: Robot, figures: BodyFigures) -> Body:
    """Complete a body from the robot's footprint and kinematics; raise ConfigurationError where
    figures contradict each other.
    """
    if figures.of not in (None, robot.name):
        figures = UNKNOWN
    if figures.model is not None:
        return _body_of_file(robot, figures, figures.model)
    low, high = _footprint_bounds(robot)
    length, width = (high - low).tolist()
    mass = figures.mass or DENSITY * _footprint_area(robot)
    height = figures.height or robot.footprint.radius
    wheels = figures.wheels or _wheels_beneath(robot, mass, height)
    casters = figures.casters if figures.casters is not None else _casters_beneath(robot, wheels)
    _check_body(robot, mass, wheels, casters)
    chassis = mass - wheels.mass * len(wheels.places)
    solid = height * height, length * length, width * width
    inertia = tuple(
        chassis * (a + b) / 12.0 for a, b in ((solid[2], solid[0]), (solid[1], solid[0]), (solid[1], solid[2]))
    )
    return Body(
        mass,
        height,
        figures.clearance if figures.clearance is not None else 0.5 * wheels.radius,
        figures.centre_height or height / 3.0,
        figures.lidar_height or height,
        figures.track_factor,
        wheels,
        casters,
        inertia,
        _support_centre(wheels.places, casters),
    )


def _body_of_file(robot: Robot, figures: BodyFigures, model: str) -> Body:
    """Return the body that a file describes; of the figures count the lidar's height, where the file names
    none, and the track factor.
    """
    own = read_robot_file(model, figures.joints, robot)
    radius = max((wheel.radius for wheel in own.wheels), default=0.0)
    width = max((2.0 * wheel.half for wheel in own.wheels), default=0.0)
    torque = figures.joints.torque or own.mass * 9.81 * max(radius, 0.01)
    return Body(
        own.mass,
        own.top,
        min(own.bottom, 0.9 * own.top),
        own.centre[2],
        own.lidar_height or figures.lidar_height or own.top,
        figures.track_factor,
        Wheels(radius, width, 0.0, torque, [wheel.place.tolist() for wheel in own.wheels]),
        [],
        own.inertia,
        own.centre[:2],
        own,
    )


def check_wheels(robot: Robot, body: Body) -> None:
    """Raise ConfigurationError for a file's body that cannot drive on its wheels: joints are
    missing, or it has omniwheels.
    """
    if body.own is None:
        return
    if robot.kinematics == "omnidirectional":
        raise ConfigurationError(
            "simulator.drive is wheels for a simulator.body.model with omniwheels; allowed: planar"
        )
    ahead = sum(wheel.place[0] > STEERED for wheel in body.own.wheels)
    fewest = {"differential": 2, "ackermann": ahead + 1}[robot.kinematics]
    if len(body.own.wheels) < fewest:
        there, kind = len(body.own.wheels), robot.kinematics
        raise ConfigurationError(
            f"simulator.body.joints.wheels has {there} joints; allowed for {kind} kinematics: {fewest} at least"
        )
    if robot.kinematics == "ackermann" and not body.own.steering:
        raise ConfigurationError(
            "simulator.body.joints.steering is empty; allowed for ackermann kinematics: 1 joint at least"
        )


def _footprint_bounds(robot: Robot) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lower and the upper corner of the footprint's bounding box, m."""
    footprint = robot.footprint
    if footprint.is_circle:
        return np.full(2, -footprint.radius), np.full(2, footprint.radius)
    return footprint.vertices_xy.min(axis=0), footprint.vertices_xy.max(axis=0)


def _footprint_area(robot: Robot) -> float:
    if robot.footprint.is_circle:
        return math.pi * robot.footprint.radius**2
    x, y = robot.footprint.vertices_xy.T
    return 0.5 * float(np.abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def _wheels_beneath(robot: Robot, mass: float, height: float) -> Wheels:
    """Return the wheels that the kinematics need: two beside base_link, three round it, or a car's four."""
    inside = 0.8 * robot.footprint.inscribed_radius
    radius = min(0.4 * inside, 0.4 * height)
    if robot.kinematics == "omnidirectional":
        places = [
            [inside * math.cos(angle), inside * math.sin(angle)] for angle in (math.pi / 3.0, math.pi, -math.pi / 3.0)
        ]
    elif robot.kinematics == "ackermann":
        places = [[x, y] for x in (robot.wheelbase, 0.0) for y in (inside, -inside)]
    else:
        places = [[0.0, inside], [0.0, -inside]]
    return Wheels(radius, 0.3 * radius, 0.02 * mass, mass * 9.81 * radius, places)


def _casters_beneath(robot: Robot, wheels: Wheels) -> Points:
    """Return casters ahead and behind where wheels on one axle alone would not carry the body."""
    if np.ptp(np.array(wheels.places)[:, 0]) > STEERED:
        return []
    inside = 0.8 * robot.footprint.inscribed_radius
    return [[inside, 0.0], [-inside, 0.0]]


def _support_centre(places: Points, casters: Points) -> tuple[float, float]:
    """Return the centre of what the body stands on: where its own centre of mass is taken to be, but two
    thirds on its driving axle.
    """
    supports = np.array([*places, *casters])
    x, y = (supports.max(axis=0) + supports.min(axis=0)) / 2.0
    if casters and len(casters) == 1:
        x = np.array(places)[:, 0].mean() * 0.75 + casters[0][0] * 0.25
    return float(x), float(y)


def _check_body(robot: Robot, mass: float, wheels: Wheels, casters: Points) -> None:
    """Raise ConfigurationError unless the wheels are as many as the kinematics need, and weigh less than all."""
    if any(len(place) != 2 for place in (*wheels.places, *casters)):
        raise ConfigurationError("simulator.body: wheels.places and casters; allowed: pairs [x, y] (m)")
    fewest = FEWEST[robot.kinematics]
    if len(wheels.places) < fewest or len(wheels.places) + len(casters) < 3:
        raise ConfigurationError(
            f"simulator.body: {len(wheels.places)} wheels and {len(casters)} casters; "
            f"allowed for {robot.kinematics} kinematics: "
            f"{fewest} wheels at least, and 3 with the casters"
        )
    if wheels.mass * len(wheels.places) >= mass:
        raise ConfigurationError(f"simulator.body.mass is {mass:g} kg; allowed: more than that of its wheels")
