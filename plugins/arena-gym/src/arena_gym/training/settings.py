"""The settings of a training, as its YAML has them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from arena_core import ConfigurationError
from arena_core.parameters import Fraction, NonNegative, NonNegativeInt, Positive, PositiveInt

GREATEST_SEED = 2**32 - 1  # that NumPy's generators take, which Stable-Baselines3 seeds


@dataclass(frozen=True, slots=True)
class Convolution:
    """One 1-D convolution over the beams: output ``channels``, ``kernel`` and ``stride`` in beams."""

    channels: PositiveInt
    kernel: PositiveInt
    stride: PositiveInt


@dataclass(frozen=True, slots=True)
class Network:
    """The policy's network: ``convolutions`` over the scans ``beams_field`` of the observation, ``features`` from them,
    then ``heads``.

    The heads, one for the policy and one for the value, see these features and the rest of the observation; all of it
    where ``beams_field`` is null. The spread of the actions begins at exp(``log_std_init``), in halves of each action's
    range or, where ``log_std_unit`` is si, in m/s and rad/s, at most such a half; unless ``log_std_final`` is null, it
    has a limit that falls from there to exp(``log_std_final``). ``differs`` tells what is not as published, for the
    policy's card.
    """

    beams_field: str | None
    convolutions: tuple[Convolution, ...]
    features: PositiveInt | None
    heads: tuple[PositiveInt, ...]
    log_std_init: float
    log_std_unit: Literal["range", "si"]
    log_std_final: float | None
    differs: str | None

    def __post_init__(self) -> None:
        if self.log_std_unit == "si" and self.log_std_final is not None:
            raise ConfigurationError(
                f"training.network.log_std_final is {self.log_std_final:g}; allowed: null where log_std_unit is si"
            )
        if (self.beams_field is None) != (self.features is None):
            raise ConfigurationError(
                f"training.network.features is {self.features}; allowed: a number with a beams_field, null without one"
            )


@dataclass(frozen=True, slots=True)
class Optimization:
    """Proximal policy optimisation (Schulman et al. 2017), in the words of Stable-Baselines3.

    ``learning_rate`` falls in a line to its share ``final_learning_rate`` at the end. Without ``gamma`` a training has
    a horizon in s.
    """

    environments: PositiveInt
    steps: PositiveInt
    minibatch: PositiveInt
    epochs: PositiveInt
    learning_rate: Positive
    final_learning_rate: Fraction
    gamma: Fraction | None
    gae_lambda: Fraction
    clip: Positive
    entropy: NonNegative
    value: NonNegative
    max_gradient: Positive

    def __post_init__(self) -> None:
        if self.minibatch < 2:
            raise ConfigurationError(
                f"training.optimization.minibatch is {self.minibatch}; allowed: 2 or more, whose advantages can differ"
            )


@dataclass(frozen=True, slots=True)
class Validation:
    """How weights are chosen: ``episodes`` of ``seed`` every ``every`` steps; best is the mean of ``average``
    validations in a row.

    Training stops early once ``target`` of them succeed without a collision on the last level; null trains to the end.
    """

    every: PositiveInt
    episodes: PositiveInt
    seed: NonNegativeInt
    average: PositiveInt
    target: Fraction | None


@dataclass(frozen=True, slots=True)
class Test:
    """What the weights that were chosen are tried on once: ``episodes`` of ``seed``; 0: they are not."""

    episodes: NonNegativeInt
    seed: NonNegativeInt


@dataclass(frozen=True, slots=True)
class TruthSettings:
    """What a critic that sees the truth is shown: so many of the nearest ``people`` within ``reach`` m."""

    people: NonNegativeInt
    reach: Positive


@dataclass(frozen=True, slots=True)
class Mixture:
    """Levels drawn evenly in a share ``floor`` of episodes, else by the change of success over
    ``window`` episodes of a level.
    """

    floor: Fraction
    window: PositiveInt


@dataclass(frozen=True, slots=True)
class Start:
    """What a training begins with: the weights of ``policy``, a file with its card beside it or pkg://; drawn ones
    where it is null.

    Neither a policy's file nor a teacher tells a value: for ``value_steps`` steps it alone is learned, and the policy
    drives as it did.
    """

    policy: str | None
    value_steps: NonNegativeInt


@dataclass(frozen=True, slots=True)
class ExpertSettings:
    """A ``planner``, tuned for the robot where it can be, whom the policy imitates at first; None: no one teaches.

    There are ``rounds`` of so many ``decisions`` of each world. In the first the teacher drives all worlds, in the last
    the policy does. After each all rounds are learned from ``epochs`` times.
    """

    planner: str | None
    rounds: PositiveInt
    decisions: PositiveInt
    epochs: PositiveInt
    minibatch: PositiveInt
    learning_rate: Positive


@dataclass(frozen=True, slots=True)
class RewardSchedule:
    """What changes after this ``share`` of the steps: numbers of the reward; None: nothing does."""

    share: Fraction
    reward: dict[str, float] | None


@dataclass(frozen=True, slots=True)
class TrainingSettings:
    """What a training is beside its environment; ``checkpoint`` is the time in s after which one is written.

    With 0 ``total_steps`` a policy is what its teacher taught it. Later rewards fade to 1/e over ``horizon`` s, where
    that is not None. Exploration keeps its direction for ``exploration_time`` s (Raffin, Kober and Stulp 2021); where
    None, each decision has noise of its own. ``allow_unpaid`` lets rewards be learned from that pay nobody.
    """

    planner: str
    seed: NonNegativeInt
    total_steps: NonNegativeInt
    device: str
    teacher: ExpertSettings
    later: RewardSchedule
    horizon: Positive | None
    exploration_time: Positive | None
    allow_unpaid: bool
    threads: PositiveInt
    network: Network
    start: Start
    critic: Literal["observed", "truth"]
    truth: TruthSettings
    levels: Literal["promote", "mixture"]
    mixture: Mixture
    checkpoint: NonNegative
    validation: Validation
    test: Test
    optimization: Optimization

    def __post_init__(self) -> None:
        if self.seed > GREATEST_SEED:
            raise ConfigurationError(f"seed is {self.seed}; allowed: 0 .. {GREATEST_SEED}")
        if self.teacher.planner is not None and self.start.policy is not None:
            raise ConfigurationError(
                f"teacher.planner is {self.teacher.planner}; allowed: null with training.start.policy"
            )
        if (self.horizon is None) == (self.optimization.gamma is None):
            raise ConfigurationError(
                f"training.optimization.gamma is {self.optimization.gamma}; allowed: null with a horizon, "
                "a number without"
            )
        self._check_exploration()
        if self.teacher.planner is None and self.total_steps == 0:
            raise ConfigurationError("total_steps is 0; allowed: 1 or more without a teacher")

    def _check_exploration(self) -> None:
        network = self.network
        if self.exploration_time is not None and (network.log_std_final is not None or network.log_std_unit == "si"):
            raise ConfigurationError(
                f"exploration_time is {self.exploration_time:g}; allowed: null where training.network.log_std_final is "
                "a number or log_std_unit is si"
            )

    def discount(self, decision_period: float) -> float:
        """Return the discount from one decision of so many s to the next."""
        if self.horizon is None:
            assert self.optimization.gamma is not None
            return self.optimization.gamma
        return math.exp(-decision_period / self.horizon)

    @property
    def begins_able(self) -> bool:
        """Return whether the policy can drive when it begins to learn from rewards."""
        return self.teacher.planner is not None or self.start.policy is not None
