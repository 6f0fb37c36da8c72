"""A robot's body from a file of its maker or user, MJCF or URDF: which of its joints are wheels, and what
the file says of the body.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, InputFileError, Robot
from arena_core.commands import one_line
from arena_core.files import local_path
from arena_core.parameters import Positive
from arena_mujoco.model_file import FORMATS, check_model_file

if TYPE_CHECKING:
    import mujoco

Floats = NDArray[np.float64]
PREFIX = "own/"  # of all names of the file in a world's model
ALONG_Y = 0.9  # how much of a wheel's axis has to lie across the robot


@dataclass(frozen=True, slots=True)
class Joints:
    """Which joints and bodies of a file are what. ``wheels`` are hinges across the robot; where it steers, those ahead
    roll freely.

    ``steering`` are hinges about the vertical, in the order of the wheels ahead; ``casters`` are bodies that slide on
    the floor without friction; the lidar is as high as the body or site ``lidar``. A motor has ``torque`` N m, None:
    enough never to stall.
    """

    wheels: list[str]
    steering: list[str]
    casters: list[str]
    lidar: str | None
    torque: Positive | None


NO_JOINTS = Joints([], [], [], None, None)


@dataclass(frozen=True, slots=True, eq=False)
class Wheel:
    """A wheel as it stands: ``joint``, ``place`` (2,) in the base's frame, ``radius``, ``half`` its width,
    m; 1 or -1 as it ``turns``.
    """

    joint: str
    place: Floats
    radius: float
    half: float
    turns: float


@dataclass(frozen=True, slots=True, eq=False)
class RobotFile:
    """A file as it was read: lengths m above the floor, ``mass`` kg; the frame of its base is ``base_height`` m above
    the floor.

    ``speeds`` and ``angles`` are where wheels and steering stand in qvel and qpos, after the free joint of the base.
    """

    path: Path
    spec: Any
    base: str
    mass: float
    inertia: tuple[float, float, float]
    centre: tuple[float, float, float]
    bottom: float
    top: float
    base_height: float
    lidar_height: float | None
    wheels: tuple[Wheel, ...]
    steering: tuple[Wheel, ...]
    casters: tuple[str, ...]
    speeds: tuple[int, ...]
    angles: tuple[int, ...]


def read_robot_file(address: str, joints: Joints, robot: Robot) -> RobotFile:
    """Read a body; raise InputFileError for a file that MuJoCo cannot read, ConfigurationError
    for names that are not in it.
    """
    path = local_path(address)
    spec = _read_spec(path)
    base = _free_body(path, spec)
    probe = _Probe(path, spec, base.name)
    _check_names(path, probe, joints, robot)
    steering = tuple(probe.steering(path, name) for name in joints.steering)
    wheels = tuple(probe.wheel(path, name) for name in joints.wheels)
    radius = max((wheel.radius for wheel in wheels), default=0.0)
    lowest = min((probe.height(wheel.joint) - wheel.radius for wheel in wheels), default=probe.lowest)
    bottom, top = probe.extent({wheel.joint for wheel in wheels}, joints.casters)
    return RobotFile(
        path,
        spec,
        base.name,
        probe.mass,
        probe.inertia,
        (probe.centre[0], probe.centre[1], probe.centre[2] - lowest),
        max(bottom - lowest, 0.0 if not wheels else 0.1 * radius),
        top - lowest,
        -lowest,
        None if joints.lidar is None else probe.height_of(joints.lidar) - lowest,
        wheels,
        steering,
        tuple(joints.casters),
        tuple(probe.speed(wheel.joint) for wheel in wheels),
        tuple(probe.angle(wheel.joint) for wheel in steering),
    )


def _read_spec(path: Path) -> Any:
    """Return MuJoCo's specification of a file, with nothing in it that moves but by joints."""
    import mujoco

    check_model_file(path)
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        raise InputFileError(
            f"{path}: MuJoCo cannot read it ({one_line(str(error), 200)}); allowed: {FORMATS}"
        ) from None
    spec.compiler.fusestatic = False  # bodies without joints keep their names
    for thing in [*spec.actuators, *spec.sensors, *spec.keys]:
        spec.delete(thing)
    return spec


def _free_body(path: Path, spec: Any) -> Any:
    """Return the body that moves freely: URDF's root, or the one of a MuJoCo model that has a free joint."""
    import mujoco

    bodies = list(spec.worldbody.bodies)
    if path.suffix == ".urdf" and len(bodies) == 1 and not list(bodies[0].joints):
        bodies[0].add_freejoint()
    free = [body for body in bodies if any(joint.type == mujoco.mjtJoint.mjJNT_FREE for joint in body.joints)]
    if len(free) != 1:
        found = ", ".join(body.name or "unnamed" for body in bodies) or "none"
        raise InputFileError(
            f"{path}: has {len(free)} free bases among its outermost bodies ({found}); allowed: one, with a freejoint"
        )
    for body in bodies:
        if body is not free[0]:
            spec.delete(body)
    for thing in [*spec.worldbody.geoms, *spec.worldbody.lights, *spec.worldbody.cameras]:
        spec.delete(thing)
    free[0].pos, free[0].quat = np.zeros(3), np.array((1.0, 0.0, 0.0, 0.0))
    if not free[0].name:
        free[0].name = "base"
    return free[0]


class _Probe:
    """The file's robot alone, compiled: what can be measured of it, in the frame of its base."""

    def __init__(self, path: Path, spec: Any, base: str) -> None:
        import mujoco

        try:
            self.model: mujoco.MjModel = spec.compile()
        except ValueError as error:
            reason = one_line(str(error), 200)
            raise InputFileError(
                f"{path}: MuJoCo refuses the model ({reason}); allowed: a model with all its files"
            ) from None
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self._hinge = int(mujoco.mjtJoint.mjJNT_HINGE)
        root = self.model.body(base).id
        self.mass = float(self.model.body_subtreemass[root])
        self.centre: tuple[float, float, float] = tuple(self.data.subtree_com[root].tolist())
        self.inertia = self._central_inertia()
        self.lowest = self._height_bounds(range(self.model.ngeom))[0]

    def _central_inertia(self) -> tuple[float, float, float]:
        """Return the moments of inertia about axes through the centre of mass, kg m2."""
        model, data, total = self.model, self.data, np.zeros((3, 3))
        for body in range(1, model.nbody):
            turn, off = data.ximat[body].reshape(3, 3), data.xipos[body] - np.array(self.centre)
            total += turn @ np.diag(model.body_inertia[body]) @ turn.T
            total += model.body_mass[body] * (off @ off * np.eye(3) - np.outer(off, off))
        return tuple(np.diag(total).tolist())  # type: ignore[return-value]

    @property
    def hinges(self) -> list[str]:
        """Return the names of all hinges."""
        return [self.model.joint(i).name for i in range(self.model.njnt) if self.model.jnt_type[i] == self._hinge]

    @property
    def bodies(self) -> list[str]:
        """Return the names of all bodies but the world."""
        return [self.model.body(i).name for i in range(1, self.model.nbody)]

    @property
    def sites(self) -> list[str]:
        """Return the names of all sites."""
        return [self.model.site(i).name for i in range(self.model.nsite)]

    def place(self, joint: str) -> Floats:
        """Return where a joint is, (2,)."""
        return np.array(self.data.joint(joint).xanchor[:2])

    def height(self, joint: str) -> float:
        """Return how high a joint is."""
        return float(self.data.joint(joint).xanchor[2])

    def height_of(self, name: str) -> float:
        """Return how high a body or a site is."""
        return float((self.data.site(name) if name in self.sites else self.data.body(name)).xpos[2])

    def speed(self, joint: str) -> int:
        """Return where a joint stands in qvel."""
        return int(self.model.joint(joint).dofadr[0])

    def angle(self, joint: str) -> int:
        """Return where a joint stands in qpos."""
        return int(self.model.joint(joint).qposadr[0])

    def wheel(self, path: Path, joint: str) -> Wheel:
        """Return the wheel that a joint turns; raise ConfigurationError for one that rolls nowhere."""
        axis = self.data.joint(joint).xaxis
        points = [self._surface_points(geom) for geom in self._subtree_geoms(int(self.model.joint(joint).bodyid[0]))]
        if abs(axis[1]) < ALONG_Y or not points:
            wrong = "turns about another axis than y" if points else "turns nothing that has a shape"
            raise ConfigurationError(
                f"simulator.body.joints.wheels: {joint} of {path} {wrong}; allowed: hinges of wheels, across the robot"
            )
        off = np.vstack(points) - self.data.joint(joint).xanchor
        along = off @ axis
        across = np.linalg.norm(off - along[:, None] * axis, axis=1)
        return Wheel(
            joint,
            self.place(joint),
            float(across.max()),
            float(max(np.ptp(along) / 2.0, 1e-3)),
            float(np.sign(axis[1])),
        )

    def steering(self, path: Path, joint: str) -> Wheel:
        """Return where a joint steers; raise ConfigurationError for one that turns
        about another axis than the vertical.
        """
        if self.data.joint(joint).xaxis[2] < ALONG_Y:
            raise ConfigurationError(
                f"simulator.body.joints.steering: {joint} of {path} does not turn about z; allowed: "
                "hinges about z, upwards"
            )
        return Wheel(joint, self.place(joint), 0.0, 0.0, 1.0)

    def extent(self, wheels: set[str], casters: Sequence[str]) -> tuple[float, float]:
        """Return the bottom of what is neither wheel nor caster, and the top of all."""
        apart = {int(self.model.joint(joint).bodyid[0]) for joint in wheels} | {
            self.model.body(name).id for name in casters
        }
        chassis = [
            geom
            for geom in range(self.model.ngeom)
            if not apart & set(self._body_ancestors(int(self.model.geom_bodyid[geom])))
        ]
        _, top = self._height_bounds(range(self.model.ngeom))
        return (self._height_bounds(chassis)[0] if chassis else self.lowest), top

    def _body_ancestors(self, body: int) -> Iterator[int]:
        """Yield a body and all that it hangs on."""
        while body > 0:
            yield body
            body = int(self.model.body_parentid[body])

    def _subtree_geoms(self, body: int) -> list[int]:
        """Return the geoms of a body and of those that hang on it."""
        return [
            geom for geom in range(self.model.ngeom) if body in self._body_ancestors(int(self.model.geom_bodyid[geom]))
        ]

    def _height_bounds(self, geoms: Sequence[int] | range) -> tuple[float, float]:
        heights = np.concatenate([self._surface_points(geom)[:, 2] for geom in geoms] or [np.zeros(1)])
        return float(heights.min()), float(heights.max())

    def _surface_points(self, geom: int) -> Floats:
        """Return points (N, 3) on a geom's outside: the vertices of a mesh, else those of a fine wire frame."""
        import mujoco

        model, kind, size = self.model, self.model.geom_type[geom], self.model.geom_size[geom]
        if kind == mujoco.mjtGeom.mjGEOM_MESH:
            mesh = model.geom_dataid[geom]
            first = model.mesh_vertadr[mesh]
            own = np.asarray(model.mesh_vert[first : first + model.mesh_vertnum[mesh]], np.float64)
        elif kind == mujoco.mjtGeom.mjGEOM_BOX:
            own = np.array(np.meshgrid(*([-1.0, 1.0],) * 3)).reshape(3, -1).T * size
        else:
            own = _round_points(kind, size)
        return np.asarray(own @ self.data.geom_xmat[geom].reshape(3, 3).T + self.data.geom_xpos[geom])


def _round_points(kind: int, size: Floats) -> Floats:
    """Return points on a sphere, an ellipsoid, a capsule or a cylinder, (N, 3); none on a plane."""
    import mujoco

    around = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    ring = np.column_stack((np.cos(around), np.sin(around), np.zeros(64)))
    if kind == mujoco.mjtGeom.mjGEOM_PLANE:
        return np.empty((0, 3))
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return np.vstack([ring * size[0] + (0.0, 0.0, end * size[1]) for end in (-1.0, 1.0)])
    rings = [ring * np.cos(tilt) + (0.0, 0.0, np.sin(tilt)) for tilt in np.linspace(-0.5 * np.pi, 0.5 * np.pi, 17)]
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return np.vstack([one * size[0] + (0.0, 0.0, np.sign(one[0, 2]) * size[1]) for one in rings])
    return np.vstack(rings) * (size if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID else size[0])


def _check_names(path: Path, probe: _Probe, joints: Joints, robot: Robot) -> None:
    """Raise ConfigurationError for a name that is not in the file, and where joints are missing
    that the kinematics need.
    """
    places = probe.bodies + probe.sites
    wanted = [
        ("wheels", joints.wheels, probe.hinges, "hinges"),
        ("steering", joints.steering, probe.hinges, "hinges"),
        ("casters", joints.casters, probe.bodies, "bodies"),
        ("lidar", [joints.lidar] if joints.lidar is not None else [], places, "bodies and sites"),
    ]
    for key, names, known, what in wanted:
        for name in names:
            if name not in known:
                there = ", ".join(filter(None, known)) or "none"
                raise ConfigurationError(
                    f"simulator.body.joints.{key} is {name!r}; allowed, of the {what} of {path}: {there}"
                )
    if joints.steering and robot.kinematics != "ackermann":
        raise ConfigurationError(
            f"simulator.body.joints.steering is {joints.steering}; allowed: none for {robot.kinematics} kinematics"
        )
