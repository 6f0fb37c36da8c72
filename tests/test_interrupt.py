"""Ctrl-C comes between control steps."""

import signal

import pytest

from arena_core.base.ctrl_c import interrupts
from arena_core.cli import main

pytestmark = pytest.mark.usefixtures("ctrl_c")


def test_interrupt_is_raised_at_once_where_no_episode_runs():
    with interrupts.heard(), pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


def test_interrupt_of_an_episode_waits_for_the_next_check():
    with interrupts.heard(), interrupts.held():
        interrupts.check()
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            interrupts.check()


def test_interrupt_noted_in_an_episode_is_not_lost_after_it():
    with interrupts.heard():
        with interrupts.held():
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            interrupts.check()


def test_second_interrupt_ends_a_planner_that_hangs():
    with interrupts.heard(), interrupts.held():
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)


def test_afterwards_all_is_as_it_was():
    with interrupts.heard(), interrupts.held():
        signal.raise_signal(signal.SIGINT)
    interrupts.check()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_process_that_ignores_interrupts_goes_on_ignoring_them():
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with interrupts.heard():
        signal.raise_signal(signal.SIGINT)
    interrupts.check()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


@pytest.mark.parametrize(
    ("note", "said"),
    [(None, "arena: interrupted\n"), ("half of it is kept", "arena: interrupted; half of it is kept\n")],
)
def test_what_is_kept_is_said_as_the_interrupt_tells_it(monkeypatch, capsys, note, said):
    def interrupted(registry, arguments):
        error = KeyboardInterrupt(signal.SIGINT)
        if note:
            error.add_note(note)
        raise error

    monkeypatch.setattr(main, "_run_command", interrupted)
    assert main.main(["train"]) == 130
    assert capsys.readouterr().err == said
