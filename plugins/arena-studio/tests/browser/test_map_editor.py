"""The map editor in a browser: what is drawn is in the file, and what happens to the file is told."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from arena_tasks.commands.packing import ANYBODY
from arena_tasks.scenario_files.scenario_file import read_scenarios
from arena_worlds.formats.ros_map import load_map

pytestmark = pytest.mark.browser
EDITOR = "document.querySelector('.page.map')?.editor"
OPEN = f"{EDITOR}?.map?.header.path"
SAVED = f"(({{ state, unsaved, running }}) => state === 'saved' && !unsaved && !running)({EDITOR}.map.autosave)"
HALL = "maps/hall/map.yaml"


def opened(show: Callable[..., Any], path: str = HALL) -> Any:
    """Return a window in which a map is open."""
    shown = show(f"map?path={path}")
    shown.wait(f"{OPEN} === '{path}'")
    return shown


def drag(shown: Any, *points: tuple[float, float]) -> None:
    """Press at the first point of the map, m, move over the others and let go."""
    shown.drag(f"{EDITOR}.view", *points)


def value_at(folder: Path, x: float, y: float, path: str = HALL) -> int:
    """Return what the suite reads at a point of a map, m."""
    grid = load_map(folder / path)
    row, column = grid.cells([x, y])
    return int(grid.data[row, column])


def test_a_wall_that_is_drawn_is_read_by_the_suite_and_there_after_a_reload(
    show: Callable[..., Any], studio: Any
) -> None:
    before = np.array(load_map(studio.folder / HALL).data)
    shown = opened(show)
    drag(shown, (2.0, 6.0), (4.0, 6.0))
    shown.wait(SAVED)
    grid = load_map(studio.folder / HALL)
    changed = np.argwhere(grid.data != before)
    assert changed.min(axis=0).tolist() == [59, 19]
    assert changed.max(axis=0).tolist() == [60, 40]
    assert (grid.data[59:61, 19:41] == 100).all()
    shown.page.reload()
    shown.wait(f"{OPEN} === '{HALL}'")
    assert (
        shown.page.evaluate(f"(() => {{ const {{ grid }} = {EDITOR}.map; return grid.at(30, grid.height - 60); }})()")
        == 0
    )
    assert shown.complaints == []


def test_every_tool_draws_and_undo_brings_back_every_byte(show: Callable[..., Any], studio: Any) -> None:
    image = studio.folder / "maps" / "hall" / "map.pgm"
    before = image.read_bytes()
    shown = opened(show)
    page = shown.page
    for key, points, where in (
        ("l", [(1.0, 2.0), (3.0, 2.5)], (2.0, 2.25)),
        ("r", [(6.0, 1.0), (7.0, 2.0)], (6.0, 1.5)),
        ("b", [(9.0, 6.0), (10.0, 6.5)], (9.5, 6.25)),
        ("f", [(0.55, 4.0)], (3.0, 3.0)),
    ):
        page.keyboard.press(key)
        drag(shown, *points)
        shown.wait(SAVED)
        assert value_at(studio.folder, *where) == 100, key
    page.keyboard.press("e")
    drag(shown, (3.0, 3.0), (3.5, 3.0))
    page.keyboard.press("p")
    page.keyboard.press("3")
    for corner in ((8.0, 4.0), (9.0, 4.0), (9.0, 5.0), (8.0, 4.0)):
        drag(shown, corner)
    shown.wait(SAVED)
    assert value_at(studio.folder, 3.2, 3.0) == 0
    assert value_at(studio.folder, 8.5, 4.0) == -1
    while page.get_by_role("button", name="Undo").is_enabled():
        page.keyboard.press("Control+z")
    shown.wait(SAVED)
    assert image.read_bytes() == before
    assert shown.complaints == []


def test_the_keyboard_alone_draws_a_wall(show: Callable[..., Any], studio: Any) -> None:
    shown = opened(show)
    page = shown.page
    page.locator("canvas").focus()
    page.keyboard.press("w")
    page.keyboard.press("ArrowRight")
    x, y = page.evaluate(f"{EDITOR}.view.cross")
    page.keyboard.press("Enter")
    for _ in range(10):
        page.keyboard.press("ArrowUp")
    page.keyboard.press("Enter")
    shown.wait(f"{EDITOR}.map.history.canUndo")
    shown.wait(SAVED)
    assert value_at(studio.folder, x, y + 0.5) == 100


def test_two_windows_on_one_map_are_told_and_both_drawings_are_kept(show: Callable[..., Any], studio: Any) -> None:
    first, second = opened(show), opened(show)
    drag(first, (2.0, 6.0), (4.0, 6.0))
    first.wait(SAVED)
    drag(second, (2.0, 3.0), (4.0, 3.0))
    second.page.get_by_role("button", name="Keep mine as a copy").click()
    second.wait(f"{OPEN} === 'maps/hall/map_2.yaml'")
    second.wait(SAVED)
    copy = "maps/hall/map_2.yaml"
    assert [value_at(studio.folder, 3.0, 6.0), value_at(studio.folder, 3.0, 3.0)] == [100, 0]
    assert [value_at(studio.folder, 3.0, 6.0, copy), value_at(studio.folder, 3.0, 3.0, copy)] == [0, 100]


def test_the_other_version_can_be_loaded_instead(show: Callable[..., Any], studio: Any) -> None:
    first, second = opened(show), opened(show)
    drag(first, (2.0, 6.0), (4.0, 6.0))
    first.wait(SAVED)
    drag(second, (2.0, 3.0), (4.0, 3.0))
    second.page.get_by_role("button", name="Load the other version").click()
    second.wait(f"{EDITOR}.map.grid.at(30, {EDITOR}.map.grid.height - 60) === 0")
    drag(second, (6.0, 6.0), (7.0, 6.0))
    second.wait(SAVED)
    assert [value_at(studio.folder, x, y) for x, y in ((3.0, 6.0), (3.0, 3.0), (6.5, 6.0))] == [100, 0, 100]


def test_a_killed_server_costs_nothing_once_it_is_back(show: Callable[..., Any], studio: Any) -> None:
    shown = opened(show)
    studio.kill()
    drag(shown, (2.0, 6.0), (4.0, 6.0))
    shown.wait("document.querySelector('.state').textContent.includes('does not answer')")
    studio.start()
    other = shown.page.context.new_page()
    other.goto(studio.address)  # its token is a new one
    shown.wait(SAVED)
    assert value_at(studio.folder, 3.0, 6.0) == 100


def test_what_is_drawn_is_on_disk_within_a_second(show: Callable[..., Any], studio: Any) -> None:
    shown = opened(show)
    drag(shown, (2.0, 6.0), (4.0, 6.0))
    began = time.monotonic()
    shown.wait(SAVED)
    # a figure for whoever reads; a busy machine decides nothing
    print(f"saved {time.monotonic() - began:.2f} s after the stroke")
    studio.kill()
    assert value_at(studio.folder, 3.0, 6.0) == 100


def test_of_two_maps_the_one_that_was_chosen_last_is_open_even_if_the_other_comes_later(
    show: Callable[..., Any], studio: Any
) -> None:
    (studio.folder / "maps" / "other.yaml").write_text(
        (studio.folder / HALL).read_text().replace("map.pgm", "hall/map.pgm")
    )
    shown = show("map")
    shown.wait(f"!!{EDITOR}")
    shown.page.evaluate(
        f"""(async () => {{
            const asked = window.fetch;
            window.late = 0;
            window.fetch = async (address, options) => {{
                const answer = await asked(address, options);
                if (String(address).includes("hall")) await new Promise((done) => setTimeout(done, 1000));
                return answer;
            }};
            const editor = {EDITOR};
            void editor.open("{HALL}").then(() => (window.late += 1));
            void editor.open("maps/other.yaml");
        }})()"""
    )
    shown.wait(f"window.late === 1 && {OPEN} === 'maps/other.yaml'")
    drag(shown, (2.0, 6.0), (4.0, 6.0))
    shown.wait(SAVED)
    assert [value_at(studio.folder, 3.0, 6.0, path) for path in ("maps/other.yaml", HALL)] == [100, 100], (
        "they share a picture"
    )
    assert shown.complaints == []


def test_a_new_map_is_an_empty_room_that_becomes_a_file_when_drawn_in(show: Callable[..., Any], studio: Any) -> None:
    shown = show("map")
    shown.page.get_by_role("button", name="New", exact=True).click()
    shown.wait(f"!!{EDITOR}?.map")
    drag(shown, (2.0, 12.0), (3.0, 12.0))
    shown.wait(f"{OPEN} === 'maps/empty_0.yaml'")
    shown.wait(SAVED)
    values = [value_at(studio.folder, x, 12.0, "maps/empty_0.yaml") for x in (2.5, 10.0)]
    assert values == [100, 0]


def test_a_generated_world_is_edited_measured_and_furnished(show: Callable[..., Any], studio: Any) -> None:
    shown = show("map")
    page = shown.page
    page.locator("summary", has_text="Generate").click()
    page.get_by_label("kind").select_option("rooms")
    page.get_by_role("button", name="Draw", exact=True).click()
    shown.wait(f"!!{EDITOR}?.map")
    drag(shown, (2.0, 12.0), (3.0, 12.0))
    shown.wait(f"{OPEN} === 'maps/rooms_0.yaml'")
    shown.wait(SAVED)
    assert value_at(studio.folder, 2.5, 12.0, "maps/rooms_0.yaml") == 100
    page.locator("summary", has_text="Measures").click()
    page.get_by_role("button", name="Measure").click()
    page.locator(".measures tr", has_text="beside walls").wait_for()
    page.locator("summary", has_text="Furniture").click()
    page.get_by_role("button", name="New scenario file").click()
    shown.wait(f"{EDITOR}.furniture.file !== null")
    page.get_by_label("to place").select_option("table")
    drag(shown, (5.0, 7.0))
    page.keyboard.press("[")
    drag(shown, (5.0, 7.0), (6.0, 7.0))
    shown.wait(f"{EDITOR}.furniture.autosave.state === 'saved' && !{EDITOR}.furniture.autosave.unsaved")
    (problem,) = read_scenarios(studio.folder / "maps" / "rooms_0_furnished.json", ANYBODY)
    (table,) = problem.furniture
    assert (table.kind, table.pose.x, table.pose.y) == ("table", pytest.approx(6.0), pytest.approx(7.0))
    assert table.pose.theta == pytest.approx(np.pi / 12, abs=1e-6)  # poses are kept to a millionth
    assert shown.complaints == []


def test_scale_and_origin_are_written(show: Callable[..., Any], studio: Any) -> None:
    shown = opened(show)
    page = shown.page
    page.locator("summary", has_text="Scale and origin").click()
    page.get_by_label("scale, m a cell").fill("0.25")
    page.get_by_label("x, m").fill("-3")
    page.get_by_label("y, m").focus()
    shown.wait(SAVED)
    shown.wait(f"{EDITOR}.map.history.done.length === 2")
    shown.wait(SAVED)
    grid = load_map(studio.folder / HALL)
    assert (grid.resolution, grid.origin.x) == (0.25, -3.0)


def test_a_map_is_cropped_and_enlarged_and_undo_brings_back_every_byte(show: Callable[..., Any], studio: Any) -> None:
    files = [studio.folder / "maps" / "hall" / name for name in ("map.pgm", "map.yaml")]
    before, grid = [file.read_bytes() for file in files], load_map(studio.folder / HALL)
    pillar = value_at(studio.folder, 6.0, 4.0)
    shown = opened(show)
    page = shown.page
    page.keyboard.press("x")
    drag(shown, (4.0, 2.0), (7.0, 4.0), (9.0, 7.0))
    shown.wait(SAVED)
    cropped = load_map(studio.folder / HALL)
    assert (cropped.data.shape, cropped.origin.x, cropped.origin.y) == ((50, 50), 4.0, 2.0)
    assert value_at(studio.folder, 6.0, 4.0) == pillar
    page.locator("summary", has_text="Size").click()
    page.get_by_label("left, m").fill("3")
    page.get_by_label("top, m").fill("-1")
    page.get_by_label("new cells are").select_option("occupied")
    page.get_by_role("button", name="Apply").click()
    shown.wait(SAVED)
    larger = load_map(studio.folder / HALL)
    assert (larger.data.shape, larger.origin.x, larger.origin.y) == ((40, 80), 1.0, 2.0)
    assert [value_at(studio.folder, x, 4.0) for x in (2.0, 6.0)] == [100, pillar]
    page.locator("canvas").focus()
    page.keyboard.press("w")
    drag(shown, (2.0, 5.0), (6.0, 5.0))
    shown.wait(SAVED)
    while page.get_by_role("button", name="Undo").is_enabled():
        page.keyboard.press("Control+z")
    shown.wait(SAVED)
    after = load_map(studio.folder / HALL)
    assert (after.data == grid.data).all()
    assert after.origin == grid.origin
    assert files[0].read_bytes() == before[0]
    assert shown.complaints == []


def test_a_damaged_map_is_told_in_one_line(show: Callable[..., Any], studio: Any) -> None:
    (studio.folder / "maps" / "hall" / "map.pgm").write_bytes(b"P5\n99 99\n255\nshort")
    shown = show(f"map?path={HALL}")
    shown.wait("document.querySelector('#wrong').textContent.includes('ends too early')")


def test_the_page_fits_its_window(show: Callable[..., Any]) -> None:
    wide = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
    too_wide = {}
    for width in (1280, 820, 390):
        shown = show(f"map?path={HALL}", width)
        shown.wait(f"{OPEN} === '{HALL}'")
        too_wide[width] = max(0, shown.page.evaluate(wide))
    assert too_wide == {1280: 0, 820: 0, 390: 0}
