"""From settings to a learner."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3 import PPO
from torch import nn

from arena_core import ConfigurationError, ObservationField
from arena_gym.training.learner import Learner
from arena_gym.training.network import AsymmetricActorCritic, BeamFeatures
from arena_gym.training.sb3_vec_env import Sb3VecEnv
from arena_gym.training.settings import Network, TrainingSettings
from arena_policies.actions import ActionScale


def make_learner(
    env: Sb3VecEnv, layout: tuple[ObservationField, ...], settings: TrainingSettings, logs: Path | None
) -> Learner:
    """Return an untrained learner whose random streams follow from its seed; what ``env`` shows
    behind ``layout`` is the truth.
    """
    torch.set_num_threads(settings.threads)
    chosen, period = settings.optimization, env.env.batch.parts.decision_period
    correlated = settings.exploration_time
    truth = env.observation_space.shape[0] - sum(field.size for field in layout)  # type: ignore[index]
    policy = _policy_kwargs(settings.network, layout)
    return Learner(
        AsymmetricActorCritic if truth else "MlpPolicy",
        env,
        learning_rate=_linear_schedule(chosen.learning_rate, chosen.final_learning_rate),
        n_steps=chosen.steps,
        batch_size=chosen.minibatch,
        n_epochs=chosen.epochs,
        gamma=settings.discount(period),
        gae_lambda=chosen.gae_lambda,
        clip_range=chosen.clip,
        ent_coef=chosen.entropy,
        vf_coef=chosen.value,
        max_grad_norm=chosen.max_gradient,
        use_sde=correlated is not None,
        sde_sample_freq=-1 if correlated is None else max(1, round(correlated / period)),
        policy_kwargs={**policy, "truth": truth} if truth else policy,
        tensorboard_log=str(logs) if logs else None,
        seed=settings.seed,
        device=choose_device(settings.device),
        verbose=0,
    )


def _linear_schedule(initial: float, final_share: float) -> Any:
    return lambda left: initial * (final_share + (1.0 - final_share) * left)


def _policy_kwargs(network: Network, layout: tuple[ObservationField, ...]) -> dict[str, Any]:
    return {
        **_feature_kwargs(network, layout),
        "net_arch": list(network.heads),
        "activation_fn": nn.ReLU,
        "log_std_init": network.log_std_init,
        "ortho_init": True,
    }


def _feature_kwargs(network: Network, layout: tuple[ObservationField, ...]) -> dict[str, Any]:
    if network.beams_field is None:
        return {}
    beams, scans = scan_columns(network, layout)
    extractor = {"beams": beams, "scans": scans, "convolutions": network.convolutions, "features": network.features}
    return {"features_extractor_class": BeamFeatures, "features_extractor_kwargs": extractor}


def scan_columns(network: Network, layout: tuple[ObservationField, ...]) -> tuple[slice, int]:
    """Return where the observation has the scans that the convolutions read, and how many; raise ConfigurationError
    where it has none.

    Scans are fields of one size in a row: ``beams_field``, then any whose names go on from it.
    """
    start = 0
    for place, field in enumerate(layout):
        if field.name == network.beams_field:
            alike = [f.name.startswith(field.name) and f.size == field.size for f in layout[place:]]
            scans = [*alike, False].index(False)
            return slice(start, start + scans * field.size), scans
        start += field.size
    names = ", ".join(field.name for field in layout)
    raise ConfigurationError(f"training.network.beams_field is {network.beams_field}; allowed: {names}")


def choose_device(name: str) -> torch.device:
    """Return the device of this name; raise ConfigurationError where this machine has none."""
    try:
        device = torch.device(name)
    except RuntimeError:
        raise ConfigurationError(f"device is {name}; allowed: cpu, cuda, cuda:1, ...") from None
    if device.type == "cuda" and not torch.cuda.is_available():
        raise ConfigurationError(f"device is {name}, but this machine has none that torch can use; allowed: device=cpu")
    return device


def spread_in_si(learner: PPO, scale: ActionScale) -> None:
    """Read the spread of the actions that a learner begins with as m/s and rad/s, at most half of their ranges.

    Until now it was in halves of their ranges. A slow robot's actions would else be at its limits nearly always.
    """
    halves = torch.as_tensor(np.log((scale.high - scale.low) / 2.0), dtype=torch.float32).to(learner.device)
    with torch.no_grad():
        learner.policy.log_std.sub_(halves).clamp_(max=0.0)


def scale_exploration(learner: Learner, observations: NDArray[np.float32]) -> None:
    """Let correlated exploration spread actions by exp(``log_std_init``) about their mean, halves of their ranges.

    It is a linear function of the policy's last features, whose size depends on what has been learned: it is scaled to
    their mean square in ``observations`` (N, D), and drawn again.
    """
    policy = learner.policy
    with torch.no_grad():
        seen = policy.pi_features_extractor(torch.as_tensor(observations, device=learner.device))
        features = policy.mlp_extractor.forward_actor(seen)
        policy.log_std.sub_(0.5 * features.square().sum(dim=1).mean().clamp(min=1e-6).log())
    policy.reset_noise(learner.n_envs)


def limit_spread(learner: PPO, log_std: float) -> None:
    """Let actions spread by at most exp(``log_std``) about their mean."""
    with torch.no_grad():
        learner.policy.log_std.clamp_(max=log_std)
