"""How kernels are compiled, and when they are compiled anew."""

from __future__ import annotations

import inspect
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, TypeVar
from zlib import crc32

from numba import njit
from numba.core.caching import FunctionCache
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

Kernel = TypeVar("Kernel", bound=Callable[..., Any])

BORROWING: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}
INNER: dict[str, Any] = {**BORROWING, "no_cpython_wrapper": True}
INLINED: dict[str, Any] = {**BORROWING, "forceinline": True}
PATIENCE, LOOK = 60.0, 0.02  # [s] for which a process waits for a kernel that another one compiles, and looks again


def compiled(kernel: Kernel) -> Kernel:
    """Compile a kernel when it is first called, and keep it on disk.

    A division that cannot raise lets the compiler drop much of the reference counting of array arguments.
    """
    return _kept(njit(error_model="numpy", no_cfunc_wrapper=True)(kernel), kernel)  # type: ignore[call-overload]


def borrowing(kernel: Kernel) -> Kernel:
    """Compile a kernel that only borrows arrays and makes none, without any reference counting.

    Counting is atomic, and was most of the time of short kernels that take whole named tuples of arrays. numba refuses to compile
    an allocation here. Such a kernel returns numbers only: arrays in a returned tuple would be released once too often.
    """
    return _kept(njit(**BORROWING)(kernel), kernel)


def inner(kernel: Kernel) -> Kernel:
    """Compile a borrowing kernel that only other borrowing kernels call, never Python: half the work for the compiler.

    Such a kernel may return named tuples of borrowed arrays.
    """
    return _kept(njit(**INNER)(kernel), kernel, _InnerDispatcher)


def inlined(kernel: Kernel) -> Kernel:
    """Compile a borrowing kernel into every caller, however large: loops over a call cannot run in vector registers."""
    return _kept(njit(**INLINED)(kernel), kernel)


class _KernelDispatcher(CPUDispatcher):
    """A kernel that one process compiles, while others that want it wait and then load it.

    Without that, tests and sweeps side by side would each compile everything, and numba's index of a kernel could name the code of
    another signature: it is written before the code, and by whoever comes last.
    """

    _cache: _KernelCache

    def compile(self, sig: Any) -> Any:
        """Load the kernel for a signature, or compile and keep it."""
        with global_compiler_lock, self._cache.alone():
            return super().compile(sig)


class _InnerDispatcher(_KernelDispatcher):
    """A kernel without an entry for Python; calling it would end the process."""

    def __call__(self, *arguments: Any) -> Any:
        raise TypeError(f"{self.py_func.__name__} is an inner kernel: only other kernels can call it")


def _kept(dispatcher: Any, kernel: Kernel, kind: type[_KernelDispatcher] = _KernelDispatcher) -> Kernel:
    dispatcher.__class__ = kind
    dispatcher._cache = _KernelCache(kernel)
    return dispatcher  # type: ignore[no-any-return]


class _KernelCache(FunctionCache):
    """numba's cache on disk, good for as long as neither the kernel's package nor this one changes.

    numba looks at the kernel's own file only; a changed kernel in another file would go on being called as it was.
    """

    def __init__(self, kernel: Callable[..., Any]) -> None:
        super().__init__(kernel)  # type: ignore[no-untyped-call]
        self._cache_file._source_stamp = (stamp(_package_of(kernel)), stamp(Path(__file__).parent))

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what was compiled for a signature, None if there is nothing, or only what names types that have moved since."""
        try:
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except (ImportError, AttributeError):
            self.flush()  # type: ignore[no-untyped-call]
            return None

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Keep other processes from this kernel, or go on beside them after a while: who holds it may be suspended."""
        file, byte = _lock_file(self.cache_path), crc32(self._cache_file._index_name.encode())
        if file is None or not _held(file, byte):
            yield
            return
        try:
            yield
        finally:
            fcntl.lockf(file, fcntl.LOCK_UN, 1, byte)


@cache
def _lock_file(folder: str) -> int | None:
    """Open the file of which each kernel in a folder locks a byte, for as long as the process lives; None where there can be none."""
    if fcntl is None:
        return None
    try:
        os.makedirs(folder, exist_ok=True)
        return os.open(Path(folder, "kernels.lock"), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    except OSError:
        return None


def _held(file: int, byte: int) -> bool:
    """Lock a byte of a file; return whether that was possible, within ``PATIENCE``."""
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until:
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, byte)
        except (BlockingIOError, PermissionError):  # another process has it
            time.sleep(LOOK)
        except OSError:  # no such locks on this file system
            return False
        else:
            return True
    return False


def _package_of(kernel: Callable[..., Any]) -> Path:
    """Return the folder of the kernel's whole package, all of its shelves included; its file's folder where it is in none."""
    package = sys.modules.get(kernel.__module__.partition(".")[0])
    return Path(next(iter(getattr(package, "__path__", ())), Path(inspect.getfile(kernel)).parent))


@lru_cache
def stamp(folder: Path) -> tuple[tuple[str, int, int], ...]:
    """Return name, time of change and size of every module at or below a folder."""
    files = ((str(path.relative_to(folder)), path.stat()) for path in sorted(folder.rglob("*.py")))
    return tuple((name, status.st_mtime_ns, status.st_size) for name, status in files)
