"""What a world model is worth: whether it foresees more than that nothing changes, and whether the
controller needs its memory.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, InputFileError
from arena_core.files import local_path
from arena_core.hosting import load_registry
from arena_core.parameters import read_settings
from arena_gym.settings import EnvironmentSettings
from arena_gym.training.evaluation import episode_outcomes, unseen_worlds
from arena_gym.vector_environment import NavigationVectorEnv
from arena_navrep.prediction import prediction_errors, sequences_of
from arena_navrep.rollouts import read_rollouts
from arena_navrep.training.settings import Recording
from arena_navrep.world_model import check_fit, load_part
from arena_policies.card import PolicyCard, part_path, read_card
from arena_policies.encoding import field_columns
from arena_policies.policy import load_policy

WORLDS = (
    "environment",
    "global_planner",
    "pedestrians",
    "randomization",
    "reward",
    "robot",
    "simulator",
    "task",
    "waypoints",
    "world",
)

Numbers = NDArray[np.float32]


def prediction_report(folder: Path) -> str:
    """Return how well the networks of a world model's folder foresee the codes of its test roll-outs."""
    vision, memory = (load_part(str(folder / f"{part}.onnx"), part) for part in ("vision", "memory"))
    check_fit(memory, vision)
    beside = memory.path.with_suffix(".json")
    with _naming_card(beside):
        recording = read_settings(
            _config_sections(beside, memory.card.training, ("recording",))["recording"], Recording, "recording"
        )
    sequences = sequences_of(read_rollouts(folder, "test", recording.test_files), vision, vision.card.layout)
    errors = prediction_errors(sequences, memory.run, memory.card.hidden)
    share = (errors["prediction"] / errors["persistence"]) ** 2
    return (
        f"next code, {sequences.begins.size} steps of unseen worlds: error {errors['prediction']:.3f} as foreseen, "
        f"{errors['persistence']:.3f} if nothing changed; {share:.2f} of its mean square"
    )


def memory_ablation(address: str, episodes: int, seed: int) -> str:
    """Return a controller's success in unseen problems as it is, and with a memory h that it sees as zeros."""
    path = local_path(address)
    beside = path.with_suffix(".json")
    training = read_card(beside).training
    config = _config_sections(beside, training, WORLDS)
    if training["config"].get("guide") is not None:  # else it learned at the true pose
        config |= _config_sections(beside, training, ("guide",))
    with _naming_card(beside):
        robot = load_registry().build("robot", config["robot"])
    policy = load_policy(address, "navrep", robot)
    if "h" not in [field.name for field in policy.card.layout]:
        raise ConfigurationError(f"{path}: sees no memory; allowed: a policy whose encoder has one")
    hidden = field_columns(policy.card.layout, "h")
    env = _make_unseen_env(path, policy.card, config, episodes, seed)

    def forgetful(seen: Numbers) -> Numbers:
        shown = seen.copy()
        shown[:, hidden] = 0.0
        return policy.run(shown)

    return _compare_outcomes(*(episode_outcomes(env, act, episodes, seed) for act in (policy.run, forgetful)))


def _make_unseen_env(
    path: Path, card: PolicyCard, config: Mapping[str, Any], episodes: int, seed: int
) -> NavigationVectorEnv:
    """Return worlds that the training of a policy did not meet."""
    networks = {name: str(part_path(path, name)) for name in card.parts}
    own = {"observation_encoder": {**card.encoder, **networks}, "action": card.action_range}
    with _naming_card(path.with_suffix(".json")):
        read_settings(config["environment"], EnvironmentSettings, "environment")
        return unseen_worlds({**config, **own}, episodes, seed, "seed")


def _config_sections(path: Path, training: Mapping[str, Any], names: Sequence[str]) -> dict[str, Any]:
    """Return sections of the configuration that a card tells; raise InputFileError where one is missing."""
    config = training.get("config")
    missing = [name for name in names if not isinstance(config, Mapping) or not isinstance(config.get(name), Mapping)]
    if missing:
        raise InputFileError(
            f"{path}: training.config has no {missing[0]}; allowed: the configuration of a training, whole"
        )
    assert isinstance(config, Mapping)
    return {name: config[name] for name in names}


@contextmanager
def _naming_card(path: Path) -> Iterator[None]:
    """Name the card whose training is told of in what is wrong with it."""
    try:
        yield
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: training.config: {error}") from error


def _compare_outcomes(remembering: Sequence[str], forgetful: Sequence[str]) -> str:
    """Return successes and their difference in problems that both drove, with an interval of the pairs' mean."""
    ended = np.array((remembering, forgetful)) == "goal_reached"
    gains = ended[0].astype(np.float64) - ended[1]
    gain, spread = gains.mean(), 1.96 * gains.std(ddof=1) / math.sqrt(len(gains))
    return (
        f"{len(gains)} unseen episodes each: success {ended[0].mean():.3f}, "
        f"with h seen as zeros {ended[1].mean():.3f}; "
        f"memory gains {gain:.3f} (95 % of pairs: {gain - spread:.3f} .. {gain + spread:.3f})"
    )
