"""Run one episode: the loop of sensing, deciding, moving and judging."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

from arena_core.episode import EpisodeRecord, Outcome, Scenario, WorldState
from arena_core.geometry import Twist
from arena_core.interfaces import Simulator
from arena_core.interrupt import interrupts
from arena_core.navigator import BRAKE, Decision, Mission, Navigator
from arena_core.parameters import NonNegative, Positive
from arena_core.recording import Recorder
from arena_core.success import ARRIVAL_SLACK


@dataclass(frozen=True, slots=True)
class Timing:
    """How late commands act: ``ideal`` at once, ``latency`` a fixed time (s), ``measured`` the wall time that the step took.

    ``measured`` counts the whole navigator, ``compute_factor`` times: a robot's computer is slower than the one at hand.
    """

    mode: Literal["ideal", "latency", "measured"]
    latency: NonNegative
    compute_factor: Positive

    def delay(self, decision: Decision) -> float:
        """Return the delay of a command, s."""
        return {"ideal": 0.0, "latency": self.latency, "measured": self.compute_factor * decision.spent.navigator}[self.mode]


class CommandQueue:
    """Commands under way to the robot; each acts from its tick on, until the next one does."""

    def __init__(self) -> None:
        self._pending: deque[tuple[int, Twist]] = deque()
        self._acting = BRAKE

    def send(self, command: Twist, acts_at: int) -> None:
        """Queue a command; one that overtakes older ones replaces them."""
        while self._pending and self._pending[-1][0] >= acts_at:
            self._pending.pop()
        self._pending.append((acts_at, command))

    def segments(self, begin: int, end: int) -> Iterator[tuple[Twist, int]]:
        """Yield (command, ticks) for the ticks from ``begin`` to ``end``."""
        tick = begin
        while tick < end:
            while self._pending and self._pending[0][0] <= tick:
                self._acting = self._pending.popleft()[1]
            until = min(end, self._pending[0][0]) if self._pending else end
            yield self._acting, until - tick
            tick = until


def run_episode(
    scenario: Scenario, simulator: Simulator, navigator: Navigator, timing: Timing, recorder: Recorder, stop_on_collision: bool
) -> EpisodeRecord:
    """Run one scenario to its end and return its record; an exception of the navigator ends it with the outcome ``error``."""
    snapshot = simulator.reset([scenario])
    state, sensors = snapshot.state(0), snapshot.sensors(0)
    steps = round(navigator.control_period / simulator.inner_step)
    queue = CommandQueue()
    tick = 0
    navigator.reset(_mission(scenario))
    navigator.rehearse(sensors)
    while True:
        interrupts.check()
        try:
            decision = navigator.decide(sensors)
        except Exception as error:
            return recorder.finish(state, "error", f"{type(error).__name__}: {error}")
        outcome = judge(scenario, state, decision, stop_on_collision)
        if outcome is not None:
            return recorder.finish(state, outcome, "", decision)
        recorder.add(state, sensors, decision)
        queue.send(decision.command, tick + math.ceil(timing.delay(decision) / simulator.inner_step - 1e-9))
        states = []
        for command, ticks in queue.segments(tick, tick + steps):
            snapshot = simulator.advance(command.array()[None], ticks)
            states.append(snapshot.state(0))
        state, sensors = joined(states), snapshot.sensors(0)
        tick += steps


def judge(scenario: Scenario, state: WorldState, decision: Decision, stop_on_collision: bool) -> Outcome | None:
    """Return how the episode ends now, or None; arrival is the navigator's word, checked against the truth."""
    if decision.arrived:
        off = state.pose.distance(scenario.goal)
        return "goal_reached" if off <= scenario.goal_radius + ARRIVAL_SLACK else "false_arrival"
    if stop_on_collision and state.contacts:
        return "collision"
    return "time_out" if state.stamp >= scenario.time_limit - 1e-9 else None


def joined(states: list[WorldState]) -> WorldState:
    """Return the last state with the contacts of all of them."""
    if len(states) == 1:
        return states[0]
    contacts = tuple(contact for state in states for contact in state.contacts)
    return replace(states[-1], contacts=contacts, contact_time=sum(state.contact_time for state in states))


def _mission(scenario: Scenario) -> Mission:
    grid = scenario.world.grid if scenario.world.known else None
    return Mission(grid, scenario.start, scenario.goal, scenario.goal_radius, scenario.seed, scenario.name)
