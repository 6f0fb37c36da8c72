"""How good a policy is, on problems that it never trained on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError
from arena_core.commands import interrupts
from arena_gym.building import build_parts
from arena_gym.seeds import check_unseen_seed
from arena_gym.vector_environment import NavigationVectorEnv

WORLDS = 32  # driven in step in an evaluation
SWITCHED = 8  # likewise where an action chooses a planner: worlds that wait for the slowest one cost as much as its own
Act = Callable[[NDArray[np.float32]], NDArray[np.floating]]


class EvaluationListener(Protocol):
    """What hears how far an evaluation is."""

    def begin(self, quota: NDArray[np.int64]) -> None:
        """Take in how many episodes each world drives, (N,)."""
        ...

    def step(self, ended: NDArray[np.bool_]) -> None:
        """Take in that all worlds have made a step, and which episodes ended with it, (N,)."""
        ...


@dataclass(frozen=True, slots=True)
class Score:
    """Shares of ``episodes``: ``success`` without any collision, ``collision``, ``time_out``."""

    episodes: int
    success: float
    collision: float
    time_out: float

    def as_row(self) -> dict[str, float]:
        """Return the score as plain numbers."""
        return asdict(self)


def unseen_worlds(config: Mapping[str, Any], episodes: int, seed: int, name: str) -> NavigationVectorEnv:
    """Return worlds and problems that no training meets, on the last level, with all people; the first collision ends
    an episode.

    A switch decides as often as it will when it drives, however long its training holds a choice. Robots have the real
    parts of their guides, whatever model of them leads them in training.

    Raises ConfigurationError where ``seed``, called ``name``, is the training's.
    """
    own = config["environment"]
    environment = {
        **own,
        "seed": check_unseen_seed(seed, own["seed"], name),
        "collisions_to_end": 1,
        "standing_to_end": None,
    }
    changed = {"environment": environment, "randomization": {**config["randomization"], "people": None}}
    if config.get("guide") is not None:
        changed["guide"] = {key: value for key, value in config["guide"].items() if key != "model"}
    if config.get("switch") is not None:
        changed["switch"] = {**config["switch"], "held": 1}
    parts = build_parts({**config, **changed})
    env = NavigationVectorEnv(min(WORLDS if parts.switch is None else SWITCHED, episodes), parts=parts)
    if parts.pool.staging is not None:
        env.set_stage(parts.pool.staging.levels - 1)
    return env


def check_distinct_seeds(config: Mapping[str, Any]) -> None:
    """Raise ConfigurationError unless training, validation and test have seeds of their own."""
    trained, validated = config["environment"]["seed"], config["training"]["validation"]["seed"]
    check_unseen_seed(validated, trained, "training.validation.seed")
    tested = check_unseen_seed(config["training"]["test"]["seed"], trained, "training.test.seed")
    if tested == validated:
        raise ConfigurationError(
            f"training.test.seed is {tested}; allowed: any other than training.validation.seed, which chooses weights"
        )


def evaluate_policy(
    env: NavigationVectorEnv, act: Act, episodes: int, seed: int, listener: EvaluationListener | None = None
) -> Score:
    """Return how well ``act`` drives in the first episodes of each world."""
    ended = episode_outcomes(env, act, episodes, seed, listener)
    return Score(
        len(ended), *(ended.count(outcome) / len(ended) for outcome in ("goal_reached", "collision", "time_out"))
    )


def episode_outcomes(
    env: NavigationVectorEnv, act: Act, episodes: int, seed: int, listener: EvaluationListener | None = None
) -> list[str]:
    """Drive the first episodes of each world until there are ``episodes`` of them; return how they ended, world by
    world.

    One with a collision, even in the step that reached the goal, ended by that.

    Each world contributes its first episodes, however long they take: the fastest to end would be the easy ones.
    Episodes at one place of two answers are the same problem, whoever drives.
    """
    quota = np.full(env.num_envs, episodes // env.num_envs)
    quota[: episodes % env.num_envs] += 1
    if listener is not None:
        listener.begin(quota)
    ended: list[list[str]] = [[] for _ in range(env.num_envs)]
    observations = env.reset(seed=seed)[0]
    while any(len(world) < wanted for world, wanted in zip(ended, quota.tolist(), strict=True)):
        interrupts.check()
        observations, _, terminated, truncated, ends = env.step(act(observations))
        if listener is not None:
            listener.step(terminated | truncated)
        for slot in np.flatnonzero(terminated | truncated).tolist():
            if len(ended[slot]) < quota[slot]:
                info = ends["final_info"]
                ended[slot].append("collision" if info["collisions"][slot] else str(info["outcome"][slot]))
    return [outcome for world in ended for outcome in world]
