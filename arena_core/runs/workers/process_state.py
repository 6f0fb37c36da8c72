"""What an episode may not change for those after it in the same process, as a value that is
compared before and after.
"""

from __future__ import annotations

import locale
import os
import signal
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import suppress
from types import ModuleType
from typing import Any

import numpy as np

from arena_core.base.portability import most_open_files, process_settings

MANY_FILES = 64  # descriptors that an episode may open and keep: libraries open some when they are first used
FILES_SHARE = 4  # of all that the process may have open, a quarter may be in use
GUARDED = (
    "arena_core",
    "numpy",
    "builtins",
    "math",
    "os",
    "posixpath",
    "time",
    "random",
    "json",
    "io",
    "zipfile",
    "struct",
    "pickle",
)
OPEN = ("/proc/self/fd", "/dev/fd")


class ProcessState:
    """Folder, signals, streams, limits, arithmetic and loaded modules of this process, as they are now."""

    def __init__(self) -> None:
        self._settings = _process_settings()
        self._files = _open_files()
        self._names = {name: dict(vars(module)) for name, module in _guarded_modules()}

    def is_kept(self) -> bool:
        """Return whether a job may follow: everything is as it was, and not many files more are open than were."""
        now = _open_files()
        most = min(self._files + MANY_FILES, most_open_files() // FILES_SHARE)
        return (
            self._settings == _process_settings() and now <= max(most, self._files) and not self._has_replaced_names()
        )

    def _has_replaced_names(self) -> bool:
        """Return whether a name of a guarded module stands for something else; new
        names come with what is first used.
        """
        now: Mapping[str, ModuleType] = dict(_guarded_modules())
        for name, before in self._names.items():
            values = vars(now[name]) if name in now else {}
            if any(values.get(key, self) is not value for key, value in before.items()):
                return True
        return False


def _guarded_modules() -> Iterator[tuple[str, ModuleType]]:
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] in GUARDED and isinstance(module, ModuleType):
            yield name, module


def _process_settings() -> tuple[Any, ...]:
    """Return what is compared as a whole."""
    return (
        _working_folder(),
        tuple(signal.getsignal(number) for number in sorted(signal.valid_signals())),
        process_settings(),
        [(id(stream), stream is None or stream.closed) for stream in (sys.stdout, sys.stderr)],
        [_file_identity(number) for number in range(3)],
        _read_umask(),
        (locale.setlocale(locale.LC_ALL), min(sys.getrecursionlimit(), 1000), sys.gettrace(), sys.getprofile()),
        (np.geterr(), sum(kind == "error" for kind, *_ in warnings.filters)),
        _float_state(),
    )


def _float_state() -> tuple[bool, bool, bool]:
    """Return how the processor rounds and whether it knows the smallest numbers; C code sets both."""
    tiny, small = np.array([5e-324, 1.0]), np.array([1e-17])
    return bool((tiny[:1] * tiny[1:])[0] > 0.0), bool(1.0 + small[0] == 1.0), bool(-1.0 - small[0] == -1.0)


def _read_umask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask


def _working_folder() -> str:
    try:
        return os.getcwd()
    except OSError:
        return ""


def _file_identity(number: int) -> tuple[int, int] | None:
    try:
        found = os.fstat(number)
    except OSError:
        return None
    return found.st_dev, found.st_ino


def _open_files() -> int:
    """Return how many descriptors are open; more than there can be where none is left to count them with."""
    for place in OPEN:
        with suppress(FileNotFoundError):
            try:
                return len(os.listdir(place))
            except OSError:
                return sys.maxsize
    return 0
