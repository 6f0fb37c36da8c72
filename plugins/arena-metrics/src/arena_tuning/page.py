"""The report of a tuning: a page with the verdict, the figures on test, the values and the pictures."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

from arena_core.files import write_bytes_whole, write_text_whole
from arena_tuning.pictures import draw_curve, draw_importance, draw_pareto, draw_sensitivity
from arena_tuning.study import Plan, Search

STYLE = (
    "body{font:15px/1.5 sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem}table{border-collapse:collapse}"
    "td,th{padding:.2rem .8rem;text-align:right;border-bottom:1px solid #ccc}th:first-child,td:first-child"
    "{text-align:left}img{max-width:100%}"
)


def write_page(folder: Path, card: Mapping[str, Any], plan: Plan, search: Search) -> Path:
    """Write the page and its pictures to a folder; return the page."""
    pictures = {"curve": draw_curve(card["curve"])}
    if card.get("pareto"):
        pictures["pareto"] = draw_pareto(card)
    if card["importance"]:
        pictures["importance"] = draw_importance(card["importance"])
    if search.entrants:
        pictures["sensitivity"] = draw_sensitivity(search, plan.space.parameters)
    for name, content in pictures.items():
        write_bytes_whole(folder / f"{name}.png", content)
    parts = [
        f"<h1>{escape(title_of(card))}</h1>",
        f"<p><b>{escape(card['verdict'])}</b></p>",
        f"<p>{_budget_sentence(card)}</p>",
        _values_table(card),
        _pareto_table(card),
        _test_table(card),
        *(f'<h2>{name}</h2><img src="{name}.png" alt="{name} of the search">' for name in pictures),
    ]
    page = folder / "index.html"
    title = f"{escape(title_of(card))} – arena tune"
    head = f'<meta charset="utf-8"><title>{title}</title><style>{STYLE}</style>'
    write_text_whole(page, f'<!doctype html><html lang="en"><head>{head}</head><body>{"".join(parts)}</body></html>\n')
    return page


def title_of(card: Mapping[str, Any]) -> str:
    """Return what was tuned for which robot, in a few words."""
    if "parts" in card:
        return f"stack of {card['planner']} on {card['robot']}"
    return f"{card['planner']} on {card['robot']}"


def _budget_sentence(card: Mapping[str, Any]) -> str:
    spent, trials = card["budget"], card["trials"]
    return escape(
        f"{trials['all']} sets of values in {trials['races']} races, {trials['whole']} of them on all problems, "
        f"{trials['failed']} failed; {spent['search']} episodes of search, {spent['validate']} of validation, "
        f"{spent['test']} of test; seed {card['seed']}, sampler {card['sampler']}, "
        f"problems {card['problems']['name']}; what the robot costs people is known of {card['twins']} episodes; "
        f"objective: {card['objective']}"
    )


def _values_table(card: Mapping[str, Any]) -> str:
    rows = [
        [key, value, card["values"].get(key, ""), one.get("unit", ""), f"{card['importance'].get(key, 0.0):.2f}"]
        for (key, value), one in zip(card["present"].items(), _spaces(card), strict=True)
    ]
    return _table(["parameter", "present", "winner", "unit", "importance"], rows)


def _spaces(card: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [card["space"][key] for key in card["present"]]


def _pareto_table(card: Mapping[str, Any]) -> str:
    """Return the points of validation that no other one dominates, with the rule that chose one of them."""
    points = card.get("pareto", ())
    if not points:
        return ""
    rows = [
        [
            f"{number}{' (chosen)' if one['chosen'] else ''}",
            *map(_number, one["advantages"]),
            _values_line(one["values"]),
        ]
        for number, one in enumerate(points, 1)
    ]
    head = ["on validation, over the present values", *card["objectives"], "values"]
    said = f"<p>Chosen: {escape(card['rule'])}. It is better if it is {escape(card['better_if'])}.</p>"
    return f"<h2>Pareto set</h2>{_table(head, rows)}{said}"


def _values_line(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{key} {value}" for key, value in values.items())


def _test_table(card: Mapping[str, Any]) -> str:
    figures = card["test"].get("figures", {})
    rows = [
        [name, *(_number(one[part]) for part in ("present", "tuned", "difference", "low", "high", "p"))]
        for name, one in figures.items()
    ]
    return _table(["on test", "present", "tuned", "difference", "low", "high", "p"], rows) if rows else ""


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"


def _table(head: list[str], rows: list[list[Any]]) -> str:
    lines = ["".join(f"<{tag}>{escape(str(cell))}</{tag}>" for cell in row) for tag, row in _tagged(head, rows)]
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def _tagged(head: list[str], rows: list[list[Any]]) -> list[tuple[str, list[Any]]]:
    return [("th", head), *(("td", row) for row in rows)]
