"""The pages Run and Results in chromium: an experiment is composed, started, watched, and its
episodes are found again.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.browser
COMPILED = 600_000  # ms: kernels may have to be compiled
QUICK = "world=empty pedestrians=none task.time_limit=10 report=false executor=serial"


def test_experiment_is_composed_started_watched_and_its_episode_replayed(show: Callable[..., Any], studio: Any) -> None:
    shown = show("run")
    page = shown.page
    page.get_by_label("planner", exact=True).select_option("pure_pursuit")
    page.get_by_label("robot", exact=True).select_option("jackal")
    page.get_by_label("episodes", exact=True).fill("2")
    page.get_by_label("more words of the command line").fill(QUICK)
    page.get_by_label("folder of the run").fill("outputs/first")
    page.get_by_text("every value is allowed").wait_for()
    command = "arena run planner=pure_pursuit robot=jackal episodes=2 recording.live=true world=empty"
    page.locator("#command", has_text=command).wait_for()
    page.reload()
    page.get_by_text("every value is allowed").wait_for()
    page.locator("#command", has_text=command).wait_for()
    page.locator("button.main:enabled").click()
    page.locator('.experiment[data-state="finished"]').wait_for(timeout=COMPILED)
    page.locator(".experiment tbody tr").nth(1).wait_for()
    assert (studio.folder / "outputs/first/episodes.csv").exists()
    with page.expect_popup() as opened:
        page.get_by_role("link", name="replay").first.click()
    replay = opened.value
    replay.locator("#facts", has_text="pure_pursuit on jackal").wait_for()
    (name,) = (path.stem for path in (studio.folder / ".arena_studio" / "runs").glob("*.json"))
    watch = page.context.new_page()
    watch.goto(f"http://127.0.0.1:{studio.port}/watch/{name}/")
    watch.locator("#finished tr").nth(1).wait_for()
    watch.locator("#standing", has_text="2 of 2 episodes").wait_for()
    with watch.context.expect_page() as opened:
        watch.click("#finished a")
    opened.value.locator("#facts li").first.wait_for()
    page.get_by_role("link", name="results", exact=True).click()
    page.locator(".episodes tbody tr").nth(1).wait_for()
    page.locator("#facts", has_text="2 episodes").wait_for()
    assert shown.complaints == []


def test_wrong_values_are_told_and_nothing_starts(show: Callable[..., Any], studio: Any) -> None:
    page = show("run").page
    page.get_by_label("episodes", exact=True).fill("many")
    page.get_by_label("seed", exact=True).focus()
    page.locator("#verdict.bad", has_text="episodes is 'many'; allowed: a whole number").wait_for()
    page.locator("[aria-invalid=true]").and_(page.get_by_label("episodes", exact=True)).wait_for()
    page.get_by_label("episodes", exact=True).fill("")
    page.get_by_label("more words of the command line").fill("planer=dwa")
    page.get_by_text("did you mean planner").wait_for()
    page.get_by_role("button", name="Start", disabled=True).wait_for()
    assert not (studio.folder / ".arena_studio").exists()


def test_parameters_of_an_option_are_fields_with_unit_and_bounds(show: Callable[..., Any]) -> None:
    page = show("run").page
    page.get_by_label("planner", exact=True).select_option("teb")
    page.get_by_label("planner teb: parameters").click()
    field = page.get_by_label("limits.max_vel_x [m/s]", exact=True)
    field.wait_for()
    page.locator(".group .hint", has_text="fastest forwards").filter(has_text="allowed: > 0").wait_for()
    field.fill("0.7")
    field.blur()
    page.locator("#command").filter(has_text="planner.limits.max_vel_x=0.7").wait_for()


def test_results_are_filtered_sorted_compared_and_kept_over_a_reload(
    show: Callable[..., Any], studio: Any, write_run: Any
) -> None:
    write_run(studio.folder / "multirun/0", "dwa", 60)
    write_run(studio.folder / "multirun/1", "teb", 60)
    shown = show("results")
    page, rows = shown.page, shown.page.locator(".episodes tbody tr")
    page.locator("#facts", has_text="120 episodes").wait_for()
    shown.until(rows.count, 50)
    page.locator('[data-column="preset"] [data-value="teb"]').check()
    page.locator("#facts", has_text="60 episodes").wait_for()
    page.get_by_label("look for").fill("timeout")
    page.locator("#facts", has_text="20 episodes").wait_for()
    page.locator('th [data-column="time_to_goal"]').click()
    page.locator('th[aria-sort="ascending"]').wait_for()
    page.locator('th [data-column="time_to_goal"]').click()
    page.locator('th[aria-sort="descending"]').wait_for()
    rows.first.filter(has_text="multirun/1").filter(has_text="teb").wait_for()
    page.reload()
    page.locator('th[aria-sort="descending"]').wait_for()
    shown.until(rows.count, 20)
    page.locator('[data-column="preset"] [data-value="teb"]').uncheck()
    page.get_by_label("look for").fill("")
    page.locator("#facts", has_text="120 episodes").wait_for()
    page.get_by_role("button", name="Compare planners").click()
    page.locator(".compared tbody tr").first.wait_for()
    page.locator(".compared tbody", has_text="teb − dwa").wait_for()
    with page.expect_download() as saved:
        page.get_by_role("button", name="Export CSV").click()
    assert len(Path(saved.value.path()).read_text().splitlines()) == 121
    assert shown.complaints == []


def test_run_that_vanishes_is_told_in_the_page(show: Callable[..., Any], studio: Any, write_run: Any) -> None:
    write_run(studio.folder / "a", "dwa", 3)
    write_run(studio.folder / "b", "teb", 3)
    shown = show("results")
    page = shown.page
    page.locator("#facts", has_text="6 episodes").wait_for()
    shutil.rmtree(studio.folder / "b")
    page.get_by_text("b: the run is gone, with 3 episodes").wait_for()
    shown.until(page.locator(".episodes tbody tr").count, 3)


def test_pages_fit_their_window_and_say_when_the_studio_is_gone(show: Callable[..., Any], studio: Any) -> None:
    windows = [(place, width, show(place, width)) for place in ("run", "results") for width in (1280, 820)]
    for place, width, shown in windows:
        shown.page.locator("#verdict, #facts").first.wait_for()
        wide = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        assert shown.page.evaluate(wide) <= 0, (place, width)
    studio.kill()
    for place, _, shown in windows:
        gone = "no connection to the studio" if place == "run" else "the studio does not answer"
        shown.page.get_by_text(gone).wait_for()
