"""How kernels are compiled, kept on disk and called: all that the suite asks of numba, beyond `njit`, stands here.

The environment variable ``ARENA_KERNELS`` chooses: ``fast``; ``native``, the same without kernels that came
ready-made; ``checked``, with every ``TypedDispatch`` call looked at; or ``plain``, numba's own ``njit(cache=True)``.
"""

from __future__ import annotations

import hashlib
import inspect
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar, cast
from weakref import WeakKeyDictionary
from zlib import crc32

from numba import njit, typeof
from numba.core import config as numba_config
from numba.core.caching import FunctionCache, InTreeCacheLocator, UserProvidedCacheLocator, UserWideCacheLocator
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher
from numba.core.registry import CPUDispatcher

from arena_kernels.ready import CHOSEN, FOLDER, read_manifest
from arena_kernels.sources import sources_digest

# Windows has no such locks, as Linux has none where it tries what Windows does
LOCKS = sys.platform != "win32" and os.environ.get("ARENA_PORTABLE", "0") in ("", "0")
if sys.platform != "win32":
    import fcntl
else:
    fcntl: Any = None

Kernel = TypeVar("Kernel", bound=Callable[..., Any])
Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

MODES = ("fast", "native", "checked", "plain")
MODE = os.environ.get("ARENA_KERNELS", "fast")
if MODE not in MODES:
    raise ValueError(f"ARENA_KERNELS is {MODE!r}; allowed: {', '.join(MODES)}")

COMPILED: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True}
BORROWING: dict[str, Any] = {**COMPILED, "_nrt": False}
INNER: dict[str, Any] = {**BORROWING, "no_cpython_wrapper": True}
INLINED: dict[str, Any] = {**BORROWING, "forceinline": True}
HERE = Path(__file__).parent
PATIENCE, LOOK = 300.0, 0.02  # [s] for which a process waits for a kernel that another one compiles, and looks again


def compiled(kernel: Kernel) -> Kernel:
    """Compile a kernel when it is first called, and keep it on disk.

    A division that cannot raise lets the compiler drop much of the reference counting of array arguments.
    """
    return _make_dispatcher(kernel, COMPILED)


def borrowing(kernel: Kernel) -> Kernel:
    """Compile a kernel that only borrows arrays and makes none, without any reference counting.

    Counting is atomic, and was most of the time of short kernels that take whole named tuples of arrays. numba refuses
    to compile an allocation here. Such a kernel returns numbers only: arrays in a returned tuple would be released once
    too often.
    """
    return _make_dispatcher(kernel, BORROWING)


def inner(kernel: Kernel) -> Kernel:
    """Compile a borrowing kernel that only other borrowing kernels call, never Python: half the work for the compiler.

    Such a kernel may return named tuples of borrowed arrays.
    """
    return _make_dispatcher(kernel, INNER, InnerDispatcher)


def inlined(kernel: Kernel) -> Kernel:
    """Compile a borrowing kernel into every caller, however large: loops over a call cannot run in vector registers."""
    return _make_dispatcher(kernel, INLINED)


class TypedDispatch(Generic[Arguments, Result]):
    """A kernel that is always called with arguments of the types of the first call: nothing checks them any more.

    numba reads the types again before each call: some 0.15 us for each number and array in named tuples, and more for
    tables with named fields. That is most of the time of a short kernel with a hundred of them. The caller vouches for
    the types: arrays that come from elsewhere are converted first. Whether an array can be written to does
    not matter. ``ARENA_KERNELS=checked`` raises a TypeError for arguments of other types.
    """

    def __init__(self, kernel: Callable[Arguments, Result]) -> None:
        self._kernel = kernel
        self._code: Callable[Arguments, Result] | None = None

    def __call__(self, *arguments: Arguments.args, **named: Arguments.kwargs) -> Result:
        """Call what the kernel is compiled to; arguments have no names here."""
        if self._code is None:
            self._code = self._compile_entry(arguments)
        return self._code(*arguments, **named)

    def __deepcopy__(self, memo: dict[int, Any]) -> TypedDispatch[Arguments, Result]:
        """Return this one: compiled code holds nothing of what it is called with."""
        return self

    def _compile_entry(self, arguments: tuple[Any, ...]) -> Callable[Arguments, Result]:
        kernel: Any = self._kernel
        if MODE == "plain":
            return kernel  # type: ignore[no-any-return]
        code = kernel.compile(tuple(typeof(argument) for argument in arguments))  # type: ignore[no-untyped-call]
        checked = _check_calls(code, kernel.py_func.__qualname__, arguments) if MODE == "checked" else code
        return checked  # type: ignore[no-any-return]


def _check_calls(code: Any, name: str, first: tuple[Any, ...]) -> Any:
    """Return what raises TypeError for arguments of other types than the first ones, before it calls ``code``."""
    expected = [type_key(argument) for argument in first]

    def call(*arguments: Any) -> Any:
        found = [type_key(argument) for argument in arguments]
        if found != expected:
            others = (
                (place, one, other) for place, (one, other) in enumerate(zip_longest(found, expected)) if one != other
            )
            raise TypeError("{}: argument {} is of type {}, at the first call {}".format(name, *next(others)))
        return code(*arguments)

    return call


def type_key(value: Any) -> Any:
    """Return what numba compiles for: the type of a value, of each in a tuple; whether an array
    can be written to is left out.
    """
    if isinstance(value, tuple):
        return type(value).__name__, *map(type_key, value)
    return str(typeof(value)).removeprefix("readonly ")  # type: ignore[no-untyped-call]


def _make_dispatcher(kernel: Kernel, options: dict[str, Any], made: type[KernelDispatcher] | None = None) -> Kernel:
    if MODE == "plain":
        return njit(cache=True, error_model="numpy")(kernel)  # type: ignore[return-value]
    dispatcher: Any = (made or KernelDispatcher)(
        py_func=kernel, targetoptions={"nopython": True, "boundscheck": None, **options}
    )
    dispatcher.enable_caching()
    return dispatcher  # type: ignore[no-any-return]


class KernelDispatcher(CPUDispatcher):
    """A kernel that one process compiles, while others that want it wait and then load it.

    Without that, tests and sweeps side by side would each compile everything, and numba's index of a kernel could name
    the code of another signature: it is written before the code, and by whoever comes last.
    """

    _cache: KernelCache

    def enable_caching(self) -> None:
        """Keep on disk what is compiled."""
        self._cache = KernelCache(self.py_func)

    def compile(self, sig: Any) -> Any:
        """Load the kernel for a signature, or compile and keep it."""
        with global_compiler_lock, self.lock_kernel():
            return super().compile(sig)

    @contextmanager
    def lock_kernel(self) -> Iterator[None]:
        """Keep other processes from this kernel, or go on beside them after a while: who holds it may be suspended."""
        file, byte = (
            lock_file(self._cache.cache_path),
            crc32(f"{self.py_func.__module__}.{self.py_func.__qualname__}".encode()),
        )
        if file is None or not held(file, byte):
            yield
            return
        try:
            yield
        finally:
            fcntl.lockf(file, fcntl.LOCK_UN, 1, byte)


class InnerDispatcher(KernelDispatcher):
    """A kernel without an entry for Python; calling it would end the process."""

    def __call__(self, *arguments: Any) -> Any:
        """Raise TypeError."""
        raise TypeError(f"{self.py_func.__name__} is an inner kernel: only other kernels can call it")


class KernelCache(FunctionCache):
    """numba's cache on disk, good for as long as no package changes that the kernel or one that it calls is from."""

    def __init__(self, kernel: Callable[..., Any]) -> None:
        given: Any = numba_config
        with _locators(
            given.CACHE_LOCATOR_CLASSES or LOCATORS
        ):  # who has set NUMBA_CACHE_LOCATOR_CLASSES has their own
            super().__init__(kernel)  # type: ignore[no-untyped-call]
        if not self.cache_path:
            self.disable()  # type: ignore[no-untyped-call]

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what was compiled for a signature, here or ready-made, None if there is nothing, or only what names
        types that have moved since.
        """
        try:
            found = super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except (ImportError, AttributeError):
            self.flush()  # type: ignore[no-untyped-call]
            return None
        if found is None and uses_ready_made():
            found = ReadyCache(self._py_func).load_overload(sig, target_context)
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled; a folder that is full, or gone, costs no more than another compilation."""
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        except OSError as error:
            self.disable()  # type: ignore[no-untyped-call]
            _say_not_kept(error.strerror or str(error))  # once for all kernels, whatever their folders


class ReadyCache(FunctionCache):
    """Kernels that came ready-made; nothing is written to it."""

    def __init__(self, kernel: Callable[..., Any]) -> None:
        with _locators(f"{__name__}.{ReadyFolder.__name__}"):
            super().__init__(kernel)  # type: ignore[no-untyped-call]

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what was compiled for a signature, None if there is nothing that this process can use."""
        with suppress(ImportError, AttributeError):
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]


@contextmanager
def _locators(names: str) -> Iterator[None]:
    """Have numba ask these where kernels are kept."""
    settings: Any = numba_config
    before = settings.CACHE_LOCATOR_CLASSES
    settings.CACHE_LOCATOR_CLASSES = names
    try:
        yield
    finally:
        settings.CACHE_LOCATOR_CLASSES = before


@cache
def uses_ready_made() -> bool:
    """Return whether this process compiles for the processor of the kernels that came ready-made."""
    manifest, settings = read_manifest(FOLDER), cast(Any, numba_config)
    if manifest is None or os.environ.get(CHOSEN) != manifest.digest:
        return False
    return bool(manifest.cpu == settings.CPU_NAME and manifest.features == settings.CPU_FEATURES)


class _Stamped:
    """Tells by content, of all packages that a kernel stands on, whether its code on disk is still good.

    numba looks at the kernel's own file only; a changed kernel in another file would go on being called as it was.
    """

    def __init__(self, py_func: Callable[..., Any], py_file: str) -> None:
        super().__init__(py_func, py_file)  # type: ignore[call-arg]
        self._stamp = tuple(sorted((folder.name, sources_digest(folder)) for folder in packages_of(py_func)))

    def get_source_stamp(self) -> tuple[Any, ...]:
        """Return name and digest of each package."""
        return self._stamp


class GivenFolder(_Stamped, UserProvidedCacheLocator):
    """Keeps kernels below where ``NUMBA_CACHE_DIR`` says, in a folder for each module and what it stands on: whatever
    environments have the same sources share it.
    """

    def __init__(self, py_func: Callable[..., Any], py_file: str) -> None:
        super().__init__(py_func, py_file)
        digest = hashlib.blake2b(repr(self._stamp).encode(), digest_size=8).hexdigest()
        self._name = f"{py_func.__module__}_{digest}"

    def get_cache_path(self) -> str:
        """Return the folder."""
        given: Any = super()
        return os.path.join(os.path.dirname(given.get_cache_path()), self._name)


class ReadyFolder(GivenFolder):
    """Finds kernels that came ready-made, in folders named as those below ``NUMBA_CACHE_DIR``; no one has to be able to
    write there.
    """

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> ReadyFolder:
        """Return where those of a kernel would be."""
        return cls(py_func, py_file)

    def get_cache_path(self) -> str:
        """Return the folder."""
        return str(FOLDER / self._name)


class BesideSource(_Stamped, InTreeCacheLocator):
    """Keeps kernels in ``__pycache__`` beside their source."""


class UsersFolder(_Stamped, UserWideCacheLocator):
    """Keeps kernels in the user's folder for caches, where the source's own cannot be written to."""


class Nowhere(_Stamped, UserWideCacheLocator):
    """Keeps nothing: what is left where no folder can be written to, as in a container whose file system is
    read-only.
    """

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> Nowhere:
        """Return the locator, and say once what it costs."""
        _say_not_kept("no folder of this user can be written to")
        return cls(py_func, py_file)

    def get_cache_path(self) -> str:
        """Return no folder."""
        return ""


@cache
def _say_not_kept(reason: str) -> None:
    line = f"kernels are not kept, each process compiles them: {reason}; NUMBA_CACHE_DIR names another folder"
    print(f"arena: {line}", file=sys.stderr)


OURS = [f"{__name__}.{locator.__name__}" for locator in (GivenFolder, BesideSource, UsersFolder)]
LOCATORS = ",".join([*OURS, "IPythonCacheLocator", "ZipCacheLocator", f"{__name__}.{Nowhere.__name__}"])
_stands_on: WeakKeyDictionary[Any, frozenset[Path]] = WeakKeyDictionary()  # folders by kernel


def packages_of(kernel: Callable[..., Any]) -> frozenset[Path]:
    """Return the folders of the packages that a kernel stands on: this one, its own, and those
    of kernels that its module has got.
    """
    if kernel not in _stands_on:
        within = [*kernel.__globals__.values(), *(cell.cell_contents for cell in kernel.__closure__ or ())]
        called = [value.py_func for value in within if isinstance(value, Dispatcher)]
        below = {_stands_on[one] if one in _stands_on else frozenset({_package_of(one)}) for one in called}
        _stands_on[kernel] = frozenset({HERE, _package_of(kernel)}).union(*below)
    return _stands_on[kernel]


def _package_of(kernel: Callable[..., Any]) -> Path:
    """Return the folder of the kernel's whole package, all of its shelves included; its file where it is in none."""
    return _folder_of(kernel.__module__.partition(".")[0]) or Path(inspect.getfile(kernel))


@cache
def _folder_of(package: str) -> Path | None:
    return next(map(Path, getattr(sys.modules.get(package), "__path__", ())), None)


@cache
def lock_file(folder: str) -> int | None:
    """Open the file of which each kernel in a folder locks a byte, for as long as the process
    lives; None where there can be none.
    """
    if not LOCKS:
        return None
    try:
        os.makedirs(folder, exist_ok=True)
        return os.open(Path(folder, "kernels.lock"), os.O_RDWR | os.O_CREAT, 0o666)
    except OSError:
        return None


def held(file: int, byte: int) -> bool:
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
