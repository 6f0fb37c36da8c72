"""Cells of teams: what their robots tell each other is a condition, and no figure."""

from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import metric_columns, pool_episodes, read_runs


def test_runs_that_differ_by_their_communication_are_told_apart_by_it(run_folder, tmp_path):
    for name, radio in (("silent", ""), ("talking", "broadcast")):
        folder = run_folder(tmp_path / name, episodes=2, only=("success",), sim_time=1.7 if radio else 1.5)
        header, *rows = (folder / "episodes.csv").read_text().splitlines()
        table = [f"{header},member,communication", *(f"{row},0,{radio}" for row in rows)]
        (folder / "episodes.csv").write_text("\n".join(table) + "\n")
    runs = read_runs([tmp_path])
    cells = cells_of(pool_episodes(runs)[0])
    assert "communication" in cells.varying
    assert sorted(cell.factors["communication"] for cell in cells.cells) == ["", "broadcast"]
    assert "communication" not in {column.name for column in metric_columns(runs)}
