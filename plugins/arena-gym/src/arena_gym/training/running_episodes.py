"""Episodes that run while a checkpoint is written: kept as what they were drawn from and the actions since,
and driven again from those.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError
from arena_core.commands import interrupts
from arena_gym.batch import NavigationBatch
from arena_gym.episodes import EpisodeKey


@dataclass(frozen=True, slots=True, eq=False)
class RunningEpisodes:
    """N episodes: ``keys``, the ``actions`` (T, N, ...) of the last T steps, and how many of them each has
    seen, ``lengths`` (N,) <= T.
    """

    keys: Sequence[EpisodeKey]
    actions: NDArray[Any]
    lengths: NDArray[np.int64]

    def replay_actions(self, batch: NavigationBatch) -> NDArray[np.float32]:
        """Bring worlds to where these episodes were, bit for bit, for an episode follows from its key and its actions;
        return what is seen.

        Each begins so many steps before the end as it has seen; until then its world is driven for nothing.
        """
        if len(self.keys) != batch.worlds:
            raise ConfigurationError(
                f"the checkpoint has {len(self.keys)} worlds; allowed: {batch.worlds}, as the training has"
            )
        observations = batch.begin_at(self.keys)
        steps = len(self.actions)
        for step, actions in enumerate(self.actions):
            interrupts.check()
            self._begin_due(steps - step, batch, observations)
            observations = batch.step(actions).observations
        self._begin_due(0, batch, observations)
        return observations

    def _begin_due(self, left: int, batch: NavigationBatch, observations: NDArray[np.float32]) -> None:
        slots = np.flatnonzero(self.lengths == left)
        if len(slots):
            observations[slots] = batch.begin_again(slots)


class ActionLog:
    """The actions of N worlds for as long back as the longest running episode goes."""

    def __init__(self, worlds: int) -> None:
        self._actions: list[NDArray[Any]] = []
        self._lengths = np.zeros(worlds, np.int64)

    def add(self, actions: NDArray[Any], ended: NDArray[np.bool_]) -> None:
        """Note the actions (N, ...) of a step, and whose episodes ended with it (N,)."""
        self._actions.append(np.array(actions))
        self._lengths = np.where(ended, 0, self._lengths + 1)

    def running_episodes(self, keys: Sequence[EpisodeKey]) -> RunningEpisodes:
        """Return the running episodes, which were drawn from these keys; forget what came before them."""
        longest = int(self._lengths.max())
        del self._actions[: len(self._actions) - longest]
        actions = np.stack(self._actions) if self._actions else np.zeros((0, len(self._lengths)), np.float32)
        return RunningEpisodes(list(keys), actions, self._lengths.copy())

    def restore(self, running: RunningEpisodes) -> None:
        """Go on from these episodes."""
        self._actions, self._lengths = list(running.actions), np.array(running.lengths, np.int64)
