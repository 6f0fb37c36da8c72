"""Other processes that tests run beside themselves, and waiting for what they do."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

ARENA = str(Path(sys.executable).with_name("arena"))
LOOK = 0.01  # s
ENDING = 60.0  # s that a process may take to end: compiling may have to end first
PUBLISHER = """
import signal, sys
from arena_ros.transport import open_transport
transport, topic, kind = sys.argv[1:]
signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM])
node = open_transport(transport, "another")
node.publisher(topic, kind, latched=True)
print("there", flush=True)
signal.sigwait([signal.SIGTERM])
node.close()
"""


@contextmanager
def run_process(*words: str, log: Path | None = None) -> Iterator[subprocess.Popen[str]]:
    """Run a process within the block; what it says goes to ``log``."""
    with ExitStack() as stack:
        out = stack.enter_context(log.open("w")) if log else subprocess.DEVNULL
        # the words are those of tests
        process = subprocess.Popen(words, stdout=out, stderr=subprocess.STDOUT, text=True)  # noqa: S603
        try:
            yield process
        finally:
            process.send_signal(signal.SIGCONT)
            process.terminate()
            try:
                process.wait(ENDING)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def wait_until(condition: Callable[[], object], seconds: float) -> None:
    """Wait until something is so; raise AssertionError where it does not come so far."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not come so far"
        time.sleep(LOOK)


def has_printed(log: Path, text: str) -> Callable[[], bool]:
    """Return what says whether a process has said something."""
    return lambda: log.is_file() and text in log.read_text()


def run_to_end(*words: str, seconds: float = 240.0) -> subprocess.CompletedProcess[str]:
    """Run a process to its end."""
    return subprocess.run(words, capture_output=True, text=True, timeout=seconds)  # noqa: S603 - words of tests


@contextmanager
def another_publisher(transport: str, topic: str, kind: str, log: Path) -> Iterator[None]:
    """Have another node publish a topic, without a message, within the block."""
    with run_process(sys.executable, "-c", PUBLISHER, transport, topic, kind, log=log):
        wait_until(has_printed(log, "there"), 60.0)
        yield
