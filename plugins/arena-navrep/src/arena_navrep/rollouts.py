"""Roll-outs: what robots saw and did, in files that are learned from."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError
from arena_core.files import read_arrays, write_bytes_whole

FOLDER = "rollouts"
DIMENSIONS = {"scans": 3, "states": 3, "begins": 2}
ARRAYS = tuple(DIMENSIONS)


@dataclass(frozen=True, slots=True, eq=False)
class Rollouts:
    """T steps of N robots: ``scans`` (T, N, S) float32, ``states`` (T, N, R) float32, ``begins``
    (T, N), where an episode begins.
    """

    scans: NDArray[np.float32]
    states: NDArray[np.float32]
    begins: NDArray[np.bool_]


def rollout_file(folder: Path, kind: str, index: int) -> Path:
    """Return where roll-outs ``index`` of a kind, train or test, lie."""
    return folder / FOLDER / f"{kind}_{index:02}.npz"


def write_rollouts(path: Path, rollouts: Rollouts) -> None:
    """Write roll-outs, whole or not at all; scans and states keep three digits."""
    content = io.BytesIO()
    np.savez(
        content,
        scans=rollouts.scans.astype(np.float16),
        states=rollouts.states.astype(np.float16),
        begins=rollouts.begins,
    )
    write_bytes_whole(path, content.getvalue())


def read_rollouts(folder: Path, kind: str, files: int) -> Rollouts:
    """Return all roll-outs of a kind side by side; raise InputFileError where there are none or one is damaged."""
    arrays = [_read_file(rollout_file(folder, kind, index)) for index in range(files)]
    joined = {name: np.concatenate([one[name] for one in arrays], axis=1) for name in ("scans", "states", "begins")}
    return Rollouts(joined["scans"].astype(np.float32), joined["states"].astype(np.float32), joined["begins"])


def _read_file(path: Path) -> dict[str, NDArray[Any]]:
    allowed = "a file that `arena navrep record` wrote"
    content = read_arrays(path, allowed)
    shapes = [content[name].shape[:2] for name in ARRAYS if name in content and content[name].ndim == DIMENSIONS[name]]
    if len(shapes) < len(ARRAYS) or len(set(shapes)) > 1:
        raise InputFileError(
            f"{path}: holds no roll-outs (it lacks {', '.join(ARRAYS)} of equal length); allowed: {allowed}"
        )
    return {name: content[name] for name in ARRAYS}
