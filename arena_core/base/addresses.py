"""Where an input file lies: a path of this machine, or a file inside an installed package."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path, PurePosixPath

from arena_core.base.errors import InputFileError
from arena_core.base.files import AnyPath

PACKAGE = "pkg://"


def local_path(address: AnyPath) -> Path:
    """Return the path of a file; ``pkg://PACKAGE/FOLDER/FILE`` is one inside an installed package, which is not
    imported.

    A configuration that names its files so is the same on every machine. Raises InputFileError for a package that is
    not installed and for a way out of it.
    """
    if isinstance(address, Path) or not address.startswith(PACKAGE):
        return Path(address)
    package, *parts = PurePosixPath(address.removeprefix(PACKAGE)).parts or ("",)
    if not package.isidentifier() or not parts or ".." in parts:
        raise InputFileError(f"{address}: is no file of a package; allowed: {PACKAGE}PACKAGE/FOLDER/FILE without ..")
    spec = find_spec(package)
    if spec is None or not spec.submodule_search_locations:
        raise InputFileError(f"{address}: package {package} is not installed")
    return Path(next(iter(spec.submodule_search_locations)), *parts)
