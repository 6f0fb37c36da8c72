"""``arena choices``: how often a switch chooses each of its members, and how it fares."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import ClassVar

from arena_aio.planner import Aio
from arena_core import ConfigurationError, EpisodeRecord
from arena_core.commands import Command, complete_overrides
from arena_core.hosting import Benchmark, build_benchmark, compose, load_registry, to_plain
from arena_core.records import is_success

USAGE = "usage: arena choices planner=aio robot=NAME [episodes=15] [seed=0] [KEY=VALUE ...]"


class ChoicesCommand(Command):
    """Drive the episodes of a benchmark and count decisions."""

    help: ClassVar[str] = "how often a switch chooses each member: arena choices planner=aio robot=jackal"

    def run(self, arguments: Sequence[str]) -> int:
        """Drive and print decisions by member, successes and collisions; return 1 when an episode failed.

        Nothing is kept.
        """
        if any(word in ("-h", "--help") for word in arguments):
            print(USAGE)
            return 0
        benchmark = build_benchmark(to_plain(compose(arguments)), load_registry())
        planner = benchmark.navigator.planner
        if not isinstance(planner, Aio):
            raise ConfigurationError(
                f"planner is {benchmark.config['planner']['name']}; allowed: a switch, such as planner=aio"
            )
        chosen: Counter[str] = Counter()
        collisions, successes, failed = [], [], 0
        for episode, record in enumerate(_run_episodes(benchmark)):
            if record.meta["outcome"] == "error":
                print(f"episode {episode}: {record.meta['error']}", file=sys.stderr)
                failed = 1
                continue
            chosen.update(planner.chosen)
            collisions.append(len(record["contact_stamp"]))
            successes.append(is_success(record))
        print("\n".join(_report_lines(chosen, successes, collisions)))
        return failed

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return overrides, those of a run."""
        return complete_overrides(words, word)


def _run_episodes(benchmark: Benchmark) -> Iterator[EpisodeRecord]:
    with TemporaryDirectory() as folder:
        for episode in range(benchmark.settings.episodes):
            yield benchmark.run(episode, Path(folder))


def _report_lines(chosen: Counter[str], successes: Sequence[bool], collisions: Sequence[int]) -> list[str]:
    decisions, episodes = max(chosen.total(), 1), max(len(successes), 1)
    shares = [f"{name}: {count} of {decisions} decisions, {count / decisions:.3f}" for name, count in chosen.items()]
    success, hits = sum(successes) / episodes, sum(collisions) / episodes
    return [*shares, f"success {success:.3f}, collisions an episode {hits:.3f}, {len(successes)} episodes"]
