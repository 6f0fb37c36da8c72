"""The spaces of observations and actions."""

from __future__ import annotations

import numpy as np
from gymnasium.spaces import Box

from arena_core import ObservationEncoder
from arena_policies.actions import ActionScale


def observation_space(encoder: ObservationEncoder) -> Box:
    """Return the box that an encoder's layout spans."""
    fields = encoder.layout()
    low = np.concatenate([np.full(field.size, field.low, np.float32) for field in fields])
    high = np.concatenate([np.full(field.size, field.high, np.float32) for field in fields])
    return Box(low, high, dtype=np.float32)


def action_space(scale: ActionScale) -> Box:
    """Return [-1, 1] in every axis."""
    return Box(-1.0, 1.0, (len(scale.names),), np.float32)
