"""``arena reference`` and ``arena explain`` on runs that are really driven."""

from __future__ import annotations

import csv
import json
import shutil
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arena_core import ArenaError, ConfigurationError, Run, Runs, run
from arena_core.cli.main import main
from arena_core.hosting import load_registry
from arena_core.records import is_success, read_findings, read_record, record_path
from arena_reference.certifying import check_driven, episodes_of, place_known, reference_runs
from arena_reference.command import ReferenceCommand
from arena_reference.explain_command import ExplainCommand

WORDS = [
    "robot=jackal",
    "world=empty",
    "world.width=9",
    "world.height=7",
    "task.pedestrians=6",
]
FEW = ["episodes=2", "seed=3", "executor=serial", "report=false", "localizer=ground_truth"]


@pytest.fixture(scope="module")
def driven(tmp_path_factory) -> Path:
    """Return the folder of runs of two blind planners on the same two problems."""
    folder = tmp_path_factory.mktemp("blind") / "runs"
    run(["planner=pure_pursuit", "planner.speed=1.0,1.9", *WORDS, *FEW], folder)
    return folder


@pytest.fixture(scope="module")
def referenced(driven: Path) -> Path:
    """Return it with a reference."""
    assert ReferenceCommand().run([str(driven), "executor=serial"]) == 0
    return driven


def found_about(one: Run) -> Mapping[int, Mapping[str, float | str]]:
    """Return what the reference found out about a run."""
    return next(kind.rows for kind in read_findings(one.folder) if kind.kind == "reference")


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def test_certificates_are_strict_successes_no_sooner_than_the_bound(referenced: Path) -> None:
    for one in Runs.below(referenced):
        for episode, row in found_about(one).items():
            certificate = read_record(record_path(one.folder / "reference", episode))
            assert row["solvable"] == "yes"
            assert is_success(certificate, collisions_allowed=0)
            assert row["time_lower"] <= row["time_certified"] == certificate["stamp"][-1]
            assert "planner clairvoyant" in certificate.meta["columns"]["privileged"]


def test_planners_that_face_the_same_problem_share_its_certificate(referenced: Path) -> None:
    one, other = (found_about(each) for each in Runs.below(referenced))
    assert [row["problem"] for row in one.values()] == [row["problem"] for row in other.values()]
    assert len({row["problem"] for row in one.values()}) == 2


def test_what_is_certified_is_not_driven_again(referenced: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runs = list(Runs.below(referenced))
    before = {
        one.certificate: one.certificate.stat().st_mtime_ns
        for each in runs
        for one in episodes_of(each, load_registry())
    }
    reference_runs(runs, {"name": "serial"}, load_registry())
    assert {path: path.stat().st_mtime_ns for path in before} == before


def test_certificates_of_other_code_do_not_count(referenced: Path) -> None:
    one = next(episodes_of(Runs.below(referenced)[0], load_registry()))
    before = one.certificate.read_bytes()
    (one.run.folder / "findings" / "reference.json").rename(referenced / "aside.json")  # as after an interruption
    place_known([one])
    assert one.certificate.is_file()
    place_known([replace(one, code="another")])
    assert not one.certificate.is_file()
    one.certificate.write_bytes(before)
    (referenced / "aside.json").rename(one.run.folder / "findings" / "reference.json")
    place_known([replace(one, problem="another")])
    assert not one.certificate.is_file()
    one.certificate.write_bytes(before)


def test_certificates_of_changed_code_are_driven_again_and_found(
    referenced: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copied = shutil.copytree(Runs.below(referenced)[0].folder, tmp_path / "run")
    told = json.loads((copied / "findings" / "reference.json").read_text())
    for row in told["episodes"].values():
        row["problem"] = "of other code"
    (copied / "findings" / "reference.json").write_text(json.dumps(told))
    before = {path: path.stat().st_mtime_ns for path in (copied / "reference" / "records").glob("*.npz")}
    (found,) = reference_runs([Run(copied)], {"name": "serial"}, load_registry()).values()
    assert len(found) == len(before) == 2
    assert all(path.stat().st_mtime_ns != time for path, time in before.items())
    one = next(episodes_of(Run(copied), load_registry()))
    assert check_driven([replace(one, code="changed meanwhile")]) == {one.problem}
    assert "certificates do not count yet: the code changed while they were driven" in capsys.readouterr().err
    assert one.certificate.is_file()


def test_runs_and_tables_do_not_take_certificates_for_episodes(referenced: Path) -> None:
    assert len(Runs.below(referenced)) == 2


def test_reports_and_queries_read_what_was_found(
    referenced: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = Runs.below(referenced).report(tmp_path / "report") / "index.html"
    assert "lower bound" in page.read_text(encoding="utf-8")
    assert (
        main(
            [
                "query",
                'SELECT count("reference.stl") AS known, min("reference.time_lower") FROM episodes',
                str(referenced),
            ]
        )
        == 0
    )
    assert "known" in capsys.readouterr().out


def test_failures_are_explained(driven: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert ExplainCommand().run([str(driven)]) == 0
    told = capsys.readouterr().out
    for one in Runs.below(driven):
        table = rows(one.folder / "explain.csv")
        for row in table:
            record = one.record(int(row["episode"]))
            assert float(row["stamp"]) in record["contact_stamp"]
            if row["avoidable_until"]:
                lead = float(row["stamp"]) - float(row["avoidable_until"])
                assert 0.0 <= lead == pytest.approx(float(row["lead"]))
            assert row["cause"] in told
    assert "strict success" in told


def test_findings_hold_the_moments_of_every_episode_with_a_way_out_where_one_was_driven(driven: Path) -> None:
    assert ExplainCommand().run([str(driven)]) == 0
    for one in Runs.below(driven):
        found = next(kind for kind in read_findings(one.folder) if kind.kind == "explain")
        table = rows(one.folder / "explain.csv")
        assert sorted(found.rows) == sorted(one.episodes["episode"])
        for episode, row in found.rows.items():
            moments = [mark for mark in found.marks.get(episode, ()) if mark.kind == "last avoidable moment"]
            known = [line["avoidable_until"] for line in table if int(line["episode"]) == episode]
            assert sorted(mark.stamp for mark in moments) == sorted(float(stamp) for stamp in known if stamp)
            assert all(len(mark.way) > 1 for mark in moments)
            kinds = [mark.kind for mark in found.marks.get(episode, ())]
            counts = {"recoveries": "recovery", "stands": "stand", "reversals": "reversal"}
            assert all(row[name] == kinds.count(kind) for name, kind in counts.items())


def test_single_episodes_are_explained_and_others_refused(driven: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = str(Runs.below(driven)[0].folder)
    assert ExplainCommand().run([folder, "0"]) == 0
    assert "strict success" not in capsys.readouterr().out
    with pytest.raises(ConfigurationError, match="episode is 99"):
        ExplainCommand().run([folder, "99"])


def test_a_run_whose_truth_no_simulator_knows_is_refused(driven: Path, tmp_path: Path) -> None:
    shutil.copytree(Runs.below(driven)[0].folder, tmp_path / "recorded")
    path = tmp_path / "recorded" / "records" / "0000.npz"
    with np.load(path, allow_pickle=False) as file:
        arrays = dict(file)
    meta = json.loads(str(arrays.pop("meta")))
    np.savez(path, meta=np.array(json.dumps({**meta, "truth": "estimated"})), **arrays)
    for command in (ReferenceCommand(), ExplainCommand()):
        with pytest.raises(ArenaError, match="no simulator knows its truth"):
            command.run([str(tmp_path / "recorded")])


def test_a_reference_without_a_folder_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    for command in (ReferenceCommand(), ExplainCommand()):
        with pytest.raises(Exception, match="DIR"):
            command.run([])
        assert command.run(["--help"]) == 0
    assert "usage: arena explain" in capsys.readouterr().out
