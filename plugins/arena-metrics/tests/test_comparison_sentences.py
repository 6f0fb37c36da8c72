"""What the first screen says of rivals: who is better, or that the episodes do not tell; by problem, and
never across different code.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

from arena_core.statistics import compare
from arena_metrics.pages.headline import summary_sentences
from arena_metrics.pages.provenance import episodes_of
from arena_metrics.pages.report import ReportCommand
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.codes import other_code
from arena_metrics.pooling.runs import metric_columns, pool_episodes, read_runs
from arena_metrics.pooling.summary import summarise_cells
from arena_metrics.tables.comparison_sentences import goal_time_sentence, success_sentence
from arena_metrics.tables.problem_table import problem_table
from arena_metrics.tables.tables import headline_table

FEW = ("success", "strict_success", "collisions", "path_length", "time_to_goal")


def summary_of(folder):
    runs = read_runs([folder])
    return summarise_cells(cells_of(pool_episodes(runs)[0]), metric_columns(runs))


def rivals(won, lost, alike, repeats=1):
    ours = np.array([1.0] * won + [0.0] * lost + [1.0] * alike)
    theirs = np.array([0.0] * won + [1.0] * lost + [1.0] * alike)
    problems = [i for i in range(len(ours)) for _ in range(repeats)] if repeats > 1 else None
    return compare(np.repeat(ours, repeats), np.repeat(theirs, repeats), True, problems)


def test_the_better_planner_is_named_first_with_points_and_p():
    assert (
        success_sentence("teb", "mine", rivals(7, 0, 8))
        == "teb succeeds more often than mine by 47 points (13–70), p = .008."
    )
    assert (
        success_sentence("mine", "teb", rivals(0, 7, 8))
        == "teb succeeds more often than mine by 47 points (13–70), p = .008."
    )


def test_what_cannot_be_told_apart_says_how_many_more_would():
    said = success_sentence("teb", "mine", rivals(2, 1, 12))
    assert said.startswith("teb and mine cannot be told apart by their successes, 7 points (−20 to 32), p = .62; ")
    assert "; 15 episodes show differences of 45 points or more, about 170 more episodes" in said
    assert said.endswith(" more episodes would show a difference of 10 points.")


@pytest.mark.parametrize(
    ("low", "text"), [(-0.05, "−5 to 20"), (-0.001, "0 to 20"), (0.0, "0–20"), (0.001, "0–20"), (0.05, "5–20")]
)
def test_a_range_has_a_dash_unless_it_begins_below_0(low, text):
    one = rivals(7, 0, 8)
    shown = replace(one, difference=replace(one.difference, mean=0.1, low=low, high=0.2))
    assert f"by 10 points ({text}), p" in success_sentence("teb", "mine", shown)
    mirrored = replace(one, difference=replace(one.difference, mean=-0.1, low=-0.2, high=-low))
    assert f"mine succeeds more often than teb by 10 points ({text}), p" in success_sentence("teb", "mine", mirrored)


@pytest.mark.parametrize(
    ("more", "text"), [(1.0, "1"), (7.2, "8"), (12.3, "13"), (99.1, "100"), (123.0, "130"), (1234.0, "1,300")]
)
def test_how_many_more_has_two_digits_and_is_rounded_up(more, text):
    open_one = replace(rivals(3, 2, 8), more=more)
    assert f"about {text} more episodes would show a difference of 10 points" in success_sentence("a", "b", open_one)
    shown = success_sentence("a", "b", replace(open_one, more=0.99))
    assert shown.endswith("a difference of 10 points would probably have shown.")


def test_repeated_problems_ask_for_more_problems():
    assert "more problems would show" in success_sentence("teb", "mine", rivals(2, 1, 12, repeats=3))


def test_many_episodes_without_a_difference_ask_for_no_more():
    assert success_sentence("a", "b", rivals(5, 5, 990)).endswith(
        "; a difference of 10 points would probably have shown."
    )


def test_few_problems_say_nothing():
    assert "met on 3 problems only: with fewer than 5 nothing can be said about others" in success_sentence(
        "a", "b", rivals(3, 0, 0, repeats=9)
    )


def test_the_report_says_it_after_holm_where_there_are_several_rivals(run_folder, tmp_path, capsys):
    run_folder(tmp_path / "dwa", planner="dwa", episodes=20, fails=range(1, 13), only=FEW)
    run_folder(tmp_path / "teb", planner="teb", episodes=20, fails=[1], only=FEW)
    run_folder(tmp_path / "mpc", planner="mpc", episodes=20, fails=range(2, 14), only=FEW)
    said = summary_sentences(summary_of(tmp_path))
    assert said[1].startswith("mpc and dwa cannot be told apart")
    assert said[2].startswith("teb succeeds more often than dwa by 55 points (")
    assert said[2].endswith("after Holm.")
    assert summary_sentences(summary_of(tmp_path), "teb")[1].startswith("teb succeeds more often than dwa")
    assert ReportCommand().run([str(tmp_path), "--no-figures"]) == 0
    assert said[2] in capsys.readouterr().out


def test_what_more_people_do_to_each_planner_is_said_where_conditions_differ_in_people_alone(run_folder, tmp_path):
    for planner, worse in (("dwa", range(10)), ("teb", range(2))):
        run_folder(tmp_path / planner / "few", planner=planner, people=4, episodes=20, fails=[0], only=FEW)
        run_folder(tmp_path / planner / "many", planner=planner, people=36, episodes=20, fails=worse, only=FEW)
    said = "Among 36 people instead of 4, success goes from 95 to 90 % (teb), from 95 to 50 % (dwa)."
    assert summary_sentences(summary_of(tmp_path))[1] == said
    run_folder(tmp_path / "other", planner="dwa", robot="robotino", people=4, episodes=20, only=FEW)
    assert not [line for line in summary_sentences(summary_of(tmp_path)) if line.startswith("Among")]


def test_the_faster_planner_is_named_first_with_seconds_and_p():
    ours, theirs = np.array([8.0, 9.5, 7.0, 10.0, 8.5, 9.0]), np.array([11.0, 12.0, 9.5, 13.5, 11.5, 11.0])
    said = "Where both succeed, teb is at the goal 2.8 s sooner than dwa ("
    assert goal_time_sentence("teb", "dwa", compare(ours, theirs)).startswith(said)
    assert goal_time_sentence("dwa", "teb", compare(theirs, ours)) == goal_time_sentence(
        "teb", "dwa", compare(ours, theirs)
    )


def test_times_are_told_where_successes_do_not_tell(run_folder, tmp_path):
    run_folder(tmp_path / "dwa", planner="dwa", episodes=12, fails=[0], only=FEW)
    run_folder(tmp_path / "teb", planner="teb", episodes=12, fails=[1], only=FEW)
    summary = summary_of(tmp_path)
    assert len(summary_sentences(summary)) == 2  # both drive alike
    teb = summary.cells.cells[1]
    saved = {e: 0.1 * (1 + e.row["episode"] % 3) for e in teb.episodes}
    faster = replace(
        teb, episodes=[replace(e, row={**e.row, "time_to_goal": e.row["time_to_goal"] - saved[e]}) for e in saved]
    )
    changed = replace(summary, cells=replace(summary.cells, cells=[summary.cells.cells[0], faster]))
    assert summary_sentences(changed)[2].startswith(
        "Where both succeed, teb is at the goal 0.2 s sooner than dwa (0.1–0.3), p "
    )


def test_conditions_share_their_problems(run_folder, tmp_path):
    """The same ten scenarios with five and with ten people are ten problems, not twenty."""
    for people in (5, 10):
        run_folder(tmp_path / f"dwa{people}", planner="dwa", people=people, episodes=10, fails=range(4))
        run_folder(tmp_path / f"teb{people}", planner="teb", people=people, episodes=10, fails=[9])
    assert "more problems would show" in summary_sentences(summary_of(tmp_path))[2]


def test_episodes_of_a_file_are_its_problems(run_folder, tmp_path):
    run_folder(tmp_path / "a", episodes=18, problems=6, only=FEW, fails=[0, 6])
    run_folder(tmp_path / "b", episodes=18, problems=6, only=FEW, seed=1, fails=[0])
    summary = summary_of(tmp_path)
    (cell,) = summary.cells.cells
    success = next(column for column in summary.columns if column.name == "success")
    assert (summary.get(cell, success).n, summary.get(cell, success).problems) == (36, 6)
    assert headline_table(summary).rows[0][1] == "36 on 6 problems"
    table = problem_table(summary.cells, summary.columns)
    assert [row[1:3] for row in table.rows] == [[f"p{i}", "6"] for i in range(6)]
    assert table.rows[0][3].startswith("50 [")
    assert table.rows[1][3].startswith("100 [")


def test_drawn_problems_have_no_table_of_their_own(run_folder, tmp_path):
    summary = summary_of(run_folder(tmp_path / "a", episodes=6))
    assert problem_table(summary.cells, summary.columns) is None


def test_one_problem_again_and_again_has_no_interval_but_is_shown(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a", episodes=12, problems=1, only=FEW)
    summary = summary_of(folder)
    assert headline_table(summary).rows[0][1:3] == ["12 on 1 problem", "50"]
    assert problem_table(summary.cells, summary.columns).rows[0][3].startswith("50 [25 –")
    assert ReportCommand().run([str(folder)]) == 0
    assert "Problem by problem" in (folder / "report" / "index.html").read_text()
    assert (folder / "report" / "tables" / "problems.csv").exists()


def test_rows_of_different_code_are_different_cells(run_folder, tmp_path):
    run_folder(tmp_path / "a", code="11111111", seed=0)
    run_folder(tmp_path / "b", code="22222222", seed=1)
    run_folder(tmp_path / "c", code="22222222", seed=2)
    run_folder(tmp_path / "d", seed=3)
    summary = summary_of(tmp_path)
    found = {summary.cells.name(cell): len(cell.episodes) for cell in summary.cells.cells}
    assert found == {"code 11111111": 3, "code 22222222": 6, "code unknown": 3}
    assert ReportCommand().run([str(tmp_path)]) == 0
    page = (tmp_path / "report" / "index.html").read_text()
    assert "<code>22222222</code>" in page
    assert ",22222222," in (tmp_path / "report" / "summary.csv").read_text()


def test_parameters_and_code_name_cells_together(run_folder, tmp_path):
    run_folder(tmp_path / "a", code="11111111", sim_time=1.5)
    run_folder(tmp_path / "b", code="22222222", sim_time=1.5)
    run_folder(tmp_path / "c", code="22222222", sim_time=2.0)
    summary = summary_of(tmp_path)
    names = ["sim_time=1.5, code 11111111", "sim_time=1.5, code 22222222", "sim_time=2.0"]
    assert [summary.cells.name(cell) for cell in summary.cells.cells] == names


def test_planners_that_a_different_core_drove_are_told(run_folder, tmp_path):
    run_folder(tmp_path / "a", planner="dwa", code="1", parts={"arena-core": "0.1.0 aa", "arena-dwa": "0.1.0 dd"})
    run_folder(tmp_path / "b", planner="teb", code="2", parts={"arena-core": "0.1.0 bb", "arena-teb": "0.1.0 ee"})
    said = ["Driven with different code: arena-core 0.1.0 aa (dwa); 0.1.0 bb (teb)."]
    assert other_code(summary_of(tmp_path).cells) == said
    ReportCommand().run([str(tmp_path), "--no-figures"])
    assert said[0] in (tmp_path / "report" / "index.html").read_text()


@pytest.mark.parametrize("broken", [{"digest": "9", "parts": {"arena-core": "x"}}, None])
def test_parts_of_other_code_than_the_rows_are_not_believed(run_folder, tmp_path, broken):
    for name, planner in (("a", "dwa"), ("b", "teb")):
        folder = run_folder(tmp_path / name, planner=planner, code="1", parts={"arena-core": planner})
    facts = json.loads((folder / "provenance.json").read_text()) | {"code": broken}
    (folder / "provenance.json").write_text(json.dumps(facts))
    assert other_code(summary_of(tmp_path).cells) == []


@pytest.mark.parametrize(
    ("there", "wanted", "said"),
    [(3, 10, "3 of 10"), (10, 10, "10 of 10"), (10, 2, "10"), (4, None, "4"), (4, "many", "4")],
)
def test_no_more_episodes_are_told_than_were_wanted(there, wanted, said):
    assert episodes_of(there, wanted) == said
