"""Says what a sweeper found that looked for the best."""

from pathlib import Path
from typing import Any

from hydra.experimental.callback import Callback
from omegaconf import DictConfig, OmegaConf

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
        else:
            print(f"{len(found.solutions)} trials are best of {', '.join(config.objective)}: none is better in all")
        print(f"written: {path}")
