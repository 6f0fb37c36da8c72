"""Nonlinear model predictive control after Rösmann, Makarow and Bertram (2021), solved by direct multiple shooting."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from arena_core import Candidate, EpisodeStart, NoValidCommand, Observation, Planner, Robot, Twist
from arena_core.parameters import Fraction, NonNegativeInt, Positive
from arena_kernels.costmap_window import allowed_gap, close_gap, footprint_outline, outline_clearance
from arena_kernels.escape import escape_command, escape_commands, keeps_gap
from arena_kernels.passage import AHEAD, KEPT, reduced_gap, room_along
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import THETA, VELOCITIES, VX, WZ
from arena_mpc.detours import path_detours
from arena_mpc.footprint import covering_discs, free_until
from arena_mpc.guess import drive_along, shift_plan
from arena_mpc.models import state_of, twist_of, velocity_bounds
from arena_mpc.moving import first_hit
from arena_mpc.optimiser import Optimiser
from arena_mpc.parameters import Form, Grid, Limits, ModelName, Obstacles, SolverSettings, Weights, drive_of, model_of
from arena_mpc.plan import Plan, Solution
from arena_mpc.reference import PathProgress, Reference, cut_where_blocked, local_reference
from arena_mpc.resizing import resize_grid
from arena_mpc.scene import Scene, scene_of

# m, from its goal that a plan may end: it waits for a person who crosses, or keeps off a goal beside a wall
ARRIVED = 0.4
DEEPER = 0.02  # m, by which a robot that already touches a person may come nearer


@dataclass(slots=True)
class Counts:
    """How the commands of an episode came about."""

    optimised: int = 0
    shifted: int = 0
    refused: int = 0


class RatedPlan(NamedTuple):
    """A safe plan: the share of it that is free of what stands, and what it costs."""

    plan: Plan
    share: float
    cost: float

    def is_better(self, other: RatedPlan | None) -> bool:
        """Return whether more of this plan is free, or it is cheaper."""
        return other is None or (self.share, -self.cost) > (other.share, -other.cost)


class MpcPlanner(Planner):
    """Optimises a plan to a local goal on the path at every control step and drives its beginning."""

    compiles: ClassVar[bool] = True

    def __init__(
        self,
        robot: Robot,
        model: ModelName | None,
        form: Form,
        discs: NonNegativeInt | None,
        look_ahead: Positive,
        reinit_distance: Positive,
        detour: Positive | None,
        escape_speed: Fraction | None,
        via_separation: Positive | None,
        final_state_fixed: bool,
        limits: Limits,
        grid: Grid,
        weights: Weights,
        obstacles: Obstacles,
        solver: SolverSettings,
    ) -> None:
        self._model, self._drive = model_of(robot, model), drive_of(robot, limits)
        self._bounds = velocity_bounds(self._model, self._drive)
        self._form, self._grid, self._obstacles = form, grid, obstacles
        self._look_ahead, self._reinit_distance = look_ahead, reinit_distance
        self._detour = detour
        self._outline = footprint_outline(robot.footprint)
        self._turn_radius, self._close = robot.turn_radius, close_gap(robot.turn_radius)
        self._turn_braking = robot.limits.alpha_max
        self._discs = covering_discs(robot.footprint, discs)
        self._optimiser = Optimiser(
            self._model, form, self._drive, self._discs, final_state_fixed, grid, weights, obstacles, solver
        )
        self._escapes = None if escape_speed is None else self._slow_commands(robot, escape_speed)
        self._via_separation, self._iterations = via_separation, solver.max_iterations
        self._period = robot.control_period
        self._progress = PathProgress()
        self._gap = obstacles.least_gap
        self._prepared = False
        self._forget_plan()

    def reset(self, episode: EpisodeStart) -> None:
        """Forget the last plan; compiled problems stay."""
        self._period = episode.control_period
        self._forget_plan()

    def considered(self) -> list[Candidate]:
        """Return the plans that were optimised, with what they cost; those that are not safe are refused."""
        return [Candidate(plan.states[:, :2], cost, plan is self._plan) for plan, cost in self._weighed]

    def _forget_plan(self) -> None:
        self._progress.clear()
        self._plan: Plan | None = None
        self._planned_at = 0.0
        self._steering = 0.0
        self._weighed: list[tuple[Plan, float]] = []
        self.counts = Counts()

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the beginning of the optimal plan, or of the last one while that is safe; raise
        NoValidCommand when neither is.
        """
        self._weighed = []
        self._check_observation(observation)
        scene = scene_of(observation, self._obstacles.moving_margin, moving=self._obstacles.moving > 0)
        reference = self._local_reference(observation, scene)
        self._gap = self._gap_to_keep(scene, reference, observation)
        self._prepare_problems(scene, reference)
        state = state_of(self._model, self._drive, self._bounds, observation.pose, observation.twist, self._steering)
        last = self._last_plan(reference, state, observation.stamp)
        plan = self._freest_plan(scene, reference, state, last)
        if plan is not None and self._keeps_gap(plan, scene, observation):
            self.counts.optimised += 1
            return self._record_plan(plan, observation.stamp)
        if (
            last is not None
            and self._is_safe(last, scene, self._free_for(last, scene))
            and self._keeps_gap(last, scene, observation)
        ):
            self._weighed.append((last, math.nan))
            self.counts.shifted += 1
            return self._record_plan(last, observation.stamp)
        self.counts.refused += 1
        self._plan = None
        return self._escape_command(scene, observation)

    def _gap_to_keep(self, scene: Scene, reference: Reference, observation: Observation) -> float:
        """Return the gap to what stands that the robot keeps here, m: less where its path has no more room."""
        x, y = observation.pose.x, observation.pose.y
        return reduced_gap(
            self._obstacles.least_gap, room_along(scene.window, self._outline, reference.path, (x, y), AHEAD), KEPT, 0.0
        )

    def _keeps_gap(self, plan: Plan, scene: Scene, observation: Observation) -> bool:
        """Return whether the command that a plan begins with keeps the gap for a control period."""
        if self._gap == 0.0:
            return True
        command = self._plan_command(plan).array()
        return keeps_gap(
            scene.window,
            self._outline,
            observation.pose.array(),
            command,
            self._period,
            self._turn_braking,
            self._gap,
            self._close,
        )

    def _slow_commands(self, robot: Robot, share: float) -> FloatArray:
        drive = self._drive
        least, most = (
            np.array((drive.vx_min, -drive.vy_max, -drive.wz_max)),
            np.array((drive.vx_max, drive.vy_max, drive.wz_max)),
        )
        return escape_commands(least, most, share, robot.turn_radius, holonomic=robot.holonomic)

    def _escape_command(self, scene: Scene, observation: Observation) -> Twist:
        """Return a slow way to more room; raise NoValidCommand where there is none."""
        if self._escapes is not None:
            moving = scene.foreseen, scene.radii
            found = escape_command(
                observation.pose.array(), scene.window, self._outline, *moving, self._escapes, self._gap
            )
            if len(found):
                return Twist.of(found[0])
        raise NoValidCommand("mpc: neither a new plan nor the last one is free of collisions")

    def _initial_guesses(
        self, scene: Scene, reference: Reference, state: FloatArray, last: Plan | None
    ) -> Iterator[tuple[Reference, Plan]]:
        """Yield what to aim at and where to begin: the last plan, the path, the ways round what
        blocks it, the path up to there.
        """
        if last is not None:
            yield reference, last
        yield reference, self._plan_along(reference.path, state)
        for path in self._path_detours(scene, reference):
            yield reference, self._plan_along(path, state)
        blocked = cut_where_blocked(reference, scene.window, self._outline.inscribed_radius)
        if blocked is not reference:
            yield blocked, self._plan_along(blocked.path, state)

    def _path_detours(self, scene: Scene, reference: Reference) -> Iterator[FloatArray]:
        """Return the path led round what stands and walks on it, if that is wanted."""
        radius, gap = self._outline.inscribed_radius, self._obstacles.moving_distance
        if self._detour is None:
            return iter(())
        return path_detours(reference.path, scene, radius, gap, self._drive.vx_max, self._detour)

    def _prepare_problems(self, scene: Scene, reference: Reference) -> None:
        """Build problems when the first command is asked for, which may be a rehearsal, and load the kernels
        that only trouble asks for.
        """
        if not self._prepared:
            self._optimiser.prepare()
            list(self._path_detours(scene, reference))
            cut_where_blocked(reference, scene.window, self._outline.inscribed_radius)
            self._prepared = True

    def _check_observation(self, observation: Observation) -> None:
        """Raise NoValidCommand for what no one can plan with."""
        if len(observation.path.poses) == 0:
            raise NoValidCommand("mpc: the path is empty")
        if not np.isfinite((*observation.pose.array(), *observation.twist.array())).all():
            raise NoValidCommand("mpc: pose or twist is not finite")

    def _local_reference(self, observation: Observation, scene: Scene) -> Reference:
        pose = observation.pose
        rest = self._progress.prune_path(observation.path.poses, np.array((pose.x, pose.y)))
        return local_reference(rest, self._look_ahead, self._via_separation, scene.window)

    def _last_plan(self, reference: Reference, state: FloatArray, stamp: float) -> Plan | None:
        """Return the last plan as it looks now, resized; None when there is none or the local goal has jumped."""
        plan, elapsed = self._plan, stamp - self._planned_at
        if plan is None or not 0.0 <= elapsed < plan.duration:
            return None
        if math.dist(plan.states[-1, :2], reference.goal[:2]) > self._reinit_distance:
            return None
        stages, step = (len(plan.states) - 1, plan.step) if self._form == "quadratic" else resize_grid(plan, self._grid)
        end = plan.states[-1].copy()
        if self._form == "minimum_time":
            end[:2] = reference.goal[:2]
        states = shift_plan(plan.states, plan.step, elapsed, end, stages, step)
        states[:, THETA] += 2.0 * math.pi * round((state[THETA] - states[0, THETA]) / (2.0 * math.pi))
        states[0] = state
        slack = shift_plan(plan.slack[:, None], plan.step, elapsed, plan.slack[-1:], stages, step)[:, 0]
        return Plan(states, step, slack)

    def _plan_along(self, path: FloatArray, state: FloatArray) -> Plan:
        """Return a drive along a path (M, 3)."""
        drive, step = self._drive, self._grid.step
        sideways = self._model == "omnidirectional"
        speed = drive.vx_max
        rolled = drive_along(path, state[:3], speed, drive.wz_max, sideways, self._turn_radius, self._grid.stages, step)
        velocities = rolled[:, 3:]
        if self._model == "unicycle":
            velocities = rolled[:, (3, 5)]
        elif self._model == "bicycle":
            steering = np.arctan2(rolled[:, WZ] * drive.wheelbase, np.maximum(rolled[:, VX], 1e-3))
            velocities = np.column_stack((rolled[:, VX], np.clip(steering, -drive.steering_max, drive.steering_max)))
        states = np.column_stack((rolled[:, :3], velocities))
        states[0] = state
        return Plan(states, step, np.zeros(len(states)))

    def _freest_plan(self, scene: Scene, reference: Reference, state: FloatArray, last: Plan | None) -> Plan | None:
        """Return the first free plan that arrives, else the cheapest free one, else the one free
        longest; None: none is safe.
        """
        best: RatedPlan | None = None
        left = self._iterations
        for aim, guess in self._initial_guesses(scene, reference, state, last):
            if best is not None and best.share == 1.0 and aim is not reference:
                break
            found = self._optimiser.optimise(scene, aim, state, guess, left)
            left -= found.iterations
            rated = self._rate_plan(found, scene)
            if found.plan is not None:
                self._weighed.append((found.plan, math.inf if rated is None else found.cost))
            if rated is None:
                continue
            if rated.is_better(best):
                best = rated
            if rated.share == 1.0 and self._reaches_goal(rated.plan, aim):
                break
        return None if best is None else best.plan

    def _rate_plan(self, found: Solution, scene: Scene) -> RatedPlan | None:
        """Return a plan that is safe with the share of it that touches nothing that stands."""
        if found.plan is None:
            return None
        free = self._free_for(found.plan, scene)
        if not self._is_safe(found.plan, scene, free):
            return None
        share = free / found.plan.duration
        return RatedPlan(found.plan, 1.0 if share >= 1.0 - 1e-9 else share, found.cost)

    def _reaches_goal(self, plan: Plan, aim: Reference) -> bool:
        """Return whether a plan ends near enough to where it should: one that ends before is stopped by something."""
        return math.dist(plan.states[-1, :2], aim.goal[:2]) < ARRIVED

    def _is_safe(self, plan: Plan, scene: Scene, free: float) -> bool:
        """Return whether the robot touches nothing that stands, and no one who keeps walking, on this plan until it
        could have stopped.

        For ``free`` s it touches nothing that stands.
        """
        needed = min(self._braking_time(plan), plan.duration) - 1e-9
        return free >= needed and first_hit(scene, plan, self._discs, DEEPER) >= needed

    def _free_for(self, plan: Plan, scene: Scene) -> float:
        """Return for how long the robot's outline touches nothing that stands on this plan, s."""
        x, y, theta = plan.states[0, :3].tolist()
        now = outline_clearance(scene.window, self._outline, (x, y, math.cos(theta), math.sin(theta)), 0.1)
        return (
            free_until(scene.window, self._outline, plan.states[:, :3].copy(), allowed_gap(now, self._gap, self._close))
            * plan.step
        )

    def _braking_time(self, plan: Plan) -> float:
        """Return how long the robot drives the plan at least, s: one control period, and braking."""
        twist, drive = twist_of(self._model, self._drive, plan.states[1, VELOCITIES:]), self._drive
        sideways = abs(twist.vy) / drive.ay_max if drive.ay_max > 0.0 else 0.0
        return self._period + max(abs(twist.vx) / drive.ax_max, sideways)

    def _record_plan(self, plan: Plan, stamp: float) -> Twist:
        """Remember the plan and return the mean of its velocities over the control period."""
        self._plan, self._planned_at = plan, stamp
        if self._model == "bicycle":
            self._steering = float(self._mean_velocities(plan)[1])
        return self._plan_command(plan)

    def _plan_command(self, plan: Plan) -> Twist:
        return twist_of(self._model, self._drive, self._mean_velocities(plan))

    def _mean_velocities(self, plan: Plan) -> FloatArray:
        ends = np.minimum(np.arange(1, len(plan.states)) * plan.step, self._period)
        shares = np.diff(ends, prepend=0.0) / self._period
        return np.asarray(shares @ plan.states[1:, VELOCITIES:] + (1.0 - shares.sum()) * plan.states[-1, VELOCITIES:])
