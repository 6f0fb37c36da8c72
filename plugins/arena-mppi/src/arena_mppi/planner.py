"""Model predictive path integral control of Williams et al. (2017, 2018), in the manner of Nav2's controller."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, ClassVar

import numpy as np

from arena_core import Candidate, EpisodeStart, NoValidCommand, Observation, Planner, Pose, Robot, Twist
from arena_core.parameters import Flat
from arena_kernels.costmap_window import allowed_gap, outline_clearance
from arena_mppi.candidates import rollout_candidates
from arena_mppi.chassis import chassis_of, motion_model_of
from arena_mppi.optimizer import control_step, sample_rollouts, update_sequence
from arena_mppi.own_critics import add_own_costs, make_critics
from arena_mppi.parameters import Critics, Floats, Scene
from arena_mppi.passage import eased_static, room_ahead
from arena_mppi.path_following import CREEP, follow_path
from arena_mppi.sampling import make_workspace, sampling_of
from arena_mppi.scene import body_of, scene_of, static_window
from arena_mppi.sequence import ControlSequence
from arena_mppi.settings import CriticSettings, Driving, Model, Noise, Optimisation, SpeedLimits
from arena_mppi.stuck_detection import StuckDetector
from arena_mppi.weights import critics_of

THROUGH = 0.4  # part of the greatest speed at which the guide leads through a passage
TIGHTEST = 0.5  # part of the least gap that a robot keeps that has lost patience: marks make a gap narrower than it is


class MppiPlanner(Planner):
    """Samples control sequences round the last one, rolls them out and drives their average,
    weighted by what they cost.
    """

    compiles: ClassVar[bool] = True

    def __init__(
        self,
        robot: Robot,
        optimisation: Annotated[Optimisation, Flat()],
        driving: Annotated[Driving, Flat()],
        model: Annotated[Model, Flat()],
        noise: Noise,
        limits: SpeedLimits,
        critics: Annotated[CriticSettings, Flat()],
    ) -> None:
        dt, kind = optimisation.model_dt, motion_model_of(robot, model.motion_model)
        self._chassis = chassis_of(robot, kind, limits, model.turning_radius, dt)
        self._sampling = sampling_of(self._chassis, noise, optimisation)
        self._work = make_workspace(self._sampling, self._chassis, optimisation.arcs)
        self._sequence = ControlSequence(optimisation.time_steps, dt, driving.velocity_feedback)
        self._body = body_of(robot.footprint)
        self._patience = StuckDetector(driving.patience)
        self._retries = driving.retry_attempt_limit
        self._critics, self._static = critics, critics.static
        self._own_critics = make_critics(critics.critics)
        self._period = robot.control_period
        self._key, self._steps = 0, 0
        self._began: tuple[Pose, Floats] | None = None
        self._drives = False

    def reset(self, episode: EpisodeStart) -> None:
        """Forget the sequence and draw the episode's table of normal numbers."""
        self._period = episode.control_period
        tied = max(1, round(self._period / float(self._sampling.dt)))
        self._sampling = self._sampling._replace(tied=min(tied, self._sampling.time_steps))
        self._work.normals[:] = episode.random.standard_normal(len(self._work.normals), np.float32)
        self._key, self._steps = int(episode.random.integers(1 << 62)), 0
        self._sequence.clear()
        self._patience.clear()
        self._began = None

    def considered(self) -> list[Candidate]:
        """Return some roll-outs of the last batch with what they cost, and the sequence that is driven."""
        return [] if self._began is None else rollout_candidates(self._work, self._sampling, *self._began, self._drives)

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the velocity that the sequence has at the end of the coming period; raise NoValidCommand
        when all collide within it.
        """
        self._began = None
        self._check_observation(observation)
        scene = self._build_scene(observation)
        self._static = eased_static(self._critics.static, self._path_clearance(observation, scene))
        twist = observation.twist
        sideways = twist.vy if self._chassis.vy_max > 0.0 else 0.0
        now = self._sequence.velocity_at(np.array((twist.vx, sideways, twist.wz), np.float32), observation.stamp)
        self._began, self._drives = (observation.pose, now), False
        work = self._work
        work.history[:] = self._sequence.past_velocities(now, observation.stamp)
        work.mean[:] = self._sequence.shifted_sequence(now, observation.stamp)
        if self._free_steps(observation, scene, now) <= self._sampling.tied:
            self._sequence.clear()
            raise NoValidCommand("mppi: every roll-out collides before the next command")
        self._drives = True
        return self._make_command(self._sequence.store_sequence(work.mean, now, observation.stamp, self._period))

    def _make_command(self, velocity: Floats) -> Twist:
        """Return a velocity as a command; the average of two bends may be a bend that no car can drive."""
        vx, vy, wz = velocity.tolist()
        tightest = float(self._chassis.turn_at_rest) + float(self._chassis.curvature) * abs(vx)
        return Twist(vx, vy, min(max(wz, -tightest), tightest))

    def _free_steps(self, observation: Observation, scene: Scene, now: Floats) -> int:
        """Improve the sequence, once more from rest when every roll-out collides;
        return for how many steps it is free.
        """
        steps = self._improve_sequence(observation, scene, now)
        for _ in range(self._retries):
            if steps == self._sampling.time_steps:
                break
            self._work.mean[:] = 0.0
            steps = self._improve_sequence(observation, scene, now)
        if self._static is not self._critics.static:
            steps = self._improve_along_path(observation, scene, now, steps, THROUGH * float(self._chassis.vx_max))
        if self._patience.clearance_scale(observation.pose, observation.stamp) < 1.0:
            steps = self._improve_along_path(observation, scene, now, steps, CREEP)
        return steps

    def _improve_along_path(self, observation: Observation, scene: Scene, now: Floats, steps: int, speed: float) -> int:
        """Improve the guide as well, and keep the cheaper sequence; return for how many steps it is free."""
        work, sampling = self._work, self._sampling
        mean, least = work.mean.copy(), work.costs[: sampling.batch_size].min()
        theta, radius = observation.pose.theta, self._body.outline.inscribed_radius
        state = np.array((math.cos(theta), math.sin(theta), *now), np.float32)
        work.mean[:] = follow_path(scene, radius, self._chassis, state, speed, float(sampling.dt), sampling.time_steps)
        guided = self._improve_sequence(observation, scene, now)
        if work.costs[: sampling.batch_size].min() < least:
            return guided
        work.mean[:] = mean
        return steps

    def _improve_sequence(self, observation: Observation, scene: Scene, now: Floats) -> int:
        """Run one control step and return for how many steps its sequence is free."""
        pose = observation.pose
        c, s = math.cos(pose.theta), math.sin(pose.theta)
        wanted = self._static.collision_gap * max(TIGHTEST, self._patience.clearance_scale(pose, observation.stamp))
        gap = outline_clearance(scene.window, self._body.outline, (pose.x, pose.y, c, s), wanted)
        least = allowed_gap(gap, wanted, 0.0) if math.isfinite(gap) else wanted
        state = np.array((c, s, *now), np.float32)
        critics = self._weighted_critics(observation)
        self._steps += 1
        if self._own_critics:
            return self._step_with_own_critics(observation, scene, critics, state, float(least))
        return control_step(
            self._work,
            scene,
            self._body,
            self._chassis,
            self._sampling,
            critics,
            state,
            float(least),
            self._key,
            self._steps,
        )

    def _step_with_own_critics(
        self, observation: Observation, scene: Scene, critics: Critics, state: Floats, least: float
    ) -> int:
        """Do what ``control_step`` does, with the critics in Python asked between its halves."""
        work, sampling, steps = self._work, self._sampling, 0
        judged = (work, scene, self._body, self._chassis, sampling)
        for iteration in range(sampling.iterations):
            count = self._steps * sampling.iterations + iteration
            sample_rollouts(*judged, critics, state, least, self._key, count)
            add_own_costs(self._own_critics, work, sampling, scene, observation, state[2:])
            steps = update_sequence(*judged, state, least)
        return steps

    def _path_clearance(self, observation: Observation, scene: Scene) -> float:
        """Return the room that the path leaves on either side over the next metre, inf where that
        is more than walls are near.
        """
        path = np.ascontiguousarray(observation.path.poses, np.float64)
        return room_ahead(
            scene.window, self._body.outline, path, scene.x, scene.y, self._critics.static.near_collision_gap
        )

    def _build_scene(self, observation: Observation) -> Scene:
        window = static_window(observation, self._critics.moving.speed_min)
        dt, steps = float(self._sampling.dt), self._sampling.time_steps
        reach = (
            float(max(self._chassis.vx_max, self._chassis.vy_max)) * dt * steps
            + self._critics.path.follow_ahead
            + self._critics.path.angle_ahead
        )
        return scene_of(observation, window, self._body, self._critics.moving, self._critics.progress, dt, steps, reach)

    def _weighted_critics(self, observation: Observation) -> Critics:
        distance = observation.pose.distance(observation.goal)
        patience = self._patience.clearance_scale(observation.pose, observation.stamp)
        speed = float(max(self._chassis.vx_max, self._chassis.vy_max))
        return critics_of(replace(self._critics, static=self._static), speed, distance, patience)

    @staticmethod
    def _check_observation(observation: Observation) -> None:
        """Raise NoValidCommand unless there are a path and finite numbers."""
        pose, twist, poses = observation.pose, observation.twist, observation.path.poses
        if len(poses) == 0:
            raise NoValidCommand("mppi: the path is empty")
        if not (
            np.isfinite(poses).all() and np.isfinite((pose.x, pose.y, pose.theta, twist.vx, twist.vy, twist.wz)).all()
        ):
            raise NoValidCommand("mppi: pose, twist or path is not finite")
