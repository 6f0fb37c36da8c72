"""From an observation to what a value network is asked: the state now, and after each action."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_cadrl.actions import discrete_velocities, velocity_commands
from arena_cadrl.lookahead import evaluate_actions
from arena_cadrl.parameters import (
    GAP,
    GOAL_WAY,
    KINEMATICS,
    OWN,
    PERSON,
    PERSON_SPEED,
    PERSON_WAY,
    ROOM,
    ROOM_POINTS,
    TARGET_WAY,
    ActionSettings,
    Floats,
    Limits,
    PerceptionSettings,
    RewardSettings,
    Rules,
    Safety,
)
from arena_cadrl.route_progress import lookahead_target
from arena_core import ConfigurationError, NoValidCommand, Observation, ObservationField, Robot
from arena_kernels.costmap_window import footprint_outline, window_of, without_discs
from arena_policies.actions import ActionRange


@dataclass(frozen=True, slots=True)
class StateSettings:
    """All that a policy's numbers and actions depend on, as its card tells it."""

    name: str
    looking: PerceptionSettings
    choosing: ActionSettings
    safety: Safety
    worth: RewardSettings


@dataclass(frozen=True, slots=True, eq=False)
class ActionLookahead:
    """What one robot sees: ``now`` (D,), ``ahead`` (A, D) after each action; the value of action a is ``gains[a] +
    weights[a]`` times the network's of its row. ``allowed`` (A,) is the safety layer's word; ``velocity_commands`` (A,
    3), the first of which stands still.
    """

    now: NDArray[np.float32]
    ahead: NDArray[np.float32]
    gains: Floats
    weights: Floats
    allowed: NDArray[np.bool_]
    commands: Floats

    def best_action(self, values: NDArray[np.float32]) -> int | None:
        """Return the allowed action of the greatest value, given the network's (A,); None where none is allowed."""
        if not self.allowed.any():
            return None
        return int(np.where(self.allowed, self.gains + self.weights * values, -np.inf).argmax())


class Perception:
    """Looks one step ahead for one robot; it remembers nothing.

    Foreseen gaps to people below ``margin`` m are contacts.
    """

    def __init__(self, robot: Robot, range_: ActionRange, settings: StateSettings, margin: float) -> None:
        if robot.kinematics not in KINEMATICS:
            raise ConfigurationError(
                f"{settings.name}: robot {robot.name} is {robot.kinematics}; allowed: {', '.join(KINEMATICS)}"
            )
        limits = robot.limits_with(
            vx_min=range_.vx_min, vx_max=range_.vx_max, vy_max=range_.vy_max, wz_max=range_.wz_max
        )
        self._robot, self._settings = robot, settings
        self._vy_max, self._wz_max = limits.vy_max, limits.wz_max
        self._outline = footprint_outline(robot.footprint)
        self._kinds = discrete_velocities(robot, range_, settings.choosing)
        looking, safety, worth = settings.looking, settings.safety, settings.worth
        self._rules = Rules(
            KINEMATICS[robot.kinematics],
            Limits(*map(float, (limits.vx_max, limits.wz_max, limits.ax_max, limits.ay_max, limits.alpha_max))),
            float(looking.lookahead),
            float(looking.room_radius),
            float(settings.choosing.horizon),
            float(safety.hold),
            float(safety.padding),
            float(worth.discount),
            float(worth.collision),
            float(worth.discomfort),
            float(worth.comfort),
            float(worth.goal_radius),
            float(margin),
        )
        self.actions, self.size = len(self._kinds), OWN + PERSON * looking.people

    def observe(self, observation: Observation) -> ActionLookahead:
        """Return what there is to be seen and chosen; raise NoValidCommand without a path."""
        path = np.ascontiguousarray(observation.path.poses, np.float64)
        if len(path) == 0:
            raise NoValidCommand(f"{self._settings.name}: the path is empty")
        pose, twist = observation.pose, observation.twist
        state = np.array((pose.x, pose.y, pose.theta, twist.vx, twist.vy, twist.wz))
        if not np.isfinite(state).all():
            raise NoValidCommand(f"{self._settings.name}: pose or twist is not finite")
        looking = self._settings.looking
        people = nearest_people(observation, state, looking.people, self._rules.horizon)
        window = without_discs(
            window_of(observation.local_map), people[:, :2].copy(), people[:, 4].copy(), looking.erase_margin
        )
        target = lookahead_target(path, window, self._outline, pose.x, pose.y, self._rules.lookahead)
        bearing = math.atan2(target[1] - pose.y, target[0] - pose.x)
        wanted = np.ascontiguousarray(
            velocity_commands(self._kinds, self._robot, self._vy_max, self._wz_max, pose.theta, bearing)
        )
        rows = np.empty((1 + self.actions, self.size), np.float32)
        gains, weights, allowed = np.empty(self.actions), np.empty(self.actions), np.empty(self.actions, np.bool_)
        evaluate_actions(
            window, self._outline, target, state, people, wanted, self._rules, rows, gains, weights, allowed
        )
        return ActionLookahead(rows[0], rows[1:], gains, weights, allowed, wanted)

    def layout(self) -> tuple[ObservationField, ...]:
        """Return the fields of a row."""
        own = (
            ObservationField(
                "goal_way", 1, "-", 0.0, 2.0, f"way to the goal by way of the target, over {GOAL_WAY:g} m"
            ),
            ObservationField("target_way", 1, "-", 0.0, 2.0, f"way to the target, over {TARGET_WAY:g} m"),
            ObservationField(
                "velocity", 2, "-", -2.0, 2.0, "along and across the direction of the target, over the greatest"
            ),
            ObservationField("turning", 1, "-", -2.0, 2.0, "over the greatest"),
            ObservationField("heading", 2, "-", -1.0, 1.0, "cosine and sine, from the direction of the target"),
            ObservationField(
                "room",
                1 + ROOM_POINTS,
                "-",
                0.0,
                1.0,
                f"walls' distance less the circle within the footprint, over {ROOM:g} m, "
                f"here and {self._rules.room_radius:g} m off",
            ),
        )
        meaning = f"place over {PERSON_WAY:g} m, velocity over {PERSON_SPEED:g} m/s, radius in m, gap over {GAP:g} m, 1"
        people = range(1, self._settings.looking.people + 1)
        return (
            *own,
            *(
                ObservationField(f"person_{k}", PERSON, "-", -2.0, 2.0, f"{meaning}; zeros where there is none")
                for k in people
            ),
        )


def nearest_people(observation: Observation, state: Floats, most: int, horizon: float) -> Floats:
    """Return rows (x, y, vx, vy, radius) of the ``most`` tracks nearest to the robot, nearest first.

    Velocities lead to where each is expected in ``horizon`` s, as far as one step looks ahead.
    """
    tracks = observation.tracks
    gaps = np.hypot(*(tracks.positions - state[:2]).T) - tracks.radii
    chosen = np.argsort(gaps, kind="stable")[:most]
    velocities = observation.predictions.take(chosen).mean_velocities(np.full(len(chosen), horizon))
    return np.column_stack((tracks.positions[chosen], velocities, tracks.radii[chosen])).astype(np.float64)
