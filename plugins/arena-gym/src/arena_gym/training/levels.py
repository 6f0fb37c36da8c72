"""Which levels of a task training episodes are of: one for all that rises and falls, or a mixture that
follows what is being learned.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError
from arena_core.hosting import Staging
from arena_gym.batch import NavigationBatch
from arena_gym.training.settings import Mixture

SLOWER = 3.0  # times the window, of the average that a change of success is measured against


class Levels(ABC):
    """A rule that hears how episodes ended and tells worlds the levels of those that follow."""

    @abstractmethod
    def apply(self, batch: NavigationBatch) -> None:
        """Let episodes that begin from now on be of these levels; called as training begins and after every update."""

    @abstractmethod
    def record_episode(self, stage: int | None, batch: NavigationBatch, *, success: bool) -> None:
        """Hear how an episode of level ``stage`` ended."""

    @property
    @abstractmethod
    def mean(self) -> float:
        """Return the level of episodes that begin now, its mean where they differ."""

    @property
    def may_end(self) -> bool:
        """Return whether training may end here."""
        return True

    def level_shares(self) -> Sequence[float]:
        """Return the share of episodes of each level, none where all are of one."""
        return ()

    @abstractmethod
    def state(self) -> dict[str, Any]:
        """Return what a checkpoint keeps, plain numbers and lists."""

    @abstractmethod
    def restore(self, state: Mapping[str, Any]) -> None:
        """Go on from a checkpoint."""


class NoLevels(Levels):
    """Of a task that has none."""

    mean = 0.0

    def apply(self, batch: NavigationBatch) -> None:
        """Leave the worlds as they are."""

    def record_episode(self, stage: int | None, batch: NavigationBatch, *, success: bool) -> None:
        """Take no notice."""

    def state(self) -> dict[str, Any]:
        """Return nothing."""
        return {}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Need nothing."""


class Promotion(Levels):
    """One level for all worlds; it changes after a block of episodes, by the rule of the task."""

    def __init__(self, staging: Staging) -> None:
        self._staging, self._stage = staging, staging.start
        self._block: list[bool] = []

    def apply(self, batch: NavigationBatch) -> None:
        """Set the level."""
        batch.set_stage(self._stage)

    def record_episode(self, stage: int | None, batch: NavigationBatch, *, success: bool) -> None:
        """Add an episode to the block; change the level at once where the block is full."""
        self._block.append(success)
        if len(self._block) >= self._staging.block:
            self._stage, self._block = self._staging.next(self._stage, self._block), []
            batch.set_stage(self._stage)

    @property
    def mean(self) -> float:
        """Return the level."""
        return float(self._stage)

    @property
    def may_end(self) -> bool:
        """Return whether this is the last level."""
        return self._stage == self._staging.levels - 1

    def state(self) -> dict[str, Any]:
        """Return level and block."""
        return {"stage": self._stage, "block": list(self._block)}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take level and block."""
        self._stage, self._block = int(state["stage"]), [bool(one) for one in state["block"]]


class LevelMixture(Levels):
    """Each episode draws its own level: a share evenly, the rest in proportion to how fast the success on a level
    changes.

    That is the absolute learning progress of teacher-student curricula (Matiisen et al. 2017): levels on which success
    rises, and those on which it falls again, are met most; a level that is mastered, or too hard as yet, keeps its part
    of the even share, so that none is lost from sight and training cannot be stuck on one. Progress is the difference
    of two running means of the success on a level, over ``window`` and over three times as many of its episodes.
    """

    def __init__(self, levels: int, settings: Mixture) -> None:
        self._floor = settings.floor
        self._rates = np.array((1.0, 1.0 / SLOWER)) / settings.window
        self._means: NDArray[np.float64] = np.zeros((levels, 2))

    def apply(self, batch: NavigationBatch) -> None:
        """Set the weights of the levels."""
        batch.mix_stages(self.level_shares())

    def record_episode(self, stage: int | None, batch: NavigationBatch, *, success: bool) -> None:
        """Count an episode towards the success on its level."""
        assert stage is not None
        self._means[stage] += self._rates * (float(success) - self._means[stage])

    @property
    def mean(self) -> float:
        """Return the mean level of episodes that begin now."""
        shares = self.level_shares()
        return float(np.dot(shares, np.arange(len(shares))))

    def level_shares(self) -> Sequence[float]:
        """Return the probability of each level."""
        progress = np.abs(self._means[:, 0] - self._means[:, 1])
        even, total = np.full(len(progress), 1.0 / len(progress)), float(progress.sum())
        found: list[float] = (
            self._floor * even + (1.0 - self._floor) * (progress / total if total > 0.0 else even)
        ).tolist()
        return found

    def state(self) -> dict[str, Any]:
        """Return the running means."""
        return {"means": self._means.tolist()}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take the running means."""
        self._means = np.array(state["means"], np.float64).reshape(self._means.shape)


def make_levels(rule: str, staging: Staging | None, settings: Mixture) -> Levels:
    """Return the rule of this name for a task with ``staging``; raise ConfigurationError for a mixture
    where there are no levels.
    """
    if staging is None:
        if rule == "mixture":
            raise ConfigurationError(
                "training.levels is mixture, but the task has no levels; allowed: task=staged, or promote"
            )
        return NoLevels()
    return Promotion(staging) if rule == "promote" else LevelMixture(staging.levels, settings)
