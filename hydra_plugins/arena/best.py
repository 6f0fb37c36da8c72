"""Says what a sweeper found that looked for the best."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hydra.experimental.callback import Callback
from omegaconf import DictConfig, OmegaConf

from .ties import find_ties

RESULTS = "optimization_results.yaml"  # what Hydra's Optuna sweeper writes to the multirun's folder


class Best(Callback):
    """Prints the best values of a multirun's end, where its sweeper has written any."""

    def on_multirun_end(self, config: DictConfig, **kwargs: Any) -> None:
        """Print the best of one objective, or how many are best of several."""
        path = Path(str(config.hydra.sweep.dir)) / RESULTS
        if not path.exists():
            return
        found = OmegaConf.load(path)
        if "best_value" in found:
            values = " ".join(
                f"{key}={value:.6g}" if isinstance(value, float) else f"{key}={value}"
                for key, value in found.best_params.items()
            )
            print(f"best of {config.objective}, {found.best_value:.6g}: {values}")
            for line in _tie_lines(path.parent, str(config.objective), float(found.best_value)):
                print(line)
        else:
            print(f"{len(found.solutions)} trials are best of {', '.join(config.objective)}: none is better in all")
        print(f"written: {path}")


def _tie_lines(folder: Path, metric: str, best: float) -> Iterator[str]:
    """Yield what is to be known of a best trial: which others have its value, and how many may be as good."""
    try:
        ties = find_ties(folder, metric, best)
    except ImportError:  # tests need scipy, which the core alone does not bring
        return
    if ties.equal:
        yield f"as good: trial{'s' * (len(ties.equal) > 1)} {', '.join(ties.equal)}"
    if ties.not_told_apart:
        alike = f"{ties.not_told_apart} of the other {ties.trials - 1} trials"
        yield f"{alike} cannot be told apart from it by their episodes"
