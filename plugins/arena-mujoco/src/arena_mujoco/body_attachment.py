"""A body from a file within the model of a world: on its wheels, or only to look at."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from arena_core import ArenaError, Robot
from arena_core.commands import one_line
from arena_mujoco.body import STEERED
from arena_mujoco.model import GRIP, ROTOR, STRONG, UNSEEN, Machine, Physics
from arena_mujoco.robot_file import PREFIX, RobotFile, Wheel

if TYPE_CHECKING:
    import mujoco

FLOOR = 4  # contype and conaffinity of the floor and of what stands on it


def driven_wheels(own: RobotFile, robot: Robot) -> list[Wheel]:
    """Return the wheels that motors turn: all of them, of a car those on its rear axle."""
    return [wheel for wheel in own.wheels if robot.kinematics != "ackermann" or wheel.place[0] <= STEERED]


def wheeled_model(text: str, name: str, own: RobotFile, machine: Machine) -> mujoco.MjModel:
    """Return the model of a world ``text`` whose robot is a footprint alone, with the body of a file in it; raise
    ArenaError.

    Its wheels touch the floor as tyres that are as large as they are, its casters slide, all else of it touches
    nothing: what stands is touched by the footprint. The motors of driven wheels come first, then those that steer.
    """
    world, base = _attach_base(text, own)
    for part in _body_tree(base):
        slides = part.name.removeprefix(PREFIX) in own.casters
        for geom in part.geoms:
            geom.contype = geom.conaffinity = FLOOR if slides else 0
            geom.group = int(UNSEEN)
            if slides:
                geom.friction, geom.condim, geom.priority, geom.solref = np.zeros(3), 1, 1, (0.02, 1.0)
    for wheel in own.wheels:
        _add_tyre(world.joint(PREFIX + wheel.joint), wheel, machine.physics)
    wheels = driven_wheels(own, machine.robot)
    slips = (
        machine.body.wheels.torque
        > STRONG
        * machine.physics.floor_friction
        * machine.body.mass
        * 9.81
        * machine.body.wheels.radius
        / len(own.wheels)
    )
    for wheel in wheels:
        load = machine.body.mass * wheel.radius**2 / len(own.wheels)
        rotor = ROTOR * load if slips else load
        world.joint(PREFIX + wheel.joint).armature = rotor
        gain = (load + rotor) * 10.0 * GRIP
        motor = _add_motor(world, wheel.joint, (gain,), (0.0, 0.0, -gain))
        if not slips:
            motor.forcelimited, motor.forcerange = 1, (-machine.body.wheels.torque, machine.body.wheels.torque)
    for steering in own.steering:
        servo = _add_motor(world, steering.joint, (60.0,), (0.0, -60.0, -2.0))
        servo.forcelimited, servo.forcerange = 1, (-20.0, 20.0)
    return _compile_world(world, name)


def static_model(text: str, name: str, own: RobotFile, group: int) -> mujoco.MjModel:
    """Return the model of a picture ``text`` with the body of a file in its robot; nothing of it moves by itself."""
    world, base = _attach_base(text, own)
    for part in _body_tree(base):
        for joint in list(part.joints):
            world.delete(joint)
        for geom in part.geoms:
            geom.contype, geom.conaffinity, geom.group = 0, 0, group
    return _compile_world(world, name)


def _attach_base(text: str, own: RobotFile) -> tuple[Any, Any]:
    """Return the specification of a world with the file's base in its body ``robot``, and that base."""
    import mujoco

    world, spec = mujoco.MjSpec.from_string(text), own.spec.copy()
    base = spec.body(own.base)
    for joint in list(base.joints):
        if joint.type == mujoco.mjtJoint.mjJNT_FREE:
            spec.delete(joint)
    frame = world.body("robot").add_frame(pos=(0.0, 0.0, own.base_height))
    frame.attach_body(base, PREFIX, "")
    return world, world.body(PREFIX + own.base)


def _body_tree(body: Any) -> list[Any]:
    """Return a body and all that hang on it."""
    return [body, *(part for child in body.bodies for part in _body_tree(child))]


def _add_tyre(joint: Any, wheel: Wheel, physics: Physics) -> None:
    """Add what of a wheel touches the floor: an ellipsoid, which does so in a point."""
    import mujoco

    tyre = joint.parent.add_geom()
    tyre.type, tyre.size, tyre.pos = (
        mujoco.mjtGeom.mjGEOM_ELLIPSOID,
        (wheel.radius, wheel.radius, wheel.half),
        joint.pos,
    )
    turn = np.zeros(4)
    mujoco.mju_quatZ2Vec(turn, np.asarray(joint.axis, np.float64))
    tyre.quat = turn
    tyre.contype, tyre.conaffinity, tyre.condim, tyre.group, tyre.mass = FLOOR, FLOOR, 3, int(UNSEEN), 0.0
    tyre.friction, tyre.solref = (physics.floor_friction, 0.005, 0.0001), (0.02, 1.0)


def _add_motor(world: Any, joint: str, gain: tuple[float, ...], bias: tuple[float, ...]) -> Any:
    """Add an actuator of a joint: force = gain * control + bias * (1, position, velocity)."""
    import mujoco

    motor = world.add_actuator(name=PREFIX + joint, target=PREFIX + joint)
    motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
    motor.gaintype, motor.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
    motor.gainprm[: len(gain)], motor.biasprm[: len(bias)] = gain, bias
    return motor


def _compile_world(world: Any, name: str) -> mujoco.MjModel:
    try:
        return world.compile()
    except ValueError as error:
        raise ArenaError(f"{name}: MuJoCo refuses the model ({one_line(str(error), 200)})") from None
