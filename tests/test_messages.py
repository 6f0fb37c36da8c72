"""A worker's messages arrive whole, whatever else is written to its pipe, and half a message keeps no one waiting."""

import multiprocessing
import os

import pytest

from arena_core.base.portability import PORTABLE
from arena_core.runs.workers.messages import LENGTH, LONGEST, Inbox, new_mark, send_message

pytestmark = pytest.mark.skipif(PORTABLE, reason="Windows keeps messages whole itself")


@pytest.fixture
def ends():
    ours, theirs = multiprocessing.Pipe()
    mark = new_mark()
    with ours, theirs:
        yield Inbox(ours, mark), theirs, mark


def test_values_arrive_in_order(ends):
    inbox, theirs, mark = ends
    for value in ("a", {"row": [1.5] * 1000}, b""):
        send_message(theirs, mark, value)
    assert [inbox.take() for _ in range(4)] == ["a", {"row": [1.5] * 1000}, b"", None]


@pytest.mark.parametrize("junk", [b"\0\0\x10\0 half", b"\xff" * 1000, b"x", b""])
def test_what_is_no_message_is_skipped(ends, junk):
    inbox, theirs, mark = ends
    os.write(theirs.fileno(), junk + mark[:7])
    assert inbox.take() is None
    send_message(theirs, mark, "answer")
    assert inbox.take() == "answer"


def test_half_a_message_keeps_nobody_waiting(ends):
    inbox, theirs, mark = ends
    os.write(theirs.fileno(), mark + LENGTH.pack(1000) + b"half")
    assert inbox.take() is None


def test_a_message_without_end_and_a_closed_pipe_are_errors(ends):
    inbox, theirs, mark = ends
    os.write(theirs.fileno(), mark + LENGTH.pack(LONGEST + 1))
    with pytest.raises(ValueError, match="a message of"):
        inbox.take()
    theirs.close()
    with pytest.raises((EOFError, ValueError)):
        inbox.take()
