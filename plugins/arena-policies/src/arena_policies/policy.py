"""Policies that drive: an ONNX file, held to its card and to the robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    EarlierScans,
    InputFileError,
    InvalidCommand,
    NoValidCommand,
    Observation,
    ObservationBatch,
    ObservationEncoder,
    ObservationField,
    Robot,
    ScanMemory,
    Twist,
)
from arena_core.files import local_path
from arena_core.hosting import load_registry
from arena_core.parameters import read_settings
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.card import PolicyCard, content_sha256, part_path, read_card
from arena_policies.encoding import all_finite, without_body_radius
from arena_policies.network import Network, network_content, open_network
from arena_policies.observation_view import batch_of_one


class PolicyNetwork:
    """Observation to the network's answers; the same in every process, one thread each."""

    def __init__(self, network: Network, encoder: ObservationEncoder, card: PolicyCard) -> None:
        self._network, self._encoder = network, encoder
        self._memory: ScanMemory | None = None
        self._earlier = ScanMemory((), 1, 0).earlier()
        self._recalled = encoder.blank(1)
        self.card = card

    def begin(self) -> None:
        """Forget what was seen before."""
        self._memory, self._recalled = None, self._encoder.blank(1)

    def observe(self, observation: Observation, last_command: Twist) -> None:
        """See what there is at one more control step, without an answer."""
        seen = self._make_batch(observation, last_command)
        if self._encoder.recurrent:
            self._encode_batch(seen)

    def run(self, numbers: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the network's answers (N, A) to numbers (N, D) as its encoder writes them."""
        return self._network.run(numbers)

    def network_outputs(self, observation: Observation, last_command: Twist) -> NDArray[np.float32]:
        """Return the network's answers (1, A) to one more control step.

        Raises NoValidCommand when something that is seen is not a number, InvalidCommand when an answer is none: that
        is a broken policy.
        """
        numbers = self._encode_batch(self._make_batch(observation, last_command))
        if not all_finite(numbers):
            raise NoValidCommand(f"{self.card.planner}: the observation has values that are not finite")
        answers = self.run(numbers)
        if not all_finite(answers):
            raise InvalidCommand(f"{self.card.planner}: the policy answered with values that are not finite")
        return answers

    def _make_batch(self, observation: Observation, last_command: Twist) -> ObservationBatch:
        return batch_of_one(
            observation, last_command, self._earlier_scans(observation), self._recalled, tracked=self._encoder.tracked
        )

    def _earlier_scans(self, observation: Observation) -> EarlierScans:
        """Return the scans that the encoder looks back at, and remember the one now."""
        ranges = np.ascontiguousarray(observation.scan.ranges, np.float32)[None]
        if self._memory is None:
            self._memory = ScanMemory(self._encoder.lookback, 1, ranges.shape[1])
            self._memory.begin(np.zeros(1, np.int64), ranges, observation.pose.array()[None])
            self._earlier = self._memory.earlier()
        elif self._encoder.lookback:
            self._memory.remember(ranges, observation.pose.array()[None])
            self._earlier = self._memory.earlier()
        return self._earlier

    def _encode_batch(self, seen: ObservationBatch) -> NDArray[np.float32]:
        """Return the encoder's numbers, and recall them at the next step, unless some are none."""
        numbers = self._encoder.encode(seen)
        if self._encoder.recurrent and all_finite(numbers):
            self._recalled = numbers
        return numbers


class Policy(PolicyNetwork):
    """Observation to velocity: encoder, network, scaling."""

    def __init__(self, network: Network, encoder: ObservationEncoder, scale: ActionScale, card: PolicyCard) -> None:
        super().__init__(network, encoder, card)
        self._scale = scale

    def command(self, observation: Observation, last_command: Twist) -> Twist:
        """Return the velocity for what is seen; raise what ``answers`` raises."""
        return Twist(*self._scale.commands(self.network_outputs(observation, last_command))[0].tolist())


class Switch(PolicyNetwork):
    """Observation to which of the card's members drives."""

    def choose_member(
        self, observation: Observation, last_command: Twist, driving: int | None = None, margin: float = 0.0
    ) -> int:
        """Return the place of the member that the network prefers, or of the one that is ``driving`` where no other is
        preferred to it by more than ``margin``; raise what ``answers`` raises.
        """
        answers = self.network_outputs(observation, last_command)[0]
        best = int(answers.argmax())
        return best if driving is None or answers[best] > answers[driving] + margin else driving


def load_policy(address: str, planner: str, robot: Robot) -> Policy:
    """Load ``address`` (a path or pkg://) with its card; raise InputFileError or ConfigurationError where
    they or the robot do not fit.
    """
    path, content, card, encoder, scale = _read_policy(address, planner, robot)
    return Policy(open_network(path, content, sum(f.size for f in card.layout), len(card.action)), encoder, scale, card)


def load_switch(address: str, planner: str, robot: Robot) -> Switch:
    """Load a policy that chooses among members, as ``load_policy`` does; raise
    ConfigurationError where its card has none.
    """
    path, content, card, encoder, _ = _read_policy(address, planner, robot)
    if len(card.members) < 2:
        raise ConfigurationError(
            f"{path.with_suffix('.json')}: members are {', '.join(card.members) or 'none'}; allowed: two or more"
        )
    return Switch(open_network(path, content, sum(f.size for f in card.layout), len(card.members)), encoder, card)


def _read_policy(
    address: str, planner: str, robot: Robot
) -> tuple[Path, bytes, PolicyCard, ObservationEncoder, ActionScale]:
    """Return file, content, card, encoder and scaling of a policy that fits planner and robot."""
    path = local_path(address)
    content = network_content(path)
    card = read_card(path.with_suffix(".json"))
    check_card(path, card, content, planner, robot)
    beside = path.with_suffix(".json")
    encoder = build_encoder(f"{beside}: encoder", {**card.encoder, **_part_files(path, card)}, robot)
    _check_parts(beside, card, encoder)
    check_layout(beside, card.robot, card.layout, encoder.layout())
    return path, content, card, encoder, _action_scale(beside, card, robot)


def _part_files(path: Path, card: PolicyCard) -> dict[str, str]:
    """Return the networks that the encoder runs; raise InputFileError where one is
    not what the policy was trained on.
    """
    found = {name: part_path(path, name) for name in card.parts}
    for name, part in found.items():
        made = content_sha256(network_content(part))
        if made != card.parts[name]:
            raise InputFileError(
                f"{part}: sha256 is {made[:12]}…, the card of {path.name} says {card.parts[name][:12]}…; "
                f"allowed: the {name} that the policy was trained on"
            )
    return {name: str(part) for name, part in found.items()}


def check_card(path: Path, card: PolicyCard, content: bytes, planner: str, robot: Robot) -> None:
    """Raise for a file that its card was not made for, and for another planner's or kinematics' policy."""
    beside = path.with_suffix(".json")
    if content_sha256(content) != card.sha256:
        raise InputFileError(
            f"{path}: sha256 is {content_sha256(content)[:12]}…, its card says {card.sha256[:12]}…; allowed: "
            "the file the card was made for"
        )
    if card.planner != planner:
        raise ConfigurationError(f"{beside}: planner is {card.planner}; allowed: a policy for {planner}")
    if card.kinematics != robot.kinematics:
        raise ConfigurationError(
            f"{beside}: trained for {card.robot} ({card.kinematics}); allowed: "
            f"a policy for {robot.name} ({robot.kinematics})"
        )


def build_encoder(where: str, told: Mapping[str, Any], robot: Robot) -> ObservationEncoder:
    """Build the encoder that a card tells of at ``where``; raise ConfigurationError where what
    is installed has none like it.
    """
    try:
        encoder: ObservationEncoder = load_registry().build("observation_encoder", told, robot=robot)
    except ConfigurationError as error:
        raise ConfigurationError(f"{where}: {error}") from error
    return encoder


def _check_parts(beside: Path, card: PolicyCard, encoder: ObservationEncoder) -> None:
    """Refuse a policy whose encoder runs networks of elsewhere: it would not travel whole."""
    if card.parts.keys() != encoder.parts().keys():
        raise InputFileError(
            f"{beside}: parts are {', '.join(card.parts) or 'none'}; allowed: what its encoder runs, "
            f"{', '.join(encoder.parts()) or 'none'}"
        )


def check_layout(path: Path, robot: str, trained: Sequence[ObservationField], made: Sequence[ObservationField]) -> None:
    """Refuse a robot whose sensors make other fields than those that a network was trained on, with
    ``robot``; its body may be another.
    """
    pairs = [(without_body_radius(a), without_body_radius(b)) for a, b in zip(trained, made, strict=False)]
    if len(trained) != len(made) or any(a != b for a, b in pairs):
        differing = next((f"{a.name} ({a.meaning})" for a, b in pairs if a != b), "number of fields")
        raise ConfigurationError(
            f"{path}: the observation of {robot} differs from this robot's in {differing}; allowed: one trained for it"
        )


def _action_scale(beside: Path, card: PolicyCard, robot: Robot) -> ActionScale:
    """Return what actions mean; refuse a robot whose speeds differ from those that the policy was trained with."""
    scale = ActionScale.of(robot, read_settings(card.action_range, ActionRange, f"{beside}: action_range"))
    ends = dict(zip(scale.names, zip(scale.low.tolist(), scale.high.tolist(), strict=True), strict=True))
    if {name: tuple(limits) for name, limits in card.action.items()} != ends:
        raise ConfigurationError(f"{beside}: actions are {dict(card.action)}; allowed: those of this robot, {ends}")
    return scale
