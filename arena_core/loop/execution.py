"""Run one episode in a simulator."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from arena_core.base.ctrl_c import interrupts
from arena_core.base.pulse import pulse
from arena_core.contracts.simulation import Simulator, Snapshot
from arena_core.loop.driving import Ending, drive_episode
from arena_core.loop.episode_loop import EpisodeLoop
from arena_core.loop.guide import Mission
from arena_core.loop.keeping_company import CompanyKeeper
from arena_core.loop.live import LiveFile
from arena_core.loop.navigator import Decision, Navigator
from arena_core.loop.recording import Recorder
from arena_core.loop.world_truth import WorldTruth
from arena_core.values.episode import EpisodeRecord, Scenario
from arena_core.values.parameters import NonNegative, Positive
from arena_core.values.sensing import Sensors


@dataclass(frozen=True, slots=True)
class Timing:
    """How late commands act: ``ideal`` at once, ``latency`` a fixed time (s), ``measured`` the wall time that the step
    took.

    ``measured`` counts the whole navigator, ``compute_factor`` times: a robot's computer is slower than the one at
    hand.
    """

    mode: Literal["ideal", "latency", "measured"]
    latency: NonNegative
    compute_factor: Positive

    def delay(self, decision: Decision) -> float:
        """Return the delay of a command, s."""
        return {"ideal": 0.0, "latency": self.latency, "measured": self.compute_factor * decision.spent.navigator}[
            self.mode
        ]


def delay_ticks(timing: Timing, decision: Decision, inner_step: float) -> int:
    """Return after how many inner steps the command of a decision acts."""
    return math.ceil(timing.delay(decision) / inner_step - 1e-9)


class SimulatedInterface:
    """The robot of a simulator as the loop drives it; ``state`` is the truth of now."""

    def __init__(
        self, worlds: EpisodeLoop, scenario: Scenario, timing: Timing, recorder: Recorder, live: LiveFile | None
    ) -> None:
        self._worlds, self._timing, self._recorder, self._live = worlds, timing, recorder, live
        self._failures: Mapping[int, str] = {}
        self._keeper = CompanyKeeper(scenario.company, scenario) if scenario.company else None
        self._take_in(worlds.begin([scenario]))

    def _take_in(self, snapshot: Snapshot) -> None:
        self.state, self.sensors = snapshot.state(0), snapshot.sensors(0)
        if self._keeper is not None:
            self.sensors = replace(self.sensors, goal=self._keeper.goal(self.state))

    def read(self) -> Sensors | Ending:
        """Record what is before anything decides."""
        if self._failures:
            return Ending("error", self._failures[0])
        interrupts.check()
        self._recorder.sense(self.state, self.sensors)
        if self._live is not None:
            self._live.show(self.state)
        pulse.beat()
        return self.sensors

    def judge(self, decision: Decision) -> Ending | None:
        """Judge on the truth."""
        if self._keeper is not None and self._keeper.is_fulfilled(self.state):
            return Ending("goal_reached", "", decision)
        outcome = self._worlds.judge(np.array((decision.arrived,))).outcome(0)
        return None if outcome is None else Ending(outcome, "", decision)

    def write(self, decision: Decision) -> Decision:
        """Move for one control period; the command acts when its delay is over."""
        late = delay_ticks(self._timing, decision, self._worlds.inner_step)
        snapshot = self._worlds.drive(decision.command.array()[None], np.array((late,)))
        self._failures = snapshot.failures
        self._take_in(snapshot)
        return decision


def run_episode(
    scenario: Scenario,
    simulator: Simulator,
    navigator: Navigator,
    timing: Timing,
    recorder: Recorder,
    live: LiveFile | None = None,
    *,
    stop_on_collision: bool,
) -> EpisodeRecord:
    """Run one scenario to its end and return its record; what the navigator raises, and what the simulator
    cannot go on from, ends it with the outcome ``error``. Where it is meanwhile is told in the ``live`` file.
    """
    worlds = EpisodeLoop(simulator, navigator.control_period, 1, 1 if stop_on_collision else None)
    try:
        robot = SimulatedInterface(worlds, scenario, timing, recorder, live)
        navigator.reset(mission_of(scenario), WorldTruth(worlds, 0, scenario) if navigator.privileged else None)
        navigator.rehearse(robot.sensors)
        ending = drive_episode(robot, navigator, recorder)
        return recorder.finish(robot.state, ending.outcome, ending.error, ending.decision, navigator.notes())
    finally:
        if live is not None:
            live.remove()


def mission_of(scenario: Scenario) -> Mission:
    """Return what a robot is told of a scenario before it drives."""
    grid = scenario.world.grid if scenario.world.known else None
    return Mission(grid, scenario.start, scenario.goal, scenario.goal_radius, scenario.seed, scenario.name)
