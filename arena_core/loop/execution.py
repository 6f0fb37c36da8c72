"""Run one episode: the loop of sensing, deciding, moving and judging."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from arena_core.base.ctrl_c import interrupts
from arena_core.base.errors import describe_error
from arena_core.base.pulse import pulse
from arena_core.contracts.simulation import Simulator
from arena_core.loop.episode_loop import EpisodeLoop
from arena_core.loop.guide import Mission
from arena_core.loop.live import LiveFile
from arena_core.loop.navigator import Decision, Navigator
from arena_core.loop.recording import Recorder
from arena_core.values.episode import EpisodeRecord, Scenario
from arena_core.values.parameters import NonNegative, Positive


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
    try:
        return _drive_episode(
            scenario, simulator, navigator, timing, recorder, live, stop_on_collision=stop_on_collision
        )
    finally:
        if live is not None:
            live.remove()


def _drive_episode(
    scenario: Scenario,
    simulator: Simulator,
    navigator: Navigator,
    timing: Timing,
    recorder: Recorder,
    live: LiveFile | None,
    *,
    stop_on_collision: bool,
) -> EpisodeRecord:
    worlds = EpisodeLoop(simulator, navigator.control_period, 1, 1 if stop_on_collision else None)
    snapshot = worlds.begin([scenario])
    state, sensors = snapshot.state(0), snapshot.sensors(0)
    navigator.reset(mission_of(scenario))
    navigator.rehearse(sensors)
    while True:
        interrupts.check()
        recorder.sense(state, sensors)  # before anything decides
        if live is not None:
            live.show(state)
        pulse.beat()
        try:
            decision = navigator.decide(sensors)
            considered = navigator.considered(decision) if recorder.keeps_considered else None
        except BaseException as error:  # whatever a planner raises, sys.exit() too
            if interrupts.raised(error):
                raise
            return recorder.finish(state, "error", describe_error(error))
        outcome = worlds.judge(np.array((decision.arrived,))).outcome(0)
        if outcome is not None:
            return recorder.finish(state, outcome, "", decision)
        recorder.add(decision, considered)
        late = math.ceil(timing.delay(decision) / simulator.inner_step - 1e-9)
        snapshot = worlds.drive(decision.command.array()[None], np.array((late,)))
        state, sensors = snapshot.state(0), snapshot.sensors(0)
        if snapshot.failures:
            return recorder.finish(state, "error", snapshot.failures[0])


def mission_of(scenario: Scenario) -> Mission:
    """Return what a robot is told of a scenario before it drives."""
    grid = scenario.world.grid if scenario.world.known else None
    return Mission(grid, scenario.start, scenario.goal, scenario.goal_radius, scenario.seed, scenario.name)
