"""Files that do harm elsewhere are refused in one line: they are too large, damaged, no files,
or lead out of their folder.
"""

import gzip
import math
import os
import re
import struct
import zipfile
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

import arena_core
from arena_core import ArenaError, InputFileError, run
from arena_core.base.files import check_inside
from arena_core.files import (
    LIMITS,
    csv_text,
    escape_formula,
    is_file,
    read_array,
    read_arrays,
    read_bytes,
    read_json,
    read_table,
    read_yaml,
    reading_within,
)
from arena_core.loop.half_written import keep_room
from arena_core.loop.record_files import write_record
from arena_core.records import read_grid, read_record
from arena_core.runs.jobs.rows import evaluate_record
from arena_core.testing import record

WRITERS = re.compile(r"csv\.writer\(|DictWriter\(|\.to_csv\(")


def refused(read, path, *words):
    with pytest.raises(InputFileError) as caught:
        read(path, *words, "a good one") if read is not read_record else read(path)
    line = str(caught.value)
    assert line.startswith(str(path))
    assert "\n" not in line
    return line


@pytest.mark.parametrize(
    "text",
    [
        "!!bool x",
        "!!int ''",
        "!!float ''",
        "!!timestamp x",
        "a: &a [*a]",
        "a: 1\na: 2",
        "? [1]\n: 2",
        "[" * 3000,
        "\x01",
    ],
)
def test_yaml_that_its_own_reader_stumbles_over_is_one_line(tmp_path, text):
    (tmp_path / "a.yaml").write_text(text)
    assert "is no YAML" in refused(read_yaml, tmp_path / "a.yaml")


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a": 1, "a": 2}', "NaN", "1" * 5000, "{", '"\udc80"'])
def test_json_of_deep_brackets_or_no_json_is_one_line(tmp_path, text):
    (tmp_path / "a.json").write_bytes(text.encode("utf-8", "surrogateescape"))
    assert "is no" in refused(read_json, tmp_path / "a.json")


def header_of(text):
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"PK\x03\x04 and no more",
        b"\x93NUMPY\x09\x09",
        header_of(b"{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }'''"),
        header_of(b"(" * 300),
        header_of(b"{'descr': '|O', 'fortran_order': False, 'shape': (1,), }") + bytes(8),
        header_of(b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }"),
        header_of(b"{'descr': '<f8', 'fortran_order': False, 'shape': (-3,), }"),
        header_of(b"{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }") + bytes(7),
    ],
)
def test_an_array_with_a_damaged_header_or_no_room_is_one_line(tmp_path, content):
    (tmp_path / "a.npy").write_bytes(content)
    assert "is no NumPy file" in refused(read_array, tmp_path / "a.npy")


def test_arrays_are_read_as_they_were_written(tmp_path):
    arrays = {
        "a": np.arange(6.0).reshape(2, 3).T,
        "b": np.array("text"),
        "c": np.zeros((0, 3), np.int8),
        "d": np.array(True),
    }
    np.savez_compressed(tmp_path / "a.npz", **arrays)
    read = read_arrays(tmp_path / "a.npz", "arrays")
    assert read.keys() == arrays.keys()
    for name, array in arrays.items():
        assert np.array_equal(read[name], array)
        assert (read[name].dtype, read[name].shape) == (array.dtype, array.shape)
    np.save(tmp_path / "a.npy", arrays["a"])
    assert np.array_equal(read_array(tmp_path / "a.npy", "an array"), arrays["a"])


@pytest.mark.slow
def test_an_archive_that_would_fill_the_memory_is_refused_before_it_is_unpacked(tmp_path):
    with (
        zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("a.npy", "w", force_zip64=True) as member,
    ):
        for _ in range(LIMITS.arrays_bytes // 10**7 + 1):
            member.write(bytes(10**7))
    assert (tmp_path / "a.npz").stat().st_size < 10**6
    assert "at most" in refused(read_arrays, tmp_path / "a.npz")


def test_a_gzip_file_is_unpacked_no_further_than_its_limit(tmp_path):
    with gzip.open(tmp_path / "a.gz", "wb", compresslevel=1) as file:
        file.write(bytes(10**6))
    assert "larger than 999999 bytes unpacked" in refused(read_bytes, tmp_path / "a.gz", 10**6 - 1)
    assert len(read_bytes(tmp_path / "a.gz", 10**6, "zeros")) == 10**6


def test_what_is_no_file_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path, tmp_path / "pipe", Path("/dev/zero")):
        assert "it is no file" in refused(read_bytes, path, 100)
    assert "No such file" in refused(read_bytes, tmp_path / "gone", 100)


def test_a_table_with_a_row_of_another_length_is_refused(tmp_path):
    (tmp_path / "a.csv").write_text("a,b\n1,2\n3\n")
    assert "line 3 has another number of fields" in refused(read_table, tmp_path / "a.csv")


@pytest.mark.parametrize("text", ["=1+1", "@SUM(A1)", "+cmd|' /C calc'!A0", "-2+3+cmd|' /C calc'!A0", "\t=1", "\r=1"])
def test_a_text_that_a_spreadsheet_would_run_begins_with_an_apostrophe(text):
    assert escape_formula(text) == f"'{text}"


@pytest.mark.parametrize("value", ["-1.5", "-0.2 (-0.4 – 0.1)", "+3", "-inf", "goal_reached", "", 3, -1.5, None])
def test_figures_and_plain_texts_stay_as_they_are(value):
    assert escape_formula(value) == value


@pytest.mark.parametrize(
    "text", ["a\r=1+1", "a\n=1+1", "\r", "a\x85b", "a\u2028=1", "a\0b", 'a"\r\n,b', "\uff1d1+1", "a\x1b[31m"]
)
def test_a_text_with_control_characters_is_one_cell_for_every_reader(tmp_path, text):
    (tmp_path / "a.csv").write_text(csv_text([["name", "x"], [text, 1.5]]), newline="")
    columns, rows = read_table(tmp_path / "a.csv", "a table")
    assert (columns, len(rows), rows[0]["x"]) == (["name", "x"], 1, "1.5")
    written = (tmp_path / "a.csv").read_text()
    assert written.count("\n") == len(written.splitlines()) == 2
    assert not re.search(r"(^|[\n,\"])[=\uff1d]", written)


def test_cells_that_are_not_defined_are_empty():
    assert csv_text([["a", "b", "c"], [math.nan, None, 0.1]]) == "a,b,c\n,,0.1\n"


def test_every_table_is_written_by_one_writer():
    """A table of its own has forgotten what the one writer knows."""
    root = Path(__file__).parents[1]
    sources = [*root.glob("arena_core/**/*.py"), *root.glob("plugins/*/src/**/*.py")]
    assert [path.name for path in sources if WRITERS.search(path.read_text())] == ["cells.py"]


@pytest.mark.parametrize("name", [".hydra", "live", "worlds", "records"])
def test_a_run_writes_through_no_link_out_of_its_folder(tmp_path, name):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / name).symlink_to(tmp_path / "elsewhere")
    words = [
        "planner=pure_pursuit",
        "robot=jackal",
        "world=empty",
        "world.width=6",
        "world.height=6",
        "task.pedestrians=0",
    ]
    with suppress(ArenaError):
        run([*words, "recording.live=true", "episodes=1", "executor=serial", "report=false"], tmp_path / "run")
    assert not list((tmp_path / "elsewhere").iterdir())


def test_room_is_kept_beside_a_link_and_not_through_it(tmp_path):
    (tmp_path / "precious").write_text("precious")
    (tmp_path / ".room.00000000").symlink_to(tmp_path / "precious")
    keep_room(tmp_path, 100)
    assert (tmp_path / "precious").read_text() == "precious"


def test_a_record_that_is_a_link_out_of_its_run_is_not_read_and_none_is_written_through_one(tmp_path):
    write_record(tmp_path / "other", 0, record())
    (tmp_path / "run" / "records").mkdir(parents=True)
    (tmp_path / "run" / "records" / "0000.npz").symlink_to(tmp_path / "other" / "records" / "0000.npz")
    assert "leads out of" in refused(read_record, tmp_path / "run" / "records" / "0000.npz")
    (tmp_path / "linked").mkdir()
    (tmp_path / "linked" / "records").symlink_to(tmp_path / "other" / "records")
    with pytest.raises(InputFileError, match="leads out of"):
        write_record(tmp_path / "linked", 1, record())
    assert [path.name for path in (tmp_path / "other" / "records").iterdir()] == ["0000.npz"]
    with pytest.raises(InputFileError, match="leads out of"):
        check_inside(tmp_path / "run", tmp_path / "run" / ".." / "other")


@pytest.mark.parametrize("grid", ["/etc/passwd", "../../x.npz", "worlds/../../x.npz", "", None, "a\\b", "a\0b"])
def test_a_record_whose_map_lies_outside_its_run_is_refused(tmp_path, grid):
    good = record()
    write_record(tmp_path, 0, type(good)(good.arrays, {**good.meta, "world": {"grid": grid}}, good.timing))
    assert "world.grid lies outside" in refused(read_record, tmp_path / "records" / "0000.npz")


@pytest.mark.parametrize(
    "change",
    [
        {"pose": np.zeros((3, 3))},
        {"stamp": np.array(["a"] * 31)},
        {"contact_kind": np.array([7])},
        {"path_offsets": np.array([0, 9])},
    ],
)
def test_a_record_with_arrays_of_another_extent_or_kind_is_refused(tmp_path, change):
    good = record()
    write_record(tmp_path, 0, type(good)({**good.arrays, **change}, good.meta, good.timing))
    assert "no record (" in refused(read_record, tmp_path / "records" / "0000.npz")


BASE = ("planner=pure_pursuit", "robot=jackal", "world=empty", "executor=serial", "report=false", "hydra.run.dir=run")


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("robot.lidar.beams=1000000000", "robot.lidar.beams is 1000000000; allowed: >= 1 and <= 10000"),
        ("episodes=99999999999999999999", "episodes is 99999999999999999999; allowed: "),
        ("episodes=100001", "episodes is 100001; allowed: >= 1 and <= 100000"),
        ("executor=processes", "executor.workers is 100000; allowed: >= 1 and <= 1024"),
        ("simulator.inner_step=1e-12", "simulator.inner_step is 1e-12; allowed: 0.0001 .. 10"),
        ("robot.limits.vx_max=inf", "robot.limits.vx_max is inf; allowed: a number up to 1e+06, of either sign"),
        ("task.time_limit=1e308", "task.time_limit is 1e+308; allowed: a number up to 1e+06"),
        ("task.people.radius=inf", "task.people.radius is inf; allowed: a number up to 1e+06"),
        ("timing.latency=1e308", "timing.latency is 1e+308; allowed: a number up to 1e+06"),
        ("replan.period=1e-300", "replan.period is 1e-300; allowed: > 0, and 1e-09 at least"),
        ("+planner.control_period=inf", "planner.control_period is inf; allowed: a number up to 1e+06"),
        ("+x.y.z=1", "the configuration has a key x that nothing reads (possible: robot, "),
        (
            f"hydra.run.dir={'/'.join(['a'] * 2000)}",
            "hydra.run.dir has 2000 parts; allowed: up to 64 folders inside each other",
        ),
    ],
)
def test_nonsense_in_a_configuration_is_one_line_and_status_2(arena, word, message):
    answer = arena(
        "run", *BASE, *(["executor=processes", "executor.workers=100000"] if word.startswith("executor=") else [word])
    )
    assert answer.status == 2
    assert answer.line.startswith(f"arena: {message}")


def test_a_folder_with_a_name_that_none_can_have_is_one_line(arena):
    answer = arena("evaluate", "a" * 2000)
    assert answer.status == 2
    assert "cannot be read" in answer.line


def test_what_is_served_is_read_within_its_folder_links_followed_and_nothing_else(tmp_path):
    inside, outside = tmp_path / "inside", tmp_path / "outside"
    inside.mkdir()
    outside.mkdir()
    for folder in (inside, outside):
        (folder / "a.json").write_text("1")
    (inside / "b.json").symlink_to(inside / "a.json")
    (inside / "c.json").symlink_to(outside / "a.json")
    (inside / "d").symlink_to(outside)
    installed = Path(arena_core.__file__)
    with reading_within(inside):
        assert [read_json(inside / name, "x") for name in ("a.json", "b.json")] == [1, 1]
        assert read_bytes(installed, 10**6, "x")
        for path in (
            outside / "a.json",
            inside / "c.json",
            inside / "d" / "a.json",
            inside / ".." / "outside" / "a.json",
        ):
            assert not is_file(path)
            with pytest.raises(InputFileError, match="allowed: a file in it"):
                read_json(path, "x")
        with reading_within(outside):
            assert is_file(outside / "a.json")
            assert not is_file(inside / "a.json")
    assert read_json(inside / "c.json", "x") == 1


def far(name, place, value):
    """Return a change of a record: one number of an array put elsewhere."""

    def change(good):
        array = good.arrays[name].astype(np.float64)
        array[place] = value
        return type(good)({**good.arrays, name: array}, good.meta, good.timing)

    return change


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (far("pose", (5, 0), 6e6), "pose covers 1.2e+07 m"),
        (far("pose", (5, 1), np.inf), "pose is not finite"),
        (far("pose", (5, 2), np.nan), "pose is not finite"),
        (far("pose", (slice(None), 0), 1e8), "pose goes beyond 1e+07"),
        (far("stamp", slice(7, None), 1e8), "stamp goes from 0 to 1e+08 s"),
        (far("stamp", -1, np.inf), "stamp is not finite and rising"),
        (far("stamp", 3, np.nan), "stamp is not finite and rising"),
        (far("stamp", 3, -5.0), "stamp is not finite and rising"),
        (far("stamp", slice(None), np.arange(31) * 0.1 + 1e300), "stamp goes from 1e+300"),
        (far("path_poses", (0, 0), np.inf), "path_poses goes beyond"),
        (far("path_stamps", 0, np.inf), "path_stamps goes beyond"),
        (far("pedestrian_positions", (0, 0, 0), 1e30), "pedestrian_positions goes beyond"),
    ],
)
def test_a_record_with_numbers_far_off_is_refused_before_anything_is_computed_of_it(tmp_path, change, fault):
    changed = change(record(contact=True))
    write_record(tmp_path, 0, changed)
    assert fault in refused(read_record, tmp_path / "records" / "0000.npz")
    with pytest.raises(InputFileError, match="numbers that are too far off"):
        evaluate_record(changed, {})


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("pedestrian_radii", (9,)),
        ("pedestrian_velocities", (31, 9, 2)),
        ("pedestrian_states", (31, 9)),
        ("contact_person", (9,)),
        ("scan_ranges", (3, 5)),
    ],
)
def test_a_record_with_arrays_of_unequal_lengths_is_refused(tmp_path, name, shape):
    good = record(contact=True)
    kind = good.arrays[name].dtype if name in good.arrays else np.float32
    write_record(tmp_path, 0, type(good)({**good.arrays, name: np.zeros(shape, kind)}, good.meta, good.timing))
    assert f"no record ({name} is" in refused(read_record, tmp_path / "records" / "0000.npz")


@pytest.mark.parametrize("number", [1e300, -1e8, 10**400])
@pytest.mark.parametrize("place", ["start", "goal_radius", "event"])
def test_a_record_whose_meta_has_numbers_far_off_is_refused(tmp_path, place, number):
    good = record()
    scenario, events = dict(good.meta["scenario"]), list(good.meta["events"])
    if place == "event":
        events.append({"stamp": number, "kind": "replan", "detail": ""})
    else:
        scenario[place] = [number, 0.0, 0.0] if place == "start" else number
    write_record(
        tmp_path, 0, type(good)(good.arrays, {**good.meta, "scenario": scenario, "events": events}, good.timing)
    )
    assert "no record (meta" in refused(read_record, tmp_path / "records" / "0000.npz")


@pytest.mark.parametrize(
    "content", [{"resolution": np.inf}, {"origin": np.array([1e300, 0.0, 0.0])}, {"origin": np.full(3, np.nan)}]
)
def test_a_map_of_a_run_that_lies_far_off_is_refused(tmp_path, content):
    (tmp_path / "worlds").mkdir()
    good = {"data": np.zeros((3, 3), np.int8), "resolution": np.array(0.1), "origin": np.zeros(3)}
    np.savez(tmp_path / "worlds" / "a.npz", **{**good, **{name: np.asarray(value) for name, value in content.items()}})
    with pytest.raises(InputFileError, match="arrays are not those of a map"):
        read_grid(tmp_path / "worlds" / "a.npz")
