"""The whole way in one browser: a wall is drawn, a person placed, an experiment run, its
episode replayed, a report opened.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from arena_core.records import read_record, record_path
from arena_worlds.formats.ros_map import load_map

pytestmark = pytest.mark.browser
MAP, SCENARIO = "document.querySelector('.page.map')", "document.querySelector('.page.scenario')"
SAVED = "{0}.autosave.state === 'saved' && !{0}.autosave.unsaved && !{0}.autosave.running"
PATH = "scenarios/straight.json"
SCENE = {"name": "a", "start": [1.0, 4.0, 0.0], "goal": [11.0, 4.0]}
COMPILED = 600_000  # ms: kernels may have to be compiled


def test_from_a_drawn_wall_to_a_report(show: Callable[..., Any], studio: Any) -> None:
    file = {"format": "arena-scenario", "version": 2, "map": "../maps/hall/map.yaml", "scenarios": [SCENE]}
    (studio.folder / PATH).write_text(json.dumps(file))

    drawn = show("map?path=maps/hall/map.yaml")
    drawn.wait(f"{MAP}?.editor?.map?.header.path === 'maps/hall/map.yaml'")
    drawn.drag(f"{MAP}.editor.view", (2.0, 6.0), (4.0, 6.0))
    drawn.wait(SAVED.format(f"{MAP}.editor.map"))
    row, column = load_map(studio.folder / "maps/hall/map.yaml").cells([3.0, 6.0])
    assert load_map(studio.folder / "maps/hall/map.yaml").data[row, column] == 100

    scene = show(f"scenario?path={PATH}")
    scene.wait(f"!!({SCENARIO} && {SCENARIO}.editor?.content && {SCENARIO}.editor.ground)")
    scene.page.click("[data-tool=person]")
    for place in ((7.0, 2.0), (9.0, 2.0)):
        scene.drag(f"{SCENARIO}.view", place)
        scene.page.wait_for_timeout(400)  # apart from a double click
    scene.page.keyboard.press("Escape")
    scene.page.wait_for_timeout(450)  # after that saving has begun
    scene.wait(SAVED.format(f"{SCENARIO}.editor"))

    run = show("run").page
    run.get_by_label("planner", exact=True).select_option("pure_pursuit")
    run.get_by_label("robot", exact=True).select_option("jackal")
    words = f"task=scenario task.path={PATH} world=scenario_map task.time_limit=20 executor=serial report=false"
    run.get_by_label("more words of the command line").fill(words)
    run.get_by_label("episodes", exact=True).fill("1")
    run.get_by_label("folder of the run").fill("outputs/way")
    run.get_by_text("every value is allowed").wait_for()
    run.locator("button.main:enabled").click()
    run.locator('.experiment[data-state="finished"]').wait_for(timeout=COMPILED)
    record = read_record(record_path(studio.folder / "outputs/way", 0))
    assert record["pedestrian_positions"].shape[1] == 1
    with run.expect_popup() as opened:
        run.get_by_role("link", name="replay").first.click()
    opened.value.locator("#facts", has_text="pure_pursuit on jackal").wait_for()

    run.get_by_role("link", name="results", exact=True).click()
    run.locator(".episodes tbody tr").first.wait_for()
    with run.expect_popup(timeout=COMPILED) as report:
        run.get_by_role("button", name="Report").click()
    report.value.locator("h1").wait_for()
    report.value.locator("body", has_text="pure_pursuit").wait_for()
    report.value.locator("details:has(table.episodes) > summary").click()
    report.value.locator("table.episodes a[href^='replays/']").first.click()
    report.value.locator("#facts", has_text="pure_pursuit on jackal").wait_for()
    report.value.go_back()
    report.value.locator("h1").wait_for()
