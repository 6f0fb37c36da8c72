"""The settings of a value network's training, as its YAML has them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from arena_core.parameters import Bounds, Fraction, NonNegative, Positive, PositiveInt


@dataclass(frozen=True, slots=True)
class ValueSettings:
    """A value network. ``pairs`` sees the robot with one person at a time, the least value counts (CADRL): layers of
    ``body``.

    ``attention`` sees all people together (SARL): layers of ``body`` for each pair, ``told`` of what a pair tells,
    ``attention`` of how much it counts, ``head`` of the value. ``differs`` says what is not as published.
    """

    kind: Literal["pairs", "attention"]
    body: tuple[PositiveInt, ...]
    told: tuple[PositiveInt, ...]
    attention: tuple[PositiveInt, ...]
    head: tuple[PositiveInt, ...]
    differs: str


@dataclass(frozen=True, slots=True)
class Learning:
    """How values are learned, in rounds of ``decisions`` in ``environments`` worlds, one at every ``every``-th control
    step.

    ``imitation`` is the share of all steps in which the teacher drives. ``trace`` is the lambda of the returns, a
    decision. ``exploration`` is the share of time in which actions are drawn by chance, at first and at the end, each
    held for ``held`` decisions. Of what the last ``memory`` rounds showed, ``updates`` minibatches are learned from
    after each round. ``average`` is how much of themselves the weights that are evaluated keep at an update.
    """

    environments: PositiveInt
    decisions: PositiveInt
    every: PositiveInt
    imitation: Fraction
    trace: Fraction
    exploration: Fraction
    final_exploration: Fraction
    held: PositiveInt
    memory: PositiveInt
    updates: PositiveInt
    minibatch: PositiveInt
    learning_rate: Positive
    final_learning_rate: Fraction
    average: Annotated[float, Bounds(low=0.0, high=0.9999)]
    max_gradient: NonNegative
