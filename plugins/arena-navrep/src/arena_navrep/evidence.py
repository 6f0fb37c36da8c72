"""What a world model is worth: whether it foresees more than that nothing changes, and whether the controller needs its memory."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError
from arena_gym.building import build_parts
from arena_gym.seeds import check_evaluation_seed
from arena_gym.training.evaluation import Score, evaluate
from arena_gym.vector_environment import NavigationVectorEnv
from arena_navrep.prediction import prediction_errors, sequences_of
from arena_navrep.rollouts import read_rollouts
from arena_navrep.world_model import load_part
from arena_policies.card import PolicyCard, part_path, read_card
from arena_policies.network import network_content, open_network

WORLDS = 32  # driven in step

Numbers = NDArray[np.float32]


def foresight(folder: Path) -> str:
    """Return how well the networks of a world model's folder foresee the codes of its test roll-outs."""
    vision, memory = (load_part(str(folder / f"{part}.onnx"), part) for part in ("vision", "memory"))
    recording = memory.card.training["config"]["recording"]
    sequences = sequences_of(read_rollouts(folder, "test", recording["test_files"]), vision, vision.card.layout)
    errors = prediction_errors(sequences, memory.run, memory.card.hidden)
    share = (errors["prediction"] / errors["persistence"]) ** 2
    return (
        f"next code, {sequences.begins.size} steps of unseen worlds: error {errors['prediction']:.3f} as foreseen, "
        f"{errors['persistence']:.3f} if nothing changed; {share:.2f} of its mean square"
    )


def worth_of_memory(policy: Path, episodes: int, seed: int) -> str:
    """Return a controller's success in unseen problems as it is, and with a memory h that it sees as zeros."""
    card = read_card(policy.with_suffix(".json"))
    if "h" not in [field.name for field in card.layout]:
        raise ConfigurationError(f"{policy}: sees no memory; allowed: a policy of planner navrep")
    env = _unseen(policy, card, seed, min(WORLDS, episodes))
    session = open_network(policy, network_content(policy), sum(f.size for f in card.layout), len(card.action))
    name, hidden = session.get_inputs()[0].name, _columns(card, "h")

    def act(seen: Numbers) -> Numbers:
        return np.asarray(session.run(None, {name: seen})[0])

    def forgetful(seen: Numbers) -> Numbers:
        shown = seen.copy()
        shown[:, hidden] = 0.0
        return act(shown)

    return _compared(evaluate(env, act, episodes, seed), evaluate(env, forgetful, episodes, seed))


def _unseen(policy: Path, card: PolicyCard, seed: int, worlds: int) -> NavigationVectorEnv:
    """Return the controller's last level, with all its people, in worlds that no training met."""
    config = dict(card.training["config"])
    networks = {name: str(part_path(policy, name)) for name in card.parts}
    config["observation_encoder"] = {**card.encoder, **networks}
    config["environment"] = {**config["environment"], "seed": check_evaluation_seed(seed), "collisions_to_end": 1}
    config["randomization"] = {**config["randomization"], "people": None}
    env = NavigationVectorEnv(worlds, parts=build_parts(config))
    staging = env.batch.parts.pool.staging
    if staging is not None:
        env.set_stage(staging.levels - 1)
    return env


def _columns(card: PolicyCard, name: str) -> slice:
    ends = np.cumsum([field.size for field in card.layout]).tolist()
    place = [field.name for field in card.layout].index(name)
    return slice(ends[place] - card.layout[place].size, ends[place])


def _compared(remembering: Score, forgetful: Score) -> str:
    gain = remembering.success - forgetful.success
    spread = sum(s.success * (1.0 - s.success) / s.episodes for s in (remembering, forgetful))
    return (
        f"{remembering.episodes} unseen episodes each: success {remembering.success:.3f}, with h seen as zeros {forgetful.success:.3f}; "
        f"memory gains {gain:.3f} (95 %: {gain - 1.96 * math.sqrt(spread):.3f} .. {gain + 1.96 * math.sqrt(spread):.3f})"
    )
