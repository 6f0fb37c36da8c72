"""Ready-made kernels: compiled for a common processor when a wheel was built, for whoever has compiled none.

numba finds kernels by the processor that they were compiled for. So a process that is to use them compiles for that
processor, too, and says so in the environment before numba is imported; its children do as it does.
"""

from __future__ import annotations

import json
import os
import platform
import sys
import sysconfig
from collections.abc import Mapping, MutableMapping
from dataclasses import asdict, dataclass
from hashlib import blake2b
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from arena_kernels.sources import sources_digest

HERE = Path(__file__).parent
FOLDER = HERE / "ready"  # in a wheel for one platform and version of Python; elsewhere there is none
NAME, NATIVE = "ready.json", "native.txt"
CPU, CPU_FEATURES, CHOSEN = (
    "NUMBA_CPU_NAME",
    "NUMBA_CPU_FEATURES",
    "ARENA_READY_KERNELS",
)  # the last one: whose they are
INFO = Path("/proc/cpuinfo")  # of Linux


@dataclass(frozen=True, slots=True)
class Target:
    """A processor that kernels are made for: LLVM's names of it and of what it can do, and Linux's names of that."""

    cpu: str
    features: str
    flags: tuple[str, ...]


# x86-64-v3 of the x86-64 psABI 1.0: Intel since Haswell (2013), AMD since Excavator (2015)
TARGETS = {
    "x86_64": Target(
        "x86-64-v3",
        "+avx,+avx2,+bmi,+bmi2,+f16c,+fma,+lzcnt,+movbe,+popcnt,+sse4.2",
        ("avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe", "popcnt", "sse4_2", "xsave"),
    )
}


@dataclass(frozen=True, slots=True)
class Manifest:
    """What kernels in a folder are made for and from; they are of use where all of it is the same."""

    cpu: str
    features: str
    flags: tuple[str, ...]
    python: str
    platform: str
    numba: str
    sources: str

    @property
    def digest(self) -> str:
        """Return what tells these kernels from others."""
        return blake2b(json.dumps(asdict(self), sort_keys=True).encode(), digest_size=4).hexdigest()


def manifest_of(target: Target) -> Manifest:
    """Return what kernels that this process makes for a processor are made from."""
    return Manifest(
        target.cpu,
        target.features,
        target.flags,
        sys.implementation.cache_tag or "",
        sysconfig.get_platform(),
        version("numba"),
        sources_digest(HERE),
    )


def write_manifest(folder: Path, target: Target) -> Manifest:
    """Write it beside kernels that were made for a processor, and return it."""
    manifest = manifest_of(target)
    (folder / NAME).write_text(json.dumps(asdict(manifest), indent=1) + "\n")
    return manifest


def read_manifest(folder: Path) -> Manifest | None:
    """Return what the kernels of a folder are made for; None where there are none, or none that can be known."""
    try:
        facts = json.loads((folder / NAME).read_text())
        return Manifest(**{**facts, "flags": tuple(facts["flags"])})
    except (OSError, ValueError, TypeError, KeyError):
        return None


def choose_target(folder: Path = FOLDER, environ: MutableMapping[str, str] = os.environ) -> str:
    """Have this process and its children use ready-made kernels, if they are of use here; return what speaks against.

    To be called before numba is imported.
    """
    if (manifest := read_manifest(folder)) is None:
        return "there are none"
    reason = reason_against(manifest, environ, processor_flags())
    if reason:
        environ[CHOSEN] = "none"
    else:
        environ.update({CPU: manifest.cpu, CPU_FEATURES: manifest.features, CHOSEN: manifest.digest})
    return reason


def reason_against(manifest: Manifest, environ: Mapping[str, str], flags: frozenset[str]) -> str:
    """Return why ready-made kernels are not used, empty where they are; ``flags`` are what the processor can do."""
    if CHOSEN in environ:
        return "" if environ[CHOSEN] == manifest.digest else "the process that has started this one uses none"
    if (mode := environ.get("ARENA_KERNELS", "fast")) in ("native", "plain"):
        return f"ARENA_KERNELS is {mode}"
    if CPU in environ or CPU_FEATURES in environ:
        return f"{CPU} or {CPU_FEATURES} is set"
    if "numba" in sys.modules:
        return "numba was imported before"
    try:
        here = manifest_of(Target(manifest.cpu, manifest.features, manifest.flags))
    except PackageNotFoundError:
        return "numba is not installed"
    if here != manifest:
        return "they were made with other versions, or from other sources"
    if lacking := sorted(set(manifest.flags) - flags):
        return f"this processor lacks {', '.join(lacking)}"
    if has_native(manifest, flags, environ):
        return "kernels were compiled for this processor"
    return ""


def processor_flags(info: Path = INFO) -> frozenset[str]:
    """Return what Linux says that the processor can do; nothing elsewhere."""
    try:
        lines = info.read_text(errors="replace").splitlines()
    except OSError:
        return frozenset()
    return frozenset(next((line.partition(":")[2].split() for line in lines if line.startswith("flags")), ()))


def has_native(manifest: Manifest, flags: frozenset[str], environ: Mapping[str, str]) -> bool:
    """Return whether kernels were compiled for this very processor, and are to be used in place of ready-made ones."""
    line = _native_line(manifest, flags)
    return any(line in _lines(folder / NATIVE) for folder in native_folders(environ))


def note_native(manifest: Manifest, flags: frozenset[str], environ: Mapping[str, str]) -> Path:
    """Note in the first folder that can be written to that they were compiled; return the file, or raise OSError."""
    refused = OSError("no folder for kernels")
    for folder in native_folders(environ):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with (folder / NATIVE).open("a") as file:
                file.write(_native_line(manifest, flags) + "\n")
        except OSError as error:
            refused = error
        else:
            return folder / NATIVE
    raise refused


def native_folders(environ: Mapping[str, str]) -> list[Path]:
    """Return where it may be noted that kernels were compiled: beside them, or else beside the ready-made ones and in
    the user's folder for caches.
    """
    if given := environ.get("NUMBA_CACHE_DIR"):
        return [Path(given)]
    cache = environ.get("XDG_CACHE_HOME") or environ.get("LOCALAPPDATA") or os.path.expanduser("~/.cache")
    return [FOLDER, Path(cache) / "arena"]


def _native_line(manifest: Manifest, flags: frozenset[str]) -> str:
    able = blake2b(" ".join([platform.machine(), *sorted(flags)]).encode(), digest_size=8).hexdigest()
    return f"{manifest.digest} {able}"


def _lines(file: Path) -> list[str]:
    try:
        return file.read_text().splitlines()
    except (OSError, ValueError):
        return []
