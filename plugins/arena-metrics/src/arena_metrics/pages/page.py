"""The report's page: one HTML file with everything inside it."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any, NamedTuple

from arena_metrics.pages.figures import Image
from arena_metrics.pages.headline import (
    OUTCOMES,
    ConditionGroup,
    factor_values,
    outcome_text,
    summary_sentences,
    table_groups,
    table_headings,
)
from arena_metrics.pages.profiles import PROFILES
from arena_metrics.pages.replays import Replay, episode_anchor, total_size
from arena_metrics.pooling.cells import VARIANT, Cell, Cells, config_differences
from arena_metrics.pooling.codes import other_code
from arena_metrics.pooling.drives import number_episodes
from arena_metrics.pooling.outcomes import describe_outcome
from arena_metrics.pooling.runs import Column, Episode, Run
from arena_metrics.pooling.summary import Summary
from arena_metrics.tables.cost import cost_table
from arena_metrics.tables.tables import BLOCK, Table, headline_columns, metric_tables

LINES = 60  # rows of the headline table before the rest is folded away
LARGE = 1.5  # scale of a picture that stands alone
PICTURES = 6  # pictures of cells before the rest is folded away
TITLE = ("planner", "robot", "world", "people")  # what the title of a single cell says
PICTURES_FIRST = 3  # most cells with which the pictures come ahead of the figures
CELLS_IN_FULL = 4 * BLOCK  # cells whose every metric is on the page
EPISODES = 600  # rows of the table of episodes
# beside the headline's metrics of an episode
BESIDE = ("collisions_people", "collisions_people_caused", "impact_speed", "goal_error")
KEYS = 80  # rows of the table of differing configuration keys
CELLS_COMPARED = 12  # columns of that table
PACKAGES = ("arena-", "numpy", "numba", "scipy", "shapely", "torch", "mujoco", "casadi", "ompl")


class Pooled(NamedTuple):
    """What the runs say together, the runs, and how many episodes were driven more than once."""

    summary: Summary
    runs: Sequence[Run]
    repeats: int


class PageTables(NamedTuple):
    """The tables of a report's page."""

    claims: Table | None
    ranking: Table | None
    pairs: Sequence[Table]
    levels: Table | None
    of_drives: Sequence[Table]
    problems: Table | None


class PageImages(NamedTuple):
    """The images of a report's page."""

    figures: Sequence[Image]
    pictures: Sequence[Image]
    climbing: Sequence[Image]


def render_page(
    pooled: Pooled, baseline: str | None, tables: PageTables, images: PageImages, replays: Mapping[str, Replay]
) -> str:
    """Return the page."""
    from jinja2 import Environment, StrictUndefined

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(
        (files("arena_metrics") / "templates" / "report.html.j2").read_text(encoding="utf-8")
    )
    first = {PROFILES, *(column.name for column, _ in headline_columns(pooled.summary))}
    return template.render(
        **_page_head(pooled.summary, baseline, pooled.runs, pooled.repeats),
        script=(files("arena_metrics") / "templates" / "report.js").read_text(encoding="utf-8"),
        style=(files("arena_metrics") / "templates" / "report.css").read_text(encoding="utf-8"),
        figures=[_embed_image(image) for image in images.figures if image.name in first],
        more_figures=[_embed_image(image) for image in images.figures if image.name not in first],
        pictures=[
            _cell_picture(pooled.summary.cells, image, LARGE if len(images.pictures) == 1 else 1.0)
            for image in images.pictures[:PICTURES]
        ],
        more_pictures=[_cell_picture(pooled.summary.cells, image) for image in images.pictures[PICTURES:]],
        of_drives=tables.of_drives,
        pictures_first=len(pooled.summary.cells.cells) <= PICTURES_FIRST,
        pictures_left_out=len(pooled.summary.cells.cells) - len(images.pictures),
        claims=tables.claims,
        ranking=tables.ranking,
        pairs=tables.pairs,
        levels=tables.levels,
        problems=tables.problems,
        cost=cost_table(pooled.summary.cells),
        climbing=[_embed_image(image) for image in images.climbing],
        tables=_all_tables(pooled.summary),
        cells_in_full=CELLS_IN_FULL,
        replays=replays,
        replays_size=total_size(replays),
        failures=[replay for replay in replays.values() if replay.picture is not None],
        **_episode_table(pooled.summary),
        **_provenance_facts(pooled.summary.cells, pooled.runs),
    )


def _page_head(summary: Summary, baseline: str | None, runs: Sequence[Run], repeats: int) -> dict[str, Any]:
    cells = summary.cells
    episodes = [episode for cell in cells.cells for episode in cell.episodes]
    shown, folded = _split_groups(table_groups(summary))
    return {
        "title": _page_title(cells),
        "common": {k: v for k, v in cells.common.items() if len(cells.cells) > 1 or k not in TITLE},
        "counts": {"runs": len(runs), "cells": len(cells.cells), "episodes": len(episodes), "repeats": repeats},
        "seeds": _format_ranges(sorted({episode.row["seed"] for episode in episodes})),
        "answers": summary_sentences(summary, baseline),
        "other_code": other_code(cells),
        "untuned": sorted({note for run in runs for note in run.provenance.get("untuned") or []}),
        "headings": table_headings(summary),
        "groups": shown,
        "folded": folded,
        "outcomes": [
            OUTCOMES[kind] for kind in OUTCOMES if any(outcome_text(episode.row) == kind for episode in episodes)
        ],
        "failed": [episode for episode in episodes if episode.row["outcome"] == "error"],
        "cells": cells,
    }


def _page_title(cells: Cells) -> str:
    """Return what was compared, or what the one cell is."""
    if len(cells.cells) == 1:
        factors = cells.cells[0].factors
        parts = [factors[f] for f in TITLE if f != "people"]
        return " · ".join([*parts, f"{factors['people']} people"] if factors["people"] else parts)
    nouns = {"planner": "planners", "robot": "robots", "world": "worlds", "people": "crowd sizes", VARIANT: "variants"}
    counts = {f: len({cell.factors[f] for cell in cells.cells}) for f in cells.varying if f in nouns}
    single = [cells.common[f] for f in ("planner", "robot", "world") if f in cells.common]
    compared = " × ".join(f"{n} {nouns[f]}" for f, n in counts.items()) or f"{len(cells.cells)} cells"
    return " · ".join([compared, *single])


def _split_groups(all_groups: Sequence[ConditionGroup]) -> tuple[list[ConditionGroup], list[ConditionGroup]]:
    """Split the headline table where it grows too long, inside a group if need be."""
    shown: list[ConditionGroup] = []
    folded: list[ConditionGroup] = []
    room = LINES
    for group in all_groups:
        if group.lines[:room]:
            shown.append(ConditionGroup(group.condition, group.lines[:room]))
        if group.lines[room:]:
            folded.append(ConditionGroup(group.condition, group.lines[room:]))
        room = max(0, room - len(group.lines))
    return shown, folded


def _format_ranges(numbers: Sequence[int]) -> str:
    """Return whole numbers in short, runs of them as a range."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][-1] + 1:
            parts[-1].append(number)
        else:
            parts.append([number])
    return ", ".join(str(p[0]) if len(p) == 1 else f"{p[0]}–{p[-1]}" for p in parts)


def _embed_image(image: Image, scale: float = 1.0) -> dict[str, Any]:
    return {
        "name": image.name,
        "caption": image.caption,
        "width": round(scale * image.width),
        "data": base64.b64encode(image.png).decode(),
    }


def _cell_picture(cells: Cells, image: Image, scale: float = 1.0) -> dict[str, Any]:
    """Return the picture of a cell with its episodes, whose numbers it shows."""
    cell = next(cell for cell in cells.cells if image.name == f"cell_{cell.hash}")
    return {
        **_embed_image(image, scale),
        "episodes": [_episode_reference(cell, episode, label) for episode, label in number_episodes(cells, cell)],
    }


def _episode_reference(cell: Cell, episode: Episode, label: str) -> dict[str, Any]:
    """Return an episode's number, the place of its row in the page, how it ended, and whether it was no success."""
    row = episode.row
    return {
        "label": label,
        "place": episode_anchor(cell, episode),
        "verdict": describe_outcome(row),
        "failed": row.get("success") != 1.0,
    }


def _all_tables(summary: Summary) -> list[tuple[str, list[Table]]]:
    shown = summary.cells.cells[:CELLS_IN_FULL]
    return [
        ("All episodes", metric_tables(summary, "all", shown)),
        ("Successful episodes only", metric_tables(summary, "successful", shown)),
    ]


def _episode_table(summary: Summary) -> dict[str, Any]:
    """Return the table of episodes: what identifies each, how it ended, and the headline's metrics."""
    columns = [column for column, _ in headline_columns(summary)] + [c for c in summary.columns if c.name in BESIDE]
    columns += summary.texts
    rows = [
        (cell, episode, _episode_reference(cell, episode, label))
        for cell in summary.cells.cells
        for episode, label in number_episodes(summary.cells, cell)
    ]
    if len(rows) > EPISODES:  # those that were no success are looked for
        rows.sort(key=lambda row: not row[2]["failed"])
    shown = {
        "episode_columns": columns,
        "episode_rows": rows[:EPISODES],
        "episodes_left_out": max(0, len(rows) - EPISODES),
    }
    return {
        **shown,
        "value": _format_value,
        "facts": lambda cell, episode: {**factor_values(summary.cells, cell), "outcome": outcome_text(episode.row)},
    }


def _format_value(episode: Episode, column: Column) -> str:
    """Return what the table of episodes shows of a metric: words for texts and for
    what was so or not, else a number.
    """
    value = episode.row.get(column.name, float("nan"))
    if isinstance(value, str):
        return value or "–"
    if column.is_proportion and value in (0.0, 1.0):
        return "yes" if value else "no"
    return "–" if value != value else f"{value:.4g}"


def _provenance_facts(cells: Cells, runs: Sequence[Run]) -> dict[str, Any]:
    compared = cells.cells[:CELLS_COMPARED]
    differing = config_differences([cell.config for cell in compared]) if len(compared) > 1 else {}
    versions: dict[str, set[str]] = {}
    for run in runs:
        for name, version in run.provenance.get("versions", {}).items():
            versions.setdefault(name, set()).add(version)
    known = {name: ", ".join(sorted(found)) for name, found in sorted(versions.items())}
    return {
        "runs": [_run_facts(run) for run in runs],
        "versions": {name: version for name, version in known.items() if name.startswith(PACKAGES)},
        "other_versions": {name: version for name, version in known.items() if not name.startswith(PACKAGES)},
        "compared": compared,
        "differing": dict(list(differing.items())[:KEYS]),
        "differing_left_out": max(0, len(differing) - KEYS),
        "configs": [(cells.name(cell), _config_text(cell.config)) for cell in compared],
    }


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


def _config_text(config: Mapping[str, Any]) -> str:
    return json.dumps(config, indent=2, ensure_ascii=False)
