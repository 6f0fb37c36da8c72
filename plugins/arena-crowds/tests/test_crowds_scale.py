"""No recording is read at a wrong scale: header, numbers, name or user tell unit and frame rate, or it is an error."""

import gzip
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import InputFileError
from arena_core.commands import print_notice
from arena_core.testing import component
from arena_crowds.replay.recordings import read_recording

CORRIDOR = Path(__file__).resolve().parents[3] / "tests" / "data" / "pedestrians" / "corridor" / "uo-corridor.txt"
JUELICH = Path(__file__).resolve().parents[4] / "shared" / "data" / "pedestrians" / "juelich"
needs_juelich = pytest.mark.skipif(
    not JUELICH.is_dir(), reason="the recorded trajectories are not beside the repository"
)


def rows(unit: float = 1.0, rate: float = 10.0, speed: float = 1.2, layout: str = "juelich") -> str:
    """Return two people who walk along x, in units of ``unit`` m and ``rate`` frames a second."""
    steps = [
        (person, frame, speed * frame / rate / unit, 3.0 * person / unit) for person in (1, 2) for frame in range(31)
    ]
    if layout == "obsmat":
        return "".join(f"{frame} {person} {x} 0 {y} {speed} 0 0\n" for person, frame, x, y in steps)
    order = (lambda p, f: (p, f)) if layout == "juelich" else (lambda p, f: (f, p))
    return "".join("{} {} {} {}\n".format(*order(person, frame), x, y) for person, frame, x, y in steps)


def written(folder: Path, content: str, name: str = "walks.txt") -> Path:
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(content)
    return path


@pytest.fixture(autouse=True)
def _told_anew() -> None:
    print_notice.cache_clear()


@pytest.mark.parametrize(
    ("header", "unit", "rate"),
    [
        (
            "# description: UNI_CORR_500_01\n# framerate: 25.00\n#geometry: geometry.xml\n# id frame x/m y/m z/m\n",
            1.0,
            25.0,
        ),
        ("#framerate: 16 fps\n# id frame x/cm y/cm z/cm\n", 0.01, 16.0),
        ("\ufeff# PersID Frame X [in m] Y [in m] Z [in m], 12.5 frames per second\n", 1.0, 12.5),
        ("# unit: mm, frame rate = 30\n", 0.001, 30.0),
        ("# x(cm) at 10 fps\n", 0.01, 10.0),
    ],
)
def test_a_header_tells_unit_and_frame_rate(tmp_path: Path, capsys, header: str, unit: float, rate: float) -> None:
    recording = read_recording(written(tmp_path, header + rows(unit, rate)), "juelich")
    assert recording.duration == pytest.approx(30.0 / rate)
    assert recording.median_speed() == pytest.approx(1.2)
    assert recording.positions[31, 1] == pytest.approx(6.0)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("layout", ["juelich", "frames"])
def test_without_a_header_unit_and_frame_rate_are_asked_for(tmp_path: Path, layout: str) -> None:
    path = written(tmp_path, rows(0.01, 16.0, layout=layout))
    with pytest.raises(
        InputFileError,
        match=r"walks\.txt: neither header nor name tells its unit of length; allowed: unit=m or unit=cm",
    ):
        read_recording(path, layout)
    with pytest.raises(
        InputFileError, match=r"walks\.txt: neither header nor name tells its frame rate; allowed: frame_rate=NUMBER"
    ):
        read_recording(path, layout, unit="cm")
    assert read_recording(path, layout, 16.0, "cm").median_speed() == pytest.approx(1.2)


@pytest.mark.parametrize(
    ("header", "rate", "unit", "says"),
    [
        ("# framerate: 25 x/m\n", 16.0, None, "frame_rate is 16, but its header says 25"),
        ("# framerate: 25 x/m\n", None, "cm", "unit is cm, but its header says m"),
        ("# framerate: 25\n# framerate: 30 x/m\n", None, None, "tells the frame rates 25, 30; allowed: one, > 0"),
        ("# framerate: 0 x/m\n", None, None, "tells the frame rates 0; allowed: one, > 0"),
        ("# framerate: 1.2.3 x/m\n", None, None, "tells the frame rates 1.2.3; allowed: one, > 0"),
        ("# framerate: 25 x/m y/m, z in cm\n", None, None, "several units of length, cm, m; allowed: one"),
    ],
)
def test_what_contradicts_the_header_is_one_line(tmp_path: Path, header: str, rate, unit, says: str) -> None:
    with pytest.raises(InputFileError) as error:
        read_recording(written(tmp_path, header + rows(rate=25.0)), "juelich", rate, unit)
    assert says in str(error.value)
    assert "\n" not in str(error.value)


@settings(max_examples=25, deadline=None)
@given(rate=st.sampled_from((2.5, 10.0, 12.0, 15.0, 25.0, 29.97)), speed=st.floats(0.6, 2.4))
def test_velocities_tell_the_frame_rate(tmp_path_factory, rate: float, speed: float) -> None:
    path = written(tmp_path_factory.getbasetemp(), rows(rate=rate, speed=speed, layout="obsmat"))
    assert read_recording(path, "obsmat").duration == pytest.approx(30.0 / rate, rel=0.01)


def test_a_frame_rate_that_contradicts_the_velocities_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, rows(rate=15.0, layout="obsmat"))
    with pytest.raises(InputFileError, match=r"frame_rate is 25, but its velocities say 15 \(1/s\)"):
        read_recording(path, "obsmat", 25.0)
    with pytest.raises(InputFileError, match="unit is cm, but format obsmat is in m"):
        read_recording(path, "obsmat", unit="cm")


def test_where_nobody_moves_the_name_of_a_published_recording_tells(tmp_path: Path) -> None:
    still = "".join(f"{frame} 1 0 0 0 0 0 0\n" for frame in (0, 6, 12))
    assert read_recording(written(tmp_path, still, "seq_eth/obsmat.txt"), "obsmat").duration == pytest.approx(0.8)
    assert read_recording(written(tmp_path, still, "seq_hotel/obsmat.txt"), "obsmat").duration == pytest.approx(0.48)
    with pytest.raises(InputFileError, match="neither header nor name tells its frame rate"):
        read_recording(written(tmp_path, still, "elsewhere/obsmat.txt"), "obsmat")


def test_a_recording_tells_its_rate_also_when_its_frames_are_numbered_as_those_of_eth(
    street: Path, tmp_path: Path
) -> None:
    duration = np.ptp(np.loadtxt(street)[:, 0]) / 25.0  # 360.4 s of zara01
    assert read_recording(street, "obsmat").duration == pytest.approx(duration)
    lines = [[f"{value:.9g}" for value in line] for line in np.loadtxt(street)]
    numbered = [[str(0.6 * float(line[0])), *line[1:]] for line in lines]  # every 6 frames in place of every 10
    path = written(tmp_path, "\n".join(map(" ".join, numbered)), "eth.txt")
    assert read_recording(path, "obsmat").duration == pytest.approx(duration)  # 15 frames a second


@pytest.mark.parametrize(
    ("source", "speed"),
    [
        pytest.param(CORRIDOR, 1.320, id="drawn"),
        pytest.param(JUELICH / "uo-050-180-180.txt", 1.374, id="real", marks=needs_juelich),
    ],
)
def test_juelich_recordings_are_read_by_their_names_and_in_metres_by_their_headers(
    source: Path, speed: float, tmp_path: Path, capsys
) -> None:
    in_cm = read_recording(source, "juelich")
    assert in_cm.median_speed() == pytest.approx(speed, abs=0.001)
    lines = [line.split() for line in source.read_text().splitlines()]
    in_m = [" ".join((*line[:2], *(str(float(value) / 100.0) for value in line[2:]))) for line in lines]
    path = written(tmp_path, "# framerate: 16\n# id frame x/m y/m z/m\n" + "\n".join(in_m))
    assert np.allclose(read_recording(path, "juelich").positions, in_cm.positions)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(("speed", "told"), [(0.012, True), (0.31, False), (2.4, False), (120.0, True)])
def test_people_of_no_human_pace_are_told_of_once(tmp_path: Path, capsys, speed: float, told: bool) -> None:
    path = written(tmp_path, rows(speed=speed))
    for _ in range(2):
        read_recording(path, "juelich", 10.0, "m")
    line = (
        f"arena: {path}: people walk at {speed:.2g} m/s (median), usual is 0.3 to 2.5; "
        "is it the right unit and frame_rate?\n"
    )
    assert capsys.readouterr().err == (line if told else "")


def test_replay_hands_on_what_the_user_says(tmp_path: Path) -> None:
    path = written(tmp_path, rows(0.01, 16.0, layout="frames"))
    chosen = [f"pedestrians.path={path}", "pedestrians.start_time=0.0"]
    with pytest.raises(InputFileError, match="allowed: unit=m"):
        component("pedestrians", "replay", chosen)
    assert component("pedestrians", "replay", [*chosen, "pedestrians.unit=cm", "pedestrians.frame_rate=16"])


PIECES = [
    *("# framerate: 25\n", "# x/m\n", "# x/cm fps 0\n", "# fps: .\n", "\n", "\0", "\ufeff", "-", "1 1\n"),
    *("1 0 0 0 0\n", "1 1 1.5 0 0\n", "2 0 3 3 0 9 red\n", "0 1 0 0\n", "1 0 1e308 0\n", "1e12 0 0 0\n", "1 2 nan 3\n"),
    *("0 1 0 0 0 1 0 1\n", "5 1 9 0 9 1 0 1\n", "9 1 0 0 0 1 0 1\n"),
]


@settings(max_examples=200, deadline=None)
@given(
    pieces=st.lists(st.sampled_from(PIECES) | st.text(max_size=5), max_size=8),
    layout=st.sampled_from(("frames", "obsmat", "juelich")),
)
def test_a_spoilt_recording_is_read_or_refused_in_one_line(tmp_path_factory, pieces: list[str], layout: str) -> None:
    path = tmp_path_factory.getbasetemp() / "spoilt.txt"
    path.write_bytes("".join(pieces).encode("utf-8", "surrogatepass"))
    _read_or_refuse(path, layout)


@settings(max_examples=60, deadline=None)
@given(cut=st.integers(0, 200), byte=st.integers(0, 255))
def test_a_spoilt_archive_is_read_or_refused_in_one_line(tmp_path_factory, cut: int, byte: int) -> None:
    content = bytearray(gzip.compress(("# framerate: 10 x/m\n" + rows()).encode()))
    content[cut % len(content)] = byte
    path = tmp_path_factory.getbasetemp() / "spoilt.txt.gz"
    path.write_bytes(content[: len(content) - cut % 7])
    _read_or_refuse(path, "juelich")


def _read_or_refuse(path: Path, layout: str) -> None:
    said, recording = "", None
    try:
        recording = read_recording(path, layout)
    except InputFileError as error:
        said = str(error)
    assert "\n" not in said
    if recording is None:
        assert str(path) in said
    else:
        assert np.isfinite(recording.positions).all()
        assert np.isfinite(recording.stamps).all()
