"""What a task may ask of a robot beyond a goal: to keep with a person, to take one's place, to be one of a team."""

from arena_core.contracts.communication import Communication
from arena_core.contracts.simulation import PatrolStrategy
from arena_core.values.company import Company
from arena_core.values.episode import Member
from arena_core.values.errands import Errands, NextPlace, PatrolGraph
from arena_core.values.messages import Message
from arena_core.values.recorded_walk import RecordedWalk

__all__ = [
    "Communication",
    "Company",
    "Errands",
    "Member",
    "Message",
    "NextPlace",
    "PatrolGraph",
    "PatrolStrategy",
    "RecordedWalk",
]
