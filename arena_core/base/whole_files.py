"""Files that are written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from secrets import token_hex
from typing import IO

from arena_core.base.errors import RunFolderError
from arena_core.base.files import AnyPath
from arena_core.base.portability import let_others_read


def write_whole(path: AnyPath, write: Callable[[IO[bytes]], object]) -> None:
    """Write a file beside its place, have the disk take it, and rename it: no half-written file is ever seen, not after
    a power cut either.

    Raises RunFolderError with the file and the reason (no space left, not writable).
    """
    path = Path(path)
    temporary = path.parent / f".{path.name}.{token_hex(4)}"  # named before it is made: Ctrl-C may come right after
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with temporary.open("xb") as file:
            write(file)
            file.flush()
            let_others_read(file.fileno())
            os.fsync(file.fileno())
        temporary.replace(path)
        _sync_folder(path.parent)
    except BaseException as error:
        with suppress(OSError):
            temporary.unlink()
        if isinstance(error, OSError):
            raise RunFolderError(f"cannot write {path}: {error.strerror or error}") from error
        raise


def write_text_whole(path: AnyPath, text: str) -> None:
    """Write a text file as ``write_whole`` does, UTF-8, with escapes in place of
    what UTF-8 has not (lone surrogates).
    """
    write_bytes_whole(path, text.encode(errors="backslashreplace"))


def write_bytes_whole(path: AnyPath, content: bytes) -> None:
    """Write a file as ``write_whole`` does."""
    write_whole(path, lambda file: file.write(content))


def _sync_folder(folder: Path) -> None:
    """Have the disk take a folder's names, too; not every file system can."""
    with suppress(OSError):
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)
