"""The folder of a run: one run at a time, and nothing left behind by a request that was refused."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from arena_core.base.errors import RunFolderError

LOCK = ".lock"
ITS_FOLDER = "out=DIR"  # which messages name
# what one process lacks, and others may have
OWN = (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EFBIG, errno.EBADF, errno.EAGAIN)
KEPT = f"finished episodes are kept, resume=true {ITS_FOLDER} continues"


@contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Keep every other run out of a folder, which is made where it is missing; raise RunFolderError (one line) where
    one is in it.

    The kernel holds the lock, not the file: a killed run leaves a file and no lock.
    """
    from filelock import FileLock, Timeout

    missing = not folder.exists()
    lock = FileLock(folder / LOCK)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock.acquire(timeout=0)
    except Timeout:
        raise RunFolderError(
            f"{folder}: another run is under way there; allowed: its end, or another folder, {ITS_FOLDER}"
        ) from None
    except OSError as error:
        raise RunFolderError(f"cannot use the run's folder {folder}: {error.strerror or error}") from error
    try:
        yield
    finally:
        with suppress(OSError):
            (folder / LOCK).unlink()  # while it is held: who opens it now sees that it is gone, and makes another
        lock.release()
        with suppress(OSError):
            if missing:
                folder.rmdir()  # if it is empty


def folder_identity(folder: Path) -> tuple[int, int] | None:
    """Return what a folder stays the same by while its name may come to stand for another; None where there is none."""
    try:
        found = folder.stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino


class FolderLost(RunFolderError):
    """A run's folder cannot be written to, by this process or by any other."""


def check_there(folder: Path) -> None:
    """Raise FolderLost where a run's folder is gone: an episode does not make it again."""
    if not folder.is_dir():
        raise FolderLost(f"{folder} was moved or removed while its run was under way; allowed: a folder that stays")


@contextmanager
def check_writable(folder: Path) -> Iterator[None]:
    """Raise FolderLost where a run's folder takes no file; what this process alone lacks stays a RunFolderError.

    A folder may go while a file is written to it: that is said as ``check_there`` says it.
    """
    try:
        yield
    except RunFolderError as error:
        check_there(folder)
        if getattr(error.__cause__, "errno", None) in OWN:
            raise
        raise FolderLost(str(error)) from error


class NewFolders:
    """What Hydra is about to make for a request before anybody has looked at the request; it asks no one."""

    def __init__(self) -> None:
        self._folders: set[Path] = set()
        self._files: dict[Path, bytes | None] = {}

    def expect(self, folder: Path) -> None:
        """Note a folder and those above it, as far as they are not there yet."""
        whole = folder.absolute()
        self._folders |= {place for place in (whole, *whole.parents) if not place.exists()}

    def expect_file(self, path: Path) -> None:
        """Note a file and what it holds now."""
        with suppress(OSError):
            self._files[path.absolute()] = path.read_bytes() if path.exists() else None

    def forget(self) -> None:
        """Begin a request again."""
        self._folders.clear()
        self._files.clear()

    def remove(self) -> None:
        """Bring the files back to what they were, and remove the folders that are empty."""
        for path, before in self._files.items():
            with suppress(OSError):
                path.unlink() if before is None else path.write_bytes(before)
        for folder in sorted(self._folders, key=lambda folder: len(folder.parts), reverse=True):
            with suppress(OSError):
                folder.rmdir()
        self.forget()


new_folders = NewFolders()  # Hydra makes the object that hears of a run's beginning, so the two meet here
