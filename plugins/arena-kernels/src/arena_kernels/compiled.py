"""How kernels are compiled, and when they are compiled anew."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

from numba import njit
from numba.core.caching import FunctionCache
from numba.core.registry import CPUDispatcher

Kernel = TypeVar("Kernel", bound=Callable[..., Any])

BORROWING: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}
INNER: dict[str, Any] = {**BORROWING, "no_cpython_wrapper": True}
INLINED: dict[str, Any] = {**BORROWING, "forceinline": True}


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
    dispatcher: Any = njit(**INNER)(kernel)
    dispatcher.__class__ = _InnerDispatcher
    return _kept(dispatcher, kernel)


def inlined(kernel: Kernel) -> Kernel:
    """Compile a borrowing kernel into every caller, however large: loops over a call cannot run in vector registers."""
    return _kept(njit(**INLINED)(kernel), kernel)


def _kept(dispatcher: Any, kernel: Kernel) -> Kernel:
    dispatcher._cache = _KernelCache(kernel)
    return dispatcher  # type: ignore[no-any-return]


class _InnerDispatcher(CPUDispatcher):
    """A kernel without an entry for Python; calling it would end the process."""

    def __call__(self, *arguments: Any) -> Any:
        raise TypeError(f"{self.py_func.__name__} is an inner kernel: only other kernels can call it")


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


def _package_of(kernel: Callable[..., Any]) -> Path:
    """Return the folder of the kernel's whole package, all of its shelves included; its file's folder where it is in none."""
    package = sys.modules.get(kernel.__module__.partition(".")[0])
    return Path(next(iter(getattr(package, "__path__", ())), Path(inspect.getfile(kernel)).parent))


@lru_cache
def stamp(folder: Path) -> tuple[tuple[str, int, int], ...]:
    """Return name, time of change and size of every module at or below a folder."""
    files = ((str(path.relative_to(folder)), path.stat()) for path in sorted(folder.rglob("*.py")))
    return tuple((name, status.st_mtime_ns, status.st_size) for name, status in files)
