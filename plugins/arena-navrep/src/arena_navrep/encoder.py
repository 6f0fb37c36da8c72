"""What NAVREP's controller sees: a scan's code, the memory of earlier ones, and the robot's state."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from arena_core import ConfigurationError, ObservationBatch, ObservationField, Robot
from arena_navrep.motion import motion_columns
from arena_navrep.world_model import CODE_MAX, Part, check_fit, load_part
from arena_policies.encoding import BoundedEncoder, Numbers
from arena_policies.policy import build_encoder, check_layout


class NavrepEncoder(BoundedEncoder):
    """The code z of the scan, the memory h of what was seen and done before, and the state of the robot (Dugas et al.
    2021: V, M).

    ``vision`` is needed; without ``memory`` the controller sees V_ONLY, with it VM. What it recalls of the step before,
    z and speeds, is with the command given since what makes h of the h before.
    """

    def __init__(self, robot: Robot, vision: str | None, memory: str | None) -> None:
        if vision is None:
            raise ConfigurationError(
                "observation_encoder.vision is null; allowed: a file that `arena navrep all robot=...` made"
            )
        self._addresses = {"vision": vision} if memory is None else {"vision": vision, "memory": memory}
        self._vision = load_part(vision, "vision")
        self._memory = None if memory is None else load_part(memory, "memory")
        if self._memory is not None:
            check_fit(self._memory, self._vision)
        self._scans = build_encoder(f"{self._vision.path.with_suffix('.json')}: scan", self._vision.card.scan, robot)
        check_layout(self._vision.path, self._vision.card.robot, self._vision.card.layout, self._scans.layout())
        scan, *state = self._scans.layout()
        self._beams, self._code = scan.size, self._vision.card.code
        self._hidden = 0 if self._memory is None else self._memory.card.hidden
        self.recurrent = self._memory is not None
        measured, commanded = motion_columns(state)
        self._state = self._code + self._hidden
        self._measured, self._commanded = self._state + measured, self._beams + commanded
        super().__init__((*_latent_fields(self._vision, self._memory), *state))

    def parts(self) -> Mapping[str, str]:
        """Return the files of vision and memory."""
        return self._addresses

    def write(self, observations: ObservationBatch, rows: Numbers) -> None:
        """Fill ``rows`` (N, D)."""
        seen = self._scans.encode(observations)
        rows[:, : self._code] = self._vision.run(np.ascontiguousarray(seen[:, : self._beams]))
        if self._memory is not None:
            rows[:, self._code : self._state] = self._update_memory(self._memory, observations.recalled, seen)
        rows[:, self._state :] = seen[:, self._beams :]

    def _update_memory(self, memory: Part, before: Numbers, seen: Numbers) -> Numbers:
        """Return h (N, H) from what was recalled of the step ``before`` and the command given since."""
        code, hidden = before[:, : self._code], before[:, self._code : self._state]
        numbers = np.concatenate((code, before[:, self._measured], seen[:, self._commanded], hidden), axis=1)
        return memory.run(numbers)[:, : self._hidden]


def _latent_fields(vision: Part, memory: Part | None) -> tuple[ObservationField, ...]:
    """Return the fields z and h; their meaning names the networks, so that numbers
    of others are never taken for them.
    """
    seen = f"code of the scan by vision {vision.card.sha256[:12]}"
    fields = (ObservationField("z", vision.card.code, "-", -CODE_MAX, CODE_MAX, seen),)
    if memory is None:
        return fields
    remembered = f"memory of earlier codes by memory {memory.card.sha256[:12]}"
    return (*fields, ObservationField("h", memory.card.hidden, "-", -1.0, 1.0, remembered))
