"""What a report says: its tables, images, replays and facts, each computed once, for its page, its files and the
terminal alike.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from arena_core import InputFileError
from arena_metrics.claims.claim_verdicts import claims_table, judge_claims
from arena_metrics.claims.model import read_claims
from arena_metrics.pages.definitions import Definition, definitions_of
from arena_metrics.pages.episodes import EpisodeTable, episode_table
from arena_metrics.pages.headline import Headline, make_headline, summary_sentences
from arena_metrics.pages.images import ReportImages
from arena_metrics.pages.ladders import ladder_tables
from arena_metrics.pages.levels import level_table
from arena_metrics.pages.options import ReportOptions
from arena_metrics.pages.page_head import PageHead, page_head
from arena_metrics.pages.provenance import Provenance, provenance_of
from arena_metrics.pages.replays import Replay, total_size
from arena_metrics.pooling.cells import Cells, cells_with_certificates
from arena_metrics.pooling.certificates import certificate_episodes
from arena_metrics.pooling.drives import Drive, drives_of
from arena_metrics.pooling.ladders import LadderDocument, ladders_below
from arena_metrics.pooling.runs import Run, metric_columns, pool_episodes
from arena_metrics.pooling.summary import Summary, summarise_cells
from arena_metrics.tables.cause_table import cause_table, failures_to_explain
from arena_metrics.tables.cost import cost_table
from arena_metrics.tables.pairs import paired_tables
from arena_metrics.tables.people_table import people_table
from arena_metrics.tables.problem_table import problem_table
from arena_metrics.tables.ranking import ranking_table
from arena_metrics.tables.repeats import distances_table, repeats_table
from arena_metrics.tables.tables import BLOCK, Table, headline_table, metric_tables

CELLS_IN_FULL = 4 * BLOCK  # cells whose every metric is on the page


@dataclass(frozen=True, slots=True, eq=False)
class PooledRuns:
    """Runs, what they say together, how many of their episodes were driven more than once, and their ladders."""

    runs: Sequence[Run]
    summary: Summary
    repeats: int
    ladders: LadderDocument | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ReportTables:
    """The tables of a report, None where there is nothing to say; ``of_drives`` by file are those that need records."""

    claims: Table | None
    headline: Table
    ranking: Table | None
    all_episodes: Sequence[Table]
    successful_episodes: Sequence[Table]
    pairs: Sequence[Table]
    causes: Table | None
    levels: Table | None
    problems: Table | None
    cost: Table | None
    people: Table | None
    ladders: Sequence[Table] = ()
    of_drives: Mapping[str, Table] = field(default_factory=dict)

    def by_file(self) -> dict[str, Sequence[Table]]:
        """Return the tables by the names of the files that hold them."""
        found: dict[str, Sequence[Table]] = {
            "claims": _present(self.claims),
            "headline": [self.headline],
            "ranking": _present(self.ranking),
            "all_episodes": self.all_episodes,
            "successful_episodes": self.successful_episodes,
            "paired_differences": self.pairs,
            "causes": _present(self.causes),
            "levels": _present(self.levels),
            "problems": _present(self.problems),
            "cost": _present(self.cost),
            "cost_to_people": _present(self.people),
            "ladders": self.ladders,
        }
        return {name: tables for name, tables in found.items() if tables}


def _present(table: Table | None) -> list[Table]:
    return [table] if table else []


@dataclass(frozen=True, slots=True, eq=False)
class ReportContent:
    """All that a report shows: ``answers`` are its first sentences, ``in_full`` the tables of all metrics of the first
    cells, ``to_explain`` the number of failures whose cause is not known.
    """

    head: PageHead
    answers: Sequence[str]
    headline: Headline
    tables: ReportTables
    in_full: Mapping[str, Sequence[Table]]
    images: ReportImages
    replays: Mapping[str, Replay]
    episodes: EpisodeTable
    provenance: Provenance
    definitions: Mapping[str, Definition]
    to_explain: int
    ladders: LadderDocument | None = None

    @property
    def failures(self) -> list[Replay]:
        """Return the replays of episodes that were no success, which have a picture."""
        return [replay for replay in self.replays.values() if replay.picture is not None]

    @property
    def replays_size(self) -> str:
        """Return how large all replays are together."""
        return total_size(self.replays)


def pool_runs(runs: Sequence[Run], columns: Sequence[str] = ()) -> PooledRuns:
    """Return what runs say together, with these ``columns`` in the headline; raise InputFileError where they hold no
    episode, or not such a column.
    """
    episodes, repeats = pool_episodes(runs)
    if not episodes:
        raise InputFileError(
            f"{runs[0].folder / 'episodes.csv'}: holds no episode yet; allowed: a run with one finished episode or more"
        )
    cells, certificates = cells_with_certificates(episodes, certificate_episodes(runs))
    summary = summarise_cells(cells, metric_columns(runs), certificates)
    known = [column.name for column in summary.columns]
    if missing := [name for name in columns if name not in known]:
        raise InputFileError(f"report.columns names {missing[0]}; allowed: {', '.join(known)}")
    return PooledRuns(runs, replace(summary, headline=columns), repeats, ladders_below(run.folder for run in runs))


def read_drives(cells: Cells, pictures: int) -> dict[str, list[Drive]]:
    """Read the records of the cells that are drawn, by the cells' hashes."""
    return {cell.hash: drives_of(cells, cell) for cell in cells.cells[: max(0, pictures)]}


def compute_tables(summary: Summary, options: ReportOptions, ladders: LadderDocument | None = None) -> ReportTables:
    """Return the tables of a summary, and what it says of the claims asked for and of ladders."""
    return ReportTables(
        _judge_claims(summary, options.claims) if options.claims else None,
        headline_table(summary),
        ranking_table(summary),
        metric_tables(summary, "all"),
        metric_tables(summary, "successful"),
        paired_tables(summary, options.baseline),
        cause_table(summary.cells),
        level_table(summary.cells),
        problem_table(summary.cells, summary.columns),
        cost_table(summary.cells),
        people_table(summary),
        ladder_tables(ladders) if ladders is not None else (),
    )


def _judge_claims(summary: Summary, name: str) -> Table:
    claims = read_claims(name)
    return claims_table(judge_claims(summary.cells.competing, summary.columns, claims), claims.source)


def compute_tables_of_drives(summary: Summary, drives: Mapping[str, Sequence[Drive]]) -> dict[str, Table]:
    """Return, by file, what the records of the cells drawn say together: repeats of one problem, and planners on the
    same scenarios.
    """
    found = {"repeats": repeats_table(summary.cells, drives), "path_distances": distances_table(summary.cells, drives)}
    return {name: table for name, table in found.items() if table is not None}


def gather_content(
    pooled: PooledRuns,
    baseline: str | None,
    tables: ReportTables,
    images: ReportImages,
    replays: Mapping[str, Replay],
) -> ReportContent:
    """Return the content of a report whose tables, images and replays are there."""
    summary = pooled.summary
    shown = summary.shown.cells[:CELLS_IN_FULL]
    return ReportContent(
        page_head(summary.cells, pooled.runs, pooled.repeats),
        summary_sentences(summary, baseline),
        make_headline(summary),
        tables,
        {
            "All episodes": metric_tables(summary, "all", shown),
            "Successful episodes only": metric_tables(summary, "successful", shown),
        },
        images,
        replays,
        episode_table(summary),
        provenance_of(summary.cells, pooled.runs),
        definitions_of(summary),
        failures_to_explain(summary.cells),
        pooled.ladders,
    )
