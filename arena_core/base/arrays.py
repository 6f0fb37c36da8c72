"""Arrays from .npy and .npz files that anybody may have written: their size is known before any
memory is taken for them.
"""

from __future__ import annotations

import io
import math
import zipfile
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from arena_core.base.errors import InputFileError
from arena_core.base.files import AnyPath, read_bytes, reason_of
from arena_core.base.limits import LIMITS

MOST_MEMBERS = 1000  # arrays of one file
PACKINGS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # others take memory as their file says
KINDS = "biufUS"  # truths, numbers and texts; no objects, which could be code


def read_arrays(path: AnyPath, allowed: str) -> dict[str, NDArray[Any]]:
    """Return the arrays of an .npz file by their names; raise InputFileError, which names
    ``allowed`` as what may be there.
    """
    content = read_bytes(path, LIMITS.arrays_bytes, allowed)
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = archive.infolist()
            _check_members(members)
            return {member.filename.removesuffix(".npy"): _read_member(archive, member) for member in members}
    # zipfile and numpy raise whatever a damaged file leads them to, tokenize.TokenError among it
    except Exception as error:
        raise InputFileError(f"{path}: damaged ({reason_of(error)}); allowed: {allowed}") from None


def read_array(path: AnyPath, allowed: str) -> NDArray[Any]:
    """Return the array of an .npy file; raise InputFileError."""
    content = read_bytes(path, LIMITS.arrays_bytes, allowed)
    try:
        return _read_npy(io.BytesIO(content), len(content))
    except Exception as error:  # as above
        raise InputFileError(f"{path}: is no NumPy file ({reason_of(error)}); allowed: {allowed}") from None


def _check_members(members: list[zipfile.ZipInfo]) -> None:
    total = sum(member.file_size for member in members)
    if len(members) > MOST_MEMBERS or total > LIMITS.arrays_bytes:
        raise ValueError(
            f"{len(members)} arrays of {total} bytes, at most {MOST_MEMBERS} of {LIMITS.arrays_bytes} are read"
        )
    if any(member.compress_type not in PACKINGS for member in members):
        raise ValueError("it is packed otherwise than by deflate")


def _read_member(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    with archive.open(member) as file:
        return _read_npy(file, member.file_size)


def _read_npy(file: IO[bytes], size: int) -> NDArray[Any]:
    """Read an array from a file of ``size`` bytes, its header among them."""
    major, minor = npy.read_magic(file)
    read_header = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}.get((major, minor))
    if read_header is None:
        raise ValueError(f"version {major}.{minor} of the format")
    shape, columns_first, kind = read_header(file)
    if kind.kind not in KINDS or kind.names is not None:
        raise ValueError(f"it holds {kind}")
    wanted = math.prod(shape) * kind.itemsize
    if any(extent < 0 for extent in shape) or wanted > size:
        raise ValueError(f"it has no room for an array of shape {shape}")
    content = file.read(wanted)
    if len(content) < wanted:
        raise ValueError("it ends too early")
    return np.ndarray(shape, kind, bytearray(content), order="F" if columns_first else "C")
