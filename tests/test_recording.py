import errno
import json
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from arena_core import ABSENT, EpisodeRecord, InputFileError, OccupancyGrid, PedestrianSpec, Pose
from arena_core.base.stopwatch import Duration
from arena_core.base.whole_files import write_bytes_whole, write_text_whole, write_whole
from arena_core.config.configuration import compose, to_plain
from arena_core.config.registry import load_registry
from arena_core.hosting import RunFolderError
from arena_core.loop import grain
from arena_core.loop.navigator import NO_TIME, Decision, Spent
from arena_core.loop.record_arrays import route_arrays, timing_arrays, whole_timing
from arena_core.loop.record_files import FORMAT, read_record, write_grid, write_record
from arena_core.loop.record_layout import EXTRAS
from arena_core.loop.record_places import find_runs
from arena_core.loop.recording import Recorder, RecordingSettings
from arena_core.records import record_digest
from arena_core.runs.jobs.benchmark import build_benchmark
from arena_core.runs.jobs.rows import evaluate_file, evaluate_record
from arena_core.testing import record, robot, room, scenario, sensors


def files(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_times_of_steps_that_waited_for_a_compiler_are_none():
    quick = Decision(None, None, None, None, False, (), Spent(0.01, 0.01, 0.02))
    waited = replace(quick, spent=Spent(3.0, 3.0, 4.0), compiled=True)
    seconds = timing_arrays([quick, waited, quick])["planner_seconds"]
    assert np.isnan(seconds).tolist() == [False, True, False]
    assert np.isnan(whole_timing(Duration(9.0, 9.0), compiled=True)["episode_cpu_seconds"]).all()


def test_a_record_is_read_back_as_it_was_written(tmp_path):
    written = record(contact=True)
    write_record(tmp_path, 7, written)
    read = read_record(tmp_path / "records" / "0007.npz")
    assert set(read.arrays) == set(written.arrays)
    for name, array in written.arrays.items():
        assert np.array_equal(read[name], array, equal_nan=array.dtype.kind == "f")
        assert read[name].dtype == array.dtype
    assert read.meta == json.loads(json.dumps(written.meta))
    assert read.timing["planner_seconds"].tolist() == written.timing["planner_seconds"].tolist()


@given(
    floats=arrays(np.float64, array_shapes(max_dims=2, max_side=5)),
    text=st.text(max_size=20),
)
def test_any_array_and_any_text_survive(tmp_path_factory, floats, text):
    folder = tmp_path_factory.mktemp("run")
    sample = record(steps=2)
    write_record(folder, 0, EpisodeRecord({**sample.arrays, "x": floats}, {**sample.meta, "text": text}))
    read = read_record(folder / "records" / "0000.npz")
    assert np.array_equal(read["x"], floats, equal_nan=True)
    assert read.meta["text"] == text


@given(arrays(np.float64, (4, 3), elements=st.floats(-100.0, 100.0) | st.sampled_from((np.nan, np.inf, -np.inf))))
def test_records_are_rounded_to_their_grain_once_and_for_all(values):
    once = grain.round_arrays(
        {
            name: values.astype(kind)
            for name, kind in (("pose", float), ("pedestrian_positions", np.float32), ("x", float))
        }
    )
    assert np.array_equal(once["x"], values, equal_nan=True)
    finite = np.isfinite(values)
    for name, array in once.items():
        assert array.dtype == (np.float32 if name == "pedestrian_positions" else np.float64)
        assert np.array_equal(array[~finite], values[~finite], equal_nan=True)
    assert np.abs(once["pose"][finite] - values[finite]).max(initial=0.0) <= 2.0**-23
    assert np.abs(once["pedestrian_positions"][finite] - values.astype(np.float32)[finite]).max(initial=0.0) <= 2.0**-13
    again = grain.round_arrays(once)
    assert all(np.array_equal(again[name], once[name], equal_nan=True) for name in once)


def test_every_step_has_its_row_and_the_last_row_is_the_final_state():
    steps = record(steps=31)
    rows = {
        name: len(array)
        for name, array in steps.arrays.items()
        if not name.startswith(("contact_", "path_", "pedestrian_", "route_"))
    }
    assert set(rows.values()) == {31}
    assert len(steps["pedestrian_positions"]) == 31
    assert steps["stamp"][-1] == pytest.approx(3.0)
    assert np.isnan(steps["command"][-1]).all()


def test_contacts_paths_and_events_are_kept(tmp_path):
    steps = record(contact=True)
    assert (steps["contact_stamp"].tolist(), steps["contact_kind"].tolist(), steps["contact_person"].tolist()) == (
        [1.5],
        [2],
        [1],
    )
    assert steps["path_offsets"].tolist() == [0, len(steps["path_poses"])]
    assert steps["path_stamps"].tolist() == [0.0]
    assert steps.meta["events"] == [{"stamp": 0.0, "kind": "replan", "detail": "start"}]


def test_where_people_were_going_is_kept_and_no_part_of_the_digest(tmp_path):
    person = PedestrianSpec(3, np.zeros(2), np.array([[1.0, 2.0], [3.0, 4.0]]), 1.0, 0.3)
    arrays = route_arrays(np.array([7, 3, 8], np.int32), [person])
    assert (arrays["route_points"].tolist(), arrays["route_offsets"].tolist()) == (
        [[1.0, 2.0], [3.0, 4.0]],
        [0, 0, 2, 2],
    )
    steps = record()
    older = EpisodeRecord(
        {name: array for name, array in steps.arrays.items() if not name.startswith("route_")}, steps.meta, {}
    )
    assert older.arrays.keys() < steps.arrays.keys()
    assert record_digest(older) == record_digest(steps)
    write_record(tmp_path, 0, older)
    assert set(read_record(tmp_path / "records" / "0000.npz").arrays) == set(older.arrays)


@pytest.mark.parametrize(
    "wrong",
    [{"route_offsets": np.array([0, 0])}, {"route_points": np.zeros((1, 3))}, {"route_offsets": np.array([0, 0, 0])}],
)
def test_routes_that_are_not_those_of_the_people_are_no_record(tmp_path, wrong):
    steps = record()
    arrays = {**steps.arrays, "route_points": np.zeros((1, 2)), "route_offsets": np.array([0, 1]), **wrong}
    write_record(tmp_path, 0, EpisodeRecord(arrays, steps.meta, {}))
    with pytest.raises(InputFileError, match="no record"):
        read_record(tmp_path / "records" / "0000.npz")


def test_who_leaves_keeps_the_column_and_is_nowhere():
    steps = record(steps=31, leaves=True)
    assert steps["pedestrian_ids"].tolist() == [1]
    gone = np.arange(31) > 15
    for name in ("pedestrian_positions", "pedestrian_velocities"):
        assert np.isnan(steps[name][:, 0]).all(axis=1).tolist() == gone.tolist()
    assert (steps["pedestrian_states"][:, 0] == ABSENT).tolist() == gone.tolist()
    assert np.isinf(steps["clearance_people"]).tolist() == gone.tolist()


def test_scans_are_kept_only_when_asked_for():
    decision = Decision(None, None, None, None, False, (), NO_TIME)
    view = sensors(Pose(0.0, 0.0), robot())
    for keep in (False, True):
        recorder = Recorder(scenario(), robot(), {}, RecordingSettings(scans=keep))
        recorder.sense(None, view)
        recorder.add(decision)
        assert len(recorder._scans) == keep


def test_the_same_record_is_written_as_the_same_bytes(tmp_path):
    for folder in ("one", "other"):
        write_record(tmp_path / folder, 0, record())
    one, other = ((tmp_path / folder / "records" / "0000.npz").read_bytes() for folder in ("one", "other"))
    assert one == other


def test_rounded_arrays_are_off_by_half_a_step_at_most_and_exact_multiples():
    values = np.array([[0.1, -123.456789], [np.nan, np.inf], [-1e-9, 4000.0001]])
    for kind, step in ((np.float64, 22), (np.float32, 12)):
        given = values.astype(kind)
        rounded = grain.to_grain(given, step)
        finite = np.isfinite(given)
        assert rounded.dtype == kind
        assert np.array_equal(rounded[~finite], given[~finite], equal_nan=True)
        assert np.abs(rounded[finite] - given[finite]).max() <= 2.0 ** -(step + 1)
        assert (rounded[finite] * 2.0**step % 1.0 == 0.0).all()
        assert not np.signbit(rounded[2, 0])
        assert np.array_equal(grain.to_grain(rounded, step), rounded, equal_nan=True)


def test_steps_are_those_of_arrays_and_of_the_page():
    made = record()
    usual = {name: step for name, step in grain.GRAIN.items() if name not in EXTRAS}
    assert usual.keys() <= made.arrays.keys()
    for name, step in usual.items():
        kept = made[name][np.isfinite(made[name])].astype(np.float64)
        assert (kept * 2.0**step % 1.0 == 0.0).all(), name
    page = (Path(__file__).parents[1] / "docs" / "records.md").read_text()
    powers = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
    for name, step in {**grain.GRAIN, "timing/": grain.TIME_GRAIN}.items():
        assert any(f"`{name}`" in line and f"2⁻{str(step).translate(powers)} " in line for line in page.splitlines()), (
            name
        )


def test_numpy_alone_reads_a_record_and_rows_come_back_as_they_lay(tmp_path):
    made = record()
    write_record(tmp_path, 0, made)
    path = tmp_path / "records" / "0000.npz"
    with np.load(path, allow_pickle=False) as file:
        assert json.loads(str(file["meta"])) == json.loads(json.dumps(made.meta))
        assert np.array_equal(file["pose"], made["pose"])
    assert all(array.flags.c_contiguous for array in read_record(path).arrays.values())


def test_every_metric_of_the_file_equals_that_of_the_run(tmp_path):
    words = [
        "planner=pure_pursuit",
        "robot=jackal",
        "world=indoor",
        "task.pedestrians=5",
        "task.time_limit=15",
        "metrics=[si,paper_legacy]",
    ]
    benchmark = build_benchmark(to_plain(compose(words)), load_registry())
    driven = benchmark.run(0, tmp_path)
    write_record(tmp_path, 0, driven)
    of_run, of_file = (
        evaluate_record(driven, benchmark.metrics),
        evaluate_file(tmp_path / "records" / "0000.npz", benchmark.metrics),
    )
    assert len(driven["stamp"]) > 30
    assert {name: repr(value) for name, value in of_file.items()} == {
        name: repr(value) for name, value in of_run.items()
    }


def test_a_long_crowded_record_is_small(tmp_path):
    made, rng = record(steps=900), np.random.default_rng(0)
    velocities = np.cumsum(rng.normal(0.0, 0.03, (900, 10, 2)), axis=0)
    people = {"pedestrian_positions": np.cumsum(0.1 * velocities, axis=0), "pedestrian_velocities": velocities}
    rounded = {name: grain.to_grain(array.astype(np.float32), grain.GRAIN[name]) for name, array in people.items()}
    write_record(tmp_path, 0, EpisodeRecord({**made.arrays, **rounded}, made.meta))
    assert (tmp_path / "records" / "0000.npz").stat().st_size < 150_000


def test_wall_times_are_in_a_file_of_their_own(tmp_path):
    write_record(tmp_path, 0, record())
    assert files(tmp_path) == ["records/0000.npz", "timing/0000.npz"]
    (tmp_path / "timing" / "0000.npz").unlink()
    assert read_record(tmp_path / "records" / "0000.npz").timing == {}


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "damaged"),
        (b"no npz at all", "damaged"),
        (b"PK\x03\x04 cut off", "damaged"),
        (None, "cannot be read"),
    ],
)
def test_a_damaged_record_is_named(tmp_path, content, reason):
    path = tmp_path / "0000.npz"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputFileError, match=f"{path}: {reason}"):
        read_record(path)


def test_a_record_that_was_cut_off_is_damaged(tmp_path):
    write_record(tmp_path, 0, record())
    path = tmp_path / "records" / "0000.npz"
    path.write_bytes(path.read_bytes()[:-1000])
    with pytest.raises(InputFileError, match="damaged"):
        read_record(path)


def test_arrays_without_meta_are_no_record(tmp_path):
    np.savez(tmp_path / "0000.npz", x=np.zeros(3))
    with pytest.raises(InputFileError, match="no record"):
        read_record(tmp_path / "0000.npz")


def test_a_record_of_another_format_says_which_is_allowed(tmp_path):
    sample = record()
    write_record(tmp_path, 0, replace(sample, meta={**sample.meta, "format": 99}))
    with pytest.raises(InputFileError, match=f"format is 99; allowed: {FORMAT}"):
        read_record(tmp_path / "records" / "0000.npz")


def test_pickles_are_never_loaded(tmp_path):
    np.savez(tmp_path / "0000.npz", meta=np.array([{"format": 1}], dtype=object))
    with pytest.raises(InputFileError, match="damaged"):
        read_record(tmp_path / "0000.npz")


def fail(number):
    def write(file):
        file.write(b"half")
        raise OSError(number, os.strerror(number))

    return write


def test_a_full_disk_leaves_the_old_file_and_no_half_written_one(tmp_path):
    write_text_whole(tmp_path / "a.txt", "old")
    with pytest.raises(RunFolderError, match=r"cannot write .*a\.txt: No space left on device"):
        write_whole(tmp_path / "a.txt", fail(errno.ENOSPC))
    assert files(tmp_path) == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


def test_a_rename_that_fails_leaves_no_half_written_file(tmp_path, monkeypatch):
    def no_rename(source, target):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(os, "replace", no_rename)
    with pytest.raises(RunFolderError, match="Read-only file system"):
        write_text_whole(tmp_path / "a.txt", "new")
    assert files(tmp_path) == []


def test_ctrl_c_while_writing_leaves_no_half_written_file(tmp_path):
    def interrupted(file):
        file.write(b"half")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_whole(tmp_path / "a.txt", interrupted)
    assert files(tmp_path) == []


def test_a_folder_below_a_file_cannot_be_written_to(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(RunFolderError, match=r"cannot write .*file/run/a\.txt: Not a directory"):
        write_text_whole(tmp_path / "file" / "run" / "a.txt", "text")


def test_a_written_file_can_be_read_by_everyone(tmp_path):
    write_text_whole(tmp_path / "a.txt", "ä")
    assert (tmp_path / "a.txt").stat().st_mode & 0o777 == 0o644
    assert (tmp_path / "a.txt").read_bytes() == "ä".encode()


def test_a_map_is_written_once_and_other_maps_beside_it(tmp_path):
    name = write_grid(tmp_path, room())
    before = (tmp_path / name).stat().st_mtime_ns
    assert write_grid(tmp_path, room()) == name
    assert (tmp_path / name).stat().st_mtime_ns == before
    moved = OccupancyGrid(room().data, room().resolution, Pose(1.0, 0.0))
    assert write_grid(tmp_path, moved) != name
    with np.load(tmp_path / name) as content:
        assert (content["data"] == room().data).all()
        assert float(content["resolution"]) == room().resolution
        assert content["origin"].tolist() == [-5.0, -5.0, 0.0]


def test_runs_are_found_at_and_below_a_folder(tmp_path):
    for name in ("b", "a/0", "a/1"):
        write_text_whole(tmp_path / name / "episodes.csv", "")
    assert [str(path.relative_to(tmp_path)) for path in find_runs(tmp_path)] == ["a/0", "a/1", "b"]
    assert find_runs(tmp_path / "b") == [tmp_path / "b"]


@pytest.mark.parametrize("name", ["", "nowhere"])
def test_a_folder_without_a_run_says_what_is_allowed(tmp_path, name):
    with pytest.raises(InputFileError, match="allowed: a folder that `arena run` wrote, or one above it"):
        find_runs(tmp_path / name)


def test_ctrl_c_right_after_a_file_was_made_leaves_nothing_behind(tmp_path, monkeypatch):
    really_open = Path.open

    def open_and_be_interrupted(self, *arguments):
        really_open(self, *arguments).close()
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "open", open_and_be_interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_bytes_whole(tmp_path / "table.csv", b"1")
    assert list(tmp_path.iterdir()) == []
