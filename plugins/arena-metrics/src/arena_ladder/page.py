"""The ladder's page: curves of all planners, breaking densities by cell, and a sentence for each pair."""

from __future__ import annotations

import base64
import html
import json
from collections.abc import Sequence
from pathlib import Path

from arena_core.files import csv_text, write_text_whole
from arena_ladder.comparing import compare_ladders, summary_sentences
from arena_ladder.results import SHARES, Ladder, ladder_document
from arena_metrics.pages.figures import report_style
from arena_metrics.pages.ladders import ladder_image
from arena_metrics.pooling.ladders import parse_ladder_document

HEAD = ["planner", "robot", "world", "crowd", "success", "share", "density", "low", "high", "text", "episodes"]
STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:70rem;margin:2rem auto;padding:0 1rem}"
    "table{border-collapse:collapse;margin:1rem 0}"
    "td,th{padding:.25rem .7rem;border-bottom:1px solid #ddd;text-align:left}"
    "img{max-width:100%}@media(prefers-color-scheme:dark){body{background:#181818;color:#ddd}img{background:#fff}}"
)
MANY = 10  # pairs, beyond which a summary stands before them
EXPLAINED = (
    "Breaking density: people per 100 m² of free ground at which success falls to .9, "
    "with its 95 % interval over maps. It counts what fails without people, too."
)


def write_page(ladders: Sequence[Ladder], out: Path) -> list[str]:
    """Write ``ladder.json``, ``ladder.csv``, ``ladder.png`` and ``ladder.html`` to ``out``; return what to print."""
    out.mkdir(parents=True, exist_ok=True)
    found = compare_ladders(ladders)
    sentences = [one.text() for one in found]
    summary = summary_sentences(found) if len(found) > MANY else []
    document = {"ladders": [ladder_document(ladder) for ladder in ladders], "pairs": sentences}
    write_text_whole(out / "ladder.json", json.dumps(document, indent=2) + "\n")
    write_text_whole(out / "ladder.csv", csv_text([HEAD, *_csv_rows(ladders)]))
    with report_style():
        image = ladder_image(parse_ladder_document(document, str(out)), pdf=False)
    assert image is not None
    picture = image.png
    (out / "ladder.png").write_bytes(picture)
    write_text_whole(out / "ladder.html", _render(ladders, summary, sentences, picture))
    return [*_table_lines(ladders), *_left_out(ladders), *sentences, *summary, f"written: {out / 'ladder.html'}"]


def breaking_table(ladders: Sequence[Ladder], *, strict: bool = False) -> list[list[str]]:
    """Return a row for each cell, and in it the breaking density of .9 of each planner."""
    cells = list(dict.fromkeys(name for ladder in ladders for name in ladder.plan.names))
    return [
        ["world", "crowd", *(ladder.name for ladder in ladders)],
        *(_table_row(ladders, c, strict=strict) for c in cells),
    ]


def _table_row(ladders: Sequence[Ladder], cell: str, *, strict: bool) -> list[str]:
    texts = []
    for ladder in ladders:
        curve = ladder.strict if strict else ladder.success
        there = cell in ladder.plan.names
        texts.append(curve.breaking[SHARES[0]][ladder.plan.names.index(cell)].text() if there else "–")
    return [*cell.split("_", 1), *texts]


def _table_lines(ladders: Sequence[Ladder]) -> list[str]:
    from arena_core.commands import align_columns

    return align_columns(breaking_table(ladders))


def _left_out(ladders: Sequence[Ladder]) -> list[str]:
    """Return a sentence for each cell in which people found no room on some rungs."""
    return [
        f"{ladder.name}, {name.replace('_', ', ')}: rungs left out, no room: {', '.join(f'{rung:g}' for rung in rungs)}"
        for ladder in ladders
        for name in ladder.plan.names
        if (rungs := ladder.without_room(name))
    ]


def _csv_rows(ladders: Sequence[Ladder]) -> list[list[object]]:
    rows: list[list[object]] = []
    for ladder in ladders:
        curves = [("success", ladder.success), ("strict_success", ladder.strict)]
        curves += [("clairvoyant", ladder.limit)] if ladder.limit is not None else []
        for i, name in enumerate(ladder.plan.names):
            for kind, curve in curves:
                for share in SHARES:
                    one = curve.breaking[share][i]
                    figures = [share, one.value, one.low, one.high, one.text(), int(curve.episodes[i].sum())]
                    rows.append([ladder.planner, ladder.robot, *name.split("_", 1), kind, *figures])
    return rows


def _render(ladders: Sequence[Ladder], summary: Sequence[str], sentences: Sequence[str], picture: bytes) -> str:
    said = _paragraphs([*sentences, *_left_out(ladders)])
    if summary:
        said = f"{_paragraphs(summary)}<details><summary>All {len(sentences)} pairs</summary>{said}</details>"
    figure = base64.b64encode(picture).decode()
    tables = "".join(
        f"<h2>{title}</h2>{_html_table(breaking_table(ladders, strict=strict))}"
        for title, strict in (("Breaking density of success", False), ("Breaking density of strict success", True))
    )
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Ladder</title><style>{STYLE}</style>'
        f"<h1>Among how many people they break</h1>{said}<p>{EXPLAINED}</p>"
        f'<img alt="Success over density, a panel for each world and crowd" src="data:image/png;base64,{figure}">'
        f"{tables}</html>\n"
    )


def _paragraphs(texts: Sequence[str]) -> str:
    return "".join(f"<p>{html.escape(text)}</p>" for text in texts)


def _html_table(rows: Sequence[Sequence[str]]) -> str:
    head, *body = ["".join(f"<{{0}}>{html.escape(text)}</{{0}}>" for text in row) for row in rows]
    lines = "".join(f"<tr>{row.format('td')}</tr>" for row in body)
    return f"<table><tr>{head.format('th')}</tr>{lines}</table>"
