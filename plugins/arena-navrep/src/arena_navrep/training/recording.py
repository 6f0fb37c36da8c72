"""The first stage: what robots see and do while they wander."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from arena_core import ConfigurationError, random_generator
from arena_gym.building import Parts, build_parts
from arena_gym.seeds import check_unseen_seed, training_seed
from arena_gym.vector_environment import NavigationVectorEnv
from arena_navrep.rollouts import Rollouts, rollout_file, write_rollouts
from arena_navrep.training.settings import Recording
from arena_navrep.training.wanderer import Wanderer

WORLDS_APART = 2**20  # between the episode seeds of two files


def record_missing(config: Mapping[str, Any], settings: Recording, folder: Path) -> None:
    """Write the roll-outs that are not there yet, each a pure function of configuration and number."""
    for kind, files in (("train", settings.files), ("test", settings.test_files)):
        missing = [index for index in range(files) if not rollout_file(folder, kind, index).exists()]
        env = _make_environment(config, settings, kind) if missing else None
        for index in missing:
            assert env is not None
            rollouts = _record_rollouts(env, settings, config["seed"], kind, index)
            write_rollouts(rollout_file(folder, kind, index), rollouts)
            print(
                f"{kind} roll-outs {index + 1} of {files}: {rollouts.begins.size} steps, "
                f"{int(rollouts.begins.sum())} episodes",
                flush=True,
            )


def _make_environment(config: Mapping[str, Any], settings: Recording, kind: str) -> NavigationVectorEnv:
    """Return the worlds of a kind; those of tests are others."""
    own = config["environment"]
    unseen = check_unseen_seed(settings.test_seed, own["seed"], "recording.test_seed")
    parts = build_parts({**config, "environment": {**own, "seed": unseen if kind == "test" else own["seed"]}})
    _check_scan(parts)
    return NavigationVectorEnv(settings.worlds, parts=parts)


def _check_scan(parts: Parts) -> None:
    names = [field.name for field in parts.encoder.layout()]
    missing = {"waypoint_cos", "waypoint_sin", "vx", "last_vx"} - set(names)
    if missing or parts.encoder.lookback:
        raise ConfigurationError(
            f"observation_encoder has fields {', '.join(names)}; allowed: rosnav_sectors without lookback, "
            "or one like it"
        )


def _record_rollouts(env: NavigationVectorEnv, settings: Recording, seed: int, kind: str, index: int) -> Rollouts:
    """Return roll-outs ``index``."""
    layout, first = env.batch.parts.encoder.layout(), seed * WORLDS_APART * 64 + index * WORLDS_APART
    random = random_generator(training_seed(seed), f"rollouts/{kind}/{index}", "wanderer")
    wanderer = Wanderer(layout, env.batch.parts.scale, settings.worlds, settings.wander, random)
    rows, begins = [env.reset(seed=first)[0].copy()], [np.ones(settings.worlds, np.bool_)]
    for _ in range(settings.steps - 1):
        seen, _, terminated, truncated, _ = env.step(wanderer.act(rows[-1]))
        rows.append(seen.copy())
        begins.append(terminated | truncated)
    seen_all = np.stack(rows)
    return Rollouts(seen_all[:, :, : layout[0].size], seen_all[:, :, layout[0].size :], np.stack(begins))
