"""Records of episodes and the tables made of them: where they lie, how they are read and evaluated, what made them."""

from arena_core.contracts.running import Better, Export, Reference, Reporter
from arena_core.loop.finding_files import FindingColumn, FindingMark, Findings, read_findings, write_findings
from arena_core.loop.record_digest import record_digest
from arena_core.loop.record_files import read_grid, read_record
from arena_core.loop.record_places import find_runs, record_path, record_paths, timing_paths
from arena_core.loop.recording import Recorder, RecordingSettings, robot_meta
from arena_core.runs.folders.provenance import cpu_kind, installed_versions, missing_tunings, read_provenance
from arena_core.runs.jobs.benchmark import build_metrics
from arena_core.runs.jobs.repeating import repeat_episodes
from arena_core.runs.jobs.rows import COLUMNS as EPISODE_COLUMNS
from arena_core.runs.jobs.rows import TEAM_TEXTS, TEXT, evaluate_record, metric_column
from arena_core.values.episode import Event, Outcome, WorldState
from arena_core.values.success import ARRIVAL_SLACK, COLLISIONS_ALLOWED, is_success

__all__ = [
    "ARRIVAL_SLACK",
    "COLLISIONS_ALLOWED",
    "EPISODE_COLUMNS",
    "TEAM_TEXTS",
    "TEXT",
    "Better",
    "Event",
    "Export",
    "FindingColumn",
    "FindingMark",
    "Findings",
    "Outcome",
    "Recorder",
    "RecordingSettings",
    "Reference",
    "Reporter",
    "WorldState",
    "build_metrics",
    "cpu_kind",
    "evaluate_record",
    "find_runs",
    "installed_versions",
    "is_success",
    "metric_column",
    "missing_tunings",
    "read_findings",
    "read_grid",
    "read_provenance",
    "read_record",
    "record_digest",
    "record_path",
    "record_paths",
    "repeat_episodes",
    "robot_meta",
    "timing_paths",
    "write_findings",
]
