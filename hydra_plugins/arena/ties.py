"""Which trials of a sweeper are as good as the one it calls the best, by the episodes that all of them drove."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isclose
from pathlib import Path


@dataclass(frozen=True)
class Ties:
    """Numbers of trials: those with the very value of the best one, and those that its episodes do not tell from it."""

    equal: Sequence[str]
    not_told_apart: int
    trials: int


def find_ties(folder: Path, metric: str, best: float) -> Ties:
    """Return the ties among the trials in the folders below ``folder``, each a run; the first of the best is no tie."""
    from arena_core.statistics import after_holm, compare

    trials = dict(_episode_values(folder, metric))
    known = {name: [x for x in of.values() if x == x] for name, of in trials.items()}
    means = {name: sum(values) / len(values) for name, values in known.items() if values}
    equal = [name for name, mean in means.items() if isclose(mean, best, rel_tol=1e-9, abs_tol=1e-12)]
    if not equal:
        return Ties((), 0, len(means))
    first = trials[equal[0]]
    others = [of for name, of in trials.items() if name != equal[0]]
    shared = [(of, [key for key in of if key in first]) for of in others]
    duels = after_holm([compare([of[k] for k in keys], [first[k] for k in keys]) for of, keys in shared if keys])
    return Ties(equal[1:], sum(not one.told_apart for one in duels), len(means))


def _episode_values(folder: Path, metric: str) -> Iterator[tuple[str, dict[str, float]]]:
    """Yield each trial's values of a metric by episode, in the order of the trials."""
    from arena_core.base.files import read_table

    numbered = [path for path in folder.iterdir() if path.name.isdecimal() and (path / "episodes.csv").is_file()]
    for path in sorted(numbered, key=lambda path: int(path.name)):
        _, rows = read_table(path / "episodes.csv", "a table that `arena run` wrote")
        yield path.name, {row["episode"]: float(row.get(metric) or "nan") for row in rows}
