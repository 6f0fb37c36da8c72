"""What the test of a contract yields."""

from __future__ import annotations

from collections.abc import Iterator

Facts = Iterator[tuple[str, bool]]  # a fact in words, and whether it holds
