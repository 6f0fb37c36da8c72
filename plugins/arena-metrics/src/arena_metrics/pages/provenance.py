"""The page's provenance: runs, versions, and where the configurations of cells differ."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from arena_metrics.pages.tuned import tuned_rows
from arena_metrics.pooling.cells import Cells, config_differences
from arena_metrics.pooling.runs import Run

KEYS = 80  # rows of the table of differing configuration keys
CELLS_COMPARED = 12  # columns of that table
PACKAGES = ("arena-", "numpy", "numba", "scipy", "shapely", "torch", "mujoco", "casadi", "ompl")


@dataclass(frozen=True, slots=True, eq=False)
class Provenance:
    """Facts of each run, how planners were ``tuned``, versions of packages, and of the cells ``compared``, by name: the
    ``differing`` keys of their configurations, and these as text.
    """

    runs: Sequence[Mapping[str, str]]
    tuned: Sequence[Sequence[str]]
    versions: Mapping[str, str]
    other_versions: Mapping[str, str]
    compared: Sequence[str]
    differing: Mapping[str, Sequence[str]]
    differing_left_out: int
    configs: Sequence[tuple[str, str]]


def provenance_of(cells: Cells, runs: Sequence[Run]) -> Provenance:
    """Return where the figures of cells come from."""
    compared = cells.cells[:CELLS_COMPARED]
    differing = config_differences([cell.config for cell in compared]) if len(compared) > 1 else {}
    known = _joined_versions(runs)
    return Provenance(
        [_run_facts(run) for run in runs],
        tuned_rows(runs),
        {name: version for name, version in known.items() if name.startswith(PACKAGES)},
        {name: version for name, version in known.items() if not name.startswith(PACKAGES)},
        [cells.name(cell) for cell in compared],
        dict(list(differing.items())[:KEYS]),
        max(0, len(differing) - KEYS),
        [(cells.name(cell), json.dumps(cell.config, indent=2, ensure_ascii=False)) for cell in compared],
    )


def _joined_versions(runs: Sequence[Run]) -> dict[str, str]:
    """Return the versions of every package with which runs were made."""
    versions: dict[str, set[str]] = {}
    for run in runs:
        for name, version in run.provenance.get("versions", {}).items():
            versions.setdefault(name, set()).add(version)
    return {name: ", ".join(sorted(found)) for name, found in sorted(versions.items())}


def episodes_of(there: int, wanted: object) -> str:
    """Return how many episodes are there, of how many; a run that went on with fewer wanted has more than those."""
    return f"{there} of {wanted}" if isinstance(wanted, int) and there <= wanted else str(there)


def _run_facts(run: Run) -> Mapping[str, str]:
    known = run.provenance
    hashes = dict.fromkeys(str(row["config_hash"]) for row in run.rows)
    return {
        "folder": str(run.folder),
        "cell": ", ".join(hashes) or str(known.get("config_hash", "–")),
        "code": ", ".join(dict.fromkeys(str(row.get("code") or "–") for row in run.rows)) or "–",
        "seed": str(known.get("seed", "–")),
        "episodes": episodes_of(len(run.rows), known.get("episodes")),
        "commit": known.get("commit") or "–",
        "python": str(known.get("python", "–")),
        "machine": " ".join(str(v) for v in known.get("machine", {}).values()) or "–",
    }
