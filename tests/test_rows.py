import csv
import math

import numpy as np
import pytest

from arena_core import Metric
from arena_core.hosting import RunFolderError
from arena_core.loop.record_files import write_record
from arena_core.runs.jobs.rows import COLUMNS, evaluate_folder, evaluate_record, metric_columns, write_episodes
from arena_core.testing import record

STEPS = Metric("steps", "-", "lower", "control steps", lambda r: len(r["stamp"]) - 1)
NOTHING = Metric("nothing", "m", "neither", "never defined", lambda r: math.nan)
PACKS = {"": [STEPS, NOTHING], "mine": [STEPS]}


def row(episode, **values):
    return {"planner": "dwa", "episode": episode, "outcome": "goal_reached", **values}


def read(folder):
    with (folder / "episodes.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_columns_of_the_bare_pack_have_its_metrics_names_and_others_are_prefixed():
    assert metric_columns(PACKS) == ["steps", "nothing", "mine.steps"]


def test_a_row_is_what_identifies_the_episode_then_its_figures():
    values = evaluate_record(record(steps=31), PACKS)
    assert (values["planner"], values["outcome"], values["error"]) == ("sample", "goal_reached", "")
    assert (values["steps"], values["mine.steps"]) == (30.0, 30.0)
    assert math.isnan(values["nothing"])


def test_columns_come_in_the_documented_order(tmp_path):
    write_episodes(tmp_path, [], PACKS)
    header = (tmp_path / "episodes.csv").read_text()
    identification = (
        "config_hash,code,planner,preset,robot,simulator,world,task,scenario,scenario_hash,stage,n_pedestrians,"
        "pedestrian_model,reaction,localizer,timing,predictor,privileged,episode,seed,outcome,error"
    )
    assert header == f"{identification},steps,nothing,mine.steps\n"
    assert ",".join(COLUMNS) == identification


def test_rows_come_in_order_of_episode_whatever_the_order_they_were_finished_in(tmp_path):
    write_episodes(tmp_path, [row(10), row(2), row(0)], {})
    assert [r["episode"] for r in read(tmp_path)] == ["0", "2", "10"]


def test_what_is_not_defined_is_left_empty(tmp_path):
    write_episodes(tmp_path, [row(0, steps=30.0, nothing=math.nan)], PACKS)
    (only,) = read(tmp_path)
    assert (only["steps"], only["nothing"], only["mine.steps"], only["error"]) == ("30.0", "", "", "")


def test_figures_are_written_to_the_last_digit(tmp_path):
    value = 0.1 + 0.2
    write_episodes(tmp_path, [row(0, steps=value)], PACKS)
    assert float(read(tmp_path)[0]["steps"]) == value


def test_texts_with_commas_and_quotes_survive(tmp_path):
    write_episodes(tmp_path, [row(0, error='ValueError: "a", b')], {})
    assert read(tmp_path)[0]["error"] == 'ValueError: "a", b'


def test_the_records_of_a_folder_are_evaluated_in_order(tmp_path):
    for episode, steps in ((3, 4), (0, 6)):
        write_record(tmp_path, episode, record(steps=steps))
    assert [r["steps"] for r in evaluate_folder(tmp_path, PACKS)] == [5.0, 3.0]


def test_a_figure_may_be_a_numpy_number():
    mean = Metric("mean", "m", "lower", "mean x", lambda r: np.float32(r["pose"][:, 0].mean()))
    assert type(evaluate_record(record(), {"": [mean]})["mean"]) is float


def test_a_table_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "run").write_text("")
    with pytest.raises(RunFolderError, match=r"cannot write .*episodes\.csv"):
        write_episodes(tmp_path / "run", [], {})


def test_a_text_and_a_truth_are_values_of_metrics(tmp_path):
    side = Metric("side", "text", "neither", "on which side people were passed", lambda r: "left")
    touched = Metric("touched", "0/1", "lower", "whether anybody was touched", lambda r: bool(r["in_contact"].any()))
    values = evaluate_record(record(contact=True), {"mine": [side, touched]})
    assert (values["mine.side"], values["mine.touched"]) == ("left", 1.0)
    write_episodes(tmp_path, [row(0, **{"mine.side": "=left", "mine.touched": 1.0})], {"mine": [side, touched]})
    assert (read(tmp_path)[0]["mine.side"], read(tmp_path)[0]["mine.touched"]) == ("'=left", "1.0")


@pytest.mark.parametrize(("unit", "value"), [("m", "left"), ("text", 1.0)])
def test_a_value_that_the_unit_does_not_allow_is_an_error(unit, value):
    metric = Metric("side", unit, "neither", "which side", lambda r: value)
    with pytest.raises(
        TypeError, match=f"metric side is {value!r} in unit {unit}; allowed: a text in unit text, else a number"
    ):
        evaluate_record(record(), {"mine": [metric]})
