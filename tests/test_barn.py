"""The BARN challenge from the experiment to the score."""

from pathlib import Path

import pytest

from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import load_registry
from arena_core.runs.jobs.benchmark import build_benchmark

BARN = Path(__file__).parents[2] / "shared" / "data" / "barn"
POST = """<model name='post{k}'><static>1</static><pose>{x} {y} 0 0 0 0</pose><link name='link'>
<collision name='collision'><geometry><cylinder><radius>0.075</radius><length>1</length></cylinder></geometry>
</collision></link></model>"""


def figures(path, folder, *overrides, episode=0):
    config = to_plain(compose(["experiment=barn", f"world.path={path}", "metrics=[barn]", *overrides]))
    benchmark = build_benchmark(config, load_registry())
    record = benchmark.run(episode, folder)
    return record, {metric.name: metric.compute(record) for metric in benchmark.metrics["barn"]}


@pytest.fixture
def row_of_posts(tmp_path):
    """A world with posts right across the straight way, 3 m wide."""
    posts = "".join(POST.format(k=k, x=-3.5 + 0.15 * k, y=8.0) for k in range(20))
    path = tmp_path / "world_7.world"
    path.write_text(f"<sdf version='1.6'><world name='default'>{posts}</world></sdf>")
    return path


@pytest.mark.slow
def test_robot_without_a_map_goes_round_what_its_scans_show(row_of_posts, tmp_path):
    record, found = figures(row_of_posts, tmp_path)
    assert record.meta["outcome"] == "goal_reached"
    assert record.meta["world"]["known"] is False
    assert record.meta["scenario"]["reference_length"] is None
    assert (found["success"], found["optimal_time"]) == (1.0, 5.0)
    assert found["score"] > 0.4
    assert len(record["contact_stamp"]) == 0


@pytest.mark.slow
def test_first_collision_ends_and_fails_a_run(row_of_posts, tmp_path):
    blind = ("planner=pure_pursuit", "local_map.mapping_range=0.2", "replan.period=null", "replan.blocked_for=null")
    record, found = figures(row_of_posts, tmp_path, *blind)
    assert record.meta["outcome"] == "collision"
    assert (found["success"], found["score"]) == (0.0, 0.0)


@pytest.mark.slow
@pytest.mark.skipif(not BARN.is_dir(), reason="the worlds of the BARN challenge are not at ../shared/data/barn")
def test_world_with_a_gap_that_comes_and_goes_is_crossed_without_dithering(tmp_path):
    record, found = figures(BARN / "world_files" / "world_138.world.gz", tmp_path)
    assert found["score"] > 0.4
    assert len(record["path_stamps"]) <= 8  # paths taken up; twenty are planned
