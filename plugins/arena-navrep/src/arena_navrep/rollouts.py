"""Roll-outs: what robots saw and did, in files that are learned from."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError, write_bytes_whole

FOLDER = "rollouts"


@dataclass(frozen=True, slots=True, eq=False)
class Rollouts:
    """T steps of N robots: ``scans`` (T, N, S) float32, ``states`` (T, N, R) float32, ``begins`` (T, N), where an episode begins."""

    scans: NDArray[np.float32]
    states: NDArray[np.float32]
    begins: NDArray[np.bool_]


def file_of(folder: Path, kind: str, index: int) -> Path:
    """Return where roll-outs ``index`` of a kind, train or test, lie."""
    return folder / FOLDER / f"{kind}_{index:02}.npz"


def write_rollouts(path: Path, rollouts: Rollouts) -> None:
    """Write roll-outs, whole or not at all; scans and states keep three digits."""
    content = io.BytesIO()
    np.savez(content, scans=rollouts.scans.astype(np.float16), states=rollouts.states.astype(np.float16), begins=rollouts.begins)
    write_bytes_whole(path, content.getvalue())


def read_rollouts(folder: Path, kind: str, files: int) -> Rollouts:
    """Return all roll-outs of a kind side by side; raise InputFileError where there are none or one is damaged."""
    arrays = [_read(file_of(folder, kind, index)) for index in range(files)]
    joined = {name: np.concatenate([one[name] for one in arrays], axis=1) for name in ("scans", "states", "begins")}
    return Rollouts(joined["scans"].astype(np.float32), joined["states"].astype(np.float32), joined["begins"])


def _read(path: Path) -> dict[str, NDArray[Any]]:
    try:
        with np.load(path, allow_pickle=False) as content:
            return {name: content[name] for name in ("scans", "states", "begins")}
    except (OSError, ValueError, KeyError, EOFError, BadZipFile) as error:
        raise InputFileError(f"{path}: holds no roll-outs ({error}); allowed: a file that `arena navrep record` wrote") from None
