"""The contract of what carries messages between the robots of a team."""

from __future__ import annotations

import numpy as np

from arena_core.base.random_streams import random_generator
from arena_core.contracts.communication import Communication
from arena_core.testing.facts import Facts
from arena_core.values.geometry import Pose, Twist
from arena_core.values.messages import Message
from arena_core.values.robot import Robot

PERIOD = 0.1  # s
STEPS = 30
Heard = list[list[tuple[Message, ...]]]  # at each step, by each robot


def check_communication(communication: Communication, body: Robot) -> Facts:
    """Let three robots tell where they are for three seconds; the last one tells nothing."""
    heard = _talk(communication, body)
    yield "no one hears of what was not told yet", not any(heard[0])
    every = [(step, robot, each) for step, by in enumerate(heard) for robot, of in enumerate(by) for each in of]
    yield "what is heard are messages", all(isinstance(each, Message) for _, _, each in every)
    yield "a robot hears of others that tell, and not of itself", all(m.sender in {0, 1} - {k} for _, k, m in every)
    once = all(len({each.sender for each in of}) == len(of) for by in heard for of in by)
    yield "a robot hears of each other one once", once
    yield "it hears of it after it was told", all(each.stamp < PERIOD * step - 1e-9 for step, _, each in every)
    poses = np.array([(*each.pose.array(), *each.twist.array(), each.radius) for _, _, each in every])
    yield "numbers are finite", bool(np.isfinite(poses).all())
    again = _talk(communication, body)
    yield "the same numbers drawn after a reset let the same be heard", _facts(heard) == _facts(again)


def _talk(communication: Communication, body: Robot) -> Heard:
    communication.reset(3, random_generator(0, "sample/0", "communication"))
    heard = []
    for step in range(STEPS):
        stamp = PERIOD * step
        heard.append([tuple(communication.heard(robot, stamp)) for robot in range(3)])
        poses = [Pose(0.5 * stamp, 1.0 * robot) for robot in range(3)]
        told: list[Message | None] = [
            Message(robot, stamp, poses[robot], Twist(0.5), np.zeros((3, 3)), body.footprint.radius)
            for robot in range(2)
        ]
        communication.tell([*told, None], np.array([(pose.x, pose.y) for pose in poses]))
    return heard


def _facts(heard: Heard) -> list[list[list[tuple[int, float, Pose, Twist]]]]:
    return [[[(m.sender, m.stamp, m.pose, m.twist) for m in of] for of in by] for by in heard]
