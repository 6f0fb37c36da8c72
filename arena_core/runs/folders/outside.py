"""Runs whose episodes were not driven by ``arena run``: those of a robot, or of a recording.

Their folder is a run's like any other.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from arena_core.base.errors import ConfigurationError
from arena_core.base.whole_files import write_text_whole
from arena_core.config.registry import Registry
from arena_core.loop.grain import round_arrays
from arena_core.loop.record_files import write_grid, write_record
from arena_core.runs.folders.provenance import NAME, make_provenance
from arena_core.runs.jobs.benchmark import build_metrics, config_hash
from arena_core.runs.jobs.code_digest import Code
from arena_core.runs.jobs.rows import evaluate_record, write_episodes
from arena_core.values.episode import EpisodeRecord
from arena_core.values.world import OccupancyGrid


class OutsideRun:
    """A run's folder that takes records one by one; on leaving the block its tables are written.

    ``config`` is the composed configuration, plain; ``code`` what drove, an empty one where that is not known. Raises
    ConfigurationError where a run is there already.
    """

    def __init__(
        self, folder: str | Path, config: Mapping[str, Any], registry: Registry, code: Code, notes: Sequence[str] = ()
    ) -> None:
        self.folder = Path(folder)
        if (self.folder / NAME).exists():
            raise ConfigurationError(f"{folder} holds a run already; allowed: a folder that is free")
        self._config, self._code, self._notes = dict(config), code, list(notes)
        self._packs = build_metrics(config, registry)
        self.rows: list[dict[str, Any]] = []

    def __enter__(self) -> OutsideRun:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.rows:
            facts = make_provenance({**self._config, "episodes": len(self.rows)}, self._code, self._notes)
            write_text_whole(self.folder / NAME, json.dumps(facts, indent=2, sort_keys=True) + "\n")
            write_episodes(self.folder, self.rows, self._packs)

    def grid(self, grid: OccupancyGrid) -> str:
        """Write a map to the run's folder and return its name there."""
        return write_grid(self.folder, grid)

    def add(self, record: EpisodeRecord) -> dict[str, Any]:
        """Write the next record and return its row; arrays are rounded as those of a simulation are."""
        number = len(self.rows)
        columns = {
            "config_hash": config_hash(self._config),
            "code": self._code.digest,
            **record.meta["columns"],
            "episode": number,
        }
        kept = EpisodeRecord(round_arrays(record.arrays), {**record.meta, "columns": columns}, record.timing)
        write_record(self.folder, number, kept)
        self.rows.append(evaluate_record(kept, self._packs))
        return self.rows[-1]
