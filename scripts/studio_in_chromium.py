"""A studio of its own and a chromium to open it in, for the pictures of the documentation and for
benchmarks/studio_speed.py.
"""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

ARENA = (sys.executable, "-m", "arena_core.cli.main")


@contextmanager
def start_studio(project: Path) -> Iterator[str]:
    """Start a studio on a folder; yield its address."""
    command = [*ARENA, "studio", str(project), "open=false"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)  # noqa: S603
    assert process.stderr is not None
    try:
        found = re.search(r"http\S+", process.stderr.readline())
        assert found, "arena studio printed no address"
        yield found[0]
    finally:
        process.send_signal(signal.SIGINT)
        process.wait()


@contextmanager
def start_browser() -> Iterator[Any]:
    """Start chromium: the system's, else playwright's own."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        yield chromium
        chromium.close()
