"""The spaces of observations and actions."""

from __future__ import annotations

import numpy as np
from gymnasium.spaces import Box, Discrete

from arena_core import ObservationEncoder
from arena_gym.building import Parts


def observation_space(encoder: ObservationEncoder) -> Box:
    """Return the box that an encoder's layout spans."""
    fields = encoder.layout()
    low = np.concatenate([np.full(field.size, field.low, np.float32) for field in fields])
    high = np.concatenate([np.full(field.size, field.high, np.float32) for field in fields])
    return Box(low, high, dtype=np.float32)


def action_space(parts: Parts) -> Box | Discrete:
    """Return [-1, 1] in every axis, or the members of a switch."""
    if parts.switch is not None:
        return Discrete(len(parts.switch.members))
    return Box(-1.0, 1.0, (len(parts.scale.names),), np.float32)
