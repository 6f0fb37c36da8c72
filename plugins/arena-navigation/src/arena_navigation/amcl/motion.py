"""The filter's motion model: what the wheels report, and how far it may be wrong."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Pose
from arena_kernels.compiled import borrowing
from arena_kernels.random import fill_normals
from arena_navigation.amcl.directions import PlacedParticles, wrap_angle, write_directions
from arena_navigation.amcl.draws import Draw
from arena_navigation.columns import COSINE, SINE, THETA, X, Y

OdometryModelType = Literal["diff", "omni", "diff-corrected", "omni-corrected"]

SHORTEST_BEARING = 0.01  # m; below this a displacement has no trustworthy direction (as in ROS amcl)


class Alphas(NamedTuple):
    """The coefficients ``odom.alpha1`` .. ``odom.alpha5``."""

    rotation_from_rotation: float
    rotation_from_translation: float
    translation_from_translation: float
    translation_from_rotation: float
    strafe_from_translation: float


class OdometryMotion(NamedTuple):
    """A displacement in three parts, each with its standard deviation: turn (rad), travel that way (m), turn again
    (rad).

    ``strafe_std`` is noise across the way travelled, m; it shares its draw with ``turn_std``, of which one is zero.
    """

    turn: float
    travel: float
    turn_again: float
    turn_std: float
    travel_std: float
    turn_again_std: float
    strafe_std: float


def odometry_motion(displacement: Pose, model: OdometryModelType, alphas: Alphas) -> OdometryMotion:
    """Return the motion that odometry reports as ``displacement`` (the new pose in the frame of the old one).

    Without ``-corrected`` the models are those of ROS 1, which takes the variance for a standard deviation, and in
    ``omni`` also ``odom.alpha1`` for ``odom.alpha4`` and the other way round.
    """
    if model == "omni":
        alphas = alphas._replace(
            rotation_from_rotation=alphas.translation_from_rotation,
            translation_from_rotation=alphas.rotation_from_rotation,
        )
    parts = _omni_motion(displacement, alphas) if model.startswith("omni") else _diff_motion(displacement, alphas)
    if not model.endswith("-corrected"):
        return parts
    return OdometryMotion(*parts[:3], *(math.sqrt(variance) for variance in parts[3:]))


def _diff_motion(displacement: Pose, alphas: Alphas) -> OdometryMotion:
    """Decompose as Thrun, Burgard, Fox, Probabilistic Robotics, table 5.6; driving
    backwards is as noisy as forwards.
    """
    travel = math.hypot(displacement.x, displacement.y)
    turn = math.atan2(displacement.y, displacement.x) if travel >= SHORTEST_BEARING else 0.0
    turn_again = math.remainder(displacement.theta - turn, 2.0 * math.pi)
    first, second = _off_axis(turn) ** 2, _off_axis(turn_again) ** 2
    a1, a2, a3, a4, _ = alphas
    return OdometryMotion(
        turn,
        travel,
        turn_again,
        a1 * first + a2 * travel**2,
        a3 * travel**2 + a4 * (first + second),
        a1 * second + a2 * travel**2,
        0.0,
    )


def _omni_motion(displacement: Pose, alphas: Alphas) -> OdometryMotion:
    """Decompose into a travel in any direction and a rotation that does not depend on it (Nav2's omni model)."""
    travel = math.hypot(displacement.x, displacement.y)
    bearing = math.atan2(displacement.y, displacement.x)
    a1, a2, a3, a4, a5 = alphas
    turned = displacement.theta**2
    return OdometryMotion(
        bearing,
        travel,
        displacement.theta - bearing,
        0.0,
        a3 * travel**2 + a4 * turned,
        a1 * turned + a2 * travel**2,
        a4 * turned + a5 * travel**2,
    )


def _off_axis(angle: float) -> float:
    """Return the angle between a direction and the robot's long axis, forwards or backwards, rad."""
    return min(abs(angle), math.pi - abs(angle))


@borrowing
def move_particles(particles: PlacedParticles, motion: OdometryMotion, draw: Draw, noise: NDArray[np.float64]) -> None:
    """Move each particle by a motion drawn for it.

    The cosine and sine of its heading go to its directions. ``noise`` is scratch space of 3 P. Headings stay in
    [-pi, pi].
    """
    draws = noise[: 3 * particles.number]
    fill_normals(draw.key, draw.tick, draws)
    for i in range(particles.number):
        particles.poses[THETA, i] += motion.turn + motion.turn_std * draws[3 * i]
    write_directions(particles.poses[THETA], particles.number, particles.directions)
    for i in range(particles.number):
        c, s = particles.directions[COSINE, i], particles.directions[SINE, i]
        travel = motion.travel + motion.travel_std * draws[3 * i + 1]
        strafe = motion.strafe_std * draws[3 * i]
        particles.poses[X, i] += travel * c + strafe * s
        particles.poses[Y, i] += travel * s - strafe * c
        particles.poses[THETA, i] = wrap_angle(
            particles.poses[THETA, i] + motion.turn_again + motion.turn_again_std * draws[3 * i + 2]
        )
    write_directions(particles.poses[THETA], particles.number, particles.directions)
