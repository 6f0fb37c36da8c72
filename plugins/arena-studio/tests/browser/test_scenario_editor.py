"""The scenario editor in a browser: what is placed is in the file, what is wrong is told and
can be mended, and a run reads it.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from arena_tasks.commands.packing import ANYBODY
from arena_tasks.scenario_files.scenario_file import read_scenario_file

pytestmark = pytest.mark.browser
PAGE = "document.querySelector('.page.scenario')"
EDITOR = f"{PAGE}.editor"
SAVED = f"{EDITOR}.autosave.state === 'saved' && !{EDITOR}.autosave.unsaved && !{EDITOR}.autosave.running"
CHECKED = f"{EDITOR}.checking === 'checked'"
PATH = "scenarios/straight.json"
PATIENT = 280_000  # ms; the first preview compiles what it uses
WATCHED = """(() => {
    const canvas = document.querySelector("canvas");
    const place = () => JSON.stringify(canvas.getBoundingClientRect());
    const before = place();
    window.moves = [];
    new ResizeObserver(() => before === place() || window.moves.push(place())).observe(canvas);
})()"""
SCENE = {"name": "a", "start": [1.0, 4.0, 0.0], "goal": [11.0, 4.0]}
FILE = {
    "format": "arena-scenario",
    "version": 2,
    "map": "../maps/hall/map.yaml",
    "scenarios": [SCENE, {**SCENE, "name": "b"}],
}


@pytest.fixture
def straight(studio: Any) -> Path:
    """Write a file with two scenes into the project."""
    path: Path = studio.folder / PATH
    path.write_text(json.dumps(FILE))
    return path


def opened(show: Callable[..., Any], path: str = PATH) -> Any:
    """Return a window in which a scenario file is open and checked."""
    shown = show(f"scenario?path={path}")
    shown.wait(f"!!({PAGE} && {EDITOR}?.content && {EDITOR}.ground)")
    shown.wait(CHECKED)
    return shown


def go(shown: Any, x: float, y: float) -> None:
    """Move the pointer to a point of the scene, m."""
    shown.go(f"{PAGE}.view", (x, y))


def drag(shown: Any, *points: tuple[float, float]) -> None:
    """Press at the first point of the scene, m, move over the others and let go."""
    shown.drag(f"{PAGE}.view", *points)


def settle(shown: Any) -> None:
    """Wait until what is shown is saved and checked."""
    shown.wait(SAVED)
    shown.wait(CHECKED)


def problems(path: Path) -> Any:
    """Return the problems of a file as the suite reads them."""
    return read_scenario_file(path, ANYBODY).problems


def test_a_person_with_a_route_is_placed_checked_mended_previewed_saved_and_run(
    show: Callable[..., Any], studio: Any, straight: Path
) -> None:
    shown = opened(show)
    page = shown.page
    page.locator("summary:has-text('can be run')").wait_for()
    page.click("[data-tool=person]")
    page.uncheck("text=free ground")
    for place in ((3.0, 6.0), (6.0, 6.0), (6.0, 4.0)):  # the last waypoint lies in the pillar
        go(shown, *place)
        page.wait_for_timeout(400)  # apart from a double click
        page.mouse.down()
        page.mouse.up()
    page.keyboard.press("Escape")
    page.locator(".findings li", has_text="Person 0: its waypoint 1 lies inside a wall or an obstacle").wait_for()
    page.click("[data-tool=choose]")
    drag(shown, (6.0, 4.0), (7.0, 5.0), (9.0, 6.0))
    page.locator("summary:has-text('can be run')").wait_for()
    settle(shown)
    (person,) = problems(straight)[0].pedestrians
    assert person.position_xy.tolist() == [3.0, 6.0]
    assert person.waypoints_xy.tolist() == [[6.0, 6.0], [9.0, 6.0]]
    page.select_option(".preview label:has-text('for, s') select", "10")
    page.click("button:has-text('Preview')")
    page.locator("input[aria-label='time of the preview, s']").wait_for(timeout=PATIENT)
    shown.page.keyboard.press("Escape")
    assert shown.complaints == []
    words = [
        f"task.path={straight}",
        "world=scenario_map",
        "planner=pure_pursuit",
        "robot=turtlebot3",
        "task.time_limit=5",
        "report=false",
    ]
    command = [
        sys.executable,
        "-m",
        "arena_core.cli.main",
        "run",
        "task=scenario",
        *words,
        "episodes=1",
        "executor=serial",
    ]
    run = subprocess.run(command, cwd=studio.folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_the_preview_plays_people_on_legs_and_beams_as_the_viewer_draws_them(
    show: Callable[..., Any], straight: Path
) -> None:
    person = {"position": [6.0, 6.0], "waypoints": [[6.0, 6.0], [9.0, 6.0]]}
    straight.write_text(json.dumps({**FILE, "scenarios": [{**SCENE, "pedestrians": [person]}]}))
    shown = opened(show)
    page = shown.page
    page.emulate_media(reduced_motion="reduce")
    page.check("label:has-text('legs') input")
    page.select_option(".preview label:has-text('for, s') select", "10")
    page.click("button:has-text('Preview')")
    page.locator("input[aria-label='time of the preview, s']").wait_for(timeout=PATIENT)
    page.evaluate(f"{PAGE}.preview.player.seek(2)")
    moment = f"{PAGE}.preview.scene.episodes[0].at(2)"
    assert page.evaluate(f"{moment}.people[0].legs.length") == 5
    assert page.evaluate(f"{moment}.path.length") > 1
    picture = f"({PAGE}.view.draw(), document.querySelector('canvas').toDataURL())"
    with_beams = page.evaluate(picture)
    page.uncheck("label:has-text('lidar') input")
    assert page.evaluate(picture) != with_beams
    page.click(".preview button:has-text('Play')")
    shown.wait(f"{PAGE}.preview.player.time > 2.2")
    page.click("button:has-text('End preview')")
    assert page.evaluate(f"{PAGE}.preview.scene") is None
    assert shown.complaints == []


def test_things_are_moved_removed_and_come_back(show: Callable[..., Any], straight: Path) -> None:
    shown = opened(show)
    page = shown.page
    page.evaluate(WATCHED)
    drag(shown, (1.0, 4.0), (1.5, 5.0), (2.0, 6.0))
    settle(shown)
    page.click("[data-tool=disc]")
    drag(shown, (4.0, 2.0), (4.4, 2.0))
    page.click("[data-tool=start]")
    drag(shown, (2.0, 6.0), (2.0, 5.0))
    page.click("[data-tool=goal]")
    go(shown, 10.0, 6.5)
    page.mouse.down()
    page.mouse.up()
    settle(shown)
    scene = problems(straight)[0]
    assert scene.start.array().tolist() == [2.0, 6.0, -1.571]
    assert scene.goal.array().tolist()[:2] == [10.0, 6.5]
    assert scene.obstacles[0].radius == pytest.approx(0.4, abs=0.02)
    assert page.evaluate("window.moves") == [], "the picture moved under the hand"
    page.click(".things button:has-text('Disc 0')")
    page.click("[data-tool=choose]")
    page.keyboard.press("Delete")
    settle(shown)
    assert problems(straight)[0].obstacles == ()
    page.keyboard.press("Control+z")
    settle(shown)
    assert len(problems(straight)[0].obstacles) == 1


def test_the_keyboard_alone_places_a_person_and_its_zone_and_changes_its_fields(
    show: Callable[..., Any], straight: Path
) -> None:
    shown = opened(show)
    page = shown.page
    page.locator("canvas").focus()
    page.keyboard.press("p")
    click = ("Enter", "Enter")  # presses, and lets go
    for key in (
        "ArrowRight",
        "ArrowUp",
        *click,
        *["ArrowUp"] * 3,
        *click,
        "Escape",
        "z",
        "Enter",
        *["ArrowRight"] * 6,
        "Enter",
    ):
        page.keyboard.press(key)
    page.select_option("select[data-entry=type]", "child")
    page.fill("input[data-entry=speed]", "0.7")
    page.keyboard.press("Tab")
    page.fill("input[data-entry=speed]", "-1")
    page.keyboard.press("Tab")
    settle(shown)
    (person,) = problems(straight)[0].pedestrians
    assert len(person.waypoints_xy) == 1
    assert person.desired_speed == 0.7
    assert person.behaviour["type"] == "child"
    assert person.behaviour["start_up_mode"] == "trigger_zone"
    assert person.behaviour["trigger_zone_radius"] >= 0.2


def test_scenes_are_tabs_and_a_fault_in_another_scene_is_told(show: Callable[..., Any], straight: Path) -> None:
    shown = opened(show)
    page = shown.page
    page.click("[role=tab]:has-text('b')")
    page.click("button:has-text('copy')")
    page.fill("input[data-entry=name]", "c")
    page.keyboard.press("Tab")
    page.click(".things button:has-text('Goal')")
    page.fill("input[data-entry=x]", "99")
    page.keyboard.press("Tab")
    settle(shown)
    assert [problem.name for problem in problems(straight)] == ["a", "b", "c"]
    page.click("[role=tab]:has-text('a')")
    page.click(".findings button:has-text('c: Goal: lies outside the map')")
    page.locator("[role=tab][aria-selected=true]", has_text="c").wait_for()
    page.click(".scenes button:has-text('remove')")
    settle(shown)
    assert [problem.name for problem in problems(straight)] == ["a", "b"]


def test_a_file_of_another_program_goes_on_as_a_file_of_ours(show: Callable[..., Any], studio: Any) -> None:
    shown = opened(show, "scenarios/hall_obs03.json")
    before = (studio.folder / "scenarios" / "hall_obs03.json").read_bytes()
    shown.page.click(".things button:has-text('Person 0')")
    shown.page.fill("input[data-entry=group]", "friends")
    shown.page.keyboard.press("Tab")
    settle(shown)
    assert (studio.folder / "scenarios" / "hall_obs03.json").read_bytes() == before
    ours = problems(studio.folder / "scenarios" / "hall_obs03.arena.json")
    assert ours[0].pedestrians[0].behaviour["group"] == "friends"


def test_two_windows_on_one_file_overwrite_nothing(show: Callable[..., Any], straight: Path) -> None:
    first, second = opened(show), opened(show)
    for shown, name in ((first, "mine"), (second, "yours")):
        shown.page.fill("input[data-entry=name]", name)
        shown.page.keyboard.press("Tab")
        if shown is first:
            settle(shown)
    second.page.locator("dialog[open]").wait_for()
    assert problems(straight)[0].name == "mine"
    second.page.click("dialog button:has-text('Keep mine as a copy')")
    settle(second)
    assert problems(straight)[0].name == "mine"
    assert problems(straight.with_name("straight.mine.json"))[0].name == "yours"


def test_a_scene_is_written_for_another_program(show: Callable[..., Any], studio: Any, straight: Path) -> None:
    shown = opened(show)
    shown.page.click("button:has-text('Export')")
    shown.page.click("dialog button:has-text('arena-rosnav')")
    shown.page.locator("#said", has_text="straight.arena-rosnav.json").wait_for()
    assert problems(studio.folder / "scenarios" / "straight.arena-rosnav.json")[0].goal.x == 11.0
