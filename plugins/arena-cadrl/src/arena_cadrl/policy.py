"""Value networks that drive: an ONNX file, held to its card and to the robot."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_cadrl.perception import Perception, StateSettings
from arena_core import ConfigurationError, NoValidCommand, Observation, Robot, Twist
from arena_core.files import local_path
from arena_core.parameters import read_settings
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.card import PolicyCard, read_card
from arena_policies.network import Network, network_content, open_network
from arena_policies.policy import check_card, check_layout


class ValuePolicy:
    """Observation to velocity: the action whose step and the value of what it leads to are worth most."""

    def __init__(self, network: Network, eyes: Perception, card: PolicyCard) -> None:
        self._network, self._perception = network, eyes
        self.card = card

    def command(self, observation: Observation) -> Twist:
        """Return the best velocity that the safety layer allows; raise NoValidCommand where there is none."""
        sight = self._perception.observe(observation)
        values: NDArray[np.float32] = self._network.run(sight.ahead)[:, 0]
        if not np.isfinite(values).all():
            raise NoValidCommand(f"{self.card.planner}: the value network answered with values that are not finite")
        chosen = sight.best_action(values)
        if chosen is None:
            raise NoValidCommand(f"{self.card.planner}: no velocity keeps the footprint clear of what stands around")
        return Twist(*sight.commands[chosen].tolist())


def load_value_policy(address: str, planner: str, robot: Robot, margin: float) -> ValuePolicy:
    """Load ``address`` (a path or pkg://) with its card, to keep ``margin`` m off people.

    Raises InputFileError or ConfigurationError where they or the robot do not fit.
    """
    path = local_path(address)
    content = network_content(path)
    beside = path.with_suffix(".json")
    card = read_card(beside)
    check_card(path, card, content, planner, robot)
    range_ = read_settings(card.action_range, ActionRange, f"{beside}: action_range")
    eyes = Perception(robot, range_, read_settings(card.encoder, StateSettings, f"{beside}: encoder"), margin)
    check_layout(beside, card.robot, card.layout, eyes.layout())
    ends = action_ends(robot, range_)
    if {name: tuple(limits) for name, limits in card.action.items()} != ends:
        raise ConfigurationError(f"{beside}: actions are {dict(card.action)}; allowed: those of this robot, {ends}")
    return ValuePolicy(open_network(path, content, eyes.size, 1), eyes, card)


def action_ends(robot: Robot, range_: ActionRange) -> dict[str, tuple[float, float]]:
    """Return the least and the greatest of each velocity that may be chosen, m/s and rad/s."""
    scale = ActionScale.of(robot, range_)
    return dict(zip(scale.names, zip(scale.low.tolist(), scale.high.tolist(), strict=True), strict=True))
