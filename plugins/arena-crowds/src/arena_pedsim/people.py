"""What the model remembers of each person beside the crowd's own arrays: constants, the way being walked, clocks."""

from __future__ import annotations

import numpy as np

from arena_core import PedestrianSpec
from arena_pedsim.parameters import ForceFactors

NOTHING, NEXT_WAYPOINT, NEW_ROUTE = 0, 1, 2  # what a person wishes of the route planner
COME, LEAVE = 3, 4  # and of the world
NEVER, AT_START, AT_RANDOM = 0, 1, 2  # where who has ended the round comes back
NO_ERRAND, ON_ERRAND, BACK_FROM_ERRAND = 0, 1, 2
MAX_CORNERS = 24  # of one route; a longer one is planned again on arrival at the last of them

PERSON = np.dtype(
    [
        ("walking_speed", np.float64),  # m/s, desired when walking; each state has its share of it
        ("max_speed", np.float64),  # m/s, that nothing makes the person exceed in the present state
        ("factor_desired", np.float64),
        ("factor_social", np.float64),
        ("factor_obstacle", np.float64),
        ("factor_robot", np.float64),
        ("goal_x", np.float64),  # where the present waypoint can be reached
        ("goal_y", np.float64),
        ("look_clock", np.float64),  # s since the way ahead was looked at
        ("stuck_clock", np.float64),  # s since the person was at (anchor_x, anchor_y)
        ("anchor_x", np.float64),
        ("anchor_y", np.float64),
        ("opposed", np.int32),  # 1: stands face to face with a person, and is the one of the two who turns round
        ("share", np.float64),  # of the repulsions of others that this person feels
        ("errand_x", np.float64),  # where to on an errand, instead of the waypoint
        ("errand_y", np.float64),
        ("push_x", np.float64),  # m/s^2, by the person's group, if ``pushing`` is 1
        ("push_y", np.float64),
        ("waypoint", np.int32),  # index of the present waypoint
        ("waypoints", np.int32),  # number of them
        ("corner", np.int32),  # index of the next corner of the route; ``corners`` of them, then comes the goal
        ("corners", np.int32),
        ("wish", np.int32),
        ("waiting", np.int32),  # 1: the route leads through a door that is closed
        ("lost", np.int32),  # 1: there is no way to the waypoint, so the person walks straight at it
        ("waypoint_mode", np.int32),  # 0: in a loop, 1: at random
        ("legs", np.int32),  # number of waypoints walked to so far
        ("errand", np.int32),  # NO_ERRAND, ON_ERRAND, or BACK_FROM_ERRAND until the route to the waypoint is there
        ("kept", np.int32),  # 1: ``corners`` are still those of the way that the errand interrupted
        ("pushing", np.int32),
        ("party", np.int32),  # number of those who do not push each other at a distance: of two who talk, of a group
        ("gives_way", np.int32),  # 1: sees the robot at all
        # in which the person reacts to the robot, NONE when it does no more than give way
        ("reaction_state", np.int32),
        ("mass", np.float64),
        ("sociable", np.int32),  # 1: takes part in social states
        ("sees_robot", np.int32),  # 1: did when it last looked, and ``watched`` was the robot's place in its team
        ("watched", np.int32),
        ("glance_clock", np.float64),  # s since then
        ("sight", np.float64),  # m, how far it sees the robot
        ("stop_distance", np.float64),  # m to the robot
        ("pace", np.float64),  # m/s while it reacts
        ("fear", np.float64),  # m^2/s^2
        ("interest", np.float64),  # s that a reaction lasts, and ``interest_left`` of it
        ("interest_left", np.float64),
        ("pause", np.float64),  # s until it may begin again, and ``pause_left`` of it
        ("pause_left", np.float64),
        ("start_x", np.float64),
        ("start_y", np.float64),
        ("absence", np.float64),  # s until the person may come
        ("respawn", np.int32),  # whether and where who has ended the round comes back
        ("draws", np.int32),  # places drawn so far
        ("stay_chance", np.float64),  # that the person stays at a waypoint, and for how long on average, s
        ("stay_time", np.float64),
        ("stay", np.float64),  # s at the present waypoint, once it is reached
        ("key", np.uint64),  # of these draws, and of those of waypoints and stays
    ],
    align=True,
)


def person_memory(spec: PedestrianSpec, factors: ForceFactors) -> np.void:
    """Return the memory of a person who is about to start."""
    person: np.void = np.zeros(1, PERSON)[0]
    person["walking_speed"] = person["max_speed"] = spec.desired_speed
    share = 1.0 if factors.reference_speed is None else spec.desired_speed / factors.reference_speed
    person["factor_desired"] = _force_factor(spec, "force_factor_desired", factors.desired)
    person["factor_social"] = share * _force_factor(spec, "force_factor_social", factors.social)
    person["factor_obstacle"] = share * _force_factor(spec, "force_factor_obstacle", factors.obstacle)
    person["factor_robot"] = share * _force_factor(spec, "force_factor_robot", factors.robot)
    for place in ("goal", "anchor", "start"):
        person[f"{place}_x"], person[f"{place}_y"] = spec.position_xy
    person["waypoints"] = len(spec.waypoints_xy)
    person["waypoint"], person["share"] = -1, share
    person["waypoint_mode"] = spec.behaviour.get("waypoint_mode", 0)
    person["stay_chance"], person["stay_time"] = (
        spec.behaviour.get("pause_probability", 0.0),
        spec.behaviour.get("pause_time", 0.0),
    )
    person["wish"] = NEXT_WAYPOINT if len(spec.waypoints_xy) else NOTHING
    return person


def _force_factor(spec: PedestrianSpec, key: str, default: float) -> float:
    return float(spec.behaviour.get(key, default))
