"""Records of episodes and the tables made of them: where they lie, how they are read and evaluated, what made them."""

from arena_core.contracts.running import Reporter
from arena_core.loop.record_digest import record_digest
from arena_core.loop.record_files import read_grid, read_record
from arena_core.loop.record_places import find_runs, record_path, record_paths, timing_paths
from arena_core.loop.recording import Recorder, robot_meta
from arena_core.runs.benchmark import build_metrics
from arena_core.runs.provenance import cpu_kind, read_provenance, untuned, versions
from arena_core.runs.repeating import repeat
from arena_core.runs.rows import COLUMNS as EPISODE_COLUMNS
from arena_core.runs.rows import TEXT, evaluate, metric_column
from arena_core.values.episode import Event, Outcome, WorldState
from arena_core.values.success import COLLISIONS_ALLOWED, succeeded

__all__ = [
    "COLLISIONS_ALLOWED",
    "EPISODE_COLUMNS",
    "TEXT",
    "Event",
    "Outcome",
    "Recorder",
    "Reporter",
    "WorldState",
    "build_metrics",
    "cpu_kind",
    "evaluate",
    "find_runs",
    "metric_column",
    "read_grid",
    "read_provenance",
    "read_record",
    "record_digest",
    "record_path",
    "record_paths",
    "repeat",
    "robot_meta",
    "succeeded",
    "timing_paths",
    "untuned",
    "versions",
]
