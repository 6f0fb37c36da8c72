"""Every page of the studio, light and dark, as axe judges it, with all that can be unfolded unfolded."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

pytestmark = pytest.mark.browser
MAP, SCENARIO = "document.querySelector('.page.map')", "document.querySelector('.page.scenario')"
SCENE = "scenarios/hall_obs03.json"
UNFOLD = "document.querySelectorAll('details').forEach((one) => { one.open = true; })"


@pytest.fixture
def studio(studio: Any, write_run: Any) -> Any:
    """Return a studio of runs of two planners."""
    for preset in ("dwa", "teb"):
        write_run(studio.folder / preset, preset, 60)
    return studio


def judge(shown: Any) -> dict[str, list[str]]:
    """Return what axe finds in each of the schemes, where it finds anything."""
    found = {}
    for scheme in ("light", "dark"):
        shown.page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        if violations := shown.violations:
            found[scheme] = violations
    return found


def test_run(show: Callable[..., Any]) -> None:
    shown = show("run")
    page = shown.page
    page.locator("#command:not(:empty)").wait_for()
    page.get_by_label("planner", exact=True).select_option("teb")
    page.get_by_label("planner teb: parameters").click()
    page.get_by_label("limits.max_vel_x [m/s]", exact=True).wait_for()
    assert judge(shown) == {}


def test_results_with_a_comparison(show: Callable[..., Any]) -> None:
    shown = show("results")
    page = shown.page
    page.locator(".episodes tbody tr").first.wait_for()
    page.get_by_role("button", name="Compare planners").click()
    page.locator(".compared tbody tr").first.wait_for()
    assert judge(shown) == {}


def test_maps_with_every_panel(show: Callable[..., Any]) -> None:
    shown = show("map?path=maps/hall/map.yaml")
    shown.wait(f"{MAP}?.editor?.map?.header.path === 'maps/hall/map.yaml'")
    shown.page.evaluate(UNFOLD)
    shown.page.get_by_label("kind", exact=True).wait_for()
    shown.page.get_by_role("button", name="Measure", exact=True).click()
    shown.page.locator(".measures tr").first.wait_for()
    shown.page.evaluate(UNFOLD)
    shown.page.keyboard.press("m")
    shown.drag(f"{MAP}.editor.view", (2.0, 2.0), (5.0, 2.0))
    assert judge(shown) == {}


def test_scenarios_with_a_person_chosen_and_the_export_dialog(show: Callable[..., Any]) -> None:
    shown = show(f"scenario?path={SCENE}")
    page = shown.page
    shown.wait(f"{SCENARIO}?.editor?.checking === 'checked'")
    page.locator(".things button", has_text="Person 0").click()
    page.evaluate(UNFOLD)
    assert judge(shown) == {}
    page.locator(".things button", has_text="Start").click()
    page.evaluate(UNFOLD)
    assert judge(shown) == {}
    page.click("button:has-text('Export')")
    page.locator("dialog[open]").wait_for()
    assert judge(shown) == {}


@pytest.mark.parametrize(
    ("place", "ready"),
    [("part=curriculum&path=growing", ".levels tbody tr"), ("part=rules", ".rule"), ("part=packs", ".files label")],
)
def test_tasks(show: Callable[..., Any], place: str, ready: str) -> None:
    shown = show(f"task?{place}")
    shown.page.locator(ready).first.wait_for()
    shown.page.evaluate(UNFOLD)
    assert judge(shown) == {}


def test_pages_without_a_file(show: Callable[..., Any]) -> None:
    for place, ready in (("map", ".page.map .empty"), ("scenario", ".page.scenario .empty"), ("task", ".parts")):
        shown = show(place)
        shown.page.locator(ready).first.wait_for()
        assert judge(shown) == {}, place


def test_curves_of_a_tuning_a_ladder_and_a_training(show: Callable[..., Any], studio: Any, curve_folders: Any) -> None:
    curve_folders.write_training(studio.folder / "trainings/rosnav")
    curve_folders.write_tuning(studio.folder / "tunings/teb")
    curve_folders.write_card(studio.folder / "tunings/teb")
    curve_folders.end_ladder(studio.folder / "ladder", curve_folders.ladder_facts("dwa", limit=True))
    for path, chart in (("trainings/rosnav", "Reward"), ("tunings/teb", "best"), ("ladder", "hall_slow")):
        shown = show(f"curves?path={path}")
        shown.page.locator(f"[data-chart={chart}]").wait_for()
        shown.page.evaluate(UNFOLD)
        assert judge(shown) == {}, path
