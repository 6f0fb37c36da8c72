"""PNG and BMP images that are changed cell by cell: mode, palette, transparency and texts stay as they are."""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass

import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from arena_core import InputFileError
from arena_core.commands import one_line
from arena_core.files import LIMITS
from arena_studio.mapping.pnm import Samples

FORMATS = ("PNG", "BMP")  # what loses nothing when it is written again
MODES = ("1", "L", "P", "LA", "RGB", "RGBA", "I;16")
ALLOWED = "PNG or BMP, grey or of 8 bit colours"


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """An image as it lies in its file: ``samples`` (H, W, C) in the mode of ``image``, row 0 at the top."""

    image: Image.Image
    form: str
    samples: Samples

    def encode_samples(self, samples: Samples) -> bytes:
        """Return a file of the same kind with these samples, which may be of another size."""
        rows, columns = samples.shape[:2]
        image = self.image.copy() if (columns, rows) == self.image.size else self.image.resize((columns, rows))
        image.frombytes(_raw_bytes(samples, self.image.mode))
        content = io.BytesIO()
        image.save(content, self.form, **self._save_options())
        return content.getvalue()

    @property
    def highest(self) -> int:
        """Return what a sample can be at most."""
        if self.image.mode == "P":
            return len(self.image.getpalette() or ()) // 3 - 1
        return {"1": 1, "I;16": 65535}.get(self.image.mode, 255)

    def _save_options(self) -> dict[str, object]:
        """Return what Pillow does not write again by itself."""
        kept: dict[str, object] = {key: self.image.info[key] for key in ("dpi",) if key in self.image.info}
        if self.form == "PNG":
            kept.update(pnginfo=_png_texts(self.image), compress_level=4)  # half the time of 6, files a tenth larger
        return kept


def read_picture(content: bytes, name: str) -> Picture | None:
    """Read an image;

    None where it is of a kind that would lose something when written. Raises InputFileError, which calls it ``name``.
    """
    # Pillow raises anything, and no common error of its own, for files that are cut off, made up or no images
    try:
        with (
            warnings.catch_warnings(action="error", category=Image.DecompressionBombWarning),
            Image.open(io.BytesIO(content)) as image,
        ):
            if image.width * image.height > LIMITS.cells:
                raise InputFileError(
                    f"{name}: has {image.width} x {image.height} pixels; allowed: {LIMITS.cells} in all"
                )
            if image.format not in FORMATS or image.mode not in MODES or getattr(image, "n_frames", 1) > 1:
                return None
            image.load()
            return Picture(image, image.format, _image_samples(image))
    except InputFileError:
        raise
    except Exception as error:
        raise InputFileError(
            f"{name}: is no image that can be read ({one_line(str(error), 120)}); allowed: {ALLOWED}"
        ) from None


def _image_samples(image: Image.Image) -> Samples:
    pixels = np.asarray(image)
    found: Samples = pixels.astype(np.uint16) if image.mode == "I;16" else pixels.astype(np.uint8, copy=False)
    return found[:, :, None] if found.ndim == 2 else found


def _raw_bytes(samples: Samples, mode: str) -> bytes:
    if mode == "1":
        return np.packbits(samples[:, :, 0] > 0, axis=1).tobytes()
    return samples.astype("<u2" if mode == "I;16" else np.uint8).tobytes()


def _png_texts(image: Image.Image) -> PngInfo:
    info = PngInfo()
    for key, value in getattr(image, "text", {}).items():
        info.add_text(key, str(value))
    return info
