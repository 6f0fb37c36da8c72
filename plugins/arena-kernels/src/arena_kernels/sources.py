"""What kernels were made from, told by content."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path


@cache
def sources_digest(place: Path) -> str:
    """Return a digest of all modules at or below a folder, or beside a file."""
    digest = hashlib.blake2b(digest_size=16)
    for file in sorted(place.rglob("*.py") if place.is_dir() else place.parent.glob("*.py")):
        digest.update(f"{file.relative_to(place if place.is_dir() else place.parent)}\0".encode())
        digest.update(hashlib.blake2b(file.read_bytes()).digest())
    return digest.hexdigest()
