"""A true pack is verified bit for bit, by outcome where that cannot be, and a false one is found out."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np

from arena_core.hosting import load_registry
from arena_core.records import read_record
from arena_submit.commands import SubmitCommand, VerifyCommand
from arena_submit.packing import read_pack, write_pack
from arena_submit.verification import sample_episodes, verify_pack

SERIAL = {"name": "serial"}


def verified(path, sample=2, seed=1):
    with read_pack(path) as pack:
        return verify_pack(pack, sample, seed, SERIAL, load_registry())


def packed_again(folder, tmp_path):
    write_pack([folder], tmp_path / "spoilt.zip")
    return tmp_path / "spoilt.zip"


def rewrite(folder, change):
    """Rewrite the table's rows with what ``change`` makes of each."""
    with (folder / "episodes.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    with (folder / "episodes.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows([change(row) for row in rows])


def test_a_pack_is_verified_bit_for_bit_where_it_was_made(packed):
    found = verified(packed)
    assert found.is_valid
    assert not found.elsewhere
    assert [one.same for one in found.repeated] == [True, True]
    assert (found.rows, list(found.wrong_rows)) == (3, [])


def test_the_sample_follows_from_the_seed_and_is_all_where_there_is_not_more(packed):
    with read_pack(packed) as pack:
        drawn = [
            [one.row["episode"] for one in sample_episodes(pack, size, seed)] for size, seed in ((2, 1), (2, 1), (9, 1))
        ]
        others = {tuple(one.row["episode"] for one in sample_episodes(pack, 1, seed)) for seed in range(20)}
    assert drawn[0] == drawn[1]
    assert drawn[2] == ["0", "1", "2"]
    assert len(others) == 3


def test_a_row_that_is_not_its_records_is_found(copied, tmp_path):
    rewrite(copied, lambda row: {**row, "collisions": "7.0"} if row["episode"] == "1" else row)
    found = verified(packed_again(copied, tmp_path))
    assert list(found.wrong_rows) == ["runs/0 episode 1: collisions is not that of the record"]
    assert not found.is_valid


def test_a_row_without_its_record_is_found(copied, tmp_path):
    (copied / "records" / "0002.npz").unlink()
    assert list(verified(packed_again(copied, tmp_path)).wrong_rows) == ["runs/0 episode 2 has no record"]


def spoil_records(folder):
    """Move the robot by a millimetre in every record."""
    for path in (folder / "records").glob("*.npz"):
        with np.load(path) as file:
            arrays = dict(file)
        arrays["pose"] = arrays["pose"] + np.array([0.001, 0.0, 0.0])
        np.savez_compressed(path, **arrays)


def test_a_record_that_nobody_drove_is_found(copied, tmp_path):
    spoil_records(copied)
    found = verified(packed_again(copied, tmp_path))
    assert [one.same for one in found.repeated] == [False, False]
    assert not found.is_valid


def test_other_versions_are_verified_by_outcome(copied, tmp_path):
    spoil_records(copied)
    facts = json.loads((copied / "provenance.json").read_text())
    facts["versions"]["numba"] = "0.1"
    facts["machine"]["cpu"] = "another"
    (copied / "provenance.json").write_text(json.dumps(facts))
    found = verified(packed_again(copied, tmp_path), sample=3)
    assert [line.split()[0] for line in found.elsewhere] == ["numba", "processor"]
    assert found.required_count == 3
    assert [one.agrees for one in found.repeated] == [True] * 3
    assert not any(one.same for one in found.repeated)


def test_a_planner_that_is_not_installed_cannot_be_driven(copied, tmp_path):
    facts = json.loads((copied / "provenance.json").read_text())
    facts["config"]["planner"]["name"] = "elsewhere"
    (copied / "provenance.json").write_text(json.dumps(facts))
    found = verified(packed_again(copied, tmp_path), sample=1)
    assert "cannot be driven here: UnknownComponent: unknown planner 'elsewhere'" in found.repeated[0].told
    assert not found.is_valid


def test_the_commands_pack_and_verify(finished, tmp_path, capsys):
    target = tmp_path / "pack.zip"
    assert SubmitCommand().run([str(finished), "--to", str(target)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0] == f"{target}: 3 episodes; no standing benchmark: it can be verified, not ranked"
    assert VerifyCommand().run([str(target), "sample=1", "seed=5", "executor=serial"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0] == said[1]
    assert told[1:] == [
        "rows: 3 of 3 are those of the records",
        "driven again: 1 episodes (seed=5), 1 the same bit for bit, 1 alike in success",
        "verified bit for bit",
    ]


def test_a_false_pack_has_exit_status_1(copied, tmp_path, capsys):
    rewrite(copied, lambda row: {**row, "success": "1.0", "collisions": "-1.0"})
    assert VerifyCommand().run([str(packed_again(copied, tmp_path)), "sample=1", "executor=serial"]) == 1
    assert capsys.readouterr().out.splitlines()[-1] == "not verified bit for bit"


def test_verification_leaves_nothing_behind(packed, tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    Path(tmp_path / "temporary").mkdir()
    monkeypatch.setattr("tempfile.tempdir", None)
    verified(packed, sample=1)
    assert list(Path(tmp_path / "temporary").iterdir()) == []


def test_records_that_were_copied_are_read_as_they_were(finished, tmp_path):
    shutil.copytree(finished / "records", tmp_path / "records")
    assert read_record(tmp_path / "records" / "0000.npz").meta == read_record(finished / "records" / "0000.npz").meta
