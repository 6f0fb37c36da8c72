"""What a task may ask of a robot beyond a goal: to keep with a person, or to take one's place."""

from arena_core.values.company import Company
from arena_core.values.recorded_walk import RecordedWalk

__all__ = ["Company", "RecordedWalk"]
