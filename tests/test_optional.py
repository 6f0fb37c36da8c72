"""Modules that only an extra brings are asked for in one line."""

import pytest

from arena_core import ConfigurationError
from arena_core.hosting import require_extra


def test_what_is_installed_is_enough():
    require_extra("arena train", ["json", "numpy"], "arena-gym[train]")


def test_what_is_missing_is_named_with_the_extra_that_brings_it():
    with pytest.raises(
        ConfigurationError, match=r"^arena train needs no_such_module; install the extra arena-gym\[train\]$"
    ):
        require_extra("arena train", ["json", "no_such_module"], "arena-gym[train]")
