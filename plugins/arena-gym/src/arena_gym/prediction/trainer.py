"""``arena predict train``: drives, samples, a fit, covariances that are held against other drives, a network with its
card.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from arena_core import ConfigurationError, Tracks
from arena_core.files import write_bytes_whole
from arena_core.hosting import Trainer
from arena_core.parameters import NonNegativeInt, read_settings
from arena_gym.prediction.fitting import Fit, fit_network
from arena_gym.prediction.network import ForesightNetwork
from arena_gym.prediction.recording import drive_files, record_drives
from arena_gym.prediction.samples import Samples, load_samples
from arena_gym.prediction.settings import DriveSettings, FitSettings, check_drives
from arena_gym.training.export import network_to_onnx
from arena_gym.training.folder import open_folder
from arena_policies.card import content_sha256
from arena_prediction.card import PredictorCard, write_card
from arena_prediction.features import LAYOUT, SIZE
from arena_prediction.hypotheses import AnswerReader
from arena_prediction.scores import score_predictions, summarise

Floats = NDArray[np.float64]
PACKAGES = ("arena-core", "arena-crowds", "arena-gym", "arena-navigation", "arena-policies", "arena-sim2d", "torch")
MISS = 0.5  # m, beyond which no hypothesis may end
INSIDE = 0.9  # of the truth lies within the ellipses of that share
MOST = 200_000  # samples that covariances are held against
EXCERPT = 20_000  # samples that each epoch is scored on


class PredictionTrainer(Trainer):
    """Learns where people will be, from drives of the suite's own simulator."""

    def __init__(self, drives: DriveSettings, fit: FitSettings) -> None:
        check_drives(drives)
        self._drives, self._fit = drives, fit
        self._times: Floats = fit.step * np.arange(1, fit.times + 1, dtype=np.float64)

    def train(self, config: Mapping[str, Any], folder: Path, *, resume: bool) -> None:
        """Watch drives, fit a network to them, and write ``people.onnx`` with its card to ``folder``."""
        seed, fit = read_settings(config["seed"], NonNegativeInt, "seed"), self._fit
        torch.set_num_threads(fit.threads)
        torch.manual_seed(seed)
        open_folder(folder, config, resume=resume)
        record_drives(self._drives, seed, folder / "drives")
        unseen, fitted = self._load(folder / "drives")
        network = ForesightNetwork(fit.hypotheses, fit.times, fit.width, fit.neighbour_width)
        excerpt = unseen.take(np.arange(0, len(unseen.numbers), max(len(unseen.numbers) // EXCERPT, 1)))
        task = Fit(fitted, fit, seed, folder)
        curve = fit_network(network, task, lambda: self._score(network, excerpt, self._ones()))
        widths = self._calibrate(network, unseen)
        score = self._score(network, unseen, widths)
        content = network_to_onnx(network, SIZE, "tracks", "answers")
        training = {
            "seed": seed,
            "config": {"drives": asdict(self._drives), "fit": asdict(fit)},
            "samples": {"fitted": len(fitted.numbers), "unseen": len(unseen.numbers)},
            "curve": curve,
            "score": score,
            "versions": {name: version(name) for name in PACKAGES},
        }
        times = tuple(round(float(time), 6) for time in self._times)
        card = PredictorCard(
            LAYOUT, fit.hypotheses, times, tuple(widths.tolist()), content_sha256(content), "MIT", training
        )
        write_bytes_whole(folder / "people.onnx", content)
        write_card(folder / "people.json", card)
        print(f"network: {folder / 'people.onnx'}")

    def _ones(self) -> Floats:
        return np.ones(len(self._times))

    def _load(self, folder: Path) -> tuple[Samples, Samples]:
        """Return the samples of drives that nothing is fitted to, and those of all others."""
        own = self._drives.validation
        parts = [
            load_samples(
                [path for block in blocks for path in drive_files(folder, block)], self._times, self._fit.every
            )
            for blocks in (range(own), range(own, self._drives.blocks))
        ]
        for part, blocks in zip(parts, (f"the first {own} blocks", "the others"), strict=True):
            if not len(part.numbers):
                raise ConfigurationError(
                    f"{folder}: no one was seen for {self._times[-1]:g} s in {blocks}; "
                    "allowed: more trainer.drives.blocks or episodes, or a longer trainer.drives.time_limit"
                )
        return parts[0], parts[1]

    def _score(self, network: ForesightNetwork, samples: Samples, widths: Floats) -> dict[str, float]:
        """Return what the network is worth on samples, beside constant velocity."""
        off, said = self._read(network, samples, widths)
        scores = score_predictions(said, self._times, off)
        straight = np.hypot(off[..., 0], off[..., 1]).mean()
        summary = {name: round(float(value), 4) for name, value in asdict(summarise(scores, MISS)).items()}
        return {**summary, "of_straight": round(float(scores.errors.mean() / straight), 4)}

    def _read(self, network: ForesightNetwork, samples: Samples, widths: Floats) -> tuple[Floats, Any]:
        """Return how far each sample's person was off its straight line, m, and what the network says of it: of tracks
        that stand at the origin and head along x.
        """
        with torch.no_grad():
            answers = network(torch.from_numpy(samples.numbers)).numpy()
        count, scale = len(samples.numbers), np.exp(samples.numbers[:, 0].astype(np.float64))
        frames = np.stack((np.ones(count), np.zeros(count), scale, np.ones(count)), axis=1)
        nothing = np.zeros((count, 2))
        tracks = Tracks(np.arange(count, dtype=np.int32), nothing, nothing, np.zeros(count), np.zeros((count, 4, 4)))
        reader = AnswerReader(np.array((0.0, *self._times)), self._fit.hypotheses, np.array((1.0, *widths)))
        return samples.metres(self._times), reader.predictions(tracks, frames, answers)

    def _calibrate(self, network: ForesightNetwork, samples: Samples) -> Floats:
        """Return by what deviations are to be multiplied at each time, so that INSIDE of the truth lies within the
        ellipses of that share.
        """
        few = samples.take(np.arange(0, len(samples.numbers), max(len(samples.numbers) // MOST, 1)))
        off, said = self._read(network, few, self._ones())
        away = off - said.means[:, 1:]
        squared = np.einsum("khi,khij,khj->kh", away, np.linalg.inv(said.covariances[:, 1:]), away)
        return np.asarray(np.sqrt(np.quantile(squared, INSIDE, axis=0) / (-2.0 * np.log(1.0 - INSIDE))))
