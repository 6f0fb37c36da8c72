"""The simulator: the robots of N worlds move by rigid-body physics; people,
contacts and lidar are those of the plane.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    Branches,
    ConfigurationError,
    ImpossibleScenario,
    OccupancyGrid,
    PedestrianModel,
    Robot,
    Scenario,
    Snapshot,
    stream_key,
)
from arena_core.parameters import Bounds, Positive, Step
from arena_core.scenes import wall_boxes
from arena_kernels.compiled import TypedDispatch
from arena_mujoco.body import BodyFigures, body_of, check_wheels
from arena_mujoco.body_attachment import wheeled_model
from arena_mujoco.camera import CameraFigures, DepthCamera
from arena_mujoco.contact_filter import ContactFilter
from arena_mujoco.model import AWAY, Drive, Machine, Physics, compile_model, model_text, robot_name
from arena_mujoco.rays import Rays
from arena_mujoco.ticking import (
    RUNS,
    TIPPED,
    Base,
    PhysicsArrays,
    Sensing,
    TickRules,
    after_mate,
    after_tick,
    before_tick,
    disturb_scan,
    file_gears,
    note_mate,
    planar_gears,
    read_mate,
    show_people,
    wheel_gears,
)
from arena_sim2d.bodies import Floats, Worlds
from arena_sim2d.obstacles import Reach
from arena_sim2d.simulator import Sim2d

if TYPE_CHECKING:
    import mujoco

MOST_BOXES = 20_000  # of a world's walls: MuJoCo then takes half a gigabyte
KEPT = 32  # models of worlds that may begin again
FAILURES = {TIPPED: "RobotTippedOver: it leans by more than simulator.tip_angle"}
REMEMBERED = PhysicsArrays._fields[5:]  # beside the views of a world's state
UNSTABLE_TEXT = "UnstablePhysics: positions or speeds are no longer finite; a smaller simulator.timestep may help"


@dataclass(frozen=True, slots=True, eq=False)
class WorldPhysics:
    """One world's model and state, and the arrays of both that kernels read and write."""

    model: mujoco.MjModel
    touching: ContactFilter
    data: mujoco.MjData
    motions: tuple[PhysicsArrays, ...]  # of each robot


class MujocoSimulator(Sim2d):
    """Steps N worlds of one robot or a team each, each by a model of its own; world k of N is bit for bit what it is
    alone.
    """

    def __init__(
        self,
        robot: Robot,
        pedestrians: PedestrianModel,
        inner_step: Step,
        crowd_period: Positive,
        drive: Drive,
        lidar: Literal["slice", "rays"],
        timestep: Positive,
        fine_way: Annotated[float, Bounds(low=1e-4, high=0.1)],
        wall_height: Positive,
        floor_friction: Annotated[float, Bounds(low=0.01, high=10.0)],
        wall_friction: Annotated[float, Bounds(low=0.0, high=10.0)],
        tip_angle: Annotated[float, Bounds(low=0.1, high=1.5)],
        depth_camera: CameraFigures,
        body: BodyFigures,
    ) -> None:
        _prepare_mujoco()
        self._body = body_of(robot, body)
        super().__init__(robot, pedestrians, inner_step, crowd_period, self._body.lidar_height, self._body.height)
        self._reach = Reach(self._body.lidar_height, self._body.clearance, self._body.height)
        if self._body.lidar_height >= wall_height:
            raise ConfigurationError(
                f"simulator.wall_height is {wall_height:g}; allowed: above the lidar, "
                f"{self._body.lidar_height:g} m high"
            )
        self._camera = DepthCamera(depth_camera, robot, self._body, inner_step) if depth_camera.enabled else None
        legs = (lidar == "rays" or depth_camera.enabled) and pedestrians.gait is not None
        self._rules = TickRules(legs, inner_step, _physics_steps(inner_step, timestep), fine_way)
        self._physics = Physics(timestep, wall_height, floor_friction, wall_friction, drive, legs, depth_camera.enabled)
        self._gears = planar_gears(robot, self._body)
        if drive == "wheels":
            check_wheels(robot, self._body)
            make = wheel_gears if self._body.own is None else file_gears
            self._gears = make(robot, self._body, floor_friction, tip_angle)
        self._rays = Rays(robot.lidar, self._body.lidar_height) if lidar == "rays" else None
        self._before, self._after, self._show_people = (
            TypedDispatch(before_tick),
            TypedDispatch(after_tick),
            TypedDispatch(show_people),
        )
        self._read_mate, self._note_mate, self._after_mate = (
            TypedDispatch(read_mate),
            TypedDispatch(note_mate),
            TypedDispatch(after_mate),
        )
        self._models: OrderedDict[tuple[Any, ...], tuple[OccupancyGrid, mujoco.MjModel, ContactFilter]] = OrderedDict()
        self._physical: list[WorldPhysics | None] = []
        self._images = np.empty((0, 0, 0), np.float32)
        self._image_keys, self._image_ticks = np.zeros(0, np.uint64), np.zeros(0, np.int64)

    def _reset_all(self, scenarios: Sequence[Scenario]) -> None:
        self._physical = [None] * len(scenarios)
        if self._camera is not None:
            self._images = np.full((len(scenarios), *self._camera.shape), np.inf, np.float32)
            self._image_keys, self._image_ticks = (
                np.zeros(len(scenarios), np.uint64),
                np.zeros(len(scenarios), np.int64),
            )
        super()._reset_all(scenarios)

    def _check_teams(self, scenarios: Sequence[Scenario], most: int) -> None:
        """Raise ConfigurationError for teams of which models know nothing, too."""
        super()._check_teams(scenarios, most)
        wheels = self._physics.drive == "wheels" and self._body.own is not None
        for scenario in scenarios:
            if scenario.robots > 1 and (wheels or self._camera is not None):
                what = "a depth camera" if not wheels else "wheels from a file of its own"
                allowed = "simulator.depth_camera.enabled=false" if not wheels else "simulator.drive=planar"
                raise ConfigurationError(
                    f"{scenario.name} has {scenario.robots} robots, and only a robot alone has {what}; allowed: "
                    f"{allowed}"
                )
            other = next((mate.robot for mate in scenario.team if mate.body not in (None, self._robot)), "")
            if other:
                raise ConfigurationError(
                    f"{scenario.name} has a {other} among robots of type {self._robot.name}; allowed with "
                    "simulator=mujoco: a team of one type"
                )

    def _begin_worlds(self, slots: NDArray[np.int64]) -> None:
        super()._begin_worlds(slots)
        for slot in slots.tolist():
            self._physical[slot] = self._physical_of(slot)
            if self._rays is not None:
                for member in range(self._scenarios[slot].robots):
                    self._cast_scan(slot, member, 0)
            if self._camera is not None:
                scenario = self._scenarios[slot]
                self._image_keys[slot] = stream_key(scenario.seed, scenario.name, "depth")
                self._take_image(slot, 0)

    def fork(self, branches: Branches) -> MujocoSimulator:
        """Return a simulator of its own whose worlds go on from these; their models are shared."""
        forked = super().fork(branches)
        assert isinstance(forked, MujocoSimulator)
        slots = branches.slots
        physical = [_copy_physics(self._physical[slot]) for slot in slots]
        _put_away_absent(vars(forked)["_worlds"], physical)
        vars(forked).update(_physical=physical)
        if self._camera is not None:
            keys = self._image_keys[slots] ^ branches.streams
            vars(forked).update(_images=self._images[slots], _image_ticks=self._image_ticks[slots], _image_keys=keys)
        return forked

    def _physical_of(self, slot: int) -> WorldPhysics:
        """Return the physics of a world that begins."""
        import mujoco

        scenario = self._scenarios[slot]
        model, touching = self._world_model(scenario, self._crowd.radii[slot, : self._crowd.counts[slot]])
        data = mujoco.MjData(model)
        starts = [scenario.start, *(mate.start for mate in scenario.team)]
        motions = []
        for start, views in zip(starts, _views(data, scenario.robots), strict=True):
            qpos = views[0]
            if self._gears.wheeled:
                qpos[:7] = start.x, start.y, 0.0, math.cos(0.5 * start.theta), 0.0, 0.0, math.sin(0.5 * start.theta)
            else:
                qpos[:3] = start.x, start.y, start.theta
            flags = np.full(1, RUNS), np.zeros(1, np.int64)
            motions.append(PhysicsArrays(*views, np.zeros(3), np.zeros(3), np.zeros(3), qpos.copy(), *flags))
        self._show_people(self._worlds, slot * self._team, motions[0], self._rules)
        return WorldPhysics(model, touching, data, tuple(motions))

    def _world_model(self, scenario: Scenario, radii: Floats) -> tuple[mujoco.MjModel, ContactFilter]:
        """Return the model of a world, and what it is tested for; one that is like an earlier
        one's is not compiled again.
        """
        grid = scenario.world.grid
        things = tuple((obstacle.vertices_xy.tobytes(), obstacle.radius) for obstacle in scenario.obstacles)
        doors = tuple(door.vertices_xy.tobytes() for door in scenario.doors)
        key = (id(grid), things, doors, scenario.world.furniture, radii.tobytes(), scenario.robots)
        if key not in self._models:
            boxes = len(grid.derive(wall_boxes)) + sum(
                len(piece.boxes) + len(piece.cylinders) for piece in scenario.world.furniture
            )
            if boxes > MOST_BOXES:
                what = "walls and furniture" if scenario.world.furniture else "walls"
                raise ImpossibleScenario(
                    f"{scenario.name}: its {what} are {boxes} boxes; allowed with simulator=mujoco: {MOST_BOXES}"
                )
            text = model_text(Machine(self._robot, self._body, self._physics), scenario, radii, self._pedestrians.gait)
            model = self._compile_world(text, scenario.name)
            self._models[key] = grid, model, ContactFilter(model)
            if len(self._models) > max(KEPT, 2 * len(self._scenarios)):
                self._models.popitem(last=False)
        self._models.move_to_end(key)
        return self._models[key][1:]

    def _compile_world(self, text: str, name: str) -> mujoco.MjModel:
        own = self._body.own
        if own is None or self._physics.drive == "planar":
            return compile_model(text, name)
        return wheeled_model(text, name, own, Machine(self._robot, self._body, self._physics))

    def _advance_worlds(self, commands: Floats, ticks: int, scan_within: int) -> None:
        self._worlds.robots["contacts"] = 0
        for slot, physical in enumerate(self._physical):
            if physical is None:
                continue
            if self._team == 1:
                self._run_world(slot, physical, commands[slot], ticks, scan_within)
            else:
                self._run_team(slot, physical, commands, ticks, scan_within)

    def _run_world(self, slot: int, physical: WorldPhysics, command: Floats, ticks: int, scan_within: int) -> None:
        """Step one world by some ticks; of the scans due within ``scan_within`` ticks only the newest is taken."""
        from mujoco import mj_step

        worlds, motion, touching, dt = self._worlds, physical.motions[0], physical.touching, self.inner_step
        model, data, option = physical.model, physical.data, physical.model.opt
        first = int(worlds.robots["tick"][slot])
        last = first + scan_within
        due = last - last % self._scanner.period
        scan_tick = due if self._rays is None else -1
        film_tick = -1 if self._camera is None else last - last % self._camera.period
        if worlds.robots["absent"][slot]:
            due, scan_tick, film_tick = -1, -1, -1
        base, rules = Base(self._chassis, self._gears), self._rules
        sensing = Sensing(self._wheels, self._scanner, self._ranges[slot], scan_tick, dt)
        for tick in range(first + 1, first + ticks + 1):
            steps = self._before(worlds, slot, base, motion, command, rules)
            if steps:
                touching.select_contacts(near=motion.near[0] == 1)
                option.timestep = dt / steps
                mj_step(model, data, steps)
            self._after(worlds, slot, base, motion, sensing)
            if self._rays is not None and tick == due:
                self._cast_scan(slot, 0, tick)
            if tick == film_tick:
                self._take_image(slot, tick)

    def _run_team(self, slot: int, physical: WorldPhysics, commands: Floats, ticks: int, scan_within: int) -> None:
        """Step the world of a team by some ticks, all its robots at once: each is read before contacts are noted, and
        contacts of all before anything is measured.
        """
        from mujoco import mj_step

        worlds, first, option = self._worlds, slot * self._team, physical.model.opt
        rows = [*enumerate(physical.motions, first)]
        begun = int(worlds.robots["tick"][first])
        last = begun + scan_within
        due = last - last % self._scanner.period
        base, scan_tick = Base(self._chassis, self._gears), due if self._rays is None else -1
        tools = self._wheels, self._scanner
        sensing = [Sensing(*tools, self._ranges[row], scan_tick, self.inner_step) for row, _ in rows]
        for tick in range(begun + 1, begun + ticks + 1):
            steps = max(self._before(worlds, row, base, motion, commands[row], self._rules) for row, motion in rows)
            if steps:
                physical.touching.select_contacts(near=any(motion.near[0] == 1 for _, motion in rows))
                option.timestep = self.inner_step / steps
                mj_step(physical.model, physical.data, steps)
            for row, motion in rows:
                self._read_mate(worlds, row, base, motion)
            for row, motion in rows:
                self._note_mate(worlds, row, motion)
            for (row, motion), own in zip(rows, sensing, strict=True):
                self._after_mate(worlds, row, base, motion, own)
            worlds.robots["tick"][first + len(rows) : first + self._team] = tick  # of those that are in other worlds
            if self._rays is not None and tick == due:
                for member in range(len(rows)):
                    self._cast_scan(slot, member, tick)

    def _take_image(self, slot: int, tick: int) -> None:
        """Take an image."""
        physical = self._physical[slot]
        if physical is not None and self._camera is not None:
            self._camera.take_image(physical.model, physical.data, self._image_keys[slot], tick, self._images[slot])
            self._image_ticks[slot] = tick

    def _cast_scan(self, slot: int, member: int, tick: int) -> None:
        """Take a scan of a robot by MuJoCo's rays."""
        physical, row = self._physical[slot], slot * self._team + member
        if physical is not None and self._rays is not None and not self._worlds.robots["absent"][row]:
            self._rays.cast_rays(physical.model, physical.data, self._ranges[row], robot_name(member))
            disturb_scan(self._worlds, row, self._scanner, tick, self._ranges[row])

    def _take_snapshot(self) -> Snapshot:
        states = {
            slot * self._team + member: int(motion.state[0])
            for slot, physical in enumerate(self._physical)
            for member, motion in enumerate(() if physical is None else physical.motions)
        }
        failures = {row: FAILURES.get(state, UNSTABLE_TEXT) for row, state in states.items() if state != RUNS}
        seen = replace(super()._take_snapshot(), failures=failures)
        if self._camera is None:
            return seen
        stamps = np.asarray(self._image_ticks * self.inner_step, np.float64)
        return replace(seen, depths=self._images.copy(), depth_stamps=stamps, depth_header=self._camera.header)


def _views(data: mujoco.MjData, robots: int) -> list[tuple[Floats, Floats, Floats, Floats, Floats]]:
    """Return the arrays of a world's state that kernels read and write, of each of its robots, which are of one type:
    the first five of PhysicsArrays.
    """
    of_all = data.qpos, data.qvel, data.ctrl, data.actuator_force
    own = [np.split(array, robots) for array in of_all]
    return [(*(parts[member] for parts in own), data.mocap_pos) for member in range(robots)]


def _copy_physics(physical: WorldPhysics | None) -> WorldPhysics | None:
    """Return a world's physics with a state of its own; the model is shared."""
    if physical is None:
        return None
    data, motions = copy(physical.data), physical.motions
    copied = [
        PhysicsArrays(*views, *(getattr(motion, name).copy() for name in REMEMBERED))
        for views, motion in zip(_views(data, len(motions)), motions, strict=True)
    ]
    return replace(physical, data=data, motions=tuple(copied))


def _put_away_absent(worlds: Worlds, physical: Sequence[WorldPhysics | None]) -> None:
    """Put the bodies of teammates that are not in the world where they are in no one's way."""
    for row in np.flatnonzero(worlds.robots["absent"]).tolist() if worlds.team > 1 else ():
        of_all, member = physical[row // worlds.team], row % worlds.team
        if of_all is not None and member < len(of_all.motions):
            motion = of_all.motions[member]
            motion.qpos[:2] = AWAY * (2.0 + member), AWAY
            motion.qvel[:], motion.ctrl[:] = 0.0, 0.0


def _prepare_mujoco() -> None:
    """Keep MuJoCo from writing a log into the working directory, unless someone else takes its warnings: rows say what
    is wrong.

    Raises ConfigurationError where MuJoCo cannot be imported.
    """
    try:
        import mujoco
    except ImportError as error:
        raise ConfigurationError(f"simulator=mujoco needs MuJoCo ({error}); allowed: pip install mujoco") from None
    if mujoco.get_mju_user_warning() is None:
        mujoco.set_mju_user_warning(_ignore_message)


def _ignore_message(_: str) -> None:
    pass


def _physics_steps(tick: float, timestep: float) -> int:
    """Return how many steps of the physics a tick has; raise ConfigurationError unless it is a whole number of them."""
    steps = round(tick / timestep)
    if steps < 1 or abs(steps * timestep - tick) > 1e-9:
        raise ConfigurationError(
            f"simulator.timestep is {timestep:g} s; allowed: simulator.inner_step ({tick:g} s) or a whole part of it"
        )
    return steps
