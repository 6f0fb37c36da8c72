"""Chromium, a studio of its own process, and a page of it that must not complain."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

PATIENCE = 120.0  # s, on a busy machine
DATA = Path(__file__).resolve().parents[4] / "tests" / "data"
STARTED = re.compile(r"(http://127\.0\.0\.1:(\d+))/\?token=(\S+)")


@pytest.fixture(scope="module")  # of one folder at a time: playwright starts once in a process
def chromium() -> Iterator[Any]:
    """Start the browser: the system's chromium, else playwright's own."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        yield browser
        browser.close()


@dataclass
class Studio:
    """``arena studio`` of a folder, in a process of its own."""

    folder: Path
    address: str = ""
    port: int = 0
    process: subprocess.Popen[str] | None = None

    def start(self) -> None:
        """Start it, on the same port as before if there was one."""
        command = [sys.executable, "-m", "arena_core.cli.main", "studio", str(self.folder), f"port={self.port}", "open=false"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if found := STARTED.search(line):
                self.address, self.port = found[0], int(found[2])
                return
        raise AssertionError("arena studio printed no address")

    def kill(self) -> None:
        """End it without a word, as a power cut would."""
        if self.process is not None:
            os.kill(self.process.pid, signal.SIGKILL)
            self.process.wait()
            if self.process.stdout is not None:
                self.process.stdout.close()
            self.process = None


@pytest.fixture
def studio(tmp_path: Path) -> Iterator[Studio]:
    """Start a studio of a project with the maps and scenarios of the tests."""
    for name in ("maps", "scenarios"):
        shutil.copytree(DATA / name, tmp_path / name)
    running = Studio(tmp_path)
    running.start()
    yield running
    running.kill()


@dataclass
class Shown:
    """A page of the studio, and what it complained about."""

    page: Any
    complaints: list[str] = field(default_factory=list)

    def wait(self, expression: str) -> Any:
        """Wait until an expression of the page is true, and return it; its policy forbids playwright's own way to wait."""
        end = time.monotonic() + PATIENCE
        while not (value := self.page.evaluate(expression)):
            assert time.monotonic() < end, f"{expression} never became true: {self.page.locator('body').inner_text()[:2000]}"
            time.sleep(0.02)
        return value


@pytest.fixture
def show(chromium: Any, studio: Studio) -> Iterator[Callable[..., Shown]]:
    """Open a place of the studio, ``map?path=...``, in a new window."""
    opened: list[Shown] = []

    def open_page(place: str, width: int = 1280, height: int = 900) -> Shown:
        page = chromium.new_context(viewport={"width": width, "height": height}).new_page()
        page.set_default_timeout(1000 * PATIENCE)
        shown = Shown(page)
        page.on("console", lambda message: shown.complaints.append(message.text) if message.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: shown.complaints.append(str(error)))
        opened.append(shown)
        page.goto(f"{studio.address}#/{place}")
        return shown

    yield open_page
    for shown in opened:
        shown.page.context.close()
