"""Which accelerations a robot's wheels hold: ramps of speed and of turning in the 3-D simulator, on two floors.

python benchmarks/robot_limits.py [ROBOT ...]
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np

from arena_core import Pose, Robot
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.testing import component, scenario

FLOORS = (0.8, 0.5)  # friction of rubber on clean concrete, on a smooth or dusty floor
ACCELERATIONS = (1.0, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0)  # m/s^2
TURNINGS = (3.2, 5.0, 10.0, 20.0)  # rad/s^2
RAMPS = {"turtlebot3": (0.22, 2.84), "jackal": (2.0, 1.57), "robotino": (2.0, 1.0), "jackal_ackermann": (2.0, 1.57)}
STEPS = 100  # of 10 ms: up, then as long down


def robot_with(name: str, acceleration: float, turning: float) -> Robot:
    """Return a robot of the suite with other limits, m/s^2 and rad/s^2."""
    words = [f"robot={name}", f"robot.limits.ax_max={acceleration}", f"robot.limits.alpha_max={turning}"]
    built: Robot = load_registry().build("robot", to_plain(compose(words))["robot"])
    return built


def drive(body: Robot, friction: float, ramp: Sequence[float], rest: Sequence[float]) -> np.ndarray:
    """Return the twists (T, 3) of a ramp up to a command and down to another, after a second of the latter."""
    words = [f"robot={body.name}", "simulator.drive=wheels", f"simulator.floor_friction={friction}"]
    crowd = component("pedestrians", "none")
    simulator = component("simulator", "mujoco", words, robot=body, pedestrians=crowd)
    simulator.reset([scenario(start=Pose(-2.0, 0.0, 0.0))])
    commands = [rest] * STEPS + [ramp] * STEPS + [rest] * STEPS
    return np.array([simulator.advance(np.array([command], float), 1).twists[0] for command in commands])


def rates(speeds: np.ndarray, wanted: float) -> tuple[float, float]:
    """Return how fast a speed (T,) rose to nine tenths of the wanted one, and fell to a tenth, each a second."""
    up, down = speeds[STEPS : 2 * STEPS], speeds[2 * STEPS :]
    rise, fall = int(np.argmax(up > 0.9 * wanted)), int(np.argmax(down < 0.1 * wanted))
    return (
        0.9 * wanted / (0.01 * rise) if rise else np.nan,
        (up[-1] - 0.1 * wanted) / (0.01 * fall) if fall else np.nan,
    )


def main(names: Sequence[str]) -> None:
    """Print a line a ramp: commanded, straight, in a turn, turning on the spot."""
    for name in names or RAMPS:
        speed, turn = RAMPS[name]
        car = robot_with(name, 1.0, 5.0).turn_radius > 0.0
        for friction in FLOORS:
            for acceleration in ACCELERATIONS:
                body = robot_with(name, acceleration, 20.0)
                straight = rates(drive(body, friction, (speed, 0.0, 0.0), (0.0, 0.0, 0.0))[:, 0], speed)
                bent = rates(drive(body, friction, (speed, 0.0, turn), (0.0, 0.0, turn))[:, 0], speed)
                print(
                    f"{name} floor {friction} {acceleration:g} m/s2: straight {straight[0]:.2f} up {straight[1]:.2f} "
                    f"down, turning {bent[0]:.2f} up {bent[1]:.2f} down",
                    flush=True,
                )
            for turning in TURNINGS:
                body, rest = robot_with(name, 2.0, turning), (0.8 if car else 0.0, 0.0, 0.0)
                held = rates(drive(body, friction, (rest[0], 0.0, turn), rest)[:, 2], turn)
                print(f"{name} floor {friction} {turning:g} rad/s2: {held[0]:.2f} up {held[1]:.2f} down", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
