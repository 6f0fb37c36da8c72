"""The drives of a training, kept as files: what is there is not driven again."""

from __future__ import annotations

from pathlib import Path

from arena_core import ImpossibleScenario
from arena_core.commands import print_notice
from arena_gym.prediction.problems import block_words
from arena_gym.prediction.settings import DriveSettings
from arena_prediction.drives import drive, save_drive, watched_benchmark


def record_drives(settings: DriveSettings, seed: int, folder: Path) -> None:
    """Drive what is missing of all blocks; a block of which a problem is impossible gives fewer drives."""
    folder.mkdir(parents=True, exist_ok=True)
    for block in range(settings.blocks):
        done = folder / f"{block:04d}.done"
        if not done.exists():
            count = _record_block(settings, seed, block, folder)
            done.write_text(f"{count}\n")
            print(f"drives: block {block + 1} of {settings.blocks}, {count} of {settings.episodes} drives", flush=True)


def _record_block(settings: DriveSettings, seed: int, block: int, folder: Path) -> int:
    benchmark, watching = watched_benchmark(block_words(settings, seed, block))
    count = 0
    for episode in range(settings.episodes):
        try:
            driven = drive(benchmark, watching, episode)
        except ImpossibleScenario as error:
            print_notice(f"block {block}, drive {episode}: {error}")
            continue
        if len(driven.stamps):
            save_drive(folder / f"{block:04d}_{episode:02d}.npz", driven)
            count += 1
    return count


def drive_files(folder: Path, block: int) -> list[Path]:
    """Return the files of a block's drives."""
    return sorted(folder.glob(f"{block:04d}_*.npz"))
