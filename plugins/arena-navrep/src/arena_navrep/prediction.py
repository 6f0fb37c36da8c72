"""How well a memory foresees the next code, against the guess that nothing changes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import ObservationField
from arena_navrep.motion import motion_columns
from arena_navrep.rollouts import Rollouts
from arena_navrep.world_model import Part

Numbers = NDArray[np.float32]
BLOCK = 4096  # scans coded at once


@dataclass(frozen=True, slots=True, eq=False)
class Sequences:
    """What a memory reads and shall foresee, T steps of N robots: ``codes`` and those a step ``before`` (T, N, Z),
    ``motions`` (T, N, K).

    A motion is the speeds measured a step before and the command given then. Where an episode ``begins`` all but the
    code is zero.
    """

    codes: Numbers
    before: Numbers
    motions: Numbers
    begins: NDArray[np.bool_]


def sequences_of(recorded: Rollouts, vision: Part, layout: Sequence[ObservationField]) -> Sequences:
    """Return the sequences of roll-outs whose scans ``vision`` codes, of scans with these fields."""
    flat = recorded.scans.reshape(-1, recorded.scans.shape[2])
    codes = np.concatenate([vision.run(flat[k : k + BLOCK]) for k in range(0, len(flat), BLOCK)]).reshape(
        *recorded.begins.shape, -1
    )
    measured, commanded = motion_columns(layout[1:])
    speeds, commands = _shift_steps(recorded.states[:, :, measured], recorded.begins), recorded.states[:, :, commanded]
    return Sequences(
        codes, _shift_steps(codes, recorded.begins), np.concatenate((speeds, commands), axis=2), recorded.begins
    )


def prediction_errors(sequences: Sequences, memory: Callable[[Numbers], Numbers], hidden: int) -> dict[str, float]:
    """Return the root mean square error of the next code as the memory expects it, and as if it were the code before.

    ``memory`` maps (N, Z + K + H) to (N, H + Z): the memory and the code expected.
    """
    squares, count = np.zeros(2), 0
    remembered = np.zeros((sequences.codes.shape[1], hidden), np.float32)
    for k, code in enumerate(sequences.codes):
        remembered[sequences.begins[k]] = 0.0
        answer = memory(np.concatenate((sequences.before[k], sequences.motions[k], remembered), axis=1))
        remembered, foreseen = answer[:, :hidden].copy(), ~sequences.begins[k]
        for place, guess in enumerate((answer[:, hidden:], sequences.before[k])):
            squares[place] += np.square(guess - code, dtype=np.float64)[foreseen].sum()
        count += int(foreseen.sum()) * code.shape[1]
    expected, persistence = np.sqrt(squares / max(count, 1)).tolist()
    return {"prediction": expected, "persistence": persistence}


def _shift_steps(numbers: Numbers, begins: NDArray[np.bool_]) -> Numbers:
    """Return numbers (T, N, D) moved on by a step, zero where an episode begins."""
    before = np.concatenate((np.zeros_like(numbers[:1]), numbers[:-1]))
    before[begins] = 0.0
    return before
