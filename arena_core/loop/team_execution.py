"""Run the episode of a team in a simulator: one world, and a navigator and a record for each robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from arena_core.base.ctrl_c import interrupts
from arena_core.base.errors import describe_error
from arena_core.base.frozen import freeze_array
from arena_core.base.pulse import pulse
from arena_core.base.random_streams import random_generator
from arena_core.contracts.communication import Communication
from arena_core.contracts.simulation import Simulator, Snapshot
from arena_core.loop.driving import Ending
from arena_core.loop.episode_loop import EpisodeLoop
from arena_core.loop.errand_book import ErrandBook
from arena_core.loop.execution import Timing, delay_ticks, mission_of
from arena_core.loop.grain import round_arrays
from arena_core.loop.live import LiveFile
from arena_core.loop.navigator import Decision, Navigator
from arena_core.loop.recording import Recorder, robot_meta
from arena_core.loop.world_truth import TeamWorldTruth, truths_of_team
from arena_core.values.candidate import Candidate
from arena_core.values.episode import EpisodeRecord, Scenario, WorldState
from arena_core.values.geometry import FloatArray
from arena_core.values.messages import Message
from arena_core.values.sensing import Sensors


@dataclass(frozen=True, slots=True, eq=False)
class TeamSeat:
    """What drives one robot of a team and keeps its record; ``planner`` is its name in the records."""

    navigator: Navigator
    recorder: Recorder
    planner: str
    live: LiveFile | None = None


@dataclass(frozen=True, slots=True, eq=False)
class TeamRules:
    """What holds for all robots of a team; with ``communication`` they tell each other where they are."""

    timing: Timing
    stop_on_collision: bool
    communication: Communication | None = None


class TeamRobot:
    """One robot of a team in its episode, which is over for it once there is an ``ending``; it then stands."""

    def __init__(self, seat: TeamSeat, truth: TeamWorldTruth) -> None:
        self._seat, self._truth, self._scenario = seat, truth, truth.scenario
        self.ending: Ending | None = None
        self.state: WorldState
        self._considered: list[Candidate] | None = None

    def begin(self, sensors: Sensors) -> None:
        """Tell the navigator of its mission; what it raises ends the episode of its robot."""
        navigator = self._seat.navigator
        try:
            navigator.reset(mission_of(self._scenario), self._truth if navigator.privileged else None)
            navigator.rehearse(sensors)
        except BaseException as error:  # whatever a planner raises, sys.exit() too
            self._end_with(error)

    def decide(self, sensors: Sensors) -> Decision | None:
        """Record what is, and return what the navigator decides; None where the episode is over for this robot."""
        if self.ending is not None:
            return None
        self._seat.recorder.sense(self.state, sensors)
        if self._seat.live is not None:
            self._seat.live.show(self.state)
        navigator = self._seat.navigator
        try:
            decision = navigator.decide(sensors)
            self._considered = navigator.considered(decision) if self._seat.recorder.keeps_considered else None
            return decision
        except BaseException as error:
            self._end_with(error)
            return None

    def add(self, decision: Decision) -> None:
        """Record a decision that is carried out, with what the planner considered."""
        self._seat.recorder.add(decision, self._considered)

    def message(self, member: int, decision: Decision | None, sensors: Sensors) -> Message | None:
        """Return what this robot tells the others; None where its episode is over."""
        if decision is None or self.ending is not None:
            return None
        estimate = decision.estimate
        return Message(
            sender=member,
            stamp=sensors.stamp,
            pose=estimate.pose,
            twist=sensors.odometry.twist,
            covariance=freeze_array(estimate.covariance),
            radius=self._seat.navigator.robot.footprint.radius,
        )

    def _end_with(self, error: BaseException) -> None:
        if interrupts.raised(error):
            raise error
        self.ending = Ending("error", describe_error(error))

    def fail(self, why: str) -> None:
        """End the episode of this robot where the simulation cannot go on with it."""
        if self.ending is None:
            self.ending = Ending("error", why)

    def finish(self) -> EpisodeRecord:
        """Return the record of this robot's own episode."""
        ending = self.ending
        assert ending is not None
        notes = self._seat.navigator.notes()
        return self._seat.recorder.finish(self.state, ending.outcome, ending.error, ending.decision, notes)

    def summary(self, name: str) -> dict[str, Any]:
        """Return what all records of the team say of this robot; ``end`` s is when its episode was over."""
        assert self.ending is not None
        return {
            "name": name,
            "planner": self._seat.planner,
            "robot": robot_meta(self._seat.navigator.robot),
            "start": self._scenario.start.array().tolist(),
            "goal": self._scenario.goal.array().tolist(),
            "outcome": self.ending.outcome,
            "end": self.state.stamp,
        }


def run_team(
    scenario: Scenario, simulator: Simulator, seats: Sequence[TeamSeat], rules: TeamRules
) -> list[EpisodeRecord]:
    """Run one scenario of a team to its end and return the record of each robot.

    Each is judged by itself. Who has arrived, failed, or whose navigator raises, brakes and stands from then on, as a
    body among the others; the episode is over once it is over for all.
    """
    worlds = EpisodeLoop(
        simulator, seats[0].navigator.control_period, 1, 1 if rules.stop_on_collision else None, team=len(seats)
    )
    truths = truths_of_team(worlds, scenario, [seat.navigator.robot for seat in seats])
    robots = [TeamRobot(seat, truth) for seat, truth in zip(seats, truths, strict=True)]
    book = None if scenario.errands is None else ErrandBook(scenario.errands, scenario.goal_radius)
    worlds.begin([scenario])
    if rules.communication is not None:
        rules.communication.reset(len(seats), random_generator(scenario.seed, scenario.name, "communication"))
    try:
        track = _drive_team(robots, worlds, rules, book)
    finally:
        for seat in seats:
            if seat.live is not None:
                seat.live.remove()
    names = ("robot0", *(member.name for member in scenario.team))
    told = [robot.summary(name) for robot, name in zip(robots, names, strict=True)]
    team = {"robots": told, **({} if book is None else {"errands": book.summary()})}
    return [_with_team(robot.finish(), member, team, track) for member, robot in enumerate(robots)]


def _drive_team(
    robots: Sequence[TeamRobot], worlds: EpisodeLoop, rules: TeamRules, book: ErrandBook | None
) -> list[tuple[float, FloatArray]]:
    """Drive until the episode is over for all; return the stamps (s) and poses (M, 3) of all control steps. Where there
    is a ``book``, it says where robots are bound for.
    """
    snapshot, radio = worlds.snapshot, rules.communication
    for row, robot in enumerate(robots):
        robot.begin(_sensors(snapshot, row, book, radio))
    track = []
    while True:
        track.append((float(snapshot.stamps[0]), snapshot.poses))
        for row, robot in enumerate(robots):
            if robot.ending is None or len(track) == 1:
                robot.state = snapshot.state(row)
        interrupts.check()
        sensed = [_sensors(snapshot, row, book, radio) for row in range(len(robots))]
        decisions = [robot.decide(sensors) for robot, sensors in zip(robots, sensed, strict=True)]
        pulse.beat()
        if book is not None:
            book.look(float(snapshot.stamps[0]), snapshot.poses, decisions)
        _judge_team(robots, worlds, decisions, on_errands=book is not None)
        if all(robot.ending is not None for robot in robots):
            return track
        if radio is not None:
            told = zip(robots, decisions, sensed, strict=True)
            messages = [robot.message(row, decision, seen) for row, (robot, decision, seen) in enumerate(told)]
            radio.tell(messages, snapshot.poses[:, :2])
        snapshot = _move_team(robots, worlds, rules.timing, decisions)
        for row, why in snapshot.failures.items():
            robots[row].fail(why)


def _sensors(snapshot: Snapshot, row: int, book: ErrandBook | None, radio: Communication | None) -> Sensors:
    """Return what a robot measures, where it is bound for if it runs errands, and what it has heard."""
    sensors = snapshot.sensors(row)
    if radio is not None:
        sensors = replace(sensors, heard=tuple(radio.heard(row, sensors.stamp)))
    return sensors if book is None else replace(sensors, goal=book.goal(row))


def _judge_team(
    robots: Sequence[TeamRobot], worlds: EpisodeLoop, decisions: Sequence[Decision | None], *, on_errands: bool
) -> None:
    """End the episodes that the judge ends, on the truth; who runs errands to the time limit has done what it ought."""
    verdicts = worlds.judge(np.array([decision is not None and decision.arrived for decision in decisions]))
    for row, (robot, decision) in enumerate(zip(robots, decisions, strict=True)):
        outcome = verdicts.outcome(row)
        if on_errands and outcome == "time_out":
            outcome = "goal_reached"
        if decision is not None and outcome is not None:
            robot.ending = Ending(outcome, "", decision)


def _move_team(
    robots: Sequence[TeamRobot], worlds: EpisodeLoop, timing: Timing, decisions: Sequence[Decision | None]
) -> Snapshot:
    """Move for one control period: each by what it decided, the others brake and stand."""
    commands, delays = np.zeros((len(robots), 3)), np.zeros(len(robots), np.int64)
    for row, (robot, decision) in enumerate(zip(robots, decisions, strict=True)):
        if decision is not None and robot.ending is None:
            commands[row] = decision.command.array()
            delays[row] = delay_ticks(timing, decision, worlds.inner_step)
            robot.add(decision)
    return worlds.drive(commands, delays)


def _with_team(
    record: EpisodeRecord, member: int, team: Mapping[str, Any], track: Sequence[tuple[float, FloatArray]]
) -> EpisodeRecord:
    """Return a robot's record with what is told of its team, and where all robots of it were until the episode was
    over for the last.
    """
    arrays = {
        "team_stamp": np.array([stamp for stamp, _ in track]),
        "team_pose": np.array([poses for _, poses in track]),
    }
    meta = {**record.meta, "team": {"member": member, **team}}
    return replace(record, arrays={**record.arrays, **round_arrays(arrays)}, meta=meta)
