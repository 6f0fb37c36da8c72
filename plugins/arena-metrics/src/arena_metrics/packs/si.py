"""The pack ``si``: every figure in SI units, from the truth, with its edge cases defined (docs/metrics.md)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from arena_core import EpisodeRecord, Metric, MetricPack
from arena_core.parameters import Positive
from arena_core.records import Better
from arena_metrics.packs import collision_courses, motion, outcome, proximity, timing
from arena_metrics.packs.bounds import with_bounds


def _path_metric(
    name: str, unit: str, better: Better, description: str, compute: Callable[[EpisodeRecord], float]
) -> Metric:
    """Make a metric of the path driven, which says little where the episode failed."""
    return Metric(name, unit, better, description, compute, path_metric=True)


@dataclass(frozen=True, slots=True)
class SiMetrics(MetricPack):
    """Metrics in SI units."""

    bare = True

    path_step: Positive
    derivative_period: Positive
    personal_space: Positive
    encounter_distance: Positive
    stand_radius: Positive
    standing_speed: Positive
    course_horizon: Positive
    course_time: Positive
    reaction_gain: Positive

    def metrics(self) -> Sequence[Metric]:
        """Return outcome, motion, proximity, navigation and timing metrics."""
        metrics = [
            *self._outcome_metrics(),
            *self._motion_metrics(),
            *self._proximity_metrics(),
            *self._navigation_metrics(),
            *_timing_metrics(),
        ]
        return with_bounds(metrics, shares=("spl", "reverse_share"))

    def _outcome_metrics(self) -> list[Metric]:
        return [
            Metric(
                "success",
                "0/1",
                "higher",
                "goal truly reached, in time, with fewer than two collisions",
                outcome.episode_success,
            ),
            Metric("strict_success", "0/1", "higher", "success without any collision", outcome.strict_success),
            Metric("spl", "-", "higher", "success weighted by path length", outcome.spl_value),
            Metric("collisions", "-", "lower", "contacts with walls, obstacles and people", outcome.collision_count),
            Metric(
                "collisions_caused",
                "-",
                "lower",
                "contacts in which the robot moved into the other",
                outcome.collisions_caused,
            ),
            Metric("collisions_people", "-", "lower", "contacts with people", outcome.collisions_people),
            Metric(
                "collisions_people_caused",
                "-",
                "lower",
                "those in which the robot moved into the person",
                outcome.collisions_people_caused,
            ),
            Metric("collisions_static", "-", "lower", "contacts with walls and obstacles", outcome.collisions_static),
            Metric("contact_time", "s", "lower", "time in contact", outcome.contact_time),
            Metric("impact_speed", "m/s", "lower", "highest closing speed at a contact", outcome.impact_speed),
            Metric("goal_error", "m", "lower", "true distance to the goal at the end", outcome.goal_error),
            _path_metric(
                "time_to_goal", "s", "lower", "time until arrival, where the goal was reached", outcome.time_to_goal
            ),
        ]

    def _motion_metrics(self) -> list[Metric]:
        step, period = self.path_step, self.derivative_period
        reverse = partial(motion.reverse_share, standing_speed=self.standing_speed)
        return [
            _path_metric("path_length", "m", "lower", "length of the true path", motion.path_length),
            _path_metric("velocity", "m/s", "higher", "path length over time", motion.mean_speed),
            _path_metric(
                "acceleration",
                "m/s^2",
                "lower",
                "mean acceleration",
                partial(motion.mean_acceleration, derivative_period=period),
            ),
            _path_metric("jerk", "m/s^3", "lower", "mean jerk", partial(motion.mean_jerk, derivative_period=period)),
            _path_metric(
                "jerk_without_contact",
                "m/s^3",
                "lower",
                "mean jerk while nothing is touched",
                partial(motion.jerk_without_contact, derivative_period=period),
            ),
            _path_metric("reverse_share", "-", "lower", "share of time driven backwards", reverse),
            _path_metric(
                "curvature_mean",
                "1/m",
                "lower",
                "mean Menger curvature",
                partial(motion.curvature_mean, path_step=step),
            ),
            _path_metric(
                "curvature_max",
                "1/m",
                "lower",
                "greatest Menger curvature",
                partial(motion.curvature_max, path_step=step),
            ),
            _path_metric(
                "curvature_min",
                "1/m",
                "neither",
                "least Menger curvature",
                partial(motion.curvature_min, path_step=step),
            ),
            _path_metric(
                "curvature_normalised",
                "-",
                "lower",
                "curvature times chords",
                partial(motion.curvature_normalised, path_step=step),
            ),
            _path_metric(
                "angle_over_length",
                "rad/m",
                "lower",
                "change of heading per metre",
                partial(motion.angle_over_length, path_step=step),
            ),
            _path_metric(
                "roughness",
                "-",
                "lower",
                "height over base of the path's triangles",
                partial(motion.path_roughness, path_step=step),
            ),
        ]

    def _proximity_metrics(self) -> list[Metric]:
        intrusion = partial(proximity.personal_space_time, personal_space=self.personal_space)
        collision = partial(collision_courses.time_to_collision_min, course_horizon=self.course_horizon)
        reaction = partial(
            collision_courses.reaction_distance,
            course_horizon=self.course_horizon,
            course_time=self.course_time,
            reaction_gain=self.reaction_gain,
            standing_speed=self.standing_speed,
        )
        encounters = partial(proximity.encounter_count, encounter_distance=self.encounter_distance)
        return [
            _path_metric(
                "clearance_mean",
                "m",
                "higher",
                "mean distance from footprint to nearest thing",
                proximity.clearance_mean,
            ),
            _path_metric(
                "clearance_max",
                "m",
                "neither",
                "greatest distance from footprint to nearest thing",
                proximity.clearance_max,
            ),
            _path_metric(
                "clearance_min",
                "m",
                "higher",
                "least distance from footprint to nearest thing",
                proximity.clearance_min,
            ),
            _path_metric(
                "clearance_normalised", "-", "higher", "mean clearance in robot radii", proximity.clearance_normalised
            ),
            _path_metric(
                "clearance_people_min",
                "m",
                "higher",
                "least distance from footprint to a person",
                proximity.clearance_people_min,
            ),
            _path_metric("personal_space_time", "s", "lower", "time within a person's personal space", intrusion),
            _path_metric("encounters", "-", "neither", "times that a person came near", encounters),
            _path_metric(
                "time_to_collision_min",
                "s",
                "higher",
                "least time to a collision with a person, straight on",
                collision,
            ),
            _path_metric(
                "reaction_distance",
                "m",
                "neither",
                "distance at which the robot first reacts to people on a collision course",
                reaction,
            ),
            Metric(
                "people_per_100m2",
                "-",
                "neither",
                "people present per 100 m2 of free ground",
                proximity.people_per_100m2,
            ),
        ]

    def _navigation_metrics(self) -> list[Metric]:
        stand = partial(motion.longest_stand, stand_radius=self.stand_radius)
        return [
            Metric("no_valid_command", "-", "lower", "control steps without a valid command", outcome.rejected_steps),
            Metric("replans", "-", "lower", "global paths asked for after the first", outcome.replan_count),
            Metric("recoveries", "-", "lower", "recovery behaviours tried", outcome.recovery_count),
            Metric("longest_stand", "s", "lower", "longest time in one place", stand),
            Metric(
                "localization_error",
                "m",
                "lower",
                "mean distance between estimated and true position",
                outcome.localization_error,
            ),
        ]


def _timing_metrics() -> list[Metric]:
    """Return what differs from run to run, all with one prefix: wall and CPU time of the planner, and of
    what else the navigator does.
    """
    wall, cpu = "wall time", "CPU time, all threads,"
    return [
        Metric(
            "planning_time_mean",
            "ms",
            "lower",
            f"mean {wall} of the local planner alone",
            partial(timing.mean_time, part="planner"),
        ),
        Metric(
            "planning_cpu_mean",
            "ms",
            "lower",
            f"mean {cpu} of the local planner alone",
            partial(timing.mean_time, part="planner_cpu"),
        ),
        Metric(
            "planning_episode_time",
            "s",
            "lower",
            f"{wall} of the whole episode, from the scenario to the record",
            partial(timing.total_time, part="episode"),
        ),
        Metric(
            "planning_episode_cpu",
            "s",
            "lower",
            f"{cpu} of the whole episode, likewise",
            partial(timing.total_time, part="episode_cpu"),
        ),
        *(
            Metric(
                f"planning_{clock}_p{percent}",
                "ms",
                "lower",
                f"{percent}th percentile of the local planner's {words}",
                partial(timing.time_percentile, part=part, percent=percent),
            )
            for percent in (95, 99)
            for clock, words, part in (("time", wall, "planner"), ("cpu", "CPU time", "planner_cpu"))
        ),
        *(
            Metric(
                f"planning_{part}_{clock}",
                "ms",
                "lower",
                f"mean {words} of {what}",
                partial(timing.mean_time, part=f"{part}{suffix}"),
            )
            for part, what in (
                ("local_map", "the local map"),
                ("tracker", "the tracker"),
                ("navigator", "the whole control step"),
            )
            for clock, words, suffix in (("time", wall, ""), ("cpu", cpu, "_cpu"))
        ),
    ]
