"""One round of driving: by the teacher, or by what the network holds best, with some chance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arena_cadrl.training.returns import lambda_returns
from arena_cadrl.training.settings import Learning
from arena_cadrl.training.worlds import VectorWorlds, WorldsObservation
from arena_gym.batch import Step

FLAGS = ("arrived", "collided", "timed_out", "terminated", "truncated")
Numbers = NDArray[np.float32]
Run = Callable[[Numbers], Numbers]


@dataclass(frozen=True, slots=True, eq=False)
class Rollout:
    """States (M, D) with what they turned out to be worth (M,), and how many
    episodes of the round ended in each way.
    """

    states: Numbers
    worth: Numbers
    arrived: int
    collided: int
    timed_out: int


class Explorer:
    """Draws actions by chance for a share of the time, each held for some steps."""

    def __init__(self, worlds: int, held: int, random: np.random.Generator) -> None:
        self._held, self._random = held, random
        self._left, self._action = np.zeros(worlds, np.int64), np.zeros(worlds, np.int64)

    def draw_actions(self, share: float, allowed: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Return an action for each robot (N,), -1 where the best one is to be taken; ``allowed`` (N, A)."""
        rate = share / (self._held * (1.0 - share) + share) if share < 1.0 else 1.0
        begins = (self._left == 0) & (self._random.random(len(self._left)) < rate)
        for slot in np.flatnonzero(begins).tolist():
            choices = np.flatnonzero(allowed[slot])
            if len(choices):
                self._action[slot], self._left[slot] = self._random.choice(choices), self._held
        active = (self._left > 0) & allowed[np.arange(len(allowed)), self._action]
        self._left = np.where(active, self._left - 1, 0)
        return np.where(active, self._action, -1)


def collect_rollout(
    worlds: VectorWorlds,
    run: Run,
    explorer: Explorer,
    settings: Learning,
    discount: float,
    share: float,
    *,
    teaching: bool,
) -> Rollout:
    """Drive for a round; return what was seen with lambda-returns by the present values, ``discount`` a decision."""
    steps, count = settings.decisions, worlds.batch.worlds
    states: list[Numbers] = []
    rewards, values = np.empty((steps, count)), np.empty((steps, count))
    ended, cut, chance = (np.zeros((steps, count), np.bool_) for _ in range(3))
    ends = np.zeros(3, np.int64)
    for t in range(steps):
        seen = worlds.observe(teaching=teaching)
        states.append(seen.rows[:, 0].copy())
        found = run(states[-1])[:, None] if teaching else state_values(run, seen)
        values[t] = found[:, 0]
        if teaching:
            commands = seen.taught
        else:
            allowed = np.array([sight.allowed for sight in seen.sights])
            drawn = explorer.draw_actions(share, allowed)
            chance[t] = drawn >= 0
            commands = chosen_commands(seen, found[:, 1:], drawn)
        step = drive_decision(worlds, commands, settings.every)
        rewards[t], ended[t], cut[t] = step.rewards, step.terminated, step.truncated
        ends += (step.arrived.sum(), step.collided.sum(), step.timed_out.sum())
    last = run(worlds.observe(teaching=False).rows[:, 0].copy()).astype(np.float64)
    worth = lambda_returns(rewards, values, last, ended, cut, chance, discount, 1.0 if teaching else settings.trace)
    kept = ~(chance | cut)
    return Rollout(np.stack(states)[kept], worth[kept].astype(np.float32), *ends.tolist())


def drive_decision(worlds: VectorWorlds, commands: NDArray[np.float64], every: int) -> Step:
    """Drive for ``every`` control steps, rewards add up; a robot whose episode ends in between
    stands until all have driven so long.
    """
    total = worlds.drive(commands)
    for _ in range(every - 1):
        worlds.track()
        goes_on = ~(total.terminated | total.truncated)
        step = worlds.drive(commands * goes_on[:, None])
        flags = {name: getattr(total, name) | (getattr(step, name) & goes_on) for name in FLAGS}
        total = replace(total, rewards=total.rewards + goes_on * step.rewards, **flags)
    return total


def state_values(run: Run, seen: WorldsObservation) -> Numbers:
    """Return the values of the states now and after each action (N, 1 + A)."""
    count, each, size = seen.rows.shape
    return run(seen.rows.reshape(count * each, size)).reshape(count, each)


def chosen_commands(seen: WorldsObservation, values: Numbers, drawn: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the velocities (N, 3) of the actions drawn, else of the best; a robot without an allowed one brakes."""
    commands = np.zeros((len(seen.sights), 3))
    for slot, sight in enumerate(seen.sights):
        action = int(drawn[slot]) if drawn[slot] >= 0 else sight.best_action(values[slot])
        if action is not None:
            commands[slot] = sight.commands[action]
    return commands
