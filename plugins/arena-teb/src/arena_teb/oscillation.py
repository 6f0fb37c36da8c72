"""Finding out that the robot swings to and fro in one place (teb_local_planner's failure detector)."""

from __future__ import annotations

from collections import deque

import numpy as np

from arena_core import Twist
from arena_teb.parameters import Recovery


class OscillationDetector:
    """Keeps the commands of the last seconds; a swing sets a preferred direction of turning for some time."""

    def __init__(self, recovery: Recovery, vx_max: float, wz_max: float) -> None:
        self._recovery = recovery
        self._scale = np.array((vx_max, wz_max))
        self.clear(1.0)

    def clear(self, period: float) -> None:
        """Begin with no command; commands come every ``period`` s."""
        length = max(2, round(self._recovery.oscillation_filter_duration / period))
        self._commands: deque[tuple[float, float]] = deque(maxlen=length)
        self._preferred = 0.0
        self._until = -np.inf

    def record_command(self, command: Twist) -> None:
        """Take in a command."""
        self._commands.append((command.vx, command.wz))

    def preferred_turn(self, stamp: float) -> float:
        """Return the direction of turning to prefer at ``stamp`` s: 1.0, -1.0 or 0.0 for none."""
        if not self._recovery.oscillation_recovery:
            return 0.0
        if stamp >= self._until:
            self._preferred = self._oscillation_sign()
            if self._preferred != 0.0:
                self._until = stamp + self._recovery.oscillation_recovery_min_duration
                self._commands.clear()
        return self._preferred

    def _oscillation_sign(self) -> float:
        """Return the sign of the mean turn when commands have changed their turn, but
        moved the robot nowhere; else 0.0.
        """
        if len(self._commands) < (self._commands.maxlen or 0):
            return 0.0
        commands = np.array(self._commands) / self._scale
        speed, turn = commands.mean(axis=0)
        crossings = int((np.diff(np.sign(commands[:, 1])) != 0).sum())
        still = abs(speed) < self._recovery.oscillation_v_eps and abs(turn) < self._recovery.oscillation_omega_eps
        return (1.0 if turn >= 0.0 else -1.0) if still and crossings > 1 else 0.0
