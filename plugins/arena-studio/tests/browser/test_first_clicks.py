"""A click on a button beside a field that is still being typed in does what the button says, with what was typed."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest
import yaml

pytestmark = pytest.mark.browser
QUICK = "world=empty pedestrians=none task.time_limit=5 report=false executor=serial"
PAGE = "document.querySelector('.page.scenario')"
PERSON = {"position": [3.0, 4.0], "radius": 0.3, "waypoints": [[4.0, 4.0]]}
SCENE = {"name": "a", "start": [1.0, 4.0, 0.0], "goal": [11.0, 4.0], "pedestrians": [PERSON]}


def press(page: Any, button: Any) -> None:
    """Press a button as a hand does: down and, a moment later, up at the same place; nothing is waited for before."""
    box = button.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.wait_for_timeout(90)
    page.mouse.up()


@pytest.mark.parametrize("label", ["episodes", "seed", "folder of the run"])
def test_first_click_on_start_starts_what_was_typed(show: Callable[..., Any], studio: Any, label: str) -> None:
    page = show("run").page
    page.get_by_label("planner", exact=True).select_option("pure_pursuit")
    page.get_by_label("more words of the command line").fill(QUICK)
    page.get_by_label("episodes", exact=True).fill("1")
    page.get_by_text("every value is allowed").wait_for()
    page.get_by_label(label, exact=True).click()
    page.get_by_label(label, exact=True).press_sequentially("2")
    press(page, page.get_by_role("button", name="Start"))
    page.locator(".experiment").wait_for()
    (note,) = (studio.folder / ".arena_studio" / "runs").glob("*.json")
    said = json.loads(note.read_text())
    typed = {
        "episodes": said["episodes"] == 12,
        "seed": "seed=2" in said["words"],
        "folder of the run": said["folder"] == "2",
    }
    assert typed[label], said


def test_start_after_a_mistake_was_mended_needs_one_click_and_a_wrong_one_says_why(
    show: Callable[..., Any], studio: Any
) -> None:
    page = show("run").page
    page.get_by_label("planner", exact=True).select_option("pure_pursuit")
    page.get_by_label("more words of the command line").fill(QUICK)
    page.get_by_label("episodes", exact=True).fill("many")
    page.locator("#verdict.bad").wait_for()
    press(page, page.get_by_role("button", name="Start"))
    page.locator("#said, #wrong").filter(has_text="episodes is 'many'").first.wait_for()
    assert not (studio.folder / ".arena_studio").exists()
    page.get_by_label("episodes", exact=True).fill("1")
    press(page, page.get_by_role("button", name="Start"))
    page.locator(".experiment").wait_for()


def test_buttons_beside_fields_of_a_person_do_what_they_say(show: Callable[..., Any], studio: Any) -> None:
    path = studio.folder / "scenarios/straight.json"
    path.write_text(
        json.dumps({"format": "arena-scenario", "version": 2, "map": "../maps/hall/map.yaml", "scenarios": [SCENE]})
    )
    shown = show("scenario?path=scenarios/straight.json")
    page = shown.page
    shown.wait(f"!!({PAGE} && {PAGE}.editor?.content && {PAGE}.editor.ground)")
    page.locator(".things button", has_text="person").first.click()
    person = f"{PAGE}.editor.scene.pedestrians[0]"
    page.locator("[data-entry=radius]").fill("0.45")
    press(page, page.get_by_role("button", name="Add a waypoint"))
    shown.until(lambda: page.evaluate(f"[{person}.radius, {person}.waypoints.length]"), [0.45, 2])
    page.locator("[data-entry=radius]").fill("0.35")
    press(page, page.get_by_role("button", name="remove waypoint 0"))
    shown.until(lambda: page.evaluate(f"[{person}.radius, {person}.waypoints]"), [0.35, [[5, 4]]])


def test_buttons_beside_fields_of_a_level_do_what_they_say(show: Callable[..., Any], studio: Any) -> None:
    shown = show("task?part=curriculum&path=growing")
    page = shown.page
    rows = page.locator(".levels tbody tr")
    rows.nth(11).wait_for()
    page.fill("input[aria-label='people of level 3']", "9")
    press(page, page.get_by_label("insert after level 3"))
    rows.nth(12).wait_for()
    people = [page.locator(f"input[aria-label='people of level {at}']") for at in (3, 4)]
    shown.until(lambda: [field.input_value() for field in people], ["9", "9"])
    kept = studio.folder / "curricula" / "growing.yaml"
    shown.until(lambda: kept.is_file() and len(yaml.safe_load(kept.read_text())["levels"]), 13)


def test_comparison_asks_for_the_words_that_were_just_typed(
    show: Callable[..., Any], studio: Any, write_run: Any
) -> None:
    write_run(studio.folder / "multirun/0", "dwa", 6)
    write_run(studio.folder / "multirun/1", "teb", 6)
    page = show("results").page
    page.locator("#facts", has_text="12 episodes").wait_for()
    page.get_by_label("look for").fill("no such words")
    press(page, page.get_by_role("button", name="Compare planners"))
    page.locator(".compared .bad", has_text="no run has such an episode").wait_for()


def test_a_scenario_file_is_run_from_its_editor(show: Callable[..., Any], studio: Any) -> None:
    path = studio.folder / "scenarios/straight.json"
    path.write_text(
        json.dumps({"format": "arena-scenario", "version": 2, "map": "../maps/hall/map.yaml", "scenarios": [SCENE]})
    )
    shown = show("scenario?path=scenarios/straight.json")
    shown.wait(f"!!({PAGE} && {PAGE}.editor?.content && {PAGE}.editor.ground)")
    page = shown.page
    page.get_by_role("button", name="Run", exact=True).click()
    page.locator("#verdict", has_text="1 episode; every value is allowed").wait_for()
    for word in (
        "task=scenario",
        "task.path=scenarios/straight.json",
        "world=ros_map",
        "world.path=maps/hall/map.yaml",
    ):
        page.locator("#command", has_text=word).wait_for()
    page.reload()
    page.locator("#command", has_text="task.path=scenarios/straight.json").wait_for()


def test_map_stays_where_it_is_when_a_preview_begins_and_ends(show: Callable[..., Any], studio: Any) -> None:
    path = studio.folder / "scenarios/straight.json"
    path.write_text(
        json.dumps({"format": "arena-scenario", "version": 2, "map": "../maps/hall/map.yaml", "scenarios": [SCENE]})
    )
    shown = show("scenario?path=scenarios/straight.json")
    shown.wait(f"!!({PAGE} && {PAGE}.editor?.content && {PAGE}.editor.ground)")
    shown.wait(f"{PAGE}.editor.checking === 'checked'")
    page = shown.page
    box = "document.querySelector('canvas').getBoundingClientRect()"
    place = (
        f"((box, at) => [box.left + at[0], box.top + at[1], box.width, box.height])({box}, {PAGE}.view.over([3, 4]))"
    )
    before = page.evaluate(place)
    page.get_by_role("button", name="Preview").click()
    during = page.evaluate(place)
    shown.wait("!!document.querySelector('.preview input[type=range]:not([hidden]), input[type=range]:not([hidden])')")
    after = page.evaluate(place)
    assert during == before
    assert after == before
