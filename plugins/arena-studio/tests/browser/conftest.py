"""Chromium, a studio of its own process, and a page of it that must not complain."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from arena_core.records import EPISODE_COLUMNS

PATIENCE = 120.0  # s, on a busy machine
AXE = Path(__file__).resolve().parents[4] / "node_modules" / "axe-core" / "axe.min.js"
DATA = Path(__file__).resolve().parents[4] / "tests" / "data"
HELD = (".arena_studio", "conf")  # experiments and options, which a studio has in memory too
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
        command = [
            sys.executable,
            "-m",
            "arena_core.cli.main",
            "studio",
            str(self.folder),
            f"port={self.port}",
            "open=false",
        ]
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

    def end_experiments(self) -> None:
        """End what was started in the browser and still drives."""
        for note in (self.folder / ".arena_studio" / "runs").glob("*.json"):
            with suppress(ProcessLookupError):
                os.killpg(json.loads(note.read_text())["pid"], signal.SIGKILL)


@pytest.fixture(scope="session")
def kept_studios(tmp_path_factory: pytest.TempPathFactory) -> Iterator[list[Studio]]:
    """Keep the studio that the next test may have: to start one takes longer than most tests."""
    kept: list[Studio] = []
    yield kept
    for one in kept:
        one.kill()


@pytest.fixture
def studio(kept_studios: list[Studio], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    """Show a project that has the maps and scenarios of the tests and nothing else."""
    running = kept_studios.pop() if kept_studios else Studio(tmp_path_factory.mktemp("project"))
    for path in running.folder.iterdir():
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    for name in ("maps", "scenarios"):
        shutil.copytree(DATA / name, running.folder / name)
    if running.process is None:
        running.start()
    yield running
    if running.process is None or any((running.folder / name).exists() for name in HELD):
        running.end_experiments()
        running.kill()
    else:
        kept_studios.append(running)


@dataclass
class Shown:
    """A page of the studio, and what it complained about."""

    page: Any
    complaints: list[str] = field(default_factory=list)

    def wait(self, expression: str) -> Any:
        """Wait until an expression of the page is true, and return it; its policy forbids
        playwright's own way to wait.
        """
        end = time.monotonic() + PATIENCE
        while not (value := self.page.evaluate(expression)):
            assert time.monotonic() < end, (
                f"{expression} never became true: {self.page.locator('body').inner_text()[:2000]}"
            )
            time.sleep(0.02)
        return value

    def until(self, look: Callable[[], Any], expected: Any) -> None:
        """Wait until what a look gives, at the page or at a file, is what is expected."""
        end = time.monotonic() + PATIENCE
        while (found := look()) != expected and time.monotonic() < end:
            self.page.wait_for_timeout(20)
        assert found == expected

    @property
    def violations(self) -> list[str]:
        """Return what axe finds wrong with the page as it is."""
        if not self.page.evaluate("'axe' in window"):
            self.page.evaluate(AXE.read_text())
        told: list[str] = self.page.evaluate(
            "axe.run().then((said) => said.violations.map((one) => `${one.id}: ${one.nodes.map((node) => node.html)}`))"
        )
        return told

    def go(self, view: str, point: tuple[float, float]) -> None:
        """Move the pointer to a point, m, of a view of the edit kit, which an expression of the page gives."""
        u, v = self.page.evaluate(f"{view}.over([{point[0]}, {point[1]}])")
        box = self.page.locator("canvas").bounding_box()
        self.page.mouse.move(box["x"] + u, box["y"] + v, steps=4)

    def drag(self, view: str, *points: tuple[float, float]) -> None:
        """Press at the first point, m, of a view, move over the others and let go."""
        self.go(view, points[0])
        self.page.mouse.down()
        for point in points[1:]:
            self.go(view, point)
        self.page.mouse.up()


@pytest.fixture(scope="session")
def write_run() -> Callable[..., None]:
    """Write a run's table without its records."""

    def write(folder: Path, preset: str, count: int) -> None:
        folder.mkdir(parents=True)
        same = {"robot": "jackal", "world": "empty", "task": "random", "success": 1, "seed": 0}
        facts = {"config_hash": preset, "planner": preset, "preset": preset, **same}
        with (folder / "episodes.csv").open("w", newline="") as file:
            writer = csv.DictWriter(
                file, [*EPISODE_COLUMNS, "success", "time_to_goal"], restval="", lineterminator="\n"
            )
            writer.writeheader()
            for number in range(count):
                outcome = "timeout" if number % 3 == 2 else "goal_reached"
                seconds = 10.0 + number + len(preset)
                writer.writerow(
                    {
                        **facts,
                        "episode": number,
                        "scenario": f"random/{number:04d}",
                        "outcome": outcome,
                        "time_to_goal": seconds,
                    }
                )

    return write


@pytest.fixture
def show(chromium: Any, studio: Studio) -> Iterator[Callable[..., Shown]]:
    """Open a place of the studio, ``map?path=...``, in a new window."""
    opened: list[Shown] = []

    def open_page(place: str, width: int = 1280, height: int = 900) -> Shown:
        page = chromium.new_context(viewport={"width": width, "height": height}).new_page()
        page.set_default_timeout(1000 * PATIENCE)
        shown = Shown(page)
        page.on(
            "console",
            lambda message: shown.complaints.append(message.text) if message.type in ("error", "warning") else None,
        )
        page.on("pageerror", lambda error: shown.complaints.append(str(error)))
        opened.append(shown)
        page.goto(f"{studio.address}#/{place}")
        return shown

    yield open_page
    for shown in opened:
        shown.page.context.close()
