"""Frames to files: one picture, or a film, written beside its place and renamed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex

import numpy as np
from numpy.typing import NDArray

from arena_core import ArenaError, ConfigurationError

Frame = NDArray[np.uint8]
ENDINGS = (".mp4", ".gif", ".png")


def check_target(target: Path) -> None:
    """Raise ConfigurationError unless its name is that of a film or a picture."""
    if target.suffix not in ENDINGS:
        raise ConfigurationError(f"out is {target.name}; allowed: a name that ends in {', '.join(ENDINGS)}")


def check_encoder(target: Path) -> None:
    """Raise ConfigurationError where a film needs what is not installed."""
    if target.suffix == ".mp4":
        try:
            import imageio_ffmpeg  # noqa: F401 - only whether it is there
        except ImportError:
            raise ConfigurationError(
                f"{target.name} needs imageio-ffmpeg; allowed: pip install imageio-ffmpeg, or .gif"
            ) from None


def write_picture(target: Path, frame: Frame) -> None:
    """Write one frame as PNG."""
    from PIL import Image

    with _temporary_path(target) as path:
        Image.fromarray(frame).save(path, format="PNG", optimize=True)


def write_film(target: Path, frames: Iterable[Frame], size: tuple[int, int], rate: float) -> None:
    """Write frames as MP4 (H.264) or GIF, ``rate`` of them a second."""
    with _temporary_path(target) as path:
        (_write_mp4 if target.suffix == ".mp4" else _write_gif)(path, iter(frames), size, rate)


def _write_mp4(path: Path, frames: Iterator[Frame], size: tuple[int, int], rate: float) -> None:
    from imageio_ffmpeg import write_frames

    settings = {
        "codec": "libx264",
        "quality": None,
        "macro_block_size": 2,
        "pix_fmt_in": "rgb24",
        "ffmpeg_log_level": "error",
    }
    more = [
        "-crf",
        "23",
        "-preset",
        "veryfast",
        "-movflags",
        "+faststart",
        "-map_metadata",
        "-1",
        "-fflags",
        "+bitexact",
    ]
    writer = write_frames(str(path), size, fps=rate, output_params=more, **settings)
    writer.send(None)
    try:
        for frame in frames:
            writer.send(np.ascontiguousarray(frame))
    finally:
        writer.close()


def _write_gif(path: Path, frames: Iterator[Frame], size: tuple[int, int], rate: float) -> None:
    from PIL import Image

    images = [Image.fromarray(frame).quantize(128, method=Image.Quantize.FASTOCTREE) for frame in frames]
    images[0].save(path, format="GIF", save_all=True, append_images=images[1:], duration=round(1000.0 / rate), loop=0)


@contextmanager
def _temporary_path(target: Path) -> Iterator[Path]:
    """Give a path beside the target; what was written there takes its place, and nothing is left of what failed."""
    path = target.with_name(f".{target.stem}.{token_hex(4)}{target.suffix}")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        yield path
        path.replace(target)
    except OSError as error:
        raise ArenaError(f"cannot write {target}: {error.strerror or error}") from None
    finally:
        path.unlink(missing_ok=True)
