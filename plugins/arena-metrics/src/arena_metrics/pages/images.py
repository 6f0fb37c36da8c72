"""The images of a report: figures of metrics, pictures of cells and figures of levels, as files and as the page shows
them.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from arena_metrics.pages.causes import CAUSES, causes_image
from arena_metrics.pages.episodes import EpisodeReference, episode_references
from arena_metrics.pages.figures import Image, metric_figures, report_style
from arena_metrics.pages.ladders import ladder_image
from arena_metrics.pages.levels import level_image
from arena_metrics.pages.options import ReportOptions
from arena_metrics.pages.panels import picture_layouts
from arena_metrics.pages.people import PEOPLE, people_image
from arena_metrics.pages.possible import POSSIBLE, possible_image
from arena_metrics.pages.profiles import PROFILES, profile_image
from arena_metrics.pages.trajectories import cell_image
from arena_metrics.pooling.cells import Cells
from arena_metrics.pooling.drives import Drive
from arena_metrics.pooling.ladders import LadderDocument
from arena_metrics.pooling.summary import Summary
from arena_metrics.tables.tables import headline_columns

LARGE = 1.5  # scale of a picture that stands alone
PICTURES_FIRST = 3  # most cells with which the pictures come ahead of the figures


@dataclass(frozen=True, slots=True, eq=False)
class DrawnImages:
    """All images drawn: figures of metrics, pictures of cells, figures of levels and of ladders."""

    figures: Sequence[Image] = ()
    pictures: Sequence[Image] = ()
    levels: Sequence[Image] = ()
    ladders: Sequence[Image] = ()

    def __iter__(self) -> Iterator[Image]:
        yield from (*self.figures, *self.pictures, *self.levels, *self.ladders)


@dataclass(frozen=True, slots=True, eq=False)
class ShownImage:
    """An image as a page shows it: ``width`` in CSS pixels, ``data`` a PNG as base64; a cell's picture has episodes."""

    name: str
    caption: str
    width: int
    data: str
    episodes: Sequence[EpisodeReference] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ReportImages:
    """The images of a page, the headline's figures apart from those of other metrics; ``people``: what it cost them."""

    people: Sequence[ShownImage]
    figures: Sequence[ShownImage]
    more_figures: Sequence[ShownImage]
    pictures: Sequence[ShownImage]
    levels: Sequence[ShownImage]
    ladders: Sequence[ShownImage]
    pictures_left_out: int
    pictures_first: bool


def draw_images(
    summary: Summary,
    drives: Mapping[str, Sequence[Drive]],
    options: ReportOptions,
    ladders: LadderDocument | None = None,
) -> DrawnImages:
    """Draw the figures of metrics, pictures and levels; nothing where no figures are asked for."""
    if options.figures == "none":
        return DrawnImages()
    cells, pdf = summary.cells, options.pdf
    columns = summary.columns if options.figures == "all" else [column for column, _ in headline_columns(summary)]
    panels = picture_layouts(cells, drives)
    with report_style():
        first = [
            people_image(summary, pdf=pdf),
            possible_image(cells, pdf=pdf),
            causes_image(cells, pdf=pdf),
            profile_image(summary, pdf=pdf),
        ]
        levels = level_image(cells, pdf=pdf)
        climbed = ladder_image(ladders, pdf=pdf) if ladders is not None else None
        return DrawnImages(
            [*filter(None, first), *metric_figures(cells, columns, pdf=pdf)],
            [
                cell_image(cells, cell, drives[cell.hash], panels[cells.condition(cell)], pdf=pdf)
                for cell in cells.cells
                if drives.get(cell.hash)
            ],
            [levels] if levels else [],
            [climbed] if climbed else [],
        )


def show_images(summary: Summary, drawn: DrawnImages) -> ReportImages:
    """Return the images of a report as its page shows them."""
    first = {POSSIBLE, CAUSES, PROFILES, *(column.name for column, _ in headline_columns(summary))}
    cells = summary.cells
    scale = LARGE if len(drawn.pictures) == 1 else 1.0
    return ReportImages(
        [_show_image(image) for image in drawn.figures if image.name == PEOPLE],
        [_show_image(image) for image in drawn.figures if image.name in first],
        [_show_image(image) for image in drawn.figures if image.name not in {PEOPLE, *first}],
        [_show_image(image, scale, _picture_episodes(cells, image)) for image in drawn.pictures],
        [_show_image(image) for image in drawn.levels],
        [_show_image(image) for image in drawn.ladders],
        len(cells.cells) - len(drawn.pictures),
        len(cells.cells) <= PICTURES_FIRST,
    )


def _picture_episodes(cells: Cells, image: Image) -> list[EpisodeReference]:
    """Return the episodes of a cell whose numbers its picture shows."""
    cell = next(cell for cell in cells.cells if image.name == f"cell_{cell.hash}")
    return episode_references(cells, cell)


def _show_image(image: Image, scale: float = 1.0, episodes: Sequence[EpisodeReference] | None = None) -> ShownImage:
    width, data = round(scale * image.width), base64.b64encode(image.png).decode()
    return ShownImage(image.name, image.caption, width, data, episodes)
