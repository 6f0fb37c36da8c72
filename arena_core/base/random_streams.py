"""Random streams: each is keyed by (seed, scenario, stream name), so nothing else can shift its numbers."""

from __future__ import annotations

from hashlib import blake2b

import numpy as np


def stream_key(seed: int, scenario: str, stream: str) -> np.uint64:
    """Return the 64-bit key of a counter-based stream, for the kernels of ``arena_kernels.random``."""
    digest = blake2b(f"{seed}\0{scenario}\0{stream}".encode(), digest_size=8).digest()
    return np.uint64(int.from_bytes(digest, "little"))


def random_generator(seed: int, scenario: str, stream: str) -> np.random.Generator:
    """Return a numpy generator of its own for this stream."""
    return np.random.Generator(np.random.Philox(key=int(stream_key(seed, scenario, stream))))
