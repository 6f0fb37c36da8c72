#!/usr/bin/env python3
"""Make the pictures of docs/studio.md: drive some episodes, open `arena studio` in chromium, and photograph its pages.

usage: .venv/bin/python scripts/studio_screenshots.py [FOLDER]      after `scripts/setup browser`; pictures go to
docs/images, or to FOLDER
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from studio_in_chromium import start_browser, start_studio

TOP = Path(__file__).resolve().parents[1]
PATIENCE = 300_000  # ms
WINDOW = {"width": 1280, "height": 860}


def main() -> int:
    """Write the pictures; return the exit status."""
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else TOP / "docs" / "images"
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder) / "lab"
        for name in ("maps", "scenarios"):
            shutil.copytree(TOP / "tests" / "data" / name, project / name)
        shutil.copytree(
            TOP / "plugins" / "arena-tasks" / "src" / "arena_scenarios" / "packs" / "arena", project / "arena"
        )
        with start_studio(project) as address, start_browser() as chromium:
            page = chromium.new_page(viewport=WINDOW)
            page.set_default_timeout(PATIENCE)
            page.goto(address)
            photograph_runs(page, target)
            photograph_results(page, target)
            photograph_maps(page, address, target)
            photograph_scenarios(page, address, target)
            photograph_tasks(page, address, target)
    return 0


def photograph_maps(page: Any, address: str, target: Path) -> None:
    """Draw a world of rooms, furnish and measure it, and photograph it as a wall is drawn."""
    page.goto(f"{address}#/map")
    page.locator("summary", has_text="Generate").click()
    page.get_by_label("kind", exact=True).select_option("rooms")
    page.get_by_label("seed", exact=True).fill("3")
    page.get_by_label("seed", exact=True).press("Tab")
    page.get_by_role("button", name="Draw", exact=True).click()
    page.locator(".empty").wait_for(state="hidden")
    page.locator("summary", has_text="Keep as another map").click()
    page.get_by_label("file, in the project").fill("maps/rooms.yaml")
    page.get_by_role("button", name="Keep a copy").click()
    page.locator("#said", has_text="kept as").wait_for()
    page.locator("summary", has_text="Keep as another map").click()
    page.locator("summary", has_text="Generate").click()
    page.locator("summary", has_text="Measures").click()
    page.get_by_role("button", name="Measure", exact=True).click()
    page.locator(".measures tr").first.wait_for()
    page.locator("canvas").focus()
    page.keyboard.press("w")
    box = page.locator("canvas").bounding_box()
    page.mouse.move(box["x"] + 0.45 * box["width"], box["y"] + 0.35 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.35 * box["height"], steps=5)
    save_screenshot(page, target / "studio-map.png")
    page.mouse.up()


def photograph_scenarios(page: Any, address: str, target: Path) -> None:
    """Open a scene with groups of people, photograph it as one of them is chosen, and as its preview plays."""
    page.goto(f"{address}#/scenario?path=arena/scenarios/moving_group_high.json")
    page.locator("summary", has_text="can be run").wait_for()
    page.locator(".things button", has_text="Person 3").click()
    save_screenshot(page, target / "studio-scenario.png")
    page.get_by_label("legs").check()
    page.get_by_role("button", name="Preview", exact=True).click()
    slider = page.get_by_label("time of the preview, s")
    slider.wait_for()
    page.evaluate("document.querySelector('.page.scenario').preview.player.seek(12)")
    save_screenshot(page, target / "studio-preview.png")


def photograph_tasks(page: Any, address: str, target: Path) -> None:
    """Photograph a curriculum, and what rules draw."""
    page.goto(f"{address}#/task?part=curriculum&path=growing")
    page.locator(".plots svg").first.wait_for()
    save_screenshot(page, target / "studio-curriculum.png")
    page.get_by_role("tab", name="Random problems").click()
    page.locator(".rule").first.wait_for()
    page.get_by_label("world or map").select_option("outdoor")
    page.get_by_role("button", name="Draw ten").click()
    page.locator(".draws figure").nth(9).wait_for()
    save_screenshot(page, target / "studio-draws.png")


def save_screenshot(page: Any, path: Path) -> None:
    """Write a picture of the page, without the line of what was done last."""
    page.locator("#said").evaluate("region => region.replaceChildren()")
    page.screenshot(path=path)


def photograph_runs(page: Any, target: Path) -> None:
    """Start a sweep in the page Run, and photograph it as it goes on and once it has ended."""
    page.get_by_label("planner", exact=True).select_option("pure_pursuit")
    page.get_by_label("planner: compare with another").click()
    page.get_by_label("planner, another").select_option("rosnav")
    page.get_by_label("robot", exact=True).select_option("jackal")
    page.get_by_label("episodes", exact=True).fill("8")
    page.get_by_label("more words of the command line").fill(
        "world=empty pedestrians=none task.time_limit=30 report=false executor=serial"
    )
    page.get_by_label("folder of the run").fill("multirun/first")
    page.locator("button.main:enabled").click()
    page.locator(".experiment tbody tr").nth(1).wait_for()
    page.evaluate("document.getElementById('page').scrollTo(0, 0)")
    save_screenshot(page, target / "studio-run.png")
    page.locator('.experiment[data-state="finished"]').wait_for()


def photograph_results(page: Any, target: Path) -> None:
    """Compare the planners in the page Results."""
    page.get_by_role("link", name="Results", exact=True).click()
    page.locator("table tbody tr").first.wait_for()
    page.get_by_role("button", name="Compare planners").click()
    page.locator(".compared tbody tr").first.wait_for()
    save_screenshot(page, target / "studio-results.png")


if __name__ == "__main__":
    sys.exit(main())
