"""What benchmarks/compare_records.py calls equal, and what it says of a difference."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from arena_core.testing import samples


@pytest.fixture(scope="module")
def comparison():
    spec = importlib.util.spec_from_file_location(
        "compare_records", Path(__file__).parents[1] / "benchmarks" / "compare_records.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def content(**changes):
    record = samples.record()
    return {**record.arrays, "meta": json.loads(json.dumps(record.meta)), **changes}


def changed(name, index, value):
    array = content()[name].copy()
    array[index] = value
    return content(**{name: array})


def test_a_record_equals_itself_not_a_number_included(comparison):
    assert np.isnan(content()["scan_min"]).any()
    assert comparison.compare_records(content(), content()) == ""


def test_first_different_element_is_named(comparison):
    said = comparison.compare_records(content(), changed("pose", (3, 1), 1e-17))
    assert said == "pose: [3, 1] is np.float64(0.0), then np.float64(1e-17)"
    assert "-0.0" in comparison.compare_records(content(), changed("pose", (3, 1), -0.0))


def test_arrays_of_another_type_or_extent_or_missing_differ(comparison):
    pose = content()["pose"]
    assert "float32" in comparison.compare_records(content(), content(pose=pose.astype(np.float32)))
    assert "(30, 3)" in comparison.compare_records(content(), content(pose=pose[:-1]))
    assert comparison.compare_records(content(), content(more=pose)) == "more: only after"


def test_code_may_differ_and_so_may_what_is_excepted(comparison):
    meta = content()["meta"]
    other = content(
        meta={**meta, "config": {"seed": 1}, "columns": {**meta["columns"], "code": "abc", "config_hash": "def"}}
    )
    assert comparison.compare_records(content(), other) == "meta.config.seed: None, then 1"
    assert comparison.compare_records(content(), other, ["config"]) == ""


def test_episodes_that_broke_are_no_proof(comparison):
    broken = content(meta={**content()["meta"], "outcome": "error", "error": "no solver"})
    assert comparison.compare_records(broken, broken) == "both broke: no solver"


def test_folders_without_records_or_with_others_differ(comparison, tmp_path):
    for folder in ("empty", "one", "two"):
        (tmp_path / folder / "records").mkdir(parents=True)
    for path in ("one/records/0000.npz", "two/records/0001.npz"):
        np.savez(tmp_path / path, stamp=np.zeros(2))
    assert comparison.compare_runs(tmp_path / "empty", tmp_path / "empty") == (0, "neither has a record")
    assert comparison.compare_runs(tmp_path / "one", tmp_path / "two") == (
        0,
        "records: ['records/0000.npz'], then ['records/0001.npz']",
    )
    assert comparison.compare_runs(tmp_path / "one", tmp_path / "one") == (1, "")
