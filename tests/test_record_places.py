"""Records of the first thousand episodes lie beside each other, later ones by the thousand;
whoever reads a run finds all.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena_core.loop.half_written import remove_half_written
from arena_core.loop.record_files import write_record
from arena_core.loop.record_places import run_folder_of, timing_of, timing_path
from arena_core.records import read_record, record_path, record_paths, timing_paths
from arena_core.runs.workers.nodes import NAMES
from arena_core.testing.samples import record as sample_record

FOLDER = Path("outputs", "001", "7")


@pytest.mark.parametrize(
    ("episode", "place"),
    [(0, "0000.npz"), (999, "0999.npz"), (1000, "001/1000.npz"), (12_345, "012/12345.npz"), (99_999, "099/99999.npz")],
)
def test_place_of_a_record(episode, place):
    assert record_path(FOLDER, episode) == FOLDER / "records" / place


@given(st.integers(0, 99_999))
def test_run_and_times_are_found_from_a_record(episode):
    record = record_path(FOLDER, episode)
    assert run_folder_of(record) == FOLDER
    assert timing_of(record) == timing_path(FOLDER, episode)
    assert NAMES.fullmatch(record.relative_to(FOLDER).as_posix())


def test_records_of_all_folders_are_found_in_order_and_read_with_their_times(tmp_path):
    record = sample_record()
    for episode in (10_000, 3, 1000, 999):
        write_record(tmp_path, episode, record)
    assert [int(path.stem) for path in record_paths(tmp_path)] == [3, 999, 1000, 10_000]
    assert [int(path.stem) for path in timing_paths(tmp_path)] == [3, 999, 1000, 10_000]
    assert all(read_record(path).timing.keys() == record.timing.keys() for path in record_paths(tmp_path))


def test_half_written_files_go_from_all_folders(tmp_path):
    write_record(tmp_path, 1000, sample_record())
    left = record_path(tmp_path, 1001).with_name(".1001.npz.0123abcd")
    left.touch()
    remove_half_written(tmp_path)
    assert not left.exists()
    assert record_path(tmp_path, 1000).exists()
