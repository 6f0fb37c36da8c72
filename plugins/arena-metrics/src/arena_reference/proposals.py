"""Which commands are tried from a state, by how the robot moves: towards where the way goes on, beside it, and back."""

from __future__ import annotations

import math

from arena_kernels.compiled import inner
from arena_kernels.motion import ACKERMANN, DIFFERENTIAL, Chassis
from arena_reference.arrays import Floats

MOST = 20  # proposals of a state
ASIDE = (0.0, 0.3, -0.3, 0.8, -0.8)  # rad beside the way


@inner
def propose(chassis: Chassis, share: float, target: tuple[float, float], span: float, commands: Floats) -> int:
    """Write commands (MOST, 3) to try for ``span`` s; return how many.

    ``target`` is where the way goes on, seen from the robot: bearing, rad, and distance, m; ``share`` of its speed
    limits is what the robot may drive.
    """
    bearing, away = target
    if chassis.kinematics == DIFFERENTIAL:
        return _turn_and_drive(chassis, share, bearing, span, commands)
    if chassis.kinematics == ACKERMANN:
        return _steer(chassis, share, bearing, away, commands)
    return _slide(chassis, share, bearing, span, commands)


@inner
def _put(commands: Floats, count: int, vx: float, vy: float, wz: float) -> int:
    commands[count, 0], commands[count, 1], commands[count, 2] = vx, vy, wz
    return count + 1


@inner
def _turn_and_drive(chassis: Chassis, share: float, bearing: float, span: float, commands: Floats) -> int:
    wz = share * chassis.wz_max
    count = _put(commands, 0, 0.0, 0.0, 0.0)
    for aside in ASIDE:
        turn = min(max((bearing + aside) / span, -wz), wz)
        count = _put(commands, count, share * chassis.vx_max, 0.0, turn)
        if abs(aside) < 0.5:
            count = _put(commands, count, 0.5 * share * chassis.vx_max, 0.0, turn)
    count = _put(commands, count, share * chassis.vx_max, 0.0, wz)
    count = _put(commands, count, share * chassis.vx_max, 0.0, -wz)
    count = _put(commands, count, 0.0, 0.0, min(max(bearing / span, -wz), wz))
    behind = bearing - math.pi if bearing > 0.0 else bearing + math.pi
    for aside in (0.0, 0.5, -0.5):
        count = _put(commands, count, share * chassis.vx_min, 0.0, min(max((behind + aside) / span, -wz), wz))
    return count


@inner
def _steer(chassis: Chassis, share: float, bearing: float, away: float, commands: Floats) -> int:
    vx, most = share * chassis.vx_max, chassis.curvature_max
    arc = 2.0 * math.sin(bearing) / max(away, 0.05)
    count = _put(commands, 0, 0.0, 0.0, 0.0)
    for curvature in (min(max(arc, -most), most), 0.0, most, -most, 0.5 * most, -0.5 * most):
        count = _put(commands, count, vx, 0.0, curvature * vx)
        count = _put(commands, count, 0.4 * vx, 0.0, 0.4 * curvature * vx)
        back = 0.5 * share * chassis.vx_min
        count = _put(commands, count, back, 0.0, curvature * back)
    return count


@inner
def _slide(chassis: Chassis, share: float, bearing: float, span: float, commands: Floats) -> int:
    """Propose directions at the greatest speed that both axes allow; the robot may turn its diagonal, along which it is
    fastest, to the way.
    """
    count = _put(commands, 0, 0.0, 0.0, 0.0)
    vx, vy, wz = share * chassis.vx_max, share * chassis.vy_max, share * chassis.wz_max
    diagonal = math.atan2(vy, vx)
    turn = bearing - diagonal
    for other in (bearing + diagonal, bearing - math.pi + diagonal, bearing + math.pi - diagonal):
        turn = other if abs(other) < abs(turn) else turn
    turn = min(max(turn / span, -wz), wz)
    for aside in ASIDE:
        c, s = math.cos(bearing + aside), math.sin(bearing + aside)
        speed = min(vx / max(abs(c), 1e-9), vy / max(abs(s), 1e-9))
        count = _put(commands, count, speed * c, speed * s, turn)
        if abs(aside) < 0.5:
            count = _put(commands, count, 0.5 * speed * c, 0.5 * speed * s, turn)
    for way in (2.0, -2.0, math.pi):
        c, s = math.cos(bearing + way), math.sin(bearing + way)
        speed = min(vx / max(abs(c), 1e-9), vy / max(abs(s), 1e-9))
        count = _put(commands, count, 0.6 * speed * c, 0.6 * speed * s, 0.0)
    return count
