"""Which topic of a recording means what: said by the user, or guessed by type and name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from pathlib import Path

from arena_core import ConfigurationError
from arena_core.files import read_yaml
from arena_ros.bags.stream import Channel

ROBOTS = ("odometry", "scan", "command", "estimate")  # roles whose topics tell the namespace of a robot
NONE = "none"  # what the user says of a role that no topic is to have


@dataclass(frozen=True, slots=True)
class Role:
    """What a topic can mean: of which types it is, and how it is usually called."""

    types: tuple[str, ...]
    names: tuple[str, ...]
    only_by_name: bool


@lru_cache(maxsize=1)
def all_roles() -> Mapping[str, Role]:
    """Return all roles by name."""
    content = read_yaml(Path(str(files("arena_ros") / "topics.yaml")), "the topics of this package")
    return {
        name: Role(tuple(role["types"]), tuple(role["names"]), bool(role.get("only_by_name")))
        for name, role in content.items()
    }


@dataclass(frozen=True, slots=True, eq=False)
class RoleAssignment:
    """Who plays which role: channels by role, and lines on what was guessed."""

    by_role: Mapping[str, Channel]
    guesses: tuple[str, ...]


def assign_roles(channels: Mapping[Channel, int], said: Mapping[str, str]) -> RoleAssignment:
    """Give roles to channels, which have these numbers of messages; raise ConfigurationError for a topic
    that is not there or of no use.
    """
    found: dict[str, Channel] = {}
    guesses, space = [], common_namespace(channels)
    for name, role in all_roles().items():
        fitting = {channel: count for channel, count in channels.items() if channel.type in role.types and count}
        if name in said:
            if said[name] != NONE:
                found[name] = _given_channel(name, role, said[name], channels)
        elif fitting and (channel := _guess_channel(role, fitting, space)) is not None:
            found[name] = channel
            if (len(fitting) > 1 and not role.only_by_name) or channel.topic != role.names[0]:
                others = sorted(other.topic for other in fitting if other is not channel)
                guesses.append(
                    f"{name} is taken from {channel.topic}" + (f" (not from {', '.join(others[:4])})" if others else "")
                )
    return RoleAssignment(found, tuple(guesses))


def _given_channel(name: str, role: Role, topic: str, channels: Mapping[Channel, int]) -> Channel:
    there = [channel for channel in channels if channel.topic == topic]
    if not there:
        fitting = sorted(channel.topic for channel in channels if channel.type in role.types)
        raise ConfigurationError(
            f"{name} is {topic}, which is not recorded; allowed: "
            f"{', '.join(fitting) or 'none of what is there'}, or none"
        )
    if there[0].type not in role.types:
        raise ConfigurationError(
            f"{name} is {topic}, which is a {there[0].type}; allowed: a topic of {' or '.join(role.types)}"
        )
    return there[0]


def common_namespace(channels: Iterable[Channel]) -> str:
    """Return the namespace in which all topics of the one robot lie, ``/robot1``; empty where
    there are several, or none.
    """
    found = set()
    for role in (all_roles()[name] for name in ROBOTS):
        for channel in channels:
            topic, names = (
                absolute_topic(channel.topic),
                [name for name in role.names if absolute_topic(channel.topic).endswith(name)],
            )
            if names and channel.type in role.types:
                found.add(topic.removesuffix(max(names, key=len)))
    return found.pop() if len(found) == 1 else ""


def absolute_topic(topic: str) -> str:
    """Return a topic as it is called from anywhere: some bags leave out the slash that it begins with."""
    return topic if topic.startswith("/") else f"/{topic}"


def _guess_channel(role: Role, fitting: Mapping[Channel, int], space: str) -> Channel | None:
    # transforms, map and clock may be common to all robots
    for name in [*(space + name for name in role.names), *role.names]:
        for channel in fitting:
            if absolute_topic(channel.topic) == name:
                return channel
    if role.only_by_name:
        return None
    own = {
        within + name
        for other in all_roles().values()
        if other is not role
        for name in other.names
        for within in ("", space)
    }
    others = [channel for channel in fitting if absolute_topic(channel.topic) not in own]
    return max(others, key=lambda channel: (fitting[channel], channel.topic), default=None)
