"""The robot's brain: from sensors to a velocity command, the same in 2-D, in 3-D and on a real robot."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from arena_core.base.errors import InvalidCommand, NoValidCommand, describe_error, one_line
from arena_core.base.once import Once
from arena_core.base.pulse import pulse
from arena_core.base.stopwatch import NOTHING, Duration, Stopwatch, Timed
from arena_core.contracts.navigation import Planner
from arena_core.contracts.truth import Truth
from arena_core.loop.extras import kept_candidates
from arena_core.loop.guide import Guide, GuideParts, Mission, ReplanRules
from arena_core.loop.observing import shown_pose
from arena_core.loop.recovery import RecoveryRules
from arena_core.values.candidate import Candidate
from arena_core.values.episode import DRIVER, EpisodeStart, Event
from arena_core.values.geometry import Pose, Twist
from arena_core.values.sensing import Observation, PoseEstimate, Sensors, Tracks
from arena_core.values.world import Path

BRAKE = Twist(0.0, 0.0, 0.0)
NAME_LENGTH = 60  # characters of a member's name
# what a planner's configuration may say of its navigator
NAVIGATOR_KEYS = ("control_period", "passage_margin", "replan", "recoveries")


@dataclass(frozen=True, slots=True)
class Spent:
    """What one control step took, s, never part of a record: the planner's wall and CPU time, the whole navigator's
    wall time.

    Local map and tracker are computed when first asked for; they count apart, also where the planner asked. So
    ``planner`` is its own.
    """

    planner: float
    planner_cpu: float
    navigator: float
    navigator_cpu: float = 0.0
    local_map: float = 0.0
    local_map_cpu: float = 0.0
    tracker: float = 0.0
    tracker_cpu: float = 0.0

    @staticmethod
    def of(parts: Mapping[str, Duration]) -> Spent:
        """Return what a step took from its parts: ``planner``, ``local_map``, ``tracker`` and the rest."""
        whole = sum(part.wall for part in parts.values()), sum(part.cpu for part in parts.values())
        get = parts.get
        return Spent(*get("planner", NOTHING), *whole, *get("local_map", NOTHING), *get("tracker", NOTHING))


NO_TIME = Spent(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """One control step of the navigator.

    ``command`` is what to send; ``arrived`` is judged on the estimate. ``planned`` is the path if it is new, else None,
    ``tracks`` what the tracker believed where it was asked for. ``compiled``: a kernel was compiled on the way, so that
    ``spent`` is no time of the planner's.
    """

    command: Twist
    estimate: PoseEstimate
    waypoint: Pose
    planned: Path | None
    arrived: bool
    events: tuple[Event, ...]
    spent: Spent
    tracks: Tracks | None = None
    compiled: bool = False


# a decision but for its time and tracks
Decided = tuple[Twist, PoseEstimate, Pose, Path | None, bool, tuple[Event, ...]]


class Navigator(Guide):
    """One robot's brain: what guides it, and the planner that decides."""

    def __init__(
        self,
        parts: GuideParts,
        planner: Planner,
        replan: ReplanRules,
        recoveries: RecoveryRules,
        control_period: float,
    ) -> None:
        super().__init__(parts, replan, recoveries, control_period)
        self.planner = planner
        self._rehearsed = not planner.compiles
        self._driver: str | None = None

    def reset(self, mission: Mission, truth: Truth | None = None) -> None:
        """Begin an episode; nothing of the one before is kept. Privileged parts are shown the ``truth``."""
        super().reset(mission, truth)
        self._driver = None
        self.planner.reset(
            EpisodeStart(self._shown_map, shown_pose(mission.goal), self.control_period, self._random_stream("planner"))
        )

    def rehearse(self, sensors: Sensors) -> None:
        """Let a planner that compiles decide once for nothing, so that no compiler's time counts
        as its own; begin the episode again.
        """
        if self._rehearsed:
            return
        self._rehearsed = True
        with suppress(Exception):  # what is wrong will be wrong again, and is then reported
            self.decide(sensors)
        self.reset(self.mission, self._truth)

    def fork(self, truth: Truth | None = None) -> Navigator:
        """Return a navigator of its own that goes on as this one would: a deep copy.

        A component shares what never changes by its ``__deepcopy__``, as networks, compiled code and maps do.
        Privileged parts of the copy see the ``truth``, that of another world which it goes on in; without one, still
        that of the first.
        """
        forked = deepcopy(self)
        if truth is not None:
            forked.see(truth)
        return forked

    def command(self, sensors: Sensors) -> Twist:
        """Return the velocity to send now."""
        return self.decide(sensors).command

    def decide(self, sensors: Sensors) -> Decision:
        """Localise, recover if there is no progress, plan where needed, choose a waypoint and ask the planner.

        Raises NoPath when there is no first path, InvalidCommand when the planner returns no finite Twist.
        """
        watch, kernels = Stopwatch(), pulse.compiled()
        decided, tracks = watch.timed("rest", lambda: self._decide_once(sensors, watch.timed))
        self.recoveries.tell(decided[0])
        known = tracks() if tracks is not None and tracks.known else None
        return Decision(*decided, Spent.of(watch.spent), known, pulse.compiled() > kernels)

    def considered(self, decision: Decision) -> list[Candidate]:
        """Return what a record keeps of what the planner weighed for this decision, the last one;
        nothing where it was not asked.
        """
        if decision.spent.planner == 0.0:  # a recovery drives, or the robot has arrived
            return []
        return kept_candidates(self.planner.considered(), type(self.planner).__name__)

    def notes(self) -> Mapping[str, float | str]:
        """Return what the planner tells of the episode, for its record: what is a number or a text, or why there is
        nothing.
        """
        try:
            return checked_notes(self.planner.notes())
        except Exception as error:
            return {"error": describe_error(error)}

    def _decide_once(self, sensors: Sensors, timed: Timed) -> tuple[Decided, Once[Tracks] | None]:
        view = self.look(sensors, timed)
        observation = view.observation
        if observation is None:
            return (BRAKE, view.estimate, view.waypoint, None, view.arrived, ()), None
        recovering = self.recoveries.command(view.estimate.pose, sensors.stamp, view.local_map, view.waypoint)
        if recovering is not None:
            return (recovering, view.estimate, view.waypoint, view.planned, False, view.events), view.tracks
        command, refusals = timed("planner", lambda: self._ask_planner(observation))
        events = view.events + refusals + self._changed_driver(sensors.stamp)
        return (command, view.estimate, view.waypoint, view.planned, False, events), view.tracks

    def _changed_driver(self, stamp: float) -> tuple[Event, ...]:
        """Return the event of a switch whose member that drives is another one than before."""
        before, self._driver = self._driver, self.planner.driving()
        return (
            () if self._driver in (before, None) else (Event(stamp, DRIVER, one_line(str(self._driver), NAME_LENGTH)),)
        )

    def _ask_planner(self, observation: Observation) -> tuple[Twist, tuple[Event, ...]]:
        """Return the planner's command, the brake if it has none, and the event of a refusal."""
        try:
            return check_command(self.planner.compute_velocity(observation), self.planner), ()
        except NoValidCommand as refusal:
            return BRAKE, (Event(observation.stamp, "no_valid_command", str(refusal)),)


def checked_notes(notes: Mapping[str, float | str]) -> dict[str, float | str]:
    """Return a planner's notes as JSON can keep them: names and texts of one line, plain floats, ``inf`` and ``nan`` as
    texts.
    """
    kept: dict[str, float | str] = {}
    for name, value in notes.items():
        if isinstance(value, (int, float, np.floating, np.integer)):
            kept[one_line(name, NAME_LENGTH)] = float(value) if math.isfinite(value) else str(float(value))
        elif isinstance(value, str):
            kept[one_line(name, NAME_LENGTH)] = one_line(value)
    return kept


def check_command(command: object, planner: Planner) -> Twist:
    """Return a planner's command with plain floats; raise InvalidCommand unless it is a finite Twist."""
    name = type(planner).__name__
    if not isinstance(command, Twist):
        raise InvalidCommand(f"{name}.compute_velocity returned {type(command).__name__}; allowed: a Twist")
    values = (command.vx, command.vy, command.wz)
    if not all(isinstance(v, (int, float, np.floating, np.integer)) and math.isfinite(v) for v in values):
        raise InvalidCommand(f"{name}.compute_velocity returned {command}; allowed: finite numbers")
    return Twist(float(command.vx), float(command.vy), float(command.wz))
