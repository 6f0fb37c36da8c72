"""The documentation and the report's page in chromium: they open from files, ask no one for anything, and
fit a desktop and a phone.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.browser

TOP = Path(__file__).resolve().parents[2]
DRIVES = (
    "world=empty world.width=8 world.height=8 task.pedestrians=1 localizer=ground_truth episodes=3 executor=serial "
    "hydra.sweep.dir=runs"
)


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the documentation, where a warning is an error."""
    folder = tmp_path_factory.mktemp("site")
    words = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    built = subprocess.run(
        words, cwd=TOP, env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}, capture_output=True, text=True
    )
    assert built.returncode == 0, built.stderr
    return folder


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Compare two planners and return the report's page."""
    folder = tmp_path_factory.mktemp("report")
    words = [
        str(TOP / ".venv" / "bin" / "arena"),
        "run",
        "-m",
        "planner=dwa,pure_pursuit",
        "robot=jackal",
        *DRIVES.split(),
    ]
    subprocess.run(words, cwd=folder, check=True, capture_output=True)
    (page,) = folder.rglob("index.html")
    return page


def test_every_page_of_the_documentation_opens_and_fits(site: Path, show: Callable[[Path], Any]) -> None:
    pages = sorted(path for path in site.rglob("*.html") if path.name != "404.html")  # that one is for a server's root
    assert len(pages) > 80
    wrong = {}
    for path in pages:
        opened = show(path)
        elsewhere = [url for url in opened.requests if not url.startswith(("file:", "data:", "about:"))]
        if opened.complaints or elsewhere or opened.overflow > 0:
            wrong[str(path.relative_to(site))] = [*opened.complaints, *elsewhere, f"{opened.overflow} pixels too wide"]
    assert wrong == {}


@pytest.mark.parametrize("word", ["LaserScan", "optuna", "joblib", "recoveries.circle_radius"])
def test_documentation_is_searched_without_a_server(site: Path, show: Callable[[Path], Any], word: str) -> None:
    page = show(site / "index.html").page
    button = page.locator("label.md-header__button[for=__search]")
    (button if button.is_visible() else page.locator(".md-search__input")).click()
    page.keyboard.type(word, delay=20)
    page.wait_for_selector(".md-search-result__item")
    assert word.split(".")[-1] in page.inner_text(".md-search-result__list")


def test_reference_shows_signature_types_and_docstring(site: Path, show: Callable[[Path], Any]) -> None:
    text = show(site / "reference" / "arena_core.values.sensing.html").page.inner_text("article")
    assert "ranges: NDArray[float32]" in text
    assert "+inf where nothing was hit within range_max" in text


def test_report_opens_and_fits(report: Path, show: Callable[[Path], Any]) -> None:
    opened = show(report)
    assert opened.complaints == []
    assert [url for url in opened.requests if not url.startswith(("file:", "data:"))] == []
    assert opened.overflow <= 0
    assert "pure_pursuit" in opened.page.inner_text("body")


def test_rows_of_the_report_are_chosen_by_planner(report: Path, show: Callable[[Path], Any]) -> None:
    page = show(report).page
    page.select_option("select[name=planner]", "dwa")
    page.locator("details:has(table.episodes) > summary").click()
    shown = page.locator("table.episodes tbody tr:visible")
    assert shown.count() == 3
    assert page.inner_text("#filters output") == "3 of 6 episodes"
    assert {name.split(",")[0] for name in shown.locator("td.name").all_inner_texts()} == {"dwa"}
    assert page.locator("table.headline tbody tr:visible td.name").all_inner_texts() == ["dwa"]


def test_episodes_of_the_report_are_sorted_by_a_column(report: Path, show: Callable[[Path], Any]) -> None:
    page = show(report).page
    page.locator("details:has(table.episodes) > summary").click()
    head = page.locator("table.episodes th", has_text="path length").first
    column = int(head.evaluate("head => head.cellIndex")) + 1

    def lengths() -> list[float]:
        texts = page.locator(f"table.episodes tbody tr td:nth-child({column})").all_inner_texts()
        return [float(text) for text in texts if text != "–"]

    head.click()
    assert lengths() == sorted(lengths())
    head.press("Enter")
    assert lengths() == sorted(lengths(), reverse=True)


BOXES = """
[...document.querySelectorAll('main, main *')]
  .filter((one) => one.clientWidth && getComputedStyle(one).display !== 'inline')
  .filter((one) => one.scrollWidth > one.clientWidth + 1)
  .map((one) => `${one.tagName}.${one.className}: ${one.scrollWidth} of ${one.clientWidth}`)
"""
CONTRASTS = """
(() => {
  const parts = (text) => (text.match(/[\\d.]+/g) ?? [0, 0, 0, 0]).map(Number);
  const light = (text) => {
    const linear = (c) => (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
    const [r, g, b] = parts(text).map((c) => linear(c / 255));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const under = (one) => {
    for (let at = one; at; at = at.parentElement) {
      const colour = getComputedStyle(at).backgroundColor;
      if ((parts(colour)[3] ?? 1) > 0) return colour;
    }
    return 'rgb(255, 255, 255)';
  };
  const own = (one) => [...one.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
  return [...document.querySelectorAll('main *')].filter((one) => own(one) && one.clientHeight).map((one) => {
    const [a, b] = [light(getComputedStyle(one).color), light(under(one))].sort((x, y) => y - x);
    return [(a + 0.05) / (b + 0.05), one.tagName, one.textContent.slice(0, 40)];
  }).filter(([contrast]) => contrast < 4.5);
})()
"""


def test_nothing_of_the_report_is_wider_than_a_phone(report: Path, show: Callable[[Path], Any]) -> None:
    opened = show(report)
    opened.page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    assert opened.overflow <= 0
    if opened.page.viewport_size["width"] == 390:
        assert opened.page.evaluate(BOXES) == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_report_is_readable_in_light_and_in_darkness(report: Path, show: Callable[[Path], Any], scheme: str) -> None:
    opened = show(report)
    opened.page.emulate_media(color_scheme=scheme)
    opened.page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    red, green, blue = (
        int(part)
        for part in re.findall(r"\d+", opened.page.evaluate("getComputedStyle(document.body).backgroundColor"))
    )
    assert (max(red, green, blue) < 60) == (scheme == "dark")
    assert opened.page.evaluate(CONTRASTS) == []
    charts = opened.page.evaluate(
        "[...document.querySelectorAll('figure.chart img')].map((one) => getComputedStyle(one).filter)"
    )
    assert charts
    assert all((chart != "none") == (scheme == "dark") for chart in charts)


def test_success_of_an_episode_is_a_word(report: Path, show: Callable[[Path], Any]) -> None:
    page = show(report).page
    said = page.evaluate(
        "[...document.querySelectorAll('.episodes td[data-label=success]')].map((one) => one.textContent.trim())"
    )
    assert said
    assert set(said) <= {"yes", "no"}
