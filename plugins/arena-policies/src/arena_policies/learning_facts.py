"""How a policy learned, in a few words, by what its card says of its training."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

NOT_TOLD = "learned, its card does not tell how"


def learned_by(training: Mapping[str, Any]) -> str:
    """Return from whom or from what a policy learned, for how long, with which seed.

    A card is for people to read: what it does not tell is left out.
    """
    config = _mapping(training.get("config"))
    teacher = _mapping(config.get("teacher")).get("planner") or _mapping(config.get("trainer")).get("teacher")
    steps, reward = training.get("steps"), _mapping(config.get("reward")).get("name")
    rewarded = isinstance(steps, int) and steps > 0 and reward is not None
    begun = training.get("start_learned_by")  # by what the weights were made that it went on from
    ways = [begun] if isinstance(begun, str) else []
    ways += [f"imitation of {teacher}"] * bool(teacher)
    if forks := _mapping(training.get("forks")):
        ways.append(f"forks of {forks.get('states')} states")
    ways += [f"rewards ({reward}), {steps} steps"] * rewarded
    if not ways:
        return NOT_TOLD
    seed = training.get("seed")
    return f"{', then '.join(ways)}" + (f", seed {seed}" if isinstance(seed, int) else "")


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}
