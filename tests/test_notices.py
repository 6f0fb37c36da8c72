"""What is told is told once, and by the main process alone."""

import multiprocessing

import pytest

from arena_core.commands import print_notice


def test_a_line_is_told_once(capsys: pytest.CaptureFixture[str]) -> None:
    print_notice.cache_clear()
    for line in ("a thing", "another", "a thing"):
        print_notice(line)
    assert capsys.readouterr().err == "arena: a thing\narena: another\n"


def test_a_worker_tells_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    worker = multiprocessing.get_context("spawn").Process(target=print_notice, args=("from a worker",))
    worker.start()
    worker.join()
    assert worker.exitcode == 0
    assert capfd.readouterr().err == ""
