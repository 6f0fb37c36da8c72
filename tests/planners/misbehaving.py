"""A planner that drives to its goal, but for a fault at one moment of some episodes: the environment says which, by
their goals.

The configuration is the same with a fault and without, and so are the records of all other episodes.
"""

import contextlib
import ctypes
import json
import math
import os
import pathlib
import resource
import signal
import stat
import subprocess
import sys
import threading
import time

import numpy as np

from arena_core import Planner, Robot, Twist, hookimpl
from arena_core.files import write_text_whole
from arena_core.hosting import RunFolderError


def deadlock():
    lock = threading.Lock()
    lock.acquire()
    thread = threading.Thread(target=lock.acquire)
    thread.start()
    thread.join()


def grow():
    kept = []
    while True:
        kept.append(bytearray(5_000_000))
        time.sleep(0.001)


def spin():
    while True:
        pass


def fork():
    if os.fork() == 0:
        time.sleep(1000)


def replace_handlers():
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1):
        signal.signal(number, lambda *_: None)


def leak():
    while True:
        kept.append(os.open(os.devnull, os.O_RDONLY))


def write_into_the_map(given):
    ctypes.memset(given.map.data.ctypes.data, 100, given.map.data.size)


def go_off():
    """Start processes that leave the worker's session, one of them its environment as well, as a daemon does; wait
    until all three have said who they are.
    """
    places = {**os.environ}
    pathlib.Path(places["PIDS"]).touch()
    subprocess.Popen(["sh", "-c", 'echo $$ >> "$PIDS"; exec sleep 1000'], env=places, start_new_session=True)
    words = 'echo $$ >> "$PIDS"; (setsid env -i sh -c "echo \\$\\$ >> $PIDS; exec sleep 1000" &) ; exit 0'
    subprocess.run(
        ["sh", "-c", words], env={"PIDS": places["PIDS"], "PATH": os.environ["PATH"]}, start_new_session=True
    )
    while len(pathlib.Path(places["PIDS"]).read_text().split()) < 3:
        time.sleep(0.01)


def half_a_message():
    """Write to every pipe and socket of the process, as code does that mistakes a number for its own."""
    for number in range(3, 64):
        with contextlib.suppress(OSError):
            if stat.S_ISSOCK(os.fstat(number).st_mode) or stat.S_ISFIFO(os.fstat(number).st_mode):
                os.write(number, b"\0\0\x10\0 half")


def say(text):
    raise RuntimeError(text)


def throw(error):
    raise error


kept = []
FAULTS = {
    "os._exit": lambda _: os._exit(0),
    "sys.exit": lambda _: sys.exit(5),
    "segfault": lambda _: os.kill(os.getpid(), signal.SIGSEGV),
    "abort": lambda _: os.abort(),
    "SIGKILL": lambda _: os.kill(os.getpid(), signal.SIGKILL),
    "BaseException": lambda _: throw(BaseException("no Exception")),
    "KeyboardInterrupt": lambda _: throw(KeyboardInterrupt()),
    "memory": lambda _: grow(),
    "spin": lambda _: spin(),
    "sleep": lambda _: time.sleep(100_000),
    "deadlock": lambda _: deadlock(),
    "fork": lambda _: fork(),
    "stdout": lambda _: (sys.stdout.close(), os.close(1)),
    "chdir": lambda _: os.chdir("/"),
    "descriptors": lambda _: leak(),
    "few descriptors": lambda _: kept.extend(os.open(os.devnull, os.O_RDONLY) for _ in range(400)),
    "RunFolderError": lambda _: throw(RunFolderError("cannot write it: No space left on device")),
    "elsewhere": lambda _: write_text_whole(pathlib.Path("/proc/nowhere/a.txt"), "a"),
    "file size": lambda _: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY)),
    "few files": lambda _: resource.setrlimit(
        resource.RLIMIT_NOFILE, (3, resource.getrlimit(resource.RLIMIT_NOFILE)[1])
    ),
    "stack": lambda _: resource.setrlimit(resource.RLIMIT_STACK, (2**20, resource.RLIM_INFINITY)),
    "np.array": lambda _: setattr(np, "array", None),
    "np.hypot": lambda _: setattr(np, "hypot", lambda x, y: x + y),
    "seterr": lambda _: np.seterr(all="raise"),
    "umask": lambda _: os.umask(0o777),
    "map": lambda given: write_into_the_map(given),
    "sessions": lambda _: go_off(),
    "half a message": lambda _: half_a_message(),
    "move": lambda _: os.rename(os.environ["MOVED"], os.environ["MOVED"] + ".away"),
    "handlers": lambda _: replace_handlers(),
    "write": lambda given: setattr(given, "goal", None),
    "NaN": lambda _: Twist(math.nan),
    "type": lambda _: "full speed",
    "huge text": lambda _: say("x" * 50_000_000),
    "surrogate": lambda _: say("\ud800 \0 \n \x1b[31m"),
}


class Misbehaving(Planner):
    def __init__(self, robot: Robot) -> None:
        self.goal = self.answer = None
        self.do("constructor", robot)

    def do(self, moment, given):
        for goal, fault, when in json.loads(os.environ.get("FAULTS", "[]")):
            if when == moment and (moment == "constructor" or goal == self.goal):
                told = FAULTS[fault](given)
                self.answer = told if fault in ("NaN", "type") else None

    def reset(self, episode):
        self.steps, self.goal = 0, f"{episode.goal.x:.6f} {episode.goal.y:.6f}"
        self.do("reset", episode)
        self.answer = None  # no command is asked for yet

    def compute_velocity(self, observation):
        self.steps += 1
        self.do({1: "first step", 6: "later step"}.get(self.steps, ""), observation)
        if self.answer is not None:
            return self.answer
        target = observation.pose.relative(observation.waypoint)
        bearing = math.atan2(target.y, target.x)
        return Twist(1.0 if abs(bearing) < 0.3 else 0.0, 0.0, 3.0 * bearing)


@hookimpl
def register_planners(register):
    register("misbehaving", Misbehaving)


@hookimpl
def config_package():
    return "misbehaving.conf"
