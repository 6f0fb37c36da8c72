"""Runs in which something saw the truth are no submission; a predictor is a choice like a planner."""

import json
import shutil

import pytest

from arena_core import ConfigurationError, InputFileError
from arena_core import run as run_benchmark
from arena_core.hosting import load_registry
from arena_submit.packing import read_pack, write_pack
from arena_submit.standing import check_standing, planner_of

ROOM = ["planner=pure_pursuit", "robot=jackal", "world=empty", "task.pedestrians=1", "executor=serial", "report=false"]


@pytest.fixture(scope="module")
def seeing(tmp_path_factory):
    folder = tmp_path_factory.mktemp("seeing") / "run"
    run_benchmark([*ROOM, "episodes=1", "tracker=ground_truth", "predictor=truth", "task.time_limit=2"], folder)
    return folder


def test_provenance_and_table_name_what_saw_the_truth(seeing):
    told = ["predictor truth", "tracker ground_truth"]
    assert json.loads((seeing / "provenance.json").read_text())["privileged"] == told
    assert ",".join(told[:1]) in (seeing / "episodes.csv").read_text()


def test_a_run_in_which_something_saw_the_truth_is_not_packed(seeing, tmp_path):
    with pytest.raises(InputFileError, match="predictor truth, tracker ground_truth saw the truth"):
        write_pack([seeing], tmp_path / "pack.zip")


def test_a_table_betrays_what_a_provenance_does_not_say(seeing, tmp_path):
    copied = shutil.copytree(seeing, tmp_path / "run")
    facts = json.loads((copied / "provenance.json").read_text())
    del facts["privileged"]
    (copied / "provenance.json").write_text(json.dumps(facts))
    with pytest.raises(InputFileError, match="predictor truth, tracker ground_truth saw the truth"):
        write_pack([copied], tmp_path / "pack.zip")


def test_a_run_of_what_sees_sensors_alone_is_packed(packed):
    with read_pack(packed) as pack:
        assert pack.runs[0].provenance["privileged"] == []


def test_a_predictor_is_a_choice_of_who_takes_part_and_is_named(faced, small_standing):
    with read_pack(faced("predictor=social_force")) as pack:
        check_standing(pack, small_standing, load_registry())
        assert planner_of(pack.runs[0]) == "pure_pursuit, predictor social_force"


@pytest.mark.parametrize("planner", ["clairvoyant", "sighted"])
def test_a_planner_that_sees_the_truth_is_no_submission(planner, tmp_path):
    run_benchmark([*ROOM[1:], f"planner={planner}", "episodes=1", "task.time_limit=2"], tmp_path / "run")
    with pytest.raises(InputFileError, match=f"planner {planner} saw the truth"):
        write_pack([tmp_path / "run"], tmp_path / "pack.zip")


@pytest.mark.parametrize("member", ["other", "teb"])
def test_a_switch_takes_no_member_that_sees_the_truth_in_place_of_those_it_was_trained_with(member, tmp_path):
    words = ["planner=aio_random", f"+planner@planner.members.{member}=clairvoyant", "robot=turtlebot3"]
    with pytest.raises(ConfigurationError, match=r"planner\.members"):
        run_benchmark([*ROOM[2:], *words, "episodes=1", "task.time_limit=2"], tmp_path / "run")
