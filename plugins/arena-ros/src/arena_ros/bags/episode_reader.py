"""Messages of a recording, one after the other, into episodes: one at a time is in memory."""

from __future__ import annotations

import heapq
import json
from collections.abc import Iterator, Sequence
from typing import Any

from arena_core import OccupancyGrid, Pose
from arena_ros import conversions as of
from arena_ros.bags.clocks import JUMP, STAMPED, Clocks, source_of
from arena_ros.bags.episode_messages import EpisodeMessages, are_numbers, is_settled
from arena_ros.bags.event_counter import EventCounter
from arena_ros.bags.message_handler import MessageHandler, ScanReading
from arena_ros.bags.stream import Bag, Channel, Message
from arena_ros.bags.topic_roles import RoleAssignment, all_roles
from arena_ros.codec import BadMessage, get_codec

GOAL_MOVED = 0.05  # m between two goals that are not the same one sent again
LONGEST = 4 * 3600 * 10**9  # ns of one episode; what is longer is cut, so that no recording takes all memory


class EpisodeReader:
    """Takes messages in the order in which they were recorded, and yields episodes."""

    def __init__(self, cast: RoleAssignment, clocks: Clocks, reading: ScanReading) -> None:
        self._clocks = clocks
        self._roles: dict[str, list[str]] = {}
        for role, channel in cast.by_role.items():
            self._roles.setdefault(channel.topic, []).append(role)
        self._cast = frozenset(cast.by_role)
        self.by_markers = "episode" in cast.by_role
        self.topics = frozenset(self._roles)
        self.notes: dict[str, int] = {}
        self._taker = MessageHandler(cast, clocks, reading, self.note)
        self._resets = EventCounter()
        self._newest: int | None = None
        self._open: EpisodeMessages | None = None
        self._has_goals = self._is_reset = False

    @property
    def grid(self) -> OccupancyGrid | None:
        """Return the map that was recorded, the last one."""
        return self._taker.grid

    @property
    def grid_frame(self) -> str:
        """Return the frame of that map."""
        return self._taker.grid_frame

    def episodes(self, bags: Sequence[Bag]) -> Iterator[EpisodeMessages]:
        """Yield the episodes of recordings that are read side by side."""
        streams = [
            bag.messages(self.topics, in_time=in_time) for bag, in_time in zip(bags, self._clocks.in_time, strict=True)
        ]
        for channel, recorded, content in heapq.merge(*streams, key=_recorded_time) if len(streams) > 1 else streams[0]:
            roles = [role for role in self._roles[channel.topic] if channel.type in all_roles()[role].types]
            if not roles:
                self.note(f"{channel.topic}: is a {channel.type} too; those messages are left out")
                continue
            try:
                message = get_codec(channel.ros).decode(content, channel.type)
            except BadMessage as bad:
                self.note(f"{channel.topic}: {bad}; left out")
                continue
            for role in roles:
                yield from self._take_message(
                    role, channel, recorded, self._message_stamp(role, channel, recorded, content), message
                )
        yield from self._close_episode("the recording ended")

    def _message_stamp(self, role: str, channel: Channel, recorded: int, content: bytes) -> int:
        """Return when a message was made; goals and the like count from when they were heard."""
        if role not in STAMPED:
            return self._clocks.now(recorded)
        source, own = source_of(channel, content)
        return self._clocks.stamp(source, recorded, own)

    def _take_message(
        self, role: str, channel: Channel, recorded: int, stamp: int, message: Any
    ) -> Iterator[EpisodeMessages]:
        yield from self._check_clock(channel.topic, stamp)
        if role == "episode":
            yield from self._take_marker(stamp, message)
        elif role == "reset":
            settled = self._is_settled(stamp)
            # one that comes with a goal is of the same beginning
            if self._resets.has_reset(message, settled=settled) and settled:
                yield from self._close_episode("a reset came")
                self._is_reset = True
        elif role == "goal" and not self.by_markers:
            yield from self._set_goal(stamp, self._taker.frame(message), of.pose_from_msg(message.pose))
        elif role == "map":
            self._taker.take_map(message)
        elif role == "tf_static":
            self._taker.take_tf_static(message)
        elif role == "tf":
            if self._open is None and "odometry" not in self._cast and not self.by_markers:
                self._begin_episode(EpisodeMessages(stamp))
            self._taker.take_tf(recorded, message)
        elif role != "clock" and not (self._open is None and self.by_markers):
            if self._open is None:
                self._begin_episode(EpisodeMessages(stamp))
            if self._open is not None:
                self._taker.take(role, self._open, stamp, message)

    def _check_clock(self, topic: str, stamp: int) -> Iterator[EpisodeMessages]:
        """End the episode where the clock by which all goes began again, or where it took too long."""
        if self._newest is not None and self._clocks.is_reference(topic) and stamp < self._newest - JUMP:
            self.note("the clock went back: a new episode begins there")
            yield from self._close_episode("the clock went back")
            self._taker.heard.begin(stamp)
        if self._clocks.is_reference(topic):
            self._newest = stamp
        if self._open is not None and stamp - self._open.begin > LONGEST:
            self.note("an episode of more than 4 h is cut")
            goal = self._open.goal
            yield from self._close_episode("it took more than 4 h")
            if goal is not None:
                self._begin_episode(EpisodeMessages(stamp, goal))

    def _is_settled(self, stamp: int) -> bool:
        return self._open is not None and is_settled(self._open, stamp)

    def _take_marker(self, stamp: int, message: Any) -> Iterator[EpisodeMessages]:
        try:
            content = json.loads(message.data)
            kind = content["event"]
        except (ValueError, KeyError, TypeError):
            self.note("a mark of an episode is no JSON with an event; left out")
            return
        if kind == "begin":
            yield from self._close_episode("the next episode began")
            self._begin_episode(EpisodeMessages(stamp, meta=content))
        elif kind == "end" and self._open is not None:
            self._open.ending = content
            yield from self._close_episode("")

    def _set_goal(self, stamp: int, frame: str, goal: Pose) -> Iterator[EpisodeMessages]:
        if not are_numbers(goal.array()):
            self.note("a goal that is no number; left out")
            return
        before = self._open.goal if self._open is not None else None
        if before is not None and before[0] == frame and before[1].distance(goal) < GOAL_MOVED:
            return
        if before is not None:
            yield from self._close_episode("another goal came")
        self._has_goals, self._is_reset = True, False
        # what was recorded before a goal belongs to no episode
        self._begin_episode(EpisodeMessages(stamp, (frame, goal)))

    def _begin_episode(self, gathered: EpisodeMessages) -> None:
        self._open = gathered
        self._taker.begin(gathered)

    def _close_episode(self, why: str) -> Iterator[EpisodeMessages]:
        finished, self._open, self._newest = self._open, None, None
        if finished is not None and finished.goal is None and self._has_goals and self._is_reset:
            self.note("what came after a reset and before a goal belongs to no episode")
        elif finished is not None:
            finished.why_ended = why
            self._taker.end(finished)
            yield finished

    def note(self, line: str) -> None:
        """Count what was left out or is worth saying."""
        self.notes[line] = self.notes.get(line, 0) + 1


def _recorded_time(message: Message) -> int:
    return message[1]
