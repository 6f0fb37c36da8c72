"""The numbers of rewards by term, as their constructors group them; in the YAML they stand side by side."""

from __future__ import annotations

from dataclasses import dataclass

from arena_core.parameters import NonNegative, Positive


@dataclass(frozen=True, slots=True)
class Ending:
    """What reaching the goal earns, and what a contact costs."""

    goal: NonNegative
    collision: NonNegative


@dataclass(frozen=True, slots=True)
class Nearness:
    """What a step costs on which something is nearer than ``safe_distance`` radii from the robot's centre."""

    safe_distance: Positive
    near: NonNegative


@dataclass(frozen=True, slots=True)
class GoalProgress:
    """What coming nearer to the goal earns and going away from it costs, 1/m."""

    progress: NonNegative
    regress: NonNegative


@dataclass(frozen=True, slots=True)
class PathProgress:
    """What is earned for each metre less of the path and beside it, and what each metre driven costs, 1/m."""

    progress: NonNegative
    beside: NonNegative
    way: NonNegative


@dataclass(frozen=True, slots=True)
class NearnessToPeople:
    """What clearance of people costs where it is less than ``people_distance`` m, in proportion to what is missing."""

    people_distance: Positive
    near_people: NonNegative


@dataclass(frozen=True, slots=True)
class Effort:
    """What a step costs, and sudden changes of the command, as shares of the greatest speeds, squared."""

    time: NonNegative
    change_of_speed: NonNegative
    change_of_turning: NonNegative


@dataclass(frozen=True, slots=True)
class Pace:
    """What a second on the path at the robot's greatest speed earns and what any second costs, 1/s; how many such
    seconds the goal is worth, and a contact costs, s; ``scale`` times all terms, 1/s.
    """

    scale: Positive
    goal: NonNegative
    collision: NonNegative
    progress: NonNegative
    time: NonNegative


@dataclass(frozen=True, slots=True)
class ClearanceCosts:
    """What a second costs on which something is nearer than ``safe_distance`` radii from the robot's centre, and one
    on which a person touches it, 1/s; the latter in proportion to what is missing of ``people_distance`` m.
    """

    safe_distance: Positive
    near: NonNegative
    people_distance: Positive
    near_people: NonNegative


@dataclass(frozen=True, slots=True)
class ChangeOfCommand:
    """What sudden changes of the command cost, as shares of the greatest speeds, squared."""

    change_of_speed: NonNegative
    change_of_turning: NonNegative


@dataclass(frozen=True, slots=True)
class Consumption:
    """What speed costs (s/m), and how much turning weighs in it (m/rad)."""

    consumption: NonNegative
    consumption_of_turning: NonNegative


@dataclass(frozen=True, slots=True)
class Following:
    """What speed on the path earns (s/m), on it being within so many m; coming nearer to it and leaving it, 1/m."""

    following: NonNegative
    following_within: Positive
    nearer_to_path: NonNegative
    farther_from_path: NonNegative


@dataclass(frozen=True, slots=True)
class Smoothness:
    """What the fourth power of changes of the command costs, and driving backwards, where nothing is near."""

    smooth_beyond: NonNegative
    change_of_vx: NonNegative
    change_of_vy: NonNegative
    change_of_wz: NonNegative
    reverse: NonNegative


@dataclass(frozen=True, slots=True)
class AmongPeople:
    """Where people are nearer than ``people_distance`` m to the robot's centre, other progress counts, 1/m."""

    people_distance: Positive
    progress_near_people: NonNegative
    regress_near_people: NonNegative
