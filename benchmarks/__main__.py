"""Run every benchmark, print one table and write benchmarks/results/latest.json; with
``--against COMMIT`` compare with a commit.
"""

from __future__ import annotations

import importlib
import json
import platform
import sys
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent


def main(names: list[str]) -> int:
    """Run the named benchmarks (all without names) in turn in this process."""
    sys.path.insert(0, str(HERE))
    if "--against" in names:
        return int(importlib.import_module("against").main(names))
    there = sorted(path.stem.removeprefix("bench_") for path in HERE.glob("bench_*.py"))
    if unknown := sorted(set(names) - set(there)):
        print(f"benchmarks: no {', '.join(unknown)}; allowed: {', '.join(there)}", file=sys.stderr)
        return 2
    chosen = names or there
    rows: list[dict[str, Any]] = []
    for name in chosen:
        print(f"measuring {name} ...", file=sys.stderr)
        rows += importlib.import_module(f"bench_{name}").measure()
    print(format_table(rows))
    target = HERE / "results" / "latest.json"
    target.parent.mkdir(exist_ok=True)
    target.write_text(
        json.dumps({"python": platform.python_version(), "machine": platform.machine(), "rows": rows}, indent=2) + "\n"
    )
    print(f"written: {target.relative_to(HERE.parent)}")
    return 0


def format_table(rows: list[dict[str, Any]]) -> str:
    """Return the rows as aligned text: what, our time, the peer's, the ratio, the goal."""
    cells = [("what", "ours", "peer", "peer's", "ratio", "goal")]
    for row in rows:
        ratio = "-" if row["ratio"] is None else f"{row['ratio']:.4g}"
        goal = "-" if row["goal"] is None else f"{row['goal']:.4g}"
        peer = "-" if row.get("peer_ms") is None else f"{row['peer_ms']:.4g} ms"
        cells.append(
            (row["what"], f"{row['ours_ms']:.4g} {row.get('ours_unit', 'ms')}", row["peer"] or "-", peer, ratio, goal)
        )
    widths = [max(len(row[i]) for row in cells) for i in range(len(cells[0]))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in cells
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
