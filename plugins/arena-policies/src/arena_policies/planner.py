"""What planners that follow a policy have in common."""

from __future__ import annotations

from typing import ClassVar

from arena_core import ConfigurationError, EpisodeStart, Observation, Planner, Robot, Twist
from arena_core.files import local_path
from arena_core.hosting import UnknownComponent, load_registry
from arena_policies.body import body_mismatch
from arena_policies.card import PolicyCard
from arena_policies.learning_facts import learned_by
from arena_policies.policy import load_policy


class PolicyPlanner(Planner):
    """Asks a policy at every ``card.every``-th control step; it remembers its last command, and scans where the policy
    looks back.

    ``policy`` is the address of an ONNX file with its card beside it, ``name`` the recipe that it was trained by.
    """

    compiles: ClassVar[bool] = True  # the encoder's kernels

    def __init__(self, name: str, robot: Robot, policy: str) -> None:
        self._name = name
        self._policy = load_policy(policy, name, robot)
        self.untuned = body_mismatch(name, self._policy.card.training, robot)
        self.learned_by = learned_by(self._policy.card.training)
        self._last = Twist(0.0)
        self._held = 0  # control steps for which the last command still holds

    def reset(self, episode: EpisodeStart) -> None:
        """Begin at rest; raise ConfigurationError for another control period than the policy was trained with."""
        trained = self._policy.card.control_period
        if abs(episode.control_period - trained) > 1e-9:
            raise ConfigurationError(
                f"{self._name}: planner.control_period is {episode.control_period:g}; allowed: {trained:g}, "
                "as the policy was trained"
            )
        self._last, self._held = Twist(0.0), 0
        self._policy.begin()

    @property
    def card(self) -> PolicyCard:
        """Return the policy's card."""
        return self._policy.card

    def observe_other(self, observation: Observation, command: Twist) -> None:
        """See a control step at which another planner drove, by ``command``."""
        self._policy.observe(observation, self._last)
        self._last, self._held = command, 0

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the policy's velocity; raise NoValidCommand where the observation is no number."""
        if self._held:
            self._policy.observe(observation, self._last)
        else:
            last, self._last = self._last, Twist(0.0)  # where there is no command, the robot brakes
            self._last, self._held = self._policy.command(observation, last), self._policy.card.every
        self._held -= 1
        return self._last


def shipped_policy(planner: str, recipe: str, robot: Robot) -> str:
    """Return the address of a planner's policy that was trained by a recipe for a robot.

    Any distribution may bring it, by the hook ``register_policies``. Raises ConfigurationError where none does.
    """
    folder = _policy_folder(planner, recipe)
    there = sorted(path.stem for path in local_path(f"{folder}/x").parent.glob("*.onnx") if "." not in path.stem)
    if robot.name not in there:
        raise ConfigurationError(
            f"{recipe}: no policy for {robot.name} (`arena train planner={recipe} robot={robot.name}` trains one); "
            f"allowed: {''.join(f'{each}, ' for each in there)}{'or ' * bool(there)}planner.policy=FILE"
        )
    return f"{folder}/{robot.name}.onnx"


def _policy_folder(planner: str, recipe: str) -> str:
    registry = load_registry()
    try:
        return str(registry.component("policy", f"{planner}/{recipe}").factory)
    except UnknownComponent as error:
        own = [name.partition("/")[2] for name in registry.names("policy") if name.startswith(f"{planner}/")]
        reason = f"{error}; " if "comes with" in str(error) else ""
        raise ConfigurationError(
            f"{planner}: no policies of {recipe!r}; {reason}allowed: {', '.join(own)}, or planner.policy=FILE"
        ) from None
