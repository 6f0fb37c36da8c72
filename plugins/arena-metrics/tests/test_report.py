"""arena report: from folders to tables, figures and a page."""

import csv
import json
import re

import numpy as np
import pytest

from arena_core import InputFileError
from arena_core.hosting import RunFolderError
from arena_metrics.pages.report import ReportCommand
from arena_metrics.pages.trajectories import people_colours, scale_bar_length
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import columns_of, metric_columns, pool_episodes, read_runs
from arena_metrics.pooling.summary import summarise_cells, summary_csv
from arena_metrics.tables.tables import headline_table, latex_tables, markdown_tables, metric_tables

FEW = ("success", "strict_success", "collisions", "path_length", "jerk")  # metrics enough to draw


def summary_of(*folders):
    runs = read_runs(folders)
    episodes, _ = pool_episodes(runs)
    return summarise_cells(cells_of(episodes), metric_columns(runs))


def names(summary):
    return [summary.cells.name(cell) for cell in summary.cells.cells]


def report(*arguments):
    return ReportCommand().run([str(argument) for argument in arguments])


def test_cells_are_named_by_what_differs(run_folder, tmp_path):
    run_folder(tmp_path / "a", planner="dwa", people=5)
    run_folder(tmp_path / "b", planner="teb", people=10)
    summary = summary_of(tmp_path)
    assert names(summary) == ["dwa, 5 people", "teb, 10 people"]
    assert summary.cells.common["robot"] == "jackal"


def test_one_cell_is_named_by_its_planner(run_folder, tmp_path):
    assert names(summary_of(run_folder(tmp_path / "a"))) == ["dwa"]


def test_parameters_name_cells_that_are_otherwise_alike(run_folder, tmp_path):
    run_folder(tmp_path / "a", sim_time=1.5)
    run_folder(tmp_path / "b", sim_time=3.0)
    run_folder(tmp_path / "c", sim_time=10.0)
    assert names(summary_of(tmp_path)) == ["sim_time=1.5", "sim_time=3.0", "sim_time=10.0"]


def test_people_are_sorted_as_numbers(run_folder, tmp_path):
    for people in (10, 5, 0):
        run_folder(tmp_path / str(people), people=people)
    assert names(summary_of(tmp_path)) == ["0 people", "5 people", "10 people"]


def test_seeds_of_one_configuration_are_one_cell_and_repeats_count_once(run_folder, tmp_path):
    run_folder(tmp_path / "a", seed=0)
    run_folder(tmp_path / "b", seed=1)
    run_folder(tmp_path / "again", seed=1)
    episodes, repeats = pool_episodes(read_runs([tmp_path]))
    assert (len(episodes), repeats, len(cells_of(episodes).cells)) == (6, 3, 1)


def test_folder_given_twice_is_read_once(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a")
    assert len(read_runs([tmp_path, folder])) == 1


def test_path_metrics_are_summarised_over_all_and_over_successful_episodes(run_folder, tmp_path):
    summary = summary_of(run_folder(tmp_path / "a", episodes=5))
    cell = summary.cells.cells[0]
    assert summary.of[cell.hash, "path_length", "all"].mean == pytest.approx(np.mean([4.0, 4.5, 5.0, 5.5, 6.0]))
    assert summary.of[cell.hash, "path_length", "successful"].mean == pytest.approx(np.mean([4.0, 5.0, 6.0]))
    assert (cell.hash, "collisions", "successful") not in summary.of


def test_headline_holds_means_intervals_and_n(run_folder, tmp_path):
    table = headline_table(summary_of(run_folder(tmp_path / "a", episodes=8, errors=[2])))
    row = dict(zip(table.head, table.rows[0], strict=True))
    assert row["n"] == "8"
    assert row["success [%]"].startswith("43 [16 – 75] (n=7)")
    assert row["path length [m], successful"] == "5.67 (n=3)"


def test_other_packs_have_tables_of_their_own(run_folder, tmp_path):
    summary = summary_of(run_folder(tmp_path / "a", packs=("si", "paper_legacy")))
    tables = metric_tables(summary, "all")
    assert [table.caption.partition(":")[0] for table in tables] == [
        "mean [95 % interval] (n) over all episodes",
        "paper_legacy",
    ]
    assert [row[0] for row in tables[1].rows][:3] == ["success", "collision", "time"]


@pytest.mark.parametrize("pack", ["foreign", "0", "si,barn", "a" * 300])
def test_columns_of_a_pack_that_is_not_installed_are_shown_without_unit(run_folder, tmp_path, pack):
    folder = run_folder(tmp_path / "a")
    text = (folder / "episodes.csv").read_text().splitlines()
    (folder / "episodes.csv").write_text(
        "\n".join([f'{text[0]},"{pack}.calm"', *(line + ",1.5" for line in text[1:])]) + "\n"
    )
    column = metric_columns(read_runs([folder]))[-1]
    assert (column.name, column.pack, column.unit) == (f"{pack}.calm", pack, "")


def test_texts_are_counted_in_the_tables_and_shown_with_each_episode(run_folder, tmp_path, capsys):
    folder = run_folder(tmp_path / "a", episodes=6)
    text = (folder / "episodes.csv").read_text().splitlines()
    sides = ["left", "left", "right", "", "left", "right"]
    rows = [f"{line},{side}" for line, side in zip(text[1:], sides, strict=True)]
    (folder / "episodes.csv").write_text("\n".join([text[0] + ",foreign.side", *rows]) + "\n")
    summary = summary_of(folder)
    assert [column.name for column in summary.texts] == ["foreign.side"]
    assert metric_tables(summary, "all")[-1].rows == [["side", "", "left (3), right (2)"]]
    assert ReportCommand().run([str(folder), "--no-figures"]) == 0
    page = (folder / "report" / "index.html").read_text()
    assert page.count("<td>left</td>") == 3
    (folder / "episodes.csv").write_text("\n".join([text[0] + ",foreign.side", *rows[:-1], f"{text[-1]},7"]) + "\n")
    with pytest.raises(
        InputFileError, match=r"episodes.csv: line 2: could not convert string to float: 'left'; allowed: numbers"
    ):
        read_runs([folder])


def test_pack_that_was_evaluated_afterwards_is_described_by_its_preset(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a", packs=("si", "paper_legacy"))
    provenance = json.loads((folder / "provenance.json").read_text())
    del provenance["config"]["metrics"]["paper_legacy"]
    (folder / "provenance.json").write_text(json.dumps(provenance))
    units = {column.name: column.unit for column in metric_columns(read_runs([folder]))}
    assert units["paper_legacy.jerk"] == "m/s/record^2"


def test_markdown_and_latex_escape_what_they_must(run_folder, tmp_path):
    run_folder(tmp_path / "a", planner="dwa_as|released")
    run_folder(tmp_path / "b", planner="teb")
    table = headline_table(summary_of(tmp_path))
    assert r"dwa_as\|released" in markdown_tables([table])
    assert r"dwa\_as|released" in latex_tables([table])
    assert r"success [\%]" in latex_tables([table])
    assert len({line.count("&") for line in latex_tables([table]).splitlines() if "&" in line}) == 1


def test_summary_has_a_line_for_each_metric(run_folder, tmp_path, pack_metrics):
    run_folder(tmp_path / "a", episodes=7, errors=[1])
    lines = list(csv.DictReader(summary_csv(summary_of(tmp_path)).splitlines()))
    success = next(line for line in lines if line["metric"] == "success")
    assert (success["n"], success["mean"], success["interval"], success["unit"]) == (
        "6",
        repr(4 / 6),
        "Agresti-Coull",
        "0/1",
    )
    assert {line["over"] for line in lines if line["metric"] == "path_length"} == {"all", "successful"}
    assert len(columns_of(pack_metrics)) == len({line["metric"] for line in lines})


def test_report_writes_tables_figures_and_a_page_without_external_requests(run_folder, tmp_path, capsys):
    for i, (planner, people) in enumerate([("dwa", 0), ("dwa", 5), ("teb", 0), ("teb", 5)]):
        run_folder(
            tmp_path / str(i), planner=planner, people=people, episodes=4, errors=[3] if i == 3 else [], only=FEW
        )
    assert report(tmp_path, "--pictures", "1", "--pdf", "--all-figures") == 0
    page = (tmp_path / "report" / "index.html").read_text()
    assert "2 planners × 2 crowd sizes · jackal · hall" in page
    assert "NoPath: &lt;none&gt;" in page
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:|#|replays/)""", page)
    assert all((tmp_path / "report" / name).exists() for name in re.findall(r'href="(replays/[^"]+)"', page))
    assert "url(" not in page
    made = {path.name for path in (tmp_path / "report" / "figures").iterdir()}
    assert {
        "success.png",
        "success.pdf",
        "jerk.png",
        "jerk.pdf",
        "cell_dwa-jackal-0-1.5.png",
        "cell_dwa-jackal-0-1.5.pdf",
    } <= made
    assert {path.name for path in (tmp_path / "report" / "tables").iterdir()} >= {
        "headline.tex",
        "headline.md",
        "headline.csv",
    }
    assert all((tmp_path / str(i) / "summary.csv").exists() for i in range(4))
    assert f"report: {tmp_path / 'report' / 'index.html'}" in capsys.readouterr().out


def test_people_who_are_not_in_the_world_are_not_drawn(run_folder, tmp_path):
    """The picture of people who are absent all the time is that of a world without people's tracks."""
    pictures = []
    for name, absent in (("all", False), ("none", True)):
        folder = run_folder(tmp_path / name, people=2, episodes=1, only=FEW)
        path = folder / "records" / "0000.npz"
        with np.load(path) as content:
            arrays = dict(content)
        arrays["pedestrian_positions"] = np.where(absent, np.nan, arrays["pedestrian_positions"] - (0.0, 1.0))
        np.savez(path, **arrays)
        assert report(folder) == 0
        pictures.append(next((folder / "report" / "figures").glob("cell_*.png")).read_bytes())
    assert pictures[0] != pictures[1]


def test_people_are_drawn_in_the_colour_of_their_type(record_of, straight_line):
    people = {
        "pedestrian_ids": np.array([4, 7, 9], np.int32),
        "pedestrian_positions": np.zeros((len(straight_line()), 3, 2), np.float32),
    }
    plain = record_of(straight_line(), **people)
    assert people_colours(plain, "red") == ["red"] * 3
    config = {"pedestrians": {"types": {"adult": {"colour": None}, "forklift": {"colour": "black"}}}}
    scenario = {**plain.meta["scenario"], "pedestrian_types": {"4": "adult", "9": "forklift"}}
    typed = record_of(straight_line(), meta={"config": config, "scenario": scenario}, **people)
    assert people_colours(typed, "red") == ["red", "red", "black"]


def test_same_runs_give_the_same_report_byte_for_byte(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a", only=FEW)
    report(folder, "--out", tmp_path / "first")
    report(folder, "--out", tmp_path / "second")
    files = sorted(path.relative_to(tmp_path / "first") for path in (tmp_path / "first").rglob("*") if path.is_file())
    assert len(files) > 10
    for path in files:
        assert (tmp_path / "first" / path).read_bytes() == (tmp_path / "second" / path).read_bytes()


def test_out_leaves_the_runs_untouched(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a")
    before = sorted(folder.rglob("*"))
    report(folder, "--out", tmp_path / "elsewhere", "--no-figures")
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize("name", ["report", "report/tables", "report/replays"])
def test_a_report_writes_through_no_link_out_of_the_runs_folder(run_folder, tmp_path, name):
    folder, elsewhere = run_folder(tmp_path / "run"), tmp_path / "elsewhere"
    elsewhere.mkdir()
    (folder / name).parent.mkdir(exist_ok=True)
    (folder / name).symlink_to(elsewhere)
    with pytest.raises(InputFileError, match="leads out of"):
        report(folder, "--no-figures")
    assert not list(elsewhere.iterdir())


def test_single_episode_is_reported_without_interval(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a", episodes=1)
    assert report(folder, "--no-figures") == 0
    assert "succeeded in 1 of 1 episode," in (folder / "report" / "index.html").read_text()


def test_cell_in_which_everything_failed_is_reported_with_its_errors(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a", episodes=2, errors=[0, 1])
    assert report(folder) == 0
    page = (folder / "report" / "index.html").read_text()
    assert "no episode could be judged" in page
    assert "5 people" in page


@pytest.mark.slow
def test_hundreds_of_cells_are_folded_away(run_folder, tmp_path):
    for i in range(130):
        run_folder(tmp_path / str(i), episodes=2, sim_time=1.0 + i, records=False)
    assert report(tmp_path, "--no-figures") == 0
    page = (tmp_path / "report" / "index.html").read_text()
    assert "The other 70 cells" in page
    assert "first 24 of 130 cells" in page


def test_report_again_does_not_read_its_own_tables(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a")
    report(folder, "--no-figures")
    first = (folder / "report" / "summary.csv").read_text()
    report(folder, "--no-figures")
    assert (folder / "report" / "summary.csv").read_text() == first


def test_folder_without_runs_is_refused(tmp_path):
    with pytest.raises(InputFileError, match=r"no run below it"):
        report(tmp_path)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda text: text.replace("config_hash", "hash", 1), "lacks the column config_hash"),
        (lambda text: text.replace(",goal_reached,", ",goal_reached,,,,,,,", 1), "line 2 has another number of fields"),
        (lambda text: text[:-60], "fields|could not convert"),
        (lambda text: re.sub(r",4\.0\d*", ",four", text, count=1), "line 2: could not convert string to float: 'four'"),
        (lambda text: text.splitlines()[0] + "\n", "holds no episode yet"),
    ],
)
def test_broken_table_is_named_with_its_line(run_folder, tmp_path, spoil, message):
    folder = run_folder(tmp_path / "a")
    table = folder / "episodes.csv"
    table.write_text(spoil(table.read_text()))
    with pytest.raises(InputFileError, match=message):
        report(folder, "--no-figures")


def test_broken_provenance_is_named(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a")
    (folder / "provenance.json").write_text("{")
    with pytest.raises(InputFileError, match=r"provenance\.json"):
        report(folder, "--no-figures")


def test_missing_map_is_named(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a")
    (folder / "worlds" / "hall.npz").unlink()
    with pytest.raises(InputFileError, match=r"hall\.npz: cannot be read"):
        report(folder)


def test_unwritable_place_is_named_and_leaves_nothing_behind(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a")
    (tmp_path / "file").write_text("")
    with pytest.raises(RunFolderError, match="cannot write"):
        report(folder, "--out", tmp_path / "file" / "below", "--no-figures")


def test_run_without_provenance_is_reported(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a")
    (folder / "provenance.json").unlink()
    assert report(folder, "--no-figures") == 0


def test_missing_tuning_is_said(run_folder, tmp_path):
    folder = run_folder(tmp_path / "a")
    provenance = json.loads((folder / "provenance.json").read_text()) | {"untuned": ["dwa: untuned for jackal"]}
    (folder / "provenance.json").write_text(json.dumps(provenance))
    report(folder, "--no-figures")
    assert "Not tuned: dwa: untuned for jackal." in (folder / "report" / "index.html").read_text()


def test_configuration_difference_is_in_the_page(run_folder, tmp_path):
    run_folder(tmp_path / "a", sim_time=1.5)
    run_folder(tmp_path / "b", sim_time=3.0)
    report(tmp_path, "--no-figures")
    page = (tmp_path / "report" / "index.html").read_text()
    assert "<code>planner.sim_time</code>" in page
    assert json.dumps(3.0) in page


@pytest.mark.parametrize(("width", "bar"), [(4.0, 1.0), (20.0, 5.0), (19.0, 2.0), (400.0, 100.0), (0.9, 0.2)])
def test_scale_bar_is_round_and_at_most_a_quarter(width, bar):
    assert scale_bar_length(width) == pytest.approx(bar)


def test_a_report_says_how_each_planner_was_tuned_and_learned(tmp_path):
    from arena_metrics.pages.tuned import NOT_TOLD, tuned_rows
    from arena_metrics.pooling.runs import Run

    config = {"planner": {"name": "dwa"}, "robot": {"name": "jackal"}, "choices": {"planner": "mine"}}
    told = {"preset": "mine", "tuned": "by arena tune for jackal", "budget": 2256, "learned_by": ""}
    runs = [Run(tmp_path, [], {"config": config, "tuning": told}), Run(tmp_path, [], {"config": config})]
    assert tuned_rows([*runs, *runs]) == [
        ("mine", "jackal", "by arena tune for jackal", "2256 episodes", "–"),
        ("mine", "jackal", NOT_TOLD, NOT_TOLD, NOT_TOLD),
    ]
