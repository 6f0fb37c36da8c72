"""``reference=clairvoyant`` in a run: what `arena reference` finds out, once the episodes have ended."""

from __future__ import annotations

from pathlib import Path

import pytest

from arena_core import ConfigurationError, Runs, run
from arena_core.hosting import UnknownComponent
from arena_core.records import read_findings, read_record, record_digest, record_path, record_paths

ROOM = [
    "robot=jackal",
    "world=empty",
    "world.width=8",
    "world.height=6",
    "task.pedestrians=4",
    "localizer=ground_truth",
]
FEW = ["localizer=ground_truth", "episodes=1", "seed=3", "executor=serial", "report=false"]
WORDS = ["planner=pure_pursuit", "planner.speed=1.0,1.9", *ROOM, *FEW]


@pytest.fixture(scope="module")
def referenced(tmp_path_factory) -> Runs:
    """Return two runs on the same problem, with a reference."""
    return run([*WORDS, "reference=clairvoyant"], tmp_path_factory.mktemp("referenced") / "runs")


def kinds(folder: Path) -> list[str]:
    return [found.kind for found in read_findings(folder)]


def certificate(folder: Path) -> Path:
    return record_path(folder / "reference", 0)


def test_a_run_with_a_reference_has_its_findings_and_shares_certificates(referenced: Runs) -> None:
    assert [kinds(one.folder) for one in referenced] == [["reference"], ["reference"]]
    first, second = (certificate(one.folder).read_bytes() for one in referenced)
    assert first == second
    assert len({read_findings(one.folder)[0].rows[0]["problem"] for one in referenced}) == 1


def test_a_reference_changes_no_record_and_no_cell(referenced: Runs, tmp_path: Path) -> None:
    alone = run(WORDS, tmp_path / "runs")
    for one, other in zip(referenced, alone, strict=True):
        assert record_digest(one.record(0)) == record_digest(other.record(0))
        assert one.provenance["config_hash"] == other.provenance["config_hash"]
        assert one.provenance["code"] == other.provenance["code"]
        assert kinds(other.folder) == []
        assert not (other.folder / "reference").exists()


def test_a_run_that_is_resumed_gets_its_reference_and_keeps_what_is_certified(tmp_path: Path) -> None:
    words = ["planner=pure_pursuit", *ROOM, *FEW]
    (alone,) = run(words, tmp_path / "run")
    assert kinds(alone.folder) == []
    asked = [*words, "resume=true", "reference=clairvoyant"]
    run(asked, tmp_path / "run")
    assert kinds(alone.folder) == ["reference"]
    before = certificate(alone.folder).stat().st_mtime_ns
    run([*asked, "episodes=2"], tmp_path / "run")
    assert certificate(alone.folder).stat().st_mtime_ns == before
    assert len(record_paths(alone.folder / "reference")) == 2
    assert sorted(read_findings(alone.folder)[0].rows) == [0, 1]


def test_runs_of_a_multirun_choose_their_reference_one_by_one(tmp_path: Path) -> None:
    runs = run(["planner=pure_pursuit", "reference=none,clairvoyant", *ROOM, *FEW], tmp_path / "runs")
    assert [kinds(one.folder) for one in runs] == [[], ["reference"]]


def test_a_reference_that_is_not_there_or_takes_no_such_key_is_refused(tmp_path: Path) -> None:
    with pytest.raises((ConfigurationError, UnknownComponent), match=r"unknown reference 'clair'.*clairvoyant, none"):
        run([*WORDS, "reference=clair"], tmp_path / "run")
    with pytest.raises(ConfigurationError, match="reference has no key cell"):
        run([*WORDS, "reference=clairvoyant", "reference.cell=1"], tmp_path / "run")
    with pytest.raises(ConfigurationError, match=r"reference.* cell"):
        run([*WORDS, "reference=clairvoyant", "+reference.cell=1"], tmp_path / "run")


def test_certificates_in_a_run_are_records_of_the_clairvoyant(referenced: Runs) -> None:
    record = read_record(certificate(referenced[0].folder))
    assert record.meta["columns"]["planner"] == "clairvoyant"
