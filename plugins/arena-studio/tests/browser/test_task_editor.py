"""The task editor in a browser: curricula, rules with draws, packs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
import yaml

from arena_tasks.random.curriculum import read_curriculum
from arena_tasks.scenario_files.pack import read_pack

pytestmark = pytest.mark.browser
PATIENT = 280_000  # ms; what draws is compiled the first time


def test_a_curriculum_is_made_from_one_that_comes_with_the_suite(show: Callable[..., Any], studio: Any) -> None:
    shown = show("task?part=curriculum&path=growing")
    page = shown.page
    page.locator(".levels tbody tr").nth(11).wait_for()
    path = studio.folder / "curricula" / "growing.yaml"
    page.fill("input[aria-label='people of level 3']", "-4")
    page.keyboard.press("Tab")
    page.locator(".wrong li", has_text="levels.3.pedestrians is -4; allowed: a whole number 0").wait_for()
    assert not path.exists()
    page.fill("input[aria-label='people of level 3']", "9")
    page.keyboard.press("Tab")
    page.click("button:has-text('Add a level')")
    page.locator(".state", has_text="saved").wait_for()
    page.locator(".wrong li").wait_for(state="detached")
    shown.until(path.is_file, True)
    shown.until(lambda: len(read_curriculum(str(path)).levels), 13)
    assert read_curriculum(str(path)).levels[3].pedestrians == 9
    page.locator(".plots svg").nth(4).wait_for()


def test_rules_of_a_staged_task_are_on_its_command_line_and_kept_as_an_option(
    show: Callable[..., Any], studio: Any
) -> None:
    shown = show("task?part=curriculum&path=growing")
    page = shown.page
    page.locator(".levels tbody tr").nth(11).wait_for()
    page.locator(".rule", has_text="promote").locator("input").fill("0.9")
    page.locator("summary", has_text="What the levels leave open").click()
    page.locator(".rule", has_text="goal radius").locator("input").fill("0.5")
    page.keyboard.press("Tab")
    page.locator("code", has_text="task.promote=0.9 task.random.goal_radius=0.5").wait_for()
    page.click("button:has-text('Add a level')")
    page.locator(".state", has_text="saved").wait_for()
    page.click("button:has-text('Keep as an option')")
    page.fill("dialog input", "harder")
    page.keyboard.press("Enter")
    page.locator("#said", has_text="conf/task/harder.yaml").wait_for()
    said = yaml.safe_load((studio.folder / "conf" / "task" / "harder.yaml").read_text())
    assert (said["path"], said["promote"], said["random"]) == ("curricula/growing.yaml", 0.9, {"goal_radius": 0.5})
    assert shown.complaints == []


def test_rules_draw_ten_scenes_and_become_a_scenario_file(show: Callable[..., Any], studio: Any) -> None:
    shown = show("task?part=rules")
    page = shown.page
    page.locator(".rule", has_text="pedestrians").first.wait_for()
    page.get_by_label("world or map").select_option("map:maps/hall/map.yaml")
    page.locator(".rule", has_text="pedestrians").first.locator("input").fill("3")
    page.locator("fieldset:has(legend:text-is('trip'))").locator("input").first.fill("4")
    page.keyboard.press("Tab")
    page.locator("code", has_text="task.pedestrians=3 task.trip.min_distance=4").wait_for()
    page.click("button:has-text('Draw ten')")
    page.locator(".draws figure").nth(9).wait_for(timeout=PATIENT)
    page.locator("figcaption", has_text="3 people").nth(9).wait_for()
    page.click("button:has-text('Keep as a scenario file')")
    page.locator("[role=tab]").nth(9).wait_for()
    assert (studio.folder / "scenarios" / "random.json").is_file()
    assert shown.complaints == []


def test_files_become_a_pack(show: Callable[..., Any], studio: Any) -> None:
    page = show("task?part=packs").page
    page.check(".files label:has-text('hall_obs03.json') input")
    page.click("button:has-text('Make the pack')")
    page.locator("#said", has_text="scenario=mine/hall_obs03").wait_for()
    assert read_pack(studio.folder / "packs" / "mine").scenario_files() == ["scenarios/hall_obs03.json"]
    page.click("a:has-text('scenarios/hall_obs03.json')")
    page.locator("summary:has-text('can be run')").wait_for()
