"""``arena list scenarios``: what stands behind `scenario=`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from arena_core.commands import Listing
from arena_core.files import option_files
from arena_core.hosting import load_registry


class ScenarioListing(Listing):
    """The options of the configuration group ``scenario``."""

    def __init__(self) -> None:
        self._registry = load_registry()
        self._options = option_files("scenario", self._registry.manager)

    def names(self) -> Sequence[str]:
        """Return the options."""
        return list(self._options)

    def summary(self) -> Sequence[str]:
        """Return how many scenarios each pack has, and the first of them."""
        counts = Counter(map(_pack_of, self._options))
        first = {_pack_of(name): name for name in reversed(self._options)}
        lines = [f"{pack or 'in no pack':22} {count}, such as scenario={first[pack]}" for pack, count in counts.items()]
        return lines or ["none installed"]

    def details(self) -> Sequence[str]:
        """Return a line for each scenario: what it holds, or why it cannot be run."""
        # reads files with libraries that the other lines do not need
        from arena_tasks.commands.scenario_table import table_lines

        return table_lines(self._options, self._registry)


def _pack_of(option: str) -> str:
    return option.rpartition("/")[0]
