"""Time a control step of the 3-D simulator, 400 walls, 10 people with legs, 360 beams, against
PyBullet and against real time.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from statistics import median
from typing import Any

import numpy as np
from bench_lidar import rooms
from bench_simulator import PEOPLE, STEP, robot, scenario
from timing import interleave

from arena_core import OccupancyGrid, Pose, Simulator, World
from arena_core.hosting import compose, load_registry, to_plain

WALLS, REPEATS, GOAL = 400, 5, 1 / 8
CALLS = {"planar": 300, "wheels": 150, "pybullet": 20}
REAL_TIME = {"planar": 250, "wheels": 100}  # times, at least


def cluttered_rooms() -> OccupancyGrid:
    """Return the rooms of the lidar's benchmark with posts of 0.1 m, about 400 walls in all."""
    data, random = rooms().data.copy(), np.random.default_rng(1)
    for row, column in random.integers(4, 394, (WALLS - 40, 2)):
        data[row : row + 2, column : column + 2] = 100
    return OccupancyGrid(data, 0.05, Pose(0.0, 0.0))


def build_simulator(drive: str) -> Simulator:
    """Return the simulator with the social-force crowd on legs, as configured by default."""
    registry = load_registry()
    crowd = registry.build(
        "pedestrians", to_plain(compose([], "pedestrians/social_force")["pedestrians"]) | {"body": "legs"}
    )
    figures = to_plain(compose(["simulator=mujoco", "robot=jackal"])["simulator"]) | {"drive": drive}
    simulator: Simulator = registry.build("simulator", figures, robot=robot(1.0), pedestrians=crowd)
    return simulator


def our_steps(drive: str) -> Callable[[], None]:
    """Return steps of one world."""
    simulator = build_simulator(drive)
    simulator.reset([scenario(0, World("cluttered", cluttered_rooms()))])
    commands, ticks = np.array([[0.3, 0.0, 0.3]]), round(STEP / simulator.inner_step)

    def run() -> None:
        for _ in range(CALLS[drive]):
            simulator.advance(commands, ticks)

    return run


def pybullet_steps() -> Callable[[], None]:
    """Return steps of PyBullet: the same boxes, ten capsules that are led, a disc that is pushed, and a
    scan by its batch of rays.
    """
    import pybullet as bullet

    from arena_core.scenes import wall_boxes

    client = bullet.connect(bullet.DIRECT)
    bullet.setTimeStep(0.005, physicsClientId=client)
    for x, y, _, length, width in wall_boxes(cluttered_rooms()).tolist():
        shape = bullet.createCollisionShape(
            bullet.GEOM_BOX, halfExtents=[length / 2, width / 2, 1.0], physicsClientId=client
        )
        bullet.createMultiBody(0, shape, basePosition=[x, y, 1.0], physicsClientId=client)
    capsule = bullet.createCollisionShape(bullet.GEOM_CAPSULE, radius=0.3, height=1.2, physicsClientId=client)
    people = [
        bullet.createMultiBody(0, capsule, basePosition=[2.0 + 0.8 * k, 3.0, 0.9], physicsClientId=client)
        for k in range(PEOPLE)
    ]
    disc = bullet.createCollisionShape(bullet.GEOM_CYLINDER, radius=0.3, height=0.3, physicsClientId=client)
    body = bullet.createMultiBody(10.0, disc, basePosition=[8.0, 8.0, 0.15], physicsClientId=client)
    angles = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    beams = 10.0 * np.column_stack((np.cos(angles), np.sin(angles), np.zeros(360)))

    def run() -> None:
        for step in range(CALLS["pybullet"]):
            for k, person in enumerate(people):
                place = [2.0 + 0.8 * k, 3.0 + 0.3 * np.sin(0.1 * step), 0.9]
                bullet.resetBasePositionAndOrientation(person, place, [0, 0, 0, 1], physicsClientId=client)
            for _ in range(round(STEP / 0.005)):
                bullet.resetBaseVelocity(body, [0.1, 0.0, 0.0], [0, 0, 0.3], physicsClientId=client)
                bullet.stepSimulation(physicsClientId=client)
            start = np.add(bullet.getBasePositionAndOrientation(body, physicsClientId=client)[0], (0.0, 0.0, 0.2))
            bullet.rayTestBatch(np.tile(start, (360, 1)).tolist(), (start + beams).tolist(), physicsClientId=client)

    return run


def measure() -> list[dict[str, Any]]:
    """Return a row for each drive, with PyBullet as the peer where it is installed."""
    runs = {drive: our_steps(drive) for drive in REAL_TIME}
    if find_spec("pybullet"):
        runs["pybullet"] = pybullet_steps()
    else:
        print("pybullet is not installed: MuJoCo not compared with it")
    times = interleave(runs, REPEATS)
    ms = {name: 1e3 * median(times[name]) / CALLS[name] for name in runs}
    return [_make_row(drive, ms) for drive in REAL_TIME]


def _make_row(drive: str, ms: dict[str, float]) -> dict[str, Any]:
    peer = ms.get("pybullet")
    what = f"mujoco, drive={drive}, {WALLS} walls, 360 beams, {PEOPLE} people: {1e3 * STEP / ms[drive]:.0f} x real time"
    told = {"peer": None, "peer_ms": None, "ratio": None, "goal": None}
    if peer:
        told = {"peer": "pybullet", "peer_ms": peer, "ratio": ms[drive] / peer, "goal": GOAL}
    return {"what": what, "ours_ms": ms[drive], **told, "unit": "x peer"}


if __name__ == "__main__":
    for row in measure():
        print(row)
