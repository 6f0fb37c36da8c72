"""Time a control step (robot, 360 beams, 10 people, contact) against navground (ORCA and lidar)
and ir-sim (social force).
"""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import yaml
from bench_lidar import free_poses, rooms
from timing import interleave

from arena_core import (
    Footprint,
    Lidar,
    OdometryModel,
    PedestrianSpec,
    Pose,
    Robot,
    Scenario,
    Simulator,
    VelocityLimits,
    World,
)
from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import load_registry

PEOPLE, STEP, BATCH, REPEATS = 10, 0.1, 64, 7
GOALS = {"navground ORCA + lidar": 0.6, "ir-sim social force": 1 / 200}
CALLS = {"batch": 120, "default": 120, "single": 2000, "navground ORCA + lidar": 3000, "ir-sim social force": 60}
DOORS = ((0.0, 4.25), (5.75, 14.25), (15.75, 20.0))
BORDER = [((0, 0), (20, 0)), ((20, 0), (20, 20)), ((20, 20), (0, 20)), ((0, 20), (0, 0))]
WALLS = BORDER + [((a, 10), (b, 10)) for a, b in DOORS] + [((10, a), (10, b)) for a, b in DOORS]


def robot(noise: float) -> Robot:
    """Return a round robot with a lidar of 10 m and odometry at 50 Hz; ``noise`` scales that of both."""
    lidar = Lidar(360, -np.pi, 2.0 * np.pi / 360, 0.1, 10.0, STEP, 0.01 * noise, Pose(0.0, 0.0))
    limits = VelocityLimits(-0.5, 1.0, 0.0, 2.0, 2.0, 0.0, 4.0)
    return Robot(
        "round", "differential", Footprint.circle(0.3), limits, lidar, OdometryModel(0.02, *[0.1 * noise] * 4), STEP
    )


def scenario(seed: int, world: World) -> Scenario:
    """Return a robot, and ten people who walk to and fro within their rooms: like the peers'
    they need no way through doors.
    """
    places = free_poses(world.grid, 200, 0.6, seed)[:, :2]
    start, rooms_of = places[0], (places > 10.0) @ (1, 2)
    homes = [k for k in range(1, 200) if np.hypot(*(places[k] - start)) > 1.0][:PEOPLE]
    ways = [places[rooms_of == rooms_of[home]][-4:] for home in homes]
    people = tuple(
        PedestrianSpec(k, places[home], way, 1.2, 0.3) for k, (home, way) in enumerate(zip(homes, ways, strict=True))
    )
    return Scenario(f"rooms/{seed}", seed, world, Pose(*start), Pose(1.0, 1.0), people, (), 0.3, 180.0)


def build_simulator(noise: float, **crowd_settings: float) -> Simulator:
    """Return the simulator with the social-force crowd, both as configured by default but for the settings given."""
    registry, body = load_registry(), robot(noise)

    def preset(group: str, name: str) -> Any:
        return to_plain(compose([], f"{group}/{name}")[group])

    crowd = registry.build("pedestrians", preset("pedestrians", "social_force") | crowd_settings)
    simulator: Simulator = registry.build("simulator", preset("simulator", "sim2d"), robot=body, pedestrians=crowd)
    return simulator


def our_steps(simulator: Simulator, worlds: int, calls: int) -> Callable[[], None]:
    """Return steps of so many worlds, each with its own people."""
    world = World("rooms", rooms())
    simulator.reset([scenario(seed, world) for seed in range(worlds)])
    commands, ticks = np.tile((0.3, 0.0, 0.3), (worlds, 1)), round(STEP / simulator.inner_step)

    def run() -> None:
        for _ in range(calls):
            simulator.advance(commands, ticks)

    return run


def navground_steps() -> Callable[[], None]:
    """Return steps of navground: ten ORCA agents, an idle robot and its lidar, which must be
    asked for by hand to be computed.
    """
    from navground import core, sim

    world, random = sim.World(), np.random.default_rng(0)
    for first, second in WALLS:
        world.add_wall(sim.Wall(np.array(first, float), np.array(second, float)))
    for _ in range(PEOPLE):
        agent = sim.Agent(radius=0.3, control_period=STEP)
        agent.kinematics = core.kinematics.OmnidirectionalKinematics(1.2)
        agent.behavior = core.Behavior.make_type("ORCA")
        agent.behavior.optimal_speed = 1.0
        agent.state_estimation = sim.state_estimations.BoundedStateEstimation(range=5.0)
        agent.task = sim.tasks.WaypointsTask(list(random.uniform(1, 19, (4, 2))), loop=True, tolerance=0.5)
        agent.position = random.uniform(1, 9, 2)
        world.add_agent(agent)
    body = sim.Agent(radius=0.3, control_period=STEP)
    body.kinematics, body.behavior = core.Kinematics.make_type("2WDiff"), core.Behavior.make_type("Dummy")
    body.kinematics.max_speed, body.kinematics.wheel_axis, body.position = 1.0, 0.4, np.array((8.0, 8.0))
    world.add_agent(body)
    lidar = sim.StateEstimation.make_type("Lidar")
    lidar.resolution, lidar.range, lidar.field_of_view, lidar.start_angle = 360, 10.0, 2.0 * np.pi, -np.pi
    world.run(10, STEP)
    state = core.SensingState()
    lidar.prepare_state(state)

    def run() -> None:
        for _ in range(CALLS["navground ORCA + lidar"]):
            world.update(STEP)
            lidar.update(body, world, state)

    return run


def irsim_steps() -> Callable[[], None]:
    """Return steps of ir-sim: ten social-force obstacles, a robot that drives a circle, and its lidar."""
    logging.disable(logging.INFO)
    import irsim

    def line(*points: tuple[float, float]) -> dict[str, Any]:
        return {"shape": {"name": "linestring", "vertices": [list(point) for point in points]}, "state": [0, 0, 0]}

    area = {"range_low": [1, 1, -3.14], "range_high": [9, 9, 3.14]}
    sensor = {"name": "lidar2d", "range_min": 0, "range_max": 10, "angle_range": 6.2831, "number": 360}
    disc = {"name": "circle", "radius": 0.3}
    people = {
        "number": PEOPLE,
        "kinematics": {"name": "omni"},
        "distribution": {"name": "random", **area},
        "shape": disc,
        "behavior": {"name": "sfm", "wander": True, **area},
        "vel_max": [1.2, 1.2],
        "vel_min": [-1.2, -1.2],
    }
    scene = {
        "world": {"height": 20, "width": 20, "step_time": STEP, "sample_time": STEP, "collision_mode": "unobstructed"},
        "robot": [
            {
                "kinematics": {"name": "diff"},
                "shape": disc,
                "state": [8, 8, 0],
                "goal": [15, 15, 0],
                "sensors": [sensor],
            }
        ],
        "obstacle": [people, line(*(first for first, _ in BORDER), (0, 0)), *(line(*wall) for wall in WALLS[4:])],
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        path.write_text(yaml.safe_dump(scene))
        world = irsim.make(str(path), log_level="ERROR", headless=True)
    command = np.array([[0.3], [0.3]])

    def run() -> None:
        for _ in range(CALLS["ir-sim social force"]):
            world.step(command)
            world.get_lidar_scan()

    return run


PEERS = {"navground ORCA + lidar": ("navground", navground_steps), "ir-sim social force": ("irsim", irsim_steps)}


def measure() -> list[dict[str, Any]]:
    """Return a row for each peer that is installed, both doing the same, and rows for the simulator as configured by
    default.

    Like the peers, the first senses without noise and steps its crowd once a control step; it does check contacts,
    keeps bodies apart and measures clearances.
    """
    runs = {
        "batch": our_steps(build_simulator(0.0, longest_step=STEP), BATCH, CALLS["batch"]),
        "default": our_steps(build_simulator(1.0), BATCH, CALLS["batch"]),
        "single": our_steps(build_simulator(1.0), 1, CALLS["single"]),
    }
    for name, (module, make) in PEERS.items():
        if find_spec(module):
            runs[name] = make()
        else:
            print(f"{module} is not installed: simulator not compared with {name}")
    times = interleave(runs, REPEATS)
    ms = {name: 1e3 * median(times[name]) / CALLS[name] for name in runs}
    what = f"control step, 360 beams, {PEOPLE} people"
    batch = ms["batch"] / BATCH
    rows = [_make_row(f"{what}, of a batch of {BATCH}", batch, name, ms[name]) for name in PEERS if name in ms] or [
        _make_row(what, batch)
    ]
    with_noise = _make_row(f"{what}, of a batch of {BATCH}, noise, two crowd steps", ms["default"] / BATCH)
    return [*rows, with_noise, _make_row(f"{what}, single, noise, two crowd steps", ms["single"])]


def _make_row(what: str, ours_ms: float, peer: str | None = None, peer_ms: float | None = None) -> dict[str, Any]:
    ratio = None if peer_ms is None else ours_ms / peer_ms
    goal = None if peer is None else GOALS[peer]
    return {
        "what": what,
        "ours_ms": ours_ms,
        "peer": peer,
        "peer_ms": peer_ms,
        "ratio": ratio,
        "goal": goal,
        "unit": "x peer",
    }


if __name__ == "__main__":
    for row in measure():
        print(f"{row['what']}: {1e3 * row['ours_ms']:.1f} us", end="")
        print("" if row["peer"] is None else f", {row['peer']} {1e3 * row['peer_ms']:.1f} us, ratio {row['ratio']:.4f}")
