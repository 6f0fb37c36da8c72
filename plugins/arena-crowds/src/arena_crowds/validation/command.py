"""``arena crowd validate`` holds crowd models against recordings and the literature; ``arena crowd
measure`` says how people walk.
"""

from __future__ import annotations

import importlib
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

from arena_core import ConfigurationError, PedestrianModel
from arena_core.commands import Command, complete_overrides, read_words
from arena_core.files import csv_text, write_bytes_whole, write_text_whole
from arena_core.hosting import compose, load_registry
from arena_crowds.validation.findings import Findings, table_lines
from arena_crowds.validation.measure import USAGE as MEASURE
from arena_crowds.validation.measure import run_measurement

EXPERIMENTS = {
    "speed_density": "walking speed over density in a corridor, against Weidmann and the Juelich recordings",
    "lanes": "lanes of people who walk against each other",
    "door": "flow through a door, over its width and over people's hurry",
    "rollout": "error of 4.8 s of simulation against the recording zara01 of UCY",
}
KEYS = ("pedestrians", "recordings", "out")
USAGE = (
    "arena crowd validate [EXPERIMENT ...] [pedestrians=MODEL,...] "
    "[pedestrians.KEY=VALUE ...] [recordings=DIR] [out=DIR]"
)


class CrowdCommand(Command):
    """Run experiments with crowd models; write a table and a picture for each."""

    help: ClassVar[str] = "validate crowd models, and measure how people walk: arena crowd validate | measure"

    def run(self, arguments: Sequence[str]) -> int:
        """Run the experiments (all that the recordings allow, without names) and print their tables, or measure."""
        if arguments and arguments[0] == "measure" and not {"--help", "-h"} & set(arguments):
            return run_measurement(arguments[1:])
        if not arguments or arguments[0] != "validate" or "--help" in arguments or "-h" in arguments:
            print(_usage_text())
            return 0 if not arguments or {"--help", "-h"} & set(arguments) else 2
        words = read_words(USAGE, arguments[1:], names=None, keys=KEYS, overrides=["pedestrians"])
        for name in words.names:
            if name not in EXPERIMENTS:
                raise ConfigurationError(
                    f"arena crowd validate has no experiment {name!r} (possible: {', '.join(EXPERIMENTS)})"
                )
        recordings = Path(words.keys["recordings"]) if "recordings" in words.keys else None
        chosen = words.keys.get("pedestrians", "social_force").split(",")
        models = {preset: build_model(preset, words.overrides) for preset in chosen}
        for name in words.names or [name for name in EXPERIMENTS if name != "rollout" or recordings]:
            findings: Findings = importlib.import_module(f"arena_crowds.validation.{name}").run(models, recordings)
            print(f"\n{name}: {EXPERIMENTS[name]}\n{table_lines(findings.rows)}")
            write_findings(findings, Path(words.keys.get("out", "crowds")), name)
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the subcommands, the experiments, and overrides."""
        if not words:
            return ["measure", "validate"]
        return [*(EXPERIMENTS if words[0] == "validate" else ()), *complete_overrides(words, word)]


def build_model(preset: str, overrides: Sequence[str]) -> PedestrianModel:
    """Build a crowd model from its preset, as a run would."""
    from omegaconf import OmegaConf

    node: Any = OmegaConf.to_container(
        compose([f"pedestrians={preset}", *overrides], "component").pedestrians, resolve=True
    )
    return load_registry().build("pedestrians", node)  # type: ignore[no-any-return]


def write_findings(findings: Findings, folder: Path, name: str) -> None:
    """Write NAME.csv and NAME.png."""
    from matplotlib.figure import Figure

    picture = io.BytesIO()
    figure = Figure(figsize=findings.size, layout="constrained")
    findings.draw(figure)
    figure.savefig(picture, format="png", dpi=110)
    columns = list(findings.rows[0])
    write_text_whole(
        folder / f"{name}.csv", csv_text([columns, *([row[key] for key in columns] for row in findings.rows)])
    )
    write_bytes_whole(folder / f"{name}.png", picture.getvalue())
    print(f"written: {folder / name}.csv and .png")


def _usage_text() -> str:
    return "\n".join(
        [f"usage: {USAGE}", f"       {MEASURE}", "", *(f"  {name:14} {what}" for name, what in EXPERIMENTS.items())]
    )
