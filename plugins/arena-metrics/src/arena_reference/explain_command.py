"""``arena explain``: why episodes failed, and until when that could have been avoided."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import ClassVar

from arena_core import ConfigurationError, Run, Runs
from arena_core.commands import Command, align_columns, read_words
from arena_core.hosting import load_registry
from arena_reference.causes import CAUSES
from arena_reference.explaining import explain_run
from arena_reference.explanations import ExplainedEpisode

USAGE = "usage: arena explain DIR... [EPISODE...] [compare=PLANNER,PLANNER]"


class ExplainCommand(Command):
    """Explain the failures of runs; with compare=A,B in which causes two planners differ."""

    help: ClassVar[str] = "why episodes failed, and until when that was avoidable: arena explain DIR... [EPISODE...]"

    def run(self, arguments: Sequence[str]) -> int:
        """Print a sentence for each contact, failure and hold-up, and how often each cause was; write findings."""
        if any(word in ("-h", "--help") for word in arguments):
            print(USAGE)
            return 0
        words = read_words(USAGE, arguments, names=None, keys=("compare",))
        episodes = [int(name) for name in words.names if name.isdecimal()]
        folders = [name for name in words.names if not name.isdecimal()]
        if not folders:
            raise ConfigurationError(f"DIR is missing; allowed: {USAGE}")
        compared = words.value("compare", str, "").split(",") if "compare" in words.keys else []
        registry, counts = load_registry(), dict[str, tuple[int, Counter[str]]]()
        for run in Runs.below(*folders):
            name = planner_of(run)
            if compared and name not in compared:
                continue
            found = explain_run(run, registry, episodes or None)
            told = [text for one in found if one.contacts or episodes for text in one.sentences()]
            print("\n".join([f"{run.folder}: {name}", *(f"  {text}" for text in told)]), flush=True)
            before, causes = counts.get(name, (0, Counter()))
            counts[name] = (before + len(run.episodes), causes + _causes(found))
        if missing := [name for name in compared if name not in counts]:
            raise ConfigurationError(f"compare is {','.join(compared)}: no run of {missing[0]} there")
        if not episodes:
            print("\n".join(align_columns(_table(counts))))
        return 0


def planner_of(run: Run) -> str:
    """Return which preset of a planner drove."""
    return str(run.config.get("choices", {}).get("planner") or run.config["planner"]["name"])


def _causes(found: Sequence[ExplainedEpisode]) -> Counter[str]:
    return Counter(one.cause for episode in found for one in episode.contacts if one.decided)


def _table(counts: Mapping[str, tuple[int, Counter[str]]]) -> list[list[str]]:
    """Return how many episodes failed by each cause, a column a planner."""
    head = ["cause", *(f"{name} (n={episodes})" for name, (episodes, _) in counts.items())]
    seen = [cause for cause in CAUSES if any(causes[cause] for _, causes in counts.values())]
    rows = [[cause, *(str(causes[cause]) for _, causes in counts.values())] for cause in seen]
    fine = ["strict success", *(str(episodes - causes.total()) for episodes, causes in counts.values())]
    return [head, *rows, fine]
