"""The driver of roll-outs: towards the waypoint, more or less, and slower where something is close."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import ObservationField
from arena_policies.actions import ActionScale
from arena_policies.encoding import field_columns

Numbers = NDArray[np.float32]
KEPT = 0.9  # share of its noise that a step keeps
TURNING = 1.5  # rad/s, or rad of steering, for each rad of bearing
BACKWARDS = 0.4  # greatest share of the forward speed that is driven backwards
TEMPER = 60  # steps for which a world keeps its haste and the strength of its noise


class Wanderer:
    """Drives N robots so that the world is seen from where a planner gets to, and from where it does not.

    Now and then a robot is hasty, backs off, or stands and looks at people who pass.
    """

    def __init__(
        self,
        layout: Sequence[ObservationField],
        scale: ActionScale,
        worlds: int,
        wander: float,
        random: np.random.Generator,
    ) -> None:
        self._ways = [field_columns(layout, name) for name in ("waypoint_cos", "waypoint_sin")]
        self._beams = layout[0].size
        self._scale, self._wander, self._random = scale, wander, random
        self._noise = np.zeros((worlds, len(scale.names)))
        self._strength, self._haste = np.zeros((worlds, 1)), np.ones(worlds)
        self._steps = 0

    def act(self, rows: Numbers) -> Numbers:
        """Return actions (N, A) for what is seen, rows (N, D)."""
        if self._steps % TEMPER == 0:
            self._strength = self._random.uniform(0.0, self._wander, self._strength.shape)
            self._haste = self._random.uniform(-0.2, 1.6, len(rows)).clip(0.0, 1.0)
        self._steps += 1
        fresh = self._random.standard_normal(self._noise.shape) * np.sqrt(1.0 - KEPT**2)
        self._noise = KEPT * self._noise + fresh
        shares = self._aim_shares(rows) + self._strength * self._noise
        shares[:, 0] = np.clip(shares[:, 0], -BACKWARDS, 1.0)
        low, high = self._scale.low, self._scale.high
        return np.clip(2.0 * (np.clip(shares, -1.0, 1.0) * high - low) / (high - low) - 1.0, -1.0, 1.0).astype(
            np.float32
        )

    def _aim_shares(self, rows: Numbers) -> NDArray[np.float64]:
        """Return shares (N, A) of the greatest speeds that head for the waypoints."""
        cos, sin = (rows[:, way.start].astype(np.float64) for way in self._ways)
        room = np.clip(1.5 - rows[:, : self._beams].max(axis=1), 0.1, 1.0)
        turn = np.clip(TURNING * np.arctan2(sin, cos) / self._scale.high[-1], -1.0, 1.0)
        aims = {
            "vx": self._haste * room * np.maximum(cos, 0.0),
            "vy": 0.5 * self._haste * sin,
            "wz": turn,
            "steering": turn,
        }
        return np.stack([aims[name] for name in self._scale.names], axis=1)
