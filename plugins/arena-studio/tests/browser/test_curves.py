"""The page Curves in chromium: a tuning, a ladder and a training as they run, what is damaged, a phone."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

pytestmark = pytest.mark.browser
PHONE = 390  # px
WIDE = "document.documentElement.scrollWidth - document.documentElement.clientWidth"


def test_a_tuning_is_shown_as_it_runs_and_once_it_has_ended(
    show: Callable[..., Any], studio: Any, curve_folders: Any
) -> None:
    curve_folders.write_tuning(studio.folder / "tunings/teb", budget=12)
    shown = show("curves")
    page = shown.page
    page.get_by_role("heading", name="teb on jackal").wait_for()
    page.locator(".state.running").wait_for()
    page.get_by_text("4 sets of values in 1 races").wait_for()
    dots = page.locator("[data-chart=best] circle")
    before = dots.count()
    curve_folders.race_on(studio.folder / "tunings/teb", budget=40)
    page.get_by_text("sets of values in 1 races").wait_for(state="detached")
    assert dots.count() > before
    page.locator("code.command", has_text="optuna-dashboard 'sqlite:///tunings/teb/study.db'").wait_for()
    page.locator("th", has_text="best so far").wait_for()
    curve_folders.write_card(studio.folder / "tunings/teb")
    page.locator(".state.finished").wait_for()
    page.locator(".answer", has_text="better than the present values").wait_for()
    page.get_by_role("row", name="weight").filter(has_text="3.5").filter(has_text="0.80").wait_for()
    page.get_by_role("row", name="strict success").filter(has_text="0.25").wait_for()
    assert shown.complaints == []


def test_a_tuning_for_two_objectives_shows_its_pareto_set_and_what_chose_one(
    show: Callable[..., Any], studio: Any, curve_folders: Any
) -> None:
    curve_folders.write_pareto(studio.folder / "tunings/both")
    shown = show("curves?path=tunings/both")
    page = shown.page
    page.locator("[data-chart=pareto] circle").first.wait_for()
    page.get_by_role("row", name="2 (chosen)").wait_for()
    page.get_by_text("Chosen: the best by the last.").wait_for()
    page.get_by_role("columnheader", name="-collisions").wait_for()
    assert shown.complaints == []


def test_a_training_is_drawn_on_while_it_learns_and_keeps_what_is_read(
    show: Callable[..., Any], studio: Any, curve_folders: Any
) -> None:
    curve_folders.write_training(studio.folder / "trainings/rosnav")
    shown = show("curves?path=trainings/rosnav")
    page = shown.page
    page.locator(".answer", has_text="6000 of 1 M steps").wait_for()
    for title in ("Success", "Reward", "Entropy"):
        page.locator("figcaption", has_text=title).wait_for()
    chart = page.locator("[data-chart=Success]")
    chart.focus()
    page.keyboard.press("End")
    page.keyboard.press("ArrowLeft")
    read = page.locator("figure", has=chart).locator(".reading")
    shown.until(read.inner_text, "4000: validation: success 0.4, validation: collision 0.1, validation: time out 0.3")
    curve_folders.write_validations(studio.folder / "trainings/rosnav", 4)
    page.locator(".answer", has_text="8000 of 1 M steps").wait_for()
    shown.wait("document.activeElement.dataset.chart === 'Success'")
    assert read.inner_text().startswith("4000: validation: success 0.4")
    page.locator("summary").click()
    page.locator("figcaption", has_text="train/loss").wait_for()
    assert shown.complaints == []


def test_what_is_damaged_meanwhile_is_told_in_one_line_and_heals(
    show: Callable[..., Any], studio: Any, curve_folders: Any
) -> None:
    curve_folders.write_training(studio.folder / "rosnav")
    shown = show("curves?path=rosnav")
    page = shown.page
    page.locator("[data-chart=Reward]").wait_for()
    (studio.folder / "rosnav/curve.json").write_text('[{"steps": 2')
    page.get_by_role("alert").filter(has_text="rosnav/curve.json: is no JSON").wait_for()
    page.locator("[data-chart=Reward]").wait_for()
    curve_folders.write_validations(studio.folder / "rosnav", 5)
    page.locator(".answer", has_text="10 k of 1 M steps").wait_for()
    assert page.locator(".page.curves .bad").is_hidden()


def test_a_folder_of_another_kind_and_an_empty_project_say_so(show: Callable[..., Any], studio: Any) -> None:
    page = show("curves").page
    page.get_by_text("Nothing in this folder was tuned or trained yet").wait_for()
    page = show("curves?path=maps").page
    page.get_by_role("alert").filter(has_text="maps: is no tuning").wait_for()


def test_studies_are_chosen_and_a_phone_is_wide_enough(
    show: Callable[..., Any], studio: Any, curve_folders: Any
) -> None:
    curve_folders.write_training(studio.folder / "trainings/rosnav")
    curve_folders.write_tuning(studio.folder / "tunings/teb")
    for width in (PHONE, 1280):
        shown = show("curves?path=trainings/rosnav", width)
        shown.page.locator("[data-chart=Reward]").wait_for()
        assert shown.page.evaluate(WIDE) <= 0
        shown.page.get_by_role("link", name="tunings/teb").click()
        shown.page.get_by_role("heading", name="teb on jackal").wait_for()
        shown.page.locator('[data-path="tunings/teb"][aria-current]').wait_for()
        assert shown.page.evaluate(WIDE) <= 0
        assert shown.complaints == []


def test_a_ladder_is_drawn_block_by_block_and_then_under_the_limit(
    show: Callable[..., Any], studio: Any, curve_folders: Any
) -> None:
    place = studio.folder / "ladders/dwa"
    curve_folders.write_ladder(place, "dwa")
    shown = show("curves")
    page = shown.page
    page.get_by_role("heading", name="Ladder of dwa on jackal").wait_for()
    page.get_by_text("24 episodes in 3 blocks of 1 cells").wait_for()
    chart = page.locator("[data-chart=hall_slow]")
    shown.until(chart.locator("circle").count, 3)
    curve_folders.end_ladder(place, curve_folders.ladder_facts("dwa", limit=True))
    page.locator(".state.finished").wait_for()
    page.locator(".legend", has_text="clairvoyant").wait_for()
    assert chart.locator("path.dashed").count() == 1
    assert chart.locator("path.bar").count() == 2
    page.get_by_role("row", name="hall").first.filter(has_text="4.0 (2.0 – 6.0)").wait_for()
    page.locator("code.command", has_text="arena ladder report ladders/dwa OTHER").wait_for()
    both = map(curve_folders.ladder_facts, ("dwa", "teb"))
    curve_folders.end_ladder(studio.folder / "ladder_report", *both)
    page.get_by_role("link", name="ladder_report").click()
    page.locator(".answer", has_text="dwa bears 2.00 times").wait_for()
    shown.until(chart.locator("path.bar").count, 4)
    assert shown.complaints == []
