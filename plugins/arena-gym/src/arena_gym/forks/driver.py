"""A planner that lets the member drive which it is told to, and notes what a switch would see."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    EpisodeStart,
    Observation,
    ObservationEncoder,
    Planner,
    Robot,
    ScanMemory,
    Twist,
)
from arena_core.hosting import Registry
from arena_policies.members import Members, build_members
from arena_policies.observation_view import batch_of_one


class ToldSwitch(Planner):
    """Drives by the member in the place ``member``; ``numbers`` (D,) is what the encoder made of the latest control
    step, None where no member was asked.
    """

    compiles: ClassVar[bool] = True

    def __init__(self, members: Members, encoder: ObservationEncoder) -> None:
        if encoder.lookback or encoder.recurrent:
            raise ConfigurationError(
                f"observation_encoder is {type(encoder).__name__}, which looks back; allowed with forks: one that "
                "reads the present alone"
            )
        self._members, self._encoder = members, encoder
        self._earlier = ScanMemory((), 1, 0).earlier()
        self._last = Twist(0.0)
        self._rehearsed = False
        self.layout = encoder.layout()
        self.member = 0
        self.numbers: NDArray[np.float32] | None = None

    @staticmethod
    def of(nodes: Mapping[str, Any], encoder: ObservationEncoder, robot: Robot, registry: Registry) -> ToldSwitch:
        """Return one whose members have these configurations, in their order."""
        return ToldSwitch(Members(build_members(nodes, tuple(nodes), robot, registry, "switch.members")), encoder)

    def reset(self, episode: EpisodeStart) -> None:
        """Begin at rest, with all members."""
        self._members.reset(episode)
        self._last, self.numbers = Twist(0.0), None

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the velocity of the member that drives; raise NoValidCommand where it has none."""
        if not self._rehearsed:
            self._rehearsed = True
            self._members.warm_up(observation)
        last, self._last = self._last, Twist(0.0)
        seen = batch_of_one(observation, last, self._earlier, self._encoder.blank(1), tracked=self._encoder.tracked)
        self.numbers = self._encoder.encode(seen)[0].copy()
        self._last = self._members.drive(self.member, observation)
        return self._last
