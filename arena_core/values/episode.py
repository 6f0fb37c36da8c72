"""One problem (Scenario), one run of it (EpisodeRecord), and what is true meanwhile (WorldState)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from arena_core.values.company import Company
from arena_core.values.doors import Door
from arena_core.values.errands import Errands
from arena_core.values.geometry import Pose, Twist
from arena_core.values.recorded_walk import RecordedWalk
from arena_core.values.robot import Robot
from arena_core.values.world import Obstacle, OccupancyGrid, Pedestrians, PedestrianSpec, World

Outcome = Literal["goal_reached", "false_arrival", "time_out", "collision", "error"]
ContactWith = Literal["wall", "obstacle", "person", "robot"]


@dataclass(frozen=True, slots=True)
class Member:
    """A teammate of a scenario's first robot: where it starts and what it is to reach, in ``map``.

    ``name`` tells it from the others. ``planner`` and ``robot`` are options of ``planner=`` and ``robot=``; empty:
    those that the run chooses. ``body`` is that robot, once it is looked up; None: the run's.
    """

    name: str
    start: Pose
    goal: Pose
    planner: str = ""
    robot: str = ""
    body: Robot | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Scenario:
    """One concrete problem: everything that every planner faces alike.

    ``seed`` and ``name`` key every random stream of the episode. ``goal_radius`` m, ``time_limit`` s. The goal's
    heading does not count for arrival. ``reference_length`` m is that of a known way from start to goal; None where no
    such way is known. ``speed_share`` of its own speed limits is what the robot may drive, whatever is commanded.
    ``stage`` is the level of a staged task. ``content_hash`` names the content of the scenario's file or pack; empty
    where it was drawn. ``company`` is the person whom the robot is to keep with: its goal then moves, and ``goal`` is
    where the two end; None in a task that is a goal. ``replaces`` is the walk of the recorded person whose place the
    robot takes, if it takes one. ``doors`` open and close by their timetables. ``team`` are the robots beside the first
    one, in their order: robot m of a team is ``team[m - 1]``; empty where the robot is alone. ``errands`` send a team
    from place to place until the time limit; None where each robot has one goal.
    """

    name: str
    seed: int
    world: World
    start: Pose
    goal: Pose
    pedestrians: tuple[PedestrianSpec, ...]
    obstacles: tuple[Obstacle, ...]
    goal_radius: float
    time_limit: float
    reference_length: float | None = None
    speed_share: float = 1.0
    stage: int | None = None
    content_hash: str = ""
    company: Company | None = None
    replaces: RecordedWalk | None = None
    doors: tuple[Door, ...] = ()
    team: tuple[Member, ...] = ()
    errands: Errands | None = None

    @property
    def robots(self) -> int:
        """Return how many robots there are."""
        return 1 + len(self.team)

    def seen_by(self, member: int) -> Scenario:
        """Return the scenario as robot ``member`` of the team faces it: its own start and goal, under a name that keys
        random streams of its own. The first robot's is this one without its team.
        """
        if member == 0:
            return replace(self, team=())
        own = self.team[member - 1]
        named = f"{self.name}/robot{member}"
        return replace(self, name=named, start=own.start, goal=own.goal, reference_length=None, team=())


@dataclass(frozen=True, slots=True)
class Contact:
    """The rising edge of a contact: ``stamp`` s, with what, closing speed m/s, where the robot was (x, y in ``map``,
    m). ``person`` is the number of the person, or of the other robot in its team, -1 for what stands.

    ``caused`` is true when the robot moved into the other, false when the other moved into it; of two robots both may
    have.
    """

    stamp: float
    kind: ContactWith
    person: int
    speed: float
    caused: bool
    x: float
    y: float


def _no_doors() -> NDArray[np.bool_]:
    return np.zeros(0, np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class WorldState:
    """The truth at one control step; no part of it ever reaches the navigator.

    ``twist`` is in ``base_link``. ``clearance`` is the distance from the footprint to the nearest wall, obstacle,
    person or other robot, ``clearance_people`` to the nearest person (inf when there is none), m. ``contacts`` are the
    rising edges since the state before, ``contact_time`` the seconds in contact since then. ``doors_open`` (D,) are the
    scenario's doors that are open.
    """

    stamp: float
    pose: Pose
    twist: Twist
    pedestrians: Pedestrians
    clearance: float
    clearance_people: float
    in_contact: bool
    contact_time: float
    contacts: tuple[Contact, ...]
    doors_open: NDArray[np.bool_] = field(default_factory=_no_doors)


@dataclass(frozen=True, slots=True, eq=False)
class EpisodeStart:
    """What a planner is told before an episode; ``map`` is None in an unknown world, ``control_period`` is in s.

    ``random`` is the planner's own stream, keyed by the scenario.
    """

    map: OccupancyGrid | None
    goal: Pose
    control_period: float
    random: np.random.Generator


DRIVER = "driver"  # kind of the event that says which member of a switch drives from then on


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened at ``stamp`` (s): ``kind`` is ``replan``, ``no_valid_command`` or ``driver``,
    ``detail`` says why, or who.
    """

    stamp: float
    kind: str
    detail: str


@dataclass(frozen=True, slots=True, eq=False)
class EpisodeRecord:
    """One finished episode: per-step arrays, events and what identifies it (docs/records.md lists every array).

    ``arrays`` hold T rows, one a control step, the last one the final state; ``meta`` is plain JSON.
    """

    arrays: Mapping[str, NDArray[Any]]
    meta: Mapping[str, Any]
    timing: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.arrays[name]

    def teammate_poses(self) -> NDArray[np.float64]:
        """Return where the other robots of its team, M in all, were at its control steps: (T, M - 1, 3) in ``map``."""
        if "team_pose" not in self.arrays:
            return np.empty((len(self["stamp"]), 0, 3))
        steps = np.searchsorted(self["team_stamp"], np.asarray(self["stamp"]) - 1e-9)
        return np.delete(np.asarray(self["team_pose"], np.float64)[steps], self.meta["team"]["member"], axis=1)

    def teammates(self) -> list[Mapping[str, Any]]:
        """Return what the record tells of the other robots of its team, as ``meta["team"]["robots"]`` has them."""
        team = self.meta.get("team") or {"robots": ()}
        return [robot for member, robot in enumerate(team["robots"]) if member != team["member"]]
