"""A planner that drives to its goal, but for one fault at one moment of the episode with one goal: the environment says which.

The configuration is the same with a fault and without, and so are the records of all other episodes.
"""

import math
import os
import signal
import sys
import threading
import time

from arena_core import Planner, Robot, Twist, hookimpl


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


def say(text):
    raise RuntimeError(text)


def throw(error):
    raise error


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
    "handlers": lambda _: replace_handlers(),
    "write": lambda given: setattr(given, "goal", None),
    "NaN": lambda _: Twist(math.nan),
    "type": lambda _: "full speed",
    "huge text": lambda _: say("x" * 50_000_000),
    "surrogate": lambda _: say("\ud800 \0 \n \x1b[31m"),
}


class Misbehaving(Planner):
    def __init__(self, robot: Robot) -> None:
        self.answer = None
        self.bad = False
        self.do("constructor", robot)

    def do(self, moment, given):
        if os.environ.get("FAULT") and os.environ["MOMENT"] == moment and (self.bad or moment == "constructor"):
            self.answer = FAULTS[os.environ["FAULT"]](given)

    def reset(self, episode):
        self.answer, self.steps = None, 0
        self.bad = os.environ.get("GOAL") == f"{episode.goal.x:.6f} {episode.goal.y:.6f}"
        self.do("reset", episode)
        self.answer = None  # no command is asked for yet

    def compute_velocity(self, observation):
        self.steps += 1
        self.do({1: "first step", 6: "later step"}.get(self.steps, ""), observation)
        if self.answer is not None and os.environ["FAULT"] in ("NaN", "type"):
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
