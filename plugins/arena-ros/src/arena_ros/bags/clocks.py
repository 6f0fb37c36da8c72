"""Which clocks a recording's stamps are of: each has one offset to the recorder's, and all are told in the robot's
time.

Stamps of the robot's own messages count as they are, or those of ``/clock`` where a simulation published it. What has
no stamp is placed by when it was recorded; what another clock stamped, by that clock's offset.
"""

from __future__ import annotations

import struct
from array import array
from bisect import bisect_right
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from arena_ros import conversions as of
from arena_ros.bags.stream import Bag, Channel
from arena_ros.bags.topic_roles import RoleAssignment
from arena_ros.codec import PEOPLE

STAMPED = frozenset({"odometry", "reference", "estimate", "scan", "people", "path", "command", "clock", "tf"})
# whose clock is the robot's: the first that is there and runs
MOTION = ("clock", "odometry", "reference", "tf", "estimate", "scan")
AGREE = 400_000_000  # ns between two clocks that count as one: nodes take as long to publish what they have stamped
FORESEEN = 2_100_000_000  # ns that AMCL and its like may stamp a transform ahead of its time (transform_tolerance)
LATEST = 3 * 10**9  # ns that a stamp may lie off its clock before it counts as none
LEAP = 10 * 10**9  # ns by which a clock that leaps ahead was set, rather than runs fast
STEP = 500_000_000  # ns of an offset from one message to the next that is no drift
SPACING = 200_000_000  # ns between two samples of a clock
JUMP = 10**9  # ns that a topic has to go back, as it lies in the file, for another beginning
SLOWEST = 1e-3  # s of a clock in one of the recording; one that stands still is none
SHORTEST_RUN = 10  # messages of one topic between two beginnings, on average
Source = tuple[str, str]  # topic, and child frame of a transform


class Clock:
    """Offsets of one clock to that of the recording, ns, in the order of recording."""

    def __init__(self, samples: Iterable[tuple[int, int]]) -> None:
        kept = _without_spikes(sorted(samples))
        self._recorded, self._offsets, self._leaps = array("q"), array("q"), array("q")
        slope, leap = _drift_rate(kept), 0
        for (before, offset_before), (recorded, offset) in zip(kept[:1] + kept[:-1], kept, strict=True):
            lapse = recorded - before
            step = offset - offset_before - slope * lapse
            if abs(step) > max(STEP, 2.0 * (1.0 + abs(slope)) * lapse):  # it was set, or began again
                leap += round(-step) if step < -LEAP else 0
                self._add_sample(recorded - 1, offset_before, self._leaps[-1])
            self._add_sample(recorded, offset, leap)

    def _add_sample(self, recorded: int, offset: int, leap: int) -> None:
        self._recorded.append(recorded)
        self._offsets.append(offset)
        self._leaps.append(leap)

    def __bool__(self) -> bool:
        return len(self._recorded) > 0

    def offset(self, recorded: int) -> int:
        """Return the time of recording less that of the clock, ns."""
        after = bisect_right(self._recorded, recorded)
        if after in (0, len(self._recorded)):
            return self._offsets[min(after, len(self._recorded) - 1)]
        before, lapse = after - 1, self._recorded[after] - self._recorded[after - 1]
        change = self._offsets[after] - self._offsets[before]
        return self._offsets[before] + (change * (recorded - self._recorded[before]) // lapse if change else 0)

    def leap(self, recorded: int) -> int:
        """Return by how much the clock has been set ahead since the begin, ns."""
        return self._leaps[max(bisect_right(self._recorded, recorded) - 1, 0)]

    def has_leapt(self) -> bool:
        """Return whether the clock was set ahead."""
        return bool(self._leaps[-1])

    def rate(self) -> float:
        """Return how many of its own seconds pass in one of the recording."""
        return 1.0 - _drift_rate(list(zip(self._recorded, self._offsets, strict=True)))

    def lag_range(self, other: Clock) -> tuple[int, int]:
        """Return by how much it is behind another clock, ns: a tenth of 200 samples is less, a tenth more."""
        places = self._recorded[:: max(len(self._recorded) // 200, 1)]
        low, high = np.quantile([self.offset(recorded) - other.offset(recorded) for recorded in places], (0.1, 0.9))
        return int(low), int(high)


def _drift_rate(samples: list[tuple[int, int]]) -> float:
    """Return by how much an offset grows in a ns of the recording, by the median over twenty parts."""
    recorded, offsets = np.array(samples, np.int64).reshape(-1, 2).T
    place = np.unique(np.linspace(0, max(len(recorded) - 1, 0), 21).astype(int))
    lapse = np.diff(recorded[place]) if len(recorded) else np.empty(0)
    known = lapse > 0
    return float(np.median(np.diff(offsets[place])[known] / lapse[known])) if known.any() else 0.0


def _without_spikes(samples: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return samples without single ones that are off both the one before and the one after."""
    kept = samples[:1]
    for sample, after in zip(samples[1:], [*samples[2:], samples[-1]], strict=False):
        spike = abs(sample[1] - kept[-1][1]) > LEAP and abs(after[1] - kept[-1][1]) < STEP
        if not spike:
            kept.append(sample)
    return kept


class Clocks:
    """Tells when messages were made, in ns of one clock; ``lines`` say what was found."""

    def __init__(
        self, main: Clock | None, own: Source, others: Mapping[Source, Clock], in_time: Sequence[bool]
    ) -> None:
        self._main, self._own, self._shifts, self.in_time = main, own, dict[Source, Clock | None](), in_time
        self.off = 0  # stamps that lie off their clock
        self.lines = _describe_main(main, own) if main is not None else []
        for source, clock in others.items():
            if main is None or source == own or not clock:
                continue
            low, high = clock.lag_range(main)
            agrees = -(FORESEEN if source[1] else AGREE) <= low and high <= AGREE
            self._shifts[source] = None if agrees else clock
            if not agrees:
                self.lines.append(
                    f"{source[0]}: its clock is {_lag_text(max(low, high, key=abs))} that of {own[0]}; shifted"
                )

    def is_reference(self, topic: str) -> bool:
        """Return whether a topic's stamps are those by which all others go."""
        return topic == self._own[0]

    def now(self, recorded: int) -> int:
        """Return when something was recorded."""
        return recorded if self._main is None else recorded - self._main.offset(recorded) - self._main.leap(recorded)

    def stamp(self, source: Source, recorded: int, own: int) -> int:
        """Return when something was made that has a stamp of its own, 0 for none."""
        expected = self.now(recorded)
        if self._main is None or own == 0 or (source != self._own and source not in self._shifts):
            return expected
        clock = self._shifts.get(source)
        shift = 0 if clock is None else clock.offset(recorded) - self._main.offset(recorded)
        made = own + shift - self._main.leap(recorded)
        if abs(made - expected) > LATEST:
            self.off += 1
            return expected
        return made


def _describe_main(clock: Clock, source: Source) -> list[str]:
    lines, rate = [], clock.rate()
    offset = clock.offset(0)
    if abs(rate - 1.0) > 0.01:
        lines.append(f"{source[0]}: its clock runs at {rate:.3g} times that of the recording; its seconds count")
    elif abs(offset) > AGREE:
        lines.append(f"{source[0]}: its clock is {_lag_text(offset)} that of the recording; its stamps count")
    if clock.has_leapt():
        lines.append(f"{source[0]}: its clock was set ahead; the time of recording bridges that")
    return lines


def _lag_text(lag: int) -> str:
    return f"{abs(lag) * 1e-9:.2f} s {'behind' if lag > 0 else 'ahead of'}"


def read_clocks(bags: Sequence[Bag], cast: RoleAssignment) -> Clocks:
    """Return the clocks of recordings, by reading the stamps of all that is stamped."""
    stamped = {channel.topic for role, channel in cast.by_role.items() if role in STAMPED}
    samples: dict[Source, list[tuple[int, int]]] = {}
    orders = [_read_samples(bag, stamped, samples) for bag in bags]
    known = {source: Clock(found) for source, found in samples.items()}
    for role in MOTION:
        channel = cast.by_role.get(role)
        topic = channel.topic if channel is not None else None
        running = [source for source, clock in known.items() if source[0] == topic and clock.rate() > SLOWEST]
        if running:
            longest = max(running, key=lambda source: len(samples[source]))
            return Clocks(known[longest], longest, known, orders)
    return Clocks(None, ("", ""), {}, orders)


def _read_samples(bag: Bag, topics: Collection[str], samples: dict[Source, list[tuple[int, int]]]) -> bool:
    """Add the samples of a recording; return whether it is to be read by time rather than as it lies in the file."""
    ranges: dict[Source, list[list[int]]] = {}
    for channel, recorded, content in bag.messages(topics, in_time=False):
        source, own = source_of(channel, content)
        if own <= 0:
            continue
        runs = ranges.setdefault(source, [])
        if not runs or recorded < runs[-1][2] - JUMP:
            runs.append([recorded, recorded, recorded, 0])
        runs[-1] = [min(runs[-1][0], recorded), max(runs[-1][1], recorded), recorded, runs[-1][3] + 1]
        found = samples.setdefault(source, [])
        if not found or abs(recorded - found[-1][0]) >= SPACING or abs(recorded - own - found[-1][1]) > STEP:
            found.append((recorded, recorded - own))
    return not any(_has_overlap(runs) for runs in ranges.values())


def _has_overlap(runs: list[list[int]]) -> bool:
    """Return whether one topic was recorded twice at a time: then the recorder's own clock began again,
    unless all are out of order.
    """
    if sum(run[3] for run in runs) < SHORTEST_RUN * len(runs):
        return False
    ordered = sorted(runs)
    return any(second[0] < first[1] - JUMP for first, second in pairwise(ordered))


def source_of(channel: Channel, content: bytes) -> tuple[Source, int]:
    """Return whose clock a message was stamped by and the stamp in ns, 0 for none, without decoding all of it."""
    try:
        if channel.type == of.TF:
            return (channel.topic, _child_frame(channel, content)), _read_stamp(channel, content, 8)
        bare = channel.type == of.CLOCK and channel.ros == 1
        return (channel.topic, ""), _read_stamp(channel, content, 0 if bare else 4) if channel.type in HEADED else 0
    except struct.error:
        return (channel.topic, ""), 0


HEADED = frozenset(
    {
        of.CLOCK,
        of.ODOMETRY,
        of.POSE_STAMPED,
        of.POSE_COVARIANCE,
        of.SCAN,
        of.TWIST_STAMPED,
        of.PATH,
        of.POSES,
        PEOPLE,
        of.GRID,
    }
)


def _byte_order(channel: Channel, content: bytes) -> str:
    return ">" if channel.ros == 2 and content[1:2] in (b"\x00", b"\x02") else "<"


def _read_stamp(channel: Channel, content: bytes, at: int) -> int:
    """Return a stamp that lies at a byte: behind the encapsulation in ROS 2, behind the sequence number in ROS 1."""
    seconds, nanoseconds = struct.unpack_from(
        _byte_order(channel, content) + ("iI" if channel.ros == 2 else "II"), content, at
    )
    return int(seconds) * 10**9 + int(nanoseconds)


def _child_frame(channel: Channel, content: bytes) -> str:
    """Return the child frame of the first transform of a message."""
    size = _byte_order(channel, content) + "I"
    at = 16
    length = struct.unpack_from(size, content, at)[0]
    at += 4 + length
    at += (-at) % 4 if channel.ros == 2 else 0
    length = struct.unpack_from(size, content, at)[0]
    return content[at + 4 : at + 4 + length].rstrip(b"\0").decode(errors="replace").lstrip("/")
