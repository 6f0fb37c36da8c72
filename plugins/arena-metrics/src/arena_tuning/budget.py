"""How much may be driven in a search: episodes, or a time after which no further race begins."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from arena_core import ConfigurationError

ALLOWED = "a number of episodes, such as 2000, or a time, such as 20min or 2h"
SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0}
MOST = 10**9


@dataclass(frozen=True, slots=True)
class Budget:
    """``episodes`` of a search, or its ``seconds``; ``text`` is as the user wrote it."""

    text: str
    episodes: int | None
    seconds: float

    def allows(self, episodes: int, seconds: float) -> bool:
        """Return whether a race may begin that would end after so many episodes, and begins after so many seconds."""
        return episodes <= self.episodes if self.episodes is not None else seconds < self.seconds


def read_budget(text: str) -> Budget:
    """Read ``2000`` or ``20min``; raise ConfigurationError."""
    found = re.fullmatch(r"(\d{1,9}(?:\.\d{1,3})?)(s|min|h)?", text.strip())
    if not found or float(found[1]) <= 0.0 or ("." in found[1] and not found[2]):
        raise ConfigurationError(f"budget is {text}; allowed: {ALLOWED}")
    if found[2]:
        return Budget(text, None, float(found[1]) * SECONDS[found[2]])
    return Budget(text, int(found[1]), math.inf)
