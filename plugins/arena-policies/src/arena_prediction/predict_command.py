"""``arena predict``: train the learned predictor, measure predictors."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, align_columns, complete_overrides, read_words
from arena_core.files import options_of
from arena_core.hosting import compose, load_registry, require_extra, to_plain
from arena_core.parameters import Bounds, Positive
from arena_prediction.measure import Measured, measure

STAGES = ("train", "measure")
TRAIN = "arena predict train [seed=0] [out=DIR] [resume=true] [KEY=VALUE ...]"
MEASURE = "arena predict measure [predictor=NAME,NAME] [horizon=2.0] [miss=0.5] [episodes=N] [KEY=VALUE ...]"
NEEDED = ("arena_gym", "torch", "onnx", "onnxscript")
Horizon = Annotated[float, Bounds(low=0.2, high=20.0)]  # s


class PredictCommand(Command):
    """Train the network of ``predictor=learned``, or measure predictors against what people then did."""

    help: ClassVar[str] = "train a predictor of people, measure predictors: arena predict measure predictor=learned"
    kept: ClassVar[str] = (
        "drives and epochs that are over are kept, resume=true (with the same words) goes on from there"
    )

    def run(self, arguments: Sequence[str]) -> int:
        """Train to a folder, or drive and print a table."""
        if not arguments or any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {TRAIN}\n       {MEASURE}")
            return 0
        stage, *words = arguments
        if stage not in STAGES:
            raise ConfigurationError(f"stage is {stage}; allowed: {', '.join(STAGES)}")
        return _train(words) if stage == "train" else _measure(words)

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the stages, then overrides of the training, or of the drives that are measured on."""
        if not words:
            return STAGES
        if words[0] == "measure" and word.startswith("predictor="):
            return [f"predictor={name}" for name in options_of("predictor", load_registry().manager)]
        return complete_overrides(words[1:], word, primary="predict" if words[0] == "train" else "config")


def _train(words: Sequence[str]) -> int:
    require_extra("arena predict train", NEEDED, "arena-gym[train]")
    given = read_words(TRAIN, words, keys=("out", "resume"), overrides=None)
    resume = given.value("resume", bool, False)
    config = to_plain(compose(given.overrides, "predict"))
    folder = Path(given.keys.get("out", f"trainings/predictor_{config['seed']}"))
    load_registry().build("trainer", config["trainer"]).train(config, folder, resume=resume)
    return 0


def _measure(words: Sequence[str]) -> int:
    given = read_words(MEASURE, words, keys=("predictor", "horizon", "miss"), overrides=None)
    names = given.keys.get("predictor", "constant_velocity,learned").split(",")
    if len(set(names)) < len(names):
        raise ConfigurationError(f"predictor is {','.join(names)}; allowed: several, each once")
    horizon, miss = given.value("horizon", Horizon, 2.0), given.value("miss", Positive, 0.5)
    found = measure(given.overrides, names, horizon, miss)
    print("\n".join(align_columns([HEADER, *(_cells(name, one, found[names[0]]) for name, one in found.items())])))
    return 0


HEADER = [
    "predictor",
    "tracks",
    "ADE m",
    "of the first",
    "FDE m",
    "min ADE m",
    "min FDE m",
    "missed",
    "NLL",
    "in 50 %",
    "in 90 %",
    "ms a call",
]


def _cells(name: str, one: Measured, first: Measured) -> list[str]:
    """Return a predictor's line of the table."""
    mean = one.summary
    return [
        name,
        str(mean.tracks),
        f"{mean.ade:.3f}",
        f"{mean.ade / first.summary.ade:.2f}" if first.summary.ade > 0.0 else "-",
        *(f"{value:.3f}" for value in (mean.fde, mean.min_ade, mean.min_fde)),
        *(f"{value:.2f}" for value in (mean.missed, mean.nll, mean.in_50, mean.in_90)),
        f"{one.milliseconds:.3f}",
    ]
