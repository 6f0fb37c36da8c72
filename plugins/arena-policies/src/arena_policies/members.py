"""Planners that a switch chooses among, of which one drives at a time."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

from arena_core import Candidate, ConfigurationError, EpisodeStart, Observation, Planner, Robot, Twist
from arena_core.hosting import NAVIGATOR_KEYS, Registry, UnknownComponent
from arena_policies.card import content_sha256
from arena_policies.planner import PolicyPlanner

Node = Mapping[str, Any]


class Members:
    """Some planners by name, one of which drives; one that takes over begins again, unless it
    runs a policy and so has looked on.
    """

    def __init__(self, planners: Mapping[str, Planner]) -> None:
        self.names = tuple(planners)
        self.planners = dict(planners)
        self._planners = list(planners.values())
        self.untuned = tuple(note for planner in planners.values() for note in planner.untuned)
        self._driving: int | None = None

    def reset(self, episode: EpisodeStart) -> None:
        """Begin an episode."""
        self._episode, self._driving = episode, None
        self._begun = episode.random.bit_generator.state
        for planner in self._planners:
            planner.reset(episode)

    def warm_up(self, observation: Observation) -> None:
        """Let each that compiles decide once for nothing, so that no compiler works in the middle of an episode;
        nothing else remains of it.
        """
        random = self._episode.random.bit_generator
        now = random.state
        for planner in self._planners:
            if planner.compiles:
                with suppress(Exception):  # what is wrong will be wrong again, and is then reported
                    planner.compute_velocity(observation)
        random.state = self._begun
        self.reset(self._episode)
        random.state = now

    def drive(self, chosen: int, observation: Observation) -> Twist:
        """Return the velocity of the member in this place; raise NoValidCommand when it has none."""
        _ = observation.local_map, observation.tracks  # kept up to date for whoever takes over and asks for them
        planner = self._planners[chosen]
        if self._driving not in (None, chosen) and not isinstance(planner, PolicyPlanner):
            planner.reset(self._episode)
        self._driving = chosen
        command = Twist(0.0)
        try:
            command = planner.compute_velocity(observation)
        finally:  # where there is none, the robot brakes
            for other in self._planners:
                if other is not planner and isinstance(other, PolicyPlanner):
                    other.observe_other(observation, command)
        return command

    def considered(self) -> Sequence[Candidate] | None:
        """Return what the member that drove last weighed; None where none has driven yet, or that one does not tell."""
        return None if self._driving is None else self._planners[self._driving].considered()


def build_members(
    nodes: Mapping[str, Node], order: Sequence[str], robot: Robot, registry: Registry, key: str
) -> dict[str, Planner]:
    """Build the members of these names, in this order, from their configurations; raise
    ConfigurationError where one cannot be.
    """
    return {name: _build_member(nodes[name], robot, registry, f"{key}.{name}") for name in order}


def _build_member(node: Node, robot: Robot, registry: Registry, key: str) -> Planner:
    period = node.get("control_period")
    if period is not None and not (isinstance(period, (int, float)) and abs(period - robot.control_period) <= 1e-9):
        raise ConfigurationError(
            f"{key}.control_period is {period!r}; allowed: {robot.control_period:g}, the robot's, for all members"
        )
    try:
        planner: Planner = registry.build("planner", _own_config(node), robot=robot)
    except UnknownComponent as error:
        raise ConfigurationError(f"{key} is not installed: {error}") from error
    return planner


def member_hash(node: Node, planner: Planner) -> str:
    """Return the hash that names a member: its configuration and, where it runs a policy, what
    that one's card says it does.
    """
    content = _own_config(node)
    if isinstance(planner, PolicyPlanner):
        card = planner.card
        content["policy"] = [card.sha256, card.encoder, card.action, card.action_range, card.parts]
    return content_sha256(json.dumps(_as_floats(content), sort_keys=True).encode())


def _as_floats(value: Any) -> Any:
    """Return a configuration with all its numbers as floats: 1 and 1.0 are the same."""
    if isinstance(value, Mapping):
        return {key: _as_floats(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_as_floats(each) for each in value]
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _own_config(node: Node) -> dict[str, Any]:
    """Return a planner's configuration without what its navigator reads."""
    return {key: value for key, value in node.items() if key not in NAVIGATOR_KEYS}


def describe_members(
    nodes: Mapping[str, Node], planners: Mapping[str, Planner], registry: Registry
) -> dict[str, dict[str, str]]:
    """Return what a card says of its members: hash, distribution and version."""
    described = {}
    for name, planner in planners.items():
        distribution, version = registry.component("planner", nodes[name]["name"]).distribution()
        described[name] = {
            "sha256": member_hash(nodes[name], planner),
            "distribution": distribution,
            "version": version,
        }
    return described
