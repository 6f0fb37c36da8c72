"""Links, pipes and folders where files should be: refused in one line or followed, never waited for, and
nothing outside is written.
"""

from __future__ import annotations

import os
import signal
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ArenaError
from tests.fuzz.conftest import EXAMPLES
from tests.fuzz.readers import READERS, beside_run, evaluate_run
from tests.fuzz.test_readers import TELLING, check_line

PATIENCE = 30.0  # s on the wall: who waits for a pipe uses no time of the processor
PLACES: dict[str, Callable[[Path], object]] = {
    "a folder": lambda path: path.mkdir(),
    "a pipe": lambda path: os.mkfifo(path),
    "a link to itself": lambda path: path.symlink_to(path),
    "a link to nothing": lambda path: path.symlink_to(path.with_name("nothing")),
    "a link to a file without an end": lambda path: path.symlink_to("/dev/zero"),
    "a link to a pipe": lambda path: (os.mkfifo(path.with_name("pipe")), path.symlink_to(path.with_name("pipe"))),
    "a link to a folder": lambda path: path.symlink_to("/"),
}
IN_A_RUN = (
    "records",
    "timing",
    "worlds",
    "report",
    "report/tables",
    "episodes.csv",
    "summary.csv",
    "provenance.json",
    "records/0001.npz",
)


class Waited(BaseException):
    """Something waits for what never comes."""


@contextmanager
def patience(what: str) -> Iterator[None]:
    """Fail where something takes long on the wall."""

    def stop(*_: object) -> None:
        raise Waited(f"{what}: more than {PATIENCE} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@pytest.fixture(autouse=True)
def quiet(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in TELLING:
        monkeypatch.setattr(f"{module}.print_notice", lambda line: None)


@pytest.mark.parametrize("name", READERS)
def test_what_is_no_file_is_refused_in_one_line(name: str, tmp_path: Path) -> None:
    reader = READERS[name]
    for number, (kind, put) in enumerate(PLACES.items()):
        folder = tmp_path / str(number)
        folder.mkdir()
        reader.beside(folder)
        path = folder / next(iter(reader.good))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)
        put(path)
        with patience(f"{name}, {kind}"):
            try:
                reader.read(path)
            except ArenaError as error:
                check_line(str(error), path)


def outside(place: Path) -> dict[str, bytes]:
    """Return all that lies in a folder."""
    return {str(path): path.read_bytes() if path.is_file() else b"" for path in place.rglob("*")}


def link_out(run: Path, name: str, place: Path) -> None:
    """Put a link to ``place`` where something of a run lies or would lie; what lay there goes to ``place``."""
    with suppress(FileExistsError, NotADirectoryError):  # the link before may lie above
        (run / name).parent.mkdir(exist_ok=True)
        if (run / name).is_symlink() or not (run / name).resolve().is_relative_to(run.resolve()):
            return
        if (run / name).exists():
            (run / name).rename(place)
        elif "." not in name:
            place.mkdir()
        (run / name).symlink_to(place)


def test_nothing_outside_a_runs_folder_is_written_through_links() -> None:
    from arena_metrics.pages.report import ReportCommand

    def report(run: Path) -> object:
        return ReportCommand().run([str(run), "--no-figures"])

    @settings(settings.get_profile("fuzz"), max_examples=max(EXAMPLES // 40, 5))
    @given(
        st.lists(st.sampled_from(IN_A_RUN), min_size=1, max_size=3, unique=True),
        st.sampled_from((evaluate_run, report)),
    )
    def link(names: list[str], act: Callable[[Path], object]) -> None:
        with tempfile.TemporaryDirectory(prefix="fuzz") as folder:
            run, elsewhere = Path(folder, "run"), Path(folder, "elsewhere")
            beside_run(run)
            elsewhere.mkdir()
            for number, name in enumerate(names):
                link_out(run, name, elsewhere / str(number))
            before = outside(elsewhere)
            with patience(", ".join(names)), suppress(ArenaError):
                act(run)
            assert outside(elsewhere) == before

    link()
