"""CADRL and SARL: they look one step ahead, and ask a value network what that leads to."""

from __future__ import annotations

from typing import ClassVar

from arena_cadrl.policy import load_value_policy
from arena_core import ConfigurationError, EpisodeStart, Observation, Planner, Robot, Twist
from arena_core.parameters import NonNegative
from arena_policies.body import body_mismatch
from arena_policies.card import PolicyCard
from arena_policies.learning_facts import learned_by
from arena_policies.planner import shipped_policy


class ValuePlanner(Planner):
    """Drives the velocity whose step and what it leads to are worth most; it keeps
    nothing from one step to the next.
    """

    compiles: ClassVar[bool] = True

    def __init__(self, name: str, robot: Robot, policy: str | None, margin: NonNegative) -> None:
        address = policy or shipped_policy(name, name, robot)
        self._name, self._policy = name, load_value_policy(address, name, robot, margin)
        self.untuned = body_mismatch(name, self._policy.card.training, robot)
        self.learned_by = learned_by(self._policy.card.training)

    @property
    def card(self) -> PolicyCard:
        """Return the policy's card."""
        return self._policy.card

    def reset(self, episode: EpisodeStart) -> None:
        """Raise ConfigurationError for another control period than the policy was trained with."""
        trained = self._policy.card.control_period
        if abs(episode.control_period - trained) > 1e-9:
            raise ConfigurationError(
                f"{self._name}: planner.control_period is {episode.control_period:g}; allowed: {trained:g}, "
                "as the policy was trained"
            )

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the best velocity; raise NoValidCommand where nothing keeps clear of what stands around."""
        return self._policy.command(observation)


class Cadrl(ValuePlanner):
    """Values of robot and each person alone, of which the least counts (Chen, Liu, Everett and How 2017)."""

    def __init__(self, robot: Robot, policy: str | None, margin: NonNegative) -> None:
        super().__init__("cadrl", robot, policy, margin)


class Sarl(ValuePlanner):
    """Values of robot and all people together, by attention (Chen, Liu, Kreiss and Alahi 2019)."""

    def __init__(self, robot: Robot, policy: str | None, margin: NonNegative) -> None:
        super().__init__("sarl", robot, policy, margin)
