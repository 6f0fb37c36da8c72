"""AIO: a policy that chooses which of several planners drives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from arena_core import Candidate, ConfigurationError, EpisodeStart, Observation, Planner, Robot, Twist, random_generator
from arena_core.hosting import load_registry
from arena_core.parameters import NonNegative, PositiveInt
from arena_policies.body import body_mismatch
from arena_policies.learning_facts import learned_by
from arena_policies.members import Members, build_members, member_hash
from arena_policies.planner import shipped_policy
from arena_policies.policy import Switch, load_switch

DEFAULT = ("arena-rosnav", "arena-teb", "arena-mpc")  # what the extra arena-aio[default] brings


class Aio(Planner):
    """Let a policy choose among ``members`` at every ``every``-th control step (Kaestner et al. 2021, All-in-One).

    ``policy`` is an ONNX file with its card beside it; None takes the one that is installed for robot and
    ``recipe``. With ``choice`` random a member is drawn in its place, of the same ones: what the policy has to be
    better than. Another member takes over where the policy prefers it to the one that drives by more than
    ``hysteresis``. ``chosen`` counts the decisions of the episode by member. Raises ConfigurationError where the policy
    was trained with another ``every``.
    """

    compiles: ClassVar[bool] = True

    def __init__(
        self,
        robot: Robot,
        policy: str | None,
        every: PositiveInt,
        choice: Literal["policy", "random"],
        members: Mapping[str, Mapping[str, Any]],
        recipe: str = "aio",
        hysteresis: NonNegative = 0.0,
    ) -> None:
        self._switch = load_switch(policy or shipped_policy("aio", recipe, robot), recipe, robot)
        if every != self._switch.card.every:
            raise ConfigurationError(
                f"planner.every is {every}; allowed: {self._switch.card.every}, as the policy was trained"
            )
        self._members = fitting_members(self._switch, members, robot)
        body = body_mismatch(recipe, self._switch.card.training, robot)
        self.untuned = body + self._members.untuned + changed_members(self._switch, members, self._members)
        self._every, self._at_random, self._hysteresis = every, choice == "random", hysteresis
        self.learned_by = "" if self._at_random else learned_by(self._switch.card.training)
        self._random = random_generator(0, "aio", "switch")
        self._rehearsed = False
        self._begin_episode()

    def reset(self, episode: EpisodeStart) -> None:
        """Begin at rest, with all members; raise ConfigurationError for another control period
        than the policy was trained with.
        """
        trained = self._switch.card.control_period
        if abs(episode.control_period - trained) > 1e-9:
            raise ConfigurationError(
                f"aio: planner.control_period is {episode.control_period:g}; allowed: {trained:g}, "
                "as the policy was trained"
            )
        self._members.reset(episode)
        self._switch.begin()
        # apart from the members' stream
        self._random = np.random.Generator(np.random.Philox(key=int(episode.random.integers(2**63))))
        self._begin_episode()

    def _begin_episode(self) -> None:
        self._steps, self._last, self._driving = 0, Twist(0.0), 0
        self.chosen = dict.fromkeys(self._members.names, 0)

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the velocity of the member that drives; raise NoValidCommand where it has none, or the
        observation is no number.
        """
        if not self._rehearsed:
            self._rehearsed = True
            self._members.warm_up(observation)
        last, self._last = self._last, Twist(0.0)  # the brake, unless a member says otherwise
        if self._steps % self._every == 0:
            self._driving = self._choose_member(observation, last)
        else:
            self._switch.observe(observation, last)
        self._steps += 1
        self._last = self._members.drive(self._driving, observation)
        return self._last

    def considered(self) -> Sequence[Candidate] | None:
        """Return what the member that drives weighed; None where that one does not tell."""
        return self._members.considered()

    def driving(self) -> str:
        """Return the name of the member that drives."""
        return self._members.names[self._driving]

    def _choose_member(self, observation: Observation, last: Twist) -> int:
        current = self._driving if self._steps and self._hysteresis else None  # at first no one drives
        choice = self._switch.choose_member(observation, last, current, self._hysteresis)
        if self._at_random:
            choice = int(self._random.integers(len(self._members.names)))
        self.chosen[self._members.names[choice]] += 1
        return choice


def fitting_members(switch: Switch, nodes: Mapping[str, Mapping[str, Any]], robot: Robot) -> Members:
    """Build the members that a policy was trained to choose among; raise ConfigurationError
    where one is missing or one too many.
    """
    wanted = switch.card.members
    for name, member in wanted.items():
        if name not in nodes:
            extra = " (arena-aio[default])" if member["distribution"] in DEFAULT else ""
            raise ConfigurationError(
                f"aio: member {name} is not installed, or not in planner.members; "
                f"install {member['distribution']}{extra}"
            )
    for name in nodes:
        if name not in wanted:
            raise ConfigurationError(
                f"planner.members has {name}, which the policy was not trained with; allowed: {', '.join(wanted)}"
            )
    return Members(build_members(nodes, tuple(wanted), robot, load_registry(), "planner.members"))


def changed_members(switch: Switch, nodes: Mapping[str, Mapping[str, Any]], members: Members) -> tuple[str, ...]:
    """Return a line for each member that is not as the policy's card says it was in its training."""
    wanted = {name: member["sha256"] for name, member in switch.card.members.items()}
    hashes = {name: member_hash(nodes[name], planner) for name, planner in members.planners.items()}
    return tuple(
        f"aio: member {name} is not as it was when the policy was trained"
        for name in hashes
        if hashes[name] != wanted[name]
    )
