"""Replays of a report's episodes, failures first, made by ``arena replay`` where it is installed: pages,
and pictures of failures.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

from arena_core import ArenaError
from arena_core.commands import Command
from arena_core.hosting import load_registry
from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.drives import number_episodes
from arena_metrics.pooling.outcomes import describe_outcome
from arena_metrics.pooling.runs import Episode

MOMENTS, SIDE = 3, 200  # of the picture of a failure: moments side by side, and pixels of each one's longer side


@dataclass(frozen=True, slots=True)
class Replay:
    """A page of one episode, by its name beside the report, its size in bytes; of a failure its
    ``picture``, a PNG as base64.
    """

    page: str
    size: int
    title: str
    verdict: str
    picture: str | None


def episode_anchor(cell: Cell, episode: Episode) -> str:
    """Return the name of an episode's row in the report, and of its replay."""
    return f"e-{cell.hash}-{episode.row['seed']}-{episode.row['episode']}"


def write_replays(cells: Cells, target: Path, most: int) -> dict[str, Replay]:
    """Write ``most`` replays into ``target``/replays, failures first; return them by
    the names of their episodes' rows.
    """
    command = _replay_command()
    if command is None or most <= 0:
        return {}
    found = {}
    for cell, episode, label in _failures_first(cells, most):
        name = episode_anchor(cell, episode)
        page = target / "replays" / f"{name}.html"
        with suppress(ArenaError):  # a record that cannot be replayed, of no known world say, has no replay
            found[name] = _write_replay(command, episode, page, f"{cells.name(cell)}, {label}")
    return found


def _write_replay(command: Command, episode: Episode, page: Path, title: str) -> Replay:
    asked = [str(episode.run.folder), str(episode.row["episode"])]
    _run_quietly(command, [*asked, f"out={page}"])
    shown = _failure_picture(command, asked) if episode.row.get("success") != 1.0 else None
    return Replay(f"replays/{page.name}", page.stat().st_size, title, describe_outcome(episode.row), shown)


def _failure_picture(command: Command, asked: Sequence[str]) -> str | None:
    """Return the picture of a failure, a PNG as base64; None where it cannot be drawn."""
    with TemporaryDirectory() as scratch, suppress(ArenaError):
        picture = Path(scratch, "picture.png")
        _run_quietly(command, [*asked, f"out={picture}", f"moments={MOMENTS}", f"side={SIDE}"])
        return base64.b64encode(picture.read_bytes()).decode() if picture.exists() else None
    return None


def total_size(replays: Mapping[str, Replay]) -> str:
    """Return how large all replays are together."""
    return f"{sum(replay.size for replay in replays.values()) / 1e6:.1f} MB"


def _replay_command() -> Command | None:
    registry = load_registry()
    if "replay" not in registry.names("command"):
        return None
    found: Command = registry.component("command", "replay").resolve()()
    return found


def _run_quietly(command: Command, words: Sequence[str]) -> None:
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        command.run(words)


def _failures_first(cells: Cells, most: int) -> Iterator[tuple[Cell, Episode, str]]:
    """Yield the first failures of all cells, one of each cell after the other, then successes in the same way."""
    queues = [
        [(cell, episode, label) for episode, label in number_episodes(cells, cell) if episode.record_path.exists()]
        for cell in cells.cells
    ]
    for failed in (True, False):
        rows = [[row for row in queue if (row[1].row.get("success") != 1.0) is failed] for queue in queues]
        for turn in range(max(map(len, rows), default=0)):
            for queue in rows:
                if turn < len(queue) and most > 0:
                    most -= 1
                    yield queue[turn]
