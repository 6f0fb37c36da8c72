"""Chromium, and what a page says and asks for since it was opened."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

WIDTHS = {"desktop": 1280, "phone": 390}  # CSS pixels
PATIENCE = 120_000  # ms, on a busy machine


@dataclass
class Opened:
    """What a page said and asked for since it was opened."""

    page: Any
    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    @property
    def overflow(self) -> int:
        """Return by how many pixels the page is wider than its window."""
        return int(self.page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth"))


@pytest.fixture(scope="module")  # of one folder at a time: playwright starts once in a process
def chromium() -> Iterator[Any]:
    """Start the browser: the system's chromium, else playwright's own."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(params=WIDTHS)
def show(chromium: Any, request: pytest.FixtureRequest) -> Iterator[Callable[[Path], Opened]]:
    """Open a file in a window of one of the widths."""
    page = chromium.new_page(viewport={"width": WIDTHS[request.param], "height": 900})
    page.set_default_timeout(PATIENCE)
    opened = Opened(page)
    page.on(
        "console",
        lambda message: opened.complaints.append(message.text) if message.type in ("error", "warning") else None,
    )
    page.on("pageerror", lambda error: opened.complaints.append(str(error)))
    page.on("request", lambda asked: opened.requests.append(asked.url))

    def open_file(path: Path) -> Opened:
        opened.complaints.clear()
        opened.requests.clear()
        page.goto(path.as_uri())
        return opened

    yield open_file
    page.close()
