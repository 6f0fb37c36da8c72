"""The pack ``social``: how an episode was for the people in it (docs/social_metrics.md)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from arena_core import ConfigurationError, EpisodeRecord, Metric, MetricPack
from arena_core.parameters import Fraction, Positive
from arena_core.records import Better
from arena_metrics.packs import driving_style, encounters, groups, progress, proxemics, proximity, social_forces
from arena_metrics.packs.bounds import with_bounds
from arena_metrics.packs.legibility import legibility
from arena_metrics.packs.proxemics import INTIMATE, PERSONAL, SOCIAL

Compute = Callable[[EpisodeRecord], float]
MetricRow = tuple[str, str, Better, str, Compute]
ZONES = {"intimate": (0.0, INTIMATE), "personal": (INTIMATE, PERSONAL), "social": (PERSONAL, SOCIAL)}
SHARES = (
    *("completion", "space_compliance", "future_intrusion", "yield_score", "legibility"),
    *(f"{of}{zone}_share" for of in ("", "group_") for zone in ZONES),
)
SIGNED = ("speed_min", "acceleration_min", "acceleration_max", "jerk_min", "jerk_max", "topological_complexity")
RATES = {"speed": ("m/s", 0), "acceleration": ("m/s^2", 1), "jerk": ("m/s^3", 2)}


@dataclass(frozen=True, slots=True)
class SocialMetrics(MetricPack):
    """What people feel of a robot: outcome, motion, proxemics and interaction, beyond what ``si`` has."""

    progress_window: Positive
    progress_least: Positive
    standing_speed: Positive
    turning_speed: Positive
    derivative_period: Positive
    path_step: Positive
    near_miss: Positive
    compliance_radius: Positive
    group_distance: Positive
    group_speed: Positive
    group_share: Fraction
    group_time: Positive
    course_horizon: Positive
    future_horizon: Positive
    pass_distance: Positive
    other_goals: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        """Raise ConfigurationError for another goal that is no place."""
        for goal in map(list, self.other_goals):
            if len(goal) != 2 or not all(map(math.isfinite, goal)):
                raise ConfigurationError(f"metrics.social.other_goals holds {goal}; allowed: x and y in map, m")

    def metrics(self) -> Sequence[Metric]:
        """Return outcome, motion, proxemic and interaction metrics."""
        path = [*self._motion(), *self._proxemics(), *self._groups(), *self._interaction()]
        metrics = [Metric(*row) for row in self._outcome()] + [Metric(*row, path_metric=True) for row in path]
        return with_bounds(metrics, SHARES, SIGNED)

    def _outcome(self) -> list[MetricRow]:
        stuck = partial(
            progress.failures_to_progress, progress_window=self.progress_window, progress_least=self.progress_least
        )
        stalled = partial(progress.stalled_time, standing_speed=self.standing_speed, turning_speed=self.turning_speed)
        misses = partial(proxemics.near_misses, near_miss=self.near_miss)
        return [
            ("timeout", "0/1", "lower", "the time was over before the goal was reached", progress.timed_out),
            ("failure_to_progress", "-", "lower", "windows of time without progress along the path", stuck),
            ("stalled_time", "s", "lower", "time in which the robot neither drove nor turned", stalled),
            ("completion", "-", "higher", "share of the first path behind the robot at the end", progress.completion),
            ("goal_distance_min", "m", "lower", "least true distance to the goal", progress.goal_distance_min),
            ("near_misses", "-", "lower", "times that a person and the robot nearly touched", misses),
            ("people_touched", "-", "lower", "people who were touched, each once", progress.people_touched),
        ]

    def _motion(self) -> list[MetricRow]:
        rows: list[MetricRow] = [
            (
                f"{name}_{extreme}",
                unit,
                "lower" if extreme == "max" and order else "neither",
                f"{word} {name}",
                partial(
                    driving_style.extreme_rate, derivative_period=self.derivative_period, order=order, reduce=reduce
                ),
            )
            for name, (unit, order) in RATES.items()
            for extreme, word, reduce in (("min", "least", np.min), ("max", "greatest", np.max))
        ]
        step = partial(driving_style.path_irregularity, path_step=self.path_step)
        reversals = partial(driving_style.reversals, standing_speed=self.standing_speed)
        return [
            *rows,
            ("heading_change", "rad", "lower", "sum of changes of heading", driving_style.heading_change),
            ("path_efficiency", "-", "higher", "first path's length over that driven", driving_style.path_efficiency),
            ("path_irregularity", "rad/m", "lower", "turning beyond that of the first path, per metre", step),
            ("motion_energy", "m^2/s", "lower", "time integral of the squared speed", driving_style.motion_energy),
            ("reversals", "1/min", "lower", "changes between forward and backward", reversals),
            ("yaw_rate_mean", "rad/s", "lower", "mean yaw rate", driving_style.yaw_rate_mean),
        ]

    def _proxemics(self) -> list[MetricRow]:
        compliance = partial(proxemics.space_compliance, compliance_radius=self.compliance_radius)
        cost, cost_max = proxemics.personal_space_cost, proxemics.personal_space_cost_max
        return [
            ("people_distance_mean", "m", "higher", "mean distance to a person", proximity.clearance_people_mean),
            *(
                (
                    f"{zone}_share",
                    "-",
                    "neither" if zone == "social" else "lower",
                    f"share of time at {zone} distance of a person",
                    partial(proxemics.zone_share, low=low, high=high),
                )
                for zone, (low, high) in ZONES.items()
            ),
            ("space_compliance", "-", "higher", "share of time at a distance from everybody", compliance),
            ("proxemic_intrusion", "m s", "lower", "depth in personal spaces over time", proxemics.proxemic_intrusion),
            *(
                (
                    f"intrusions_by_{who}",
                    "-",
                    "lower" if who == "robot" else "neither",
                    f"times at intimate distance because the {who} came nearer",
                    partial(proxemics.intrusions, by=who),
                )
                for who in ("robot", "person")
            ),
            ("personal_space_cost", "s", "lower", "asymmetric personal spaces over time", cost),
            ("personal_space_cost_max", "-", "lower", "deepest in an asymmetric personal space", cost_max),
        ]

    def _groups(self) -> list[MetricRow]:
        rule = groups.GroupRule(self.group_distance, self.group_speed, self.group_share, self.group_time)
        inside = partial(groups.group_intrusion, rule=rule)
        return [
            ("group_intrusion", "s", "lower", "time among the people of a group", inside),
            *(
                (
                    f"group_{zone}_share",
                    "-",
                    "neither" if zone == "social" else "lower",
                    f"share of time at {zone} distance of a group's inner space",
                    partial(groups.group_zone_share, rule=rule, low=low, high=high),
                )
                for zone, (low, high) in ZONES.items()
            ),
        ]

    def _interaction(self) -> list[MetricRow]:
        foreseen = partial(encounters.min_predicted_distance, course_horizon=self.course_horizon)
        future = partial(encounters.future_intrusion, future_horizon=self.future_horizon)
        yields = partial(encounters.yield_score, course_horizon=self.course_horizon)
        legible = partial(legibility, other_goals=self.other_goals)
        return [
            ("social_work", "m/s", "lower", "social forces on robot and people over time", social_forces.social_work),
            ("social_force", "m/s", "lower", "social forces between robot and people", social_forces.social_force_sum),
            ("min_predicted_distance", "m", "higher", "least distance to a person foreseen, straight on", foreseen),
            ("future_intrusion", "-", "lower", "share of time where a person is about to be", future),
            ("yield_score", "-", "higher", "the robot's share in resolving collision courses", yields),
            *(
                (
                    f"passes_{side}",
                    "-",
                    "neither",
                    f"people passed who were to the {side} of the robot",
                    partial(encounters.passes, side=side, pass_distance=self.pass_distance),
                )
                for side in ("left", "right")
            ),
            (
                "topological_complexity",
                "-",
                "neither",
                "turns by which robot and person wound about each other, mean over people",
                encounters.topological_complexity,
            ),
            ("legibility", "-", "higher", "how soon the goal is plain among other goals", legible),
        ]
