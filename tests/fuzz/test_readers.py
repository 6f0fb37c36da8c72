"""Whatever a file holds: it is read, or refused in one line, at once and in little memory."""

from __future__ import annotations

import gc
import gzip
import resource
import signal
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ArenaError
from arena_core.base.errors import LONGEST_LINE
from tests.fuzz.conftest import EXAMPLES
from tests.fuzz.readers import BYTES, READERS, Change

CORPUS = Path(__file__).parent / "corpus"
HANG = 5.0  # s of the processor's time: the clock on the wall tells how busy a machine is
MEMORY = 1_000_000  # kB that one process may take for all inputs together
TELLING = (
    *(
        "arena_crowds.replay.recordings",
        "arena_worlds.formats.flatland_world",
        "arena_tasks.scenario_files.scenario_task",
    ),
    "arena_ros.bags.importing",
)
read_so_far = {"inputs": 0, "refused": 0}


class Hang(BaseException):
    """An input took too long."""


def read_within_limits(name: str, path: Path) -> None:
    """Read a file; fail where that raises anything but an ArenaError of one line, or takes too long."""

    def stop(*_: object) -> None:
        raise Hang(f"{name}: more than {HANG} s")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, HANG)
    try:
        read_so_far["inputs"] += 1
        READERS[name].read(path)
    except ArenaError as error:
        read_so_far["refused"] += 1
        check_line(str(error), path)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def check_line(line: str, path: Path) -> None:
    """Fail for an error of several lines, or of a page."""
    assert "\n" not in line
    assert len(line) < LONGEST_LINE + 4 * len(str(path))


def spoilt(data: st.DataObject, way: Change, content: bytes, packed: bool) -> bytes:
    """Return a changed content; one of gzip is changed as it is unpacked, unless its bytes are changed."""
    if not packed or way is BYTES:
        return bytes(data.draw(way(content)))
    return gzip.compress(data.draw(way(gzip.decompress(content))))


@pytest.fixture(autouse=True)
def quiet(monkeypatch: pytest.MonkeyPatch, recwarn: pytest.WarningsRecorder) -> None:
    """Tell no one of what is odd about a file, and warn no one: only errors are
    looked for, and the reader's own time.
    """
    import warnings

    warnings.simplefilter("ignore")
    gc.collect()
    gc.freeze()  # what other readers left behind is not searched again in this one's time
    for module in TELLING:
        monkeypatch.setattr(f"{module}.print_notice", lambda line: None)


@pytest.mark.parametrize("name", READERS)
def test_a_good_file_is_read(name: str, tmp_path: Path) -> None:
    for file, good in READERS[name].good.items():
        READERS[name].beside(tmp_path)
        path = tmp_path / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(good())
        if name != "pack":  # whose files are not those that it was made of
            READERS[name].read(path)


@pytest.mark.parametrize("name", READERS)
def test_a_spoilt_file_is_read_or_refused_in_one_line(name: str) -> None:
    reader = READERS[name]
    contents = {file: good() for file, good in reader.good.items()}

    @settings(settings.get_profile("fuzz"), max_examples=max(round(reader.share * EXAMPLES), 3))
    @given(st.data())
    def spoil(data: st.DataObject) -> None:
        file = data.draw(st.sampled_from(sorted(contents)))
        way = data.draw(st.sampled_from(reader.changes))
        content = spoilt(data, way, contents[file], file.endswith(".gz"))
        with tempfile.TemporaryDirectory(prefix="fuzz") as folder:
            reader.beside(Path(folder))
            path = Path(folder, file)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
            read_within_limits(name, path)

    spoil()


@pytest.mark.parametrize("kept", sorted(CORPUS.rglob("*.*")), ids=lambda path: path.relative_to(CORPUS).as_posix())
def test_a_file_that_once_did_harm_is_refused_in_one_line(kept: Path, tmp_path: Path) -> None:
    """``corpus/READER/...`` keeps them; the name is that of the file for its reader,
    after the last double underscore.
    """
    reader = READERS[kept.parent.name]
    reader.beside(tmp_path)
    file = next(
        (file for file in reader.good if Path(file).name == kept.name.rpartition("__")[2]), next(iter(reader.good))
    )
    path = tmp_path / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(kept.read_bytes())
    read_within_limits(kept.parent.name, path)


def test_reading_took_little_memory() -> None:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(
        f"\n{read_so_far['inputs']} inputs, {read_so_far['refused']} of them refused, {peak / 1000:.0f} MB at the most"
    )
    assert peak < MEMORY or EXAMPLES <= 100  # beside all other tests, others' memory counts too
